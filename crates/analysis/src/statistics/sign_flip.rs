//! The exact sign-flip test over participants (Fisher 1935, *The Design of Experiments*, section 21).
//!
//! Each participant contributes one integer, `d` = answers for A minus answers for B over a contrast's questions.
//! Without preference `d` and `-d` are equally likely, however much one person's answers hang together, so
//!
//! p = #{e in {-1, +1}^m : |sum e_s d_s| >= |sum d_s|} / 2^m.
//!
//! No pattern is enumerated: a pattern is the subset of participants with a plus sign, and subsets are counted by
//! their sum of |d|, one participant at a time. Up to [`RATIO_LIMIT`] participants with `d != 0` the counts are exact
//! in 128 bits. Beyond, the distribution is tilted exponentially until its mean is the observed sum (Daniels 1954), so
//! that what is added up is never small, and doubles are enough at any depth: the logarithm of p is right to about
//! 1e-10 and does not underflow.

use std::collections::BTreeMap;

/// Participants with a difference up to which p is an exact ratio of integers.
pub const RATIO_LIMIT: usize = 126;

/// Densities below this part of the largest are dropped by the tilted sum; far below a double's resolution.
const NEGLIGIBLE: f64 = 1e-30;

/// The result of a sign-flip test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignFlip {
    /// Sum of the differences: answers for A minus answers for B.
    pub net: i64,
    /// How many participants, those without a difference included.
    pub participants: usize,
    /// Natural logarithm of the two-sided p.
    pub ln_p: f64,
    /// p as patterns at least as extreme, over all 2^k patterns of the k participants with a difference; `None` for
    /// k above [`RATIO_LIMIT`]. Participants without a difference double both numbers and are left out.
    pub ratio: Option<(u128, u128)>,
}

impl SignFlip {
    /// The two-sided p, in 0..=1; 0 only if it is below the smallest double.
    pub fn p(&self) -> f64 {
        match self.ratio {
            Some((extreme, all)) => extreme as f64 / all as f64,
            None => self.ln_p.exp(),
        }
    }
}

/// Tests whether the differences, one a participant, are symmetric about zero. p is 1 if all are zero.
///
/// The same for any order of participants and for all signs turned round.
///
/// # Panics
/// If the absolute differences add up to more than 63 bits hold.
pub fn sign_flip(differences: &[i64]) -> SignFlip {
    let mut sizes = BTreeMap::new();
    for &d in differences.iter().filter(|&&d| d != 0) {
        *sizes.entry(d.unsigned_abs()).or_insert(0_u64) += 1;
    }
    let net: i64 = differences.iter().sum();
    let sizes: Vec<(u64, u64)> = sizes.into_iter().collect();
    SignFlip { net, participants: differences.len(), ..two_sided(&sizes, net) }
}

/// The two-sided p of a sum of `n` signs times `size` for each `(size, n)`; sizes are above zero.
pub(super) fn two_sided(sizes: &[(u64, u64)], net: i64) -> SignFlip {
    let divisor = sizes.iter().fold(net.unsigned_abs(), |divisor, &(size, _)| gcd(divisor, size)).max(1);
    let sizes: Vec<(u64, u64)> = sizes.iter().map(|&(size, n)| (size / divisor, n)).collect();
    let (decided, net_size) = (sizes.iter().map(|&(_, n)| n).sum::<u64>(), net.unsigned_abs() / divisor);
    let participants = decided as usize;
    if participants <= RATIO_LIMIT {
        let extreme = extreme_patterns(&sizes, net_size);
        let all = 1_u128 << decided;
        let ln_p = (extreme as f64).ln() - decided as f64 * std::f64::consts::LN_2;
        return SignFlip { net, participants, ln_p, ratio: Some((extreme, all)) };
    }
    SignFlip { net, participants, ln_p: ln_tilted(&sizes, net_size), ratio: None }
}

/// How many sign patterns give a sum of at least `net` in size.
fn extreme_patterns(sizes: &[(u64, u64)], net: u64) -> u128 {
    let total: u64 = sizes.iter().map(|&(size, n)| size * n).sum();
    // patterns[j]: how many have plus signs on sizes that add up to j; the signed sum is 2j - total.
    let mut patterns = vec![0_u128; total as usize + 1];
    patterns[0] = 1;
    let mut reached = 0;
    for &(size, n) in sizes {
        for _ in 0..n {
            reached += size as usize;
            for j in (size as usize..=reached).rev() {
                patterns[j] += patterns[j - size as usize];
            }
        }
    }
    let extreme = |&(j, _): &(usize, &u128)| (2 * j as u64).abs_diff(total) >= net;
    patterns.iter().enumerate().filter(extreme).map(|(_, count)| count).sum()
}

