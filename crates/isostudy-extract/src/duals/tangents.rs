//! Crossings as the field has them, with its normals there: each asked for once.

use glam::{DVec3, Vec3};

use crate::cubes::grid::CubeGrid;
use crate::sampling::bracket::Bracket;
use crate::sampling::level::Level;

/// The root search may call the field so often; a crease between the ends takes most.
const MOST_CALLS: usize = 24;
/// And knows the root to this fraction of the edge.
const TOLERANCE: f64 = 1e-6;

/// A crossing, and the outward unit normal of the field there, if it has one.
pub(crate) type Tangent = (DVec3, Option<DVec3>);

/// By layer, even or odd.
pub(super) type Known = [Layer; 2];

/// The tangents of the edges that begin in a layer of points.
#[derive(Default)]
pub(super) struct Layer {
    /// Of each edge the number of its tangent, counted from 1; 0 where it is not known.
    numbers: Vec<u32>,
    /// The edges that are known, in the order of `tangents`.
    edges: Vec<usize>,
    tangents: Vec<Tangent>,
}

impl Layer {
    /// Forgets all, in the time that it took to know them.
    pub(super) fn clear(&mut self) {
        self.edges.drain(..).for_each(|edge| self.numbers[edge] = 0);
        self.tangents.clear();
    }

    /// That of an edge of so many, made if it is not known.
    fn entry(&mut self, edge: usize, edges: usize, make: impl FnOnce() -> Tangent) -> Tangent {
        // For the whole layer at once: a later one whose surface lies elsewhere allocates nothing.
        if self.numbers.len() < edges {
            self.numbers.resize(edges, 0);
        }
        if let Some(known) = self.numbers[edge].checked_sub(1) {
            return self.tangents[known as usize];
        }
        let made = make();
        self.tangents.push(made);
        self.edges.push(edge);
        self.numbers[edge] = self.tangents.len() as u32;
        made
    }
}

/// The crossings of two layers of points.
pub(super) struct Tangents<'a> {
    level: Level<'a>,
    known: &'a mut Known,
}

impl<'a> Tangents<'a> {
    /// For the cells of layer `z`, the points above which are new.
    pub(super) fn new(level: Level<'a>, known: &'a mut Known, z: usize) -> Self {
        known[(z + 1) % 2].clear();
        Self { level, known }
    }

    /// The crossing of the edge that begins at a point, with the samples at its ends.
    pub(super) fn at(&mut self, grid: &CubeGrid, from: [usize; 3], axis: usize, ends: [f32; 2]) -> Tangent {
        let [x, y, z] = from;
        let level = self.level;
        let [columns, rows, _] = grid.size;
        let edge = 3 * (x + columns * y) + axis;
        self.known[z % 2].entry(edge, 3 * columns * rows, || tangent(level, grid, from, axis, ends))
    }
}

/// The same, found anew.
pub(crate) fn tangent(
    level: Level,
    grid: &CubeGrid,
    from: [usize; 3],
    axis: usize,
    ends: [f32; 2],
) -> Tangent {
    let start = grid.position(from);
    let mut edge = DVec3::ZERO;
    edge[axis] = f64::from(grid.at[axis][from[axis] + 1]) - f64::from(grid.at[axis][from[axis]]);
    let at = |ratio: f64| start.as_dvec3() + edge * ratio;
    let (ratio, near) = root(level, at, ends.map(|value| value - level.isovalue));
    let crossing = at(ratio);
    let normal = level.normal_after(crossing.as_vec3(), near).map(|normal| normal.as_dvec3());
    (crossing, normal.filter(|normal| normal.is_finite()))
}

/// Where between two points, 0 to 1, the field has the isovalue, if it is the differences from it that are given at the points; a half if
/// one of them is not finite. A plane that is off by a little is an edge that is off by much, so this is found to the last bits. With it
/// the last point that was asked, which is near, and the value there.
fn root(level: Level, at: impl Fn(f64) -> DVec3, ends: [f32; 2]) -> (f64, Option<(Vec3, f32)>) {
    if !ends.iter().all(|end| end.is_finite()) {
        return (0.5, None);
    }
    let [low, high] = ends.map(f64::from);
    let mut bracket = Bracket::new((0.0, low), (1.0, high));
    let mut ratio = bracket.guess();
    let mut near = None;
    for _ in 0..MOST_CALLS {
        let point = at(ratio).as_vec3();
        let value = level.field.sample(point);
        let there = value - level.isovalue;
        if !there.is_finite() {
            break;
        }
        near = Some((point, value));
        bracket.narrow(ratio, f64::from(there));
        let before = std::mem::replace(&mut ratio, bracket.guess());
        if (ratio - before).abs() <= TOLERANCE || bracket.width() <= TOLERANCE {
            break;
        }
    }
    (ratio, near)
}
