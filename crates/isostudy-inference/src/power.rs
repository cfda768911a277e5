//! How likely a study is to find a preference that is there, before anyone is asked.
//!
//! The study's own forms are answered by simulated people, and each study is judged as a real one: exact sign-flip over
//! participants, two-sided, corrected in its family, at the study's level. Contrasts, families and corrections are those of the
//! analysis. What is found must be what was assumed: a rejection in favour of the wrong one is none. How often the test alone,
//! without its correction, would reject is counted beside it.
//!
//! In every contrast the first property is ahead by the same number of logits. Each person deviates by an own amount for
//! each arrangement, each clustering and each method that is compared as one, and so does each object, for everybody; two
//! properties' deviations differ by the given standard deviation. The tests are about the study's own objects: a preference that is there on these alone is
//! found as well. Answers follow Davidson's model, or that of another [`Way`] to ask, with a bonus for the left side: who sees which side
//! comes from the forms.
//! Controls, repeats and training are left out, as in the tests. Nobody is excluded.

mod scores;
mod spread;
#[cfg(test)]
mod tests;
mod ways;

pub use spread::{Spread, spread_between_people};
pub use ways::Way;

use crate::series::{Part, Series};
use isostudy_design::Level;
use isostudy_design::Study;
use isostudy_design::contrast::{Contrast, Family, Over, PRIMARY, contrasts, families};
use isostudy_design::forms::{Questionnaire, Role};
use isostudy_statistics::simulation::{normal, stream};
use isostudy_statistics::{SignFlip, benjamini_hochberg, holm, sign_flip_of_counts};
use rand::Rng;
use scores::weights;
use std::collections::BTreeMap;

/// What is assumed of people, and what is simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Assumptions {
    /// Numbers of participants, from small to large.
    pub participants: Vec<usize>,
    /// Shares of decided answers for the first of two properties, by a person who does not deviate; above 0 and below 1.
    pub shares: Vec<f64>,
    /// Bonuses of the left side, in logits; 0 for people who do not care for sides.
    pub side_biases: Vec<f64>,
    /// Standard deviation between people of the difference of two properties, in logits.
    pub person_sd: f64,
    /// Standard deviation between objects of the same.
    pub object_sd: f64,
    /// Davidson's tie parameter nu: two equal items tie with chance nu / (2 + nu).
    pub ties: f64,
    /// How people are asked. Their scores are of what an answer counts, in every way.
    pub way: Way,
    /// Studies to simulate for each share.
    pub studies: u64,
    /// Seed; the same seed gives the same numbers on any number of threads.
    pub seed: u64,
}

/// Power of one contrast.
#[derive(Debug, Clone, PartialEq)]
pub struct Power {
    /// The family within which p is adjusted, as in the tests of a study.
    pub family: String,
    /// What the contrasts of the family are over, in words.
    pub over: String,
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
    /// Assumed bonus of the left side, in logits.
    pub side_bias: f64,
    /// Share of the studies that found it as they are judged, corrected in its family: by Holm's correction, for single questions by
    /// Benjamini and Hochberg's. At a share of 0.5, the share that found either.
    pub corrected: f64,
    /// Share in which the test alone would have found it.
    pub uncorrected: f64,
    /// Level of the tests.
    pub level: f64,
    /// Studies simulated.
    pub studies: u64,
}

impl Power {
    /// Monte-Carlo standard errors of [`Power::corrected`] and [`Power::uncorrected`], with two studies more that found it and two
    /// that did not (Agresti and Coull 1998), so that they are not 0 where all studies ended alike.
    pub fn errors(&self) -> [f64; 2] {
        let studies = self.studies as f64 + 4.0;
        [self.corrected, self.uncorrected].map(|share| {
            let near = (share * self.studies as f64 + 2.0) / studies;
            (near * (1.0 - near) / studies).sqrt()
        })
    }
}

/// One hypothesis of the design.
struct Target {
    family: String,
    over: String,
    contrast: String,
    scope: String,
    /// Questions about it.
    questions: usize,
    /// By block what is asked about it: question and weight. Weighted answers add up to a participant's score, in a unit that
    /// makes every score whole.
    weights: Vec<Vec<(usize, i64)>>,
    /// Whether its power is told. Differences are simulated for the sake of their family alone: one share for all contrasts
    /// means that there are none.
    told: bool,
}

