//! Oracles that need no published number: the sphere is known in closed form.

use std::collections::HashSet;
use std::f64::consts::PI;

use crate::topology::{assert_closed_manifold, directed_sides};
use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Clustering, Execution, Extraction, Positions, Topology};
use isostudy_field::{Sphere, StudyField};
use isostudy_mesh::{Bounds, TriangleMesh};

const ARRANGEMENTS: [Arrangement; 2] = [Arrangement::BodyCentred, Arrangement::SimpleCubic];

fn run(
    field: &dyn StudyField,
    arrangement: Arrangement,
    spacing: f32,
    settings: ExtractSettings,
) -> Extraction {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let lattice = Lattice::try_new(arrangement, bounds, spacing).unwrap();
    extract(field, &lattice, &settings, &Execution { threads: 1 }).unwrap()
}

fn with(clustering: Clustering) -> ExtractSettings {
    ExtractSettings::default().with_clustering(clustering)
}

/// Vertices less edges plus triangles, over what triangles use.
fn euler_characteristic(mesh: &TriangleMesh) -> i64 {
    let vertices: HashSet<u32> = mesh.triangles.iter().flatten().copied().collect();
    let edges: HashSet<(u32, u32)> = directed_sides(mesh).map(|(a, b)| (a.min(b), a.max(b))).collect();
    vertices.len() as i64 - edges.len() as i64 + mesh.triangles.len() as i64
}

#[test]
fn area_and_volume_converge_to_the_ball() {
    let ball = Sphere { radius: 0.83 };
    let (area, volume) = (4.0 * PI * 0.83f64.powi(2), 4.0 / 3.0 * PI * 0.83f64.powi(3));
    for arrangement in ARRANGEMENTS {
        for clustering in [Clustering::None, Clustering::Integrated] {
            let [coarse, fine] =
                [0.1, 0.05].map(|spacing| run(&ball, arrangement, spacing, with(clustering)).mesh);
            let error = |value: f64, exact: f64| (1.0 - value / exact).abs();
            for (coarse, fine, exact) in
                [(coarse.area(), fine.area(), area), (coarse.volume(), fine.volume(), volume)]
            {
                assert!(fine < exact, "an inscribed surface is smaller");
                let (coarse, fine) = (error(coarse, exact), error(fine, exact));
                assert!(fine < 0.006, "{arrangement:?} {clustering:?} {fine}");
                assert!((3.0..5.5).contains(&(coarse / fine)), "second order: {coarse} to {fine}");
            }
        }
    }
}

#[test]
fn unit_sphere_in_its_box_is_closed_with_indexed_positions() {
    for arrangement in ARRANGEMENTS {
        for clustering in [Clustering::None, Clustering::Integrated] {
            let mesh = run(&Sphere::default(), arrangement, 0.04, with(clustering)).mesh;
            assert_closed_manifold(&mesh);
            assert_eq!(euler_characteristic(&mesh), 2, "{arrangement:?} {clustering:?}");
        }
    }
    let counts = run(&Sphere::default(), Arrangement::BodyCentred, 0.04, with(Clustering::Integrated)).counts;
    assert_eq!((counts.vertices, counts.triangles), (13_598, 27_192));
}

/// The accumulated positions put one pole inside by a last bit: a hole of eight sides.
#[test]
fn unit_sphere_in_its_box_is_open_with_accumulated_positions() {
    let settings = with(Clustering::None).with_positions(Positions::Accumulated { chunks: 16 });
    let mesh = run(&Sphere::default(), Arrangement::BodyCentred, 0.04, settings).mesh;
    assert_eq!(euler_characteristic(&mesh), 1);
}

#[test]
fn published_edge_collapse_folds_the_sphere() {
    // Published topology of the collapsed spheres: 10 and 148 where a sphere has 2.
    let positions = Positions::Accumulated { chunks: 16 };
    for (arrangement, characteristic) in ARRANGEMENTS.into_iter().zip([10, 148]) {
        let topology = Topology::Published;
        let settings = with(Clustering::EdgeCollapse).with_positions(positions).with_topology(topology);
        let mesh = run(&Sphere::default(), arrangement, 0.04, settings).mesh;
        assert_eq!(euler_characteristic(&mesh), characteristic, "{arrangement:?}");
    }
}

