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
//! 1e-10 and does not underflow. No normal approximation enters at any size; a hundred thousand participants take
//! milliseconds.

use std::collections::BTreeMap;

/// Participants with a difference up to which p is an exact ratio of integers.
pub const RATIO_LIMIT: usize = 126;

/// Natural logarithm of what counts as nothing beside 1 in the tilted sum, far below a double's resolution.
const NEGLIGIBLE: f64 = -50.0;

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
    let mut counts = BTreeMap::new();
    differences.iter().for_each(|&d| *counts.entry(d).or_insert(0_u64) += 1);
    sign_flip_of_counts(&counts)
}

/// As [`sign_flip`], given how many participants have each difference.
///
/// # Panics
/// As [`sign_flip`].
pub fn sign_flip_of_counts(counts: &BTreeMap<i64, u64>) -> SignFlip {
    sign_flip_within(counts, 0)
}

/// As [`sign_flip_of_counts`], for differences that were rounded: patterns count as extreme that fall short of the observed
/// sum by up to `slack`, so that p is an upper bound. Beyond [`RATIO_LIMIT`], where no single sum matters, it is ignored.
///
/// # Panics
/// As [`sign_flip`].
pub(super) fn sign_flip_within(counts: &BTreeMap<i64, u64>, slack: u64) -> SignFlip {
    let observed = Observed::of(counts);
    let Observed { net, participants, decided, ref sizes, divisor } = observed;
    if decided <= RATIO_LIMIT {
        let patterns = patterns(sizes);
        let ratio = observed.ratio(&patterns, net, decided, slack);
        let ln_p = (ratio.0 as f64).ln() - decided as f64 * std::f64::consts::LN_2;
        return SignFlip { net, participants, ln_p, ratio: Some(ratio) };
    }
    let ln_p = ln_tilted(sizes, net.unsigned_abs() / divisor);
    SignFlip { net, participants, ln_p, ratio: None }
}

/// The two-sided p of `n` signs times `size` for each `(size, n)`, sizes above zero, adding up to `net` or more either way.
pub(super) fn two_sided(sizes: &[(u64, u64)], net: u64) -> f64 {
    let decided = sizes.iter().map(|&(_, n)| n).sum::<u64>();
    if decided as usize > RATIO_LIMIT {
        return ln_tilted(sizes, net).exp();
    }
    let total: u64 = sizes.iter().map(|&(size, n)| size * n).sum();
    let extreme = |&(j, _): &(usize, &u128)| (2 * j as u64).abs_diff(total) >= net;
    let extreme: u128 = patterns(sizes).iter().enumerate().filter(extreme).map(|(_, count)| count).sum();
    extreme as f64 / (1_u128 << decided) as f64
}

/// p with one participant left out, by that participant's difference.
///
/// # Panics
/// As [`sign_flip`].
pub(super) fn without_one(counts: &BTreeMap<i64, u64>, slack: u64) -> BTreeMap<i64, f64> {
    let observed = Observed::of(counts);
    let Observed { net, decided, ref sizes, divisor, .. } = observed;
    let present = counts.iter().filter(|&(_, &n)| n > 0).map(|(&d, _)| d);
    if decided > RATIO_LIMIT {
        let without = |d: i64| {
            let mut others = counts.clone();
            *others.get_mut(&d).expect("one of them") -= 1;
            (d, sign_flip_within(&others, slack).p())
        };
        return present.map(without).collect();
    }
    let all = patterns(sizes);
    let without = |d: i64| {
        let (extreme, of) = match d {
            0 => observed.ratio(&all, net, decided, slack),
            _ => {
                let size = (d.unsigned_abs() / divisor) as usize;
                observed.ratio(&divided(&all, size), net - d, decided - 1, slack)
            }
        };
        (d, extreme as f64 / of as f64)
    };
    present.map(without).collect()
}

/// Differences, their signs taken off and their common divisor with them.
struct Observed {
    net: i64,
    participants: usize,
    /// How many have a difference.
    decided: usize,
    /// `(size, n)`: how many differences are of this size, in units of the divisor.
    sizes: Vec<(u64, u64)>,
    divisor: u64,
}

impl Observed {
    fn of(counts: &BTreeMap<i64, u64>) -> Self {
        let mut sizes: BTreeMap<u64, u64> = BTreeMap::new();
        for (&d, &n) in counts.iter().filter(|&(&d, &n)| d != 0 && n > 0) {
            *sizes.entry(d.unsigned_abs()).or_insert(0) += n;
        }
        let divisor = sizes.keys().fold(0, |divisor, &size| greatest_common_divisor(divisor, size)).max(1);
        Self {
            net: counts.iter().map(|(&d, &n)| d * n as i64).sum(),
            participants: counts.values().sum::<u64>() as usize,
            decided: sizes.values().sum::<u64>() as usize,
            sizes: sizes.into_iter().map(|(size, n)| (size / divisor, n)).collect(),
            divisor,
        }
    }

