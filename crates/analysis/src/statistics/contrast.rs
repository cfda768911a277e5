//! Contrasts of a study: which answers speak for one property over another, with everything else equal.

use super::ballot::{Ballot, Outcome};
use super::bootstrap::{BootstrapInterval, Resampling, bca, kinds, mean, mean_and_error, studentised};
use super::equivalence::{Equivalence, MARGIN, equivalence};
use super::sign_flip::{SignFlip, sign_flip_of_counts};
use crate::interval::{Interval, of_mean_score};
use design::{Arrangement, Clustering, Study};
use std::collections::BTreeMap;

/// The families within which p values are adjusted, declared before looking.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Family {
    /// Clusterings pooled over arrangements, arrangements pooled over clusterings.
    Pooled,
    /// Clusterings within each arrangement, arrangements within each clustering.
    Groups,
    /// Arrangements by object.
    Objects,
    /// Differences of contrasts: do preferences depend on the other property, or on the object?
    Interactions,
}

impl Family {
    /// The name in files.
    pub fn code(self) -> &'static str {
        match self {
            Self::Pooled => "pooled",
            Self::Groups => "groups",
            Self::Objects => "objects",
            Self::Interactions => "interactions",
        }
    }
}

/// A value of one of the two properties that a study varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// How sample points are laid out.
    Arrangement(Arrangement),
    /// How vertices are merged.
    Clustering(Clustering),
}

/// Over which answers a contrast goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// All that compare its two levels.
    All,
    /// Those where the other property has this value.
    Within(Level),
    /// Those on one object, by index.
    Object(usize),
    /// Those where the other property has the first value, less those where it has the second.
    Difference(Level, Level),
    /// Those on one object, less those on all others.
    AgainstOthers(usize),
}

/// A weighted sum of answers; each question's weight is for its left side.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Contrast {
    /// Where p is adjusted.
    pub family: Family,
    /// What is compared, such as `U-I`.
    pub name: String,
    /// Over which answers, such as `within B`.
    pub scope: String,
    /// What is compared: the level that counts as positive, and the other.
    pub levels: [Level; 2],
    /// Over which answers.
    pub over: Over,
    /// Question index to weight.
    pub weights: BTreeMap<usize, i64>,
}

/// What answers say about a contrast.
#[derive(Debug, Clone, PartialEq)]
pub struct ContrastTest {
    /// Answers for the first, none, for the second; of a contrast with weights other than 1 and -1, `None`.
    pub counts: Option<[u64; 3]>,
    /// Whoever counts, those with the same answers together; ascending.
    pub kinds: Vec<Kind>,
    /// The exact test of the nets.
    pub sign_flip: SignFlip,
    /// How far scores can be from zero: 1, and 2 for interactions, which are differences of two mean scores.
    pub reach: f64,
    /// Mean of the scores; 0 without participants.
    pub mean: f64,
    /// Interval for it over participants: [`of_mean_score`].
    pub interval: Option<Interval>,
}

/// Participants with the same answers to a contrast's questions, as far as it can tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    /// Sum of weight times sign.
    pub net: i64,
    /// Sum of the weights' sizes over the questions answered.
    pub size: i64,
    /// How many participants.
    pub people: u64,
}

impl Level {
    /// The paper's letter, upper case.
    pub fn code(self) -> char {
        match self {
            Self::Arrangement(arrangement) => arrangement.code().to_ascii_uppercase(),
            Self::Clustering(clustering) => clustering.code().to_ascii_uppercase(),
        }
    }
}

impl Contrast {
    /// Tests it on ballots, whose questions are the study's.
    ///
    /// Whoever answered some of its questions counts as far as that goes; for an interaction, whoever answered all of them:
    /// of half a difference nothing can be said.
    pub fn test<'a>(&self, ballots: impl IntoIterator<Item = &'a Ballot>) -> ContrastTest {
        let questions = self.weights.keys().last().map_or(0, |last| last + 1);
        let weights: Vec<i64> =
            (0..questions).map(|q| self.weights.get(&q).copied().unwrap_or_default()).collect();
        let weighted = |ballot: &Ballot| {
            let weight = *weights.get(ballot.question()).filter(|&&weight| weight != 0)?;
            Some((ballot.participant(), weight, ballot.outcome()))
        };
        let answers = ballots.into_iter().filter_map(weighted);
        match self.family {
            Family::Interactions => {
                ContrastTest::of_difference(answers, self.weights.values().map(|w| w.abs()).sum())
            }
            _ => ContrastTest::of(answers),
        }
    }
}