/// Targets whose p values are corrected together, which follow one another.
struct Correction {
    size: usize,
    of: fn(&[f64]) -> Vec<f64>,
}

/// A question: what it compares.
#[derive(Clone, Copy)]
struct Question {
    object: usize,
    /// Its two levels, by index; the first is the one assumed to be ahead.
    levels: [usize; 2],
    /// 1 if the first is on the left as listed, -1 if on the right.
    sign: i64,
}

/// A question as the first form of its block asks it.
struct Asked {
    question: usize,
    /// 1 if the first of its two levels is on the left, -1 if on the right.
    first: f64,
}

struct Setting {
    /// Level of the tests.
    level: f64,
    targets: Vec<Target>,
    corrections: Vec<Correction>,
    questions: Vec<Question>,
    /// Questions by block. Participants are dealt blocks in turn.
    blocks: Vec<Vec<Asked>>,
    /// By participant, 1 if sides are as in the first form of the block, -1 if they are exchanged.
    mirrored: Vec<f64>,
    levels: usize,
    objects: usize,
}

/// Power of every contrast and question of the study's forms; `None` for a study without forms or comparisons.
///
/// `done` is called with one after each simulated study, from any thread.
///
/// # Panics
/// As [`simulated`].
pub fn power(study: &Study, assumptions: &Assumptions, done: &(dyn Fn() + Sync)) -> Option<Vec<Power>> {
    powers(study, assumptions, &simulated(study, assumptions, Part::WHOLE, done)?)
}

/// Simulates a part of the studies: a series for each share and bonus, which counts rejections without and with correction, by target
/// and number of participants. `None` and `done` as in [`power`].
///
/// # Panics
/// If there are no participants to simulate, or their numbers do not ascend.
pub fn simulated(
    study: &Study,
    assumptions: &Assumptions,
    part: Part,
    done: &(dyn Fn() + Sync),
) -> Option<Vec<Series>> {
    let numbers = &assumptions.participants;
    assert!(numbers.is_sorted() && numbers.first().is_some_and(|&least| least > 0));
    let setting = Setting::of(study, numbers.last().copied().unwrap_or(0))?;
    let simulated = cases(assumptions).zip(setting.blank(assumptions)).map(|(case, blank)| {
        blank.count(part, |number| {
            let mut stream = stream(assumptions.seed, case.first + number);
            let rejected = setting.study([case.share, case.side_bias], assumptions, &mut stream);
            done();
            rejected.concat()
        })
    });
    Some(simulated.collect())
}

/// The series of [`simulated`] with nothing counted; `None` as there.
pub fn blank(study: &Study, assumptions: &Assumptions) -> Option<Vec<Series>> {
    Some(Setting::of(study, 0)?.blank(assumptions))
}

/// Power of whole series as [`simulated`] makes them with the same study and assumptions; `None` as there.
///
/// # Panics
/// If they are others.
pub fn powers(study: &Study, assumptions: &Assumptions, series: &[Series]) -> Option<Vec<Power>> {
    let setting = Setting::of(study, 0)?;
    let numbers = &assumptions.participants;
    let share_of = |count: u64| count as f64 / assumptions.studies as f64;
    let mut all = Vec::new();
    for (case, series) in cases(assumptions).zip(series) {
        let rejected = series.counts.chunks(2 * numbers.len());
        let told = setting.targets.iter().zip(rejected).filter(|(target, _)| target.told);
        for (target, rejected) in told {
            for (&participants, rejected) in numbers.iter().zip(rejected.chunks(2)) {
                all.push(Power {
                    family: target.family.clone(),
                    over: target.over.clone(),
                    contrast: target.contrast.clone(),
                    scope: target.scope.clone(),
                    questions: target.questions,
                    participants,
                    share: case.share,
                    side_bias: case.side_bias,
                    corrected: share_of(rejected[1]),
                    uncorrected: share_of(rejected[0]),
                    level: setting.level,
                    studies: assumptions.studies,
                });
            }
        }
    }
    Some(all)
}

/// What is assumed of one series of studies.
struct Case {
    share: f64,
    side_bias: f64,
    /// Number of its first study's stream of random numbers.
    first: u64,
}

/// Each share with each bonus of a side.
fn cases(assumptions: &Assumptions) -> impl Iterator<Item = Case> {
    assumptions.shares.iter().enumerate().flat_map(|(place, &share)| {
        // The same people for every bonus of a side: what differs between them is the bonus.
        let first = place as u64 * assumptions.studies;
        assumptions.side_biases.iter().map(move |&side_bias| Case { share, side_bias, first })
    })
}

