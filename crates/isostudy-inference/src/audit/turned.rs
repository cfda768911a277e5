//! Were the answers to a file turned? Then the two orders of a pair contradict each other, by more than a general pull of one
//! side explains.
//!
//! Of a pair, the answers that decide make a table of two rows, one an order of sides, and two columns, one an item. The
//! pull of a side is its log odds ratio: in Davidson's model with a side (Davidson and Beaver 1977, Biometrics 33:693) twice
//! the bonus, whatever the worths and ties. Hence the odds ratios of all pairs are compared, never mean scores, on which one
//! pull looks weak where people agree and strong where they do not.

use super::stimuli::{Stimuli, Stimulus};
use statrs::function::factorial::ln_binomial;

/// Answers in each order below which a pair is not judged.
const FEWEST_ANSWERS: u64 = 5;
/// Pairs in both orders below which the general pull of a side cannot be told from turned answers.
const FEWEST_STIMULI: usize = 4;
/// A pair whose orders contradict each other at this p, of its own, is kept from what would blame a side or an object for it.
const DOUBT: f64 = 0.05;
/// Standard errors to which the others' pull is followed to both sides, and steps to each.
const REACH: f64 = 4.0;
const STEPS: i32 = 16;

/// A pair in both orders.
pub(super) struct Judged<'a> {
    pub(super) stimulus: &'a Stimulus,
    /// Two-sided, of one pair.
    p: f64,
    /// `p` times the number of pairs; 1 unless the orders contradict each other.
    pub(super) adjusted: f64,
}

impl Judged<'_> {
    /// Whether something else would be blamed for what may be the key's.
    pub(super) fn is_doubtful(&self) -> bool {
        self.p < DOUBT
    }
}

/// Every pair that can be judged; `None` if they are too few.
///
/// A pair's own table against the others' common odds ratio, given its margins: Fisher's noncentral hypergeometric
/// distribution (Fisher 1935, Journal of the Royal Statistical Society 98:39), in which the pair's own worths have no part. The
/// common odds ratio is Mantel and Haenszel's (1959), with the variance of Robins, Breslow and Greenland (1986, Biometrics
/// 42:311) and what pairs' pulls differ by themselves: chances are averaged over where it may lie, as a normal distribution.
pub(super) fn judge(stimuli: &Stimuli) -> Option<Vec<Judged<'_>>> {
    let tables: Vec<(&Stimulus, Table)> = stimuli
        .all
        .iter()
        .filter(|s| s.orders.iter().all(|order| order.n() >= FEWEST_ANSWERS))
        .map(|s| (s, Table::of(s)))
        .collect();
    if tables.len() < FEWEST_STIMULI {
        return None;
    }
    let sums = tables.iter().fold(Sums::default(), |sums, (_, table)| sums.plus(&table.sums(), 1.0));
    let centre = sums.log_ratio();
    let spreads: Vec<Spread> = tables.iter().map(|(_, table)| table.spread(centre)).collect();
    let spread = spreads.iter().fold(Spread::default(), |all, own| all.plus(own, 1.0));
    let n = tables.len() as f64;
    let judged = tables.iter().zip(&spreads).map(|((stimulus, table), own)| {
        let others = sums.plus(&table.sums(), -1.0);
        let contradict = table.contradicts(0.5 * others.log_ratio());
        let p = if contradict { table.p(&others, spread.plus(own, -1.0).between()) } else { 1.0 };
        Judged { stimulus, p, adjusted: (n * p).min(1.0) }
    });
    Some(judged.collect())
}

/// Decided answers to a pair: by order of sides, for the lower item and for the other.
struct Table([[u64; 2]; 2]);

/// What the common odds ratio is made of, over pairs.
#[derive(Default)]
struct Sums {
    /// Mantel and Haenszel's numerator and denominator.
    ratio: [f64; 2],
    /// Sums of P R, of P S + Q R, and of Q S.
    variance: [f64; 3],
}

/// How far pairs are from the common odds ratio.
#[derive(Default)]
struct Spread {
    squares: f64,
    variances: f64,
    squared_variances: f64,
}

impl Sums {
    fn plus(&self, other: &Self, times: f64) -> Self {
        Self {
            ratio: [0, 1].map(|i| self.ratio[i] + times * other.ratio[i]),
            variance: [0, 1, 2].map(|i| self.variance[i] + times * other.variance[i]),
        }
    }

    /// Half an answer is added where all answers are on one side.
    fn ends(&self) -> [f64; 2] {
        let add = if self.ratio.iter().any(|&of| of < NOTHING) { 0.5 } else { 0.0 };
        self.ratio.map(|of| of.max(0.0) + add)
    }

    fn log_ratio(&self) -> f64 {
        let [r, s] = self.ends();
        (r / s).ln()
    }

    /// Variance of the common log odds ratio.
    fn variance(&self) -> f64 {
        let [r, s] = self.ends();
        if self.ratio.iter().any(|&of| of < NOTHING) {
            return 1.0 / r + 1.0 / s;
        }
        let [pr, mixed, qs] = self.variance;
        0.5 * (pr / (r * r) + mixed / (r * s) + qs / (s * s)).max(0.0)
    }
}

/// Below it a sum, from which others were taken off, is rounding.
const NOTHING: f64 = 1e-9;

