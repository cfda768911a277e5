//! Placements of vertices: the same triangles, none of them turned over, in better places.

use crate::fields::{FAMILIES, Volume};
use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{
    Arrangement, BoxGrid, Clustering, Execution, ExtractError, Extractor, Placement, Source, Topology,
    accuracy,
};
use isostudy_field::{Asteroid, Gyroid, MeshDistance, Sphere, StudyField};
use isostudy_mesh::quality::quality;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};

const ONE: Execution = Execution { threads: 1 };
const BOTH: [Arrangement; 2] = [Arrangement::BodyCentred, Arrangement::SimpleCubic];
const PLACEMENTS: [Placement; 4] =
    [Placement::MeanOfCrossings, Placement::CurvatureWeighted, Placement::Projected, Placement::Relaxed];

fn cube(half: f32) -> Bounds {
    Bounds { min: Vec3::splat(-half), max: Vec3::splat(half) }
}

/// Every placement but the published one.
fn others(base: ExtractSettings) -> impl Iterator<Item = ExtractSettings> {
    let all = PLACEMENTS.into_iter().flat_map(move |placement| {
        [false, true]
            .map(|refine_crossings| base.with_placement(placement).with_refine_crossings(refine_crossings))
    });
    all.filter(move |settings| *settings != base)
}

/// What all placements promise beside the published one. Returns how many vertices were moved.
fn check(field: &dyn StudyField, lattice: &Lattice, base: ExtractSettings) -> usize {
    let published = extract(field, lattice, &base, &ONE).unwrap().mesh;
    let Bounds { min, max } = lattice.bounds();
    let normal = |mesh: &TriangleMesh, t: usize| {
        let [a, b, c] = mesh.corners(t).map(|p| p.as_dvec3());
        (b - a).cross(c - a)
    };
    let mut moved = 0;
    for settings in others(base) {
        let mesh = extract(field, lattice, &settings, &ONE).unwrap().mesh;
        assert!(mesh.triangles == published.triangles, "{settings:?}");
        for t in 0..mesh.triangles.len() {
            let (before, after) = (normal(&published, t), normal(&mesh, t));
            assert!(after.dot(before) >= 0.1 * before.length_squared(), "{settings:?}: triangle {t}");
        }
        for (&p, &q) in mesh.positions.iter().zip(&published.positions) {
            assert!(p == p.clamp(min, max), "{settings:?}: {p} is beyond the box");
            let reach = lattice.spacing() * 2.0;
            assert!(p.distance(q) <= reach, "{settings:?}: {q} went to {p}");
            moved += usize::from(p != q);
        }
    }
    moved
}

#[test]
fn no_triangle_of_a_smooth_surface_changes_or_turns_over() {
    let ball = extract(
        &Sphere { radius: 0.7 },
        &Lattice::try_new(Arrangement::BodyCentred, cube(1.0), 0.2).unwrap(),
        &ExtractSettings::default(),
        &ONE,
    );
    let solid = MeshDistance::try_new(&ball.unwrap().mesh).unwrap();
    let fields: [(&dyn StudyField, f32); 5] = [
        (&Sphere { radius: 0.8 }, 0.1),
        (&Asteroid::default(), 0.1),
        (&Gyroid::default(), 0.1),
        // Under three points a period.
        (&Gyroid { frequency: 24.0 }, 0.1),
        (&solid, 0.11),
    ];
    for arrangement in BOTH {
        for (field, spacing) in fields {
            let lattice = Lattice::try_new(arrangement, cube(1.0), spacing).unwrap();
            for (clustering, topology) in [
                (Clustering::Integrated, Topology::Guarded),
                (Clustering::Integrated, Topology::Published),
                (Clustering::None, Topology::Guarded),
            ] {
                let base = ExtractSettings::default().with_clustering(clustering).with_topology(topology);
                let moved = check(field, &lattice, base);
                assert!(moved > 100, "{arrangement:?} {base:?}");
            }
        }
    }
}

#[test]
fn no_triangle_of_noise_changes_or_turns_over() {
    for arrangement in BOTH {
        for (seed, family) in (1..).zip(FAMILIES) {
            for clustering in [Clustering::Integrated, Clustering::None] {
                let volume = Volume::random(arrangement, 5, family, seed);
                let lattice = volume.lattice();
                let settings = ExtractSettings::default().with_clustering(clustering);
                check(&volume, &lattice, settings);
                check(&volume.closed(), &lattice, settings);
            }
        }
    }
}

#[test]
fn collapsed_meshes_stay_manifold() {
    for arrangement in BOTH {
        let lattice = Lattice::try_new(arrangement, cube(1.0), 0.1).unwrap();
        for clustering in [Clustering::EdgeCollapse, Clustering::IntegratedCollapse] {
            for settings in others(ExtractSettings::default().with_clustering(clustering)) {
                let mesh = extract(&Asteroid::default(), &lattice, &settings, &ONE).unwrap().mesh;
                let report = topology(&mesh);
                assert!(report.is_closed_manifold(), "{settings:?}: {report:?}");
                assert_eq!((report.euler_characteristic, report.folded_faces), (2, 0), "{settings:?}");
            }
        }
    }
}

