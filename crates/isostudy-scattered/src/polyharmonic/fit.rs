//! Fitting: anchors, centres, weights.

use glam::DVec3;

use super::greedy;
use super::reduced::Anchors;
use super::system::System;
use super::{FitError, FitReport, FitSettings, MOST_CENTRES, Polyharmonic};

/// How often what rounding left is solved for again.
const REFINEMENTS: usize = 2;

impl Polyharmonic {
    /// The spline through values at points, or past them with smoothing.
    ///
    /// Up to [`FitSettings::most_centres`] points are all centres. Of more, some are chosen: first some that lie far apart, then,
    /// again and again, those where the spline so far is farthest from its value. A point at the place of another, or as good as
    /// there, is no centre. What the fit misses is in the report.
    ///
    /// O(c^3) for c centres, and 4 c^2 bytes; no thread but the caller's.
    ///
    /// # Errors
    /// [`FitError`]. A point with a value that is not finite is named.
    ///
    /// # Panics
    /// If there are not as many values as points.
    pub fn fit(
        points: &[DVec3],
        values: &[f64],
        settings: &FitSettings,
    ) -> Result<(Self, FitReport), FitError> {
        assert_eq!(points.len(), values.len(), "a value for each point");
        check(points, values, settings)?;
        let anchors = Anchors::choose(points, settings.kernel, settings.smoothing)?;
        let mut system = System::new(points, values, settings, anchors);
        if points.len() <= settings.most_centres {
            system.append(&(0..points.len()).collect::<Vec<_>>());
            system.solve();
        } else {
            greedy::choose(&mut system, settings.most_centres);
        }
        for _ in 0..REFINEMENTS {
            system.refine();
        }
        let spline = system.spline();
        let errors = (0..points.len()).map(|i| (spline.value(points[i]) - values[i]).abs());
        let (largest, squares) =
            errors.fold((0.0, 0.0), |(largest, squares): (f64, f64), e| (largest.max(e), squares + e * e));
        let root_mean_square = (squares / points.len() as f64).sqrt();
        let (points, centres) = (points.len(), spline.centres());
        Ok((spline, FitReport { points, centres, largest, root_mean_square }))
    }
}

fn check(points: &[DVec3], values: &[f64], settings: &FitSettings) -> Result<(), FitError> {
    if !(settings.smoothing >= 0.0 && settings.smoothing.is_finite()) {
        let (name, allowed) = ("smoothing", "0 or more");
        return Err(FitError::Setting { name, allowed, value: settings.smoothing });
    }
    if !(4..=MOST_CENTRES).contains(&settings.most_centres) {
        let (name, allowed) = ("centres", "4 to 10000");
        return Err(FitError::Setting { name, allowed, value: settings.most_centres as f64 });
    }
    let is_sound =
        |i: &usize| !points[*i].is_nan() && points[*i].abs().max_element() <= 1e18 && values[*i].is_finite();
    if let Some(point) = (0..points.len()).find(|i| !is_sound(i)) {
        return Err(FitError::NotFinite { point });
    }
    if points.len() < 4 { Err(FitError::Few { points: points.len() }) } else { Ok(()) }
}
