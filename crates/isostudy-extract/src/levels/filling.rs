//! Triangles in a loop of crossings round a divided cell.

use glam::DVec3;
use isostudy_cells::{PolygonTriangles, radius_ratio};

use super::divided::Divided;

/// What a triangle costs that lies in a divided side: it would stand square on a surface that is not parallel to the side.
const FLAT: f64 = 1.0;
/// What a triangle costs that faces against its loop. Square on it, it costs a quarter of that.
const AGAINST: f64 = 32.0;
/// The least cosine between a triangle's direction and its loop's where the loop is not strange.
const LEAST_COSINE: f64 = 0.2;
/// To how many corners of a loop a vertex within it is tried to be joined.
const BRIDGES: usize = 3;

/// The most vertices within a loop.
const MOST_NEW: usize = 2;
/// The number of the first one, until it has one.
const FIRST_NEW: u32 = u32::MAX - MOST_NEW as u32;

/// A corner of a loop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub(super) vertex: u32,
    pub(super) position: DVec3,
    pub(super) on: On,
}

/// What a corner lies on.
#[derive(Debug, Clone, Copy)]
pub(super) enum On {
    /// An edge of the cell.
    Edge(u8),
    /// A face of the cell.
    Face(u8),
    /// Nothing: it lies in the cell.
    Nothing,
}

impl Corner {
    /// A vertex within a loop, which has no number yet.
    fn new(i: usize, position: DVec3) -> Self {
        Self { vertex: FIRST_NEW + i as u32, position, on: On::Nothing }
    }

    /// The divided sides that it lies in, one bit each.
    fn sides(&self, kind: &Divided) -> u8 {
        match self.on {
            On::Edge(edge) => kind.sides_at_edge[usize::from(edge)],
            On::Face(_) | On::Nothing => 0,
        }
    }

    /// Whether a diagonal to another one lies within the cell.
    fn may_join(&self, other: &Self, kind: &Divided) -> bool {
        match [self.on, other.on] {
            [On::Edge(a), On::Edge(b)] => kind.triangulator.may_join(a, b),
            [On::Edge(edge), On::Face(face)] | [On::Face(face), On::Edge(edge)] => {
                kind.cell.faces_at_edge()[usize::from(edge)] >> face & 1 == 0
            }
            [On::Face(a), On::Face(b)] => a != b,
            [On::Nothing, _] | [_, On::Nothing] => self.vertex != other.vertex,
        }
    }
}

/// Fills loops with triangles; room that is used again.
#[derive(Debug, Default)]
pub(super) struct Filling {
    /// Of the loop.
    pub(super) corners: Vec<Corner>,
    /// The triangles that were found, by their vertices; where those within the loop are; and the least cosine between a triangle's
    /// direction and the loop's.
    triangles: Vec<[u32; 3]>,
    inner: Vec<DVec3>,
    least_cosine: f64,
    /// A loop with a bridge to a vertex within it, or to another loop.
    bridged: Vec<Corner>,
    found: PolygonTriangles,
    sides: Vec<[u32; 2]>,
}

impl Filling {
    /// Forgets what was found before.
    fn begin(&mut self) {
        self.triangles.clear();
        self.inner.clear();
        self.least_cosine = f64::NEG_INFINITY;
    }

    /// Finds triangles of the loop's corners, as far as can be well shaped and facing as the loop does. `false` if there are none, or some
    /// face so differently that vertices within the loop may help.
    pub(super) fn find(&mut self, kind: &Divided) -> bool {
        self.begin();
        self.bridged.clear();
        self.bridged.extend_from_slice(&self.corners);
        self.try_bridged(kind, &[]);
        self.least_cosine >= LEAST_COSINE
    }

    /// Tries the same with up to two vertices within the loop.
    pub(super) fn find_round(&mut self, kind: &Divided, inner: &[DVec3]) {
        let n = self.corners.len();
        let mut nearest: [Vec<usize>; MOST_NEW] = Default::default();
        for (nearest, position) in nearest.iter_mut().zip(inner) {
            let squared = |i: &usize| self.corners[*i].position.distance_squared(*position);
            nearest.extend(0..n);
            nearest.sort_by(|a, b| squared(a).total_cmp(&squared(b)));
            nearest.truncate(BRIDGES);
        }
        let [first, second] = &nearest;
        for &i in first {
            for j in second.iter().map(Some).chain(second.is_empty().then_some(None)) {
                // From the corner with the first bridge once round.
                self.bridged.clear();
                for k in (i..n).chain(0..=i) {
                    self.bridged.push(self.corners[k]);
                    if Some(&k) == j && self.bridged.len() <= n {
                        self.bridged.push(Corner::new(1, inner[1]));
                        self.bridged.push(self.corners[k]);
                    }
                }
                self.bridged.push(Corner::new(0, inner[0]));
                self.try_bridged(kind, inner);
            }
        }
    }

    /// Finds triangles of a band between the loop and another one, if need be with a vertex at one of some places. `false` if there are none.
    pub(super) fn find_band(&mut self, kind: &Divided, other: &[Corner], places: &[DVec3]) -> bool {
        self.begin();
        self.try_bands(kind, other, None);
        if self.least_cosine < LEAST_COSINE {
            places.iter().for_each(|&place| self.try_bands(kind, other, Some(place)));
        }
        self.has_found()
    }

