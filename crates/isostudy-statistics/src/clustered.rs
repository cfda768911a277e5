//! What is known of a combination of estimates where one participant's answers hang together.

use super::fit::has_spread;
use super::newton::{Matrix, quadratic, times};
use crate::interval::{Interval, t_half_width};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// A coefficient with what is known of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficient {
    /// The estimate.
    pub estimate: f64,
    /// Standard error, participants as clusters.
    pub se: f64,
    /// t interval at [`LEVEL`](crate::interval::LEVEL) on m - 1 degrees of freedom.
    pub interval: Interval,
    /// Two-sided p of t = estimate / se on m - 1 degrees of freedom.
    pub p: f64,
}

/// m/(m-1) B (sum of s s') B over m participants' gradients s, B the inverse information (Liang and Zeger 1986, Biometrika 73:13);
/// `None` with fewer than two of them.
pub(super) fn sandwich(bread: &Matrix, scores: impl ExactSizeIterator<Item = Vec<f64>>) -> Option<Matrix> {
    let (m, size) = (scores.len() as f64, bread.len());
    let mut sum = vec![vec![0.0; size]; size];
    for score in scores {
        let moved = times(bread, &score);
        for (row, x) in sum.iter_mut().zip(&moved) {
            row.iter_mut().zip(&moved).for_each(|(cell, y)| *cell += m / (m - 1.0) * x * y);
        }
    }
    (m > 1.0).then_some(sum)
}

/// Estimates with both of their covariances.
#[derive(Debug, Clone, Copy)]
pub(super) struct Estimates<'a> {
    pub(super) independent: &'a Matrix,
    pub(super) clustered: Option<&'a Matrix>,
    pub(super) participants: u64,
}

impl Estimates<'_> {
    /// A sum of parameters times factors, whose value is given: t interval and two-sided p on m - 1 degrees of freedom. `None` with
    /// fewer than two participants, and where no two of them tell anything different.
    pub(super) fn combined(&self, value: f64, factors: &[(usize, f64)]) -> Option<Coefficient> {
        let mut contrast = vec![0.0; self.independent.len()];
        factors.iter().for_each(|&(place, factor)| contrast[place] += factor);
        let error = |of: &Matrix| quadratic(&contrast, of, &contrast).max(0.0).sqrt();
        let se = self.clustered.map(error).filter(|&se| has_spread(se, error(self.independent)))?;
        let degrees = self.participants as f64 - 1.0;
        let half = t_half_width(degrees)? * se;
        let t = StudentsT::new(0.0, 1.0, degrees).ok()?;
        let interval = Interval { low: value - half, high: value + half };
        Some(Coefficient { estimate: value, se, interval, p: 2.0 * t.cdf(-(value / se).abs()) })
    }

    /// The difference of two items' worths, of which those of items 1.. begin at the parameter `start`.
    pub(super) fn difference(
        &self,
        worths: &[f64],
        start: usize,
        item: usize,
        other: usize,
    ) -> Option<Coefficient> {
        let parts = [(item, 1.0), (other, -1.0)];
        let own =
            parts.into_iter().filter(|(item, _)| *item > 0).map(|(item, sign)| (start + item - 1, sign));
        self.combined(worths[item] - worths[other], &own.collect::<Vec<_>>())
    }
}
