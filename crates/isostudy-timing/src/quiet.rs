//! Whether the machine was left alone.

use std::fmt;

use isostudy_design::record::{BenchRun, Failure, LoadWindow, Resumption};

/// A share of the CPU time above which others are said to have been at work.
pub const BUSY: f64 = 0.05;

/// The share of the CPU time, for other processes and other machines, that three windows of four stayed below. A median
/// is moved little by what happens in less than a quarter of the rounds, and outliers show that. 0 if nothing is known.
pub(super) fn busy_share(load: &[LoadWindow]) -> f64 {
    let mut shares: Vec<f64> = shares(load).collect();
    shares.sort_unstable_by(f64::total_cmp);
    let rank = (3 * shares.len()).div_ceil(4).saturating_sub(1);
    shares.get(rank).copied().unwrap_or(0.0)
}

/// A share of the CPU time, and of the stretches of a run, above which it was not measured alone: threads are then woken late,
/// which no share of the time accounts for.
const BESIDE: [f64; 2] = [0.25, 0.5];

/// Others were at work for much of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
struct OtherWork {
    /// In so many stretches of the run others had more than a quarter of the CPU time.
    busy: usize,
    stretches: usize,
    /// The most that they had in one.
    most: f64,
}

impl OtherWork {
    fn of(run: &BenchRun) -> Option<Self> {
        let during: Vec<f64> = shares(&run.load).collect();
        let busy = during.iter().filter(|share| **share > BESIDE[0]).count();
        let invalid = busy > 0 && busy as f64 >= BESIDE[1] * during.len() as f64;
        let most = during.iter().copied().fold(0.0, f64::max);
        invalid.then_some(Self { busy, stretches: during.len(), most })
    }
}

impl fmt::Display for OtherWork {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (busy, stretches, limit, most) =
            (self.busy, self.stretches, 100.0 * BESIDE[0], 100.0 * self.most);
        write!(
            f,
            "measured beside other work: in {busy} of {stretches} stretches others had more than {limit:.0} % of the CPU time, {most:.1} % at most"
        )
    }
}

/// Why a run is no evidence of anything: others had more than a quarter of the CPU time in at least half of its stretches. `None`
/// of a run that was left alone, or of which it is not known.
pub fn beside_other_work(run: &BenchRun) -> Option<String> {
    OtherWork::of(run).map(|work| work.to_string())
}

/// What others had of the CPU time while the run measured.
fn shares(load: &[LoadWindow]) -> impl Iterator<Item = f64> {
    load.iter().filter(|window| window.invocation.is_some()).map(|window| window.others + window.steal)
}

/// What a reader of the numbers should know of the machine; its words are for a reader.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Warning<'a> {
    Failed(&'a Failure),
    /// The system does not tell what others do.
    Unknown,
    /// The share that others had of the CPU time before the run.
    Before(f64),
    /// In so many stretches of the run they had more than [`BUSY`], and at most so much.
    During {
        who: &'static str,
        busy: usize,
        stretches: usize,
        most: f64,
    },
    /// By how much of a time other runs may differ for that reason alone.
    Hidden(f64),
    Resumed(&'a Resumption),
}

impl fmt::Display for Warning<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Failed(Failure { id, reason, .. }) => {
                let reason = reason.trim_end_matches('.');
                write!(f, "{id} has no times, because its program failed: {reason}.")
            }
            Self::Unknown => f.write_str(
                "This system does not tell what others do: nobody knows whether the machine was quiet.",
            ),
            Self::Before(share) => write!(
                f,
                "Before the run others had {:.1} % of the CPU time. Close other programs and run again.",
                100.0 * share
            ),
            Self::During { who, busy, stretches, most } => write!(
                f,
                "In {busy} of {stretches} stretches of the run {who} had more than {:.1} % of the CPU time, {:.1} % at most.",
                100.0 * BUSY,
                100.0 * most
            ),
            Self::Hidden(part) => write!(
                f,
                "Differences below {:.0} % from other runs may be due to that: a comparison does not report them.",
                100.0 * part
            ),
            Self::Resumed(Resumption { invocation, iteration, place }) => write!(
                f,
                "The run was broken off and taken up again in round {iteration}, place {place}, of process {invocation}, after warm-up."
            ),
        }
    }
}

/// What a reader of the numbers should know of the machine, in plain words; empty if it was quiet.
pub fn warnings(run: &BenchRun) -> Vec<String> {
    judged(run).iter().map(Warning::to_string).collect()
}

