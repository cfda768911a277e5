//! Splines against SciPy, linear functions, and what moves with its data.

use glam::{DMat3, DVec3};
use isostudy_scattered::{FitError, FitSettings, Kernel, Polyharmonic};

const STEPS: [f64; 3] = [0.8191725133961645, 0.6710436067037893, 0.5497004779019703];
const SHIFTS: [f64; 3] = [10.0, -2.0, 0.5];

/// As scripts/scattered-values.py makes them.
fn point(i: usize) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|k| 3.0 * ((i as f64 * STEPS[k]) % 1.0) + SHIFTS[k]))
}

fn value(p: DVec3) -> f64 {
    let (x, y, z) = (p.x - 11.0, p.y + 1.0, p.z - 2.0);
    (x * x + y * y + z * z).sqrt() + 0.25 * x * y - z * z * z / 8.0
}

/// Points, kernel, smoothing, and the values at six other points.
/// scripts/scattered-values.py prints them: NumPy 2.4.6, SciPy 1.17.1.
const SCIPY: [(usize, Kernel, f64, [f64; 6]); 6] = [
    (
        20,
        Kernel::Biharmonic,
        0.0,
        [
            1.0745910714062128,
            2.331895648128687,
            1.1714440169381042,
            1.159464192839056,
            1.8662509201098918,
            1.902029196662831,
        ],
    ),
    (
        400,
        Kernel::Biharmonic,
        0.0,
        [
            1.2225835069625282,
            2.6447583668958226,
            1.099813981771708,
            1.01806716872383,
            2.025124851850838,
            2.0436034061663966,
        ],
    ),
    (
        400,
        Kernel::Biharmonic,
        0.5,
        [
            1.19939726313605,
            2.653349560495489,
            1.0977086731047265,
            1.0320687206097228,
            2.0243406945361064,
            2.0512833740521814,
        ],
    ),
    (
        60,
        Kernel::Triharmonic,
        0.0,
        [
            1.223450951279621,
            2.6431112397395378,
            1.088475799074178,
            0.9937088921707118,
            2.015492747590553,
            2.0483207077921577,
        ],
    ),
    (
        400,
        Kernel::Triharmonic,
        0.0,
        [
            1.237815579857548,
            2.6403219968267067,
            1.1006869363505052,
            1.0158073744700706,
            2.0253614457459577,
            2.0416551200196125,
        ],
    ),
    (
        400,
        Kernel::Triharmonic,
        0.5,
        [
            1.229313059147803,
            2.643738779376577,
            1.0917544328532642,
            1.0081806791413372,
            2.022168516439648,
            2.0454903079142768,
        ],
    ),
];

fn fitted(points: &[DVec3], kernel: Kernel, smoothing: f64) -> Polyharmonic {
    let values: Vec<f64> = points.iter().map(|&p| value(p)).collect();
    let settings = FitSettings { kernel, smoothing, ..FitSettings::default() };
    let (spline, report) = Polyharmonic::fit(points, &values, &settings).unwrap();
    assert_eq!((report.points, report.centres), (points.len(), points.len()));
    if smoothing == 0.0 {
        assert!(report.largest < 1e-10 && report.root_mean_square <= report.largest, "{report:?}");
    } else {
        assert!(report.largest > 1e-4, "{report:?}");
    }
    spline
}

#[test]
fn values_are_those_of_scipy() {
    for (many, kernel, smoothing, want) in SCIPY {
        let points: Vec<DVec3> = (0..many).map(point).collect();
        let spline = fitted(&points, kernel, smoothing);
        for (i, want) in want.into_iter().enumerate() {
            let found = spline.value(point(1000 + 7 * i));
            assert!((found - want).abs() < 1e-9, "{many} {kernel:?} {smoothing}, {i}: {found} for {want}");
        }
    }
}