/// ln P(|sum| >= net) by exponential tilting; `net` has the parity of the sum of sizes.
fn ln_tilted(sizes: &[(u64, u64)], net: u64) -> f64 {
    let total: u64 = sizes.iter().map(|&(size, n)| size * n).sum();
    let decided: u64 = sizes.iter().map(|&(_, n)| n).sum();
    if net == 0 {
        return 0.0;
    }
    if net == total {
        return (1.0 - decided as f64) * std::f64::consts::LN_2;
    }
    let tilt = tilt_to(sizes, net as f64);
    // Density over j, the sum of sizes with a plus sign, under the tilt; `first` is the j of its first entry.
    let (mut first, mut density) = (0_u64, vec![1.0]);
    for &(size, n) in sizes {
        let (start, group) = binomial(n, 1.0 / (1.0 + (-2.0 * tilt * size as f64).exp()));
        let mut sum = vec![0.0; density.len() + (group.len() - 1) * size as usize];
        for (k, weight) in group.iter().enumerate() {
            for (into, d) in sum[k * size as usize..].iter_mut().zip(&density) {
                *into += weight * d;
            }
        }
        first += start * size;
        let cut = trim(&mut sum);
        (first, density) = (first + cut, sum);
    }
    let threshold = (net + total) / 2;
    let tail = density.iter().zip(first..).filter(|&(_, j)| j >= threshold);
    let tail: f64 = tail.map(|(d, j)| d * (-2.0 * tilt * (j - threshold) as f64).exp()).sum();
    // Undo the tilt: ln of the moment generating function, minus tilt times the threshold's sum; twice for two sides.
    let generating: f64 = sizes.iter().map(|&(size, n)| n as f64 * ln_cosh(tilt * size as f64)).sum();
    (std::f64::consts::LN_2 + tail.ln() + generating - tilt * net as f64).min(0.0)
}

/// The tilt whose expected sum is `net`: sum n size tanh(tilt size) = net, by bisection.
fn tilt_to(sizes: &[(u64, u64)], net: f64) -> f64 {
    let expected =
        |tilt: f64| -> f64 { sizes.iter().map(|&(v, n)| (n * v) as f64 * (tilt * v as f64).tanh()).sum() };
    let mut high = 1e-3;
    while expected(high) < net && high < 64.0 {
        high *= 2.0;
    }
    let mut low = 0.0;
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if expected(middle) < net { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The binomial density without its negligible ends, by ratios from the mode: `(first count, densities)`.
fn binomial(n: u64, p: f64) -> (u64, Vec<f64>) {
    let odds = p / (1.0 - p);
    let mode = (((n + 1) as f64 * p) as u64).min(n);
    let mut below = Vec::new();
    let (mut k, mut d) = (mode, 1.0);
    while k > 0 && d > NEGLIGIBLE {
        d *= k as f64 / ((n - k + 1) as f64 * odds);
        k -= 1;
        below.push(d);
    }
    let first = k;
    let mut densities: Vec<f64> = below.into_iter().rev().chain([1.0]).collect();
    (k, d) = (mode, 1.0);
    while k < n && d > NEGLIGIBLE {
        d *= (n - k) as f64 * odds / (k + 1) as f64;
        k += 1;
        densities.push(d);
    }
    let sum: f64 = densities.iter().sum();
    densities.iter_mut().for_each(|d| *d /= sum);
    (first, densities)
}

/// Cuts negligible ends off; how many entries the front lost.
fn trim(density: &mut Vec<f64>) -> u64 {
    let least = NEGLIGIBLE * density.iter().copied().fold(0.0, f64::max);
    let keep = |d: &f64| *d > least;
    let last = density.iter().rposition(keep).expect("the largest is kept");
    density.truncate(last + 1);
    let first = density.iter().position(keep).expect("the largest is kept");
    density.drain(..first);
    first as u64
}

fn ln_cosh(x: f64) -> f64 {
    x.abs() + (-2.0 * x.abs()).exp().ln_1p() - std::f64::consts::LN_2
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests;