/// What the contrasts of a family are over, in words.
fn over(study: &Study, family: Family) -> String {
    match family {
        Family::Pooled => "all answers".into(),
        Family::Methods => "methods as a whole".into(),
        Family::Objects(factor) => format!("{} on one object", study.factor(factor).plural),
        Family::Groups | Family::Interactions | Family::ObjectPairs(_) => {
            let names: Vec<&str> =
                study.declared_factors().map(|factor| study.factor(factor).name.as_str()).collect();
            format!("within one {}", names.join(" or "))
        }
    }
}

impl Setting {
    /// For up to so many people.
    fn of(study: &Study, people: usize) -> Option<Self> {
        let questionnaire = Questionnaire::of(study)?;
        // Question, and whether its sides are as listed.
        let block = |block| -> Vec<(usize, bool)> {
            let form = questionnaire.form(block);
            let asked = form.trials.iter().filter(|t| t.role == Role::Comparison);
            let pairs: Vec<(usize, bool)> = asked
                .filter_map(|t| t.comparison.map(|q| (q, t.shown[0] == study.comparisons[q].left)))
                .collect();
            match pairs.is_empty() {
                // Where nobody is asked about pairs, answers about two follow from others, and nothing has sides.
                true => form.comparisons(study).into_iter().map(|question| (question, true)).collect(),
                false => pairs,
            }
        };
        let listed: Vec<Vec<(usize, bool)>> = (0..questionnaire.blocks()).map(block).collect();
        let questions_of = |asked: &Vec<(usize, bool)>| asked.iter().map(|&(question, _)| question).collect();
        let blocks: Vec<Vec<usize>> = listed.iter().map(questions_of).collect();
        let all = contrasts(study);
        let mut levels: Vec<Level> = Vec::new();
        let mut questions = vec![Question { object: 0, levels: [0; 2], sign: 1 }; study.comparisons.len()];
        // Every question is in one of these.
        for contrast in all.iter().filter(|contrast| contrast.over == Over::All) {
            let place = contrast.levels.map(|level| {
                levels.iter().position(|&known| known == level).unwrap_or_else(|| {
                    levels.push(level);
                    levels.len() - 1
                })
            });
            for (&question, &sign) in &contrast.weights {
                let object = study.comparisons[question].object;
                questions[question] = Question { object, levels: place, sign };
            }
        }
        let (mut targets, mut corrections) = (Vec::new(), Vec::new());
        for family in families(&all, &study.file.analysis) {
            let members: Vec<&Contrast> = family.members.iter().map(|&i| &all[i]).collect();
            if members.iter().all(|contrast| contrast.is_difference()) {
                continue;
            }
            corrections.push(Correction { size: members.len(), of: holm });
            targets.extend(members.into_iter().map(|contrast| Target {
                family: if family.name == PRIMARY { PRIMARY.into() } else { contrast.family_name.clone() },
                over: if family.name == PRIMARY {
                    "primary contrasts".into()
                } else {
                    over(study, contrast.family)
                },
                contrast: contrast.name.clone(),
                scope: contrast.scope.clone(),
                questions: contrast.weights.len(),
                weights: weights(study, contrast, &blocks),
                told: !contrast.is_difference(),
            }));
        }
        corrections.push(Correction { size: questions.len(), of: benjamini_hochberg });
        targets.extend(study.comparisons.iter().enumerate().map(|(q, comparison)| {
            let own = |block: &Vec<usize>| {
                block.contains(&q).then_some((q, questions[q].sign)).into_iter().collect()
            };
            Target {
                family: QUESTIONS.into(),
                over: "one question alone".into(),
                contrast: format!("{}-{}", comparison.left.method, comparison.right.method),
                scope: comparison.question.clone(),
                questions: 1,
                weights: blocks.iter().map(own).collect(),
                told: true,
            }
        }));
        let asked = |&(question, as_listed): &(usize, bool)| {
            let sign = questions[question].sign as f64;
            Asked { question, first: if as_listed { sign } else { -sign } }
        };
        let turned = |participant| if questionnaire.is_mirrored(participant) { -1.0 } else { 1.0 };
        Some(Self {
            level: study.file.analysis.level,
            targets,
            corrections,
            blocks: listed.iter().map(|block| block.iter().map(asked).collect()).collect(),
            mirrored: (0..people).map(turned).collect(),
            questions,
            levels: levels.len(),
            objects: study.file.objects.len(),
        })
    }

