//! Noise in formulas: the field's own to the bit, in one another, with bounds that hold, and with errors that say what is
//! allowed.

use std::sync::atomic::{AtomicUsize, Ordering};

use isostudy_expression::{Expression, ExpressionError};
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Execution};
use isostudy_field::{Fractal, NoiseShape, StudyField, noise};
use isostudy_mesh::Bounds;
use isostudy_mesh::glam::{DVec3, Vec3};
use proptest::prelude::*;

fn parsed(text: &str) -> Expression {
    text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// Places near and far, on whole numbers and off them.
fn places() -> impl Iterator<Item = Vec3> {
    (0..3000).map(|i| {
        let t = i as f32;
        let p = Vec3::new((t * 0.377).sin() * 3.0, (t * 0.719).cos() * 11.0, (t * 0.131).sin() * 0.7);
        match i % 10 {
            0 => p.round(),
            1 => p * 1e5,
            2 => p * 1e-6,
            3 => Vec3::new(p.x, p.y, 0.0),
            _ => p,
        }
    })
}

fn assert_same(text: &str, of: impl Fn(DVec3) -> f64) {
    let field = parsed(text);
    for p in places() {
        let (found, wanted) = (field.sample(p), of(p.as_dvec3()) as f32);
        assert_eq!(found.to_bits(), wanted.to_bits(), "{text} at {p}: {found} for {wanted}");
    }
    // In rows as well.
    let x: Vec<f32> = (0..150).map(|i| i as f32 * 0.03 - 2.0).collect();
    let mut values = vec![0.0; x.len()];
    field.sample_row(&x, 0.4, -0.9, &mut values);
    for (x, value) in x.into_iter().zip(values) {
        assert_eq!(value.to_bits(), field.sample(Vec3::new(x, 0.4, -0.9)).to_bits(), "{text}");
    }
    // And of points near each other.
    let points: Vec<Vec3> = places().collect();
    let mut values = vec![0.0; points.len()];
    field.sample_near(&points, &mut values, None);
    for (p, value) in points.into_iter().zip(values) {
        assert_eq!(value.to_bits(), field.sample(p).to_bits(), "{text} at {p}");
    }
}

#[test]
fn the_functions_are_those_of_the_field_to_the_bit() {
    assert_same("noise(x, y, z)", |p| noise(p, 0));
    assert_same("noise(x, y, z, 77)", |p| noise(p, 77));
    assert_same("noise(z, x, 0.5)", |p| noise(DVec3::new(p.z, p.x, 0.5), 0));
    for (name, shape) in
        [("fbm", NoiseShape::Plain), ("ridged", NoiseShape::Ridged), ("billowed", NoiseShape::Billowed)]
    {
        for octaves in [1, 4, 16] {
            let fractal = Fractal::new(shape, octaves, 0.5, 0);
            assert_same(&format!("{name}(x, y, z, {octaves})"), |p| fractal.value(p));
            let seeded = Fractal::new(shape, octaves, 0.5, 16_777_215);
            assert_same(&format!("{name}(x, y, z, {octaves}, 2^24 - 1)"), |p| seeded.value(p));
        }
    }
}

#[test]
fn noise_of_noise_takes_the_inner_first() {
    let single = |value: f64| f64::from(value as f32);
    assert_same("noise(noise(x, y, z, 1)*4, z, fbm(y, z, x, 3))", |p| {
        let inner = (noise(p, 1) as f32) * 4.0;
        let fbm = Fractal::new(NoiseShape::Plain, 3, 0.5, 0).value(DVec3::new(p.y, p.z, p.x));
        noise(DVec3::new(f64::from(inner), p.z, single(fbm)), 0)
    });
    // The same call twice, in different places, and one that does not matter.
    assert_same("noise(x, y, z) + 0*noise(x, x, x) + noise(noise(x, y, z), 0.5, 0.25)", |p| {
        let inner = noise(p, 0) as f32;
        f64::from(inner + noise(DVec3::new(f64::from(inner), 0.5, 0.25), 0) as f32)
    });
    let deep = |n: usize| format!("{}x{}", "noise(".repeat(n), ", y, z)".repeat(n));
    assert!(parsed(&deep(90)).sample(Vec3::new(0.3, 0.4, 0.6)).is_finite());
    assert!(matches!(deep(300).parse::<Expression>(), Err(ExpressionError::TooDeep { .. })));
}

#[test]
fn numbers_alone_make_a_number() {
    let value = noise(DVec3::new(0.25, 0.5, 0.75), 0) as f32;
    assert!(value != 0.0);
    assert_eq!(parsed("x + noise(1/4, 1/2, 3/4)").sample(Vec3::ZERO), value);
    match "noise(0.25, 0.5, 0.75)".parse::<Expression>() {
        Err(ExpressionError::Constant { value: found }) => assert_eq!(found, value),
        other => panic!("{other:?}"),
    }
    // What is not finite has no noise.
    assert!(parsed("noise(1/x, y, z)").sample(Vec3::ZERO).is_nan());
    match "x + noise(1/0, 0, 0)".parse::<Expression>() {
        Err(ExpressionError::Constant { value }) => assert!(value.is_nan()),
        other => panic!("{other:?}"),
    }
}

#[test]
fn errors_name_the_argument_and_what_is_allowed() {
    for (text, want) in [
        ("noise(x, y)", "column 1: `noise` takes x, y, z, and a seed if wanted, not 2"),
        ("noise(x, y, z, 1, 2)", "column 1: `noise` takes x, y, z, and a seed if wanted, not 5"),
        ("1 + fbm(x, y, z)", "column 5: `fbm` takes x, y, z, octaves, and a seed if wanted, not 3"),
        ("ridged()", "column 1: `ridged` takes x, y, z, octaves, and a seed if wanted, not 0"),
        (
            "fbm(x, y, z, 2.5)",
            "column 14: the number of octaves of `fbm` has to be a whole number from 1 to 16, not 2.5",
        ),
        (
            "x + fbm(x, y, z,  17, 3)",
            "column 19: the number of octaves of `fbm` has to be a whole number from 1 to 16, not 17",
        ),
        (
            "ridged(x, y, z, y)",
            "column 17: the number of octaves of `ridged` has to be a whole number from 1 to 16, not a formula in x, y or z",
        ),
        (
            "billowed(x, y, z, 0/0)",
            "column 19: the number of octaves of `billowed` has to be a whole number from 1 to 16, not NaN",
        ),
        (
            "noise(x, y, z, -1)",
            "column 16: the seed of `noise` has to be a whole number from 0 to 16777215, not -1",
        ),
        (
            "fbm(x, y, z, 4, 1e9)",
            "column 17: the seed of `fbm` has to be a whole number from 0 to 16777215, not 1000000000",
        ),
    ] {
        let error = text.parse::<Expression>().unwrap_err();
        assert_eq!(error.to_string(), want, "{text}");
        assert!(error.column().is_some());
    }
}

/// Counts samples, and tells of ranges or does not.
struct Watched<'a> {
    field: &'a Expression,
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
    let bounds = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    for (text, share) in [
        ("fbm(x*2, y*2, 0, 5)*0.5 - z", 0.25),
        ("ridged(x*2, y*2, 0, 4, 3)*0.5 - 0.4 - z + 0.1*noise(x*6, y*6, z*6)", 0.35),
        ("min(0.8 - length(x, y, z) + 0.2*billowed(x*3, y*3, z*3, 3), 0.3 - noise(x*4, y*4, z*4))", 0.6),
        ("0.3*noise(x*2 + noise(x*3, y*3, z*3), y*2, 0) - z", 0.35),
    ] {
        let field = parsed(text);
        let mut found = Vec::new();
        for tells in [false, true] {
            for threads in [1, 2] {
                let watched = Watched { field: &field, tells, samples: AtomicUsize::new(0) };
                let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.025).unwrap();
                let settings = ExtractSettings::default();
                let mesh = extract(&watched, &lattice, &settings, &Execution { threads }).unwrap().mesh;
                found.push((mesh, watched.samples.into_inner()));
            }
        }
        assert!(found[0].0.triangles.len() > 1000, "{text}");
        assert!(found.iter().all(|(mesh, _)| *mesh == found[0].0), "{text}");
        println!("{text}: {} of {}", found[2].1, found[0].1);
        assert!((found[2].1 as f64) < share * found[0].1 as f64, "{text}: {} of {}", found[2].1, found[0].1);
    }
}