#[test]
fn linear_functions_are_reproduced() {
    let linear = |p: DVec3| 3.0 - 2.0 * p.x + 0.5 * p.y + 7.0 * p.z;
    let points: Vec<DVec3> = (0..300).map(point).collect();
    let values: Vec<f64> = points.iter().map(|&p| linear(p)).collect();
    for kernel in [Kernel::Biharmonic, Kernel::Triharmonic] {
        for (smoothing, most_centres) in [(0.0, 3000), (0.3, 3000), (0.0, 40)] {
            let settings = FitSettings { kernel, smoothing, most_centres };
            let (spline, report) = Polyharmonic::fit(&points, &values, &settings).unwrap();
            assert!(report.largest < 1e-11, "{report:?}");
            for i in 0..50 {
                // Far outside as well.
                let p = point(2000 + i) * if i % 2 == 0 { 1.0 } else { 30.0 };
                let size = 1.0 + p.abs().max_element();
                assert!((spline.value(p) - linear(p)).abs() < 1e-11 * size, "{kernel:?} at {p}");
                assert!(
                    (spline.gradient(p) - DVec3::new(-2.0, 0.5, 7.0)).length() < 1e-10,
                    "{kernel:?} at {p}"
                );
            }
        }
    }
}

#[test]
fn a_spline_turns_moves_and_scales_with_its_data() {
    let points: Vec<DVec3> = (0..120).map(point).collect();
    let values: Vec<f64> = points.iter().map(|&p| value(p)).collect();
    let turn = DMat3::from_cols_array(&[1.0, 2.0, -2.0, -2.0, 2.0, 1.0, 2.0, 1.0, 2.0].map(|x| x / 3.0));
    for kernel in [Kernel::Biharmonic, Kernel::Triharmonic] {
        let settings = FitSettings { kernel, ..FitSettings::default() };
        let placed = |p: DVec3| 40.0 * (turn * p) - DVec3::new(100.0, 7.0, 3.0);
        let moved: Vec<DVec3> = points.iter().map(|&p| placed(p)).collect();
        let (one, _) = Polyharmonic::fit(&points, &values, &settings).unwrap();
        let (other, _) = Polyharmonic::fit(&moved, &values, &settings).unwrap();
        for i in 0..30 {
            let p = point(3000 + i);
            let (a, b) = (one.value(p), other.value(placed(p)));
            assert!((a - b).abs() < 1e-8, "{kernel:?}: {a} and {b}");
        }
    }
}

#[test]
fn gradients_are_those_of_the_values_and_rows_are_values() {
    for (kernel, smoothing) in [(Kernel::Biharmonic, 0.0), (Kernel::Triharmonic, 0.1)] {
        let points: Vec<DVec3> = (0..100).map(point).collect();
        let spline = fitted(&points, kernel, smoothing);
        for i in 0..60 {
            let (p, step) = (point(500 + i), 1e-5);
            let differences = [DVec3::X, DVec3::Y, DVec3::Z]
                .map(|axis| (spline.value(p + step * axis) - spline.value(p - step * axis)) / (2.0 * step));
            let off = (spline.gradient(p) - DVec3::from_array(differences)).length();
            assert!(off < 1e-7, "{kernel:?} at {p}: {off}");
        }
        let x: Vec<f64> = (0..37).map(|i| 9.0 + 0.13 * f64::from(i)).collect();
        let mut row = vec![f64::NAN; x.len()];
        spline.row(&x, -1.3, 1.7, &mut row);
        for (x, found) in x.into_iter().zip(row) {
            assert_eq!(found.to_bits(), spline.value(DVec3::new(x, -1.3, 1.7)).to_bits());
        }
        assert!(spline.gradient(points[5]).is_finite(), "at a centre");
    }
}

/// A fit with chosen centres is no worse where more are chosen, and its report is that of a search of all points.
#[test]
fn chosen_centres_come_near_and_the_report_says_how_near() {
    let points: Vec<DVec3> = (0..1500).map(point).collect();
    let values: Vec<f64> = points.iter().map(|&p| value(p)).collect();
    for kernel in [Kernel::Biharmonic, Kernel::Triharmonic] {
        let mut before = f64::INFINITY;
        for most_centres in [30, 120, 480] {
            let settings = FitSettings { kernel, smoothing: 0.0, most_centres };
            let (spline, report) = Polyharmonic::fit(&points, &values, &settings).unwrap();
            let errors = points.iter().zip(&values).map(|(&p, value)| (spline.value(p) - value).abs());
            let largest = errors.clone().fold(0.0, f64::max);
            let mean: f64 = errors.map(|e| e * e).sum::<f64>() / 1500.0;
            assert_eq!((report.centres, report.points), (most_centres, 1500));
            assert_eq!((report.largest, report.root_mean_square), (largest, mean.sqrt()));
            assert!(report.largest < 0.6 * before, "{kernel:?}, {most_centres}: {report:?} after {before}");
            println!("{kernel:?}, {most_centres} of 1500 centres: largest error {largest:.1e}");
            before = report.largest;
        }
    }
}

