//! What formulas mean, what is no formula, and that ranges hold.

use isostudy_expression::{Expression, ExpressionError};
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Execution};
use isostudy_field::{Negated, StudyField};
use isostudy_mesh::glam::Vec3;
use isostudy_mesh::{Bounds, TriangleMesh};
use proptest::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

fn parsed(text: &str) -> Expression {
    text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn at(text: &str, x: f32, y: f32, z: f32) -> f32 {
    parsed(text).sample(Vec3::new(x, y, z))
}

#[test]
fn operators_bind_as_in_mathematics() {
    // x = 2, y = 3, z = 5.
    for (text, want) in [
        ("x + y * z", 17.0),
        ("(x + y) * z", 25.0),
        ("x - y - z", -6.0),
        ("z / x / x", 1.25),
        ("z % y", 2.0),
        ("-z % y", 1.0),
        ("-x^2", -4.0),
        ("(-x)^2", 4.0),
        ("x^y^2", 512.0),
        ("x^-1", 0.5),
        ("x**3", 8.0),
        ("2*-x", -4.0),
        ("x - -y", 5.0),
        ("+x", 2.0),
        ("x*1e-1 + .5 + 1.", 1.7),
        ("x + 2e0", 4.0),
        ("x*e", 5.436_563_7),
        ("x*pi - x*tau/2", 0.0),
    ] {
        assert!((at(text, 2.0, 3.0, 5.0) - want).abs() < 1e-5, "{text}: {}", at(text, 2.0, 3.0, 5.0));
    }
}

#[test]
fn functions_are_those_of_their_names() {
    let (x, y, z) = (0.3f32, -0.7f32, 2.4f32);
    for (text, want) in [
        ("sqrt(z)", z.sqrt()),
        ("cbrt(y)", y.cbrt()),
        ("abs(y)", 0.7),
        ("exp(x)", x.exp()),
        ("ln(z)", z.ln()),
        ("sin(x)", x.sin()),
        ("cos(y)", y.cos()),
        ("tan(x)", x.tan()),
        ("asin(x)", x.asin()),
        ("acos(y)", y.acos()),
        ("atan(z)", z.atan()),
        ("atan2(y, x)", y.atan2(x)),
        ("floor(y)", -1.0),
        ("ceil(z)", 3.0),
        ("round(z)", 2.0),
        ("square(y)", y * y),
        ("sign(y)", -1.0),
        ("mod(y, x)", y.rem_euclid(x)),
        ("pow(z, 1.7)", z.powf(1.7)),
        ("z^0.5", z.sqrt()),
        ("z^y", z.powf(y)),
        ("clamp(z, x, 1)", 1.0),
        ("mix(x, z, 0.25)", x + (z - x) * 0.25),
        ("min(x, y, z)", y),
        ("max(x, y, z)", z),
        ("min(x)", x),
        ("length(x, y, z)", (x * x + y * y + z * z).sqrt()),
    ] {
        assert!((at(text, x, y, z) - want).abs() < 1e-5, "{text}: {} for {want}", at(text, x, y, z));
    }
}

#[test]
fn what_is_not_defined_is_no_number_and_no_panic() {
    assert!(at("1/x", 0.0, 0.0, 0.0).is_infinite());
    assert!(at("x/y", 0.0, 0.0, 0.0).is_nan());
    assert!(at("sqrt(x)", -1.0, 0.0, 0.0).is_nan());
    assert!(at("ln(x)", -1.0, 0.0, 0.0).is_nan());
    assert!(at("x^1.5", -1.0, 0.0, 0.0).is_nan());
    // Infinity less infinity, and 0 times infinity, in values and in boxes.
    let bounds = Bounds { min: Vec3::splat(-9.0), max: Vec3::splat(9.0) };
    for text in ["exp(999*x) - exp(999*y)", "x*exp(exp(99*y))", "1/x - 1/y", "x % 0", "tan(1/x)", "0*x + 1/x"]
    {
        let field = parsed(text);
        let _ = (field.range(bounds, f32::NAN), field.sample(Vec3::splat(3.0)));
        for spacing in [0.7, 6.0] {
            let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, spacing).unwrap();
            extract(&field, &lattice, &ExtractSettings::default(), &Execution::default()).unwrap();
        }
    }
}

