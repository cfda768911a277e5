//! The streaming extractor against the dense one: the same mesh to the byte, and the same counts.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::Vec3;
use isostudy_mesh::Bounds;
use proptest::prelude::*;

use super::super::dense;
use crate::bunny::{BOX, bunny};
use crate::by_lattice::{ExtractSettings, Lattice};
use crate::lattice::{Border, Coordinates, Layout};
use crate::{
    Arrangement, Clustering, Execution, ExtractError, Extraction, Extractor, Placement, Positions, Source,
    Topology,
};
use isostudy_field::{Asteroid, Gyroid, MeshDistance, Sphere, StudyField};

/// Noise by position. Values are multiples of `1 / levels`; of `odd` points in 64, some are not numbers, some infinite.
#[derive(Debug, Clone, Copy)]
struct Noise {
    seed: u32,
    levels: u32,
    odd: u32,
    /// Neighbouring points in cubes of this size share a value.
    grain: f32,
}

impl StudyField for Noise {
    fn sample(&self, p: Vec3) -> f32 {
        let bits = (p / self.grain).floor().to_array().map(|v| v as i32 as u32);
        let mut mixed = bits.iter().fold(self.seed ^ 0x9e37_79b9, |h, &b| {
            let h = (h ^ b).wrapping_mul(0x85eb_ca6b);
            (h ^ h >> 13).wrapping_mul(0xc2b2_ae35) ^ h >> 16
        });
        mixed ^= mixed >> 15;
        match (mixed >> 8) % 64 {
            n if n < self.odd => [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0][mixed as usize % 4],
            _ => (mixed % (2 * self.levels + 1)) as f32 / self.levels as f32 - 1.0,
        }
    }
}

const BOTH: [Arrangement; 2] = [Arrangement::BodyCentred, Arrangement::SimpleCubic];

fn lattice(arrangement: Arrangement, cells: [u32; 3]) -> Lattice {
    let max = Vec3::from_array(cells.map(|n| n as f32));
    Lattice::try_new(arrangement, Bounds { min: Vec3::ZERO, max }, 1.0).unwrap()
}

fn assert_same(left: &Extraction, right: &Extraction) {
    assert_eq!(left.counts, right.counts);
    let bits = |points: &[Vec3]| points.iter().map(|p| p.to_array().map(f32::to_bits)).collect::<Vec<_>>();
    assert!(bits(&left.mesh.positions) == bits(&right.mesh.positions), "positions differ");
    assert!(left.mesh.triangles == right.mesh.triangles, "triangles differ");
    assert!(bits(&left.mesh.normals) == bits(&right.mesh.normals), "normals differ");
}

/// All ways of the streaming extractor against the dense one.
fn check(field: &dyn StudyField, lattice: &Lattice, isovalue: f32) {
    check_with(field, lattice, all_settings(isovalue));
}

fn check_with(field: &dyn StudyField, lattice: &Lattice, all: impl Iterator<Item = ExtractSettings>) {
    let mut extractor = Extractor::new();
    for settings in all {
        let samples = all_samples(field, lattice, &settings);
        let one = Execution { threads: 1 };
        let expected = dense::extract(field, lattice, &settings, (&one).into(), u32::MAX).unwrap();
        for threads in [1, 3] {
            let execution = Execution { threads };
            let called = extractor.extract(Source::Study(field), lattice, &settings, &execution).unwrap();
            assert_same(&called, &expected);
            let given = extractor.extract(Source::Samples(&samples), lattice, &settings, &execution).unwrap();
            assert_same(&given, &expected);
        }
    }
}

/// Every clustering by every topology.
fn all_settings(isovalue: f32) -> impl Iterator<Item = ExtractSettings> {
    let clusterings =
        [Clustering::None, Clustering::Integrated, Clustering::EdgeCollapse, Clustering::IntegratedCollapse];
    clusterings.into_iter().flat_map(move |clustering| {
        [Topology::Guarded, Topology::Published].map(|topology| ExtractSettings {
            isovalue,
            clustering,
            topology,
            ..ExtractSettings::default()
        })
    })
}

/// The placements that need more than the mean of interpolated crossings, by clusterings.
fn placed_settings() -> impl Iterator<Item = ExtractSettings> {
    let placements = [Placement::CurvatureWeighted, Placement::Projected, Placement::Relaxed];
    let refined = ExtractSettings { refine_crossings: true, ..ExtractSettings::default() };
    let placed = placements.map(|placement| ExtractSettings { placement, ..ExtractSettings::default() });
    placed.into_iter().chain([refined]).flat_map(|settings| {
        [Clustering::Integrated, Clustering::None, Clustering::IntegratedCollapse]
            .map(|clustering| ExtractSettings { clustering, ..settings })
    })
}

