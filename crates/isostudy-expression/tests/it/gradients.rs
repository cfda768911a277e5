//! A formula's gradient is that of its values: against differences between samples, at random places.

use isostudy_expression::Expression;
use isostudy_field::StudyField;
use isostudy_mesh::glam::{DVec3, Vec3};

/// By differences; `None` where those to either side do not agree.
fn by_differences(field: &Expression, p: Vec3) -> Option<DVec3> {
    let here = f64::from(field.sample(p));
    let slope = |axis: usize, step: f32| {
        let mut there = p;
        there[axis] += step;
        (f64::from(field.sample(there)) - here) / (f64::from(there[axis]) - f64::from(p[axis]))
    };
    let [low, high] = [-3e-4, 3e-4].map(|step| DVec3::new(slope(0, step), slope(1, step), slope(2, step)));
    (low.distance(high) < 1e-2 * (1.0 + high.length())).then_some((low + high) * 0.5)
}

#[test]
fn gradients_are_those_of_the_values() {
    for text in [
        "x*y - z^2 + sin(3*x)",
        "max(abs(x) - 0.4, abs(y - 0.1*z) - 0.5, z)",
        "length(x, y, z) + exp(x*z)",
        "noise(2*x, y, z + 0.3*x)",
        "z + 0.3*fbm(x*2 + noise(y, z, x), y*2, 0, 3) - 0.1*ridged(x, y, z, 2, 5)",
        "max(z, 0.2 - billowed(x + y, 3*y, z, 2)) * noise(x, y, z)",
    ] {
        let field: Expression = text.parse().unwrap();
        let mut smooth = 0;
        for i in 0..2_000 {
            let t = i as f32;
            let p = Vec3::new((t * 0.377).sin(), (t * 0.719).cos(), (t * 0.131).sin() * 0.9);
            let Some(want) = by_differences(&field, p) else { continue };
            let found = field.gradient(p).unwrap().as_dvec3();
            assert!(
                found.distance(want) < 1e-2 * (1.0 + want.length()),
                "{text} at {p}: {found}, not {want}"
            );
            smooth += 1;
        }
        assert!(smooth > 1_500, "{text}: {smooth} smooth places");
    }
}
