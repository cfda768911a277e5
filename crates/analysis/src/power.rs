//! How likely a study is to find a preference that is there, before anyone is asked.
//!
//! The study's own forms are answered by simulated people, and each study is tested as [`statistics`](statistics)
//! tests a real one: exact sign-flip over participants, two-sided at 5 %, with and without adjustment in its family.
//! What is found must be what was assumed: a rejection in favour of the wrong one is none.
//!
//! In every contrast the first property is ahead by the same number of logits. Each person deviates by an own amount for
//! each arrangement and each clustering, and so does each object, for everybody; two properties' deviations differ by the
//! given standard deviation. The tests are about the study's own objects: a preference that is there on these alone is
//! found as well. Answers follow Davidson's model. Controls, repeats and training are left out, as in the tests.

#[cfg(test)]
mod tests;

use design::Study;
use design::contrast::{Contrast, Family, Level, contrasts};
use design::forms::{Questionnaire, Role};
use rand::Rng;
use rayon::prelude::*;
use statistics::simulation::{davidson, draw, normal, stream};
use statistics::{Outcome, benjamini_hochberg, holm, sign_flip_of_counts};
use std::collections::BTreeMap;

/// Level of the tests.
const ALPHA: f64 = 0.05;

/// What is assumed of people, and what is simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Assumptions {
    /// Numbers of participants, from small to large.
    pub participants: Vec<usize>,
    /// Shares of decided answers for the first of two properties, by a person who does not deviate; above 0 and below 1.
    pub shares: Vec<f64>,
    /// Standard deviation between people of the difference of two properties, in logits.
    pub person_sd: f64,
    /// Standard deviation between objects of the same.
    pub object_sd: f64,
    /// Davidson's tie parameter nu: two equal items tie with chance nu / (2 + nu).
    pub ties: f64,
    /// Studies to simulate for each share.
    pub studies: u64,
    /// Seed; the same seed gives the same numbers on any number of threads.
    pub seed: u64,
}

/// Power of one contrast.
#[derive(Debug, Clone, PartialEq)]
pub struct Power {
    /// The family within which p is adjusted, as in the tests of a study.
    pub family: &'static str,
    /// What is compared, such as `U-I`.
    pub contrast: String,
    /// Over which answers, such as `within B`; or the question.
    pub scope: String,
    /// Questions about it.
    pub questions: usize,
    /// Participants.
    pub participants: usize,
    /// Assumed share of decided answers for the first.
    pub share: f64,
    /// Share of the studies that found it, unadjusted; at a share of 0.5, that found either.
    pub power: f64,
    /// The same, adjusted in its family: Holm's adjustment, for single questions Benjamini and Hochberg's.
    pub adjusted: f64,
    /// Studies simulated.
    pub studies: u64,
}

impl Power {
    /// Monte-Carlo standard errors of [`Power::power`] and [`Power::adjusted`], with two studies more that found it and two
    /// that did not (Agresti and Coull 1998), so that they are not 0 where all studies ended alike.
    pub fn errors(&self) -> [f64; 2] {
        let studies = self.studies as f64 + 4.0;
        [self.power, self.adjusted].map(|share| {
            let near = (share * self.studies as f64 + 2.0) / studies;
            (near * (1.0 - near) / studies).sqrt()
        })
    }
}

/// One hypothesis of the design.
struct Target {
    family: &'static str,
    contrast: String,
    scope: String,
    /// Question index to weight.
    weights: BTreeMap<usize, i64>,
}

/// A question that differs in one property.
#[derive(Clone, Copy)]
struct Question {
    object: usize,
    /// Its two properties, by index; the first is the one assumed to be ahead.
    levels: [usize; 2],
    /// 1 if the first is on the left as listed, -1 if on the right.
    sign: i64,
}

