//! The interval of alpha by a test of every value, on the scale of its odds.

use crate::interval::{Interval, t_half_width};

/// What the test needs: see [`alpha_with_interval`](super::alpha_with_interval).
pub(super) struct Odds {
    /// The estimate, below 1.
    pub(super) alpha: f64,
    /// What the odds gain by agreement with oneself; above zero.
    pub(super) own_pairs: f64,
    /// Independent deviations of the questions' shares; at least 1.
    pub(super) degrees: f64,
    /// Jackknife's, of alpha.
    pub(super) variance: f64,
    /// Participants; at least 4.
    pub(super) people: f64,
}

/// Alpha of -1.
const LEAST: f64 = -0.5;
/// More than halve any two doubles that bracket an end to neighbours.
const HALVINGS: usize = 200;

impl Odds {
    pub(super) fn interval(&self) -> Interval {
        let alpha = |odds: f64| odds / (1.0 + odds);
        Interval { low: alpha(self.end(1.0)), high: alpha(self.end(-1.0)) }.cut(-1.0, 1.0)
    }

    /// The odds at which the test statistic is so many t quantiles, by halving; at least [`LEAST`].
    fn end(&self, quantiles: f64) -> f64 {
        let above = |odds: f64| {
            let (z, t) = self.test(odds);
            z > quantiles * t
        };
        let (mut low, mut high) = (LEAST, 1.0);
        if !above(low) {
            return low;
        }
        while above(high) {
            (low, high) = (high, 2.0 * high);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if above(middle) { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// The statistic under odds, falling in them, and the t quantile that it is compared with.
    fn test(&self, odds: f64) -> (f64, f64) {
        let estimate = self.alpha / (1.0 - self.alpha) + self.own_pairs;
        let possible = odds.max(0.0);
        let mean = possible + self.own_pairs;
        let at_none = 2.0 * self.own_pairs * self.own_pairs / self.degrees;
        let of_odds = self.variance / (1.0 - self.alpha).powi(4);
        // No sum of squares is below zero, but for rounding.
        let growing = of_odds * possible / estimate.max(1e-9);
        let variance = at_none + growing;
        let h = variance / (9.0 * mean * mean);
        let z = (((estimate - odds + possible) / mean).cbrt() - 1.0 + h) / h.sqrt();
        let degrees = (self.people - 1.0) * variance * variance
            / (at_none * at_none / self.degrees + growing * growing);
        (z, t_half_width(degrees).expect("three degrees or more"))
    }
}
