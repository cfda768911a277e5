//! What has grown so far: vertices, triangles, and the front, the directed edges that still want a triangle on their left.

use glam::DVec3;
use isostudy_mesh::Bounds;

use crate::near::Near;
use crate::probe::Foot;

/// In place of a triangle: the edge lies on the border of the box.
const BORDER: u32 = u32::MAX;
/// A triangle that was taken away.
const GONE: [u32; 3] = [u32::MAX; 3];

pub(crate) struct Patch {
    pub(crate) places: Vec<DVec3>,
    pub(crate) normals: Vec<DVec3>,
    /// Per vertex, the sum of its normal and those of its triangles: in creases angles are measured round it.
    axes: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    alive: usize,
    /// Per vertex, the ends of the directed edges that have a triangle on their left, and which.
    used: Vec<Vec<(u32, u32)>>,
    /// Per vertex, the ends of the front's edges that begin there, and the beginnings of those that end there.
    pub(crate) out: Vec<Vec<u32>>,
    pub(crate) into: Vec<Vec<u32>>,
    pub(crate) near: Near,
}

impl Patch {
    pub(crate) fn new(bounds: Bounds, edge: f64) -> Self {
        Self {
            places: Vec::new(),
            normals: Vec::new(),
            axes: Vec::new(),
            triangles: Vec::new(),
            alive: 0,
            used: Vec::new(),
            out: Vec::new(),
            into: Vec::new(),
            near: Near::new(bounds, edge),
        }
    }