fn formula() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        3 => prop::sample::select(vec!["x", "y", "z"]).prop_map(str::to_owned),
        1 => (-30i32..30).prop_map(|n| format!("({})", n as f32 * 0.25)),
        1 => prop::sample::select(vec!["1e30", "1e-30"]).prop_map(str::to_owned),
    ];
    leaf.prop_recursive(4, 20, 3, |inner| {
        let noises = vec!["noise", "fbm", "ridged", "billowed"];
        prop_oneof![
            (prop::sample::select(noises), prop::array::uniform3(inner.clone()), 1u32..6, 0u32..99).prop_map(
                |(name, [x, y, z], octaves, seed)| match name {
                    "noise" => format!("noise({x},{y},{z},{seed})"),
                    _ => format!("{name}({x},{y},{z},{octaves},{seed})"),
                }
            ),
            (inner.clone(), prop::sample::select(vec!["+", "-", "*", "/"]), inner.clone())
                .prop_map(|(a, f, b)| format!("({a}{f}{b})")),
            (prop::sample::select(vec!["abs", "sqrt", "exp"]), inner).prop_map(|(f, a)| format!("{f}({a})")),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4_000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Where a range is told, every value is a number in it.
    #[test]
    fn ranges_hold(
        text in formula(),
        low in prop::array::uniform3(-4.0f32..4.0),
        size in prop::array::uniform3(prop_oneof![Just(0.0f32), 0.0f32..0.1, 0.0f32..4.0]),
        parts in prop::collection::vec(prop::array::uniform3(0.0f32..=1.0), 12),
    ) {
        let Ok(field) = text.parse::<Expression>() else { return Ok(()) };
        let bounds = Bounds { min: Vec3::from(low), max: Vec3::from(low) + Vec3::from(size) };
        if let Some((least, most)) = field.range(bounds, f32::NAN) {
            for part in parts {
                let p = (bounds.min + Vec3::from(part) * bounds.size()).clamp(bounds.min, bounds.max);
                let value = field.sample(p);
                prop_assert!(least <= value && value <= most, "{text}: {value} at {p} is not in {least}..{most}");
            }
        }
    }
}
