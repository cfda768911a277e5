//! The arrangements whose cubes are cut each by itself: manifolds whatever the samples, and nearer to the surface the
//! finer the lattice.

use std::f64::consts::PI;

use crate::fields::{FAMILIES, Family, Volume};
use crate::survey::{Component, survey};
use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{
    Arrangement, BoxGrid, Clustering, Execution, ExtractError, Extraction, Extractor, Placement, Positions,
    Source, Topology, accuracy,
};
use isostudy_field::{Asteroid, Gyroid, Sphere, StudyField};
use isostudy_mesh::Bounds;
use isostudy_mesh::topology::topology;
use rayon::prelude::*;

const BY_CUBES: [Arrangement; 2] = [Arrangement::FiveTetrahedra, Arrangement::FaceCentred];
const CUBE: Bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
const ONE: Execution = Execution { threads: 1 };

fn settings(clustering: Clustering) -> ExtractSettings {
    ExtractSettings::default().with_clustering(clustering)
}

fn run(field: &dyn StudyField, lattice: &Lattice, clustering: Clustering) -> Extraction {
    extract(field, lattice, &settings(clustering), &ONE).unwrap()
}

fn components(extraction: &Extraction, what: &str) -> Vec<Component> {
    let mesh = &extraction.mesh;
    survey(mesh.positions.len(), &mesh.triangles).unwrap_or_else(|fault| panic!("{what}: {fault}"))
}

#[test]
fn any_samples_give_a_manifold_and_the_collapse_keeps_it() {
    let cases: Vec<_> = FAMILIES
        .into_iter()
        .flat_map(|family| (0..8).map(move |seed| (family, seed)))
        .flat_map(|(family, seed)| BY_CUBES.map(|arrangement| (family, seed, arrangement)))
        .collect();
    cases.par_iter().for_each(|&(family, seed, arrangement)| {
        for cells in [1, 2, 5] {
            for closed in [false, true] {
                let what = format!("{family:?} {seed} {arrangement:?} {cells} cells, closed {closed}");
                let volume = Volume::random(arrangement, cells, family, seed);
                let volume = if closed { volume.closed() } else { volume };
                let plain = run(&volume, &volume.lattice(), Clustering::None);
                let found = components(&plain, &what);
                assert_eq!(
                    (plain.counts.vertices, plain.counts.discarded_triangles),
                    (plain.counts.crossings, 0)
                );
                assert!(!closed || found.iter().all(|component| component.1 == 0), "{what} is open");
                if closed && family != Family::Odd && !plain.mesh.triangles.is_empty() {
                    assert!(plain.mesh.volume() > 0.0, "{what} faces inward");
                }
                let collapsed = run(&volume, &volume.lattice(), Clustering::EdgeCollapse);
                assert_eq!(components(&collapsed, &what), found, "{what}");
            }
        }
    });
}

/// A ring round the z axis.
struct Torus;

impl StudyField for Torus {
    fn sample(&self, p: Vec3) -> f32 {
        0.22 - Vec3::new(p.truncate().length() - 0.6, p.z, 0.0).length()
    }
}

#[test]
fn genus_is_that_of_the_surface() {
    for arrangement in Arrangement::ALL {
        for spacing in [0.09, 0.041] {
            let lattice = Lattice::try_new(arrangement, CUBE, spacing).unwrap();
            let fields: [(&dyn StudyField, i64); 3] =
                [(&Sphere { radius: 0.8 }, 2), (&Torus, 0), (&Asteroid::default(), 2)];
            for (field, characteristic) in fields {
                let report = topology(&run(field, &lattice, Clustering::None).mesh);
                assert!(report.is_closed_manifold(), "{arrangement:?} {report:?}");
                assert_eq!(
                    (report.euler_characteristic, report.components),
                    (characteristic, 1),
                    "{arrangement:?}"
                );
            }
        }
    }
}

/// Halving the spacing divides what area and volume fall short by four: linear interpolation is of second order.
#[test]
fn area_and_volume_converge_at_second_order() {
    let radius = 0.8f64;
    let exact = [4.0 * PI * radius.powi(2), 4.0 / 3.0 * PI * radius.powi(3)];
    for arrangement in BY_CUBES {
        let shortfall = [0.1f32, 0.05, 0.025].map(|spacing| {
            let lattice = Lattice::try_new(arrangement, CUBE, spacing).unwrap();
            let mesh = run(&Sphere { radius: radius as f32 }, &lattice, Clustering::None).mesh;
            [exact[0] - mesh.area(), exact[1] - mesh.volume()]
        });
        for of in [0, 1] {
            let shortfall = shortfall.map(|both| both[of]);
            assert!(shortfall[2] > 0.0, "{arrangement:?}: inside a convex surface");
            for pair in shortfall.windows(2) {
                let ratio = pair[0] / pair[1];
                assert!((3.7..4.3).contains(&ratio), "{arrangement:?}: {ratio}");
            }
        }
        // And so does each point: the sagitta of an edge of the spacing on the sphere is h^2 / 8 r.
        let lattice = Lattice::try_new(arrangement, CUBE, 0.05).unwrap();
        let sphere = Sphere { radius: radius as f32 };
        let mesh = run(&sphere, &lattice, Clustering::None).mesh;
        let distance = accuracy(&mesh, &sphere, 0.0, &BoxGrid::from(&lattice), &ONE).unwrap().distance;
        assert!(distance.max < 2.0 * 0.05f64.powi(2) / (4.0 * radius), "{arrangement:?} {distance:?}");
    }
}

