//! Vertices of a window moved as those of the whole mesh would be, as far as that is certain.
//!
//! In the whole mesh a vertex stays where it is if one of its triangles would turn over ([`Moves`]); that is decided
//! triangle by triangle, and one that stays can make its neighbours stay. A window lacks triangles at its rim. So each
//! vertex there is *open*: it may stay or not. A triangle with open corners is tried with either. Where the outcome is
//! always the same, which is nearly everywhere, its other corners are as certain as before; where not, they are open too.
//! What is not open at the end is as in the whole mesh, to the bit.

use std::collections::TryReserveError;

use crate::lattice::{CellBox, Lattice};
use crate::memory::refill;
use crate::placement::{MOST_PASSES, Moves, on_box};
use crate::surface::trace::Trace;
use glam::Vec3;

/// A vertex that is moved is followed so many cells from the chunk, where its neighbours decide whether it may be.
pub(super) const MOST_EXTRA: u32 = 64;

/// Room to work in.
#[derive(Debug, Default)]
pub(super) struct Settled {
    stays: Vec<bool>,
    open: Vec<bool>,
}

impl Settled {
    /// Moves the vertices of a window to `targets`, which are right for all vertices of triangles in `known`, and for all
    /// vertices of their triangles. `false` if that leaves a vertex of a triangle in `wanted` open; some have moved then.
    pub(super) fn advance(
        &mut self,
        (positions, triangles, trace): (&mut [Vec3], &[[u32; 3]], &Trace),
        targets: &[Vec3],
        window: &Lattice,
        [known, wanted]: [CellBox; 2],
    ) -> Result<bool, TryReserveError> {
        let Self { stays, open } = self;
        let seen = window.cell_box();
        let bounds = window.bounds();
        open.clear();
        refill(open, positions.len(), true)?;
        for (triangle, &cell) in triangles.iter().zip(&trace.cells) {
            if known.contains(seen.cell(cell)) {
                triangle.iter().for_each(|&v| open[v as usize] = false);
            }
        }
        stays.clear();
        stays.try_reserve_exact(positions.len())?;
        stays.extend(positions.iter().zip(targets).map(|(p, to)| on_box(p, &bounds) || !to.is_finite()));
        for pass in 0.. {
            let mut changed = false;
            for triangle in triangles {
                let corners = triangle.map(|v| v as usize);
                // What has been decided for all corners, or for none, is not looked at.
                if corners.iter().all(|&v| stays[v] || open[v]) {
                    continue;
                }
                let is_open = corners.map(|v| open[v]);
                let before = corners.map(|v| positions[v]);
                let to = corners.map(|v| targets[v]);
                let (mut refused, mut passed) = (false, false);
                for case in 0..8 {
                    let at = |k: usize| if is_open[k] { case >> k & 1 != 0 } else { stays[corners[k]] };
                    let is_case = (0..3).all(|k| is_open[k] || case >> k & 1 == 0);
                    if is_case {
                        let stay = [at(0), at(1), at(2)];
                        if Moves::is_refused(before, before, to, stay) {
                            refused = true
                        } else {
                            passed = true
                        }
                    }
                }
                if !refused {
                    continue;
                }
                for v in corners {
                    if !stays[v] && !open[v] {
                        *(if passed { &mut open[v] } else { &mut stays[v] }) = true;
                        changed = true;
                    }
                }
            }
            if !changed {
                break;
            }
            if pass == MOST_PASSES {
                return Ok(false);
            }
        }
        let is_certain = triangles
            .iter()
            .zip(&trace.cells)
            .filter(|(_, cell)| wanted.contains(seen.cell(**cell)))
            .all(|(triangle, _)| triangle.iter().all(|&v| !open[v as usize]));
        for (v, p) in positions.iter_mut().enumerate() {
            if !stays[v] && !open[v] {
                *p = targets[v];
            }
        }
        Ok(is_certain)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Arrangement;
    use isostudy_mesh::Bounds;

    /// A strip of triangles along x, two in each cell: vertices `2 i` at `y = 0`, `2 i + 1` at `y = 1`.
    fn strip(cells: u32) -> (Vec<Vec3>, Vec<[u32; 3]>, Trace, Lattice) {
        let positions = (0..=cells).flat_map(|i| [0.0, 1.0].map(|y| Vec3::new(i as f32, y, 0.5))).collect();
        let triangles = (0..cells)
            .flat_map(|i| [[2 * i, 2 * i + 2, 2 * i + 1], [2 * i + 2, 2 * i + 3, 2 * i + 1]])
            .collect();
        let trace = Trace { cells: (0..cells).flat_map(|i| [i, i]).collect(), ..Trace::default() };
        let bounds = Bounds { min: Vec3::splat(-9.0), max: Vec3::splat(99.0) };
        let whole = Lattice::try_new(Arrangement::SimpleCubic, bounds, 1.0).unwrap();
        let end = [cells as i32, 1, 1];
        (positions, triangles, trace, whole.window(CellBox { start: [0; 3], end }).unwrap())
    }

    fn cells(from: i32, to: i32) -> CellBox {
        CellBox { start: [from, 0, 0], end: [to, 1, 1] }
    }

    #[test]
    fn a_part_moves_as_the_whole_does_where_it_says_so() {
        let mut certain = 0;
        for seed in 0..400u32 {
            let (positions, triangles, trace, window) = strip(20);
            let number = |i: usize| {
                let hash = (seed.wrapping_mul(0x9e37_79b9) ^ i as u32).wrapping_mul(0x85eb_ca6b);
                (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35) as f32 / u32::MAX as f32 - 0.5
            };
            // Far enough that many triangles would turn over.
            let target =
                |(i, p): (usize, &Vec3)| *p + Vec3::new(1.3 * number(2 * i), 0.7 * number(2 * i + 1), 0.0);
            let targets: Vec<Vec3> = positions.iter().enumerate().map(target).collect();
            let mut whole = positions.clone();
            Moves::start(&positions)
                .unwrap()
                .advance(&mut whole, &targets, &triangles, &window.bounds())
                .unwrap();
            // The same, of which only the cells from 5 to 15 are known; beyond them targets are wrong, too.
            let mut wrong = targets.clone();
            for v in (0..8).chain(34..42) {
                wrong[v] = positions[v] + Vec3::new(5.0 * number(v + 77), 3.0, 0.0);
            }
            let mut part = positions.clone();
            let (known, wanted) = (cells(5, 15), cells(7, 13));
            let mesh = (&mut part[..], &triangles[..], &trace);
            let told = Settled::default().advance(mesh, &wrong, &window, [known, wanted]).unwrap();
            if told {
                certain += 1;
                assert_eq!(part[14..28], whole[14..28], "{seed}");
            }
        }
        assert!((100..400).contains(&certain), "{certain}: both happen");
    }
}
