//! Lattice sizes, and every way to ask for an impossible one.

use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Clustering, Execution, ExtractError, LatticeError, Positions};
use isostudy_field::{Sphere, StudyField};
use isostudy_mesh::Bounds;

const UNIT: Bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };

fn body_centred(bounds: Bounds, spacing: f32) -> Result<Lattice, LatticeError> {
    Lattice::try_new(Arrangement::BodyCentred, bounds, spacing)
}

#[test]
fn twenty_cells_a_side_as_the_original_shows_them() {
    let lattice = body_centred(UNIT, 0.1).unwrap();
    assert_eq!(lattice.cells(), [20; 3]);
    assert_eq!(lattice.stored_samples(), 20_812);
    assert_eq!(lattice.needed_samples(), 19_661);
    assert_eq!(lattice.stored_edges(), 291_368);
    assert_eq!(lattice.needed_edges(), 125_260);
    assert_eq!(lattice.tetrahedra(), 100_800);
    let extraction =
        extract(&Sphere::default(), &lattice, &ExtractSettings::default(), &Execution::default()).unwrap();
    assert_eq!(extraction.counts.tetrahedra.unwrap().tetrahedra_evaluated, 25_056);
}

#[test]
fn cells_are_counted_in_single_precision() {
    // 1.1 / 0.02 is 55.000004 in f32, so 56 cells; the published bunny has them.
    let bounds = Bounds { min: Vec3::new(-0.7, -0.4, -0.5), max: Vec3::new(0.8, 0.4, 0.6) };
    let lattice = body_centred(bounds, 0.02).unwrap();
    assert_eq!(lattice.cells(), [75, 40, 56]);
    assert_eq!((lattice.stored_samples(), lattice.needed_samples()), (371_910, 364_492));
    assert_eq!((lattice.needed_edges(), lattice.tetrahedra()), (2_456_011, 2_053_760));
    let simple = Lattice::try_new(Arrangement::SimpleCubic, bounds, 0.02).unwrap();
    assert_eq!(crate::published::needed_as_published(&simple), (158_730, 1_147_851));
}

#[test]
fn spacing_must_be_positive_and_finite() {
    for spacing in [0.0, -0.0, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let error = body_centred(UNIT, spacing).unwrap_err();
        assert!(matches!(error, LatticeError::Spacing { .. }), "{spacing}: {error}");
    }
}

#[test]
fn bounds_must_be_finite_and_ordered_on_every_axis() {
    for (i, axis) in ['x', 'y', 'z'].into_iter().enumerate() {
        for (low, high) in [
            (1.0, 1.0),
            (2.0, 1.0),
            (f32::NAN, 1.0),
            (0.0, f32::NAN),
            (0.0, f32::INFINITY),
            (f32::NEG_INFINITY, 0.0),
        ] {
            let mut bounds = UNIT;
            bounds.min[i] = low;
            bounds.max[i] = high;
            match body_centred(bounds, 0.1).unwrap_err() {
                LatticeError::Bounds { axis: named, .. } => assert_eq!(named, axis),
                other => panic!("{low} to {high}: {other}"),
            }
        }
    }
}

#[test]
fn absurd_sizes_are_refused_or_can_be_seen() {
    let refused = |bounds, spacing| body_centred(bounds, spacing).unwrap_err();
    assert!(matches!(refused(UNIT, 1e-8), LatticeError::TooManyCells { axis: 'x', .. }));
    // Far more than a 32-bit number can name: a few layers are held.
    let fine = body_centred(UNIT, 1e-4).unwrap();
    assert_eq!(fine.stored_samples(), 20_002 * 20_002 * 40_003);
    assert_eq!(fine.tetrahedra(), 12 * 20_000u64.pow(3) + 4 * 3 * 20_000u64.pow(2));
    assert!(fine.streaming_bytes(1) < 64 << 30, "{}", fine.streaming_bytes(1));
    let limits = [Lattice::MAX_SAMPLES, Lattice::MAX_SAMPLES_PER_LAYER];
    let (samples, limit) = (80_002u128.pow(2), limits[1]);
    let flat = Bounds { max: Vec3::new(1.0, 1.0, -0.9), ..UNIT };
    assert_eq!(refused(flat, 2.5e-5), LatticeError::TooManyInLayer { samples, limit });
    let samples = 60_000u128.pow(2) * 16_000_000;
    let tall = Bounds { min: Vec3::ZERO, max: Vec3::new(59_999.0, 59_999.0, 15_999_999.0) };
    let error = Lattice::try_new(Arrangement::SimpleCubic, tall, 1.0).unwrap_err();
    assert_eq!(error, LatticeError::TooManySamples { samples, limit: limits[0] });
    let huge = Bounds { min: Vec3::splat(f32::MIN), max: Vec3::splat(f32::MAX) };
    assert!(matches!(refused(huge, 1.0), LatticeError::TooManyCells { .. }));
    assert!(matches!(refused(UNIT, f32::MAX), LatticeError::OutOfRange { .. }));
    let told = refused(UNIT, f32::MAX).to_string();
    assert!(told.starts_with("spacing 3.4028235e38 puts lattice points along x"), "{told}");
    let told = refused(UNIT, 1e-30).to_string();
    assert!(told.contains("e30 cells along x") && told.len() < 60, "{told}");
    // Possible to name, too large to want: the caller can tell beforehand.
    let large = body_centred(UNIT, 0.0016).unwrap();
    assert!(large.memory_bytes() > 200_000_000_000, "{}", large.memory_bytes());
}