#[test]
fn errors_name_the_column_and_what_stands_there() {
    let unknown = |what: &str| {
        format!(
            "{what} is not known; x, y, z, pi, tau and e are, and the functions sqrt, cbrt, abs, exp, ln, sin, cos, tan, \
             asin, acos, atan, floor, ceil, round, sign, square, atan2, mod, pow, clamp, mix, min, max, length, noise, fbm, \
             ridged, billowed"
        )
    };
    for (text, want) in [
        ("", "column 1: the end where a number, a name or `(` belongs"),
        ("x +", "column 4: the end where a number, a name or `(` belongs"),
        ("x + * y", "column 5: `*` where a number, a name or `(` belongs"),
        ("2x", "column 2: `x` where an operator or the end belongs"),
        ("x y", "column 3: `y` where an operator or the end belongs"),
        ("(x", "column 3: the end where `)` or an operator belongs"),
        ("x)", "column 2: `)` where an operator or the end belongs"),
        ("x $ y", "column 3: `$` is not part of any formula"),
        ("x² - 1", "column 2: `²` is not part of any formula"),
        ("x + 1.2.3", "column 5: `1.2.3` is not a finite number"),
        ("x + 1e99", "column 5: `1e99` is not a finite number"),
        ("x + .", "column 5: `.` is not a finite number"),
        ("r - 1", &unknown("column 1: `r`")),
        ("sinh(x)", &unknown("column 1: `sinh`")),
        ("x + sqrt", &unknown("column 5: `sqrt`")),
        ("sqrt(x, y)", "column 1: `sqrt` takes one argument, not 2"),
        ("1 + min()", "column 5: `min` takes at least one argument, not 0"),
        ("min(x,)", "column 7: `)` where a number, a name or `(` belongs"),
        ("min(x y)", "column 7: `y` where `,`, `)` or an operator belongs"),
        ("1 + 2", "the formula is 3 everywhere; x, y or z must matter"),
        ("1/0", "the formula is inf everywhere; x, y or z must matter"),
        ("x - x + 0/0", "the formula is NaN everywhere; x, y or z must matter"),
        ("0*x", "the formula is 0 everywhere; x, y or z must matter"),
    ] {
        assert_eq!(text.parse::<Expression>().unwrap_err().to_string(), want, "{text}");
    }
}

#[test]
fn parts_without_variables_mean_what_ieee_754_says() {
    for text in [
        "0/0",
        "x + 0/0",
        "0/0 - x",
        "x * (0/0)",
        "0 * (0/0)",
        "(0/0) / x",
        "0 * (1/0)",
        "(1/0) - (1/0)",
        "x % (0/0)",
        "1 % 0",
        "mod(0/0, x)",
        "mix(0, 1/0, 0)",
        "0/sqrt(-1)",
        "length(x, y) + 0/0",
        "(1/0) * 0",
        "1^(1/0)",
    ] {
        match text.parse::<Expression>() {
            Err(ExpressionError::Constant { value }) => assert!(value.is_nan(), "{text}: {value}"),
            other => panic!("{text}: {other:?}"),
        }
    }
    for text in
        ["min(x, 0/0)", "max(0/0, x)", "abs(0/0) + x", "length(x, 0/0)", "clamp(x, 0/0, 1)", "atan2(0/0, x)"]
    {
        let value = text.parse::<Expression>().map(|field| field.sample(Vec3::ONE));
        assert!(!matches!(value, Ok(v) if !v.is_nan()), "{text}: {value:?}");
    }
    for (text, want) in [
        ("x + 0*5", 1.0),
        ("x + 1/(1/0)", 1.0),
        ("x * (0 - 1)", -1.0),
        ("x + 2^-1", 1.5),
        ("x + 0^0", 2.0),
        ("cbrt(0) + x", 1.0),
    ] {
        assert_eq!(at(text, 1.0, 0.0, 0.0), want, "{text}");
    }
}

#[test]
fn an_excerpt_of_a_long_formula_shows_the_place() {
    let long = format!("{} + $ + {}", vec!["x"; 9000].join("+"), vec!["y"; 900].join("+"));
    let error = long.parse::<Expression>().unwrap_err();
    assert_eq!(error.column(), Some(18_003));
    let excerpt = error.excerpt(&long);
    assert_eq!(excerpt, "...x+x+x+x+x+x+x+x+x+x+x+x+x+x + $ + y+y+y+y+y+y+y+y+y+y+y+y+y+...");
    assert_eq!("x + é".parse::<Expression>().unwrap_err().excerpt("x + é"), "x + é");
    assert_eq!("x +".parse::<Expression>().unwrap_err().excerpt("x +"), "x +");
    let endless = "x+".repeat(40_000);
    assert_eq!(endless.parse::<Expression>().unwrap_err().excerpt(&endless).len(), 33);
}

