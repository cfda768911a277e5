//! One score a participant, and whether people lean one way: the test of every contrast.
//!
//! A participant's score is the mean of the answers that count: +1 for the first, 0 for neither, -1 for the second. Of a
//! difference it is the mean over one part of the questions less the mean over the other. People weigh alike, however many
//! questions each of them answered, and mean, interval and sign-flip test are all about these scores.

use super::bootstrap::{BootstrapInterval, Resampling, kinds, mean_and_error, studentised};
use super::equivalence::{Equivalence, equivalence};
use super::sign_flip::{RATIO_LIMIT, SignFlip, greatest_common_divisor, sign_flip_within, without_one};
use crate::interval::{Interval, of_mean_score};
use std::collections::BTreeMap;

/// The test needs whole numbers. Scores without a common unit as coarse as 1 / this are rounded to multiples of it.
const FINEST: i64 = 55_440;
/// The exact test adds up this many steps at most, which bounds the units of all people together.
const MOST_STEPS: i64 = 1 << 19;

/// What answers say about a contrast.
#[derive(Debug, Clone, PartialEq)]
pub struct ScoreTest {
    /// Answers for the first, for neither, for the second; `None` of a difference, whose parts weigh unlike.
    pub counts: Option<[u64; 3]>,
    /// Participants with a score, those with the same score together; ascending by score.
    pub groups: Vec<ScoreGroup>,
    /// By participant, the place of its group; [`NO_SCORE`] without a score.
    places: Vec<u32>,
    /// The exact test of the scores. Its `net` is their sum in a unit that makes them whole numbers.
    pub sign_flip: SignFlip,
    /// How far scores can be from zero: 1, and 2 for differences.
    pub reach: f64,
    /// Mean of the scores; 0 without participants.
    pub mean: f64,
    /// Interval for it over participants: [`of_mean_score`].
    pub interval: Option<Interval>,
    /// Of a difference, how far its parts are about different strata, 0 to 1, where people answered both parts in none that is common:
    /// half the sum of what the strata's shares of the answers differ by. What differs may then be strata.
    pub apart: f64,
}

/// The place of whoever has no score.
const NO_SCORE: u32 = u32::MAX;

/// Participants with the same score, a fraction in lowest terms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScoreGroup {
    /// Numerator of the score.
    pub numerator: i64,
    /// Denominator, above 0.
    pub denominator: i64,
    /// How many participants.
    pub people: u64,
}

impl ScoreGroup {
    /// The score.
    pub fn score(&self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }
}

/// What one participant answered to one part of the questions.
#[derive(Debug, Clone, Copy, Default)]
struct Part {
    net: i64,
    answers: i64,
}

impl ScoreTest {
    /// Tests answers given as `(participant, sign)`; the sign is +1 for the first, 0 for neither, -1 for the second.
    pub fn of(answers: impl IntoIterator<Item = (usize, i64)>) -> Self {
        let mut people: Vec<Part> = Vec::new();
        let mut counts = [0; 3];
        for (participant, sign) in answers {
            if participant >= people.len() {
                people.resize(participant + 1, Part::default());
            }
            people[participant].add(sign);
            counts[(1 - sign.signum()) as usize] += 1;
        }
        let scores = people.iter().map(|of| (of.answers > 0).then_some((of.net, of.answers)));
        Self::of_scores(scores, Some(counts), 1.0)
    }

    /// Tests a difference: answers are `(participant, stratum, whether to the second part, sign)`, strata from 0.
    ///
    /// A participant's difference is the mean over the strata in which both parts were answered, such as objects, so that who
    /// stops before the last object does not look like a change of taste. Who answered both parts in no common stratum, as
    /// where questions are dealt into blocks, has the difference of the two means. Whoever answered nothing of one part has
    /// no score.
    pub fn of_difference(answers: impl IntoIterator<Item = (usize, usize, bool, i64)>) -> Self {
        let mut people: Vec<Vec<[Part; 2]>> = Vec::new();
        for (participant, stratum, second, sign) in answers {
            if participant >= people.len() {
                people.resize(participant + 1, Vec::new());
            }
            let strata = &mut people[participant];
            if stratum >= strata.len() {
                strata.resize(stratum + 1, Default::default());
            }
            strata[stratum][usize::from(second)].add(sign);
        }
        let apart = apart(&people);
        Self { apart, ..Self::of_scores(people.iter().map(|strata| difference(strata)), None, 2.0) }
    }

