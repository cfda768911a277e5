//! One cell: which of its corners are joined on its surface, and which through its inside.

use std::cmp::Ordering;

use crate::number::{Differences, Fraction, Quadratic, Whole};
use crate::samples::Ties;

/// The corners of the cell's faces, round each; corner `i` is at `(i & 1, i >> 1 & 1, i >> 2)`.
const FACES: [[usize; 4]; 6] =
    [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]];

/// The corners of the cell's edges.
pub(crate) const EDGES: [[usize; 2]; 12] =
    [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

/// The surface in one cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CellTopology {
    /// Closed curves on the surface of the cell.
    pub loops: u32,
    /// Connected pieces of surface, each a sphere with as many holes as it has loops.
    pub pieces: u32,
    /// Loops less pieces: 1 where two loops are joined by a tube, and never more.
    pub tunnels: u32,
}

/// The corners of a cell by region: each has the lowest corner of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Regions {
    pub(crate) on_surface: [u8; 8],
    pub(crate) in_solid: [u8; 8],
}

/// The topology of the trilinear level set in one cell, corner `i` at `(i & 1, i >> 1 & 1, i >> 2)`.
///
/// # Panics
/// If a value is not finite.
pub fn cell_topology(values: [f32; 8], isovalue: f32, ties: Ties) -> CellTopology {
    assert!(values.iter().chain([&isovalue]).all(|v| v.is_finite()), "samples are finite");
    let (values, isovalue) = oriented(values, isovalue, ties);
    let Regions { on_surface, in_solid } = regions(values, isovalue);
    let count = |region: [u8; 8]| (0..8u8).filter(|&c| region[usize::from(c)] == c).count() as u32;
    let (loops, pieces) = (count(on_surface) - 1, count(in_solid) - 1);
    CellTopology { loops, pieces, tunnels: loops - pieces }
}

/// Turned round if need be, so that what equals the isovalue is outside.
pub(crate) fn oriented(values: [f32; 8], isovalue: f32, ties: Ties) -> ([f32; 8], f32) {
    match ties {
        Ties::Outside => (values, isovalue),
        Ties::Inside => (values.map(|v| -v), -isovalue),
    }
}

/// The regions of a cell. A value above the isovalue is inside.
pub(crate) fn regions(values: [f32; 8], isovalue: f32) -> Regions {
    match Differences::new(values, isovalue) {
        Differences::Short(differences) => exact_regions(&differences),
        Differences::Long(differences) => exact_regions(&differences),
    }
}

fn exact_regions<W: Whole>(values: &[W; 8]) -> Regions {
    let inside: [bool; 8] = std::array::from_fn(|c| values[c].sign() == Ordering::Greater);
    let mut surface = Joined::new();
    for [a, b] in EDGES {
        if inside[a] == inside[b] {
            surface.join(a, b);
        }
    }
    let mut solid = surface;
    let ambiguous = |[a, b, c, d]: &[usize; 4]| {
        inside[*a] == inside[*c] && inside[*b] == inside[*d] && inside[*a] != inside[*b]
    };
    for [a, b, c, d] in FACES.into_iter().filter(ambiguous) {
        let [a, b, c, d] = if inside[a] { [a, b, c, d] } else { [b, c, d, a] };
        let product = |p: usize, q: usize| values[p].clone() * values[q].clone();
        // The inside corners are a and c.
        if product(a, c) > product(b, d) { surface.join(a, c) } else { surface.join(b, d) }
    }
    join_through_slices(values, &inside, &mut solid);
    Regions { on_surface: surface.regions(), in_solid: solid.regions() }
}

/// Part of an upright edge that is on one side; `corner` is the one that it ends at.
struct Segment<W> {
    corner: usize,
    from: Fraction<W>,
    to: Fraction<W>,
}

/// Joins what is joined in any slice of the cell. What is inside is open, what is outside is closed: so it is for a level
/// raised by less than any number.
fn join_through_slices<W: Whole>(values: &[W; 8], inside: &[bool; 8], joined: &mut Joined) {
    // Round the slice.
    const COLUMNS: [[usize; 2]; 4] = [[0, 4], [1, 5], [3, 7], [2, 6]];
    let lines = COLUMNS.map(|column| column.map(|c| values[c].clone()));
    for side in [true, false] {
        let segments: [Vec<Segment<W>>; 4] =
            std::array::from_fn(|k| segments(COLUMNS[k], &lines[k], inside, side));
        let meeting = |k: usize, l: usize| {
            let (ours, theirs) = (&segments[k], &segments[l]);
            let pairs = ours.iter().flat_map(move |p| theirs.iter().map(move |q| (p, q)));
            pairs.filter_map(move |(p, q)| {
                let from = if p.from.compare(&q.from) == Ordering::Less { &q.from } else { &p.from };
                let to = if p.to.compare(&q.to) == Ordering::Greater { &q.to } else { &p.to };
                let order = from.compare(to);
                let is_there = order == Ordering::Less || (order == Ordering::Equal && !side);
                is_there.then_some((p.corner, q.corner, from, to))
            })
        };
        for k in 0..4 {
            for (p, q, ..) in meeting(k, (k + 1) % 4) {
                joined.join(p, q);
            }
        }
        for k in [0, 1] {
            for (p, q, from, to) in meeting(k, k + 2) {
                if joined.is_joined(p, q) {
                    continue;
                }
                let around = [&lines[k], &lines[k + 1], &lines[k + 2], &lines[(k + 3) % 4]];
                let largest = Quadratic::of_lines(around).largest_sign(from, to);
                if largest == Ordering::Greater || (largest == Ordering::Equal && !side) {
                    joined.join(p, q);
                }
            }
        }
    }
}

/// The parts of an upright edge that are on a side: none, one, or the whole, which counts as its lower corner's.
fn segments<W: Whole>(
    [low, high]: [usize; 2],
    [at_low, at_high]: &[W; 2],
    inside: &[bool; 8],
    side: bool,
) -> Vec<Segment<W>> {
    let [zero, one] = [0, 1].map(Fraction::whole);
    match (inside[low] == side, inside[high] == side) {
        (true, true) => vec![Segment { corner: low, from: zero, to: one }],
        (true, false) => vec![Segment { corner: low, from: zero, to: Fraction::root(at_low, at_high) }],
        (false, true) => vec![Segment { corner: high, from: Fraction::root(at_low, at_high), to: one }],
        (false, false) => Vec::new(),
    }
}

/// Corners that belong together.
#[derive(Debug, Clone, Copy)]
struct Joined([u8; 8]);

impl Joined {
    fn new() -> Self {
        Self(std::array::from_fn(|c| c as u8))
    }

    fn is_joined(&self, a: usize, b: usize) -> bool {
        self.0[a] == self.0[b]
    }

    fn join(&mut self, a: usize, b: usize) {
        let [a, b] = [self.0[a], self.0[b]];
        let (low, high) = (a.min(b), a.max(b));
        for name in &mut self.0 {
            if *name == high {
                *name = low;
            }
        }
    }

    fn regions(self) -> [u8; 8] {
        self.0
    }
}
