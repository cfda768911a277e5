//! What was preferred to what: sorted by what holds, what depends on something else, and what is open.

use super::evidence::Evidence;
use super::finding::{over_all, score, tested};
use super::{names, tipping, worths};
use crate::statement::Block;
use crate::statement::{Finding, Standing};
use crate::words::{against, capital, counted, list, number, p};
use isostudy_design::Level;
use isostudy_design::Study;
use isostudy_design::contrast::{Over, contrasts};
use isostudy_inference::hypotheses::{self, Conclusion, Dependence, Hypothesis, On, Target};
use isostudy_inference::omnibus::{Asked, Omnibus};
use isostudy_statistics::ScoreTest;

/// So many comparisons that too few people lean on are told one by one, more of them together.
const APART: usize = 3;
/// Open dependences named at most; the table of tests has all.
const NAMED: usize = 4;

/// Blocks of three sections.
#[derive(Default)]
pub(super) struct Sorted {
    pub(super) holds: Vec<Block>,
    pub(super) depends: Vec<Block>,
    pub(super) open: Vec<Block>,
    too_few: Vec<TooFew>,
}

/// A comparison on which too few people lean one way or the other.
struct TooFew {
    place: usize,
    finding: Finding,
    name: String,
    leaning: usize,
}

impl Sorted {
    fn add(&mut self, evidence: &Evidence<'_>, hypothesis: &Hypothesis, finding: Finding) {
        match finding.standing {
            Standing::Holds | Standing::Equal => self.holds.push(Block::Finding(finding)),
            _ if matches!(hypothesis.conclusion(), Conclusion::TooFew | Conclusion::NobodyLeans) => {
                self.too_few.push(TooFew {
                    place: self.open.len() + self.too_few.len(),
                    finding,
                    name: names::hypothesis(evidence, hypothesis),
                    leaning: hypothesis.test.leaning(),
                });
            }
            _ => self.open.push(Block::Finding(finding)),
        }
    }

    /// Puts the comparisons that too few lean on among the open ones: in their place while they are few, else as one.
    fn fold(mut self, all: usize, level: f64) -> Self {
        let too_few = std::mem::take(&mut self.too_few);
        if too_few.len() <= APART {
            for TooFew { place, finding, .. } in too_few {
                self.open.insert(place, Block::Finding(finding));
            }
            return self;
        }
        let most = too_few.iter().map(|of| of.leaning).max().unwrap_or(0);
        let mut named: Vec<String> = too_few.iter().take(APART).map(|of| of.name.clone()).collect();
        named.push(format!("{} more", too_few.len() - APART));
        let text = format!(
            "{} of {} are not decided: {}. {} The table of tests has their counts.",
            too_few.len(),
            counted(all, "comparison"),
            list(&named),
            match most {
                0 => "Nobody leans one way or the other on any of them.".into(),
                most => format!(
                    "At most {} {} one way or the other, and no outcome of so few is significant (exact sign-flip test; {} \
                     would have to).",
                    counted(most, "participant"),
                    if most == 1 { "leans" } else { "lean" },
                    fewest_leaning(level)
                ),
            }
        );
        let standing = if most == 0 { Standing::Open } else { Standing::TooFew };
        self.open.push(Block::Finding(Finding::new(standing, text)));
        self
    }
}

/// The fewest people whose unanimity is significant.
fn fewest_leaning(level: f64) -> usize {
    (1..).find(|&people| 2.0_f64.powi(1 - people) <= level).expect("a power of a half") as usize
}

