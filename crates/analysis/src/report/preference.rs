//! What was preferred to what: sorted by what holds, what depends on something else, and what is open.

use super::finding::{Finding, Standing, score, tested};
use super::words::{against, capital, counted, list, number, p};
use super::{Block, Evidence, names};
use crate::hypotheses::{ALPHA, Hypothesis, Subject};
use crate::tables::contrasts::study_scores;
use design::Study;
use statistics::contrast::{ContrastTest, Level, Over, contrasts};
use statistics::friedman;

/// So many comparisons that too few people lean on are told one by one, more of them together.
const APART: usize = 3;

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
            Standing::TooFew => self.too_few.push(TooFew {
                place: self.open.len() + self.too_few.len(),
                finding,
                name: names::hypothesis(evidence, hypothesis),
                leaning: hypothesis.test.leaning(),
            }),
            _ => self.open.push(Block::Finding(finding)),
        }
    }

    /// Puts the comparisons that too few lean on among the open ones: in their place while they are few, else as one.
    fn fold(mut self, all: usize) -> Self {
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
                    fewest_leaning()
                ),
            }
        );
        self.open.push(Block::Finding(Finding::new(Standing::TooFew, text)));
        self
    }
}

pub(super) fn findings(evidence: &Evidence<'_>) -> Sorted {
    let mut sorted = Sorted::default();
    let Some(study) = evidence.study else {
        for hypothesis in evidence.hypotheses {
            if let Subject::Items { group, first, second } = &hypothesis.subject {
                let scope = names::in_group(evidence, group);
                let finding = Finding::of_preference(hypothesis, first, second, &scope);
                sorted.add(evidence, hypothesis, finding);
            }
        }
        return sorted.fold(evidence.hypotheses.len());
    };
    sorted.holds.extend(omnibus(study, evidence));
    for (hypothesis, levels, over) in contrasts_of(evidence) {
        let [first, second] = levels.map(names::level);
        match over {
            Over::Difference(..) | Over::AgainstOthers(_) => {}
            Over::Object(_) => {
                let finding = Finding::of_preference(hypothesis, first, second, &names::over(study, over));
                sorted.depends.push(Block::Finding(finding));
            }
            Over::All | Over::Within(_) => {
                let mut finding =
                    Finding::of_preference(hypothesis, first, second, &names::over(study, over));
                let object = (over == Over::All).then(|| standing_out(evidence, levels)).flatten();
                if let (Standing::Holds, Some((_, object))) = (finding.standing, object) {
                    let name = &study.file.objects[object].name;
                    finding
                        .text
                        .push_str(&format!(" It depends on the object, the {name} above all: see below."));
                }
                sorted.add(evidence, hypothesis, finding);
            }
        }
    }
    let mut by_object = std::mem::take(&mut sorted.depends);
    sorted.depends.extend(dependences(study, evidence));
    sorted.depends.append(&mut by_object);
    sorted
        .fold(contrasts_of(evidence).filter(|(.., over)| matches!(over, Over::All | Over::Within(_))).count())
}

fn contrasts_of<'a>(evidence: &'a Evidence<'_>) -> impl Iterator<Item = (&'a Hypothesis, [Level; 2], Over)> {
    evidence.hypotheses.iter().filter_map(|h| match h.subject {
        Subject::Contrast { levels, over } => Some((h, levels, over)),
        _ => None,
    })
}

/// The object whose preference differs most clearly from the others', if any does.
fn standing_out<'a>(evidence: &'a Evidence<'_>, levels: [Level; 2]) -> Option<(&'a Hypothesis, usize)> {
    let of = contrasts_of(evidence).filter_map(|(h, l, over)| match over {
        Over::AgainstOthers(object) if l == levels && h.adjusted <= ALPHA => Some((h, object)),
        _ => None,
    });
    of.min_by(|(a, _), (b, _)| a.test.sign_flip.ln_p.total_cmp(&b.test.sign_flip.ln_p))
}

fn omnibus(study: &Study, evidence: &Evidence<'_>) -> Vec<Block> {
    let clusterings = study_scores(study, evidence.ballots).clusterings;
    let Some(test) = friedman(&clusterings).filter(|test| test.p <= ALPHA) else { return Vec::new() };
    let text = format!(
        "The clusterings are not liked alike: Friedman's test on {}' wins less losses, chi-square {:.2} on {} degrees of \
         freedom, {}.",
        counted(clusterings.len(), "participant"),
        test.statistic,
        test.degrees,
        p(test.p)
    );
    vec![Block::Finding(Finding::new(Standing::Holds, text))]
}

