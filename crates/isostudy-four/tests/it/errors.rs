//! Input that is wrong is an error that says where.

use isostudy_four::{FourError, Placement, Series, interval_volume, surface};

fn series(frames: Vec<Vec<f32>>) -> Result<Series, FourError> {
    Series::try_new(Placement::unit([2, 3, 2]), frames)
}

#[test]
fn bad_frames_are_errors_that_name_the_frame() {
    let good = vec![0.0; 12];
    assert_eq!(series(vec![good.clone()]).unwrap_err(), FourError::Few { frames: 1 });
    assert_eq!(series(vec![]).unwrap_err(), FourError::Few { frames: 0 });
    let short = series(vec![good.clone(), vec![0.0; 11]]).unwrap_err();
    assert_eq!(short, FourError::Samples { frame: 1, found: 11, wanted: 12 });
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut bad = good.clone();
        bad[1 + 2 * (2 + 3)] = value;
        let error = series(vec![good.clone(), good.clone(), bad]).unwrap_err();
        assert!(matches!(error, FourError::NotFinite { frame: 2, place: [1, 2, 1], .. }), "{error}");
    }
    let flat = Series::try_new(Placement::unit([4, 1, 4]), vec![vec![0.0; 16]; 2]).unwrap_err();
    assert_eq!(flat, FourError::Flat { counts: [4, 1, 4] });
}

#[test]
fn times_outside_and_isovalues_that_are_none_are_errors() {
    let series = series(vec![vec![0.0; 12], vec![1.0; 12], vec![0.0; 12]]).unwrap();
    let space_time = series.extract(0.5).unwrap();
    for time in [-0.001, 2.0001, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let error = series.slice(0.5, time).unwrap_err();
        assert!(matches!(error, FourError::Time { last: 2, .. }), "{error}");
        assert!(matches!(space_time.slice(time), Err(FourError::Time { last: 2, .. })));
        assert!(series.slice_bytes(0.5, time).is_err());
    }
    for time in [0.0, -0.0, 0.5, 1.0, 2.0] {
        assert!(series.slice(0.5, time).is_ok(), "{time}");
    }
    for isovalue in [f32::NAN, f32::INFINITY] {
        assert!(matches!(series.extract(isovalue), Err(FourError::Isovalue { .. })));
        assert!(matches!(series.slice(isovalue, 0.5), Err(FourError::Isovalue { .. })));
        let placement = series.placement();
        assert!(matches!(surface(placement, &[0.0; 12], isovalue), Err(FourError::Isovalue { .. })));
    }
}

#[test]
fn isovalues_in_the_wrong_order_are_an_error() {
    let placement = Placement::unit([2, 3, 2]);
    let between = |low, high| interval_volume(&placement, &[0.0; 12], low, high);
    assert_eq!(between(1.0, 0.5).unwrap_err(), FourError::Order { low: 1.0, high: 0.5 });
    assert_eq!(between(1.0, 1.0).unwrap_err(), FourError::Order { low: 1.0, high: 1.0 });
    assert!(matches!(between(f32::NAN, 1.0), Err(FourError::Isovalue { .. })));
    assert!(between(0.5, 1.0).unwrap().tetrahedra.is_empty());
}
