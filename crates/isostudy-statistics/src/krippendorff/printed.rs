//! Where the interval of alpha is printed.

use crate::ballot::DeclaredBallot;

/// People who answered a question, on average, below which no interval is given: with fewer, simulated intervals cover 80 to
/// 100 %.
pub(super) const PEOPLE_PER_QUESTION: f64 = 12.0;

/// Questions times (1 - alpha) below which no interval is given: disagreement then hangs on few answers, or on one question, and
/// simulated intervals cover 78 to 99 %.
pub(super) const DISPUTED_QUESTIONS: f64 = 3.0;

/// Questions with two answers or more below which no interval is given: with three, simulated intervals cover up to 100 % by the
/// other rules.
pub(super) const LEAST_QUESTIONS: usize = 4;

/// The greatest alpha whose interval is printed; it depends on who answered what, not on the answers. `None` if none is.
///
/// `ballots` are sorted by participant, then by question.
pub(super) fn most(ballots: &[DeclaredBallot], counts: &[[u64; 3]]) -> Option<f64> {
    let questions = counted(counts);
    let enough = people_per_question(ballots, counts)? >= PEOPLE_PER_QUESTION;
    (enough && questions >= LEAST_QUESTIONS as f64).then(|| 1.0 - DISPUTED_QUESTIONS / questions)
}

/// How many people answered a question, on average over those with two answers or more; `None` if there is none.
pub(super) fn people_per_question(ballots: &[DeclaredBallot], counts: &[[u64; 3]]) -> Option<f64> {
    let questions = counted(counts);
    let by_people = ballots
        .chunk_by(|a, b| (a.participant(), a.question()) == (b.participant(), b.question()))
        .filter(|own| counts[own[0].question()].iter().sum::<u64>() >= 2)
        .count();
    (questions > 0.0).then(|| by_people as f64 / questions)
}

/// Questions with two answers or more.
fn counted(counts: &[[u64; 3]]) -> f64 {
    counts.iter().filter(|counts| counts.iter().sum::<u64>() >= 2).count() as f64
}
