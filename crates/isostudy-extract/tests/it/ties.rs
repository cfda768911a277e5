//! Samples that equal the isovalue: their vertices stay apart, so that no triangle is without area, and where a vertex
//! has the place of a sample to itself it stays in it.

use crate::fields::{FAMILIES, Family, Numbers, Volume};
use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Clustering, Execution, Topology};
use isostudy_field::{Beyond, StudyField, VolumeField};
use isostudy_mesh::quality::quality;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};
use proptest::prelude::*;

const CLUSTERINGS: [Clustering; 4] =
    [Clustering::None, Clustering::Integrated, Clustering::EdgeCollapse, Clustering::IntegratedCollapse];

fn mesh_of(field: &dyn StudyField, lattice: &Lattice, clustering: Clustering, isovalue: f32) -> TriangleMesh {
    let settings = ExtractSettings::default().with_clustering(clustering).with_isovalue(isovalue);
    extract(field, lattice, &settings, &Execution { threads: 1 }).unwrap().mesh
}

/// Every one of the clusterings that the arrangement has.
fn check(field: &dyn StudyField, lattice: &Lattice, clusterings: &[Clustering], isovalue: f32, what: &str) {
    let arrangement = lattice.arrangement();
    for &clustering in clusterings.iter().filter(|&&clustering| arrangement.supports(clustering)) {
        let mesh = mesh_of(field, lattice, clustering, isovalue);
        assert_eq!(quality(&mesh).degenerate, 0, "{what} at {isovalue}: {arrangement} {clustering}");
        let report = topology(&mesh);
        let faults = (report.non_manifold_edges, report.misoriented_edges, report.non_manifold_vertices);
        assert_eq!(faults, (0, 0, 0), "{what} at {isovalue}: {arrangement} {clustering}");
        let Bounds { min, max } = lattice.bounds();
        assert!(mesh.positions.iter().all(|p| p.cmpge(min).all() && p.cmple(max).all()), "{what}");
    }
}

const SIDE: usize = 14;

/// Whole numbers: blobs with noise, noise, and labels.
fn whole_numbers(kind: u64, seed: u64, step: f64, origin: f64) -> VolumeField {
    let mut numbers = Numbers::new(seed);
    let mut unit = move || numbers.below(1 << 24) as f32 / (1 << 24) as f32;
    let blobs: Vec<(Vec3, f32)> =
        (0..4).map(|_| (Vec3::new(unit(), unit(), unit()) * SIDE as f32, 2.0 + 3.0 * unit())).collect();
    let values = (0..SIDE.pow(3)).map(|i| {
        let p = Vec3::new((i % SIDE) as f32, (i / SIDE % SIDE) as f32, (i / SIDE / SIDE) as f32);
        let ratios = blobs.iter().map(|(centre, radius)| p.distance(*centre) / radius);
        let value = match kind {
            0 => ratios.map(|ratio| 8.0 / (1.0 + ratio * ratio * ratio)).sum::<f32>() + 1.5 * unit(),
            1 => 12.0 * unit(),
            _ => 4.0 * ratios.filter(|&ratio| ratio < 1.0).count() as f32,
        };
        value.round()
    });
    let steps = [[step, 0.0, 0.0], [0.0, step, 0.0], [0.0, 0.0, step]];
    VolumeField::try_new([SIDE; 3], values.collect(), [origin; 3], steps, Beyond::Continued).unwrap()
}

#[test]
fn volumes_of_whole_numbers_have_no_triangle_without_area() {
    for (kind, name) in ["blobs", "noise", "labels"].into_iter().enumerate() {
        for (seed, (step, origin)) in
            [(1.0, 0.0), (0.7, -3.0), (1.0, -1000.25), (0.48, 212.5)].into_iter().enumerate()
        {
            let field = whole_numbers(kind as u64, seed as u64, step, origin);
            for arrangement in Arrangement::ALL {
                let lattice = Lattice::try_new(arrangement, field.bounds(), field.spacing()).unwrap();
                for isovalue in [4.0, 4.5, 4.25, 1.0, 6.5, 7.125] {
                    check(&field, &lattice, &CLUSTERINGS, isovalue, &format!("{name} {step} {origin}"));
                }
            }
        }
    }
}