/// What the dense extractor has in memory.
fn all_samples(field: &dyn StudyField, lattice: &Lattice, settings: &ExtractSettings) -> Vec<f32> {
    let (layout, border) = (Layout::new(lattice), Border::of(settings));
    let coordinates = Coordinates::sampled(lattice, &layout, Positions::Indexed, border).unwrap();
    let mut samples = vec![0.0; layout.len()];
    crate::tetrahedra::dense::sampling::sample(
        field,
        &layout,
        &coordinates,
        Default::default(),
        &mut samples,
    )
    .unwrap();
    samples
}

fn noise() -> impl Strategy<Value = Noise> {
    let levels = prop_oneof![Just(1), Just(2), Just(5), Just(10_000_000)];
    let odd = prop_oneof![3 => Just(0), 1 => Just(4), 1 => Just(40)];
    let grain = prop_oneof![Just(0.25), Just(1.7), Just(3.1)];
    (any::<u32>(), levels, odd, grain).prop_map(|(seed, levels, odd, grain)| Noise {
        seed,
        levels,
        odd,
        grain,
    })
}

fn arrangement() -> impl Strategy<Value = Arrangement> {
    prop_oneof![Just(Arrangement::BodyCentred), Just(Arrangement::SimpleCubic)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Surfaces through every boundary, ties, zeros, and samples that are not numbers.
    #[test]
    fn noise_gives_the_stored_mesh(
        field in noise(),
        arrangement in arrangement(),
        cells in [1u32..8, 1u32..8, 1u32..24],
        isovalue in prop_oneof![Just(0.0f32), Just(0.2), Just(-1.0), Just(5.0)],
    ) {
        check(&field, &lattice(arrangement, cells), isovalue);
    }

    /// Rows about a word long.
    #[test]
    fn long_rows_give_the_stored_mesh(
        field in noise(),
        arrangement in arrangement(),
        x in prop_oneof![60u32..67, 124u32..130],
        z in 1u32..3,
    ) {
        check(&field, &lattice(arrangement, [x, 2, z]), 0.0);
    }
}

#[test]
fn every_placement_is_that_of_the_stored_mesh() {
    let noise = Noise { seed: 7, levels: 10_000_000, odd: 4, grain: 1.7 };
    let fields: [(&dyn StudyField, f32); 3] =
        [(&Asteroid::default(), 0.09), (&Gyroid::default(), 0.11), (&noise, 1.0)];
    for arrangement in BOTH {
        for (field, spacing) in fields {
            let max = Vec3::new(1.0, 0.9, 1.6) * if spacing == 1.0 { 9.0 } else { 1.0 };
            let lattice = Lattice::try_new(arrangement, Bounds { min: -max, max }, spacing).unwrap();
            for settings in placed_settings() {
                let expected =
                    dense::extract(field, &lattice, &settings, Default::default(), u32::MAX).unwrap();
                for threads in [1, 3] {
                    let source = Source::Study(field);
                    let found = Extractor::new().extract(source, &lattice, &settings, &Execution { threads });
                    assert_same(&found.unwrap(), &expected);
                }
            }
        }
    }
}

#[test]
fn one_cell_of_every_pattern() {
    /// Inside where the bit of the cell's corner is set; a centre is the middle of its corners.
    struct Corners(u32);
    impl StudyField for Corners {
        fn sample(&self, p: Vec3) -> f32 {
            let value = |i: u32| if self.0 >> i & 1 != 0 { 1.0 } else { -0.7 };
            let near = |v: f32| v.clamp(0.0, 1.0);
            let (x, y, z) = (near(p.x), near(p.y), near(p.z));
            let along = |y: u32, z: u32| value(2 * y + 4 * z) * (1.0 - x) + value(1 + 2 * y + 4 * z) * x;
            (along(0, 0) * (1.0 - y) + along(1, 0) * y) * (1.0 - z)
                + (along(0, 1) * (1.0 - y) + along(1, 1) * y) * z
        }
    }
    for arrangement in BOTH {
        for pattern in 0..256 {
            check(&Corners(pattern), &lattice(arrangement, [1, 1, 1]), 0.0);
        }
    }
}

/// Several slabs and tiles of all sizes. What edges collapse from is then the same, which coarse lattices show as well
/// in a fraction of the time.
#[test]
fn smooth_fields_give_the_stored_mesh() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let rough = Asteroid { amplitude: 0.6, gain: 0.5, ..Asteroid::default() };
    let fields: [(&dyn StudyField, f32); 6] = [
        (&Sphere { radius: 1.0 }, 0.0),
        (&Sphere { radius: 0.8 }, 0.1),
        (&Asteroid::default(), 0.0),
        (&rough, 0.05),
        (&Gyroid::default(), 0.0),
        (&Gyroid { frequency: 20.0 }, 0.9),
    ];
    let collapses = |settings: &ExtractSettings| {
        matches!(settings.clustering, Clustering::EdgeCollapse | Clustering::IntegratedCollapse)
    };
    for arrangement in BOTH {
        let lattice = |spacing| Lattice::try_new(arrangement, bounds, spacing).unwrap();
        for (i, (field, isovalue)) in fields.into_iter().enumerate() {
            // Each sort of field with tiles that fit and, the other way round on the other lattice, with some that do not.
            let spacing = [0.05, 0.041][(i + arrangement as usize) % 2];
            let settings = all_settings(isovalue).filter(|settings| !collapses(settings));
            check_with(field, &lattice(spacing), settings);
            check_with(field, &lattice(0.1), all_settings(isovalue).filter(collapses));
        }
    }
}

