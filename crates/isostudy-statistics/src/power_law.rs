//! How a quantity grows with another: a power law.

use crate::interval::{Interval, t_half_width};
use serde::Serialize;

/// y = factor · x^exponent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PowerLaw {
    /// The slope on logarithms.
    pub exponent: f64,
    /// Its 95 % t interval, n - 2 degrees of freedom: how far the points are from any power law, not how noisy each of them
    /// is. `None` of two points.
    pub interval: Option<Interval>,
    /// y where x is 1.
    pub factor: f64,
    /// How many points.
    pub points: usize,
}

/// Least squares on the logarithms of `(x, y)`. `None` if there are fewer than two different x, or a number is not above
/// zero.
pub fn power_law(points: &[(f64, f64)]) -> Option<PowerLaw> {
    if points.iter().any(|(x, y)| !(*x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite())) {
        return None;
    }
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / n;
    let (x0, y0) = (mean(|p| p.0), mean(|p| p.1));
    let spread: f64 = logs.iter().map(|(x, _)| (x - x0).powi(2)).sum();
    if logs.len() < 2 || spread <= 0.0 {
        return None;
    }
    let exponent = logs.iter().map(|(x, y)| (x - x0) * (y - y0)).sum::<f64>() / spread;
    let residuals: f64 = logs.iter().map(|(x, y)| (y - y0 - exponent * (x - x0)).powi(2)).sum();
    let interval = t_half_width(n - 2.0).map(|t| {
        let half = t * (residuals / (n - 2.0) / spread).sqrt();
        Interval { low: exponent - half, high: exponent + half }
    });
    Some(PowerLaw { exponent, interval, factor: (y0 - exponent * x0).exp(), points: points.len() })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// R 4: `m <- lm(log(y) ~ log(x)); coef(m); confint(m)`.
    #[test]
    fn slope_and_interval_as_r_has_them() {
        let found = power_law(&[(16.0, 1.1), (32.0, 4.2), (64.0, 17.9), (128.0, 66.0)]).unwrap();
        let interval = found.interval.unwrap();
        for (ours, r) in [
            (found.exponent, 1.981_217_014_13),
            (found.factor.ln(), -5.401_799_890_83),
            (interval.low, 1.864_242_039_04),
            (interval.high, 2.098_191_989_23),
        ] {
            assert!((ours - r).abs() < 1e-9, "{ours} {r}");
        }
    }

    #[test]
    fn an_exact_law_is_found_and_nonsense_is_not() {
        let cubes: Vec<(f64, f64)> = (1..6).map(|x| (f64::from(x), 2.0 * f64::from(x * x * x))).collect();
        let found = power_law(&cubes).unwrap();
        assert!((found.exponent - 3.0).abs() < 1e-12 && (found.factor - 2.0).abs() < 1e-12);
        assert_eq!(power_law(&cubes[..2]).unwrap().interval, None);
        assert_eq!(power_law(&cubes[..1]), None);
        assert_eq!(power_law(&[(2.0, 1.0), (2.0, 3.0)]), None);
        assert_eq!(power_law(&[(1.0, 0.0), (2.0, 3.0)]), None);
    }
}
