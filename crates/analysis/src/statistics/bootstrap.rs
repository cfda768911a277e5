//! Bootstrap intervals that resample participants, never answers (Efron 1987, J. Amer. Statist. Assoc. 82:171).
//!
//! Resample b draws from its own stream of the seeded generator, so the result does not depend on the number of threads.

use crate::interval::{Interval, LEVEL};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal};

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

/// The participants of one resample: `participants` draws with replacement.
fn draw(resampling: Resampling, resample: usize, participants: usize) -> Vec<usize> {
    let mut stream =
        Pcg64::seed_from_u64(resampling.seed ^ (resample as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    (0..participants).map(|_| stream.random_range(0..participants)).collect()
}

fn replicates<T: Send>(
    resampling: Resampling,
    participants: usize,
    statistic: impl Fn(&[usize]) -> Option<T> + Sync,
) -> Vec<T> {
    let one = |resample| statistic(&draw(resampling, resample, participants));
    let all: Vec<Option<T>> = (0..resampling.resamples).into_par_iter().map(one).collect();
    all.into_iter().flatten().collect()
}

/// The bias-corrected and accelerated interval of a statistic of participants, given by their indices.
///
/// The acceleration is the jackknife's over participants. `None` if the statistic, a jackknife value or more than half of
/// the resamples have no estimate, if the estimate lies outside all resamples, or if nothing varies.
pub fn bca(
    participants: usize,
    resampling: Resampling,
    statistic: impl Fn(&[usize]) -> Option<f64> + Sync,
) -> Option<BootstrapInterval> {
    let everyone: Vec<usize> = (0..participants).collect();
    let estimate = statistic(&everyone)?;
    let without = |left_out: usize| {
        let others: Vec<usize> = everyone.iter().copied().filter(|&p| p != left_out).collect();
        statistic(&others)
    };
    let jackknife = (0..participants).map(without).collect::<Option<Vec<f64>>>()?;
    let replicates = replicates(resampling, participants, &statistic);
    let without_estimate = resampling.resamples - replicates.len();
    let interval = bca_interval(replicates, estimate, &jackknife)
        .filter(|_| 2 * without_estimate <= resampling.resamples);
    interval.map(|interval| BootstrapInterval { interval, without_estimate })
}

/// BCa ends from replicates, estimate and jackknife values: quantiles at Phi(z0 + (z0 + z) / (1 - a (z0 + z))), with
/// z0 = Phi^-1 of the share of replicates below the estimate (those equal to it count half).
pub(super) fn bca_interval(mut replicates: Vec<f64>, estimate: f64, jackknife: &[f64]) -> Option<Interval> {
    replicates.sort_by(f64::total_cmp);
    let below = replicates.iter().filter(|&&r| r < estimate).count() as f64;
    let same = replicates.iter().filter(|&&r| r == estimate).count() as f64;
    let share = (below + 0.5 * same) / replicates.len() as f64;
    if !(share > 0.0 && share < 1.0) {
        return None;
    }
    let mean = jackknife.iter().sum::<f64>() / jackknife.len() as f64;
    let moment = |power: i32| jackknife.iter().map(|value| (mean - value).powi(power)).sum::<f64>();
    if moment(2) == 0.0 {
        return None;
    }
    let acceleration = moment(3) / (6.0 * moment(2).powf(1.5));
    let normal = Normal::standard();
    let bias = normal.inverse_cdf(share);
    let end = |level: f64| {
        let z = bias + normal.inverse_cdf(level);
        quantile(&replicates, normal.cdf(bias + z / (1.0 - acceleration * z)))
    };
    Some(Interval { low: end(0.5 - LEVEL / 2.0), high: end(0.5 + LEVEL / 2.0) })
}

/// The percentile interval of a statistic of participants, given by their indices: quantiles of the replicates. For
/// statistics whose jackknife says nothing of their spread, such as a median. `None` if the statistic or more than half of
/// the resamples have no estimate.
pub fn percentile(
    participants: usize,
    resampling: Resampling,
    statistic: impl Fn(&[usize]) -> Option<f64> + Sync,
) -> Option<BootstrapInterval> {
    let mut replicates = replicates(resampling, participants, statistic);
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
/// error. `None` as for [`bca`], or if a standard error is not above zero in more than half of the resamples.
pub fn studentised(
    participants: usize,
    resampling: Resampling,
    statistic: impl Fn(&[usize]) -> Option<(f64, f64)> + Sync,
) -> Option<BootstrapInterval> {
    let everyone: Vec<usize> = (0..participants).collect();
    let (estimate, error) = statistic(&everyone).filter(|(_, error)| *error > 0.0)?;
    let mut pivots = replicates(resampling, participants, |draws| {
        let (replicate, own) = statistic(draws)?;
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

/// Mean and standard error of the drawn participants' scores, for [`studentised`]; `None` of fewer than two.
pub fn mean_and_error(scores: &[f64], draws: &[usize]) -> Option<(f64, f64)> {
    let n = draws.len() as f64;
    let mean = draws.iter().map(|&p| scores[p]).sum::<f64>() / n;
    let squares: f64 = draws.iter().map(|&p| (scores[p] - mean) * (scores[p] - mean)).sum();
    (draws.len() > 1).then(|| (mean, (squares / (n - 1.0) / n).sqrt()))
}

/// Quantile of sorted values, linear between neighbours (Hyndman and Fan's type 7, as R and NumPy have it).
fn quantile(sorted: &[f64], level: f64) -> f64 {
    let place = level * (sorted.len() - 1) as f64;
    let (below, above) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
    below + (above - below) * place.fract()
}

#[cfg(test)]
mod tests;
