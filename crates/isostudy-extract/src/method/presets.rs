//! Methods that have a name.
//!
//! The first letter is the arrangement: body-centred, simple cubic, mirrored five tetrahedra, face-centred. The second is
//! the clustering: unclustered, integrated, post-processed by an edge collapse, integrated and then collapsed, warped.

use super::{Continuation, Cubes, DualContouring, Macet, Method, SnapCubes, SurfaceNets, Tetrahedra};
use crate::cubes::{ContinuedCells, Diagonals, Faces, Flat, Seeds};
use crate::lattice::Arrangement::{self, BodyCentred, FaceCentred, FiveTetrahedra, SimpleCubic};
use crate::settings::Clustering::{self, EdgeCollapse, Integrated, IntegratedCollapse, None};
use crate::settings::{Placement, Positions, Topology};

const COSTEN: &str = "Costen 2026";
const TREECE: &str = "Treece, Prager & Gee 1999; Costen 2026";
const COLLAPSED: &str = "Costen 2026; Dey, Edelsbrunner, Guha & Nekhayev 1999";
const OWN: &str = "not in the paper; see isostudy_extract::Arrangement and isostudy_extract::Clustering";
const CUBES: &str = "Lorensen & Cline 1987, with faces that agree";
const TRILINEAR: &str = "Chernyaev 1995, with every case decided by the interpolant's saddles";
const EDGE_GROUPS: &str = "Lorensen & Cline 1987; Dietrich et al. 2008";
const BEST: &str = "Lorensen & Cline 1987; diagonals by radius ratios, see isostudy_extract::Diagonals";
const SNAPPED: &str = "Raman & Wenger 2008; table by hulls, Bhaniramka et al. 2004";
const TURNED: &str = "our reading of Macet, Dietrich et al. 2009; table of Dietrich et al. 2008";
const WARPED: &str = "Labelle & Shewchuk 2007, the warp and the boundary";
const NETS: &str = "Gibson 1998, by values and without relaxation";
const PATCHES: &str = "Nielson 2004; Wenger 2013";
const PLANES: &str = "Ju, Losasso, Schaefer & Warren 2002, on a uniform grid";
const PLANES_OF_PATCHES: &str = "Schaefer, Ju & Warren 2007, on a uniform grid; Wenger 2013";
const CONTINUED: &str = "Wyvill, McPheeters & Wyvill 1986; Bloomenthal 1994";
const PLACED: &str = "Treece, Prager & Gee 1999; for the placement see isostudy_extract::Placement";

/// A method with a name.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Preset {
    /// 2 to 16 of a to z, 0 to 9 and `-`, a letter first. No two presets have one id.
    pub id: &'static str,
    /// The same in words. No two presets have one label.
    pub label: &'static str,
    /// What it is.
    pub method: Method,
    /// Where it was published: authors and year.
    pub source: &'static str,
}

impl Preset {
    /// Whether it is there to be compared with, not to be chosen: the published rules as they were, edges collapsed after the
    /// fact, which the paper compares clustering with, and arrangements that make more triangles of the same cubes.
    pub fn is_for_comparison(&self) -> bool {
        let Method::Tetrahedra(of) = &self.method else { return false };
        of.topology == Topology::Published
            || matches!(of.arrangement, FiveTetrahedra | FaceCentred)
            || matches!(of.clustering, EdgeCollapse | IntegratedCollapse)
    }
}

/// The named methods, in a fixed order: with the library's defaults first, then with vertices placed otherwise, then as
/// published, for comparison with published numbers only.
pub fn presets() -> &'static [Preset] {
    &PRESETS
}

