//! One step: the triangle that an edge of the front is given.
//!
//! A new point is taken where there is room for it. Otherwise the vertex of the front under which the edge is seen at the largest angle,
//! among those that it can be joined to without crossing the front: in a plane that is the triangle of the constrained Delaunay
//! triangulation of the front, and there always is one. That vertex may lie on any part of the front, so fronts split and merge.

use glam::DVec3;
use isostudy_mesh::Bounds;

use crate::patch::Patch;
use crate::probe::{Foot, Miss, Probe, rounded};
use crate::sizes::Sizes;

/// A new point stays so many edges away from vertices.
const CLEAR_OF_VERTICES: f64 = 0.65;
/// And from edges of the front.
const CLEAR_OF_EDGES: f64 = 0.45;
/// The free angle at an end, in radians, below which no new point is tried first.
pub(crate) const ACUTE: f64 = 1.47;
/// The least height of a new triangle over its edge, in lengths of the edge.
const LEAST_HEIGHT: f64 = 0.25;
/// What is tried for an edge, one after the other, with shares of the height.
const WAYS: [(Way, f64); 6] = [
    (Way::Newton, 1.0),
    (Way::Front, 1.0),
    (Way::Circle, 1.0),
    (Way::Newton, 0.6),
    (Way::Circle, 0.6),
    (Way::Newton, 0.35),
];
/// Degrees between points of the circle, and how many to either side.
const CIRCLE: (f64, u32) = (20.0, 7);

/// How a third corner is looked for.
#[derive(Clone, Copy)]
enum Way {
    /// In the tangent plane, and from there by Newton's method.
    Newton,
    /// On a circle round the edge: past a crease, where Newton's method leads back to it.
    Circle,
    /// Among the front's vertices.
    Front,
}

/// How much a surface may bend along an edge.
#[derive(Clone, Copy)]
struct Bend {
    /// The least cosine of the angle between two normals.
    normals: f64,
    /// The greatest sine of the angle between the edge and a tangent plane.
    rise: f64,
    /// The least angle of a triangle at the vertex that it is joined to, in radians.
    angle: f64,
    /// The least cosine between the normals of a triangle and of its corners.
    triangle: f64,
    /// The longest side of a triangle, in wanted lengths.
    longest: f64,
}

const SMOOTH: Bend = Bend { normals: 0.4, rise: 0.6, angle: 0.26, triangle: 0.5, longest: 1.8 };
/// A right-angled crease passes.
const CREASED: Bend = Bend { normals: -0.15, rise: 1.01, angle: 0.03, triangle: -0.25, longest: 2.6 };

/// What an edge of the front grows.
pub(crate) enum Growth {
    Point(Foot),
    Vertex(u32),
    /// Nothing fits; and why, if the field is to blame.
    Nothing(Option<Miss>),
}

/// What a step knows.
pub(crate) struct Step<'a> {
    pub(crate) probe: &'a Probe<'a>,
    pub(crate) patch: &'a Patch,
    pub(crate) sizes: &'a Sizes,
    pub(crate) bounds: Bounds,
}

/// An edge of the front, and what lies round it.
struct Round {
    a: u32,
    b: u32,
    middle: DVec3,
    length: f64,
    /// Wanted.
    size: f64,
    normal: DVec3,
    /// Along the edge, and to its left.
    along: DVec3,
    left: DVec3,
    vertices: Vec<u32>,
    front: Vec<[u32; 2]>,
}

