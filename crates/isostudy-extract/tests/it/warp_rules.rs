//! What the warp's tests share: the shares, the lattice's directions, and a mesh by the extractor.

use crate::fields::Volume;
use isostudy_extract::by_lattice::{ExtractSettings, extract};
use isostudy_extract::{Clustering, Execution};
use isostudy_mesh::TriangleMesh;

pub(crate) const ONE: Execution = Execution { threads: 1 };
pub(crate) const WARP: ExtractSettings = ExtractSettings::new().with_clustering(Clustering::Warp);
/// Of edges between two centres or two corners, and of the others.
pub(crate) const ALPHA: [f64; 2] = [0.24999, 0.359];

pub(crate) type Place = [i32; 3];

/// To the fourteen neighbours, in half cells.
pub(crate) fn offsets() -> Vec<Place> {
    let axes =
        (0..3).flat_map(|axis| [2, -2].map(|step| std::array::from_fn(|a| if a == axis { step } else { 0 })));
    let diagonals = (0..8).map(|c| std::array::from_fn(|a| if c >> a & 1 == 0 { 1 } else { -1 }));
    axes.chain(diagonals).collect()
}

pub(crate) fn plus(p: Place, q: Place) -> Place {
    std::array::from_fn(|a| p[a] + q[a])
}

pub(crate) fn alpha(offset: Place) -> f64 {
    ALPHA[usize::from(!offset.contains(&0))]
}

pub(crate) fn mesh_of(volume: &Volume, settings: &ExtractSettings) -> TriangleMesh {
    extract(volume, &volume.lattice(), settings, &ONE).unwrap().mesh
}
