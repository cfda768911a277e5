//! Volumes against what was sampled into them.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DMat3, DVec3, Vec3};
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Execution};
use isostudy_field::{Beyond, Negated, StudyField, VolumeField, VolumeFieldError};
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};
use proptest::prelude::*;

const COUNTS: [usize; 3] = [21, 17, 19];

/// A function, sampled on a grid.
fn volume(steps: [[f64; 3]; 3], beyond: Beyond, function: impl Fn(DVec3) -> f64) -> VolumeField {
    let origin = [0.25, -1.0, 2.0];
    let at = |i, j, k| DVec3::from_array(origin) + DMat3::from_cols_array_2d(&steps) * DVec3::new(i, j, k);
    let mut values = Vec::new();
    for k in 0..COUNTS[2] {
        for j in 0..COUNTS[1] {
            values.extend((0..COUNTS[0]).map(|i| function(at(i as f64, j as f64, k as f64)) as f32));
        }
    }
    VolumeField::try_new(COUNTS, values, origin, steps, beyond).unwrap()
}

/// Straight, mirrored, with axes exchanged, turned and sheared.
fn frames() -> [[[f64; 3]; 3]; 4] {
    let turned = DMat3::from_rotation_x(0.4) * DMat3::from_rotation_z(1.1) * 0.3;
    [
        [[0.3, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.3]],
        [[0.0, 0.3, 0.0], [-0.3, 0.0, 0.0], [0.0, 0.0, -0.3]],
        turned.to_cols_array_2d(),
        [[0.3, 0.0, 0.0], [0.05, -0.3, 0.0], [0.1, 0.0, 0.3]],
    ]
}

fn middle(field: &VolumeField) -> Vec3 {
    let Bounds { min, max } = field.bounds();
    (min + max) * 0.5
}

fn mesh_of(field: &dyn StudyField, bounds: Bounds, spacing: f32, isovalue: f32) -> TriangleMesh {
    let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, spacing).unwrap();
    let settings = ExtractSettings::default().with_isovalue(isovalue);
    extract(field, &lattice, &settings, &Execution::default()).unwrap().mesh
}

fn grown(bounds: Bounds, by: f32) -> Bounds {
    Bounds { min: bounds.min - by, max: bounds.max + by }
}

#[test]
fn a_linear_function_comes_back_wherever_the_grid_lies() {
    let function = |p: DVec3| 1.0 + p.x - 2.0 * p.y + 0.5 * p.z;
    for steps in frames() {
        let field = volume(steps, Beyond::Continued, function);
        let centre = middle(&field);
        for i in 0..1000u32 {
            let part = |k: u32| (i.wrapping_mul(k) >> 8) as f32 / (1u32 << 24) as f32 - 0.5;
            let shift = Vec3::new(part(2_654_435_761), part(2_246_822_519), part(3_266_489_917)) * 2.0;
            let (got, want) = (field.sample(centre + shift), function((centre + shift).as_dvec3()));
            assert!((f64::from(got) - want).abs() < 1e-5, "{got} {want}");
        }
    }
}

#[test]
fn a_sample_is_the_value_at_its_place_and_continues_beyond_the_end() {
    let values: Vec<f32> = (0..24).map(|i| (i * i % 17) as f32).collect();
    let steps = [[2.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 0.5]];
    let field =
        |beyond| VolumeField::try_new([4, 3, 2], values.clone(), [1.0, 2.0, 3.0], steps, beyond).unwrap();
    let continued = field(Beyond::Continued);
    assert_eq!(continued.bounds(), Bounds { min: Vec3::new(1.0, 0.0, 3.0), max: Vec3::new(7.0, 2.0, 3.5) });
    assert_eq!((continued.spacing(), continued.value_range()), (0.5, (0.0, 16.0)));
    assert!(continued.is_axis_aligned());
    for (n, &want) in values.iter().enumerate() {
        let index = Vec3::new((n % 4) as f32, (n / 4 % 3) as f32, (n / 12) as f32);
        assert_eq!(continued.sample(Vec3::new(1.0, 2.0, 3.0) + index * Vec3::new(2.0, -1.0, 0.5)), want);
    }
    // Three steps beyond the corner (3, 2, 1): two along x, three along y.
    let far = Vec3::new(7.0 + 4.0, 0.0 - 3.0, 3.5 + 0.25);
    let last = values[23];
    assert_eq!(continued.sample(far), last);
    assert_eq!(field(Beyond::Falling).sample(far), last - 3.0 * 16.0);
    assert_eq!(field(Beyond::Rising).sample(far), last + 3.0 * 16.0);
    assert!(continued.sample(Vec3::NAN).is_nan());
    // Neighbours whose difference is no number in single precision.
    let far_apart = [3e38, -3e38].repeat(4);
    let field = VolumeField::try_new([2; 3], far_apart, [0.0; 3], steps, Beyond::Continued).unwrap();
    for (x, want) in [(0.0, 3e38), (0.5, 1.5e38), (1.0, 0.0), (2.0, -3e38)] {
        assert!((field.sample(Vec3::new(x, -0.25, 0.25)) - want).abs() < 1e32, "{x}");
    }
}