/// Centres that are chosen by their errors gather where the function bends: as many spread evenly are worse.
#[test]
fn chosen_centres_are_better_than_any() {
    let peak = |p: DVec3| 1.0 / (0.02 + p.distance_squared(DVec3::new(11.0, -1.0, 2.0)));
    let points: Vec<DVec3> = (0..2000).map(point).collect();
    let values: Vec<f64> = points.iter().map(|&p| peak(p)).collect();
    let settings = FitSettings { most_centres: 200, ..FitSettings::default() };
    let (_, chosen) = Polyharmonic::fit(&points, &values, &settings).unwrap();
    let (any, _) = Polyharmonic::fit(&points[..200], &values[..200], &settings).unwrap();
    let largest = points.iter().map(|&p| (any.value(p) - peak(p)).abs()).fold(0.0, f64::max);
    assert!(chosen.largest < 0.3 * largest, "{} and {largest}", chosen.largest);
}

#[test]
fn points_at_one_place_are_one_centre() {
    let mut points: Vec<DVec3> = (0..50).map(point).collect();
    let mut values: Vec<f64> = points.iter().map(|&p| value(p)).collect();
    let (one, _) = Polyharmonic::fit(&points, &values, &FitSettings::default()).unwrap();
    points.extend_from_within(10..20);
    values.extend_from_within(10..20);
    let (twice, report) = Polyharmonic::fit(&points, &values, &FitSettings::default()).unwrap();
    assert_eq!((report.points, report.centres), (60, 50));
    assert!(report.largest < 1e-10);
    let p = point(77);
    assert!((one.value(p) - twice.value(p)).abs() < 1e-11);
    // Two values at one place: no function has both, and the report says so.
    *values.last_mut().unwrap() += 1.0;
    let (_, report) = Polyharmonic::fit(&points, &values, &FitSettings::default()).unwrap();
    assert!((report.largest - 1.0).abs() < 1e-9, "{report:?}");
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    let settings = FitSettings::default();
    let fit = |points: &[DVec3], values: &[f64], settings: &FitSettings| {
        Polyharmonic::fit(points, values, settings).map(drop).unwrap_err()
    };
    let points: Vec<DVec3> = (0..9).map(point).collect();
    assert_eq!(fit(&points[..3], &[1.0; 3], &settings), FitError::Few { points: 3 });
    assert_eq!(fit(&[], &[], &settings), FitError::Few { points: 0 });
    let flat: Vec<DVec3> = points.iter().map(|p| DVec3::new(p.x, p.y, 2.0 * p.x - p.y)).collect();
    assert_eq!(fit(&flat, &[1.0; 9], &settings), FitError::Flat);
    let line: Vec<DVec3> = points.iter().map(|p| DVec3::splat(p.x)).collect();
    assert_eq!(fit(&line, &[1.0; 9], &settings), FitError::Flat);
    assert_eq!(fit(&[DVec3::ONE; 9], &[1.0; 9], &settings), FitError::Flat);
    for odd in [f64::NAN, f64::INFINITY, 2e18] {
        let mut points = points.clone();
        points[4].y = odd;
        assert_eq!(fit(&points, &[1.0; 9], &settings), FitError::NotFinite { point: 4 });
    }
    let mut values = [1.0; 9];
    values[7] = f64::NAN;
    assert_eq!(fit(&points, &values, &settings), FitError::NotFinite { point: 7 });
    for (smoothing, most_centres, name) in [
        (-1.0, 100, "smoothing"),
        (f64::NAN, 100, "smoothing"),
        (0.0, 3, "centres"),
        (0.0, 10_001, "centres"),
    ] {
        let odd = FitSettings { smoothing, most_centres, ..settings };
        assert!(
            matches!(fit(&points, &[1.0; 9], &odd), FitError::Setting { name: found, .. } if found == name)
        );
    }
}
