//! What was preferred to what: first what was shown, then what was not. The table of contrasts has every row.

use super::evidence::Evidence;
use super::finding::{self, of_contrast};
use super::{names, sides, tipping, worths};
use crate::standing::Standing;
use crate::statement::{Block, Finding};
use crate::words::{against, capital, counted, list, p};
use isostudy_design::Study;
use isostudy_design::contrast::{Over, contrasts};
use isostudy_inference::conclusions::{Conclusion, Limit, Verdict, Why};
use isostudy_inference::glance::Row;
use isostudy_inference::hypotheses::{Hypothesis, On, Target};
use isostudy_inference::omnibus::{Asked, Omnibus};
use isostudy_statistics::ScoreTest;

/// Sentences of one kind at most; the table has all.
const MOST: usize = 12;
/// So many contrasts that nothing was shown of are told one by one, more of them together.
const APART: usize = 8;
/// Contrasts named in one sentence at most.
const NAMED: usize = 4;

/// A contrast, and what was found of it.
type Found<'a> = (&'a Row, &'a Conclusion);

pub(super) fn findings(evidence: &Evidence<'_>) -> Vec<Block> {
    let Some(preferences) = evidence.preferences else { return Vec::new() };
    let mut found: Vec<Finding> =
        evidence.study.map_or_else(Vec::new, |study| levels_differ(study, evidence));
    let all = preferences.concluded();
    // By how much a contrast is about: over all answers, over a part of them, on one object.
    let kinds = [Kind::Whole, Kind::Part, Kind::OnOneObject];
    let is_difference = |of: &&Found<'_>| of.0.is_difference;
    let (differences, preferences): (Vec<Found<'_>>, Vec<Found<'_>>) = all.iter().partition(is_difference);
    let is_shown = |of: &&Found<'_>| of.1.holds() || of.1.verdict == Verdict::Equal;
    let mut open = Vec::new();
    for kind in kinds {
        let own = preferences.iter().filter(|of| Kind::of(evidence, of.0) == kind);
        let (shown, not): (Vec<&Found<'_>>, Vec<&Found<'_>>) = own.partition(is_shown);
        let total = shown.len() + not.len();
        found.extend(told(&shown, "results", |of| preference(evidence, of)));
        open.extend(not_shown(evidence, &not, &format!("{}{}", counted(total, "comparison"), kind.place())));
    }
    let (shown, not): (Vec<&Found<'_>>, Vec<&Found<'_>>) =
        differences.iter().partition(|(_, of)| of.holds() || of.is_limited(Limit::OtherObjects));
    found.extend(told(&shown, "differences", |of| difference(evidence, of)));
    open.extend(not_shown(evidence, &not, &counted(differences.len(), "difference")));
    let blocks = found.into_iter().chain(open).map(Block::Finding);
    sides::sides_and_methods(evidence).into_iter().chain(blocks).collect()
}

/// What contrasts are counted together.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Whole,
    Part,
    OnOneObject,
}

impl Kind {
    fn of(evidence: &Evidence<'_>, row: &Row) -> Self {
        match &evidence.hypotheses[row.hypothesis].target {
            Target::Contrast { over: Over::Object(_), .. } | Target::Items { on: On::Object(_), .. } => {
                Self::OnOneObject
            }
            _ if row.is_whole => Self::Whole,
            _ => Self::Part,
        }
    }

    /// Said after how many there are.
    fn place(self) -> &'static str {
        match self {
            Self::Whole => "",
            Self::Part => " within one level each",
            Self::OnOneObject => " on one object each",
        }
    }
}

/// A sentence each, and how many more there are.
fn told(shown: &[&Found<'_>], noun: &str, one: impl Fn(&Found<'_>) -> Finding) -> Vec<Finding> {
    let mut found: Vec<Finding> = shown.iter().take(MOST).map(|of| one(of)).collect();
    if shown.len() > MOST {
        let text = format!("The table of contrasts has {} more {noun} like these.", shown.len() - MOST);
        found.push(Finding::new(Standing::Noted, text));
    }
    found
}

/// What was shown of a preference, what else the scale says, and whether one object makes it.
fn preference(evidence: &Evidence<'_>, &(row, found): &Found<'_>) -> Finding {
    let hypothesis = &evidence.hypotheses[row.hypothesis];
    let mut finding = of_contrast(evidence, row, found);
    if let Some(study) = evidence.study.filter(|_| found.holds() && found.is_limited(Limit::DependsOnObject))
    {
        finding.text.push_str(&without_one_object(study, evidence, hypothesis));
    }
    finding
}

