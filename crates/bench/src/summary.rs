//! What the terminal shows of a run. Tables and figures for the report are made from the samples, in `analysis`.

use crate::stages::Stage;
use design::ConfigurationId;
use design::record::BenchRun;
use std::collections::{BTreeMap, BTreeSet};

/// The samples of one stage of one configuration, in seconds.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Which configuration.
    pub id: ConfigurationId,
    /// Which stage.
    pub stage: Stage,
    /// How many samples.
    pub samples: usize,
    /// Arithmetic mean; the one figure the paper gives.
    pub mean_s: f64,
    /// Standard deviation with divisor n - 1; `None` for a single sample.
    pub sd_s: Option<f64>,
    /// Smallest.
    pub min_s: f64,
    /// Lower quartile. Quantiles are interpolated linearly between order statistics (Hyndman & Fan 1996, type 7).
    pub q25_s: f64,
    /// Median.
    pub median_s: f64,
    /// Upper quartile.
    pub q75_s: f64,
    /// Largest.
    pub max_s: f64,
}

/// A summary of every stage, total last, of every configuration that has samples, configurations in the order of their
/// ids. Medians of stages need not add up to the median of the total; means do, up to rounding.
pub fn summarise(run: &BenchRun) -> Vec<Summary> {
    let mut samples: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for sample in &run.samples {
        samples.entry(&sample.id).or_default().push(sample);
    }
    let of_stage = |(id, stage)| {
        let values = samples[id].iter().map(|sample| Stage::of(stage, sample)).collect();
        summary(id, stage, values)
    };
    samples.keys().flat_map(|id| Stage::ALL.map(|stage| (*id, stage))).map(of_stage).collect()
}

/// One line that says which plan a table is from and whether the machine is the one that was meant.
pub fn caption(run: &BenchRun) -> String {
    let configurations = run.samples.iter().map(|sample| &sample.id).collect::<BTreeSet<_>>().len();
    let model = run.machine.model.as_deref().unwrap_or("an unknown CPU");
    let differing: Vec<&str> = run.differences.iter().map(|row| row.property.as_str()).collect();
    let verdict = if differing.is_empty() {
        "which matches".to_owned()
    } else {
        format!("which differs ({}) from", differing.join(", "))
    };
    format!(
        "{}: {configurations} configurations, {} iterations after {} of warm-up, sampling threads: {}, on {model}, \
         {verdict} the target {}",
        run.study, run.iterations, run.warmup, run.threads, run.target.name
    )
}

/// `values` are not empty.
fn summary(id: &ConfigurationId, stage: Stage, mut values: Vec<f64>) -> Summary {
    values.sort_by(f64::total_cmp);
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    Summary {
        id: id.clone(),
        stage,
        samples: values.len(),
        mean_s: mean,
        sd_s: (values.len() > 1).then(|| (squares / (count - 1.0)).sqrt()),
        min_s: values[0],
        q25_s: quantile(&values, 0.25),
        median_s: quantile(&values, 0.5),
        q75_s: quantile(&values, 0.75),
        max_s: values[values.len() - 1],
    }
}

fn quantile(sorted: &[f64], share: f64) -> f64 {
    let position = share * (sorted.len() - 1) as f64;
    let (low, high) = (sorted[position.floor() as usize], sorted[position.ceil() as usize]);
    low + (high - low) * position.fract()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::tests::{ids, mock_run};

    fn of(values: &[f64]) -> Summary {
        summary(&ids()[0], Stage::Total, values.to_vec())
    }

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    /// Python 3: `statistics.mean`, `stdev` and `quantiles(x, n=4, method="inclusive")`.
    #[test]
    fn statistics_are_those_of_python() {
        let s = of(&[0.4, 0.1, 0.3, 0.9]);
        assert!(near(s.mean_s, 0.425) && near(s.sd_s.unwrap(), 0.340_342_964_277_702_3), "{s:?}");
        assert!(near(s.q25_s, 0.25) && near(s.median_s, 0.35) && near(s.q75_s, 0.525), "{s:?}");
        assert_eq!((s.samples, s.min_s, s.max_s), (4, 0.1, 0.9));
        let s = of(&[5.0, 1.0, 4.0, 2.0, 3.0]);
        assert_eq!((s.q25_s, s.median_s, s.q75_s), (2.0, 3.0, 4.0));
    }

    #[test]
    fn a_single_sample_has_no_spread() {
        let s = of(&[0.25]);
        assert_eq!(
            (s.sd_s, s.mean_s, s.min_s, s.q25_s, s.median_s, s.q75_s, s.max_s),
            (None, 0.25, 0.25, 0.25, 0.25, 0.25, 0.25)
        );
    }

    #[test]
    fn every_stage_of_every_configuration_is_summarised() {
        let summaries = summarise(&mock_run());
        assert_eq!(summaries.len(), 4 * 6);
        let mut sorted = ids();
        sorted.sort();
        for (group, id) in summaries.chunks(6).zip(&sorted) {
            assert!(group.iter().all(|s| s.id == *id && s.samples == 5));
            assert_eq!(group.iter().map(|s| s.stage).collect::<Vec<_>>(), Stage::ALL);
            let stages: f64 = group[..5].iter().map(|s| s.mean_s).sum();
            assert!(near(stages, group[5].mean_s), "means add up");
        }
        // The mock samples subject 2, `as_sp`, for 0.03 s; ids sort it first.
        assert_eq!((summaries[1].stage, summaries[1].median_s), (Stage::Sampling, 0.03));
    }

    #[test]
    fn the_caption_says_which_plan_and_which_machine() {
        let mut run = mock_run();
        let text = caption(&run);
        assert!(text.starts_with("mock: 4 configurations, 5 iterations after 2 of warm-up, "), "{text}");
        assert!(text.ends_with("i7-11700 @ 2.50GHz, which matches the target any"), "{text}");
        run.target.cores = Some(2);
        run.differences = crate::differences(&run.target, &run.machine);
        run.machine.model = None;
        let text = caption(&run);
        assert!(text.ends_with("on an unknown CPU, which differs (cores) from the target any"), "{text}");
    }
}
