//! Marching tetrahedra as a method.

use super::{Family, Method, Preset, Promises};
use crate::builders::builders;
use crate::extractor::Way;
use crate::lattice::Arrangement::{self, BodyCentred, FaceCentred, FiveTetrahedra, SimpleCubic};
use crate::settings::Clustering::{self, EdgeCollapse, Integrated, IntegratedCollapse, None as Unclustered};
use crate::settings::{ExtractSettings, Placement, Positions, Topology};

const COSTEN: &str = "Costen 2026";
const TREECE: &str = "Treece, Prager & Gee 1999; Costen 2026";
const COLLAPSED: &str = "Costen 2026; Dey, Edelsbrunner, Guha & Nekhayev 1999";
const OWN: &str = "no paper; docs/study-file.md explains it";
const WARPED: &str = "Labelle & Shewchuk 2007, the warp and the boundary";
const PLACED: &str = "Treece, Prager & Gee 1999; docs/study-file.md explains its placement";

/// By name.
pub(super) const PRESETS: &[Preset] = &[
    plain("bu", "body-centred, none", BodyCentred, Unclustered, COSTEN),
    plain("bi", "body-centred, integrated", BodyCentred, Integrated, TREECE),
    plain("bp", "body-centred, edge collapse", BodyCentred, EdgeCollapse, COLLAPSED),
    plain("bc", "body-centred, integrated + collapse", BodyCentred, IntegratedCollapse, OWN),
    plain("su", "simple cubic, none", SimpleCubic, Unclustered, COSTEN),
    plain("si", "simple cubic, integrated", SimpleCubic, Integrated, TREECE),
    plain("sp", "simple cubic, edge collapse", SimpleCubic, EdgeCollapse, COLLAPSED),
    plain("sc", "simple cubic, integrated + collapse", SimpleCubic, IntegratedCollapse, OWN),
    plain("mu", "five tetrahedra, none", FiveTetrahedra, Unclustered, OWN),
    plain("mp", "five tetrahedra, edge collapse", FiveTetrahedra, EdgeCollapse, OWN),
    plain("fu", "face-centred, none", FaceCentred, Unclustered, OWN),
    plain("fp", "face-centred, edge collapse", FaceCentred, EdgeCollapse, OWN),
    placed("bi-projected", "body-centred, integrated, projected", BodyCentred, Placement::Projected),
    placed("bi-relaxed", "body-centred, integrated, relaxed", BodyCentred, Placement::Relaxed),
    placed("si-projected", "simple cubic, integrated, projected", SimpleCubic, Placement::Projected),
    placed("si-relaxed", "simple cubic, integrated, relaxed", SimpleCubic, Placement::Relaxed),
    Preset { source: WARPED, ..plain("bw", "body-centred, warp", BodyCentred, Clustering::Warp, OWN) },
    published("bu-published", "body-centred, none, as published", BodyCentred, Unclustered),
    published("bi-published", "body-centred, integrated, as published", BodyCentred, Integrated),
    published("bp-published", "body-centred, edge collapse, as published", BodyCentred, EdgeCollapse),
    published("su-published", "simple cubic, none, as published", SimpleCubic, Unclustered),
    published("si-published", "simple cubic, integrated, as published", SimpleCubic, Integrated),
    published("sp-published", "simple cubic, edge collapse, as published", SimpleCubic, EdgeCollapse),
];

const fn plain(
    id: &'static str,
    label: &'static str,
    arrangement: Arrangement,
    clustering: Clustering,
    source: &'static str,
) -> Preset {
    Preset { id, label, method: Method::Tetrahedra(Tetrahedra { clustering, ..Tetrahedra::new(arrangement) }), source }
}

const fn placed(
    id: &'static str,
    label: &'static str,
    arrangement: Arrangement,
    placement: Placement,
) -> Preset {
    let method = Tetrahedra { placement, ..Tetrahedra::new(arrangement) };
    Preset { id, label, method: Method::Tetrahedra(method), source: PLACED }
}

