//! Draws with replacement, counted by kind.

use rand::{Rng, RngExt};
use statrs::function::factorial::ln_binomial;

/// Expected successes up to which a binomial draw counts up from none.
const FROM_NONE: f64 = 20.0;

/// As many draws as `counts` add up to, each of kind k with chance counts[k] / sum: how many came out of each kind.
///
/// Kind by kind, each binomial given what is left (Davis 1993, Comput. Stat. Data Anal. 16:205).
pub(super) fn multinomial(stream: &mut impl Rng, counts: &[u64]) -> Vec<u64> {
    let (mut draws, mut rest): (u64, u64) = (counts.iter().sum(), counts.iter().sum());
    let of_kind = |&count: &u64| {
        let drawn = if count == rest { draws } else { binomial(stream, draws, count as f64 / rest as f64) };
        draws -= drawn;
        rest -= count;
        drawn
    };
    counts.iter().map(of_kind).collect()
}

/// Successes in `n` trials of chance `p` below 1, by inversion of one uniform number: up from none where few are expected,
/// else outwards from the mode.
fn binomial(stream: &mut impl Rng, n: u64, p: f64) -> u64 {
    if n == 0 || p == 0.0 {
        return 0;
    }
    if p > 0.5 {
        return n - binomial(stream, n, 1.0 - p);
    }
    let mut left: f64 = stream.random();
    let odds = p / (1.0 - p);
    let up = |k: u64| (n - k) as f64 / (k + 1) as f64 * odds;
    if n as f64 * p <= FROM_NONE {
        let mut k = 0;
        let mut chance = (n as f64 * (-p).ln_1p()).exp();
        while left > chance && k < n {
            left -= chance;
            chance *= up(k);
            k += 1;
        }
        return k;
    }
    let mode = ((n + 1) as f64 * p) as u64;
    let at_mode = (ln_binomial(n, mode) + mode as f64 * p.ln() + (n - mode) as f64 * (-p).ln_1p()).exp();
    if left <= at_mode {
        return mode;
    }
    left -= at_mode;
    let (mut high, mut of_high, mut low, mut of_low) = (mode, at_mode, mode, at_mode);
    loop {
        if high < n {
            of_high *= up(high);
            high += 1;
            if left <= of_high {
                return high;
            }
            left -= of_high;
        }
        if low > 0 {
            low -= 1;
            of_low /= up(low);
            if left <= of_low {
                return low;
            }
            left -= of_low;
        }
        // What rounding left over belongs nowhere in particular.
        if (low == 0 || of_low == 0.0) && (high == n || of_high == 0.0) {
            return mode;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;
    use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF};

    /// Chi-square of 20,000 draws in `cells` classes of about equal chance; p of it.
    fn fits(n: u64, p: f64) -> f64 {
        let mut stream = Pcg64::seed_from_u64(n ^ 77);
        let of = Binomial::new(p, n).unwrap();
        let edges: Vec<u64> = (1..12).map(|i| of.inverse_cdf(f64::from(i) / 12.0)).collect();
        let mut seen = [0.0; 12];
        let draws = 20_000;
        (0..draws).for_each(|_| {
            let k = binomial(&mut stream, n, p);
            seen[edges.partition_point(|&edge| edge < k)] += 1.0;
        });
        let below = |i: usize| match i {
            0 => 0.0,
            12 => 1.0,
            i => of.cdf(edges[i - 1]),
        };
        let (mut statistic, mut cells) = (0.0, 0.0);
        for (i, seen) in seen.iter().enumerate() {
            let want = f64::from(draws) * (below(i + 1) - below(i));
            if want > 0.0 {
                statistic += (seen - want) * (seen - want) / want;
                cells += 1.0;
            }
        }
        ChiSquared::new(cells - 1.0).unwrap().sf(statistic)
    }

    #[test]
    fn binomial_draws_are_binomial() {
        for (n, p) in [(18, 0.3), (18, 0.97), (400, 0.02), (1000, 0.4), (100_000, 0.5), (100_000, 0.0003)] {
            assert!(fits(n, p) > 0.001, "{n} {p}");
        }
    }

    #[test]
    fn multinomial_draws_add_up_and_covary() {
        let counts = [5, 0, 3, 10];
        let mut stream = Pcg64::seed_from_u64(5);
        let (mut means, mut product) = ([0.0; 4], 0.0);
        let resamples = 50_000;
        for _ in 0..resamples {
            let drawn = multinomial(&mut stream, &counts);
            assert_eq!(drawn.iter().sum::<u64>(), 18);
            (0..4).for_each(|k| means[k] += drawn[k] as f64 / f64::from(resamples));
            product += drawn[0] as f64 * drawn[3] as f64 / f64::from(resamples);
        }
        (0..4).for_each(|k| assert!((means[k] - counts[k] as f64).abs() < 0.05, "{means:?}"));
        // Covariance -n p q = -18 (5/18) (10/18).
        assert!((product - 50.0 + 50.0 / 18.0).abs() < 0.3, "{product}");
    }
}
