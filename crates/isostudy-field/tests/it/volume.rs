//! Samples of a grid, interpolated.

use glam::Vec3;
use isostudy_field::{Beyond, StudyField, VolumeField};

/// Beside samples that are far larger, too: `a + (b - a)` is 0 for 1e30 and 1.
#[test]
fn at_a_sample_is_the_sample() {
    let kinds = [1e30, 1.0, -1e30, 0.1, 3e-40, -7.5, f32::MAX];
    let counts = [3, 2, 4];
    let steps = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for shift in 0..kinds.len() {
        let values: Vec<f32> =
            (0..24).map(|i| kinds[(i * i + 3 * i + shift * (i + 1)) % kinds.len()]).collect();
        let field = VolumeField::try_new(counts, values.clone(), [0.0; 3], steps, Beyond::Continued).unwrap();
        for (i, value) in values.iter().enumerate() {
            let p = Vec3::new((i % 3) as f32, (i / 3 % 2) as f32, (i / 6) as f32);
            assert_eq!(field.sample(p), *value, "{p} of {values:?}");
        }
    }
}

/// Of steps that have no exact inverse some samples lie a rounding below their place: 49 times 1/49 is less than 1.
#[test]
fn at_a_sample_is_the_sample_whatever_the_steps() {
    const COUNT: usize = 30;
    let values: Vec<f32> = (0..4 * COUNT).map(|i| if i % 3 == 0 { 1e9 } else { -0.125 }).collect();
    for step in [0.75, 49.0, 98.0] {
        let steps = [[step, 0.0, 0.0], [0.0, step, 0.0], [0.0, 0.0, step]];
        let counts = [COUNT, 2, 2];
        let field = VolumeField::try_new(counts, values.clone(), [0.0; 3], steps, Beyond::Continued).unwrap();
        for (i, value) in values.iter().enumerate() {
            let place = [i % COUNT, i / COUNT % 2, i / COUNT / 2].map(|n| n as f32 * step as f32);
            assert_eq!(field.sample(Vec3::from(place)), *value, "steps of {step}, sample {i}");
        }
    }
}