    /// Tests a difference of ratings: they are `(participant, stratum, whether of the second item, rating)`, in whole steps, of which the
    /// scale has `reach` from its least to its largest. Means over strata, such as objects, as in
    /// [`of_difference`](Self::of_difference): only a person's own ratings are compared, so people may use the scale as they like.
    pub fn of_rating_difference(
        ratings: impl IntoIterator<Item = (usize, usize, bool, i64)>,
        reach: f64,
    ) -> Self {
        let of = Self::of_difference(ratings);
        let interval = of_mean_score(&of.scores(), reach);
        Self { reach, interval, ..of }
    }

    /// Scores by participant, as numerator and denominator.
    fn of_scores(
        scores: impl Iterator<Item = Option<(i64, i64)>>,
        counts: Option<[u64; 3]>,
        reach: f64,
    ) -> Self {
        let scores: Vec<Option<(i64, i64)>> = scores
            .map(|score| score.map(|(numerator, denominator)| reduced(numerator, denominator)))
            .collect();
        let mut alike: BTreeMap<(i64, i64), u64> = BTreeMap::new();
        scores.iter().flatten().for_each(|score| *alike.entry(*score).or_default() += 1);
        let mut groups: Vec<ScoreGroup> = alike
            .into_iter()
            .map(|((numerator, denominator), people)| ScoreGroup { numerator, denominator, people })
            .collect();
        groups.sort_by_key(|group| (group.numerator as i128 * WIDE) / i128::from(group.denominator));
        let place: BTreeMap<(i64, i64), u32> =
            groups.iter().zip(0..).map(|(of, place)| ((of.numerator, of.denominator), place)).collect();
        let places = scores.iter().map(|score| score.map_or(NO_SCORE, |score| place[&score])).collect();
        let units = Units::of(&groups);
        let sign_flip = sign_flip_within(&units.counts(&groups), units.slack);
        let test = Self { counts, groups, places, sign_flip, reach, mean: 0.0, interval: None, apart: 0.0 };
        let scores = test.scores();
        // Rounding must not make a preference of none.
        let none = test.sign_flip.net == 0 && units.slack == 0;
        let mean = match scores.len() {
            0 => 0.0,
            _ if none => 0.0,
            people => scores.iter().sum::<f64>() / people as f64,
        };
        Self { mean, interval: of_mean_score(&scores, reach), ..test }
    }

    /// The place of a participant's group in [`groups`](Self::groups); `None` without a score.
    pub fn group_of(&self, participant: usize) -> Option<usize> {
        self.places.get(participant).filter(|&&place| place != NO_SCORE).map(|&place| place as usize)
    }

    /// Every participant with a score, ascending.
    pub fn with_score(&self) -> impl Iterator<Item = usize> {
        self.places.iter().enumerate().filter(|(_, place)| **place != NO_SCORE).map(|(person, _)| person)
    }

    /// How many participants have a score.
    pub fn participants(&self) -> usize {
        self.groups.iter().map(|group| group.people as usize).sum()
    }

    /// How many of them score above zero, at zero and below.
    pub fn people(&self) -> [u64; 3] {
        let mut people = [0; 3];
        for group in &self.groups {
            people[(1 - group.numerator.signum()) as usize] += group.people;
        }
        people
    }

    /// How many of them lean to one side.
    pub fn leaning(&self) -> usize {
        let [first, _, second] = self.people();
        (first + second) as usize
    }

    /// One score a participant, ascending.
    pub fn scores(&self) -> Vec<f64> {
        let of = |group: &ScoreGroup| std::iter::repeat_n(group.score(), group.people as usize);
        self.groups.iter().flat_map(of).collect()
    }

    /// The test that the mean score lies within `margin` of zero.
    pub fn equivalence(&self, margin: f64) -> Option<Equivalence> {
        equivalence(&self.scores(), margin, self.reach)
    }

    /// p with one participant left out: one value for each group of equal scores, in their order; empty for fewer than two
    /// participants.
    pub fn leave_one_out(&self) -> Vec<f64> {
        if self.participants() < 2 {
            return Vec::new();
        }
        let units = Units::of(&self.groups);
        let p = without_one(&units.counts(&self.groups), units.slack);
        self.groups.iter().map(|group| p[&units.whole(group)]).collect()
    }

    /// Studentised bootstrap interval for the mean score, resampling participants. `None` below [`FEWEST_RESAMPLED`].
    pub fn studentised(&self, resampling: Resampling) -> Option<BootstrapInterval> {
        if self.participants() < FEWEST_RESAMPLED {
            return None;
        }
        let (scores, counts) = kinds(&self.scores());
        studentised(&counts, resampling, |weights| mean_and_error(&scores, weights))
    }
}