/// The original's rules, and its sums as its benchmark makes them.
const fn published(
    id: &'static str,
    label: &'static str,
    arrangement: Arrangement,
    clustering: Clustering,
) -> Preset {
    let (topology, positions) = (Topology::Published, Positions::Accumulated { chunks: 16 });
    let method = Tetrahedra { clustering, topology, positions, ..Tetrahedra::new(arrangement) };
    Preset { id, label, method: Method::Tetrahedra(method), source: COSTEN }
}

/// Regularised marching tetrahedra: an arrangement of sample points, and what [`ExtractSettings`] have beside the isovalue.
///
/// With the feature `serde` the keys are those of the fields, and `arrangement` must be given. `positions` is `"indexed"`
/// or `"accumulated"`; to the latter belongs a number `accumulation_chunks`, 1 if it is left out, without effect beside the
/// former.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "keys::Keys", into = "keys::Keys"))]
pub struct Tetrahedra {
    /// How sample points fill the box, and which tetrahedra they make.
    pub arrangement: Arrangement,
    /// How vertices are merged.
    pub clustering: Clustering,
    /// Whether merging keeps the surface a manifold.
    pub topology: Topology,
    /// How the positions of sample points are computed.
    pub positions: Positions,
    /// Where a vertex goes.
    pub placement: Placement,
    /// Whether crossings are roots of the field rather than interpolated between samples.
    pub refine_crossings: bool,
    /// How far crossings are kept from sample points, in lengths of a lattice edge: see [`ExtractSettings::edge_clamp`].
    pub edge_clamp: f32,
}

builders! {
    Tetrahedra {
        with_arrangement: arrangement: Arrangement,
        with_clustering: clustering: Clustering,
        with_topology: topology: Topology,
        with_positions: positions: Positions,
        with_placement: placement: Placement,
        with_refine_crossings: refine_crossings: bool,
        with_edge_clamp: edge_clamp: f32,
    }
}

impl Tetrahedra {
    /// An arrangement with the defaults of [`ExtractSettings`].
    pub const fn new(arrangement: Arrangement) -> Self {
        Self {
            arrangement,
            clustering: Integrated,
            topology: Topology::Guarded,
            positions: Positions::Indexed,
            placement: Placement::MeanOfCrossings,
            refine_crossings: false,
            edge_clamp: 0.0,
        }
    }

    /// The settings of an extraction.
    pub fn settings(&self, isovalue: f32) -> ExtractSettings {
        let Self { arrangement: _, clustering, topology, positions, placement, refine_crossings, edge_clamp } =
            *self;
        ExtractSettings { isovalue, clustering, topology, positions, placement, refine_crossings, edge_clamp }
    }
}

impl Default for Tetrahedra {
    /// The body-centred arrangement, [`new`](Self::new).
    fn default() -> Self {
        Self::new(BodyCentred)
    }
}

impl Family for Tetrahedra {
    fn way(&self) -> Option<Way> {
        None
    }

    fn arrangement(&self) -> Arrangement {
        self.arrangement
    }

    fn settings(&self, isovalue: f32) -> ExtractSettings {
        Self::settings(self, isovalue)
    }

    fn promises(&self) -> Promises {
        let guarded = match self.topology {
            Topology::Guarded => true,
            Topology::Published => false,
        };
        let collapses = self.clustering.collapses();
        let indexed = self.positions == Positions::Indexed;
        let moved_in_chunks = match self.placement {
            Placement::MeanOfCrossings => true,
            Placement::Projected | Placement::Relaxed => !collapses,
            Placement::CurvatureWeighted => false,
        };
        Promises {
            manifold: guarded && self.clustering != Clustering::Warp,
            closed_off_the_box: guarded,
            // Each tetrahedron's triangles lie in it.
            no_intersections: guarded
                && self.clustering == Clustering::None
                && self.placement == Placement::MeanOfCrossings
                && indexed,
            // A warp has not all placements.
            same_triangles_for_all_placements: !collapses && self.clustering != Clustering::Warp,
            chunks: indexed && !self.refine_crossings && moved_in_chunks,
            samples_suffice: indexed && !self.refine_crossings && !self.placement.calls_the_field(),
        }
    }