pub(super) fn findings(evidence: &Evidence<'_>) -> Sorted {
    let mut sorted = Sorted::default();
    let level = evidence.rules().level;
    let Some(study) = evidence.study else {
        return of_items(evidence, sorted, level);
    };
    sorted.holds.extend(levels_differ(study, evidence));
    let mut by_object = Vec::new();
    for (hypothesis, levels, over) in contrasts_of(evidence) {
        let [first, second] = levels.map(|level| names::level(study, level));
        let scope = names::over(study, over);
        match over {
            Over::Difference(..) | Over::ObjectDifference(..) => {}
            Over::Object(_) => {
                by_object.push(Block::Finding(preference(evidence, hypothesis, &first, &second, &scope)));
            }
            Over::All | Over::Within(_) => {
                let mut finding = preference(evidence, hypothesis, &first, &second, &scope);
                if let Some(shown) = depends_on_object(evidence, levels) {
                    caution(study, evidence, &mut finding, hypothesis, &shown);
                }
                sorted.add(evidence, hypothesis, finding);
            }
        }
    }
    sorted.depends.extend(dependences(evidence));
    sorted.depends.append(&mut by_object);
    let pooled = contrasts_of(evidence).filter(|(.., over)| matches!(over, Over::All | Over::Within(_)));
    sorted.fold(pooled.count(), level)
}

/// Of answers without a study.
fn of_items(evidence: &Evidence<'_>, mut sorted: Sorted, level: f64) -> Sorted {
    let (mut pooled, mut by_object) = (0, Vec::new());
    for hypothesis in evidence.hypotheses {
        let Target::Items { group, first, second, on } = &hypothesis.target else { continue };
        let scope = format!("{}{}", names::on_object(on), names::in_group(evidence, group));
        match on {
            On::All => {
                pooled += 1;
                let mut finding = preference(evidence, hypothesis, first, second, &scope);
                finding.text.push_str(&worths::beside(
                    evidence,
                    group,
                    [first, second],
                    hypothesis.differs(),
                ));
                let between = evidence.hypotheses.iter().filter(|of| {
                    let same = matches!(&of.target, Target::Items { group: own, on: On::Difference(_), .. } if own == group);
                    same && of.contrast == hypothesis.contrast && of.adjusted <= level
                });
                let clearest = between.min_by(|a, b| a.test.sign_flip.ln_p.total_cmp(&b.test.sign_flip.ln_p));
                if let Some(clearest) = clearest {
                    let shown = tested(clearest);
                    finding.text.push_str(&format!(" The preference depends on the object ({shown})."));
                }
                sorted.add(evidence, hypothesis, finding);
            }
            On::Object(_) => {
                by_object.push(Block::Finding(preference(evidence, hypothesis, first, second, &scope)));
            }
            On::Difference(_) => {}
        }
    }
    sorted.depends.extend(dependences(evidence));
    sorted.depends.append(&mut by_object);
    sorted.fold(pooled, level)
}

/// What one test of a preference says, and what a liking for a side means for it.
fn preference(
    evidence: &Evidence<'_>,
    hypothesis: &Hypothesis,
    first: &str,
    second: &str,
    scope: &str,
) -> Finding {
    let mut finding = Finding::of_preference(hypothesis, first, second, scope);
    if finding.standing == Standing::Holds {
        finding.text.push_str(&tipping::sentence(evidence, hypothesis));
    }
    finding
}

/// Every contrast that was tested.
fn contrasts_of<'a>(evidence: &'a Evidence<'_>) -> impl Iterator<Item = (&'a Hypothesis, [Level; 2], Over)> {
    hypotheses::contrasts_of(evidence.hypotheses)
}

/// What shows that a preference depends on the object, in words; `None` if nothing does.
pub(super) fn depends_on_object(evidence: &Evidence<'_>, levels: [Level; 2]) -> Option<String> {
    let level = evidence.rules().level;
    let found = hypotheses::depends_on_object(evidence.hypotheses, evidence.omnibus, levels, level)?;
    Some(match found {
        Dependence::Omnibus(of) => {
            format!("Friedman's test over objects, {} after Holm's correction", p(of.adjusted))
        }
        Dependence::Difference(of) => tested(of),
    })
}

