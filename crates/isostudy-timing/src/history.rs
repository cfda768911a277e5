//! Runs that were kept, one after the other: how totals moved from the first on.

use super::differences::commit;
use super::series::{by_configuration, middle, values};
use isostudy_design::record::BenchRun;
use isostudy_design::{ConfigurationId, Stage};
use isostudy_table::{Cell, Columns, Table};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What is kept of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Kept {
    /// Under which name.
    pub name: String,
    /// The program's commit, with a word on changes; `None` if it is not known.
    pub commit: Option<String>,
    /// The CPU's model.
    pub model: Option<String>,
    /// Measured rounds.
    pub rounds: u32,
    /// What was asked of the extractor, by configuration.
    pub workloads: BTreeMap<ConfigurationId, String>,
    /// Median totals, in seconds.
    pub totals_s: BTreeMap<ConfigurationId, f64>,
    /// Median of the reference work, in seconds.
    pub reference_s: Option<f64>,
}

impl Kept {
    /// Of a run.
    pub fn of(name: &str, run: &BenchRun) -> Self {
        let reference: Vec<f64> = run.samples.iter().filter_map(|sample| sample.reference_s).collect();
        let totals = by_configuration(run).into_iter();
        Self {
            name: name.into(),
            commit: commit(&run.machine.build),
            model: run.machine.model.clone(),
            rounds: run.iterations,
            workloads: run.workloads.iter().map(|of| (of.id.clone(), of.digest.clone())).collect(),
            totals_s: totals
                .map(|(id, samples)| (id.clone(), middle(&values(&samples, Stage::Total))))
                .collect(),
            reference_s: (!reference.is_empty()).then(|| middle(&reference)),
        }
    }
}

/// A run beside the first that asked for the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// What was kept.
    pub kept: Kept,
    /// Each total over that of the first run in which the configuration asked for the same extraction.
    pub ratios: BTreeMap<ConfigurationId, f64>,
    /// Their geometric mean; `None` of a run without one.
    pub mean: Option<f64>,
    /// The reference work's time over that of the first run that has it.
    pub reference: Option<f64>,
}

/// The steps in the order in which runs were kept.
pub fn history(kept: &[Kept]) -> Vec<Step> {
    let first = |id: &ConfigurationId, of: &Kept| {
        let same = |run: &&Kept| run.workloads.get(id) == of.workloads.get(id);
        kept.iter().filter(same).find_map(|run| run.totals_s.get(id).copied())
    };
    let reference = kept.iter().find_map(|run| run.reference_s);
    let step = |run: &Kept| {
        let ratio = |(id, total): (&ConfigurationId, &f64)| {
            let ratio = total / first(id, run)?;
            ratio.is_finite().then(|| (id.clone(), ratio))
        };
        let ratios: BTreeMap<ConfigurationId, f64> = run.totals_s.iter().filter_map(ratio).collect();
        let logs = ratios.values().map(|ratio| ratio.ln()).sum::<f64>();
        Step {
            mean: (!ratios.is_empty()).then(|| (logs / ratios.len() as f64).exp()),
            ratios,
            reference: run.reference_s.zip(reference).map(|(now, then)| now / then),
            kept: run.clone(),
        }
    };
    kept.iter().map(step).collect()
}

/// A line for each step.
pub fn history_table(steps: &[Step]) -> Table {
    let numbered: Vec<(u64, &Step)> = (1..).zip(steps).collect();
    let by_ratio = |a: &(&ConfigurationId, &f64), b: &(&ConfigurationId, &f64)| a.1.total_cmp(b.1);
    let most = |step: &Step| step.ratios.iter().max_by(by_ratio).map(|(id, ratio)| (id.to_string(), *ratio));
    let table = Columns::over(&numbered)
        .column("number", "Number", |(number, _)| Cell::count(*number))
        .column("name", "Name", |(_, step)| Cell::text(&step.kept.name))
        .column("commit", "Commit", |(_, step)| Cell::text(step.kept.commit.as_deref().unwrap_or("unknown")))
        .column("rounds", "Rounds", |(_, step)| Cell::count(u64::from(step.kept.rounds)))
        .column("mean", "Totals, over the first", |(_, step)| Cell::number(step.mean, 3))
        .column("least", "from", |(_, step)| Cell::number(step.ratios.values().copied().reduce(f64::min), 3))
        .column("most", "to", |(_, step)| Cell::number(most(step).map(|(_, ratio)| ratio), 3))
        .column("slowest", "on", |(_, step)| Cell::text(most(step).map(|(id, _)| id).unwrap_or_default()))
        .column("reference", "Reference work, over the first", |(_, step)| Cell::number(step.reference, 3))
        .into_table("history", "Runs that were kept");
    table.with_note(
        "Median totals over those of the first run that asked for the same extraction: geometric mean of the configurations, \
         the least and the most. These are no verdicts; `isostudy bench compare` gives those.",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(name: &str, digest: &str, totals: [f64; 2]) -> Kept {
        let ids = ["ss_bi", "ss_su"].map(|id| id.parse::<ConfigurationId>().unwrap());
        Kept {
            name: name.into(),
            commit: None,
            model: None,
            rounds: 10,
            workloads: ids.iter().map(|id| (id.clone(), digest.to_owned())).collect(),
            totals_s: ids.into_iter().zip(totals).collect(),
            reference_s: Some(0.001),
        }
    }

    #[test]
    fn totals_are_held_against_the_first_of_the_same_work() {
        let runs = [
            kept("one", "x", [1.0, 4.0]),
            kept("two", "x", [2.0, 2.0]),
            kept("three", "other", [3.0, 3.0]),
            kept("four", "other", [6.0, 6.0]),
        ];
        let steps = history(&runs);
        let means: Vec<f64> = steps.iter().map(|step| step.mean.unwrap()).collect();
        // Twice and half: their geometric mean is 1.
        for (found, want) in means.iter().zip([1.0, 1.0, 1.0, 2.0]) {
            assert!((found - want).abs() < 1e-12, "{means:?}");
        }
        let text = history_table(&steps).to_csv();
        assert_eq!(text.lines().nth(2), Some("2,two,unknown,10,1,0.5,2,ss_bi,1"), "{text}");
    }
}