#[test]
fn triangles_face_outward_in_mirrored_and_turned_grids() {
    for steps in frames() {
        for beyond in [Beyond::Continued, Beyond::Falling] {
            let centre = middle(&volume(steps, beyond, |_| 0.0)).as_dvec3();
            let ball = volume(steps, beyond, |p| 1.5 - p.distance(centre));
            let surface = mesh_of(&ball, ball.bounds(), 0.15, 0.0);
            assert!(topology(&surface).is_closed_manifold());
            let want = 4.0 / 3.0 * std::f64::consts::PI * 1.5f64.powi(3);
            assert!((surface.volume() - want).abs() < 0.05 * want, "{}", surface.volume());
            // A distance that is negative inside, turned round.
            let hollow = volume(steps, Beyond::Continued, |p| p.distance(centre) - 1.5);
            let same = mesh_of(&Negated(hollow), ball.bounds(), 0.15, -0.0);
            assert!((same.volume() - surface.volume()).abs() < 1e-3);
        }
    }
}

#[test]
fn what_leaves_the_volume_is_open_or_closed_as_asked() {
    for steps in frames() {
        let upper = |beyond| volume(steps, beyond, |p| p.x + 0.3 * p.y - 0.2 * p.z);
        let field = upper(Beyond::Continued);
        let isovalue = field.sample(middle(&field));
        let bounds = grown(field.bounds(), 0.35);
        let open = topology(&mesh_of(&field, field.bounds(), 0.3, isovalue));
        assert!(open.boundary_edges > 0 && (open.components == 1 || !field.is_axis_aligned()));
        let closed = mesh_of(&upper(Beyond::Falling), bounds, 0.15, isovalue);
        assert!(topology(&closed).is_closed_manifold());
        // Half the volume, to a part of a step all round.
        let det = DMat3::from_cols_array_2d(&steps).determinant().abs();
        let whole = det * COUNTS.iter().map(|n| (n - 1) as f64).product::<f64>();
        assert!((closed.volume() / whole - 0.5).abs() < 0.06, "{} of {whole}", closed.volume());
        let other = mesh_of(&Negated(upper(Beyond::Rising)), bounds, 0.15, -isovalue);
        assert!(topology(&other).is_closed_manifold());
        assert!((other.volume() / whole - 0.5).abs() < 0.06, "{} of {whole}", other.volume());
    }
}

/// Counts samples, and tells of ranges or does not.
struct Watched<'a> {
    field: &'a VolumeField,
    tells: bool,
    samples: AtomicUsize,
}

impl StudyField for Watched<'_> {
    fn sample(&self, p: Vec3) -> f32 {
        self.samples.fetch_add(1, Ordering::Relaxed);
        self.field.sample(p)
    }

    fn range(&self, bounds: Bounds, value: f32) -> Option<(f32, f32)> {
        if self.tells { self.field.range(bounds, value) } else { None }
    }
}

#[test]
fn blocks_without_surface_are_never_sampled_and_the_mesh_is_the_same() {
    for steps in frames() {
        for beyond in [Beyond::Continued, Beyond::Falling] {
            let centre = middle(&volume(steps, beyond, |_| 0.0)).as_dvec3();
            let field = volume(steps, beyond, |p| 3.0 - p.distance(centre));
            let isovalue = 1.5;
            let mut meshes = Vec::new();
            let mut samples = Vec::new();
            for tells in [false, true] {
                let watched = Watched { field: &field, tells, samples: AtomicUsize::new(0) };
                meshes.push(mesh_of(&watched, grown(field.bounds(), 0.2), 0.05, isovalue));
                samples.push(watched.samples.into_inner());
            }
            assert_eq!(meshes[0], meshes[1]);
            assert!(samples[1] < samples[0] / 2, "{samples:?}");
        }
    }
}

#[test]
fn what_makes_no_field_is_refused() {
    let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let make = |counts, values: Vec<f32>, steps| {
        VolumeField::try_new(counts, values, [0.0; 3], steps, Beyond::Continued)
    };
    let counts = |counts, samples| VolumeFieldError::Counts { counts, samples };
    assert_eq!(make([2, 2, 2], vec![0.0; 7], unit).unwrap_err(), counts([2, 2, 2], 7));
    assert_eq!(make([2, 0, 2], vec![], unit).unwrap_err(), counts([2, 0, 2], 0));
    assert_eq!(make([usize::MAX, 2, 1], vec![0.0; 2], unit).unwrap_err(), counts([usize::MAX, 2, 1], 2));
    for bad in [0.0, f64::NAN, f64::INFINITY] {
        let steps = [unit[0], unit[1], [0.0, 0.0, bad]];
        assert!(matches!(make([2, 2, 2], vec![1.0; 8], steps), Err(VolumeFieldError::Steps { .. })));
    }
    for flat in [[1, 1, 1], [1, 4, 2], [4, 1, 2], [4, 2, 1]] {
        let error = make(flat, vec![3.0; flat.iter().product()], unit).unwrap_err();
        assert_eq!(error, VolumeFieldError::Flat { counts: flat });
    }
    let no_numbers = [f32::NAN, f32::INFINITY].repeat(4);
    assert_eq!(make([2, 2, 2], no_numbers, unit).unwrap_err(), VolumeFieldError::NoNumbers);
    assert_eq!(make([2, 2, 2], vec![3.0; 8], unit).unwrap().sample(Vec3::splat(9.0)), 3.0);
}

