//! Continuation as a method.

use super::{Family, Method, MethodError, Preset, Promises};
use crate::builders::builders;
use crate::cubes::{Continued, ContinuedCells, Seeds};
use crate::extractor::Way;

const CONTINUED: &str = "Wyvill, McPheeters & Wyvill 1986; Bloomenthal 1994";

/// By name.
pub(super) const PRESETS: &[Preset] = &[
    named("continued", "continuation, cubes", ContinuedCells::Cubes),
    named("continued-tetra", "continuation, tetrahedra", ContinuedCells::Tetrahedra),
];

const fn named(id: &'static str, label: &'static str, cells: ContinuedCells) -> Preset {
    let method = Continuation { cells, seeds: Seeds::FOUND, search: 8 };
    Preset { id, label, method: Method::Continuation(method), source: CONTINUED }
}

/// Marching cubes from cube to cube: from seeds on, across faces with corners on both sides (Wyvill, McPheeters & Wyvill 1986; Bloomenthal
/// 1994). It takes about two samples for each vertex, however large the box is, and none between the surface and the box.
///
/// The mesh is the part of marching cubes' that is reached: cubes hang together by crossed faces. A part of the surface that has no seed is
/// missing, and nothing says so. Faces are decided by signs, inside corners apart, so that neighbours agree.
///
/// With the feature `serde` the keys are those of the fields, all with defaults.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Continuation {
    /// What is made of a visited cube.
    pub cells: ContinuedCells,
    /// Points to begin near: in their cells, or else at the nearest edge that is crossed along the six directions from there. Without
    /// any, seeds are searched for.
    pub seeds: Seeds,
    /// How far apart the lines are on which seeds are searched for, in cells; 1 takes all samples, and misses nothing. A line has a sample as
    /// often, and finds the surface between two of them that lie on different sides. Where no line finds any, lines half as far apart
    /// are looked at: a mesh is empty only if all samples lie on one side.
    pub search: u32,
}

builders! {
    Continuation {
        with_cells: cells: ContinuedCells,
        with_seeds: seeds: Seeds,
        with_search: search: u32,
    }
}

impl Continuation {
    /// As [`Default`].
    pub const fn new() -> Self {
        Self { cells: ContinuedCells::Cubes, seeds: Seeds::FOUND, search: 8 }
    }
}

impl Default for Continuation {
    /// As [`new`](Self::new).
    fn default() -> Self {
        Self::new()
    }
}

impl Family for Continuation {
    fn way(&self) -> Option<Way> {
        let Self { cells, seeds, search } = *self;
        Some(Way::Continued(Continued { cells, seeds, search }))
    }

    fn promises(&self) -> Promises {
        Promises {
            manifold: true,
            closed_off_the_box: true,
            no_intersections: false,
            same_triangles_for_all_placements: false,
            chunks: false,
            samples_suffice: true,
        }
    }

    fn check_own(&self) -> Result<(), MethodError> {
        MethodError::unless(self.search > 0, "search", self.search, "must be 1 or more, cells")
    }
}
