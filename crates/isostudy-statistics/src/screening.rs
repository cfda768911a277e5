//! Signs of careless answering, reported beside the results and never applied silently.

use super::ballot::{DeclaredBallot, Outcome, ShownBallot};
use super::kendall::outcome_counts;
use super::outlying::{WithMajority, outlying_respondents};

/// How an answer was given, as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Circumstances {
    /// Its place in the order in which the participant saw the questions.
    pub order: Option<u32>,
    /// Time from the question to the answer, in milliseconds.
    pub rt_ms: Option<f64>,
}

/// What screening can use beside the ballots; whatever is empty or missing is not judged.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Protocol<'a> {
    /// One a ballot, in the same order, or none at all.
    pub circumstances: &'a [Circumstances],
    /// By question, what it shows its two items on (the object): questions with the same scene and items are repeats. Left
    /// empty, only a question answered twice is one.
    pub scenes: &'a [usize],
    /// How long what a question shows lasts, in milliseconds: nobody has seen it in less.
    pub shown_ms: Option<f64>,
    /// Whether left and right are no sides; then nobody is one-sided.
    pub sides_unknown: bool,
    /// Whether nobody could answer "no preference"; then to decide a control is no sign of guessing.
    pub forced: bool,
}

/// One participant's answers, seen from outside.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Screening {
    /// The participant.
    pub participant: usize,
    /// Answers `[left, tie, right]`, controls left out.
    pub answers: [u64; 3],
    /// Questions that the participant decided and on which the others' decided answers have a majority.
    pub comparable: u64,
    /// Of these, how many agree with that majority.
    pub agreeing: u64,
    /// Longest run of the same side, in the order of presentation if it is known of all answers, else of questions; ties
    /// end a run.
    pub longest_run: u64,
    /// Answers to controls, which show an item beside itself.
    pub controls: u64,
    /// Of these, how many decided for a side nonetheless.
    pub controls_decided: u64,
    /// Of the controls that were decided, how many went left.
    pub controls_left: u64,
    /// Whether every item that the participant decided about stood on both sides in these answers.
    pub items_on_both_sides: bool,
    /// Answers that repeat an earlier one about the same two items in the same scene, in either order of sides, both decided.
    pub repeats: u64,
    /// Of these, how many chose the other item.
    pub repeats_opposite: u64,
    /// Of the repeats, how many had the sides swapped.
    pub repeats_swapped: u64,
    /// Answers whose time is known.
    pub timed: u64,
    /// Sum of these times in milliseconds.
    pub time_ms: f64,
    /// One-sided p of agreeing so much less than the others, see [`outlying_respondents`]; `None` if not judged.
    pub outlying_p: Option<f64>,
}

/// A rule that a participant broke. The rules are declared here, for every study alike, and only the last looks at what was
/// preferred.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Flag {
    /// Ten decided answers or more, all for the same side, where that is no preference: see [`Screening::tells_sides`].
    OneSided,
    /// Two controls decided or more, and more than half of them.
    Controls,
    /// Two repeats or more chose the other item, and more than half of them.
    Repeats,
    /// All timed answers together took less than what they were shown lasts.
    Time,
    /// Agrees with the others' majority on less than half, and so much less than the others that it is not chance at 1 %.
    Outlying,
}

impl Flag {
    /// Every rule.
    pub const ALL: [Self; 5] = [Self::OneSided, Self::Controls, Self::Repeats, Self::Time, Self::Outlying];

    /// The name in files.
    pub fn code(self) -> &'static str {
        match self {
            Self::OneSided => "one-sided",
            Self::Controls => "controls",
            Self::Repeats => "repeats",
            Self::Time => "time",
            Self::Outlying => "outlying",
        }
    }
}

impl Screening {
    /// How often the participant agrees with the others.
    pub fn with_majority(&self) -> WithMajority {
        let Self { participant, comparable, agreeing, .. } = *self;
        WithMajority { participant, comparable, agreeing }
    }

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

    /// Share of repeats with the same choice; `None` without repeats.
    pub fn consistency(&self) -> Option<f64> {
        (self.repeats > 0).then(|| 1.0 - self.repeats_opposite as f64 / self.repeats as f64)
    }

    /// Whether choosing one side throughout could be told from preferring what stood there. It could if
    /// - every item that the participant decided about stood on the left in some of these answers and on the right in others,
    ///   so that no order of the items has the same side ahead in all of them; or
    /// - two repeats or more were decided that had the sides swapped, so that the same side means the other item; or
    /// - two controls or more were decided, where there is nothing else to prefer, all for that same side.
    ///
    /// Who agrees on everything where sides go with items chooses one side throughout, and is not careless for it.
    pub fn tells_sides(&self) -> bool {
        let [left, _, right] = self.answers;
        let same_side =
            if left >= right { self.controls_left } else { self.controls_decided - self.controls_left };
        let by_controls = self.controls_decided >= 2 && same_side == self.controls_decided;
        self.items_on_both_sides || self.repeats_swapped >= 2 || by_controls
    }

