//! Label pass: which points the surface is drawn to, and along which of their edges.

use std::collections::TryReserveError;

use super::super::grid::CubeGrid;
use super::super::sampling::{Near, Samples};
use crate::memory::reset;
use crate::sampling::in_sight::{State, Values};
use crate::sampling::rows::{Rows, before, next};

/// Layers in sight: of a cell, the two of its corners, and one more on either side.
const SLOTS: usize = 4;
/// The way of a point that equals the isovalue: nowhere.
const HERE: u8 = 6;
/// From a point to its neighbours, the lowest number first: axis, and whether it is the next one.
const WAYS: [(usize, bool); 6] = [(2, false), (1, false), (0, false), (0, true), (1, true), (2, true)];

/// A few layers of labels. What is neither inside nor on the surface is outside.
#[derive(Default)]
pub(super) struct Labels {
    pub(super) inside: Rows,
    pub(super) on: Rows,
    /// Of points on the surface.
    ways: Vec<u8>,
    states: Vec<State>,
    size: [usize; 3],
}

impl Labels {
    /// Makes room, with all points outside.
    pub(super) fn fit(&mut self, grid: &CubeGrid) -> Result<(), TryReserveError> {
        let [nx, ny, _] = grid.size;
        self.size = grid.size;
        self.inside.fit(grid.words, grid.size[1], SLOTS)?;
        self.on.fit(grid.words, grid.size[1], SLOTS)?;
        reset(&mut self.ways, nx * ny * SLOTS, HERE)?;
        reset(&mut self.states, ny * SLOTS, State::Outside)
    }

    /// Whether all points of some rows are inside, or all outside.
    #[inline]
    pub(super) fn is_uniform(&self, rows: &[[usize; 2]]) -> bool {
        let state = |[y, z]: [usize; 2]| self.states[z % SLOTS * self.size[1] + y];
        let first = state(rows[0]);
        first != State::Mixed && rows.iter().all(|&row| state(row) == first)
    }

    /// Whether a point is outside; beyond the grid all are.
    pub(super) fn is_outside(&self, place: [Option<usize>; 3]) -> bool {
        let [Some(x), Some(y), Some(z)] = place else { return true };
        if x >= self.size[0] || y >= self.size[1] || z >= self.size[2] {
            return true;
        }
        let bit = |rows: &Rows| rows.row(y, z)[x / 64] >> (x % 64) & 1;
        bit(&self.inside) | bit(&self.on) == 0
    }

    /// The edge whose crossing a point on the surface stands for: where it begins, and its axis. `None` where the point's own
    /// sample equals the isovalue.
    pub(super) fn edge(&self, [x, y, z]: [usize; 3]) -> Option<([usize; 3], usize)> {
        let way = self.ways[(z % SLOTS * self.size[1] + y) * self.size[0] + x];
        let &(axis, is_next) = WAYS.get(usize::from(way))?;
        let mut from = [x, y, z];
        from[axis] -= usize::from(!is_next);
        Some((from, axis))
    }

    /// Labels a layer. Of the layers next to it, sides and samples are known.
    pub(super) fn find(
        &mut self,
        grid: &CubeGrid,
        samples: &Samples,
        values: Values,
        snap: Snap,
        layer: usize,
    ) {
        let [nx, ny, nz] = grid.size;
        let near_layers = [layer.saturating_sub(1), layer, (layer + 1).min(nz - 1)];
        let states = near_layers.map(|layer| samples.states(layer));
        for row in 0..ny {
            let sides = &samples.sides.row(row, layer)[..grid.words];
            self.inside.row_mut(row, layer).copy_from_slice(sides);
            self.on.row_mut(row, layer).fill(0);
            let (here, rows) = (states[1][row], row.saturating_sub(1)..ny.min(row + 2));
            let is_like_it = |states: &[State]| states[rows.clone()].iter().all(|&state| state == here);
            if here == State::Mixed || !states.into_iter().all(is_like_it) {
                let near = Near::new(grid, [row, layer], true);
                let around = Around::new(grid, samples, values, [row, layer]);
                let ways = &mut self.ways[(layer % SLOTS * ny + row) * nx..][..nx];
                near.for_each_word(grid, &samples.sides, |word, wanted| {
                    let crossed = around.crossed(grid, word);
                    let (mut left, mut on) = (wanted, 0);
                    while left != 0 {
                        let bit = left.trailing_zeros();
                        left &= left - 1;
                        let x = 64 * word + bit as usize;
                        let way = if around.here[x] == snap.isovalue {
                            Some(HERE)
                        } else {
                            let ways =
                                (0..WAYS.len()).fold(0, |set, way| set | (crossed[way] >> bit & 1) << way);
                            snap.way(&around, x, ways)
                        };
                        // A wall drawn onto the box would be the box, and the mesh open there.
                        let Some(way) = way.filter(|_| !is_wall(grid, samples, [x, row, layer])) else {
                            continue;
                        };
                        on |= 1 << bit;
                        ways[x] = way;
                    }
                    self.on.row_mut(row, layer)[word] = on;
                    self.inside.row_mut(row, layer)[word] &= !on;
                });
            }
            let is_on = self.on.row(row, layer).iter().any(|&on| on != 0);
            let state = if is_on { State::Mixed } else { State::of(sides, !0, nx) };
            self.states[layer % SLOTS * ny + row] = state;
        }
    }
}