impl Spread {
    fn plus(&self, other: &Self, times: f64) -> Self {
        Self {
            squares: self.squares + times * other.squares,
            variances: self.variances + times * other.variances,
            squared_variances: self.squared_variances + times * other.squared_variances,
        }
    }

    /// Variance between pairs' log odds ratios, by moments: where a pair's is x off, its count is off by x times its variance.
    fn between(&self) -> f64 {
        let beyond = (self.squares - self.variances).max(0.0);
        if self.squared_variances > NOTHING { beyond / self.squared_variances } else { 0.0 }
    }
}

impl Table {
    fn of(stimulus: &Stimulus) -> Self {
        Self(stimulus.orders.map(|order| [order.chosen, order.other]))
    }

    fn sums(&self) -> Sums {
        let [[a, b], [c, d]] = self.0.map(|row| row.map(|n| n as f64));
        let n = a + b + c + d;
        if n == 0.0 {
            return Sums::default();
        }
        let (p, q, r, s) = ((a + d) / n, (b + c) / n, a * d / n, b * c / n);
        Sums { ratio: [r, s], variance: [p * r, p * s + q * r, q * s] }
    }

    fn spread(&self, log_ratio: f64) -> Spread {
        let [mean, variance] = self.moments(log_ratio);
        let off = self.0[0][0] as f64 - mean;
        Spread { squares: off * off, variances: variance, squared_variances: variance * variance }
    }

    /// Whether, the pull of the side taken off, the two orders choose different items.
    fn contradicts(&self, pull: f64) -> bool {
        let log_odds = |[chosen, other]: [u64; 2]| ((chosen as f64 + 0.5) / (other as f64 + 0.5)).ln();
        (log_odds(self.0[0]) - pull) * (log_odds(self.0[1]) + pull) < 0.0
    }

    /// Given the margins, every count that the first cell can have with its chance.
    fn chances(&self, log_ratio: f64) -> Vec<(u64, f64)> {
        let [[a, b], [c, d]] = self.0;
        let (first, second, chosen) = (a + b, c + d, a + c);
        let log = |k: u64| ln_binomial(first, k) + ln_binomial(second, chosen - k) + k as f64 * log_ratio;
        let range = chosen.saturating_sub(second)..=first.min(chosen);
        let logs: Vec<f64> = range.clone().map(log).collect();
        let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = logs.iter().map(|log| (log - most).exp()).sum();
        range.zip(logs).map(|(k, log)| (k, (log - most).exp() / sum)).collect()
    }

    fn moments(&self, log_ratio: f64) -> [f64; 2] {
        let chances = self.chances(log_ratio);
        let mean: f64 = chances.iter().map(|&(k, p)| p * k as f64).sum();
        [mean, chances.iter().map(|&(k, p)| p * (k as f64 - mean).powi(2)).sum()]
    }

    /// Two-sided: twice the smaller tail, over where the pull of a pair may lie whose pulls differ by `between` (a variance).
    fn p(&self, others: &Sums, between: f64) -> f64 {
        let (centre, error) = (others.log_ratio(), (others.variance() + between).sqrt());
        let own = self.0[0][0];
        let (mut below, mut above, mut sum) = (0.0, 0.0, 0.0);
        for step in -STEPS..=STEPS {
            let z = REACH * f64::from(step) / f64::from(STEPS);
            let weight = (-0.5 * z * z).exp();
            sum += weight;
            for (k, p) in self.chances(centre + error * z) {
                below += if k <= own { weight * p } else { 0.0 };
                above += if k >= own { weight * p } else { 0.0 };
            }
        }
        (2.0 * below.min(above) / sum).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLES: [[[u64; 2]; 2]; 3] = [[[12, 5], [6, 9]], [[3, 14], [1, 16]], [[9, 8], [4, 11]]];

    #[test]
    fn the_common_odds_ratio_is_rs() {
        // R 4.2.2: m <- mantelhaen.test(array(c(12, 6, 5, 9, 3, 1, 14, 16, 9, 4, 8, 11), c(2, 2, 3)));
        // log(m$estimate); diff(log(m$conf.int)) / (2 * qnorm(0.975)).
        let sums = TABLES.iter().fold(Sums::default(), |sums, of| sums.plus(&Table(*of).sums(), 1.0));
        assert!((sums.log_ratio() - 1.210_290_831_660_497).abs() < 1e-12, "{}", sums.log_ratio());
        assert!((sums.variance().sqrt() - 0.488_441_858_678_891_5).abs() < 1e-12);
    }

    #[test]
    fn tails_are_rs() {
        // R 4.2.2: fisher.test(matrix(c(12, 6, 5, 9), 2), or = exp(0.4), alternative = "greater")$p.value;
        // k <- 3:17; d <- dhyper(k, 17, 15, 18) * exp(0.4 * k); d <- d / sum(d); sum(k * d); sum(d * (k - sum(k * d))^2).
        let chances = Table(TABLES[0]).chances(0.4);
        let least: f64 = chances.iter().filter(|(k, _)| *k >= 12).map(|(_, p)| p).sum();
        assert!((least - 0.210_051_267_043_152_97).abs() < 1e-12, "{least}");
        let [mean, variance] = Table(TABLES[0]).moments(0.4);
        assert!(
            (mean - 10.370_726_210_618_137).abs() < 1e-10
                && (variance - 2.009_750_442_062_863_6).abs() < 1e-10,
            "{mean} {variance}"
        );
    }
}
