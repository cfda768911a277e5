//! The net of merged cells: none of its triangles is folded.

use glam::Vec3;
use isostudy_mesh::TriangleMesh;

use super::super::quads::{Quadrilateral, is_other_better};
use super::hermite::{Hermite, point_number};
use super::merging::Merged;
use crate::cubes::grid::CubeGrid;
use crate::extraction::ExtractError;
use crate::memory::{collected, copied, filled, push};
use crate::sampling::level::Level;
use crate::source::Request;
use crate::surface::trace::Trace;

/// A triangle counts as facing the other way if it has more than this share of the squares of its sides in area.
const FLAT: f64 = 1e-4;

/// The uniform net, and cells of it that may be merged.
pub(super) struct Net<'a> {
    pub(super) level: Level<'a>,
    pub(super) grid: &'a CubeGrid<'a>,
    pub(super) hermite: &'a Hermite,
    /// Each before those in it.
    pub(super) merged: &'a [Merged],
    pub(super) quadrilaterals: &'a [Quadrilateral],
}

/// The net with some of its cells merged, in the numbers of its vertices.
pub(super) struct Simplified {
    /// By vertex, the one that stands for it: of a merged cell the first.
    stands_for: Vec<u32>,
    positions: Vec<Vec3>,
    /// By leaf, the number of the cell that it is merged in.
    cell_of: Vec<Option<usize>>,
}

/// What stands for the vertices of a uniform net.
pub(in super::super) struct Standing {
    /// By vertex, the one that stands for it.
    pub(in super::super) stands_for: Vec<u32>,
    /// Where each is.
    pub(in super::super) positions: Vec<Vec3>,
    /// The lowest point of the cell that each is in, and how many leaves long that is.
    pub(in super::super) cells: Vec<([usize; 3], usize)>,
}

impl Net<'_> {
    /// Merges the largest cells whose triangles face as the surface does at the crossing that they are round. Where one does not, the
    /// cells at it are taken apart again. A vertex that left its cell for an edge of the object may be in the way of others.
    pub(super) fn unfolded(&self, request: &Request, positions: &[Vec3]) -> Result<Simplified, ExtractError> {
        let mut leaf_of = filled(positions.len(), 0)?;
        for (i, leaf) in self.hermite.leaves.iter().enumerate() {
            leaf_of[leaf.vertices.start as usize..leaf.vertices.end as usize].fill(i as u32);
        }
        let leaf_of = |v: u32| leaf_of[v as usize] as usize;
        let mut is_divided = filled(self.merged.len(), false)?;
        // By leaf, the cell that it is merged in.
        let mut cell_of = filled(self.hermite.leaves.len(), None)?;
        let mut is_new = filled(self.hermite.leaves.len(), true)?;
        loop {
            request.control.check()?;
            cell_of.fill(None);
            let mut end = 0;
            for (number, Merged { leaves, .. }) in self.merged.iter().enumerate() {
                if leaves.start >= end && !is_divided[number] {
                    cell_of[leaves.clone()].fill(Some(number));
                    end = leaves.end;
                }
            }
            let simplified = self.simplified(positions, &cell_of)?;
            let mut folded = Vec::new();
            for of in self.quadrilaterals {
                let cells = of.corners.map(|v| cell_of[leaf_of(v)]);
                let is_new = of.corners.iter().any(|&v| is_new[leaf_of(v)]);
                if is_new && cells.iter().any(Option::is_some) && self.is_folded(*of, &simplified, leaf_of) {
                    for cell in cells.into_iter().flatten() {
                        push(&mut folded, cell)?;
                    }
                }
            }
            if folded.is_empty() {
                return Ok(simplified);
            }
            is_new.fill(false);
            for cell in folded {
                is_divided[cell] = true;
                is_new[self.merged[cell].leaves.clone()].fill(true);
            }
        }
    }

    fn simplified(&self, positions: &[Vec3], cell_of: &[Option<usize>]) -> Result<Simplified, ExtractError> {
        let mut stands_for: Vec<u32> = collected(0..positions.len() as u32)?;
        let mut positions = copied(positions)?;
        let mut leaf = 0;
        while let Some(cell) = cell_of.get(leaf) {
            let Some(cell) = *cell else {
                leaf += 1;
                continue;
            };
            let Merged { leaves, vertex, .. } = &self.merged[cell];
            let vertices = || self.hermite.leaves[leaves.clone()].iter().map(|leaf| leaf.vertices.start);
            let first = vertices().min().expect("a cell with leaves");
            vertices().for_each(|v| stands_for[v as usize] = first);
            positions[first as usize] = vertex.as_vec3();
            leaf = leaves.end;
        }
        Ok(Simplified { stands_for, positions, cell_of: copied(cell_of)? })
    }

    /// Whether a triangle faces against the surface at the crossing that a quadrilateral with merged corners is round.
    fn is_folded(&self, of: Quadrilateral, simplified: &Simplified, leaf_of: impl Fn(u32) -> usize) -> bool {
        let [low, _, from, _] = of.corners.map(|v| self.hermite.leaves[leaf_of(v)].cell);
        let axis = (0..3).find(|&axis| low[axis] == from[axis]).expect("cells round an edge");
        let Some(normal) = self.hermite.tangent(3 * point_number(self.grid, from) + axis as u64).1 else {
            return false;
        };
        let triangles = simplified.triangles(self.level, of);
        triangles.into_iter().flatten().any(|t| {
            let [a, b, c] = t.map(|v| simplified.positions[v as usize].as_dvec3());
            let [ab, ac] = [b - a, c - a];
            ab.cross(ac).dot(normal) < -FLAT * (ab.length_squared() + ac.length_squared())
        })
    }
}