    fn try_bands(&mut self, kind: &Divided, other: &[Corner], inner: Option<DVec3>) {
        for (j, end) in other.iter().enumerate() {
            let squared = |corner: &Corner| corner.position.distance_squared(end.position);
            let may = self.corners.iter().enumerate().filter(|(_, corner)| corner.may_join(end, kind));
            let Some((i, _)) = may.min_by(|a, b| squared(a.1).total_cmp(&squared(b.1))) else { continue };
            self.bridged.clear();
            self.bridged.extend_from_slice(&self.corners[i..]);
            self.bridged.extend_from_slice(&self.corners[..=i]);
            self.bridged.extend_from_slice(&other[j..]);
            self.bridged.extend_from_slice(&other[..=j]);
            let Some(place) = inner else {
                self.try_bridged(kind, &[]);
                continue;
            };
            for k in 0..self.corners.len() + other.len() + 2 {
                // A bridge from each corner to the vertex and back.
                let corner = self.bridged[k];
                self.bridged.splice(k + 1..k + 1, [Corner::new(0, place), corner]);
                self.try_bridged(kind, &[place]);
                self.bridged.drain(k + 1..k + 3);
            }
        }
    }

    /// Takes all triangles from the loop's sides to a vertex within it.
    pub(super) fn take_fan(&mut self, centre: DVec3) {
        self.begin();
        self.inner.push(centre);
        let centre = Corner::new(0, centre).vertex;
        let next = self.corners.iter().cycle().skip(1);
        self.triangles
            .extend(self.corners.iter().zip(next).map(|(one, two)| [one.vertex, two.vertex, centre]));
    }

    /// Whether triangles were found.
    pub(super) fn has_found(&self) -> bool {
        !self.triangles.is_empty()
    }

    /// Where the vertices within the loop are.
    pub(super) fn inner(&self) -> &[DVec3] {
        &self.inner
    }

    /// The triangles that were found. Vertices within the loop have these numbers.
    pub(super) fn triangles(&self, inner: [u32; MOST_NEW]) -> impl Iterator<Item = [u32; 3]> {
        let number = move |v: u32| v.checked_sub(FIRST_NEW).map_or(v, |i| inner[i as usize]);
        self.triangles.iter().map(move |triangle| triangle.map(number))
    }

    /// Finds triangles of `bridged`, and takes them if they face as the loop does more than those that were found before.
    fn try_bridged(&mut self, kind: &Divided, new: &[DVec3]) {
        let Self { bridged: corners, found, triangles, inner, least_cosine, sides, .. } = self;
        let facing = area(corners).normalize_or_zero();
        let of = |triangle: [u8; 3]| triangle.map(|i| &corners[usize::from(i)]);
        let cosine = |triangle: [&Corner; 3]| {
            let [a, b, c] = triangle.map(|corner| corner.position);
            (b - a).cross(c - a).normalize_or_zero().dot(facing)
        };
        let may_join = |i: usize, j: usize| corners[i].may_join(&corners[j], kind);
        let cost = |triangle: [u8; 3]| {
            let triangle = of(triangle);
            let off = 0.5 - 0.5 * cosine(triangle);
            let is_flat = triangle.iter().fold(!0, |common, corner| common & corner.sides(kind)) != 0;
            let shape = 1.0 - radius_ratio(triangle.map(|corner| corner.position.to_array()));
            off * off * AGAINST + if is_flat { FLAT } else { 0.0 } + shape
        };
        if found.find(corners.len(), may_join, cost).is_none() {
            return;
        }
        let least = found.triangles().iter().map(|&triangle| cosine(of(triangle))).fold(1.0, f64::min);
        if least <= *least_cosine && !triangles.is_empty() {
            return;
        }
        // Corners that are there twice must not have a diagonal twice.
        sides.clear();
        for triangle in found.triangles() {
            let [a, b, c] = of(*triangle).map(|corner| corner.vertex);
            sides.extend([[a, b], [b, c], [c, a]]);
        }
        sides.sort_unstable();
        if sides.windows(2).any(|pair| pair[0] == pair[1]) {
            return;
        }
        triangles.clear();
        triangles.extend(found.triangles().iter().map(|&triangle| of(triangle).map(|c| c.vertex)));
        inner.clear();
        inner.extend_from_slice(new);
        *least_cosine = least;
    }

    /// The mean of the loop's corners.
    pub(super) fn mean(&self) -> DVec3 {
        self.corners.iter().map(|corner| corner.position).sum::<DVec3>() / self.corners.len() as f64
    }

    /// The direction that the loop faces.
    pub(super) fn facing(&self) -> Option<DVec3> {
        area(&self.corners).try_normalize()
    }
}

/// The vector area of a loop, which is that of all surfaces that fill it.
fn area(corners: &[Corner]) -> DVec3 {
    let first = corners[0].position;
    corners.windows(2).map(|pair| (pair[0].position - first).cross(pair[1].position - first)).sum()
}