/// The rule is the guarded topology's: as published they lie in one place.
#[test]
fn the_published_topology_keeps_its_rule() {
    let field = whole_numbers(1, 0, 1.0, 0.0);
    let lattice = Lattice::try_new(Arrangement::BodyCentred, field.bounds(), 1.0).unwrap();
    let settings = ExtractSettings::default()
        .with_clustering(Clustering::None)
        .with_topology(Topology::Published)
        .with_isovalue(4.5);
    let mesh = extract(&field, &lattice, &settings, &Execution { threads: 1 }).unwrap().mesh;
    assert!(quality(&mesh).degenerate > 500);
}

/// A height above a level, both exact in `f32`.
struct Above(f32);

impl StudyField for Above {
    fn sample(&self, p: Vec3) -> f32 {
        self.0 - p.z
    }
}

#[test]
fn a_plane_through_samples_stays_where_it_is() {
    let bounds = Bounds { min: Vec3::splat(-2.0), max: Vec3::splat(2.0) };
    for arrangement in Arrangement::ALL {
        let lattice = Lattice::try_new(arrangement, bounds, 0.25).unwrap();
        for level in [0.0, 0.5, -0.125] {
            let farthest = |clustering| {
                let mesh = mesh_of(&Above(level), &lattice, clustering, 0.0);
                mesh.positions.iter().map(|p| (p.z - level).abs()).fold(0.0, f32::max)
            };
            // Displaced by some units in the last place of the farthest coordinate, 2.
            let unclustered = farthest(Clustering::None);
            assert!(unclustered < 32.0 * 2.0 * f32::EPSILON, "{arrangement} {level}: {unclustered}");
            if arrangement.supports(Clustering::Integrated) {
                assert_eq!(farthest(Clustering::Integrated), 0.0, "{arrangement} {level}");
            }
        }
    }
}

/// Small triangles at samples face the same way as the others.
#[test]
fn planes_through_samples_turn_no_triangle_over() {
    struct Plane(Vec3);
    impl StudyField for Plane {
        fn sample(&self, p: Vec3) -> f32 {
            -self.0.dot(p)
        }
    }
    let bounds = Bounds { min: Vec3::splat(-2.0), max: Vec3::splat(2.0) };
    for arrangement in Arrangement::ALL {
        let lattice = Lattice::try_new(arrangement, bounds, 0.25).unwrap();
        for normal in [[1.0, 1.0, 0.0], [1.0, 2.0, -1.0], [1.0, 1.0, 1.0], [3.0, -1.0, 2.0], [0.0, 1.0, 4.0]]
        {
            let normal = Vec3::from(normal);
            let mesh = mesh_of(&Plane(normal), &lattice, Clustering::None, 0.0);
            let turned = (0..mesh.triangles.len()).filter(|&t| {
                let [a, b, c] = mesh.corners(t).map(|p| p.as_dvec3());
                (b - a).cross(c - a).dot(normal.as_dvec3()) < 0.0
            });
            assert_eq!(turned.count(), 0, "{arrangement} {normal}");
        }
    }
}

#[test]
fn ties_beside_samples_that_are_not_numbers_have_an_area() {
    for arrangement in Arrangement::ALL {
        for seed in 0..40 {
            let volume = Volume::random(arrangement, 4, Family::Odd, seed);
            // Crossings without a place may lie in a line: only the manifold is promised.
            let lattice = volume.lattice();
            let mesh = mesh_of(&volume, &lattice, Clustering::None, 0.0);
            assert_eq!(quality(&mesh).degenerate, 0, "{arrangement} {seed}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Any family, of which some are full of ties and equal differences, at isovalues that samples have. Without means of
    /// crossings, which can lie in a line.
    #[test]
    fn random_volumes_have_no_triangle_without_area(
        family in 0..14usize,
        seed: u64,
        arrangement in 0..4usize,
        cells in 1..7usize,
        isovalue in prop::sample::select(vec![0.0f32, 0.5, -0.5, 0.25, -1.0]),
    ) {
        let volume = Volume::random(Arrangement::ALL[arrangement], cells, FAMILIES[family], seed);
        let volume = if seed % 2 == 0 { volume.closed() } else { volume };
        let whole = [Clustering::None, Clustering::EdgeCollapse];
        check(&volume, &volume.lattice(), &whole, isovalue, &format!("{:?} {seed}", FAMILIES[family]));
    }
}