#[test]
fn memory_covers_what_the_counts_say() {
    for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
        let lattice = Lattice::try_new(arrangement, UNIT, 0.1).unwrap();
        let counts =
            extract(&Sphere::default(), &lattice, &ExtractSettings::default(), &Execution::default())
                .unwrap()
                .counts
                .tetrahedra
                .unwrap();
        let tables = counts.sample_bytes + counts.edge_bytes;
        assert!(lattice.memory_bytes() > tables && lattice.memory_bytes() < tables * 11 / 10);
    }
}

#[test]
fn memory_is_that_of_the_extractor_the_settings_choose() {
    let lattice = body_centred(UNIT, 0.0016).unwrap();
    let indexed = ExtractSettings::default();
    let accumulated = indexed.with_positions(Positions::Accumulated { chunks: 8 });
    let on = |threads| Execution { threads };
    assert_eq!(lattice.memory_bytes_for(&accumulated, &on(1)), lattice.memory_bytes());
    assert_eq!(lattice.memory_bytes_for(&indexed, &on(1)), lattice.streaming_bytes(1));
    assert_eq!(lattice.memory_bytes_for(&indexed, &on(4)), lattice.streaming_bytes(4));
    // No more threads than there is work for.
    let most = lattice.memory_bytes_for(&indexed, &on(usize::MAX));
    assert!(most < lattice.memory_bytes() / 4, "{most}");
    let small = body_centred(UNIT, 0.5).unwrap();
    assert_eq!(small.memory_bytes_for(&indexed, &on(64)), small.streaming_bytes(1));
}

#[test]
fn settings_are_checked() {
    let lattice = body_centred(UNIT, 0.5).unwrap();
    let run = |settings| extract(&Sphere::default(), &lattice, &settings, &Execution::default()).map(drop);
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let error = run(ExtractSettings::default().with_isovalue(value)).unwrap_err();
        assert!(matches!(error, ExtractError::Isovalue { .. }), "{error}");
    }
    let none = Positions::Accumulated { chunks: 0 };
    assert_eq!(run(ExtractSettings::default().with_positions(none)), Err(ExtractError::NoChunks));
    let many = Positions::Accumulated { chunks: u32::MAX };
    assert_eq!(run(ExtractSettings::default().with_positions(many)), Ok(()));
}

/// A field of one repeated odd value, and a ball where it is not.
struct Odd(f32);

impl StudyField for Odd {
    fn sample(&self, p: Vec3) -> f32 {
        if p.x > 0.3 { self.0 } else { 0.8 - p.length() }
    }
}

#[test]
fn odd_values_give_a_mesh_of_numbers() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 0.0, f32::MIN_POSITIVE] {
        for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
            for clustering in [Clustering::None, Clustering::Integrated, Clustering::EdgeCollapse] {
                let lattice = Lattice::try_new(arrangement, UNIT, 0.15).unwrap();
                let settings = ExtractSettings::default().with_clustering(clustering);
                let mesh = extract(&Odd(value), &lattice, &settings, &Execution::default()).unwrap().mesh;
                assert!(mesh.triangles.len() > 100, "{value}");
                let bounds = lattice.bounds();
                for &p in &mesh.positions {
                    assert!(
                        p.is_finite() && p.cmpge(bounds.min).all() && p.cmple(bounds.max).all(),
                        "{value}: {p}"
                    );
                }
            }
        }
    }
}

#[test]
fn not_a_number_is_outside() {
    let lattice = body_centred(UNIT, 0.15).unwrap();
    let settings = ExtractSettings::default().with_clustering(Clustering::None);
    let run = |field: Odd| extract(&field, &lattice, &settings, &Execution::default()).unwrap();
    assert_eq!(run(Odd(f32::NAN)).counts.crossings, run(Odd(-1.0)).counts.crossings);
    assert_ne!(run(Odd(f32::NAN)).counts.crossings, run(Odd(1.0)).counts.crossings);
}