struct Setting {
    targets: Vec<Target>,
    /// By question; `None` if two properties differ, which no contrast is about.
    questions: Vec<Option<Question>>,
    /// Questions by participant.
    forms: Vec<Vec<usize>>,
    levels: usize,
    objects: usize,
}

/// Power of every contrast and question of the study's forms; `None` for a study without forms or comparisons.
///
/// `done` is called with one after each simulated study, from any thread.
///
/// # Panics
/// If there are no participants to simulate, or their numbers do not ascend.
pub fn power(study: &Study, assumptions: &Assumptions, done: &(dyn Fn() + Sync)) -> Option<Vec<Power>> {
    let numbers = &assumptions.participants;
    assert!(numbers.is_sorted() && numbers.first().is_some_and(|&least| least > 0));
    let setting = Setting::of(study, *numbers.last()?)?;
    let places = numbers.len() * setting.targets.len();
    let mut all = Vec::new();
    for (place, &share) in assumptions.shares.iter().enumerate() {
        let first = place as u64 * assumptions.studies;
        let add = |mut a: Vec<[u64; 2]>, b: Vec<[u64; 2]>| {
            a.iter_mut().zip(b).for_each(|(a, b)| (0..2).for_each(|i| a[i] += b[i]));
            a
        };
        let rejected = (0..assumptions.studies)
            .into_par_iter()
            .map(|number| {
                let found = setting.study(share, assumptions, &mut stream(assumptions.seed, first + number));
                done();
                found
            })
            .reduce(|| vec![[0; 2]; places], add);
        let share_of = |count: u64| count as f64 / assumptions.studies as f64;
        for (target, rejected) in setting.targets.iter().zip(rejected.chunks(numbers.len())) {
            for (&participants, &[plain, adjusted]) in numbers.iter().zip(rejected) {
                all.push(Power {
                    family: target.family,
                    contrast: target.contrast.clone(),
                    scope: target.scope.clone(),
                    questions: target.weights.len(),
                    participants,
                    share,
                    power: share_of(plain),
                    adjusted: share_of(adjusted),
                    studies: assumptions.studies,
                });
            }
        }
    }
    Some(all)
}

impl Setting {
    fn of(study: &Study, participants: usize) -> Option<Self> {
        let questionnaire = Questionnaire::of(study)?;
        let form = |participant| {
            let asked = questionnaire.form(participant).trials.into_iter();
            asked.filter(|t| t.role == Role::Comparison).filter_map(|t| t.comparison).collect()
        };
        let all = contrasts(study);
        let mut levels: Vec<Level> = Vec::new();
        let mut questions = vec![None; study.comparisons.len()];
        for contrast in all.iter().filter(|contrast| contrast.family == Family::Pooled) {
            let place = contrast.levels.map(|level| {
                levels.iter().position(|&known| known == level).unwrap_or_else(|| {
                    levels.push(level);
                    levels.len() - 1
                })
            });
            for (&question, &sign) in &contrast.weights {
                let object = study.comparisons[question].object;
                questions[question] = Some(Question { object, levels: place, sign });
            }
        }
        Some(Self {
            targets: targets(study, all, &questions),
            questions,
            forms: (0..participants).map(form).collect(),
            levels: levels.len(),
            objects: study.file.objects.len(),
        })
    }

