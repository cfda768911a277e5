//! Samples far from the rest: named, kept, and their effect on the median shown.

use super::series::{middle, values};
use isostudy_design::record::BenchSample;
use isostudy_design::{ConfigurationId, Stage};
use serde::Serialize;

/// A total further from the median than this many scaled median absolute deviations is an outlier (Leys et al. 2013, whose
/// strictest limit is 3; times have a long upper tail of their own).
pub const MAD_LIMIT: f64 = 5.0;

/// Makes the median absolute deviation of normal values their standard deviation: 1 / Phi^-1(3/4).
const MAD_SCALE: f64 = 1.482_602_218_505_602;

/// A sample far from the rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outlier {
    /// What was extracted.
    pub id: ConfigurationId,
    /// In which round.
    pub iteration: u32,
    /// Its total in seconds.
    pub total_s: f64,
    /// How many scaled median absolute deviations from the median.
    pub deviations: f64,
}

/// The outliers among a configuration's totals, and the median in seconds without them. Where more than half of the totals
/// are the same there is no scale, and nothing is an outlier.
pub(super) fn outliers(samples: &[&BenchSample]) -> (Vec<Outlier>, f64) {
    let totals = values(samples, Stage::Total);
    let median = middle(&totals);
    let scale = MAD_SCALE * middle(&totals.iter().map(|total| (total - median).abs()).collect::<Vec<_>>());
    let deviations = |total: f64| (total - median) / scale;
    let far = |total: f64| scale > 0.0 && deviations(total).abs() > MAD_LIMIT;
    let outlier = |sample: &&BenchSample| Outlier {
        id: sample.id.clone(),
        iteration: sample.iteration,
        total_s: sample.total_s,
        deviations: deviations(sample.total_s),
    };
    let found = samples.iter().filter(|sample| far(sample.total_s)).map(outlier).collect();
    let rest: Vec<f64> = totals.iter().copied().filter(|total| !far(*total)).collect();
    (found, middle(&rest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    #[test]
    fn outliers_are_named_and_stay() {
        let study = fixture::study();
        let run = fixture::bench(&study);
        let id = study.configurations[0].id.clone();
        let mut samples: Vec<BenchSample> =
            run.samples.into_iter().filter(|sample| sample.id == id).collect();
        let totals = [1.0, 1.1, 0.9, 1.2, 9.0];
        samples.iter_mut().zip(totals).for_each(|(sample, total)| sample.total_s = total);
        let (found, without) = outliers(&samples.iter().collect::<Vec<_>>());
        // The median is 1.1, deviations .1, 0, .2, .1, 7.9, their median .1: (9 - 1.1) / .14826.
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].iteration, found[0].total_s), (4, 9.0));
        assert!((found[0].deviations - 53.284_69).abs() < 1e-4, "{found:?}");
        assert_eq!(without, 1.05);
        samples.iter_mut().for_each(|sample| sample.total_s = 1.0);
        samples[0].total_s = 2.0;
        assert_eq!(outliers(&samples.iter().collect::<Vec<_>>()).0, [], "no scale");
    }
}
