//! Tests of one question, where each participant answers once: the sign test, and what it does about ties.

use super::sign_flip::two_sided;
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::factorial::ln_binomial;

/// Two-sided sign test of `wins` against `losses`, ties dropped: twice the upper tail of Binomial(wins + losses, 1/2),
/// at most 1 (Dixon and Mood 1946). 1 if nothing was decided.
///
/// Over several answers of one person it claims more than it knows: use [`sign_flip`](super::sign_flip::sign_flip).
pub fn binomial(wins: u64, losses: u64) -> f64 {
    walk(wins + losses, wins.abs_diff(losses))
}

/// P(|wins - losses| >= difference) among `decided` fair answers: the sign-flip test with one answer each.
fn walk(decided: u64, difference: u64) -> f64 {
    if difference == 0 { 1.0 } else { two_sided(&[(1, decided)], difference) }
}

/// The asymptotically uniformly most powerful test of Coakley and Heise (1996, Biometrics 52:1242):
/// z = (wins - losses) / sqrt(wins + losses) and its two-sided normal p. `None` if nothing was decided.
pub fn coakley_heise(wins: u64, losses: u64) -> Option<(f64, f64)> {
    let decided = wins + losses;
    let z = (wins as f64 - losses as f64) / (decided as f64).sqrt();
    (decided > 0).then(|| (z, 2.0 * Normal::standard().cdf(-z.abs())))
}

/// The trinomial test (Bian, McAleer and Wong 2011, Math. Comput. Simul. 81:1153), two-sided: P(|D| >= |wins - losses|)
/// where D adds up `n` independent steps of +1, 0, -1 with P(0) = ties / n and the rest shared evenly.
///
/// Computed by conditioning on the number of decided answers, a Binomial(n, 1 - ties/n). Treats the observed share of
/// ties as known: a sensitivity check, not the default. 1 if nothing was decided.
pub fn trinomial(wins: u64, ties: u64, losses: u64) -> f64 {
    let (n, difference) = (wins + ties + losses, wins.abs_diff(losses));
    if difference == 0 {
        return 1.0;
    }
    if ties == 0 {
        return binomial(wins, losses);
    }
    let decided_share = (wins + losses) as f64 / n as f64;
    let ln_density = |decided: u64| {
        let (k, rest) = (decided as f64, (n - decided) as f64);
        ln_binomial(n, decided) + k * decided_share.ln() + rest * (1.0 - decided_share).ln()
    };
    // Beyond 40 standard deviations a binomial holds less than any double.
    let spread = 40.0 * (n as f64 * decided_share * (1.0 - decided_share)).sqrt() + 40.0;
    let middle = wins + losses;
    let (low, high) = (difference.max(middle.saturating_sub(spread as u64)), n.min(middle + spread as u64));
    // A walk of k steps reaches the difference or the next sum of k's parity.
    let of_parity = |first: u64| {
        let reach = difference + (first - difference) % 2;
        let start = if first < reach { first + 2 } else { first };
        let mut p = if start <= high { walk(start, reach) } else { 0.0 };
        let mut sum = 0.0;
        for k in (start..=high).step_by(2) {
            sum += ln_density(k).exp() * p;
            p += gain(k, reach);
        }
        sum
    };
    (of_parity(low) + of_parity(low + 1)).min(1.0)
}

/// P(|S| >= reach) after k + 2 fair steps less that after k, for a reach of k's parity above zero:
/// (P(S = reach - 2) - P(S = reach)) / 2.
fn gain(k: u64, reach: u64) -> f64 {
    let up = (k + reach - 2) / 2;
    let before = (ln_binomial(k, up) - k as f64 * std::f64::consts::LN_2).exp();
    0.5 * before * (reach - 1) as f64 / (up + 1) as f64
}

#[cfg(test)]
mod tests;
