//! One measure over many triangles: moments, quantiles and a histogram.

/// A summary of finitely many finite numbers.
///
/// No field is ever NaN or infinite. An empty distribution has `count` 0 and zeros everywhere else, so test
/// `count` before reading the rest.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Distribution {
    /// How many values there are.
    pub count: u64,
    /// Arithmetic mean.
    pub mean: f64,
    /// Population standard deviation (divisor `count`).
    pub sd: f64,
    /// Smallest value.
    pub min: f64,
    /// 5 % quantile; all quantiles interpolate linearly (Hyndman & Fan 1996, type 7, as R and NumPy do).
    pub q05: f64,
    /// Lower quartile.
    pub q25: f64,
    /// Median.
    pub median: f64,
    /// Upper quartile.
    pub q75: f64,
    /// 95 % quantile.
    pub q95: f64,
    /// Largest value.
    pub max: f64,
    /// Counts in equal bins.
    pub histogram: Histogram,
}

/// Counts in equal bins over `low..=high`; a value on an inner bin border counts upwards, `high` counts in the
/// last bin.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Histogram {
    /// Lower border of the first bin.
    pub low: f64,
    /// Upper border of the last bin.
    pub high: f64,
    /// Values a bin.
    pub counts: Vec<u64>,
    /// Values under `low`.
    pub below: u64,
    /// Values over `high`.
    pub above: u64,
}

/// The range and fineness of a histogram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bins {
    /// Lower border of the first bin.
    pub low: f64,
    /// Upper border of the last bin.
    pub high: f64,
    /// Number of bins.
    pub count: usize,
}

impl Distribution {
    /// Summarises `values`, which are sorted first: the order they come in changes nothing, not even the last bit.
    ///
    /// # Panics
    /// If a value is NaN or infinite.
    pub fn of(mut values: Vec<f64>, bins: Bins) -> Self {
        assert!(values.iter().all(|v| v.is_finite()), "a distribution holds finite numbers only");
        let histogram = Histogram::of(&values, bins);
        values.sort_unstable_by(f64::total_cmp);
        let (Some(&min), Some(&max)) = (values.first(), values.last()) else {
            return Self { histogram, ..Self::default() };
        };
        let n = values.len() as f64;
        // Centred on the median, so that many equal values give an exact mean and a spread of exactly zero.
        let centre = quantile(&values, 0.5);
        let shift = values.iter().map(|v| v - centre).sum::<f64>() / n;
        let mean = (centre + shift).clamp(min, max);
        let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / n;
        Self {
            count: values.len() as u64,
            mean,
            sd: variance.sqrt(),
            min,
            q05: quantile(&values, 0.05),
            q25: quantile(&values, 0.25),
            median: centre,
            q75: quantile(&values, 0.75),
            q95: quantile(&values, 0.95),
            max,
            histogram,
        }
    }
}

impl Distribution {
    /// Root of the mean square.
    pub fn rms(&self) -> f64 {
        self.mean.hypot(self.sd)
    }
}

impl Histogram {
    fn of(values: &[f64], bins: Bins) -> Self {
        let Bins { low, high, count } = bins;
        let mut histogram = Self { low, high, counts: vec![0; count], below: 0, above: 0 };
        for &v in values {
            if v < low {
                histogram.below += 1;
            } else if v > high || count == 0 {
                histogram.above += 1;
            } else {
                // An empty range (low = high) puts everything into the first bin: 0/0 casts to 0.
                let bin = ((v - low) / (high - low) * count as f64) as usize;
                histogram.counts[bin.min(count - 1)] += 1;
            }
        }
        histogram
    }
}

/// Linear interpolation between the order statistics around `p * (n - 1)`.
fn quantile(sorted: &[f64], p: f64) -> f64 {
    let position = p * (sorted.len() - 1) as f64;
    let below = position as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (sorted[above] - sorted[below]) * (position - below as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const UNIT: Bins = Bins { low: 0.0, high: 1.0, count: 4 };

    #[test]
    fn ten_squares_by_hand() {
        // Sums of i^2 = 385 and i^4 = 25,333 for i = 1..=10; quantile p interpolates at rank 9 p.
        let d = Distribution::of((1..=10).rev().map(|i| f64::from(i * i) / 100.0).collect(), UNIT);
        let got = [d.mean, d.sd, d.min, d.q05, d.q25, d.median, d.q75, d.q95, d.max];
        let want = [0.385, 0.105_105f64.sqrt(), 0.01, 0.0235, 0.1075, 0.305, 0.6025, 0.9145, 1.0];
        for (g, w) in got.iter().zip(want) {
            assert!((g - w).abs() < 1e-11, "{got:?}");
        }
        assert_eq!(d.histogram.counts, [4, 3, 1, 2]); // .25 and 1 are borders
        assert!((d.rms() - 0.253_33f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn empty_is_zeros() {
        let d = Distribution::of(vec![], UNIT);
        assert_eq!((d.count, d.mean, d.sd, d.max), (0, 0.0, 0.0, 0.0));
        assert_eq!(d.histogram.counts, [0; 4]);
    }

    #[test]
    fn values_outside_the_bins_are_counted_apart() {
        let d = Distribution::of(vec![-0.1, 0.0, 1.0, 1.1, 7.0], UNIT);
        assert_eq!((d.histogram.below, d.histogram.above), (1, 2));
        assert_eq!(d.histogram.counts, [1, 0, 0, 1]);
        let flat = Distribution::of(vec![0.0; 3], Bins { low: 0.0, high: 0.0, count: 2 });
        assert_eq!(flat.histogram.counts, [3, 0]);
    }

    proptest! {
        #[test]
        fn ordered_complete_and_independent_of_order(values in prop::collection::vec(-1e6..1e6f64, 1..60)) {
            let d = Distribution::of(values.clone(), UNIT);
            let ladder = [d.min, d.q05, d.q25, d.median, d.q75, d.q95, d.max];
            prop_assert!(ladder.is_sorted());
            prop_assert!(d.min <= d.mean && d.mean <= d.max && d.sd <= d.max - d.min);
            let h = &d.histogram;
            prop_assert_eq!(h.counts.iter().sum::<u64>() + h.below + h.above, values.len() as u64);
            let reversed = values.into_iter().rev().collect();
            prop_assert_eq!(&Distribution::of(reversed, UNIT), &d);
        }
    }
}
