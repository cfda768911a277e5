//! Blocks as a method.

use super::{Family, Method, Preset, Promises};
use crate::builders::builders;
use crate::duals::{Blocks, Nets, VertexPer};
use crate::extractor::Way;

/// By name.
pub(super) const PRESETS: &[Preset] = &[
    named("blocky", "blocks", false, "Herman & Liu 1979"),
    named("blocky-greedy", "blocks, squares merged", true, "Lysenko 2012"),
];

const fn named(id: &'static str, label: &'static str, merged: bool, source: &'static str) -> Preset {
    Preset { id, label, method: Method::Blocky(Blocky { merged }), source }
}

/// A block round each sample that is inside: a square between every two neighbours on different sides, half way from the one to the other
/// (Herman & Liu 1979). What a sample is does not matter, but for its side. Surface nets have the same connections.
///
/// Vertices lie in the middle of cells, so the mesh is up to half a cell's diagonal from the surface. Where the surface leaves the box the
/// mesh ends half a cell before it. Where blocks meet along an edge alone, that edge has four squares.
///
/// With the feature `serde` the keys are those of the fields, all with defaults.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Blocky {
    /// Whether squares of one plane become rectangles, as few as going along rows finds (greedy meshing; Lysenko 2012). A corner of one
    /// rectangle may lie within the side of another: the mesh covers the same surface, and is not closed by its edges. There are no
    /// chunks, since rectangles go on.
    pub merged: bool,
}

builders! {
    Blocky {
        with_merged: merged: bool,
    }
}

impl Blocky {
    /// As [`Default`].
    pub const fn new() -> Self {
        Self { merged: false }
    }
}

impl Default for Blocky {
    /// As [`new`](Self::new).
    fn default() -> Self {
        Self::new()
    }
}

impl Family for Blocky {
    fn way(&self) -> Option<Way> {
        let blocks = Some(if self.merged { Blocks::Merged } else { Blocks::Single });
        Some(Way::Nets(Nets { vertex_per: VertexPer::Cell, sharp: None, smoothing: 0, tolerance: 0.0, blocks }))
    }

    fn promises(&self) -> Promises {
        Promises {
            manifold: false,
            closed_off_the_box: !self.merged,
            no_intersections: false,
            same_triangles_for_all_placements: false,
            chunks: !self.merged,
            samples_suffice: true,
        }
    }

    /// As of surface nets.
    fn halo_without_normals(&self) -> Option<u32> {
        (!self.merged).then_some(1)
    }

    /// As of surface nets.
    fn unmoved_halo(&self) -> Option<u32> {
        (!self.merged).then_some(2)
    }
}
