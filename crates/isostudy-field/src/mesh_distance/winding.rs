//! The winding number of a closed surface around a point, counted along the ray towards +x.
//!
//! Triangles that the ray crosses outward count +1, inward -1. All that is decided at an edge is decided from that
//! edge alone, by an expression that only changes its sign when the edge is run the other way, and borders belong
//! to one side (half-open). So a ray through an edge or a vertex is counted once, never twice or not at all, and
//! there is no unlucky direction.

use glam::{DVec3, Vec3};

/// Triangles by the cell of a grid in the (y, z) plane that their shadow may touch.
#[derive(Debug, Clone)]
pub(super) struct WindingColumns {
    triangles: Vec<[Vec3; 3]>,
    y: Axis,
    z: Axis,
    /// Where each cell's part of `members` starts; one more than there are cells.
    starts: Vec<u32>,
    members: Vec<u32>,
}

/// Equal cells along one axis.
#[derive(Debug, Clone, Copy)]
struct Axis {
    low: f64,
    high: f64,
    cells: usize,
    per_unit: f64,
}

impl Axis {
    fn new(low: f64, high: f64, cells: usize) -> Self {
        Self { low, high, cells, per_unit: cells as f64 / (high - low).max(f64::MIN_POSITIVE) }
    }

    /// Monotone in `v`, hence a value between two others has a cell between theirs.
    fn cell(&self, v: f64) -> usize {
        (((v - self.low) * self.per_unit) as usize).min(self.cells - 1)
    }

    fn holds(&self, v: f64) -> bool {
        self.low <= v && v <= self.high
    }
}

impl WindingColumns {
    /// Of at least one triangle with finite corners, together a closed surface.
    pub(super) fn new(triangles: Vec<[Vec3; 3]>) -> Self {
        let corners = triangles.iter().flatten().map(|p| p.as_dvec3());
        let (low, high) =
            corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        // About as many cells as triangles, and as square as may be.
        let size = (high - low).max(DVec3::splat(f64::MIN_POSITIVE));
        let along_y = (triangles.len() as f64 * size.y / size.z).sqrt().clamp(1.0, triangles.len() as f64);
        let cells_y = along_y.ceil() as usize;
        let cells_z = triangles.len().div_ceil(cells_y);
        let (y, z) = (Axis::new(low.y, high.y, cells_y), Axis::new(low.z, high.z, cells_z));
        let mut columns =
            Self { triangles, y, z, starts: vec![0; cells_y * cells_z + 1], members: Vec::new() };
        columns.fill();
        columns
    }

    pub(super) fn triangles(&self) -> &[[Vec3; 3]] {
        &self.triangles
    }

    /// A counting sort: sizes, then starts, then members in triangle order.
    fn fill(&mut self) {
        let touched: Vec<_> = self.triangles.iter().map(|t| self.cells_of(t)).collect();
        for cell in touched.iter().flat_map(|t| t.cells(self.y.cells)) {
            self.starts[cell + 1] += 1;
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        let mut next = self.starts.clone();
        self.members = vec![0; self.starts[self.starts.len() - 1] as usize];
        for (t, range) in touched.iter().enumerate() {
            for cell in range.cells(self.y.cells) {
                self.members[next[cell] as usize] = t as u32;
                next[cell] += 1;
            }
        }
    }

    fn cells_of(&self, [a, b, c]: &[Vec3; 3]) -> CellRange {
        let (low, high) = (a.min(*b).min(*c).as_dvec3(), a.max(*b).max(*c).as_dvec3());
        CellRange {
            y: [self.y.cell(low.y), self.y.cell(high.y)],
            z: [self.z.cell(low.z), self.z.cell(high.z)],
        }
    }

    /// The winding number around `p`, which must be finite.
    pub(super) fn at(&self, p: Vec3) -> i32 {
        let q = p.as_dvec3();
        if !self.y.holds(q.y) || !self.z.holds(q.z) {
            return 0;
        }
        let cell = self.z.cell(q.z) * self.y.cells + self.y.cell(q.y);
        let members = &self.members[self.starts[cell] as usize..self.starts[cell + 1] as usize];
        members.iter().map(|&t| crossing(&self.triangles[t as usize], p)).sum()
    }
}

/// The cells from first to last on both axes.
struct CellRange {
    y: [usize; 2],
    z: [usize; 2],
}

impl CellRange {
    fn cells(&self, cells_y: usize) -> impl Iterator<Item = usize> {
        let [first, last] = self.y;
        (self.z[0]..=self.z[1]).flat_map(move |z| (first..=last).map(move |y| z * cells_y + y))
    }
}

/// How the ray from `p` towards +x crosses a triangle: 1 outward, -1 inward, 0 not at all.
fn crossing(triangle: &[Vec3; 3], p: Vec3) -> i32 {
    // Most triangles of a cell end here: all to one side in z or y, or behind.
    let [a, b, c] = triangle;
    let above = [a.z > p.z, b.z > p.z, c.z > p.z];
    if above == [true; 3] || above == [false; 3] || a.x.max(b.x).max(c.x) < p.x {
        return 0;
    }
    // Differences of single-precision numbers of like size are exact in double precision, and so are their products.
    let [a, b, c] = triangle.map(|corner| corner.as_dvec3() - p.as_dvec3());
    let shadow =
        turn(a, b, above[0], above[1]) + turn(b, c, above[1], above[2]) + turn(c, a, above[2], above[0]);
    // Six times the volume of the tetrahedron over the triangle with its tip at `p`: positive behind the face.
    if shadow != 0 && f64::from(shadow) * a.dot(b.cross(c)) > 0.0 { shadow } else { 0 }
}

/// An edge's part in the winding of a shadow around the origin of the (y, z) plane: 1 if it crosses the ray
/// towards +y upward, -1 downward.
fn turn(a: DVec3, b: DVec3, a_above: bool, b_above: bool) -> i32 {
    if a_above == b_above {
        return 0;
    }
    let left = a.y * b.z - a.z * b.y;
    match b_above {
        true if left > 0.0 => 1,
        false if left < 0.0 => -1,
        _ => 0,
    }
}