impl ContrastTest {
    /// Tests answers given as `(participant, weight, outcome)`; a positive weight speaks for the left side. A participant's
    /// score is the net over the size: -1..=1.
    pub fn of(answers: impl IntoIterator<Item = (usize, i64, Outcome)>) -> Self {
        let (people, counts) = add_up(answers);
        Self::of_people(people.into_iter().filter(|&(_, size)| size > 0), Some(counts), 1.0)
    }

    /// Tests a difference of two mean scores, each part of which has half of the weights' sizes, `all` together. Only those
    /// who answered everything count. Scores are -2..=2; counts of answers mean nothing, since not all weigh the same.
    fn of_difference(answers: impl IntoIterator<Item = (usize, i64, Outcome)>, all: i64) -> Self {
        let (people, _) = add_up(answers);
        Self::of_people(people.into_iter().filter(|&(_, size)| size == all), None, 2.0)
    }

    fn of_people(people: impl Iterator<Item = (i64, i64)>, counts: Option<[u64; 3]>, reach: f64) -> Self {
        let mut alike: BTreeMap<(i64, i64), u64> = BTreeMap::new();
        people.for_each(|person| *alike.entry(person).or_default() += 1);
        let kinds: Vec<Kind> =
            alike.into_iter().map(|((net, size), people)| Kind { net, size, people }).collect();
        let test = Self {
            counts,
            sign_flip: sign_flip_of_counts(&nets(&kinds)),
            kinds,
            reach,
            mean: 0.0,
            interval: None,
        };
        let scores = test.scores();
        let mean = if scores.is_empty() { 0.0 } else { scores.iter().sum::<f64>() / scores.len() as f64 };
        // Rounding must not make a preference of none.
        let mean = if test.sign_flip.net == 0 && test.kinds.iter().all(|k| k.size == test.kinds[0].size) {
            0.0
        } else {
            mean
        };
        Self { mean, interval: of_mean_score(&scores, reach), ..test }
    }

    /// How many participants count.
    pub fn participants(&self) -> usize {
        self.kinds.iter().map(|kind| kind.people as usize).sum()
    }

    /// How many of them lean to one side.
    pub fn leaning(&self) -> usize {
        self.kinds.iter().filter(|kind| kind.net != 0).map(|kind| kind.people as usize).sum()
    }

    /// One score a participant, ascending by net.
    pub fn scores(&self) -> Vec<f64> {
        let of = |kind: &Kind| {
            std::iter::repeat_n(self.reach * kind.net as f64 / kind.size as f64, kind.people as usize)
        };
        self.kinds.iter().flat_map(of).collect()
    }

    /// The test that the mean score lies within [`MARGIN`] of zero.
    pub fn equivalence(&self) -> Option<Equivalence> {
        equivalence(&self.scores(), MARGIN, self.reach)
    }

    /// Smallest and largest p when each participant in turn is left out; `None` for fewer than two.
    pub fn leave_one_out(&self) -> Option<(f64, f64)> {
        // Participants with the same difference leave the same p behind.
        let counts = nets(&self.kinds);
        let without = |left_out: &i64| {
            let mut others = counts.clone();
            *others.get_mut(left_out).expect("one of them") -= 1;
            sign_flip_of_counts(&others).p()
        };
        let all = (self.participants() > 1).then(|| counts.keys().map(without));
        all.map(|p| p.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p))))
    }

    /// BCa interval for the mean score, resampling participants.
    pub fn bca(&self, resampling: Resampling) -> Option<BootstrapInterval> {
        let (scores, counts) = kinds(&self.scores());
        bca(&counts, resampling, |weights| mean(&scores, weights))
    }

    /// Studentised bootstrap interval for the mean score, resampling participants.
    pub fn studentised(&self, resampling: Resampling) -> Option<BootstrapInterval> {
        let (scores, counts) = kinds(&self.scores());
        studentised(&counts, resampling, |weights| mean_and_error(&scores, weights))
    }
}