/// Fewer participants are not resampled: at 95 % the studentised interval covered 79 % with four of them and 88 % with six.
pub const FEWEST_RESAMPLED: usize = 10;

/// Enough to order any two fractions of sums of answers.
const WIDE: i128 = 1 << 60;

/// The whole numbers that stand for scores.
struct Units {
    per_one: i64,
    /// How far rounding can move a sum of scores against another, in units; 0 where nothing is rounded.
    slack: u64,
}

impl Units {
    /// The least common multiple of the denominators, or if that is too fine for so many people, what is fine enough.
    fn of(groups: &[ScoreGroup]) -> Self {
        let people: i64 = groups.iter().map(|group| group.people as i64).sum();
        // Differences reach to 2. Beyond the exact test's number of people the cost grows with the root of theirs.
        let finest = if people <= RATIO_LIMIT as i64 { MOST_STEPS / (2 * people.max(1)) } else { FINEST };
        let rounded = Self { per_one: finest, slack: people as u64 };
        let mut per_one = 1_i64;
        for group in groups {
            let divisor =
                greatest_common_divisor(per_one.unsigned_abs(), group.denominator.unsigned_abs()) as i64;
            match per_one.checked_mul(group.denominator / divisor).filter(|&of| of <= finest) {
                Some(of) => per_one = of,
                None => return rounded,
            }
        }
        Self { per_one, slack: 0 }
    }

    fn whole(&self, group: &ScoreGroup) -> i64 {
        let scaled = i128::from(group.numerator) * i128::from(self.per_one);
        let (of, half) = (i128::from(group.denominator), i128::from(group.denominator / 2));
        // Rounded alike for a score and its opposite; nothing to round where there is no slack.
        ((scaled.abs() + half) / of * scaled.signum()) as i64
    }

    fn counts(&self, groups: &[ScoreGroup]) -> BTreeMap<i64, u64> {
        let mut counts = BTreeMap::new();
        groups.iter().for_each(|group| *counts.entry(self.whole(group)).or_default() += group.people);
        counts
    }
}

impl Part {
    fn add(&mut self, sign: i64) {
        self.net += sign;
        self.answers += 1;
    }
}

/// Numerator and denominator of one participant's difference.
fn difference(strata: &[[Part; 2]]) -> Option<(i64, i64)> {
    let of = |[a, b]: [Part; 2]| (a.net * b.answers - b.net * a.answers, a.answers * b.answers);
    let mut both = strata.iter().filter(|[a, b]| a.answers > 0 && b.answers > 0).map(|parts| of(*parts));
    if let Some(first) = both.next() {
        let mut count = 1;
        let (sum, denominator) = both.fold(first, |(sum, denominator), (net, answers)| {
            count += 1;
            reduced(sum * answers + net * denominator, denominator * answers)
        });
        return Some((sum, denominator * count));
    }
    let total = strata.iter().fold([Part::default(); 2], |sum, parts| {
        [0, 1].map(|i| Part { net: sum[i].net + parts[i].net, answers: sum[i].answers + parts[i].answers })
    });
    let [a, b] = total;
    (a.answers > 0 && b.answers > 0).then(|| of(total))
}

/// How far the parts of differences without a common stratum are about different strata, as [`ScoreTest::apart`].
fn apart(people: &[Vec<[Part; 2]>]) -> f64 {
    let mut answers: Vec<[i64; 2]> = Vec::new();
    for strata in people {
        let [a, b] = [0, 1].map(|part| strata.iter().any(|parts| parts[part].answers > 0));
        let is_common = |[a, b]: &[Part; 2]| a.answers > 0 && b.answers > 0;
        if !(a && b) || strata.iter().any(is_common) {
            continue;
        }
        answers.resize(answers.len().max(strata.len()), [0; 2]);
        for (sum, parts) in answers.iter_mut().zip(strata) {
            (0..2).for_each(|part| sum[part] += parts[part].answers);
        }
    }
    let [a, b] = [0, 1].map(|part| answers.iter().map(|of| of[part]).sum::<i64>().max(1) as f64);
    0.5 * answers.iter().map(|of| (of[0] as f64 / a - of[1] as f64 / b).abs()).sum::<f64>()
}

/// In lowest terms.
fn reduced(numerator: i64, denominator: i64) -> (i64, i64) {
    let divisor = greatest_common_divisor(numerator.unsigned_abs(), denominator.unsigned_abs()) as i64;
    (numerator / divisor, denominator / divisor)
}

#[cfg(test)]
mod tests;