#[test]
fn nesting_has_a_limit_and_length_as_well() {
    let nested = |n: usize, open: &str, close: &str| format!("{}x{}", open.repeat(n), close.repeat(n));
    for (open, close) in [("(", ")"), ("sqrt(", ")"), ("-", ""), ("2^", ""), ("min(1,", ")")] {
        assert!(nested(90, open, close).parse::<Expression>().is_ok(), "{open}");
        for n in [1000, 9000] {
            let error = nested(n, open, close).parse::<Expression>().unwrap_err();
            assert!(matches!(error, ExpressionError::TooDeep { limit: 200, .. }), "{open}: {error}");
        }
    }
    // A long sum is not deep for the reader, but for whoever recurses over its graph.
    let sum = |n: usize| (0..n).map(|i| format!("x*{i}")).collect::<Vec<_>>().join("+");
    // 7999 * 4000, with the rounding of 8,000 additions beyond 2^24.
    let value = parsed(&sum(8000)).sample(Vec3::X);
    assert!((value / (7999.0 * 4000.0) - 1.0).abs() < 1e-3, "{value}");
    let product = vec!["x"; 30_000].join("-y*");
    assert_eq!(parsed(&format!("{}-z", &product[..60_001])).sample(Vec3::X), 1.0);
    let error = sum(20_000).parse::<Expression>().unwrap_err();
    assert!(matches!(error, ExpressionError::TooLong { limit: 65_536, .. }));
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

fn mesh_of(field: &dyn StudyField, threads: usize) -> TriangleMesh {
    let bounds = Bounds { min: Vec3::splat(-1.2), max: Vec3::splat(1.2) };
    let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.02).unwrap();
    extract(field, &lattice, &ExtractSettings::default(), &Execution { threads }).unwrap().mesh
}

#[test]
fn blocks_without_surface_are_never_sampled_and_the_mesh_is_the_same() {
    for text in
        ["1 - sqrt(x^2+y^2+z^2)", "0.2 - length(length(x, y) - 0.8, z)", "0.3 - abs(sin(3*x)*y + cos(3*z))"]
    {
        let field = parsed(text);
        let mut meshes = Vec::new();
        let mut samples = Vec::new();
        for tells in [false, true] {
            let watched = Watched { field: &field, tells, samples: AtomicUsize::new(0) };
            meshes.push(mesh_of(&watched, 1));
            samples.push(watched.samples.into_inner());
        }
        assert_eq!(meshes[0], meshes[1], "{text}");
        assert_eq!(meshes[0], mesh_of(&field, 2), "{text}");
        assert!(samples[1] < samples[0] * 3 / 4, "{text}: {samples:?}");
    }
}

#[test]
fn a_distance_that_is_negative_inside_is_turned_round() {
    let surface = mesh_of(&Negated(parsed("sqrt(x^2+y^2+z^2) - 1")), 0);
    assert!((surface.volume() - 4.18879).abs() < 0.005, "{}", surface.volume());
}

/// Formulas of every kind, without division by what is surely zero.
fn formula() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        prop::sample::select(vec!["x", "y", "z"]).prop_map(str::to_owned),
        (-30i32..30).prop_map(|n| format!("({})", n as f32 * 0.25)),
        prop::sample::select(vec!["1e30", "1e-30", "pi"]).prop_map(str::to_owned),
    ];
    leaf.prop_recursive(5, 40, 3, |inner| {
        let one = vec![
            "sqrt", "abs", "exp", "ln", "sin", "cos", "tan", "asin", "acos", "atan", "floor", "ceil",
            "round", "square", "sign", "cbrt", "-",
        ];
        let two = vec!["+", "-", "*", "/", "%", "^"];
        prop_oneof![
            (prop::sample::select(one), inner.clone()).prop_map(|(f, a)| format!("{f}({a})")),
            (inner.clone(), prop::sample::select(two), inner.clone())
                .prop_map(|(a, f, b)| format!("({a}{f}{b})")),
            (prop::sample::select(vec!["min", "max", "atan2", "length"]), inner.clone(), inner.clone())
                .prop_map(|(f, a, b)| format!("{f}({a},{b})")),
            (inner, -6i32..7).prop_map(|(a, n)| format!("({a})^{n}")),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

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

    /// Any text: a formula or an error, never a panic.
    #[test]
    fn noise_never_panics(
        words in prop::collection::vec(prop::sample::select(vec![
            "x", "y", "1", "1e", "e", ".", "+", "-", "*", "**", "/", "^", "%", "(", ")", ",", " ", "sqrt(", "min", "pow(", "\u{e9}", "\0", "9e9",
        ]), 0..30),
        noise in "\\PC{0,20}",
    ) {
        let _ = words.concat().parse::<Expression>();
        let _ = noise.parse::<Expression>();
    }
}