/// The fewest people whose unanimity is significant at 5 %.
fn fewest_leaning() -> usize {
    (1..).find(|&people| 2.0_f64.powi(1 - people) <= ALPHA).expect("a power of a half") as usize
}

/// Interactions: one that holds is told with its parts, those that do not in one sentence.
fn dependences(study: &Study, evidence: &Evidence<'_>) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Vec<&Hypothesis> = Vec::new();
    for (hypothesis, levels, over) in contrasts_of(evidence) {
        match over {
            Over::Difference(..) | Over::AgainstOthers(_) if hypothesis.adjusted > ALPHA => {
                open.push(hypothesis)
            }
            Over::Difference(a, b) => {
                let parts = [a, b].map(|level| {
                    let part =
                        contrasts_of(evidence).find(|(_, l, o)| *l == levels && *o == Over::Within(level));
                    part.map(|(part, ..)| (names::within(level), &part.test))
                });
                if let [Some((at_a, a)), Some((at_b, b))] = parts {
                    blocks.push(Block::Finding(dependence(hypothesis, levels, (&at_a, a), (&at_b, b))));
                }
            }
            Over::AgainstOthers(object) => {
                let Some((own, rest)) = on_and_off(study, evidence, levels, object) else { continue };
                let here = format!(" on the {}", study.file.objects[object].name);
                let first = standing_out(evidence, levels).is_some_and(|(_, o)| o == object);
                let mut finding = dependence(hypothesis, levels, (&here, &own), (" elsewhere", &rest));
                if first {
                    finding.text.push_str(&without(study, evidence, levels, object, &rest));
                }
                blocks.push(Block::Finding(finding));
            }
            _ => {}
        }
    }
    if let Some(smallest) = open.iter().map(|h| h.adjusted).min_by(f64::total_cmp) {
        let names: Vec<String> = open.iter().map(|h| names::hypothesis(evidence, h)).collect();
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
    blocks
}

fn dependence(
    hypothesis: &Hypothesis,
    levels: [Level; 2],
    (here, own): (&str, &ContrastTest),
    (there, rest): (&str, &ContrastTest),
) -> Finding {
    let [first, second] = levels.map(names::level);
    let part = |place: &str, test: &ContrastTest| {
        format!(
            "{}: {}, mean score {}",
            capital(place.trim_start()),
            against(test.counts.unwrap_or_default()),
            number(test.mean, 2)
        )
    };
    let text = format!(
        "How much {first} is preferred to {second} differs. {}. {}. The difference holds: {}.",
        part(here, own),
        part(there, rest),
        tested(hypothesis)
    );
    Finding::new(Standing::Holds, text)
}

/// The contrast on one object and on all others.
fn on_and_off(
    study: &Study,
    evidence: &Evidence<'_>,
    levels: [Level; 2],
    object: usize,
) -> Option<(ContrastTest, ContrastTest)> {
    let all = contrasts(study).into_iter().find(|c| c.levels == levels && c.over == Over::All)?;
    let of = |on: bool| {
        let weight = |b: &&statistics::ShownBallot| (study.comparisons[b.question()].object == object) == on;
        let own = evidence.ballots.iter().filter(weight);
        ContrastTest::of(
            own.filter_map(|b| Some((b.participant(), *all.weights.get(&b.question())?, b.outcome()))),
        )
    };
    Some((of(true), of(false)))
}

/// What is left of an overall preference without the object that stands out.
fn without(
    study: &Study,
    evidence: &Evidence<'_>,
    levels: [Level; 2],
    object: usize,
    rest: &ContrastTest,
) -> String {
    let pooled = contrasts_of(evidence).find(|(_, l, over)| *l == levels && *over == Over::All);
    let Some((pooled, ..)) = pooled.filter(|(h, ..)| h.adjusted <= ALPHA) else { return String::new() };
    let name = &study.file.objects[object].name;
    let same_way = pooled.test.sign_flip.net.signum() == rest.sign_flip.net.signum();
    let p = p(rest.sign_flip.p());
    match (rest.sign_flip.p() <= ALPHA, same_way) {
        (true, true) => format!(" Without the {name} the overall preference still holds ({p})."),
        (true, false) => format!(" Without the {name} the preference is the other way round ({p})."),
        (false, _) => {
            format!(" Without the {name} the overall preference is gone: {}; {p}.", lower(&score(rest, true)))
        }
    }
}

fn lower(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_lowercase().chain(letters).collect())
}