/// A ball of finite samples among others that are not: every finite sample is met, on all sides alike, whatever the rounding
/// of the coordinates.
#[test]
fn a_mask_of_no_numbers_is_as_symmetric_as_its_samples() {
    const N: usize = 21;
    for other in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for (step, origin) in [(1.0, -10.0), (0.7, 3.3), (0.1, -1001.7)] {
            let steps = [[step, 0.0, 0.0], [0.0, step, 0.0], [0.0, 0.0, step]];
            let index = |n: usize| Vec3::new((n % N) as f32, (n / N % N) as f32, (n / N / N) as f32);
            let is_in = |i: Vec3| i.distance(Vec3::splat(10.0)) < 7.5;
            let values = (0..N.pow(3)).map(|n| if is_in(index(n)) { 100.0 + (n % 5) as f32 } else { other });
            let field = VolumeField::try_new([N; 3], values.collect(), [origin; 3], steps, Beyond::Continued)
                .unwrap();
            let place = |i: Vec3| (i.as_dvec3() * step + origin).as_vec3();
            for n in 0..N.pow(3) {
                let (value, want) = (field.sample(place(index(n))), 100.0 + (n % 5) as f32);
                let is_right = if is_in(index(n)) { (value - want).abs() < 0.01 } else { value.is_nan() };
                assert!(is_right, "{n}: {value} for {want}");
                // Half a step on, on an edge of a cell: between two samples, and no others.
                let along = index(n) + Vec3::X * 0.5;
                let known = is_in(along - Vec3::X * 0.5) && is_in(along + Vec3::X * 0.5);
                assert_eq!(field.sample(place(along)).is_nan(), !known, "{along}");
            }
            for arrangement in [Arrangement::SimpleCubic, Arrangement::BodyCentred] {
                let lattice = Lattice::try_new(arrangement, field.bounds(), field.spacing()).unwrap();
                let settings = ExtractSettings::default().with_isovalue(50.5);
                let mesh = extract(&field, &lattice, &settings, &Execution::default()).unwrap().mesh;
                assert!(topology(&mesh).is_closed_manifold());
                let Bounds { min, max } = mesh.bounds().unwrap();
                let middle = (DVec3::splat(10.0 * step + origin) * 2.0 - min.as_dvec3()).as_vec3();
                assert!((middle - max).abs().max_element() < 1e-3 * step as f32, "{min} to {max}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Every value in a box lies in the range that is told of it, also where samples are no numbers, or huge.
    #[test]
    fn ranges_hold(
        counts in prop::array::uniform3(2usize..12),
        seed: u32,
        odd in prop::sample::select(vec![0.0f32, f32::NAN, f32::INFINITY, f32::MAX, -f32::MAX, 1e-40]),
        frame in 0usize..4,
        falling: bool,
        low in prop::array::uniform3(-1.0f32..4.0),
        size in prop::array::uniform3(0.0f32..2.0),
        parts in prop::collection::vec(prop::array::uniform3(0.0f32..=1.0), 30),
    ) {
        let number = |i: u32| ((i ^ seed).wrapping_mul(2_654_435_761) >> 8) as f32 / (1u32 << 24) as f32;
        let total = counts.iter().product::<usize>() as u32;
        let mut values: Vec<f32> = (0..total).map(number).collect();
        values[seed as usize % total as usize] = odd;
        let beyond = if falling { Beyond::Falling } else { Beyond::Continued };
        let Ok(field) = VolumeField::try_new(counts, values, [0.0; 3], frames()[frame], beyond) else { return Ok(()) };
        let bounds = Bounds { min: Vec3::from(low), max: Vec3::from(low) + Vec3::from(size) };
        if let Some((least, most)) = field.range(bounds, f32::NAN) {
            prop_assert!(!least.is_nan() && !most.is_nan());
            for part in parts {
                let p = (bounds.min + Vec3::from(part) * (bounds.max - bounds.min)).clamp(bounds.min, bounds.max);
                let value = field.sample(p);
                prop_assert!(least <= value && value <= most, "{value} at {p} is not in {least}..{most}");
            }
        } else {
            prop_assert!(!odd.is_finite() || odd.abs() > 1.0, "nothing known of sound samples");
        }
    }
}