/// By participant, sum of weight times sign and of the weights' sizes, which is 0 for whoever did not answer; and counts of
/// answers for, neither, against.
fn add_up(answers: impl IntoIterator<Item = (usize, i64, Outcome)>) -> (Vec<(i64, i64)>, [u64; 3]) {
    let mut people: Vec<(i64, i64)> = Vec::new();
    let mut counts = [0; 3];
    for (participant, weight, outcome) in answers {
        if participant >= people.len() {
            people.resize(participant + 1, (0, 0));
        }
        let signed = weight * outcome.sign();
        people[participant].0 += signed;
        people[participant].1 += weight.abs();
        counts[(1 - signed.signum()) as usize] += 1;
    }
    (people, counts)
}

/// How many participants have each net.
fn nets(kinds: &[Kind]) -> BTreeMap<i64, u64> {
    let mut nets = BTreeMap::new();
    kinds.iter().for_each(|kind| *nets.entry(kind.net).or_default() += kind.people);
    nets
}

/// What a question compares, if its sides differ in one property alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Single {
    Clustering { within: Arrangement, left: Clustering, right: Clustering },
    Arrangement { within: Clustering, left: Arrangement, right: Arrangement },
}

fn single(study: &Study, question: usize) -> Option<Single> {
    let (left, right) = (study.comparisons[question].left.method, study.comparisons[question].right.method);
    match (left.arrangement == right.arrangement, left.clustering == right.clustering) {
        (true, false) => Some(Single::Clustering {
            within: left.arrangement,
            left: left.clustering,
            right: right.clustering,
        }),
        (false, true) => Some(Single::Arrangement {
            within: left.clustering,
            left: left.arrangement,
            right: right.arrangement,
        }),
        _ => None,
    }
}

/// Weights of one sign for `(first, second)` as shown left and right, of the other for the reverse.
fn weights(questions: &[(usize, Single)], weight: impl Fn(usize, Single) -> i64) -> BTreeMap<usize, i64> {
    questions.iter().map(|&(q, single)| (q, weight(q, single))).filter(|&(_, weight)| weight != 0).collect()
}