impl Step<'_> {
    pub(crate) fn grow(&self, a: u32, b: u32) -> Growth {
        let Some(round) = self.round(a, b) else { return Growth::Nothing(None) };
        let (at_a, at_b) = self.free_angles(a, b);
        if at_a.min(at_b) < ACUTE
            && let Some(v) = self.vertex(&round, SMOOTH)
        {
            return Growth::Vertex(v);
        }
        let mut blame = None;
        for (way, height) in WAYS {
            let found = match way {
                Way::Newton => self.point(&round, at_a, at_b, height),
                Way::Circle => self.point_on_circle(&round, height),
                Way::Front => match self.vertex(&round, SMOOTH) {
                    Some(v) => return Growth::Vertex(v),
                    None => continue,
                },
            };
            match found {
                Ok(Some(foot)) => return Growth::Point(foot),
                Ok(None) | Err(Miss::Far) => {}
                Err(miss) => blame = Some(miss),
            }
        }
        self.vertex(&round, CREASED).map_or(Growth::Nothing(blame), Growth::Vertex)
    }

    /// The free angles at both ends of an edge of the front.
    pub(crate) fn free_angles(&self, a: u32, b: u32) -> (f64, f64) {
        let at_a = self.patch.sector(a, b).map_or(0.0, |of| of.1);
        let at_b = self.patch.sector_before(b, a).map_or(0.0, |of| of.1);
        (at_a, at_b)
    }

    fn round(&self, a: u32, b: u32) -> Option<Round> {
        let patch = self.patch;
        let (from, to) = (patch.place(a), patch.place(b));
        let (middle, length) = (0.5 * (from + to), from.distance(to));
        let along = (to - from).try_normalize()?;
        let mean = patch.normal(a) + patch.normal(b);
        let normal = (mean - along * along.dot(mean)).try_normalize()?;
        let size = self.sizes.at(middle);
        let radius = 2.0 * size.max(length);
        let mut vertices = Vec::new();
        patch.near.each(middle, radius, |v| {
            if patch.place(v).distance_squared(middle) < radius * radius
                && patch.normal(v).dot(normal) > CREASED.normals
            {
                vertices.push(v);
            }
        });
        vertices.sort_unstable();
        let ends = |&v: &u32| patch.out[v as usize].iter().map(move |&w| [v, w]);
        let mut front: Vec<[u32; 2]> = vertices.iter().flat_map(ends).collect();
        let into = |&v: &u32| patch.into[v as usize].iter().map(move |&u| [u, v]);
        front.extend(vertices.iter().flat_map(into).filter(|[u, _]| vertices.binary_search(u).is_err()));
        front.retain(|&edge| edge != [a, b]);
        Some(Round { a, b, middle, length, size, normal, along, left: normal.cross(along), vertices, front })
    }

    /// A new point where there is room.
    fn point(&self, round: &Round, at_a: f64, at_b: f64, height: f64) -> Result<Option<Foot>, Miss> {
        let start = self.apex(round, at_a, at_b, height);
        if !self.has_room(round, Foot { place: start, normal: round.normal }) {
            return Ok(None);
        }
        let foot = self.probe.project(start, 0.6 * round.size.max(round.length))?;
        Ok(self.fits(round, foot).then_some(foot))
    }

    /// A new point where the surface next crosses a circle round the edge.
    fn point_on_circle(&self, round: &Round, height: f64) -> Result<Option<Foot>, Miss> {
        let radius = 0.866 * round.size.clamp(0.6 * round.length, 1.8 * round.length) * height;
        let at = |turn: f64| {
            let (sin, cos) = turn.to_radians().sin_cos();
            rounded(round.middle + radius * (cos * round.left + sin * round.normal))
        };
        let is_inside = self.probe.value(at(0.0)) > 0.0;
        let step = if is_inside { CIRCLE.0 } else { -CIRCLE.0 };
        let mut turns = (1..=CIRCLE.1).map(|i| f64::from(i) * step);
        let Some(turn) = turns.find(|&turn| (self.probe.value(at(turn)) > 0.0) != is_inside) else {
            return Ok(None);
        };
        let place = self.probe.root(at(turn - step), at(turn))?;
        let foot = Foot { place, normal: self.probe.mean_normal(place, 0.1 * radius)? };
        Ok(self.fits(round, foot).then_some(foot))
    }

    fn fits(&self, round: &Round, foot: Foot) -> bool {
        let ends = [round.a, round.b].map(|v| self.patch.foot(v));
        let way = foot.place - round.middle;
        let height = (way - round.along * way.dot(round.along)).length();
        height > LEAST_HEIGHT * round.length
            && ends.iter().all(|end| bends_within(*end, foot, CREASED))
            && faces([ends[0], ends[1], foot], CREASED.triangle)
            && self.has_room(round, foot)
    }

    /// The third corner: free angles are shared evenly by triangles of about 60 degrees, and the length comes near the wanted one.
    fn apex(&self, round: &Round, at_a: f64, at_b: f64, height: f64) -> DVec3 {
        let share = |angle: f64| {
            let triangles = (angle / 60_f64.to_radians()).round().max(if angle > ACUTE { 2.0 } else { 1.0 });
            (angle / triangles).clamp(0.75, 1.3).tan()
        };
        let (at_a, at_b) = (share(at_a), share(at_b));
        let x = round.length * at_b / (at_a + at_b);
        let wanted = round.size.clamp(0.6 * round.length, 1.8 * round.length);
        let ideal = (wanted * wanted - 0.25 * round.length * round.length).sqrt();
        let y = ideal * (x * at_a / (0.866 * round.length)).clamp(0.75, 1.25) * height;
        self.patch.place(round.a) + round.along * x + round.left * y
    }

    /// Whether a new point lies in the box, keeps its distances, and its triangle crosses nothing.
    fn has_room(&self, round: &Round, foot: Foot) -> bool {
        let p = foot.place;
        if p.clamp(self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3()) != p {
            return false;
        }
        let sides = [round.a, round.b].map(|v| self.patch.place(v).distance(p));
        let size = sides[0].min(sides[1]).min(round.size.max(0.6 * round.length));
        let is_same = |v: u32| {
            let (to, normal) = (self.patch.place(v) - p, self.patch.normal(v));
            let rise = to.dot(foot.normal).abs().max(to.dot(normal).abs());
            foot.normal.dot(normal) > CREASED.normals && rise < CREASED.rise * to.length() + 0.02 * size
        };
        let (is_a_or_b, clear) = (|v: u32| v == round.a || v == round.b, CLEAR_OF_VERTICES * size);
        let is_near =
            |&v: &u32| !is_a_or_b(v) && self.patch.place(v).distance_squared(p) < clear * clear && is_same(v);
        if round.vertices.iter().any(is_near) {
            return false;
        }
        let clear = CLEAR_OF_EDGES * size;
        let is_beside = |&[u, w]: &[u32; 2]| {
            let foot_on = on_segment(self.patch.place(u), self.patch.place(w), p);
            foot_on.distance_squared(p) < clear * clear && is_same(u) && is_same(w)
        };
        !round.front.iter().any(is_beside) && self.is_clear(round, None, foot)
    }

    /// The vertex of the front that the edge is joined to.
    fn vertex(&self, round: &Round, bend: Bend) -> Option<u32> {
        let patch = self.patch;
        let (from, to) = (patch.place(round.a), patch.place(round.b));
        let longest = (bend.longest * round.size).max(1.1 * round.length);
        let mut found: Vec<(f64, u32)> = Vec::new();
        for &v in &round.vertices {
            let p = patch.place(v);
            let is_left = (p - round.middle).dot(round.left) > 1e-3 * round.length;
            if v == round.a || v == round.b || !is_left || !patch.is_on_front(v) {
                continue;
            }
            if p.distance(from).max(p.distance(to)) > longest {
                continue;
            }
            let angle = (from - p).angle_between(to - p);
            if angle < bend.angle {
                continue;
            }
            let foot = patch.foot(v);
            let ends = [patch.foot(round.a), patch.foot(round.b)];
            if ends.iter().all(|end| bends_within(*end, foot, bend))
                && faces([ends[0], ends[1], foot], bend.triangle)
                && patch.is_free([round.a, round.b, v])
            {
                found.push((angle, v));
            }
        }
        found.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        found.into_iter().map(|of| of.1).find(|&v| self.is_clear(round, Some(v), patch.foot(v)))
    }

    /// Whether the triangle to a corner lies in free sectors, crosses no edge of the front, and holds no vertex of it.
    fn is_clear(&self, round: &Round, v: Option<u32>, corner: Foot) -> bool {
        let (patch, p) = (self.patch, corner.place);
        let (a, b) = ((Some(round.a), patch.place(round.a)), (Some(round.b), patch.place(round.b)));
        if !patch.has_room(round.a, b, (v, p)) || !patch.has_room(round.b, (v, p), a) {
            return false;
        }
        if v.is_some_and(|v| !patch.has_room(v, a, b)) {
            return false;
        }
        // The triangle's own plane: past a crease that of the edge would turn it over.
        let normal = round.along.cross(p - round.middle).try_normalize().unwrap_or(round.normal);
        let left = normal.cross(round.along);
        let flat = |q: DVec3| [(q - round.middle).dot(round.along), (q - round.middle).dot(left)];
        let rise = |q: DVec3| (q - round.middle).dot(normal);
        let apart = 0.7 * round.size.max(round.length);
        let sides = [(round.a, a.1), (round.b, b.1)];
        let corners = [flat(a.1), flat(b.1), flat(p)];
        let is_corner = |w: u32| w == round.a || w == round.b || Some(w) == v;
        round.front.iter().all(|&[u, w]| {
            let ends = [patch.place(u), patch.place(w)];
            if (0.5 * (rise(ends[0]) + rise(ends[1]))).abs() > apart {
                return true;
            }
            let edge = ends.map(flat);
            let is_inside =
                !is_corner(u) && holds(corners, edge[0]) && is_beside(patch.foot(u), corner, patch, round);
            let crosses = sides.iter().any(|&(end, q)| {
                let shares = [u, w].iter().any(|&x| x == end || Some(x) == v);
                !shares && cross(flat(q), corners[2], edge[0], edge[1])
            });
            !is_inside && !crosses
        })
    }
}