    /// One simulated study: by target and number of participants, whether p and adjusted p reject.
    fn study(&self, share: f64, assumptions: &Assumptions, random: &mut impl Rng) -> Vec<[u64; 2]> {
        let ahead = (share / (1.0 - share)).ln();
        let mut deviations = |sd: f64, count: usize| -> Vec<f64> {
            // Two independent deviations of sd / sqrt(2) differ by sd.
            (0..count).map(|_| sd / std::f64::consts::SQRT_2 * normal(random)).collect()
        };
        let of_objects = deviations(assumptions.object_sd, self.objects * self.levels);
        let of_people = deviations(assumptions.person_sd, self.forms.len() * self.levels);
        let numbers = &assumptions.participants;
        let mut p = vec![(1.0, false); numbers.len() * self.targets.len()];
        // By target: how many participants have each difference.
        let mut counts: Vec<BTreeMap<i64, u64>> = vec![BTreeMap::new(); self.targets.len()];
        let mut signs = vec![None; self.questions.len()];
        let mut place = 0;
        for (participant, form) in self.forms.iter().enumerate() {
            signs.fill(None);
            for &question in form {
                let Some(Question { object, levels: [a, b], sign }) = self.questions[question] else {
                    continue;
                };
                let [person, object] = [(&of_people, participant), (&of_objects, object)].map(|(of, i)| {
                    let own = &of[i * self.levels..(i + 1) * self.levels];
                    own[a] - own[b]
                });
                let outcome = draw(davidson(ahead + person + object, assumptions.ties), random);
                signs[question] = Some(sign * Outcome::sign(outcome));
            }
            for (target, counts) in self.targets.iter().zip(&mut counts) {
                let answered = target.weights.iter().filter_map(|(&q, weight)| Some(weight * signs[q]?));
                let (answers, difference) = answered.fold((0, 0), |(n, sum), signed| (n + 1, sum + signed));
                if answers > 0 {
                    *counts.entry(difference).or_default() += 1;
                }
            }
            while numbers.get(place) == Some(&(participant + 1)) {
                for (target, counts) in counts.iter().enumerate() {
                    let test = sign_flip_of_counts(counts);
                    // For the wrong one: it takes its place in the adjustment, and is not counted.
                    let wrong = ahead * (test.net as f64) < 0.0;
                    p[target * numbers.len() + place] = (test.p(), wrong);
                }
                place += 1;
            }
        }
        self.rejected(&p, numbers.len())
    }

    /// Of each p, and whether it speaks for the wrong one: whether it is a find, unadjusted and adjusted.
    fn rejected(&self, p: &[(f64, bool)], numbers: usize) -> Vec<[u64; 2]> {
        let found = |p: f64, wrong: bool| u64::from(p <= ALPHA && !wrong);
        let mut rejected: Vec<[u64; 2]> = p.iter().map(|&(p, wrong)| [found(p, wrong), 0]).collect();
        for place in 0..numbers {
            let mut begin = 0;
            for family in self.targets.chunk_by(|a, b| a.family == b.family) {
                let members = (begin..begin + family.len()).map(|target| target * numbers + place);
                let of_family: Vec<f64> = members.clone().map(|i| p[i].0).collect();
                let adjusted = if family[0].family == QUESTIONS {
                    benjamini_hochberg(&of_family)
                } else {
                    holm(&of_family)
                };
                members.zip(adjusted).for_each(|(i, adjusted)| rejected[i][1] = found(adjusted, p[i].1));
                begin += family.len();
            }
        }
        rejected
    }
}

/// The family of single questions.
pub(crate) const QUESTIONS: &str = "questions";

/// The contrasts but interactions, for which one share for all contrasts would mean that there are none; then each question.
fn targets(study: &Study, contrasts: Vec<Contrast>, questions: &[Option<Question>]) -> Vec<Target> {
    let of_contrast = |c: Contrast| Target {
        family: c.family.code(),
        contrast: c.name,
        scope: c.scope,
        weights: c.weights,
    };
    let kept = contrasts.into_iter().filter(|contrast| contrast.family != Family::Interactions);
    let mut targets: Vec<Target> = kept.map(of_contrast).collect();
    for (q, question) in questions.iter().enumerate() {
        let Some(Question { sign, .. }) = question else { continue };
        let comparison = &study.comparisons[q];
        targets.push(Target {
            family: QUESTIONS,
            contrast: format!("{}-{}", comparison.left.method, comparison.right.method),
            scope: comparison.question.clone(),
            weights: BTreeMap::from([(q, *sign)]),
        });
    }
    targets
}