#[test]
fn vertices_lie_near_the_sphere_and_normals_are_unit_and_outward() {
    // Linear interpolation along the longest lattice edge, a cube's main diagonal: its square over eight radii.
    let sagitta = 1.05 * 3.0 * 0.05 * 0.05 / (8.0 * 0.71);
    for arrangement in ARRANGEMENTS {
        for clustering in [Clustering::None, Clustering::Integrated] {
            let mesh = run(&Sphere { radius: 0.71 }, arrangement, 0.05, with(clustering)).mesh;
            assert_eq!(mesh.normals.len(), mesh.positions.len());
            for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
                assert!((p.length() - 0.71).abs() < sagitta, "{p}");
                assert!((n.length() - 1.0).abs() < 1e-6, "{n}");
                assert!(n.dot(p.normalize()) > 0.9, "{n} at {p}");
            }
            for t in 0..mesh.triangles.len() {
                let [a, b, c] = mesh.corners(t);
                assert!((b - a).cross(c - a).dot(a + b + c) >= -1e-9, "triangle {t} faces inward");
            }
        }
    }
}

#[test]
fn clustering_keeps_the_surface_and_improves_the_triangles() {
    for arrangement in ARRANGEMENTS {
        let [plain, merged] = [Clustering::None, Clustering::Integrated]
            .map(|clustering| run(&Sphere { radius: 0.77 }, arrangement, 0.05, with(clustering)));
        assert!(merged.counts.triangles * 3 < plain.counts.triangles);
        assert!((merged.mesh.volume() / plain.mesh.volume() - 1.0).abs() < 2e-3);
        let quality = |mesh: &TriangleMesh| {
            let total: f32 = (0..mesh.triangles.len())
                .map(|t| {
                    let [a, b, c] = mesh.corners(t);
                    let squares =
                        (b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared();
                    2.0 * 3f32.sqrt() * (b - a).cross(c - a).length() / squares
                })
                .sum();
            total / mesh.triangles.len() as f32
        };
        assert!(quality(&merged.mesh) > 0.83 && quality(&plain.mesh) < 0.75);
    }
}

#[test]
fn isovalue_shifts_the_radius() {
    let settings = ExtractSettings::default().with_isovalue(0.25);
    let shifted = run(&Sphere { radius: 1.0 }, Arrangement::BodyCentred, 0.1, settings).mesh;
    let plain = run(&Sphere { radius: 0.75 }, Arrangement::BodyCentred, 0.1, ExtractSettings::default()).mesh;
    assert_eq!(shifted.triangles, plain.triangles);
    assert!(shifted.positions.iter().zip(&plain.positions).all(|(a, b)| a.distance(*b) < 1e-5));
}

#[test]
fn threads_do_not_show() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    for arrangement in ARRANGEMENTS {
        let lattice = Lattice::try_new(arrangement, bounds, 0.09).unwrap();
        for positions in [Positions::Indexed, Positions::Accumulated { chunks: 7 }] {
            let settings = ExtractSettings::default().with_positions(positions);
            let field = isostudy_field::Asteroid::default();
            let mesh = |threads| extract(&field, &lattice, &settings, &Execution { threads }).unwrap().mesh;
            let bits = |mesh: &TriangleMesh| -> Vec<[u32; 3]> {
                mesh.positions.iter().chain(&mesh.normals).map(|p| p.to_array().map(f32::to_bits)).collect()
            };
            let one = mesh(1);
            assert!(one.triangles.len() > 1000);
            for threads in [0, 2, 3, 16, 1000] {
                let other = mesh(threads);
                assert_eq!(one.triangles, other.triangles, "{threads} threads");
                assert_eq!(bits(&one), bits(&other), "{threads} threads");
            }
        }
    }
}

#[test]
fn stage_times_add_up() {
    for positions in [Positions::Indexed, Positions::Accumulated { chunks: 1 }] {
        for (clustering, collapses) in [
            (Clustering::None, false),
            (Clustering::Integrated, false),
            (Clustering::EdgeCollapse, true),
            (Clustering::IntegratedCollapse, true),
        ] {
            let settings = ExtractSettings::default().with_clustering(clustering).with_positions(positions);
            let before = std::time::Instant::now();
            let times = run(&Sphere { radius: 0.9 }, Arrangement::BodyCentred, 0.05, settings).times;
            let around = before.elapsed();
            let always = [times.allocation, times.sampling, times.vertex, times.geometry, times.normals];
            assert_eq!(times.total(), always.iter().sum::<std::time::Duration>() + times.clustering);
            assert!(times.total() <= around);
            assert!(always.iter().all(|stage| !stage.is_zero()), "{clustering:?}: {times:?}");
            assert_eq!(!times.clustering.is_zero(), collapses, "{clustering:?}: {times:?}");
        }
    }
}