/// The face-centred cube has all the mirror planes of the cube, and the sphere's mesh with it; five tetrahedra need the
/// planes to go through corners.
#[test]
fn a_symmetric_field_has_a_symmetric_mesh() {
    for arrangement in BY_CUBES {
        let lattice = Lattice::try_new(arrangement, CUBE, 0.125).unwrap();
        let mesh = run(&Sphere { radius: 0.8 }, &lattice, Clustering::None).mesh;
        let sorted = |turn: &dyn Fn(Vec3) -> Vec3| {
            let mut points: Vec<[i32; 3]> = mesh
                .positions
                .iter()
                .map(|&p| (turn(p) * 1e5).round().to_array().map(|c| c as i32))
                .collect();
            points.sort_unstable();
            points
        };
        let whole = sorted(&|p| p);
        for (name, turn) in [
            ("x mirrored", &(|p: Vec3| Vec3::new(-p.x, p.y, p.z)) as &dyn Fn(Vec3) -> Vec3),
            ("y mirrored", &|p| Vec3::new(p.x, -p.y, p.z)),
            ("x and z exchanged", &|p| Vec3::new(p.z, p.y, p.x)),
            ("axes turned", &|p| Vec3::new(p.y, p.z, p.x)),
        ] {
            assert_eq!(sorted(turn), whole, "{arrangement:?} {name}");
        }
    }
}

#[test]
fn vertices_stand_on_the_surface_where_the_field_is_called() {
    let (field, spacing) = (Gyroid::default(), 0.03);
    for arrangement in BY_CUBES {
        let lattice = Lattice::try_new(arrangement, CUBE, spacing).unwrap();
        // Of the vertex in the middle: some of the others stay, lest a sliver turn over.
        let median_off = |settings: ExtractSettings| {
            let extraction = extract(&field, &lattice, &settings, &ONE).unwrap();
            let positions = &extraction.mesh.positions;
            let mut values: Vec<f32> = positions.iter().map(|&p| field.sample(p).abs()).collect();
            values.sort_unstable_by(f32::total_cmp);
            let median = values[values.len() / 2];
            (extraction.mesh.triangles, median)
        };
        let plain = settings(Clustering::None);
        let (triangles, interpolated) = median_off(plain);
        let projected = plain.with_placement(Placement::Projected);
        let refined = plain.with_refine_crossings(true);
        for better in [projected, refined] {
            let (same, off) = median_off(better);
            assert_eq!(same, triangles, "{arrangement:?}: vertices move, triangles stay");
            assert!(off < 0.1 * interpolated, "{arrangement:?}: {off} of {interpolated}");
        }
        // The weighted mean of one crossing is the crossing.
        let weighted = plain.with_placement(Placement::CurvatureWeighted);
        assert!((median_off(weighted).1 - interpolated).abs() < 1e-5);
    }
}

/// As published, a crossing in the middle of its edge has a vertex at either end; guarded, at the inside one.
#[test]
fn ties_follow_the_topology() {
    struct Levels;
    impl StudyField for Levels {
        fn sample(&self, p: Vec3) -> f32 {
            if p.x < 0.3 { 1.0 } else { -1.0 }
        }
    }
    for arrangement in BY_CUBES {
        let lattice = Lattice::try_new(arrangement, CUBE, 0.5).unwrap();
        let [guarded, published] = [Topology::Guarded, Topology::Published].map(|topology| {
            let settings = settings(Clustering::None).with_topology(topology);
            extract(&Levels, &lattice, &settings, &ONE).unwrap().counts
        });
        assert_eq!((guarded.vertices, published.vertices), (guarded.crossings, 2 * guarded.crossings));
        assert_eq!(guarded.triangles, published.triangles);
    }
}

#[test]
fn buffers_samples_and_threads_do_not_show() {
    for arrangement in BY_CUBES {
        let mut extractor = Extractor::new();
        for cells in [7, 4] {
            let volume = Volume::random(arrangement, cells, Family::LowPassOnce, 5);
            let lattice = volume.lattice();
            let expected = run(&volume, &lattice, Clustering::None);
            for threads in [0, 1, 3] {
                let execution = Execution { threads };
                let settings = settings(Clustering::None);
                let again =
                    extractor.extract(Source::Study(&volume), &lattice, &settings, &execution).unwrap();
                assert_eq!((again.mesh, again.counts), (expected.mesh.clone(), expected.counts));
            }
            assert_eq!(expected.counts.samples, lattice.needed_samples());
            assert_eq!(lattice.memory_bytes(), 9 * lattice.stored_samples());
        }
    }
}

#[test]
fn what_an_arrangement_does_not_have_is_an_error() {
    for arrangement in BY_CUBES {
        let lattice = Lattice::try_new(arrangement, CUBE, 0.5).unwrap();
        for clustering in [Clustering::Integrated, Clustering::IntegratedCollapse] {
            let error = extract(&Sphere { radius: 0.8 }, &lattice, &settings(clustering), &ONE).unwrap_err();
            assert_eq!(error, ExtractError::ArrangementClustering { arrangement, clustering });
            let text = error.to_string();
            assert!(
                text.contains("none and edge-collapse") && text.contains("body-centred"),
                "says what there is: {text}"
            );
        }
        let positions = Positions::Accumulated { chunks: 16 };
        let accumulated = settings(Clustering::None).with_positions(positions);
        let error = extract(&Sphere { radius: 0.8 }, &lattice, &accumulated, &ONE).unwrap_err();
        assert_eq!(error, ExtractError::ArrangementAccumulated { arrangement });
    }
}