    /// How many of all patterns give a sum of at least `net` in size, less the slack.
    fn ratio(&self, patterns: &[u128], net: i64, decided: usize, slack: u64) -> (u128, u128) {
        let total = patterns.len() as u64 - 1;
        let least = net.unsigned_abs().saturating_sub(slack).div_ceil(self.divisor);
        let extreme = |&(j, _): &(usize, &u128)| (2 * j as u64).abs_diff(total) >= least;
        (patterns.iter().enumerate().filter(extreme).map(|(_, count)| count).sum(), 1 << decided)
    }
}

/// By j, how many patterns have plus signs on sizes that add up to j; the signed sum is then 2j less their total.
fn patterns(sizes: &[(u64, u64)]) -> Vec<u128> {
    let total: u64 = sizes.iter().map(|&(size, n)| size * n).sum();
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
    patterns
}

/// The patterns of all sizes but one: the generating polynomial divided by 1 + x^size.
fn divided(patterns: &[u128], size: usize) -> Vec<u128> {
    let mut others = patterns[..patterns.len() - size].to_vec();
    for j in size..others.len() {
        others[j] -= others[j - size];
    }
    others
}

/// ln P(|sum| >= net) by exponential tilting; `net` has the parity of the sum of sizes.
///
/// With j the sum of the sizes with a plus sign, its tilted chances come back from their characteristic function phi at the 2W frequencies pi k / W, which is exact up to what lies more than W from the threshold, and that is below
/// e^-78 (Hoeffding 1963). The tail's geometric weights are summed in closed form, so no chance of any single j is needed;
/// and phi is negligible at nearly every frequency, which its first factors show.
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
    let mut steps: Vec<Step> = sizes.iter().map(|&(size, n)| Step::new(size, n, tilt)).collect();
    steps.sort_by(|a, b| b.n.total_cmp(&a.n));
    // Mean of j less the threshold (net + total) / 2: nearly nothing, by the choice of the tilt.
    let excess: f64 =
        steps.iter().map(|s| 0.5 * s.n * s.size * (tilt * s.size).tanh()).sum::<f64>() - 0.5 * net as f64;
    let squares: f64 = steps.iter().map(|s| s.n * s.size * s.size).sum();
    let window = ((6.25 * squares.sqrt()).ceil()).min(total as f64 + 1.0);
    let mut tail = 0.0;
    for k in 0..=window as u64 {
        let angle = std::f64::consts::PI * k as f64 / window;
        let Some((size, phase)) = characteristic(&steps, angle) else { continue };
        let (re, im) = geometric(2.0 * tilt, angle, window, k % 2 == 1);
        let (sin, cos) = (phase + angle * excess).sin_cos();
        // Frequencies k and 2W - k are conjugates.
        let twice = if k == 0 || k as f64 == window { 1.0 } else { 2.0 };
        tail += twice * size * (cos * re - sin * im);
    }
    tail /= 2.0 * window;
    // Undo the tilt: ln of the moment generating function, minus tilt times the threshold's sum; twice for two sides.
    let generating: f64 = sizes.iter().map(|&(size, n)| n as f64 * ln_cosh(tilt * size as f64)).sum();
    (std::f64::consts::LN_2 + tail.ln() + generating - tilt * net as f64).min(0.0)
}

/// All participants of one size under the tilt: each has a plus sign with chance `plus`.
struct Step {
    size: f64,
    n: f64,
    plus: f64,
    minus: f64,
}

impl Step {
    fn new(size: u64, n: u64, tilt: f64) -> Self {
        let chance = |sign: f64| 1.0 / (1.0 + (-2.0 * sign * tilt * size as f64).exp());
        Self { size: size as f64, n: n as f64, plus: chance(1.0), minus: chance(-1.0) }
    }
}

/// Size and phase of the characteristic function of j less its mean; `None` if its size is below [`NEGLIGIBLE`].
fn characteristic(steps: &[Step], angle: f64) -> Option<(f64, f64)> {
    let (mut ln_size, mut phase) = (0.0, 0.0);
    for step in steps {
        let turn = angle * step.size;
        let half = (0.5 * turn).sin();
        ln_size += 0.5 * step.n * (-4.0 * step.plus * step.minus * half * half).ln_1p();
        if ln_size < NEGLIGIBLE {
            return None;
        }
        let (sin, cos) = turn.sin_cos();
        phase += step.n * ((step.plus * sin).atan2(step.minus + step.plus * cos) - step.plus * turn);
    }
    Some((ln_size.exp(), phase))
}

/// Sum over s = 0..W of e^((-decay - i angle) s), where angle W is a whole multiple of pi, odd or even: real and imaginary
/// part. By (1 - z^W) / (1 - z), where nothing cancels.
fn geometric(decay: f64, angle: f64, window: f64, odd: bool) -> (f64, f64) {
    let end = if odd { 1.0 + (-decay * window).exp() } else { -(-decay * window).exp_m1() };
    let half = (0.5 * angle).sin();
    let re = -(-decay).exp_m1() + 2.0 * (-decay).exp() * half * half;
    let im = (-decay).exp() * angle.sin();
    let norm = re * re + im * im;
    (end * re / norm, -end * im / norm)
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

fn ln_cosh(x: f64) -> f64 {
    x.abs() + (-2.0 * x.abs()).exp().ln_1p() - std::f64::consts::LN_2
}

/// The greatest common divisor; of zero and a number, the number.
pub(super) fn greatest_common_divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

#[cfg(test)]
mod tests;
