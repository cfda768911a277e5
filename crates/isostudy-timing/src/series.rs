//! The samples of one stage of one configuration, and the words for what follows from them.

use isostudy_design::record::{BenchRun, BenchSample};
use isostudy_design::{ConfigurationId, Stage};
use serde::Serialize;
use std::collections::BTreeMap;

/// Why there is no floor.
pub(super) const NO_AA_BLOCK: &str = "no A/A block: the noise floor is not known";

/// What can be said of two times.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The second takes less time than the first.
    Faster,
    /// The second takes more.
    Slower,
    /// Neither can be said.
    CannotSay,
}

impl Verdict {
    /// The word for it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Faster => "faster",
            Self::Slower => "slower",
            Self::CannotSay => "cannot say",
        }
    }
}

/// A verdict, and why nothing can be said where nothing can.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Judgement {
    /// What can be said.
    pub verdict: Verdict,
    /// Why nothing more; empty for the other verdicts.
    pub reason: &'static str,
}

impl Judgement {
    pub(super) fn cannot_say(reason: &'static str) -> Self {
        Self { verdict: Verdict::CannotSay, reason }
    }

    /// The verdict of a log-ratio whose interval is `low` to `high`, against a floor, if each of `parts` has its sign.
    pub(super) fn of(low: f64, high: f64, floor: Option<f64>, parts: Option<&[f64]>) -> Self {
        let Some(floor) = floor else {
            return Self::cannot_say(NO_AA_BLOCK);
        };
        let verdict = match () {
            () if low > floor => Verdict::Slower,
            () if high < -floor => Verdict::Faster,
            () => return Self::cannot_say("within the noise"),
        };
        let sign = if verdict == Verdict::Slower { 1.0 } else { -1.0 };
        match parts {
            None => Self::cannot_say("too few rounds to see it repeated"),
            Some(parts) if parts.iter().all(|part| part * sign > 0.0) => Self { verdict, reason: "" },
            Some(_) => Self::cannot_say("parts of the run disagree"),
        }
    }
}

/// The samples of each configuration, in the order measured.
pub(super) type Series<'a> = Vec<(&'a ConfigurationId, Vec<&'a BenchSample>)>;

/// Samples by configuration, in the study's order, which is that of the memory measured; where none was, in that of ids.
pub(super) fn by_configuration(run: &BenchRun) -> Series<'_> {
    let mut own: BTreeMap<&ConfigurationId, Vec<&BenchSample>> = BTreeMap::new();
    run.samples.iter().for_each(|sample| own.entry(&sample.id).or_default().push(sample));
    let with_memory = run.memory.iter().map(|memory| &memory.id);
    let mut series: Series<'_> = with_memory.filter_map(|id| Some((id, own.remove(id)?))).collect();
    series.extend(own);
    series
}

/// The samples of one configuration; `None` if it has none.
pub(super) fn of<'s, 'a>(series: &'s Series<'a>, id: &ConfigurationId) -> Option<&'s Vec<&'a BenchSample>> {
    series.iter().find(|(other, _)| *other == id).map(|(_, samples)| samples)
}

/// One stage.
pub(super) fn values(samples: &[&BenchSample], stage: Stage) -> Vec<f64> {
    samples.iter().map(|sample| stage.of(sample)).collect()
}

/// Consecutive thirds; `None` of fewer than three values.
pub(super) fn thirds(values: &[f64]) -> Option<[&[f64]; 3]> {
    let at = |part: usize| part * values.len() / 3;
    (values.len() >= 3).then(|| [0, 1, 2].map(|part| &values[at(part)..at(part + 1)]))
}

/// The median alone; not a number of no values.
pub(super) fn middle(values: &[f64]) -> f64 {
    isostudy_statistics::median(values.to_vec(), 0.0).map_or(f64::NAN, |median| median.median)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_verdict_needs_a_floor_an_interval_beyond_it_and_agreement() {
        let parts = [0.2, 0.1, 0.3];
        let downwards = parts.map(|part: f64| -part);
        let of = |low, high, floor, parts| Judgement::of(low, high, floor, parts).verdict;
        assert_eq!(of(0.1, 0.3, Some(0.05), Some(&parts[..])), Verdict::Slower);
        assert_eq!(of(-0.3, -0.1, Some(0.05), Some(&downwards[..])), Verdict::Faster);
        assert_eq!(of(0.1, 0.3, Some(0.1), Some(&parts[..])), Verdict::CannotSay, "touches the floor");
        assert_eq!(of(-0.1, 0.3, Some(0.0), Some(&parts[..])), Verdict::CannotSay);
        assert_eq!(of(0.1, 0.3, None, Some(&parts[..])), Verdict::CannotSay);
        assert_eq!(of(0.1, 0.3, Some(0.05), Some(&[0.2, -0.01, 0.3][..])), Verdict::CannotSay);
        assert_eq!(of(0.1, 0.3, Some(0.05), None), Verdict::CannotSay);
        assert_eq!(of(f64::NAN, f64::NAN, Some(0.05), Some(&parts[..])), Verdict::CannotSay);
    }

    #[test]
    fn thirds_leave_nothing_out() {
        let values: Vec<f64> = (0..10).map(f64::from).collect();
        let parts = thirds(&values).unwrap();
        assert_eq!(parts.concat(), values);
        assert_eq!(parts.map(<[f64]>::len), [3, 3, 4]);
        assert_eq!(thirds(&values[..2]), None);
    }
}
