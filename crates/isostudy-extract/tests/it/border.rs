//! Surfaces that leave the box end on it, without scraps: the tetrahedra fill the box and nothing else.

use std::sync::Mutex;

use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{
    Arrangement, BoxGrid, ChunkExtractor, ChunkSettings, Clustering, Execution, Method, Tetrahedra, Topology,
    weld_chunks,
};
use isostudy_field::{Gyroid, StudyField};
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};
use proptest::prelude::*;

const ONE: Execution = Execution { threads: 1 };

/// Solid below a height.
struct Terrain<F>(F);

impl<F: Fn(f32, f32) -> f32 + Sync> StudyField for Terrain<F> {
    fn sample(&self, p: Vec3) -> f32 {
        (self.0)(p.x, p.y) - p.z
    }
}

fn mesh_of(field: &dyn StudyField, lattice: &Lattice, clustering: Clustering) -> TriangleMesh {
    let settings = ExtractSettings::default().with_clustering(clustering);
    extract(field, lattice, &settings, &ONE).unwrap().mesh
}

/// One sheet with one rim; and unless edges are collapsed towards the rim no part of it lies flat in a face of the box.
fn check(field: &dyn StudyField, lattice: &Lattice, what: &str) {
    let arrangement = lattice.arrangement();
    for clustering in [Clustering::None, Clustering::Integrated, Clustering::EdgeCollapse] {
        if !arrangement.supports(clustering) {
            continue;
        }
        let mesh = mesh_of(field, lattice, clustering);
        let report = topology(&mesh);
        let shape = (report.components, report.boundary_loops, report.euler_characteristic);
        assert_eq!(shape, (1, 1, 1), "{what}: {arrangement} {clustering}");
        assert_eq!(
            isostudy_mesh::quality::quality(&mesh).degenerate,
            0,
            "{what}: {arrangement} {clustering}"
        );
        if clustering == Clustering::EdgeCollapse {
            continue;
        }
        let Bounds { min, max } = lattice.bounds();
        let flat = (0..mesh.triangles.len()).filter(|&t| {
            let corners = mesh.corners(t);
            [min, max]
                .iter()
                .any(|side| corners.iter().fold(!0, |all, p| all & p.cmpeq(*side).bitmask()) != 0)
        });
        assert_eq!(flat.count(), 0, "{what}: {arrangement} {clustering}");
    }
}

#[test]
fn a_smooth_terrain_is_one_sheet() {
    let bounds = Bounds { min: Vec3::new(-8.0, -8.0, -4.0), max: Vec3::new(8.0, 8.0, 4.0) };
    let smooth = Terrain(|x: f32, y: f32| 2.0 * (0.7 * x).sin() * (0.5 * y).cos());
    let rough = Terrain(|x: f32, y: f32| {
        2.0 * (0.7 * x).sin() * (0.5 * y).cos() + 0.4 * (2.3 * x + y).sin() + 0.15 * (4.1 * y - 1.3 * x).cos()
    });
    for arrangement in Arrangement::ALL {
        // With spacings that divide the box, that do not, and that leave nearly nothing or nearly a cube.
        for spacing in [0.25, 0.3, 0.2499, 0.2501, 0.37] {
            let lattice = Lattice::try_new(arrangement, bounds, spacing).unwrap();
            check(&smooth, &lattice, &format!("smooth {spacing}"));
            check(&rough, &lattice, &format!("rough {spacing}"));
        }
    }
}

#[test]
fn a_gyroid_has_as_many_parts_on_every_lattice() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    for spacing in [2.0 / 48.0, 0.0431] {
        let parts = Arrangement::ALL.map(|arrangement| {
            let lattice = Lattice::try_new(arrangement, bounds, spacing).unwrap();
            topology(&mesh_of(&Gyroid { frequency: 11.0 }, &lattice, Clustering::None)).components
        });
        assert_eq!(parts, [parts[1]; 4], "{spacing}");
    }
}

/// Writes down where it is called.
struct Recorder(Mutex<Vec<Vec3>>);

impl StudyField for Recorder {
    fn sample(&self, p: Vec3) -> f32 {
        self.0.lock().unwrap().push(p);
        p.x.sin()
    }
}

#[test]
fn the_field_is_never_called_outside_of_the_box_unless_as_published() {
    let bounds = Bounds { min: Vec3::new(-1.3, 0.2, 5.0), max: Vec3::new(2.0, 1.7, 7.77) };
    for arrangement in Arrangement::ALL {
        for spacing in [0.3, 0.25, 1.5, 2.0, 9.0] {
            let lattice = Lattice::try_new(arrangement, bounds, spacing).unwrap();
            let beyond = |topology| {
                let recorder = Recorder(Mutex::default());
                let settings =
                    ExtractSettings::default().with_topology(topology).with_clustering(Clustering::None);
                extract(&recorder, &lattice, &settings, &ONE).unwrap();
                let places = recorder.0.into_inner().unwrap();
                // To each of the six faces there are samples.
                for side in [bounds.min, bounds.max] {
                    let on = places.iter().fold(0, |on, p| on | p.cmpeq(side).bitmask());
                    assert!(topology == Topology::Published || on == 7, "{arrangement} {spacing}");
                }
                places.iter().any(|p| (p.cmplt(bounds.min) | p.cmpgt(bounds.max)).any())
            };
            assert!(!beyond(Topology::Guarded), "{arrangement} {spacing}");
            assert!(beyond(Topology::Published), "{arrangement} {spacing}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Gentle hills in boxes of any size, with any spacing: one sheet; and chunks weld to it.
    #[test]
    fn random_hills_are_one_sheet(
        waves in prop::collection::vec((0.0f32..0.1, -2.0f32..2.0, -2.0f32..2.0, 0.0f32..6.0), 4),
        arrangement in 0..4usize,
        size in prop::array::uniform2(1.0f32..3.0),
        corner in prop::array::uniform3(-2.0f32..2.0),
        spacing in 0.07f32..0.2,
    ) {
        let base = corner[2] + 0.6;
        let field = Terrain(move |x: f32, y: f32| {
            base + waves.iter().map(|(a, u, v, w)| a * (u * x + v * y + w).sin()).sum::<f32>()
        });
        let min = Vec3::from(corner);
        let bounds = Bounds { min, max: min + Vec3::new(size[0], size[1], 1.2) };
        let lattice = Lattice::try_new(Arrangement::ALL[arrangement], bounds, spacing).unwrap();
        check(&field, &lattice, "hills");
        let method = Tetrahedra::new(lattice.arrangement()).with_clustering(Clustering::None);
        let mut extractor = ChunkExtractor::in_box(
            &BoxGrid::from(&lattice),
            &Method::Tetrahedra(method),
            &ChunkSettings::default(),
        )
        .unwrap();
        let boxes: Vec<_> = extractor.grid(5).collect();
        let source: &dyn StudyField = &field;
        let chunks: Vec<_> =
            boxes.into_iter().map(|cells| extractor.extract(source, cells, &ONE).unwrap()).collect();
        prop_assert!(weld_chunks(&chunks).unwrap() == mesh_of(&field, &lattice, Clustering::None));
    }
}
