//! Bootstrap intervals that resample participants, never answers (Davison and Hinkley 1997, *Bootstrap Methods and their
//! Application*).
//!
//! Participants of the same kind (the same score, the same answers) are interchangeable, so a resample is how many it has
//! of each kind: one multinomial draw, whose cost goes with the number of kinds and not of people. Resample b draws from
//! its own stream of the seeded generator, so the result does not depend on the number of threads.

use super::multinomial::multinomial;
use crate::interval::{Interval, LEVEL};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use rayon::prelude::*;

/// How to resample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Resampling {
    /// How many resamples.
    pub resamples: usize,
    /// Seed: the same seed, the same interval.
    pub seed: u64,
}

impl Default for Resampling {
    fn default() -> Self {
        Self { resamples: 2000, seed: 20_261_121 }
    }
}

/// An interval, and how many resamples it had to do without.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BootstrapInterval {
    /// The interval at [`LEVEL`].
    pub interval: Interval,
    /// Resamples without an estimate, as where answers separated. The interval speaks of the others; if there are many, it
    /// is too narrow.
    pub without_estimate: usize,
}

/// The distinct values among participants, ascending, and how many have each.
pub fn kinds(values: &[f64]) -> (Vec<f64>, Vec<u64>) {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let runs = sorted.chunk_by(|a, b| a == b);
    runs.map(|run| (run[0], run.len() as u64)).unzip()
}

fn replicates<T: Send>(
    counts: &[u64],
    resampling: Resampling,
    statistic: impl Fn(&[u64]) -> Option<T> + Sync,
) -> Vec<T> {
    let one = |resample: usize| {
        let stream = resampling.seed ^ (resample as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        statistic(&multinomial(&mut Pcg64::seed_from_u64(stream), counts))
    };
    let all: Vec<Option<T>> = (0..resampling.resamples).into_par_iter().map(one).collect();
    all.into_iter().flatten().collect()
}

/// The percentile interval of a statistic of participants, of whom there are `counts[k]` of kind k; the statistic is given
/// how many it is to take of each. Quantiles of the replicates, for statistics without a standard error, such as a median. `None` if the statistic or more than half of
/// the resamples have no estimate.
pub fn percentile(
    counts: &[u64],
    resampling: Resampling,
    statistic: impl Fn(&[u64]) -> Option<f64> + Sync,
) -> Option<BootstrapInterval> {
    let mut replicates = replicates(counts, resampling, statistic);
    let without_estimate = resampling.resamples - replicates.len();
    if replicates.is_empty() || 2 * without_estimate > resampling.resamples {
        return None;
    }
    replicates.sort_by(f64::total_cmp);
    let end = |level: f64| quantile(&replicates, level);
    let interval = Interval { low: end(0.5 - LEVEL / 2.0), high: end(0.5 + LEVEL / 2.0) };
    Some(BootstrapInterval { interval, without_estimate })
}

/// The studentised (bootstrap-t) interval: estimate - q s, where q are quantiles of (replicate - estimate) / its own
/// standard error and s is the estimate's (Davison and Hinkley 1997, section 2.4). `statistic` gives estimate and standard
/// error. `None` if the statistic or more than half of the resamples have none, or none above zero.
pub fn studentised(
    counts: &[u64],
    resampling: Resampling,
    statistic: impl Fn(&[u64]) -> Option<(f64, f64)> + Sync,
) -> Option<BootstrapInterval> {
    let (estimate, error) = statistic(counts).filter(|(_, error)| *error > 0.0)?;
    let mut pivots = replicates(counts, resampling, |weights| {
        let (replicate, own) = statistic(weights)?;
        (own > 0.0).then(|| (replicate - estimate) / own)
    });
    pivots.sort_by(f64::total_cmp);
    let without_estimate = resampling.resamples - pivots.len();
    if 2 * without_estimate > resampling.resamples {
        return None;
    }
    let end = |level: f64| estimate - quantile(&pivots, level) * error;
    let interval = Interval { low: end(0.5 + LEVEL / 2.0), high: end(0.5 - LEVEL / 2.0) };
    Some(BootstrapInterval { interval, without_estimate })
}

/// Mean of the values, each taken so often; `None` of nothing.
pub fn mean(values: &[f64], weights: &[u64]) -> Option<f64> {
    let n: u64 = weights.iter().sum();
    let sum: f64 = values.iter().zip(weights).map(|(value, &weight)| value * weight as f64).sum();
    (n > 0).then(|| sum / n as f64)
}

/// Mean and standard error of the values, each taken so often, for [`studentised`]; `None` of fewer than two.
pub fn mean_and_error(values: &[f64], weights: &[u64]) -> Option<(f64, f64)> {
    let n = weights.iter().sum::<u64>() as f64;
    let mean = mean(values, weights).filter(|_| n > 1.0)?;
    let square = |(value, &weight): (&f64, &u64)| weight as f64 * (value - mean) * (value - mean);
    let squares: f64 = values.iter().zip(weights).map(square).sum();
    Some((mean, (squares / (n - 1.0) / n).sqrt()))
}

/// Quantile of sorted values, linear between neighbours (Hyndman and Fan's type 7, as R and NumPy have it).
fn quantile(sorted: &[f64], level: f64) -> f64 {
    let place = level * (sorted.len() - 1) as f64;
    let (below, above) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
    below + (above - below) * place.fract()
}

#[cfg(test)]
mod tests;