    pub(crate) fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.triangles.iter().copied().filter(|t| *t != GONE)
    }

    /// The triangles from number `first` on that are still there, and the number after the last.
    pub(crate) fn since(&self, first: usize) -> (Vec<[u32; 3]>, usize) {
        let new = self.triangles[first..].iter().copied().filter(|t| *t != GONE).collect();
        (new, self.triangles.len())
    }

    pub(crate) fn triangle_count(&self) -> usize {
        self.alive
    }

    pub(crate) fn place(&self, v: u32) -> DVec3 {
        self.places[v as usize]
    }

    pub(crate) fn normal(&self, v: u32) -> DVec3 {
        self.normals[v as usize]
    }

    pub(crate) fn foot(&self, v: u32) -> Foot {
        Foot { place: self.place(v), normal: self.normal(v) }
    }

    pub(crate) fn add_vertex(&mut self, foot: Foot) -> u32 {
        let v = self.places.len() as u32;
        self.places.push(foot.place);
        self.normals.push(foot.normal);
        self.axes.push(foot.normal);
        self.used.push(Vec::new());
        self.out.push(Vec::new());
        self.into.push(Vec::new());
        self.near.insert(v, foot.place);
        v
    }

    /// An edge of the border, with the surface on its left.
    pub(crate) fn add_border(&mut self, a: u32, b: u32) {
        self.used[b as usize].push((a, BORDER));
        self.add_front(a, b);
    }

    /// Whether the directed edge has a triangle on its left.
    pub(crate) fn is_used(&self, a: u32, b: u32) -> bool {
        self.used[a as usize].iter().any(|&(to, _)| to == b)
    }

    pub(crate) fn is_front(&self, a: u32, b: u32) -> bool {
        self.out[a as usize].contains(&b)
    }

    pub(crate) fn is_on_front(&self, v: u32) -> bool {
        !self.out[v as usize].is_empty()
    }

    /// All edges of the front, by number.
    pub(crate) fn front(&self) -> Vec<[u32; 2]> {
        let from = self.out.iter().enumerate();
        from.flat_map(|(a, ends)| ends.iter().map(move |&b| [a as u32, b])).collect()
    }

    /// Whether the three directed edges are free.
    pub(crate) fn is_free(&self, [a, b, c]: [u32; 3]) -> bool {
        !(self.is_used(a, b) || self.is_used(b, c) || self.is_used(c, a))
    }

    /// Adds a triangle whose directed edges are free, counter-clockwise seen from outside.
    pub(crate) fn add_triangle(&mut self, [a, b, c]: [u32; 3]) {
        let t = self.triangles.len() as u32;
        self.triangles.push([a, b, c]);
        self.alive += 1;
        self.turn_axes([a, b, c], 1.0);
        for [p, q] in [[a, b], [b, c], [c, a]] {
            if self.is_front(p, q) {
                self.remove_front(p, q);
            } else {
                self.add_front(q, p);
            }
            self.used[p as usize].push((q, t));
        }
    }

    /// Takes the triangles away that have a corner within `radius`, and the vertices that are then left over.
    pub(crate) fn remove_round(&mut self, centre: DVec3, radius: f64) {
        let is_in = |v: &u32| self.places[*v as usize].distance(centre) < radius;
        let doomed: Vec<usize> = (0..self.triangles.len())
            .filter(|&t| self.triangles[t] != GONE && self.triangles[t].iter().any(is_in))
            .collect();
        let mut corners: Vec<u32> = Vec::new();
        for t in doomed {
            let [a, b, c] = std::mem::replace(&mut self.triangles[t], GONE);
            self.alive -= 1;
            self.turn_axes([a, b, c], -1.0);
            corners.extend([a, b, c]);
            for [p, q] in [[a, b], [b, c], [c, a]] {
                self.used[p as usize].retain(|&(to, _)| to != q);
                if self.is_used(q, p) {
                    self.add_front(p, q);
                } else {
                    self.remove_front(q, p);
                }
            }
        }
        corners.sort_unstable();
        corners.dedup();
        for v in corners {
            let i = v as usize;
            if self.used[i].is_empty() && self.out[i].is_empty() && self.into[i].is_empty() {
                self.near.remove(v, self.places[i]);
            }
        }
    }

    /// The first vertex round which triangles make more than one fan.
    pub(crate) fn pinched(&self) -> Option<u32> {
        (0..self.places.len() as u32).find(|&v| self.fans(v) > 1)
    }

    fn fans(&self, v: u32) -> usize {
        // Each triangle at v leads from one neighbour to the next.
        let spokes = &self.used[v as usize];
        let next = |to: u32, t: u32| {
            let [a, b, c] = self.triangles[t as usize];
            if [a, b] == [v, to] {
                c
            } else if [b, c] == [v, to] {
                a
            } else {
                b
            }
        };
        let mut steps: Vec<(u32, u32)> =
            spokes.iter().filter(|s| s.1 != BORDER).map(|&(to, t)| (to, next(to, t))).collect();
        let mut fans = 0;
        while let Some((start, mut end)) = steps.pop() {
            fans += 1;
            while let Some(i) = steps.iter().position(|step| step.0 == end) {
                end = steps.swap_remove(i).1;
            }
            let mut begin = start;
            while let Some(i) = steps.iter().position(|step| step.1 == begin) {
                begin = steps.swap_remove(i).0;
            }
        }
        fans
    }

    fn turn_axes(&mut self, corners: [u32; 3], by: f64) {
        let [a, b, c] = corners.map(|v| self.place(v));
        let normal = by * (b - a).cross(c - a).normalize_or_zero();
        corners.iter().for_each(|&v| self.axes[v as usize] += normal);
    }

    fn add_front(&mut self, a: u32, b: u32) {
        self.out[a as usize].push(b);
        self.into[b as usize].push(a);
    }

    fn remove_front(&mut self, a: u32, b: u32) {
        self.out[a as usize].retain(|&to| to != b);
        self.into[b as usize].retain(|&from| from != a);
    }

    /// The angle at `v` from `from` to `to`, counter-clockwise seen from outside, from 0 up to 2 pi, in the tangent plane.
    pub(crate) fn angle(&self, v: u32, from: DVec3, to: DVec3) -> f64 {
        angle(self.axes[v as usize].normalize_or(self.normal(v)), from - self.place(v), to - self.place(v))
    }

    /// The edge of the front that ends the free sector behind the edge from `v` to `d`: where it begins, and the sector's angle.
    pub(crate) fn sector(&self, v: u32, d: u32) -> Option<(u32, f64)> {
        let angles = self.into[v as usize].iter().map(|&e| (e, self.angle(v, self.place(d), self.place(e))));
        angles.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
    }

    /// The edge of the front that begins the free sector before the edge from `e` to `v`: where it ends, and the sector's angle.
    pub(crate) fn sector_before(&self, v: u32, e: u32) -> Option<(u32, f64)> {
        let angles = self.out[v as usize].iter().map(|&d| (d, self.angle(v, self.place(d), self.place(e))));
        angles.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
    }

    /// Whether a triangle's corner at `v`, from the direction of `x` counter-clockwise to that of `y`, lies in a free sector. A corner
    /// is a vertex, with its number, or a new point.
    pub(crate) fn has_room(&self, v: u32, x: (Option<u32>, DVec3), y: (Option<u32>, DVec3)) -> bool {
        self.out[v as usize].iter().any(|&d| {
            let Some((e, whole)) = self.sector(v, d) else { return false };
            let from = if x.0 == Some(d) { 0.0 } else { self.angle(v, self.place(d), x.1) };
            let to = if y.0 == Some(e) { whole } else { self.angle(v, self.place(d), y.1) };
            from < to && to <= whole
        })
    }
}

fn angle(normal: DVec3, from: DVec3, to: DVec3) -> f64 {
    let flat = |v: DVec3| v - normal * normal.dot(v);
    let (from, to) = (flat(from), flat(to));
    let angle = normal.dot(from.cross(to)).atan2(from.dot(to));
    if angle < 0.0 { angle + std::f64::consts::TAU } else { angle }
}
