//! SnapMC as a method.

use super::{Family, Method, MethodError, Preset, Promises};
use crate::builders::builders;
use crate::cubes::Flat;
use crate::extractor::Way;

const SNAPPED: &str = "Raman & Wenger 2008; table by hulls, Bhaniramka et al. 2004";

/// By name.
pub(super) const PRESETS: &[Preset] = &[
    Preset {
        id: "snapmc",
        label: "marching cubes, snapped",
        method: Method::SnapCubes(SnapCubes { gamma: 0.3, flat: Flat::Both }),
        source: SNAPPED,
    },
];

/// Marching cubes whose crossings near a point of the lattice are drawn to it, so that triangles have bounded angles (Raman & Wenger
/// 2008): from 12.7 to 144.2 degrees with the default, whatever the samples (`tests/it/snap.rs` tries every triangle of the table).
///
/// A sample that equals the isovalue is on the surface where one of the cells at it has a corner inside, otherwise outside. On the box
/// it is outside too, unless a neighbour there is inside: so a solid that ends at the box has walls. The bounds of angles do not hold
/// for the triangles of such walls. Sides of
/// triangles have an even number of triangles off the box, two or more: where sheets of the surface are less than a cell apart,
/// they meet along edges and at points. Pieces thinner than that can be lost. Edges are at least `gamma` times the root of two long.
///
/// With the feature `serde` the keys are those of the fields, all with defaults.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct SnapCubes {
    /// How near to a point a crossing must be, in lengths of its edge: from 0, where crossings stay where they are, to 0.5.
    pub gamma: f32,
    /// What a face between two cells gets in which both have a piece of surface.
    pub flat: Flat,
}

builders! {
    SnapCubes {
        with_gamma: gamma: f32,
        with_flat: flat: Flat,
    }
}

impl SnapCubes {
    /// As published.
    pub const fn new() -> Self {
        Self { gamma: 0.3, flat: Flat::Both }
    }
}

impl Default for SnapCubes {
    /// As [`new`](Self::new).
    fn default() -> Self {
        Self::new()
    }
}

impl Family for SnapCubes {
    fn way(&self) -> Option<Way> {
        Some(Way::Snapped { gamma: self.gamma, flat: self.flat })
    }

    /// Where several sheets meet in one cell, snapping joins them along edges and at points.
    fn promises(&self) -> Promises {
        Promises {
            manifold: false,
            closed_off_the_box: true,
            no_intersections: false,
            same_triangles_for_all_placements: false,
            chunks: true,
            samples_suffice: true,
        }
    }

    fn check_own(&self) -> Result<(), MethodError> {
        let allowed = "must be from 0 to 0.5, in lengths of a lattice edge";
        MethodError::unless((0.0..=0.5).contains(&self.gamma), "gamma", self.gamma, allowed)
    }

    fn layers(&self) -> u64 {
        2
    }

    /// The normal of a vertex is that of the cells round it. Which patches these have is for their corners' labels to say, left out
    /// ones included, and labels are for samples one step beyond.
    fn unmoved_halo(&self) -> Option<u32> {
        Some(2)
    }
}