fn judged(run: &BenchRun) -> Vec<Warning<'_>> {
    let mut warnings: Vec<Warning> = run.failed.iter().map(Warning::Failed).collect();
    if run.imported_from.is_some() {
        return warnings;
    }
    let (during, before): (Vec<&LoadWindow>, Vec<&LoadWindow>) =
        run.load.iter().partition(|window| window.invocation.is_some());
    if run.load.is_empty() {
        warnings.push(Warning::Unknown);
    }
    if let Some(window) = before.iter().find(|window| window.others + window.steal > BUSY) {
        warnings.push(Warning::Before(window.others + window.steal));
    }
    let others: Vec<f64> = during.iter().map(|window| window.others).collect();
    let steal: Vec<f64> = during.iter().map(|window| window.steal).collect();
    for (who, shares) in [("other programs", others), ("other machines on the same host", steal)] {
        let busy = shares.iter().filter(|share| **share > BUSY).count();
        if busy > 0 {
            let most = shares.iter().copied().fold(0.0, f64::max);
            warnings.push(Warning::During { who, busy, stretches: shares.len(), most });
        }
    }
    let floor = -(1.0 - busy_share(&run.load).min(0.999)).ln();
    if busy_share(&run.load) > BUSY {
        warnings.push(Warning::Hidden(floor.exp() - 1.0));
    }
    warnings.extend(run.resumed.iter().map(Warning::Resumed));
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    fn window(invocation: Option<u32>, others: f64, steal: f64) -> LoadWindow {
        LoadWindow { invocation, rounds: invocation.map(|s| (s, s)), others, steal, load_average: None }
    }

    #[test]
    fn a_quiet_machine_is_passed_over_in_silence() {
        let mut run = fixture::bench(&fixture::study());
        run.load = vec![window(None, 0.01, 0.0), window(Some(0), 0.05, 0.0), window(Some(1), 0.0, 0.05)];
        assert_eq!(judged(&run), []);
        run.load.clear();
        assert_eq!(judged(&run)[0], Warning::Unknown, "unknown is not quiet");
        run.imported_from = Some("a table".into());
        assert!(warnings(&run).is_empty());
    }

    #[test]
    fn a_busy_machine_is_told_of() {
        let mut run = fixture::bench(&fixture::study());
        run.load = vec![window(None, 0.5, 0.0)];
        run.load.extend((0..4).map(|invocation| window(Some(invocation), 0.1 * f64::from(invocation), 0.0)));
        run.load.push(window(Some(4), 0.0, 0.07));
        // Shares 0, .07, .1, .2, .3: the fourth of five; 1 / (1 - .2) is 1.25.
        assert_eq!(busy_share(&run.load), 0.2);
        let told = judged(&run);
        let [Warning::Before(before), programs, machines, Warning::Hidden(hidden)] = told[..] else {
            panic!("{told:?}");
        };
        assert_eq!(before, 0.5);
        let of = |who, busy, most| Warning::During { who, busy, stretches: 5, most };
        assert_eq!(programs, of("other programs", 3, 0.1 * 3.0));
        assert_eq!(machines, of("other machines on the same host", 1, 0.07));
        assert!((hidden - 0.25).abs() < 1e-12, "{hidden}");
    }

    /// The words, by hand: other tests ask for numbers.
    #[test]
    fn the_words_are_those_of_the_file() {
        let failure = Failure { id: "ss_su".parse().unwrap(), reason: "it ended with code 3.".into() };
        let resumption = Resumption { invocation: 2, iteration: 7, place: 4 };
        let told = [
            Warning::Failed(&failure),
            Warning::Unknown,
            Warning::Before(0.5),
            Warning::During { who: "other programs", busy: 3, stretches: 5, most: 0.3 },
            Warning::During { who: "other machines on the same host", busy: 1, stretches: 5, most: 0.07 },
            Warning::Hidden(0.25),
            Warning::Resumed(&resumption),
        ];
        let mut words: Vec<String> = told.iter().map(Warning::to_string).collect();
        words.push(OtherWork { busy: 2, stretches: 4, most: 0.934 }.to_string());
        assert_eq!(words, include_str!("../tests/golden/quiet.txt").lines().collect::<Vec<_>>());
    }

    #[test]
    fn a_run_beside_other_work_is_no_evidence() {
        let mut run = fixture::bench(&fixture::study());
        assert_eq!(beside_other_work(&run), None, "nothing is known");
        let load = |shares: &[f64]| -> Vec<LoadWindow> {
            let before = [window(None, 0.9, 0.0)];
            before.into_iter().chain(shares.iter().map(|s| window(Some(0), s / 2.0, s / 2.0))).collect()
        };
        run.load = load(&[0.3, 0.0, 0.0, 0.3, 0.2]);
        assert_eq!(beside_other_work(&run), None, "two of five");
        run.load = load(&[0.25, 0.25]);
        assert_eq!(beside_other_work(&run), None, "a quarter, and no more");
        run.load = load(&[0.3, 0.0, 0.0, 0.934]);
        let work = OtherWork::of(&run).expect("two of four");
        assert_eq!((work.busy, work.stretches), (2, 4));
        assert!((work.most - 0.934).abs() < 1e-12, "{work:?}");
    }

    #[test]
    fn what_happens_in_less_than_a_quarter_of_the_rounds_is_left_to_the_outliers() {
        let load = |busy: usize| -> Vec<LoadWindow> {
            (0..20).map(|i| window(Some(0), if i < busy { 0.9 } else { 0.01 }, 0.0)).collect()
        };
        assert_eq!((busy_share(&load(5)), busy_share(&load(6))), (0.01, 0.9));
        assert_eq!(busy_share(&[]), 0.0);
        assert_eq!(busy_share(&[window(None, 0.9, 0.0)]), 0.0, "before the run is not during it");
    }
}
