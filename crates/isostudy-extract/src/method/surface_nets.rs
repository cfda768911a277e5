//! Surface nets as a method.

use super::{Family, Method, MethodError, Preset, Promises};
use crate::builders::builders;
use crate::duals::{MOST_SMOOTHING, Nets, VertexPer};
use crate::extractor::Way;
use crate::settings::{Clustering, ExtractSettings, Topology};

const NETS: &str = "Gibson 1998, by values and without relaxation";
const PATCHES: &str = "Nielson 2004; Wenger 2013";

/// By name.
pub(super) const PRESETS: &[Preset] = &[
    named("nets", "surface nets", false, NETS),
    named("nets-manifold", "surface nets (manifold)", true, PATCHES),
];

const fn named(id: &'static str, label: &'static str, patches: bool, source: &'static str) -> Preset {
    Preset { id, label, method: Method::SurfaceNets(SurfaceNets { patches, smoothing: 0, edge_clamp: 0.0 }), source }
}

/// Surface nets, the dual of marching cubes: a vertex in each cube that the surface crosses, at the mean of the crossings of its edges,
/// and a quadrilateral round each crossed edge (Gibson 1998). Each is two triangles, on either side of its
/// shorter diagonal.
///
/// Where the surface leaves the box the mesh ends half a cell before it, since a vertex lies in a cell.
///
/// With the feature `serde` the keys are those of the fields, all with defaults.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct SurfaceNets {
    /// A vertex for each loop of surface round a cell rather than one in all (Nielson 2004), and where that would leave an edge with four
    /// quadrilaterals, inside corners joined on the face between (Wenger 2013): then the mesh is a manifold. Without, sheets of the
    /// surface that cross one cell share its vertex.
    pub patches: bool,
    /// How many times all vertices go half the way to the mean of those that they share a side of a quadrilateral with; at most 64. None
    /// leaves its cube (Gibson 1998). It takes the steps out of samples that only say in or out; of others it wears off what they know.
    pub smoothing: u32,
    /// How far crossings are kept from sample points, in lengths of a lattice edge: see [`ExtractSettings::edge_clamp`].
    pub edge_clamp: f32,
}

builders! {
    SurfaceNets {
        with_patches: patches: bool,
        with_smoothing: smoothing: u32,
        with_edge_clamp: edge_clamp: f32,
    }
}

impl SurfaceNets {
    /// As [`Default`].
    pub const fn new() -> Self {
        Self { patches: false, smoothing: 0, edge_clamp: 0.0 }
    }
}

impl Default for SurfaceNets {
    /// As [`new`](Self::new).
    fn default() -> Self {
        Self::new()
    }
}

impl Family for SurfaceNets {
    fn way(&self) -> Option<Way> {
        Some(Way::Nets(Nets { vertex_per: if self.patches { VertexPer::Run } else { VertexPer::Cell }, sharp: None, smoothing: self.smoothing, tolerance: 0.0, blocks: None }))
    }

    fn promises(&self) -> Promises {
        Promises {
            manifold: self.patches,
            closed_off_the_box: true,
            no_intersections: false,
            same_triangles_for_all_placements: false,
            chunks: true,
            samples_suffice: true,
        }
    }

    fn settings(&self, isovalue: f32) -> ExtractSettings {
        ExtractSettings {
            isovalue,
            clustering: Clustering::None,
            topology: Topology::Guarded,
            edge_clamp: self.edge_clamp,
            ..ExtractSettings::default()
        }
    }

    fn check_own(&self) -> Result<(), MethodError> {
        let allowed = "must be from 0 to 64, steps";
        MethodError::unless(self.smoothing <= MOST_SMOOTHING, "smoothing", self.smoothing, allowed)
    }

    /// With patches, a cell beside them has vertices between those that are needed.
    fn makes_wanted_alone(&self) -> bool {
        self.smoothing == 0 && !self.patches
    }

    /// A triangle has vertices of the next lower cells. With patches, how such a cell is cut may be for the next one to say.
    fn halo_without_normals(&self) -> Option<u32> {
        Some(self.smoothing + if self.patches { 2 } else { 1 })
    }

    /// A cell's own samples give its vertices their normals.
    fn halo_with_normals_of_samples(&self) -> Option<u32> {
        if self.smoothing == 0 { self.halo_without_normals() } else { None }
    }

    /// A triangle has vertices of the next lower cells, whose triangles give them normals; how such a cell is cut may be for the
    /// next one to say. Each step of smoothing looks one cell farther.
    fn unmoved_halo(&self) -> Option<u32> {
        Some(self.smoothing + if self.patches { 3 } else { 2 })
    }
}
