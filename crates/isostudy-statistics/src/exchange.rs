//! Are some of each participant's answers like the rest? The permutation test within participants (Fisher 1935; Pesarin and
//! Salmaso 2010, *Permutation Tests for Complex Data*, section 2.5).
//!
//! If it makes no difference on which object a question was asked, any of a participant's answers could have been the one
//! on this object. The sum of those on it is then a draw without replacement. Unlike the sign-flip test of own mean
//! against the others' mean, this needs no symmetry: where nearly everybody agrees, one answer less the mean of four is skewed.

use statrs::distribution::{ContinuousCDF, Normal};

/// Steps of adding up above which the normal distribution with the same variance is taken.
const MOST_STEPS: usize = 4_000_000;

/// One participant's answers for (+), neither, and against (-) an item.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Split {
    /// Those in question: `[for, neither, against]`.
    pub own: [u64; 3],
    /// All, those in question included.
    pub all: [u64; 3],
}

/// Two-sided p: how probable it is that draws without replacement, for each participant as many as `own` has, are together
/// as far from what is expected as `own` is. Each participant's distance is N s - n S, where s and S are for less against
/// of the n and N answers. Exact, or beyond some thousand participants by the normal distribution. 1 of nothing.
pub fn exchange(splits: &[Split]) -> f64 {
    let total = |of: &[u64; 3]| of.iter().sum::<u64>() as i64;
    let net = |of: &[u64; 3]| of[0] as i64 - of[2] as i64;
    let distance = |split: &Split, s: i64| total(&split.all) * s - total(&split.own) * net(&split.all);
    let observed: i64 = splits.iter().map(|split| distance(split, net(&split.own))).sum();
    let draws: Vec<Vec<(i64, f64)>> = splits
        .iter()
        .map(|split| draws(split).into_iter().map(|(s, p)| (distance(split, s), p)).collect())
        .collect();
    let reach: i64 = draws.iter().map(|of| of.iter().map(|(d, _)| d.abs()).max().unwrap_or(0)).sum();
    let size = 2 * reach as usize + 1;
    if observed == 0 {
        return 1.0;
    }
    if splits.len().saturating_mul(size) > MOST_STEPS {
        let variance: f64 = draws.iter().flatten().map(|&(d, p)| p * (d * d) as f64).sum();
        let z = observed.abs() as f64 / variance.sqrt();
        return (2.0 * Normal::standard().sf(z)).min(1.0);
    }
    let mut sums = vec![0.0; size];
    sums[reach as usize] = 1.0;
    let mut reached = 0;
    for of in &draws {
        let own = of.iter().map(|(d, _)| d.abs()).max().unwrap_or(0);
        let mut next = vec![0.0; size];
        for at in reach - reached..=reach + reached {
            for &(d, p) in of {
                next[(at + d) as usize] += p * sums[at as usize];
            }
        }
        (sums, reached) = (next, reached + own);
    }
    let far = |&(at, _): &(usize, &f64)| (at as i64 - reach).abs() >= observed.abs();
    sums.iter().enumerate().filter(far).map(|(_, p)| p).sum::<f64>().min(1.0)
}

/// Every sum of n answers drawn from a participant's, with its chance.
fn draws(split: &Split) -> Vec<(i64, f64)> {
    let [plus, zero, minus] = split.all;
    let n = split.own.iter().sum::<u64>();
    let all = choose(plus + zero + minus, n);
    let mut chances = vec![0.0; 2 * n as usize + 1];
    for a in 0..=n.min(plus) {
        for b in 0..=(n - a).min(minus) {
            let ways = choose(plus, a) * choose(minus, b) * choose(zero, n - a - b);
            chances[(n + a - b) as usize] += ways / all;
        }
    }
    chances.into_iter().enumerate().filter(|&(_, p)| p > 0.0).map(|(i, p)| (i as i64 - n as i64, p)).collect()
}

/// n over k, 0 where k exceeds n.
fn choose(n: u64, k: u64) -> f64 {
    if k > n { 0.0 } else { (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(own: [u64; 3], all: [u64; 3]) -> Split {
        Split { own, all }
    }

    #[test]
    fn by_counting() {
        // One answer of three, + on the others: 1 of 3 draws is as far, and no other distance is reached (3 s - 2 is -2, 1, 1;
        // with own - : all [2, 0, 1], S = 1, distances 3 s - 1: -4 once, 2 twice).
        let odd = split([0, 0, 1], [2, 0, 1]);
        assert!((exchange(&[odd]) - 1.0 / 3.0).abs() < 1e-15);
        // Two such people: -8 in 1 of 9; 4 and -2 are nearer.
        assert!((exchange(&[odd; 2]) - 1.0 / 9.0).abs() < 1e-15);
        // Six of them: sums -4 k + 2 (6 - k) of k draws; as far as -24 is only k = 6.
        assert!((exchange(&[odd; 6]) - 3.0_f64.powi(-6)).abs() < 1e-15);
        assert_eq!(exchange(&[]), 1.0);
        assert_eq!(exchange(&[split([1, 0, 0], [3, 0, 0])]), 1.0);
    }

    #[test]
    fn fishers_test_is_the_case_of_one_participant() {
        // scipy.stats.fisher_exact([[8, 2], [1, 5]]).pvalue = 0.0349650...; own is the row of ten.
        let p = exchange(&[split([8, 0, 2], [9, 0, 7])]);
        assert!((p - 0.034_965_034_965_034_97).abs() < 1e-12, "{p}");
    }

    #[test]
    fn large_numbers_are_normal() {
        let against = |i: usize| i % 30 < 9;
        let own = |i: usize| if against(i) { [0, 0, 1] } else { [1, 0, 0] };
        let people: Vec<Split> = (0..5000).map(|i| split(own(i), [2, 0, 1])).collect();
        // Distances are -4 with chance 1/3, else 2: variance 8 each.
        let p = |observed: f64, people: usize| {
            2.0 * Normal::standard().sf(observed / (8.0 * people as f64).sqrt())
        };
        let observed = 2.0 * 3497.0 - 4.0 * 1503.0;
        assert_eq!((0..5000).filter(|&i| against(i)).count(), 1503);
        assert!((exchange(&people) / p(observed, 5000) - 1.0).abs() < 1e-12);
        // Few enough to be exact, many enough to be nearly normal: sums are six apart.
        let observed = 2.0 * 274.0 - 4.0 * 126.0;
        assert_eq!((0..400).filter(|&i| against(i)).count(), 126);
        let exact = exchange(&people[..400]);
        // As far on the other side begins at -46.
        let normal = 0.5 * (p(observed - 3.0, 400) + p(46.0 - 3.0, 400));
        assert!((exact - normal).abs() < 0.001, "{exact}");
    }
}
