//! The interval of alpha by a test of every value, on the scale of its odds.

use crate::interval::{Interval, LEVEL};
use statrs::distribution::{ContinuousCDF, StudentsT};

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
    /// How many of them answered a question, on average; above 2.
    pub(super) per_question: f64,
    /// The greatest alpha that is printed; below 1, and not below `alpha`.
    pub(super) most: f64,
}

/// Alpha of -1.
const LEAST: f64 = -0.5;
/// Alpha of 0.999, from where on an upper end is 1.
const MOST: f64 = 999.0;
/// How far apart odds are tried, relative to odds + 1: the interval is wider.
const STEP: f64 = 1.0 / 32.0;
/// More than halve any two doubles that bracket an end to neighbours.
const HALVINGS: usize = 200;
/// Chance of an end to be missed.
const TAIL: f64 = (1.0 - LEVEL) / 2.0;

impl Odds {
    pub(super) fn interval(&self) -> Interval {
        let estimate = odds(self.alpha);
        let low = if self.too_high(LEAST) { end(LEAST, estimate, |x| !self.too_high(x)) } else { LEAST };
        let (mut within, mut beyond) = (estimate, estimate);
        while !self.too_low(beyond) && beyond < MOST {
            (within, beyond) = (beyond, beyond + STEP * (1.0 + beyond));
        }
        let high = if self.too_low(beyond) { alpha(end(within, beyond, |x| self.too_low(x))) } else { 1.0 };
        Interval { low: alpha(low), high }.cut(-1.0, 1.0)
    }

    /// Whether so high an estimate has too small a chance under odds.
    fn too_high(&self, odds: f64) -> bool {
        let under = self.under(odds);
        under.chance_of_less(self.alpha) >= 1.0 - TAIL
    }

    /// Whether so low an estimate has too small a chance under odds, among estimates that are printed. Of the chance to be too high among
    /// them half of what is left over is added.
    fn too_low(&self, odds: f64) -> bool {
        let under = self.under(odds);
        let printed = under.chance_of_less(self.most);
        let too_high = (printed - (1.0 - TAIL)).max(0.0);
        under.chance_of_less(self.alpha) <= TAIL * printed + 0.5 * (TAIL * printed - too_high)
    }

    fn under(&self, truth: f64) -> Under {
        let estimate = odds(self.alpha) + self.own_pairs;
        let possible = truth.max(0.0);
        let mean = possible + self.own_pairs;
        let at_none = 2.0 * self.own_pairs * self.own_pairs / self.degrees;
        // No sum of squares is below zero, but for rounding.
        let growing = self.variance / (1.0 - self.alpha).powi(4) * possible / estimate.max(1e-9);
        let variance = at_none + growing;
        let degrees = variance * variance
            / (at_none * at_none / ((self.people - 1.0) * self.degrees)
                + growing * growing / (self.per_question - 1.0));
        let t = StudentsT::new(0.0, 1.0, degrees).expect("more than one degree");
        Under { shift: self.own_pairs - truth + possible, mean, h: variance / (9.0 * mean * mean), t }
    }
}

/// How estimates are distributed under some odds.
struct Under {
    /// To be added to estimated odds.
    shift: f64,
    mean: f64,
    h: f64,
    t: StudentsT,
}

impl Under {
    fn chance_of_less(&self, alpha: f64) -> f64 {
        let z = (((odds(alpha) + self.shift) / self.mean).cbrt() - 1.0 + self.h) / self.h.sqrt();
        self.t.cdf(z)
    }
}

fn odds(alpha: f64) -> f64 {
    alpha / (1.0 - alpha)
}

fn alpha(odds: f64) -> f64 {
    odds / (1.0 + odds)
}

/// Where `reached` begins, between where it is not and where it is, by halving.
fn end(mut not: f64, mut is: f64, reached: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (not + is);
        if middle <= not || middle >= is {
            break;
        }
        if reached(middle) { is = middle } else { not = middle }
    }
    0.5 * (not + is)
}