#[test]
fn projected_vertices_lie_on_the_surface_and_relaxed_ones_make_better_triangles() {
    let sphere = Sphere { radius: 0.8 };
    let lattice = |arrangement| Lattice::try_new(arrangement, cube(1.0), 0.05).unwrap();
    let with = |placement, arrangement| {
        let settings = ExtractSettings::default().with_placement(placement);
        extract(&sphere, &lattice(arrangement), &settings, &ONE).unwrap().mesh
    };
    for (arrangement, published_quality) in [(BOTH[0], 0.92), (BOTH[1], 0.845)] {
        let of = |mesh: &TriangleMesh| {
            let found = accuracy(mesh, &sphere, 0.0, &BoxGrid::from(&lattice(arrangement)), &ONE).unwrap();
            (quality(mesh).radius_ratio.mean, found.distance.mean, found.normal_error_deg.mean)
        };
        let off =
            |mesh: &TriangleMesh| mesh.positions.iter().map(|p| (p.length() - 0.8).abs()).fold(0.0, f32::max);
        let [published, projected, relaxed] =
            [Placement::MeanOfCrossings, Placement::Projected, Placement::Relaxed]
                .map(|placement| with(placement, arrangement));
        assert!(off(&published) > 1e-4 && off(&projected) < 1e-6 && off(&relaxed) < 1e-6);
        let (published, projected, relaxed) = (of(&published), of(&projected), of(&relaxed));
        assert!((published.0 - published_quality).abs() < 5e-3 && (projected.0 - published.0).abs() < 1e-3);
        assert!(relaxed.0 > published.0 + 0.015, "{relaxed:?}");
        assert!(projected.1 < 0.7 * published.1 && relaxed.1 < 0.7 * published.1);
        assert!(projected.2 < published.2 && relaxed.2 < 0.75 * published.2);
    }
}

#[test]
fn refined_crossings_lie_on_the_surface_and_on_their_edges() {
    // The fourth power makes the interpolation poor.
    struct Steep;
    impl StudyField for Steep {
        fn sample(&self, p: Vec3) -> f32 {
            0.4 - p.length_squared() * p.length_squared()
        }
    }
    let radius = 0.4f32.powf(0.25);
    for arrangement in BOTH {
        let lattice = Lattice::try_new(arrangement, cube(1.0), 0.1).unwrap();
        let plain = ExtractSettings::default().with_clustering(Clustering::None);
        let refined = plain.with_refine_crossings(true);
        let [plain, refined] =
            [plain, refined].map(|settings| extract(&Steep, &lattice, &settings, &ONE).unwrap().mesh);
        let off = |p: &Vec3| f64::from((p.length() - radius).abs());
        let mean =
            |mesh: &TriangleMesh| mesh.positions.iter().map(off).sum::<f64>() / mesh.positions.len() as f64;
        assert!(mean(&refined) < 0.02 * mean(&plain), "{} {}", mean(&refined), mean(&plain));
        for (p, q) in plain.positions.iter().zip(&refined.positions) {
            // Along the edge: a multiple of one of the lattice's offsets.
            let way = *q - *p;
            let unit = way / way.abs().max_element().max(1e-9);
            let whole = unit.to_array().iter().all(|c| c.abs() < 0.02 || (c.abs() - 1.0).abs() < 0.02);
            assert!(way.length() < 1e-4 || whole, "{p} to {q}");
        }
    }
}

#[test]
fn curvature_draws_vertices_to_creases() {
    /// A cube turned away from the axes.
    struct Block;
    impl StudyField for Block {
        fn sample(&self, p: Vec3) -> f32 {
            let turned = glam::Quat::from_euler(glam::EulerRot::XYZ, 0.5, 0.7, 0.3) * p;
            0.6 - turned.abs().max_element()
        }
    }
    for arrangement in BOTH {
        let lattice = Lattice::try_new(arrangement, cube(1.2), 0.08).unwrap();
        let distances = [Placement::MeanOfCrossings, Placement::CurvatureWeighted].map(|placement| {
            let settings = ExtractSettings::default().with_placement(placement);
            let mesh = extract(&Block, &lattice, &settings, &ONE).unwrap().mesh;
            accuracy(&mesh, &Block, 0.0, &BoxGrid::from(&lattice), &ONE).unwrap().distance.mean
        });
        assert!(distances[1] < 0.9 * distances[0], "{distances:?}");
    }
}

#[test]
fn threads_do_not_show() {
    let lattice = Lattice::try_new(Arrangement::BodyCentred, cube(1.0), 0.04).unwrap();
    for settings in others(ExtractSettings::default()) {
        let one = extract(&Asteroid::default(), &lattice, &settings, &ONE).unwrap();
        for threads in [2, 3, 0] {
            let many = extract(&Asteroid::default(), &lattice, &settings, &Execution { threads }).unwrap();
            assert!(one.mesh == many.mesh, "{settings:?} on {threads} threads");
        }
    }
}

#[test]
fn given_samples_cannot_be_asked_between() {
    let lattice = Lattice::try_new(Arrangement::SimpleCubic, cube(1.0), 0.5).unwrap();
    let samples = vec![-1.0; lattice.stored_samples() as usize];
    for settings in others(ExtractSettings::default()) {
        let result = Extractor::new().extract(Source::Samples(&samples), &lattice, &settings, &ONE);
        let ExtractSettings { placement, refine_crossings, .. } = settings;
        if placement == Placement::CurvatureWeighted && !refine_crossings {
            assert!(result.is_ok());
        } else {
            let error = ExtractError::PlacementNeedsField { placement, refine_crossings };
            assert_eq!(result.unwrap_err(), error);
        }
    }
}
