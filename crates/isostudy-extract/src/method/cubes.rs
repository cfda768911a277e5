//! Marching cubes as a method.

use super::{Family, Method, Preset, Promises};
use crate::builders::builders;
use crate::cubes::{Diagonals, Faces, Rule};
use crate::extractor::Way;
use crate::settings::{Clustering, ExtractSettings, Placement, Positions, Topology};

const CUBES: &str = "Lorensen & Cline 1987, with faces that agree";
const TRILINEAR: &str = "Chernyaev 1995, with every case decided by the interpolant's saddles";
const EDGE_GROUPS: &str = "Lorensen & Cline 1987; Dietrich et al. 2008";
const BEST: &str = "Lorensen & Cline 1987; docs/study-file.md explains its diagonals";

/// By name.
pub(super) const PRESETS: &[Preset] = &[
    named("mc", "marching cubes", Faces::SeparateInside, Diagonals::Fan, CUBES),
    named("mc33", "marching cubes, trilinear", Faces::Trilinear, Diagonals::Fan, TRILINEAR),
    named(
        "mc-edge-groups",
        "marching cubes, edge groups",
        Faces::SeparateInside,
        Diagonals::EdgeGroups,
        EDGE_GROUPS,
    ),
    named("mc-quality", "marching cubes, best diagonals", Faces::SeparateInside, Diagonals::Quality, BEST),
];

const fn named(
    id: &'static str,
    label: &'static str,
    faces: Faces,
    diagonals: Diagonals,
    source: &'static str,
) -> Preset {
    let placement = Placement::MeanOfCrossings;
    let method = Cubes { faces, diagonals, placement, refine_crossings: false, edge_clamp: 0.0 };
    Preset { id, label, method: Method::Cubes(method), source }
}

/// Marching cubes: cubes that are not cut any further, a polygon for each loop of surface round one (Lorensen & Cline 1987), and
/// what others made of them.
///
/// With the feature `serde` the keys are those of the fields, all with defaults.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Cubes {
    /// What ambiguous faces and cells get.
    pub faces: Faces,
    /// How polygons become triangles.
    pub diagonals: Diagonals,
    /// Where a vertex goes.
    pub placement: Placement,
    /// Whether crossings are roots of the field rather than interpolated between samples.
    pub refine_crossings: bool,
    /// How far crossings are kept from sample points, in lengths of a lattice edge: see [`ExtractSettings::edge_clamp`].
    pub edge_clamp: f32,
}

builders! {
    Cubes {
        with_faces: faces: Faces,
        with_diagonals: diagonals: Diagonals,
        with_placement: placement: Placement,
        with_refine_crossings: refine_crossings: bool,
        with_edge_clamp: edge_clamp: f32,
    }
}

impl Cubes {
    /// As [`Default`].
    pub const fn new() -> Self {
        Self { faces: Faces::SeparateInside, diagonals: Diagonals::Fan, placement: Placement::MeanOfCrossings, refine_crossings: false, edge_clamp: 0.0 }
    }
}

impl Default for Cubes {
    /// As [`new`](Self::new).
    fn default() -> Self {
        Self::new()
    }
}

impl Cubes {
    fn table(&self) -> Rule {
        Rule { faces: self.faces, diagonals: self.diagonals }
    }
}

impl Family for Cubes {
    fn way(&self) -> Option<Way> {
        Some(Way::Patches(self.table()))
    }

    fn promises(&self) -> Promises {
        Promises {
            manifold: true,
            closed_off_the_box: true,
            no_intersections: false,
            same_triangles_for_all_placements: true,
            chunks: self.halo().is_some() && !self.refine_crossings,
            samples_suffice: !self.refine_crossings && !self.placement.calls_the_field(),
        }
    }

    fn settings(&self, isovalue: f32) -> ExtractSettings {
        ExtractSettings {
            isovalue,
            clustering: Clustering::None,
            topology: Topology::Guarded,
            positions: Positions::Indexed,
            placement: self.placement,
            refine_crossings: self.refine_crossings,
            edge_clamp: self.edge_clamp,
        }
    }

    fn rule(&self) -> Option<Rule> {
        Some(self.table())
    }

    fn has_vertices_on_edges(&self) -> bool {
        true
    }

    /// One that is moved looks at its triangles, and one that is relaxed at its neighbours first.
    fn halo(&self) -> Option<u32> {
        let more = match self.placement {
            Placement::MeanOfCrossings => 0,
            Placement::Projected => 1,
            Placement::Relaxed => 2,
            Placement::CurvatureWeighted => return None,
        };
        Some(self.unmoved_halo()? + more)
    }

    /// No vertex depends on samples beyond its own cells.
    fn halo_without_normals(&self) -> Option<u32> {
        match self.placement {
            Placement::MeanOfCrossings => Some(0),
            _ => self.halo(),
        }
    }

    /// Differences at a corner are of the samples on either side of it.
    fn halo_with_normals_of_samples(&self) -> Option<u32> {
        if self.placement == Placement::MeanOfCrossings { Some(1) } else { None }
    }

    fn makes_wanted_alone(&self) -> bool {
        self.placement == Placement::MeanOfCrossings
    }

    /// A vertex of a cell is one of its neighbours' too, and their other vertices give it its normal; no vertex depends on
    /// samples beyond its own cells.
    fn unmoved_halo(&self) -> Option<u32> {
        Some(1)
    }
}