/// Those of which nothing was shown: a few one by one, more of them together.
fn not_shown(evidence: &Evidence<'_>, not: &[&Found<'_>], of_all: &str) -> Vec<Finding> {
    let is_too_few =
        |of: &&&Found<'_>| matches!(of.1.verdict, Verdict::NotJudged(Why::TooFew | Why::NobodyLeans));
    let (too_few, open): (Vec<&Found<'_>>, Vec<&Found<'_>>) =
        not.iter().copied().partition(|of| is_too_few(&of));
    let mut found = Vec::new();
    let are_differences = not.iter().all(|of| of.0.is_difference);
    if open.len() <= APART && !are_differences {
        found.extend(open.iter().map(|&&(row, of)| {
            let mut finding = of_contrast(evidence, row, of);
            if let Target::Items { group, first, second, on: On::All } =
                &evidence.hypotheses[row.hypothesis].target
            {
                finding.text.push_str(&worths::beside(evidence, group, [first, second]));
            }
            finding
        }));
    } else if let Some(smallest) = open.iter().map(|of| of.0.adjusted).min_by(f64::total_cmp) {
        let text = format!(
            "Nothing was shown of {} of {of_all}: {} (smallest adjusted {}). That is not to say that there is nothing.",
            open.len(),
            named(evidence, &open),
            p(smallest)
        );
        found.push(Finding::new(Standing::Open, text));
    }
    if too_few.len() <= APART && !are_differences {
        found.extend(too_few.iter().map(|&&(row, of)| of_contrast(evidence, row, of)));
    } else if !too_few.is_empty() {
        let leaning = too_few.iter().map(|of| evidence.hypotheses[of.0.hypothesis].test.leaning());
        let text = format!(
            "{} of {of_all} are not decided: {}. {}",
            too_few.len(),
            named(evidence, &too_few),
            match leaning.max().unwrap_or(0) {
                0 => "Nobody leans one way or the other on any of them.".into(),
                most => format!(
                    "At most {} {} one way or the other, and no outcome of fewer than {} is significant.",
                    counted(most, "participant"),
                    if most == 1 { "leans" } else { "lean" },
                    fewest_leaning(evidence.rules().level)
                ),
            }
        );
        let nobody = too_few.iter().all(|of| of.1.verdict == Verdict::NotJudged(Why::NobodyLeans));
        found.push(Finding::new(if nobody { Standing::Open } else { Standing::TooFew }, text));
    }
    found
}

fn named(evidence: &Evidence<'_>, all: &[&Found<'_>]) -> String {
    let name = |of: &&Found<'_>| names::hypothesis(evidence, &evidence.hypotheses[of.0.hypothesis]);
    let mut names: Vec<String> = all.iter().take(NAMED).map(name).collect();
    if all.len() > NAMED {
        names.push(format!("{} more", all.len() - NAMED));
    }
    list(&names)
}

/// The fewest people whose unanimity is significant.
fn fewest_leaning(level: f64) -> usize {
    (1..).find(|&people| 2.0_f64.powi(1 - people) <= level).expect("a power of a half") as usize
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
                text.push_str(&format!(" Without the {} it is not shown ({p_rest}).", object.name));
            }
        }
    }
    text
}

fn levels_differ(study: &Study, evidence: &Evidence<'_>) -> Vec<Finding> {
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
    shown.filter_map(text).map(|text| Finding::new(Standing::Holds, text)).collect()
}

/// A difference that was shown, with the two preferences that differ.
fn difference(evidence: &Evidence<'_>, &(row, found): &Found<'_>) -> Finding {
    let hypothesis = &evidence.hypotheses[row.hypothesis];
    let [first, second] = &row.things;
    let parts = parts(evidence, hypothesis).map_or(String::new(), |parts| {
        let part = |(place, of): &(String, &Hypothesis)| {
            let mut counts = of.test.counts.unwrap_or_default();
            // As the names stand in the table.
            if is_turned(evidence, row, of) {
                counts.reverse();
            }
            format!("{}: {}", capital(place.trim_start()), against(counts))
        };
        format!(" {}.", parts.iter().map(part).collect::<Vec<_>>().join(". "))
    });
    let holds = match found.is_limited(Limit::OtherObjects) {
        true => {
            " The two parts were asked about different objects, of most people or all, so that objects may make the difference"
        }
        false => " The difference holds",
    };
    let mut text = format!(
        "How much {first} is preferred to {second} differs.{parts}{holds} (adjusted {}).",
        p(hypothesis.adjusted)
    );
    if found.is_limited(Limit::WithinMargin) {
        text.push_str(" It is smaller than the margin.");
    }
    text.push_str(&finding::over_all(hypothesis, found));
    if found.holds() {
        text.push_str(&tipping::sentence(evidence, hypothesis));
    }
    Finding::new(Standing::of(found), text)
}

/// Whether a row of the table shows what a hypothesis compares the other way round.
fn is_turned(evidence: &Evidence<'_>, row: &Row, of: &Hypothesis) -> bool {
    match (&of.target, evidence.study) {
        (Target::Contrast { levels, .. }, Some(study)) => row.things[0] != names::level(study, levels[0]),
        (Target::Items { first, .. }, _) => row.things[0] != *first,
        _ => false,
    }
}

/// The two preferences that a difference is of, and where each of them is; `None` if one of them was not tested.
fn parts<'a>(evidence: &'a Evidence<'_>, hypothesis: &Hypothesis) -> Option<[(String, &'a Hypothesis); 2]> {
    let of_target =
        |target: Target| evidence.hypotheses.iter().find(|of| of.is_tested() && of.target == target);
    let targets = match &hypothesis.target {
        Target::Contrast { levels, over } => {
            let (a, b) = match *over {
                Over::Difference(a, b) => (Over::Within(a), Over::Within(b)),
                Over::ObjectDifference(a, b) => (Over::Object(a), Over::Object(b)),
                _ => return None,
            };
            [a, b].map(|over| Target::Contrast { levels: *levels, over })
        }
        Target::Items { group, first, second, on: On::Difference(objects) } => {
            objects.each_ref().map(|object| Target::Items {
                group: group.clone(),
                first: first.clone(),
                second: second.clone(),
                on: On::Object(object.clone()),
            })
        }
        _ => return None,
    };
    let part = |target: Target| {
        let of = of_target(target)?;
        Some((finding::scope(evidence, of), of))
    };
    let [a, b] = targets;
    Some([part(a)?, part(b)?])
}