/// A row of points, and those that edges lead to from it, by [`WAYS`]. Beyond the grid there is the row itself, to which none leads.
struct Around<'a> {
    sides: &'a [u64],
    here: &'a [f32],
    others: [(&'a [u64], &'a [f32]); WAYS.len()],
}

impl<'a> Around<'a> {
    fn new(grid: &CubeGrid, samples: &'a Samples, values: Values<'a>, [row, layer]: [usize; 2]) -> Self {
        let at = |y, z| (samples.sides.row(y, z), values.row(y, z));
        let (sides, here) = at(row, layer);
        let others = WAYS.map(|(axis, is_next)| {
            let moved = |from: usize, size: usize| match is_next {
                true => (from + 1).min(size - 1),
                false => from.saturating_sub(1),
            };
            match axis {
                0 => (sides, here),
                1 => at(moved(row, grid.size[1]), layer),
                _ => at(row, moved(layer, grid.size[2])),
            }
        });
        Self { sides, here, others }
    }

    /// The points of a word from which an edge leads to the other side, by way.
    fn crossed(&self, grid: &CubeGrid, word: usize) -> [u64; WAYS.len()] {
        let mut way = 0;
        self.others.map(|(sides, _)| {
            let there = match WAYS[way] {
                (0, true) => next(sides, word) & grid.with_next(word) | sides[word] & !grid.with_next(word),
                (0, false) => before(sides, word),
                _ => sides[word],
            };
            way += 1;
            self.sides[word] ^ there
        })
    }

    /// The sample that a way leads to from a column.
    #[inline]
    fn other(&self, x: usize, way: usize) -> f32 {
        let values = self.others[way].1;
        match WAYS[way] {
            (0, true) => values[x + 1],
            (0, false) => values[x - 1],
            _ => values[x],
        }
    }
}

/// When crossings are drawn to a point.
#[derive(Clone, Copy)]
pub(super) struct Snap {
    pub(super) isovalue: f32,
    /// How near they must be, in lengths of the edge.
    pub(super) gamma: f32,
}

impl Snap {
    /// Along which of its crossed edges, a bit each, the point of a column is drawn, the one with the nearest crossing, if there is one near
    /// enough.
    #[inline]
    fn way(self, around: &Around, x: usize, mut crossed: u64) -> Option<u8> {
        let (isovalue, gamma) = (f64::from(self.isovalue), f64::from(self.gamma));
        let value = f64::from(around.here[x]);
        let to_level = (isovalue - value).abs();
        let (mut nearest, mut found) = (f64::INFINITY, None);
        while crossed != 0 {
            let way = crossed.trailing_zeros() as usize;
            crossed &= crossed - 1;
            let is_next = WAYS[way].1;
            let other = around.other(x, way);
            if other == self.isovalue {
                continue;
            }
            let length = (f64::from(other) - value).abs();
            // Most are too far by more than a division can err.
            if to_level > gamma * length * (1.0 + 1e-12) {
                continue;
            }
            let own = to_level / length;
            // The lower end is asked first.
            let is_free = is_next || {
                let others = (isovalue - f64::from(other)).abs() / length;
                others > gamma || others.is_nan()
            };
            if own <= gamma && is_free && own < nearest {
                (nearest, found) = (own, Some(way as u8));
            }
        }
        found
    }
}

/// Whether a point lies on a side of the box with nothing inside next to it on that side. A patch through it would lie in the side,
/// where no cell has one, and a solid that ends there would be open.
#[inline]
fn is_wall(grid: &CubeGrid, samples: &Samples, place: [usize; 3]) -> bool {
    let is_side = |axis: usize| place[axis] == 0 || place[axis] + 1 == grid.size[axis];
    (0..3).any(is_side) && !has_inside_beside(grid, samples, place, is_side)
}

/// Whether a point next to it, on one of the same sides, is inside.
#[cold]
fn has_inside_beside(
    grid: &CubeGrid,
    samples: &Samples,
    place: [usize; 3],
    is_side: impl Fn(usize) -> bool,
) -> bool {
    let near = |axis: usize| place[axis].saturating_sub(1)..grid.size[axis].min(place[axis] + 2);
    let is_inside = |[x, y, z]: [usize; 3]| samples.sides.row(y, z)[x / 64] >> (x % 64) & 1 != 0;
    let mut around = near(2).flat_map(|z| near(1).flat_map(move |y| near(0).map(move |x| [x, y, z])));
    around.any(|there| (0..3).any(|axis| is_side(axis) && there[axis] == place[axis]) && is_inside(there))
}