static PRESETS: [Preset; 36] = [
    plain("bu", "body-centred, none", BodyCentred, None, COSTEN),
    plain("bi", "body-centred, integrated", BodyCentred, Integrated, TREECE),
    plain("bp", "body-centred, edge collapse", BodyCentred, EdgeCollapse, COLLAPSED),
    plain("bc", "body-centred, integrated + collapse", BodyCentred, IntegratedCollapse, OWN),
    plain("su", "simple cubic, none", SimpleCubic, None, COSTEN),
    plain("si", "simple cubic, integrated", SimpleCubic, Integrated, TREECE),
    plain("sp", "simple cubic, edge collapse", SimpleCubic, EdgeCollapse, COLLAPSED),
    plain("sc", "simple cubic, integrated + collapse", SimpleCubic, IntegratedCollapse, OWN),
    plain("mu", "five tetrahedra, none", FiveTetrahedra, None, OWN),
    plain("mp", "five tetrahedra, edge collapse", FiveTetrahedra, EdgeCollapse, OWN),
    plain("fu", "face-centred, none", FaceCentred, None, OWN),
    plain("fp", "face-centred, edge collapse", FaceCentred, EdgeCollapse, OWN),
    placed("bi-projected", "body-centred, integrated, projected", BodyCentred, Placement::Projected),
    placed("bi-relaxed", "body-centred, integrated, relaxed", BodyCentred, Placement::Relaxed),
    placed("si-projected", "simple cubic, integrated, projected", SimpleCubic, Placement::Projected),
    placed("si-relaxed", "simple cubic, integrated, relaxed", SimpleCubic, Placement::Relaxed),
    Preset { source: WARPED, ..plain("bw", "body-centred, warp", BodyCentred, Clustering::Warp, OWN) },
    cubes("mc", "marching cubes", Faces::SeparateInside, Diagonals::Fan, CUBES),
    cubes("mc33", "marching cubes, trilinear", Faces::Trilinear, Diagonals::Fan, TRILINEAR),
    cubes(
        "mc-edge-groups",
        "marching cubes, edge groups",
        Faces::SeparateInside,
        Diagonals::EdgeGroups,
        EDGE_GROUPS,
    ),
    cubes("mc-quality", "marching cubes, best diagonals", Faces::SeparateInside, Diagonals::Quality, BEST),
    Preset {
        id: "snapmc",
        label: "marching cubes, snapped",
        method: Method::SnapCubes(SnapCubes { gamma: 0.3, flat: Flat::Both }),
        source: SNAPPED,
    },
    Preset {
        id: "macet",
        label: "marching cubes, edges turned",
        method: Method::Macet(Macet {
            faces: Faces::SeparateInside,
            diagonals: Diagonals::EdgeGroups,
            pull: 1.0,
            steps: 4,
            share: 1.0,
        }),
        source: TURNED,
    },
    Preset {
        id: "nets",
        label: "surface nets",
        method: Method::SurfaceNets(SurfaceNets { patches: false, smoothing: 0, edge_clamp: 0.0 }),
        source: NETS,
    },
    Preset {
        id: "nets-manifold",
        label: "surface nets (manifold)",
        method: Method::SurfaceNets(SurfaceNets { patches: true, smoothing: 0, edge_clamp: 0.0 }),
        source: PATCHES,
    },
    Preset {
        id: "dc",
        label: "dual contouring",
        method: Method::DualContouring(DualContouring {
            patches: false,
            truncation: 1e-3,
            in_cell: false,
            tolerance: 0.0,
        }),
        source: PLANES,
    },
    Preset {
        id: "dc-manifold",
        label: "dual contouring (manifold)",
        method: Method::DualContouring(DualContouring {
            patches: true,
            truncation: 1e-3,
            in_cell: false,
            tolerance: 0.0,
        }),
        source: PLANES_OF_PATCHES,
    },
    Preset {
        id: "dc-in-cell",
        label: "dual contouring in cells",
        method: Method::DualContouring(DualContouring {
            patches: true,
            truncation: 1e-3,
            in_cell: true,
            tolerance: 0.0,
        }),
        source: PLANES_OF_PATCHES,
    },
    continued("continued", "continuation, cubes", ContinuedCells::Cubes),
    continued("continued-tetra", "continuation, tetrahedra", ContinuedCells::Tetrahedra),
    published("bu-published", "body-centred, none, as published", BodyCentred, None),
    published("bi-published", "body-centred, integrated, as published", BodyCentred, Integrated),
    published("bp-published", "body-centred, edge collapse, as published", BodyCentred, EdgeCollapse),
    published("su-published", "simple cubic, none, as published", SimpleCubic, None),
    published("si-published", "simple cubic, integrated, as published", SimpleCubic, Integrated),
    published("sp-published", "simple cubic, edge collapse, as published", SimpleCubic, EdgeCollapse),
];

/// With the library's defaults, which `defaults_are_those_of_the_library` holds to.
const fn settings(arrangement: Arrangement, clustering: Clustering) -> Tetrahedra {
    Tetrahedra {
        arrangement,
        clustering,
        topology: Topology::Guarded,
        positions: Positions::Indexed,
        placement: Placement::MeanOfCrossings,
        refine_crossings: false,
        edge_clamp: 0.0,
    }
}

const fn plain(
    id: &'static str,
    label: &'static str,
    arrangement: Arrangement,
    clustering: Clustering,
    source: &'static str,
) -> Preset {
    Preset { id, label, method: Method::Tetrahedra(settings(arrangement, clustering)), source }
}

const fn placed(
    id: &'static str,
    label: &'static str,
    arrangement: Arrangement,
    placement: Placement,
) -> Preset {
    let method = Tetrahedra { placement, ..settings(arrangement, Integrated) };
    Preset { id, label, method: Method::Tetrahedra(method), source: PLACED }
}

const fn cubes(
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

const fn continued(id: &'static str, label: &'static str, cells: ContinuedCells) -> Preset {
    let method = Continuation { cells, seeds: Seeds::FOUND, search: 8 };
    Preset { id, label, method: Method::Continuation(method), source: CONTINUED }
}

/// The original's rules, and its sums as its benchmark makes them.
const fn published(
    id: &'static str,
    label: &'static str,
    arrangement: Arrangement,
    clustering: Clustering,
) -> Preset {
    let (topology, positions) = (Topology::Published, Positions::Accumulated { chunks: 16 });
    let method = Tetrahedra { topology, positions, ..settings(arrangement, clustering) };
    Preset { id, label, method: Method::Tetrahedra(method), source: COSTEN }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_those_of_the_library() {
        for arrangement in Arrangement::ALL {
            assert_eq!(settings(arrangement, Integrated), Tetrahedra::new(arrangement));
        }
    }
}
