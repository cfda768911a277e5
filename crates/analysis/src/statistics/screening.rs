//! Signs of careless answering, reported beside the results and never applied silently.

use super::ballot::{Ballot, Outcome};
use super::kendall::outcome_counts;
use std::collections::BTreeMap;

/// One participant's answers, seen from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Screening {
    /// The participant.
    pub participant: usize,
    /// Answers `[left, tie, right]`.
    pub answers: [u64; 3],
    /// Questions that the participant decided and on which the others' decided answers have a majority.
    pub comparable: u64,
    /// Of these, how many agree with that majority.
    pub agreeing: u64,
    /// Longest run of the same side in the order of questions; ties end a run.
    pub longest_run: u64,
}

impl Screening {
    /// Share of comparable questions answered with the others' majority; `None` of nothing. About 0.5 by chance.
    pub fn agreement(&self) -> Option<f64> {
        (self.comparable > 0).then(|| self.agreeing as f64 / self.comparable as f64)
    }

    /// (left - right) / (left + right): -1 all right, 1 all left; `None` of nothing. To be read against the other
    /// participants': where sides go with configurations, everybody leans.
    pub fn one_sidedness(&self) -> Option<f64> {
        let [left, _, right] = self.answers;
        (left + right > 0).then(|| (left as f64 - right as f64) / (left + right) as f64)
    }
}

/// Screens every participant with a ballot, in their order.
pub fn screening(ballots: &[Ballot]) -> Vec<Screening> {
    let counts = outcome_counts(ballots);
    let mut of: BTreeMap<usize, Vec<&Ballot>> = BTreeMap::new();
    ballots.iter().for_each(|ballot| of.entry(ballot.participant).or_default().push(ballot));
    let screen = |(participant, mut own): (usize, Vec<&Ballot>)| {
        own.sort_by_key(|ballot| ballot.question);
        let mut seen = Screening { participant, answers: [0; 3], comparable: 0, agreeing: 0, longest_run: 0 };
        let (mut run, mut last) = (0, 0);
        for ballot in own {
            let sign = ballot.outcome.sign();
            seen.answers[(1 - sign) as usize] += 1;
            run = if sign != 0 && sign == last { run + 1 } else { sign.unsigned_abs() };
            last = sign;
            seen.longest_run = seen.longest_run.max(run);
            let [left, _, right] = counts[ballot.question];
            let others = left as i64 - right as i64 - sign;
            if ballot.outcome != Outcome::Tie && others != 0 {
                seen.comparable += 1;
                seen.agreeing += u64::from(others.signum() == sign);
            }
        }
        seen
    };
    of.into_iter().map(screen).collect()
}

#[cfg(test)]
mod tests;