/// Whether a vertex lies on the same sheet as the triangle, as normals say.
fn is_beside(of: Foot, corner: Foot, patch: &Patch, round: &Round) -> bool {
    let sum = corner.normal + patch.normal(round.a) + patch.normal(round.b);
    of.normal.dot(sum) > 0.0
}

fn bends_within(a: Foot, b: Foot, bend: Bend) -> bool {
    let way = b.place - a.place;
    let rise = way.dot(a.normal).abs().max(way.dot(b.normal).abs());
    a.normal.dot(b.normal) > bend.normals && rise < bend.rise * way.length()
}

/// Whether a triangle faces the way that its corners' normals do.
pub(crate) fn faces(corners: [Foot; 3], least: f64) -> bool {
    let [a, b, c] = corners.map(|corner| corner.place);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let mean = corners.iter().map(|corner| corner.normal).sum::<DVec3>().normalize_or_zero();
    mean.dot(normal) > 0.4 && corners.iter().all(|corner| corner.normal.dot(normal) > least)
}

fn on_segment(a: DVec3, b: DVec3, p: DVec3) -> DVec3 {
    let way = b - a;
    a + way * ((p - a).dot(way) / way.length_squared()).clamp(0.0, 1.0)
}

/// Twice the signed area.
fn area([ax, ay]: [f64; 2], [bx, by]: [f64; 2], [cx, cy]: [f64; 2]) -> f64 {
    (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
}

fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> bool {
    (area(a, b, c) > 0.0) != (area(a, b, d) > 0.0) && (area(c, d, a) > 0.0) != (area(c, d, b) > 0.0)
}

fn holds([a, b, c]: [[f64; 2]; 3], p: [f64; 2]) -> bool {
    area(a, b, p) > 0.0 && area(b, c, p) > 0.0 && area(c, a, p) > 0.0
}