    fn is_for_comparison(&self) -> bool {
        self.topology == Topology::Published
            || self.arrangement == Arrangement::FiveTetrahedra
            || self.clustering == Clustering::EdgeCollapse
    }

    fn has_corners(&self) -> bool {
        self.arrangement == Arrangement::SimpleCubic
            && self.topology == Topology::Guarded
            && self.positions == Positions::Indexed
    }

    fn tables(&self) -> Vec<isostudy_cells::Table> {
        crate::lattice::tetrahedra::tables(self.arrangement)
    }

    /// A vertex of a cell is one of its neighbours' too, their other vertices give it its normal, and those depend on
    /// samples one lattice edge away. Where cubes are cut each by itself the last step leads no farther. A vertex that is
    /// moved looks at its triangles, and one that is relaxed at its neighbours first.
    fn halo(&self) -> Option<u32> {
        if self.clustering.collapses() || self.positions != Positions::Indexed {
            return None;
        }
        let moves = match self.placement {
            Placement::MeanOfCrossings => 0,
            Placement::Projected => 1,
            Placement::Relaxed => 2,
            Placement::CurvatureWeighted => return None,
        };
        Some(self.unmoved_halo()? + moves)
    }

    /// Where vertices stay at the mean of their crossings.
    fn unmoved_halo(&self) -> Option<u32> {
        Some(if self.arrangement.uniform().is_some() { 2 } else { 1 })
    }
}

/// The keys of a file.
#[cfg(feature = "serde")]
mod keys {
    use serde::{Deserialize, Serialize};

    use super::{Arrangement, Clustering, Placement, Tetrahedra, Topology};

    #[derive(Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub(super) struct Keys {
        arrangement: Arrangement,
        #[serde(default)]
        clustering: Clustering,
        #[serde(default)]
        topology: Topology,
        #[serde(default)]
        positions: Positions,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        accumulation_chunks: Option<u32>,
        #[serde(default)]
        placement: Placement,
        #[serde(default)]
        refine_crossings: bool,
        #[serde(default)]
        edge_clamp: f32,
    }

    #[derive(Default, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    enum Positions {
        #[default]
        Indexed,
        Accumulated,
    }

    impl From<Tetrahedra> for Keys {
        fn from(method: Tetrahedra) -> Self {
            let Tetrahedra {
                arrangement,
                clustering,
                topology,
                positions,
                placement,
                refine_crossings,
                edge_clamp,
            } = method;
            let (positions, accumulation_chunks) = match positions {
                super::Positions::Indexed => (Positions::Indexed, None),
                super::Positions::Accumulated { chunks } => (Positions::Accumulated, Some(chunks)),
            };
            Self {
                arrangement,
                clustering,
                topology,
                positions,
                accumulation_chunks,
                placement,
                refine_crossings,
                edge_clamp,
            }
        }
    }

    impl From<Keys> for Tetrahedra {
        fn from(keys: Keys) -> Self {
            let chunks = keys.accumulation_chunks.unwrap_or(1);
            let positions = match keys.positions {
                // Study files keep the number for the day when they sum up again.
                Positions::Indexed => super::Positions::Indexed,
                Positions::Accumulated => super::Positions::Accumulated { chunks },
            };
            let Keys { arrangement, clustering, topology, placement, refine_crossings, edge_clamp, .. } =
                keys;
            Self { arrangement, clustering, topology, positions, placement, refine_crossings, edge_clamp }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_those_of_the_library() {
        for arrangement in Arrangement::ALL {
            assert_eq!(Tetrahedra::new(arrangement).settings(0.0), ExtractSettings::default());
        }
    }
}