/// Every contrast that the study's questions allow, by family, then in the study's order.
///
/// `A-B` counts answers for A as positive; A is the code that a question shows on the left first. Interactions are
/// differences of two contrasts' mean scores, and those of one object against the others.
pub fn contrasts(study: &Study) -> Vec<Contrast> {
    let questions: Vec<(usize, Single)> =
        (0..study.comparisons.len()).filter_map(|q| single(study, q).map(|single| (q, single))).collect();
    let mut clusterings: Vec<(Clustering, Clustering)> = Vec::new();
    let mut arrangements: Vec<(Arrangement, Arrangement)> = Vec::new();
    for &(_, single) in &questions {
        match single {
            Single::Clustering { left, right, .. } => push_pair(&mut clusterings, left, right),
            Single::Arrangement { left, right, .. } => push_pair(&mut arrangements, left, right),
        }
    }
    let mut found = Vec::new();
    let mut add = |family, levels: [Level; 2], scope: String, over, weights: BTreeMap<usize, i64>| {
        let name = format!("{}-{}", levels[0].code(), levels[1].code());
        found.push(Contrast { family, name, scope, levels, over, weights });
    };
    for &(a, b) in &clusterings {
        let levels = [a, b].map(Level::Clustering);
        let sign = |single| match single {
            Single::Clustering { left, right, .. } => sign_of((a, b), (left, right)),
            Single::Arrangement { .. } => 0,
        };
        let inside = |single| match single {
            Single::Clustering { within, .. } => Some(within),
            Single::Arrangement { .. } => None,
        };
        add(Family::Pooled, levels, "all".into(), Over::All, weights(&questions, |_, s| sign(s)));
        let arrangements = &study.file.arrangements;
        for &arrangement in arrangements {
            let within = Level::Arrangement(arrangement);
            let here = weights(&questions, |_, s| if inside(s) == Some(arrangement) { sign(s) } else { 0 });
            add(Family::Groups, levels, format!("within {}", within.code()), Over::Within(within), here);
        }
        if let [first, second] = arrangements[..] {
            let parts = [first, second]
                .map(|of| weights(&questions, |_, s| i64::from(inside(s) == Some(of)) * sign(s)));
            let [first, second] = [first, second].map(Level::Arrangement);
            let scope = format!("{} - {}", first.code(), second.code());
            let over = Over::Difference(first, second);
            add(Family::Interactions, levels, scope, over, difference(&parts[0], &parts[1]));
        }
    }
    for &(a, b) in &arrangements {
        let levels = [a, b].map(Level::Arrangement);
        let sign = |single| match single {
            Single::Arrangement { left, right, .. } => sign_of((a, b), (left, right)),
            Single::Clustering { .. } => 0,
        };
        let inside = |single| match single {
            Single::Arrangement { within, .. } => Some(within),
            Single::Clustering { .. } => None,
        };
        let all = weights(&questions, |_, s| sign(s));
        add(Family::Pooled, levels, "all".into(), Over::All, all.clone());
        let of = |clustering: Clustering| {
            weights(&questions, |_, s| i64::from(inside(s) == Some(clustering)) * sign(s))
        };
        let clusterings = &study.file.clusterings;
        for (i, &clustering) in clusterings.iter().enumerate() {
            let within = Level::Clustering(clustering);
            let scope = format!("within {}", within.code());
            add(Family::Groups, levels, scope, Over::Within(within), of(clustering));
            for &other in &clusterings[i + 1..] {
                let second = Level::Clustering(other);
                let scope = format!("{} - {}", within.code(), second.code());
                let over = Over::Difference(within, second);
                add(Family::Interactions, levels, scope, over, difference(&of(clustering), &of(other)));
            }
        }
        for (o, object) in study.file.objects.iter().enumerate() {
            let here = |q: &usize| study.comparisons[*q].object == o;
            let (own, rest): (BTreeMap<_, _>, BTreeMap<_, _>) = all.iter().partition(|(q, _)| here(q));
            let (against, over) = (format!("{} - others", object.name), Over::AgainstOthers(o));
            add(Family::Objects, levels, object.name.clone(), Over::Object(o), own.clone());
            add(Family::Interactions, levels, against, over, difference(&own, &rest));
        }
    }
    found.retain(|contrast| !contrast.weights.is_empty());
    found.sort_by_key(|contrast| contrast.family);
    found
}

fn push_pair<T: PartialEq + Copy>(pairs: &mut Vec<(T, T)>, left: T, right: T) {
    if !pairs.contains(&(left, right)) && !pairs.contains(&(right, left)) {
        pairs.push((left, right));
    }
}

fn sign_of<T: PartialEq>((a, b): (T, T), (left, right): (T, T)) -> i64 {
    if left == a && right == b {
        1
    } else if left == b && right == a {
        -1
    } else {
        0
    }
}

/// The first mean minus the second as whole weights; empty if one side is.
fn difference(first: &BTreeMap<usize, i64>, second: &BTreeMap<usize, i64>) -> BTreeMap<usize, i64> {
    if first.is_empty() || second.is_empty() {
        return BTreeMap::new();
    }
    let (n, m) = (first.len() as i64, second.len() as i64);
    let divisor = (1..=n.min(m)).rev().find(|d| n % d == 0 && m % d == 0).unwrap_or(1);
    let plus = first.iter().map(|(&q, &weight)| (q, weight * m / divisor));
    plus.chain(second.iter().map(|(&q, &weight)| (q, -weight * n / divisor))).collect()
}

#[cfg(test)]
mod tests;