    /// The rules broken.
    pub fn flags(&self, protocol: &Protocol<'_>) -> Vec<Flag> {
        let [left, _, right] = self.answers;
        let breaks = |flag: &Flag| match flag {
            Flag::OneSided => {
                let one_side = left + right >= 10 && left.min(right) == 0;
                one_side && !protocol.sides_unknown && self.tells_sides()
            }
            Flag::Controls => {
                !protocol.forced && self.controls_decided >= 2 && 2 * self.controls_decided > self.controls
            }
            Flag::Repeats => self.repeats_opposite >= 2 && 2 * self.repeats_opposite > self.repeats,
            Flag::Time => {
                let least = protocol.shown_ms.map(|each| each * self.timed as f64);
                self.timed > 0 && least.is_some_and(|least| self.time_ms < least)
            }
            Flag::Outlying => self.outlying_p.is_some_and(|p| p < 0.01),
        };
        Flag::ALL.into_iter().filter(breaks).collect()
    }
}

/// Screens every participant with a ballot, in their order, by the ballots alone.
pub fn screening(ballots: &[ShownBallot]) -> Vec<Screening> {
    screening_with(ballots, &Protocol::default())
}

/// Screens every participant with a ballot, in their order.
///
/// Agreement compares items, whichever side they stood on; everything else is about sides as they were shown.
///
/// # Panics
/// If there are circumstances, but not one a ballot.
pub fn screening_with(ballots: &[ShownBallot], protocol: &Protocol<'_>) -> Vec<Screening> {
    let known = protocol.circumstances;
    assert!(known.is_empty() || known.len() == ballots.len(), "circumstances of another set of ballots");
    let by_item: Vec<DeclaredBallot> = ballots.iter().map(ShownBallot::by_item).collect();
    let counts = outcome_counts(&by_item);
    let ordered = !known.is_empty() && known.iter().all(|of| of.order.is_some());
    let mut places: Vec<usize> = (0..ballots.len()).collect();
    places.sort_by_key(|&i| {
        let order = if ordered { known[i].order } else { None };
        (ballots[i].participant(), order, ballots[i].question())
    });
    let of_participant = |places: &[usize]| {
        let mut seen = Screening { participant: ballots[places[0]].participant(), ..Screening::default() };
        let (mut run, mut last) = (0, 0);
        for &i in places {
            let (ballot, sign) = (&ballots[i], ballots[i].outcome().sign());
            if let Some(time) = known.get(i).and_then(|of| of.rt_ms) {
                seen.timed += 1;
                seen.time_ms += time;
            }
            run = if sign != 0 && sign == last { run + 1 } else { sign.unsigned_abs() };
            last = sign;
            seen.longest_run = seen.longest_run.max(run);
            if ballot.left() == ballot.right() {
                seen.controls += 1;
                seen.controls_decided += sign.unsigned_abs();
                seen.controls_left += u64::from(sign > 0);
                continue;
            }
            seen.answers[ballot.outcome().index()] += 1;
            let own = by_item[i].preference().sign();
            let [first, _, second] = counts[ballot.question()];
            let others = first as i64 - second as i64 - own;
            if ballot.outcome() != Outcome::Tie && others != 0 {
                seen.comparable += 1;
                seen.agreeing += u64::from(others.signum() == own);
            }
        }
        let decided = || {
            let own = places.iter().map(|&i| &ballots[i]);
            own.filter(|b| b.left() != b.right() && b.outcome() != Outcome::Tie)
        };
        seen.items_on_both_sides = on_both_sides(decided());
        seen.count_repeats(decided(), protocol.scenes);
        seen
    };
    let same = |a: &usize, b: &usize| ballots[*a].participant() == ballots[*b].participant();
    let mut screened: Vec<Screening> = places.chunk_by(same).map(of_participant).collect();
    for outlying in outlying_respondents(&screened.iter().map(Screening::with_majority).collect::<Vec<_>>()) {
        let place =
            screened.binary_search_by_key(&outlying.participant, |s| s.participant).expect("one of them");
        screened[place].outlying_p = Some(outlying.p);
    }
    screened
}

impl Screening {
    /// Decided answers about the same items in the same scene, each against the one before.
    fn count_repeats<'a>(&mut self, decided: impl Iterator<Item = &'a ShownBallot>, scenes: &[usize]) {
        // Without scenes every question is its own.
        let scene = |b: &ShownBallot| {
            (scenes.get(b.question()).copied(), if scenes.is_empty() { b.question() } else { 0 })
        };
        let chosen = |b: &ShownBallot| if b.outcome() == Outcome::Left { b.left() } else { b.right() };
        let mut shown: Vec<_> = decided
            .map(|b| ((scene(b), b.left().min(b.right()), b.left().max(b.right())), b.left(), chosen(b)))
            .collect();
        // Stable: the order of presentation stays within each.
        shown.sort_by_key(|&(pair, ..)| pair);
        for two in shown.windows(2) {
            let [(pair, left, item), (next_pair, next_left, next)] = [two[0], two[1]];
            if pair == next_pair {
                self.repeats += 1;
                self.repeats_opposite += u64::from(item != next);
                self.repeats_swapped += u64::from(left != next_left);
            }
        }
    }
}

/// Whether there are items, and all of them stood on both sides.
fn on_both_sides<'a>(decided: impl Iterator<Item = &'a ShownBallot>) -> bool {
    let (mut left, mut right): (Vec<usize>, Vec<usize>) = decided.map(|b| (b.left(), b.right())).unzip();
    for items in [&mut left, &mut right] {
        items.sort_unstable();
        items.dedup();
    }
    !left.is_empty() && left == right
}

#[cfg(test)]
mod tests;