#[test]
fn nothing_inside_is_an_empty_mesh() {
    let lattice = body_centred(UNIT, 0.2).unwrap();
    for radius in [-1.0, 9.0] {
        let extraction =
            extract(&Sphere { radius }, &lattice, &ExtractSettings::default(), &Execution::default())
                .unwrap();
        assert_eq!(extraction.mesh, isostudy_mesh::TriangleMesh::default());
        assert_eq!((extraction.counts.crossings, extraction.counts.cells_visited), (0, 0));
        assert_eq!(extraction.counts.tetrahedra.unwrap().tetrahedra_evaluated, 0);
    }
}

#[test]
fn one_cell_is_a_lattice() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
        // The quotient of size and spacing underflows to zero cells; one is made.
        let tiny = Bounds { min: Vec3::ZERO, max: Vec3::splat(1e-30) };
        assert_eq!(Lattice::try_new(arrangement, tiny, 1e20).unwrap().cells(), [1; 3]);
        let lattice = Lattice::try_new(arrangement, bounds, 2.0).unwrap();
        let corner_ball = |p: Vec3| 1.0 - p.distance(Vec3::ONE);
        struct Of<F>(F);
        impl<F: Fn(Vec3) -> f32 + Sync> StudyField for Of<F> {
            fn sample(&self, p: Vec3) -> f32 {
                (self.0)(p)
            }
        }
        let settings = ExtractSettings::default().with_clustering(Clustering::None);
        let counts = extract(&Of(corner_ball), &lattice, &settings, &Execution::default()).unwrap().counts;
        // The corner inside sees its three cube edges, and per arrangement its diagonals.
        assert_eq!(counts.crossings, 7);
    }
}

/// Cells are visited where their own points, and body-centred those of the cells beside them, are on both sides; here each
/// is looked at by itself.
#[test]
fn cells_visited_are_those_that_the_surface_may_meet() {
    const CELLS: i32 = 32;
    let sphere = Sphere { radius: 0.8 };
    let spacing = 2.0 / CELLS as f32;
    let at = |p: [f32; 3]| sphere.sample(Vec3::NEG_ONE + Vec3::from_array(p) * spacing) > 0.0;
    for arrangement in Arrangement::ALL {
        let mut expected = 0;
        for cell in 0..CELLS.pow(3) {
            let low = [cell % CELLS, cell / CELLS % CELLS, cell / CELLS.pow(2)].map(|i| i as f32);
            let point = |halves: [i32; 3]| at([0, 1, 2].map(|axis| low[axis] + 0.5 * halves[axis] as f32));
            let corners = (0..8).map(|c| [0, 1, 2].map(|axis| 2 * (c >> axis & 1)));
            let across = |to: i32| {
                (0..3).flat_map(move |axis| {
                    [1 - to, 1 + to].map(|v| {
                        let mut face = [1; 3];
                        face[axis] = v;
                        face
                    })
                })
            };
            let points: Vec<_> = match arrangement {
                Arrangement::SimpleCubic | Arrangement::FiveTetrahedra => corners.collect(),
                Arrangement::FaceCentred => corners.chain(across(1)).chain([[1; 3]]).collect(),
                // No centre beyond the box is inside.
                Arrangement::BodyCentred => corners.chain(across(2)).chain([[1; 3]]).collect(),
            };
            let inside = points.iter().filter(|&&halves| point(halves)).count();
            expected += u64::from(inside > 0 && inside < points.len());
        }
        let lattice = Lattice::try_new(arrangement, UNIT, spacing).unwrap();
        assert_eq!(lattice.cells(), [CELLS as u32; 3]);
        let settings = ExtractSettings::default().with_clustering(Clustering::None);
        for threads in [1, 3] {
            let counts = extract(&sphere, &lattice, &settings, &Execution { threads }).unwrap().counts;
            assert_eq!((counts.cells, counts.cells_visited), (32 * 32 * 32, expected), "{arrangement}");
            let tetrahedra = counts.tetrahedra.unwrap();
            assert_eq!(counts.samples, lattice.needed_samples());
            let a_cell = match arrangement {
                Arrangement::BodyCentred => 12,
                Arrangement::SimpleCubic => 6,
                Arrangement::FiveTetrahedra => 5,
                Arrangement::FaceCentred => 24,
            };
            // Body-centred, the lowest cells have more, and the surface stays clear of them.
            assert_eq!(tetrahedra.tetrahedra_evaluated, a_cell * expected, "{arrangement}");
        }
    }
}
