//! The sine behind the asteroid's hash, the same on every machine.

// Coefficients: Arm's optimised routines, sincosf_data.c, copyright (c) 2018 Arm Limited, MIT licence.
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// Beyond this the simple reduction to one quadrant loses digits.
const REDUCIBLE: f64 = 1e5;

/// `sin(x)` to within 0.57 units in the last place.
///
/// Not correctly rounded, on purpose. The published evaluation ran on a library whose sine was not either, and the
/// hash takes the last bit up to the third decimal: `libm`'s two sines, both correctly rounded here, give the
/// body-centred asteroid 22552 crossings where 22550 were published. This one, with the polynomials of ARM's
/// optimised routines (`sinf`, which glibc uses too), gives all published vertex, triangle and tetrahedron counts.
pub(super) fn sin(x: f32) -> f32 {
    let x = f64::from(x);
    if x.is_nan() || x.abs() > REDUCIBLE {
        return libm::sin(x) as f32;
    }
    let quadrant = (x * FRAC_2_PI).round_ties_even();
    let r = x - quadrant * FRAC_PI_2;
    let quadrant = quadrant as i64;
    let magnitude = if quadrant & 1 == 0 { near_zero(r) } else { near_quarter(r) };
    (if quadrant & 2 == 0 { magnitude } else { -magnitude }) as f32
}

/// `sin(r)` for `|r| <= pi/4`.
fn near_zero(r: f64) -> f64 {
    const S: [f64; 3] = [-0.16666654943701084, 0.008332178146138854, -0.00019517298981385725];
    let square = r * r;
    let cube = r * square;
    (r + cube * S[0]) + cube * square * (S[1] + square * S[2])
}

/// `cos(r)` for `|r| <= pi/4`.
fn near_quarter(r: f64) -> f64 {
    const C: [f64; 4] =
        [-0.49999999725108224, 0.041666623324344516, -0.001388676379437604, 2.4390450703564542e-5];
    let square = r * r;
    let fourth = square * square;
    ((1.0 + square * C[0]) + fourth * C[1]) + fourth * square * (C[2] + square * C[3])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every argument the evaluation's asteroid can hash: whole-number points within 16 of the origin.
    fn hashed() -> impl Iterator<Item = f32> {
        let line = -16..=16;
        line.clone().flat_map(move |i| {
            let line = line.clone();
            line.clone().flat_map(move |j| {
                line.clone().map(move |k| 12.98 * i as f32 + 78.23 * j as f32 + 35.63 * k as f32)
            })
        })
    }

    #[test]
    fn error_stays_below_the_stated_bound() {
        let fine = (-20_000..20_000).map(|i| i as f32 * 0.001);
        for x in hashed().chain(fine) {
            let exact = libm::sin(f64::from(x));
            let ulp = 2f64.powi((exact.abs() as f32).to_bits() as i32 / (1 << 23) - 150);
            let error = (f64::from(sin(x)) - exact).abs() / ulp.max(f64::MIN_POSITIVE);
            assert!(error <= 0.57, "sin({x}) is off by {error} units");
        }
    }

    #[test]
    fn it_is_not_the_correctly_rounded_sine() {
        let differing = hashed().filter(|&x| sin(x) != libm::sin(f64::from(x)) as f32).count();
        assert!((1..3_000).contains(&differing), "{differing} of 35937");
    }

    #[test]
    fn large_and_undefined_arguments_have_an_answer() {
        assert!(sin(f32::NAN).is_nan() && sin(f32::INFINITY).is_nan());
        assert_eq!(sin(1e30), libm::sin(f64::from(1e30f32)) as f32);
        assert_eq!(sin(0.0), 0.0);
    }
}