/// What is said of all objects together where a preference depends on the object.
fn caution(
    study: &Study,
    evidence: &Evidence<'_>,
    finding: &mut Finding,
    hypothesis: &Hypothesis,
    shown: &str,
) {
    match finding.standing {
        Standing::Holds => {
            finding.text.push_str(&format!(" It depends on the object ({shown})."));
            finding.text.push_str(&without_one_object(study, evidence, hypothesis));
        }
        Standing::Open | Standing::TooFew => {
            finding.text.push_str(&format!(" The preference depends on the object ({shown})."));
        }
        _ => {}
    }
}

/// Whether any one object is what an overall preference rests on.
fn without_one_object(study: &Study, evidence: &Evidence<'_>, hypothesis: &Hypothesis) -> String {
    let all = contrasts(study);
    let Some(contrast) = all
        .iter()
        .find(|c| (&c.name, &c.scope) == (&hypothesis.contrast, &hypothesis.scope) && !c.is_difference())
    else {
        return String::new();
    };
    let mut text = String::new();
    for (o, object) in study.file.objects.iter().enumerate() {
        let off = |question: usize| study.comparisons[question].object != o;
        let on = contrast.parts[0].keys().any(|&question| !off(question));
        let signed = evidence.declared.iter().filter(|b| off(b.question())).filter_map(|b| {
            let sign = contrast.parts[0].get(&b.question())?;
            Some((b.participant(), sign * b.preference().sign()))
        });
        let rest = ScoreTest::of(signed);
        if !on || rest.participants() == 0 {
            continue;
        }
        let p_rest = p(rest.sign_flip.p());
        let level = evidence.rules().level;
        let same_way = (hypothesis.test.mean > 0.0) == (rest.mean > 0.0);
        match (rest.sign_flip.p() <= level, same_way) {
            (true, true) => {}
            (true, false) => {
                text.push_str(&format!(" Without the {} it is the other way round ({p_rest}).", object.name));
            }
            (false, _) => {
                let left = lower(&score(&rest, true));
                text.push_str(&format!(" Without the {} it is not shown: {left}; {p_rest}.", object.name));
            }
        }
    }
    text
}

fn levels_differ(study: &Study, evidence: &Evidence<'_>) -> Vec<Block> {
    let level = evidence.rules().level;
    let shown = evidence.omnibus.iter().filter(|of| of.adjusted <= level);
    let text = |of: &Omnibus| {
        let Asked::Levels(factor) = of.asked else { return None };
        let noun = &study.factor(factor).plural;
        Some(format!(
            "The {noun} are not liked alike: Friedman's test on {}' wins less losses, chi-square {:.2} on {} degrees of \
             freedom, {}.",
            counted(of.participants, "participant"),
            of.test.statistic,
            of.test.degrees,
            p(of.test.p)
        ))
    };
    shown.filter_map(text).map(|text| Block::Finding(Finding::new(Standing::Holds, text))).collect()
}

/// Interactions: one that holds is told with its parts, those that do not in one sentence.
fn dependences(evidence: &Evidence<'_>) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Vec<&Hypothesis> = Vec::new();
    let mut untold = 0;
    for hypothesis in evidence.hypotheses.iter().filter(|of| of.is_tested() && of.is_difference()) {
        match hypothesis.conclusion() {
            Conclusion::TooFew | Conclusion::NobodyLeans => {
                untold += 1;
                continue;
            }
            _ if !hypothesis.differs() => {
                open.push(hypothesis);
                continue;
            }
            _ => {}
        }
        blocks.extend(dependence(evidence, hypothesis).map(Block::Finding));
    }
    if let Some(smallest) = open.iter().map(|h| h.adjusted).min_by(f64::total_cmp) {
        let mut names: Vec<String> =
            open.iter().take(NAMED).map(|h| names::hypothesis(evidence, h)).collect();
        if open.len() > NAMED {
            names.push(format!("{} more", open.len() - NAMED));
        }
        let text = format!(
            "For {} no difference was shown: {} (exact sign-flip tests, smallest corrected {}). That is not to say that there is \
             none.",
            match open.len() {
                1 => "one other dependence that was looked for".into(),
                n => format!("{n} other dependences that were looked for"),
            },
            list(&names),
            p(smallest)
        );
        blocks.push(Block::Finding(Finding::new(Standing::Open, text)));
    }
    if untold > 0 {
        let dependences = match untold {
            1 => "1 dependence".into(),
            n => format!("{n} dependences"),
        };
        let text = format!(
            "{dependences} could not have been shown: too few people lean one way or the other for any outcome to be significant."
        );
        blocks.push(Block::Finding(Finding::new(Standing::TooFew, text)));
    }
    blocks
}

