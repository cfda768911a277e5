//! How much alpha would vary with other people who are asked the same.

use super::{Metric, Table, printed};
use crate::ballot::DeclaredBallot;

/// Over participants.
pub(super) struct Jackknife {
    /// Their number.
    pub(super) people: f64,
    /// How many of them answered a question, on average.
    pub(super) per_question: f64,
    /// Of alpha.
    pub(super) variance: f64,
}

/// From alpha with each participant left out. `None` where that leaves nothing.
///
/// What leaving one out does depends on the answers and on which questions were answered. The second part is no chance: it is the sum of
/// the questions' mean effects of one answer less, and is taken off. Where all answered everything it is the same for all.
/// `ballots` are sorted by participant, then by question; `all` has the sums of all `counts`.
pub(super) fn of(
    ballots: &[DeclaredBallot],
    counts: &[[u64; 3]],
    all: &Table,
    metric: Metric,
) -> Option<Jackknife> {
    let effects: Vec<f64> =
        counts.iter().map(|counts| mean_effect(counts, all, metric)).collect::<Option<_>>()?;
    let without = |own: &[DeclaredBallot]| {
        let mut table = *all;
        let mut expected = 0.0;
        for of_question in own.chunk_by(|a, b| a.question() == b.question()) {
            let question = of_question[0].question();
            let mut left = counts[question];
            table.add(&left, -1.0);
            of_question.iter().for_each(|ballot| left[ballot.preference().index()] -= 1);
            table.add(&left, 1.0);
            expected += of_question.len() as f64 * effects[question];
        }
        table.alpha(metric).map(|alpha| alpha - expected)
    };
    let mut left_out: Vec<f64> =
        ballots.chunk_by(|a, b| a.participant() == b.participant()).map(without).collect::<Option<_>>()?;
    // Sums of doubles depend on their order, and people come in any.
    left_out.sort_by(f64::total_cmp);
    let people = left_out.len() as f64;
    let mean = left_out.iter().sum::<f64>() / people;
    let squares: f64 = left_out.iter().map(|x| (x - mean) * (x - mean)).sum();
    // People vary about the means of their questions, and of each of these there are so many.
    let per_question = printed::people_per_question(ballots, counts)?;
    Some(Jackknife { people, per_question, variance: (per_question - 1.0) / per_question * squares })
}

/// By how much alpha changes with one answer less to a question, on average over its answers.
fn mean_effect(counts: &[u64; 3], all: &Table, metric: Metric) -> Option<f64> {
    let alpha = all.alpha(metric)?;
    let mut effects = [0.0; 3];
    for (i, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let mut left = *counts;
        left[i] -= 1;
        let mut table = *all;
        table.add(counts, -1.0);
        table.add(&left, 1.0);
        effects[i] = count as f64 * (table.alpha(metric)? - alpha);
    }
    let answers = counts.iter().sum::<u64>().max(1) as f64;
    // In this order the sum is the same to the last bit whichever item is named first.
    Some((effects[0] + effects[2] + effects[1]) / answers)
}