/// Known distances and known sides are used, and change nothing.
#[test]
fn the_distance_to_a_mesh_gives_the_stored_mesh() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let coarse = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.1).unwrap();
    let rough = Asteroid { amplitude: 0.3, gain: 0.5, ..Asteroid::default() };
    let settings = ExtractSettings::default();
    let solid = Extractor::new()
        .extract(Source::Study(&rough), &coarse, &settings, &Execution { threads: 1 })
        .unwrap();
    let field = MeshDistance::try_new(&solid.mesh).unwrap();
    for arrangement in BOTH {
        let lattice = Lattice::try_new(arrangement, bounds, 0.037).unwrap();
        for isovalue in [0.0, 0.05, -0.1] {
            check(&field, &lattice, isovalue);
        }
    }
}

/// The same on the evaluation's bunny, where it is.
#[test]
fn the_bunny_gives_the_stored_mesh() {
    let Some(bunny) = bunny() else { return };
    let field = MeshDistance::try_new(&bunny).unwrap();
    let lattice = Lattice::try_new(Arrangement::BodyCentred, BOX, 0.02).unwrap();
    let (settings, execution) = (ExtractSettings::default(), Execution { threads: 1 });
    let expected = dense::extract(&field, &lattice, &settings, (&execution).into(), u32::MAX).unwrap();
    let streamed = Extractor::new().extract(Source::Study(&field), &lattice, &settings, &execution).unwrap();
    assert_same(&streamed, &expected);
}

/// Counts samples.
struct Counting<F>(F, AtomicUsize);

impl<F: StudyField> StudyField for Counting<F> {
    fn sample(&self, p: Vec3) -> f32 {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.sample(p)
    }

    fn slope(&self, bounds: Bounds) -> Option<f32> {
        self.0.slope(bounds)
    }
}

#[test]
fn far_from_the_surface_nothing_is_sampled() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    for arrangement in BOTH {
        let lattice = Lattice::try_new(arrangement, bounds, 2.0 / 128.0).unwrap();
        let field = Counting(Sphere { radius: 0.8 }, AtomicUsize::new(0));
        let execution = Execution { threads: 1 };
        let source = Source::Study(&field);
        Extractor::new().extract(source, &lattice, &ExtractSettings::default(), &execution).unwrap();
        let taken = field.1.load(Ordering::Relaxed) as f64 / lattice.stored_samples() as f64;
        assert!(taken < 0.12, "{arrangement:?}: {taken} of all points");
    }
}

#[test]
fn given_samples_must_be_as_many_as_the_lattice_has() {
    let lattice = lattice(Arrangement::BodyCentred, [2, 2, 2]);
    let samples = vec![0.0; 5];
    let settings = ExtractSettings::default();
    let error = Extractor::new()
        .extract(Source::Samples(&samples), &lattice, &settings, &Execution::default())
        .unwrap_err();
    assert_eq!(error, ExtractError::SampleCount { given: 5, wanted: lattice.stored_samples() });
}

#[test]
fn odd_fields_have_a_mesh_and_odd_isovalues_an_error() {
    struct Constant(f32);
    impl StudyField for Constant {
        fn sample(&self, _: Vec3) -> f32 {
            self.0
        }
    }
    for arrangement in BOTH {
        let lattice = lattice(arrangement, [3, 4, 20]);
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, 1.0] {
            for isovalue in [0.0, 1.0, f32::MAX, f32::MIN] {
                check(&Constant(value), &lattice, isovalue);
            }
        }
        for isovalue in [f32::NAN, f32::INFINITY] {
            let settings = ExtractSettings { isovalue, ..ExtractSettings::default() };
            let result = Extractor::new().extract(
                Source::Study(&Constant(0.0)),
                &lattice,
                &settings,
                &Execution::default(),
            );
            assert!(matches!(result, Err(ExtractError::Isovalue { .. })), "{isovalue}");
        }
    }
}

#[test]
fn progress_ends_with_all_layers() {
    use std::sync::{Arc, Mutex};
    let seen = Arc::new(Mutex::new(Vec::new()));
    let log = Arc::clone(&seen);
    let lattice = lattice(Arrangement::BodyCentred, [4, 4, 40]);
    let field: &dyn StudyField = &Sphere { radius: 3.0 };
    let mut extractor =
        Extractor::new().with_progress(move |done, all| log.lock().unwrap().push((done, all)));
    extractor
        .extract(field.into(), &lattice, &ExtractSettings::default(), &Execution { threads: 2 })
        .unwrap();
    let mut seen = seen.lock().unwrap().clone();
    seen.sort_unstable();
    assert_eq!(seen, (1..=83).map(|done| (done, 83)).collect::<Vec<_>>());
}