impl Simplified {
    /// What is left of a quadrilateral: two triangles, one or none.
    fn triangles(
        &self,
        level: Level,
        Quadrilateral { corners, leads_out }: Quadrilateral,
    ) -> [Option<[u32; 3]>; 2] {
        let [a, b, c, d] = corners.map(|v| self.stands_for[v as usize]);
        let one = |[a, b, c]: [u32; 3]| {
            let is_any = a != b && b != c && c != a;
            [is_any.then_some(if leads_out { [a, b, c] } else { [a, c, b] }), None]
        };
        if a == b || b == c {
            return one([a, c, d]);
        }
        if c == d || d == a {
            return one([a, b, c]);
        }
        let corners = [a, b, c, d];
        let by_other = is_other_better(Some(level), corners.map(|v| self.positions[v as usize]));
        Quadrilateral { corners, leads_out }.cut(by_other).map(Some)
    }

    /// The net in boxes.
    pub(super) fn standing(self, net: &Net) -> Result<Standing, ExtractError> {
        let Self { stands_for, positions, cell_of } = self;
        let mut cells = filled(positions.len(), ([0; 3], 1))?;
        for (leaf, merged) in net.hermite.leaves.iter().zip(&cell_of) {
            let cell = match merged {
                None => (leaf.cell, 1),
                Some(number) => {
                    let Merged { low, size, .. } = net.merged[*number];
                    (low, size)
                }
            };
            cells[leaf.vertices.start as usize..leaf.vertices.end as usize].fill(cell);
        }
        Ok(Standing { stands_for, positions, cells })
    }

    /// Writes what is left of a net.
    pub(super) fn write(
        self,
        net: &Net,
        trace: &mut Trace,
        mesh: &mut TriangleMesh,
    ) -> Result<(), ExtractError> {
        let cells = std::mem::take(&mut trace.cells);
        mesh.triangles.clear();
        for (of, cell) in net.quadrilaterals.iter().zip(cells.iter().step_by(2)) {
            mesh.triangles.extend(self.triangles(net.level, *of).into_iter().flatten());
            trace.cells.resize(mesh.triangles.len(), *cell);
        }
        let mut numbers = filled(self.positions.len(), 0)?;
        mesh.positions.clear();
        for (v, position) in self.positions.iter().enumerate() {
            if self.stands_for[v] as usize == v {
                trace.keys[mesh.positions.len()] = trace.keys[v];
                numbers[v] = mesh.positions.len() as u32;
                mesh.positions.push(*position);
            }
        }
        trace.keys.truncate(mesh.positions.len());
        mesh.triangles.iter_mut().flatten().for_each(|v| *v = numbers[*v as usize]);
        Ok(())
    }
}