/// Parts of a difference that are farther apart than this are about different things, see [`ScoreTest::apart`].
const OTHER_OBJECTS: f64 = 0.1;

/// A difference that holds, with the two preferences that differ. `None` if one of them was not tested.
fn dependence(evidence: &Evidence<'_>, hypothesis: &Hypothesis) -> Option<Finding> {
    let ([first, second], [(here, own), (there, rest)]) = parts(evidence, hypothesis)?;
    let part = |place: &str, test: &ScoreTest| {
        format!(
            "{}: {}, mean score {}",
            capital(place.trim_start()),
            against(test.counts.unwrap_or_default()),
            number(test.mean, 2)
        )
    };
    let within = match hypothesis.conclusion() {
        Conclusion::DiffersWithinMargin => " It is smaller than the margin.",
        _ => "",
    };
    let (standing, holds) = match hypothesis.test.apart > OTHER_OBJECTS {
        true => (
            Standing::NotAnswerable,
            "The two parts were asked about different objects, of most people or all, so that objects may make the difference",
        ),
        false => (Standing::Holds, "The difference holds"),
    };
    let text = format!(
        "How much {first} is preferred to {second} differs. {}. {}. {holds}: {}.{within}{}",
        part(&here, own),
        part(&there, rest),
        tested(hypothesis),
        over_all(hypothesis)
    );
    let text = match standing {
        Standing::Holds => text + &tipping::sentence(evidence, hypothesis),
        _ => text,
    };
    Some(Finding::new(standing, text))
}

/// What two preferences are called, and where each of them is, with its test.
type Parts<'a> = ([String; 2], [(String, &'a ScoreTest); 2]);

/// The two preferences that a difference is of.
fn parts<'a>(evidence: &'a Evidence<'_>, hypothesis: &Hypothesis) -> Option<Parts<'a>> {
    let test_of = |target: Target| {
        evidence.hypotheses.iter().find(|of| of.is_tested() && of.target == target).map(|of| &of.test)
    };
    match (&hypothesis.target, evidence.study) {
        (Target::Contrast { levels, over }, Some(study)) => {
            let (a, b) = match *over {
                Over::Difference(a, b) => (Over::Within(a), Over::Within(b)),
                Over::ObjectDifference(a, b) => (Over::Object(a), Over::Object(b)),
                _ => return None,
            };
            let part =
                |over| Some((names::over(study, over), test_of(Target::Contrast { levels: *levels, over })?));
            Some((levels.map(|level| names::level(study, level)), [part(a)?, part(b)?]))
        }
        (Target::Items { group, first, second, on: On::Difference(objects) }, _) => {
            let part = |object: &String| {
                let on = On::Object(object.clone());
                let place = format!("{}{}", names::on_object(&on), names::in_group(evidence, group));
                let [group, first, second] = [group, first, second].map(String::clone);
                Some((place, test_of(Target::Items { group, first, second, on })?))
            };
            let [a, b] = objects;
            Some(([first.clone(), second.clone()], [part(a)?, part(b)?]))
        }
        _ => None,
    }
}

fn lower(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_lowercase().chain(letters).collect())
}