    /// What [`simulated`] counts, with nothing counted.
    fn blank(&self, assumptions: &Assumptions) -> Vec<Series> {
        let things = 2 * assumptions.participants.len() * self.targets.len();
        let name = |case: &Case| format!("share {}, liking for the left side {}", case.share, case.side_bias);
        cases(assumptions).map(|case| Series::blank(name(&case), assumptions.studies, things)).collect()
    }

    /// One simulated study: by target and number of participants, whether p and adjusted p reject.
    fn study(
        &self,
        [share, side_bias]: [f64; 2],
        assumptions: &Assumptions,
        random: &mut impl Rng,
    ) -> Vec<[u64; 2]> {
        let ahead = (share / (1.0 - share)).ln();
        let numbers = &assumptions.participants;
        let people = numbers.last().copied().unwrap_or(0);
        let mut deviations = |sd: f64, count: usize| -> Vec<f64> {
            // Two independent deviations of sd / sqrt(2) differ by sd.
            (0..count).map(|_| sd / std::f64::consts::SQRT_2 * normal(random)).collect()
        };
        let of_objects = deviations(assumptions.object_sd, self.objects * self.levels);
        let of_people = deviations(assumptions.person_sd, people * self.levels);
        let mut rejected = vec![[0; 2]; numbers.len() * self.targets.len()];
        // By target: how many participants have each score.
        let mut counts: Vec<BTreeMap<i64, u64>> = vec![BTreeMap::new(); self.targets.len()];
        let mut signs = vec![0; self.questions.len()];
        let mut place = 0;
        for participant in 0..people {
            let block = participant % self.blocks.len();
            for &Asked { question, first } in &self.blocks[block] {
                let Question { object, levels: [a, b], sign } = self.questions[question];
                let [person, object] = [(&of_people, participant), (&of_objects, object)].map(|(of, i)| {
                    let own = &of[i * self.levels..(i + 1) * self.levels];
                    own[a] - own[b]
                });
                let side = side_bias * first * self.mirrored[participant];
                let counts = assumptions.way.answer(ahead + person + object + side, assumptions.ties, random);
                signs[question] = sign * counts;
            }
            for (target, counts) in self.targets.iter().zip(&mut counts) {
                let asked = &target.weights[block];
                if !asked.is_empty() {
                    let score = asked.iter().map(|&(question, weight)| weight * signs[question]).sum();
                    *counts.entry(score).or_default() += 1;
                }
            }
            while numbers.get(place) == Some(&(participant + 1)) {
                let test =
                    |counts: &BTreeMap<i64, u64>| (!counts.is_empty()).then(|| sign_flip_of_counts(counts));
                let tests: Vec<Option<SignFlip>> = counts.iter().map(test).collect();
                let p: Vec<Option<f64>> = tests.iter().map(|test| test.map(|test| test.p())).collect();
                let adjusted = self.adjusted(&p);
                for (target, test) in tests.into_iter().enumerate() {
                    // For the wrong one: it takes its place in the adjustment, and is not counted.
                    let wrong = test.is_none_or(|test| ahead * (test.net as f64) < 0.0);
                    let found = |p: Option<f64>| u64::from(p.is_some_and(|p| p <= self.level && !wrong));
                    rejected[target * numbers.len() + place] = [p[target], adjusted[target]].map(found);
                }
                place += 1;
            }
        }
        rejected
    }

    /// p by target, adjusted within each correction. What nobody was asked is not among the tests.
    fn adjusted(&self, p: &[Option<f64>]) -> Vec<Option<f64>> {
        let mut adjusted = vec![None; p.len()];
        let mut begin = 0;
        for correction in &self.corrections {
            let members = begin..begin + correction.size;
            let tested: Vec<(usize, f64)> = members.filter_map(|target| Some((target, p[target]?))).collect();
            let of_tested = (correction.of)(&tested.iter().map(|&(_, p)| p).collect::<Vec<_>>());
            tested.iter().zip(of_tested).for_each(|(&(target, _), p)| adjusted[target] = Some(p));
            begin += correction.size;
        }
        adjusted
    }
}

/// The family of single questions.
pub const QUESTIONS: &str = "questions";
