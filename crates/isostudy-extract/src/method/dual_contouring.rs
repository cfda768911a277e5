//! Dual contouring as a method.

use super::{Family, Method, MethodError, Preset, Promises};
use crate::builders::builders;
use crate::duals::{Nets, Sharp, VertexPer};
use crate::extractor::Way;

const PLANES: &str = "Ju, Losasso, Schaefer & Warren 2002, on a uniform grid";
const ENVELOPES: &str = "Ju & Udeshi 2006, on a uniform grid, with a vertex per sheet (Wenger 2013)";
const PLANES_OF_PATCHES: &str = "Schaefer, Ju & Warren 2007, on a uniform grid; Wenger 2013";

/// By name.
pub(super) const PRESETS: &[Preset] = &[
    named("dc", "dual contouring", [false, false, false], PLANES),
    named("dc-manifold", "dual contouring (manifold)", [true, false, false], PLANES_OF_PATCHES),
    named("dc-in-cell", "dual contouring in cells", [true, true, false], PLANES_OF_PATCHES),
    #[cfg(feature = "dual-contouring-clean")]
    named("dc-clean", "dual contouring (clean)", [true, true, true], ENVELOPES),
];

const fn named(
    id: &'static str,
    label: &'static str,
    [patches, in_cell, clean]: [bool; 3],
    source: &'static str,
) -> Preset {
    let method = DualContouring { patches, truncation: 1e-3, in_cell, clean, tolerance: 0.0 };
    Preset { id, label, method: Method::DualContouring(method), source }
}

/// Dual contouring (Ju, Losasso, Schaefer & Warren 2002) on a uniform grid, or an octree made of one: the connections of [surface nets](super::SurfaceNets), with
/// each vertex where the field's tangent planes at the crossings of its cube meet, so that edges and corners are kept.
///
/// Crossings are roots of the field on their edges. Normals are the field's own gradients where it has some, else central differences.
/// The vertex has the least sum of squared distances to the planes; where they leave a choice it is the point nearest to the mean of
/// the crossings. Triangles may pass through each other, unless the net is to be [`clean`](DualContouring::clean).
///
/// With the feature `serde` the keys are those of the fields, all with defaults.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct DualContouring {
    /// As for [surface nets](super::SurfaceNets::patches).
    pub patches: bool,
    /// Eigenvalues of the sum of the normals' outer products that are smaller than this share of the largest count as none, so that
    /// nearly parallel planes do not send a vertex away: 0 to 1.
    pub truncation: f32,
    /// Whether a vertex stays in its cube, at the best point there. A corner or an edge that pokes into a cube without a crossing is
    /// then cut off, by up to half a cube. Otherwise it may leave the cube by the length of an edge, and triangles may turn over; as
    /// published there is no bound, which gives spikes on rough surfaces.
    pub in_cell: bool,
    /// Whether no triangle passes through another one. Where the quadrilateral of an edge would leave the tetrahedra between that edge and
    /// its vertices, it gets vertices in the faces of its cubes or on the edge (Ju & Udeshi 2006). Needs `patches` and
    /// `in_cell`, and the feature `dual-contouring-clean`, which is on by default.
    pub clean: bool,
    /// How far a vertex may be from the tangent plane at any crossing of its cell, in lengths of a lattice edge, where eight cells become
    /// one and theirs again, as far as the topology stays what it is. Triangles then are within a few times that of the surface, and few
    /// where it is flat. With 0, the default, cells stay as they are. The vertex of a larger cell stays in it, and cells at the box are
    /// never merged.
    pub tolerance: f32,
}

builders! {
    DualContouring {
        with_patches: patches: bool,
        with_truncation: truncation: f32,
        with_in_cell: in_cell: bool,
        with_clean: clean: bool,
        with_tolerance: tolerance: f32,
    }
}

impl DualContouring {
    /// As [`Default`].
    pub const fn new() -> Self {
        Self { patches: false, truncation: 1e-3, in_cell: false, clean: false, tolerance: 0.0 }
    }
}

impl Default for DualContouring {
    /// As [`new`](Self::new).
    fn default() -> Self {
        Self::new()
    }
}

impl Family for DualContouring {
    fn way(&self) -> Option<Way> {
        let sharp = Sharp { truncation: self.truncation, in_cell: self.in_cell };
        let vertex_per = match (self.patches, self.clean) {
            (_, true) => VertexPer::Loop,
            (true, false) => VertexPer::Run,
            (false, false) => VertexPer::Cell,
        };
        Some(Way::Nets(Nets { vertex_per, sharp: Some(sharp), smoothing: 0, tolerance: self.tolerance, blocks: None }))
    }

    fn promises(&self) -> Promises {
        Promises {
            manifold: self.patches,
            closed_off_the_box: true,
            no_intersections: self.clean,
            same_triangles_for_all_placements: false,
            chunks: self.tolerance == 0.0,
            samples_suffice: false,
        }
    }

    fn check_own(&self) -> Result<(), MethodError> {
        let Self { truncation, tolerance, .. } = *self;
        let share = "must be from 0 to 1, a share of the largest eigenvalue";
        MethodError::unless((0.0..=1.0).contains(&truncation), "truncation", truncation, share)?;
        let length = "must be 0 or more, in lengths of a lattice edge";
        MethodError::unless(tolerance >= 0.0, "tolerance", tolerance, length)?;
        let is_built = !self.clean || cfg!(feature = "dual-contouring-clean");
        MethodError::unless(is_built, "clean", self.clean, "needs the feature dual-contouring-clean")?;
        let goes_with = !self.clean || self.patches && self.in_cell;
        MethodError::unless(goes_with, "clean", self.clean, "needs patches = true and in_cell = true")
    }

    fn calls_the_field_always(&self) -> bool {
        true
    }

    /// As for surface nets: crossings and their normals are those of their edges alone.
    fn unmoved_halo(&self) -> Option<u32> {
        // Merged cells may reach across the whole box.
        (self.tolerance == 0.0).then_some(if self.patches { 3 } else { 2 })
    }
}
