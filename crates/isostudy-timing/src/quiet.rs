//! Whether the machine was left alone.

use isostudy_design::record::{BenchRun, Failure, LoadWindow};

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

/// Why a run is no evidence of anything: others had more than a quarter of the CPU time in at least half of its stretches. `None`
/// of a run that was left alone, or of which it is not known.
pub fn beside_other_work(run: &BenchRun) -> Option<String> {
    let during: Vec<f64> = shares(&run.load).collect();
    let busy = during.iter().filter(|share| **share > BESIDE[0]).count();
    let invalid = busy > 0 && busy as f64 >= BESIDE[1] * during.len() as f64;
    invalid.then(|| {
        format!(
            "measured beside other work: in {busy} of {} stretches others had more than {:.0} % of the CPU time, {:.1} % at most",
            during.len(),
            100.0 * BESIDE[0],
            100.0 * during.iter().copied().fold(0.0, f64::max)
        )
    })
}

/// What others had of the CPU time while the run measured.
fn shares(load: &[LoadWindow]) -> impl Iterator<Item = f64> {
    load.iter().filter(|window| window.invocation.is_some()).map(|window| window.others + window.steal)
}

/// What a reader of the numbers should know of the machine, in plain words; empty if it was quiet.
pub fn warnings(run: &BenchRun) -> Vec<String> {
    let failed = |of: &Failure| {
        format!("{} has no times, because its program failed: {}.", of.id, of.reason.trim_end_matches('.'))
    };
    let mut warnings: Vec<String> = run.failed.iter().map(failed).collect();
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    if run.imported_from.is_some() {
        return warnings;
    }
    let (during, before): (Vec<&LoadWindow>, Vec<&LoadWindow>) =
        run.load.iter().partition(|window| window.invocation.is_some());
    if run.load.is_empty() {
        warnings.push(
            "This system does not tell what others do: nobody knows whether the machine was quiet.".into(),
        );
    }
    if let Some(window) = before.iter().find(|window| window.others + window.steal > BUSY) {
        let share = percent(window.others + window.steal);
        warnings.push(format!(
            "Before the run others had {share} of the CPU time. Close other programs and run again."
        ));
    }
    let busy = |of: fn(&LoadWindow) -> f64| during.iter().filter(|window| of(window) > BUSY).count();
    for (count, who, share) in [
        (busy(|w| w.others), "other programs", during.iter().map(|w| w.others).fold(0.0, f64::max)),
        (
            busy(|w| w.steal),
            "other machines on the same host",
            during.iter().map(|w| w.steal).fold(0.0, f64::max),
        ),
    ] {
        if count > 0 {
            let (all, limit, share) = (during.len(), percent(BUSY), percent(share));
            warnings.push(format!(
                "In {count} of {all} stretches of the run {who} had more than {limit} of the CPU time, {share} at most."
            ));
        }
    }
    let floor = -(1.0 - busy_share(&run.load).min(0.999)).ln();
    if busy_share(&run.load) > BUSY {
        let percent = 100.0 * (floor.exp() - 1.0);
        warnings.push(format!(
            "Differences below {percent:.0} % from other runs may be due to that: a comparison does not report them."
        ));
    }
    for resumption in &run.resumed {
        warnings.push(format!(
            "The run was broken off and taken up again in round {}, place {}, of process {}, after warm-up.",
            resumption.iteration, resumption.place, resumption.invocation
        ));
    }
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
        assert_eq!(warnings(&run), [] as [String; 0]);
        run.load.clear();
        assert!(warnings(&run)[0].contains("does not tell"), "unknown is not quiet");
        run.imported_from = Some("a table".into());
        assert!(warnings(&run).is_empty());
    }

    #[test]
    fn a_busy_machine_is_told_of_in_plain_words() {
        let mut run = fixture::bench(&fixture::study());
        run.load = vec![window(None, 0.5, 0.0)];
        run.load.extend((0..4).map(|invocation| window(Some(invocation), 0.1 * f64::from(invocation), 0.0)));
        run.load.push(window(Some(4), 0.0, 0.07));
        let text = warnings(&run).join("\n");
        assert!(
            text.contains("Before the run others had 50.0 % of the CPU time. Close other programs"),
            "{text}"
        );
        assert!(text.contains("In 3 of 5 stretches of the run other programs had more than 5.0 %"), "{text}");
        assert!(text.contains("of the CPU time, 30.0 % at most."), "{text}");
        assert!(text.contains("In 1 of 5 stretches of the run other machines on the same host"), "{text}");
        // Shares 0, .07, .1, .2, .3: the fourth of five; 1 / (1 - .2) is 1.25.
        assert_eq!(busy_share(&run.load), 0.2);
        assert!(text.contains("Differences below 25 % from other runs"), "{text}");
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
        let want = "measured beside other work: in 2 of 4 stretches others had more than 25 % of the CPU time, 93.4 % at most";
        assert_eq!(beside_other_work(&run).as_deref(), Some(want));
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
