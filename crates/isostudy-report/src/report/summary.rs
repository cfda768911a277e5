//! The abstract: six lines that say what was compared, by whom, what came out, how sure it is, what limits it, and what
//! to do next.

use super::evidence::Evidence;
use super::told::{self, named};
use super::{SummaryLine, asked, limits};
use crate::region;
use crate::wants;
use crate::words::{capital, counted, list, number, of_all};
use isostudy_design::record::Purpose;
use isostudy_design::{Factor, Method, Study};
use isostudy_inference::Preferences;
use isostudy_inference::conclusions::{About, Conclusion, Verdict, Why};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::{MeshSet, known};
use isostudy_inference::preference::two_factors;
use isostudy_inference::results::Results;

/// A share of the decided answers on one side from which on the side, not what stood there, decides much.
const LARGE_SIDE: f64 = 0.6;

/// `inputs` are those of a study.
pub(super) fn lines(evidence: &Evidence<'_>, results: Option<&Results<'_>>) -> Vec<SummaryLine> {
    let inputs = results.map(|of| &of.inputs);
    let of_meshes = match results.map(told::best) {
        Some(best) if evidence.shown.is_empty() && !best.is_empty() => best,
        _ => inputs.and_then(regular).into_iter().collect(),
    };
    let answers = evidence.preferences.map_or_else(Vec::new, |of| told::sentences(of, results));
    let found: Vec<String> = answers.into_iter().chain(of_meshes).collect();
    let lines = [
        ("Compared", Some(compared(evidence))),
        ("By whom", Some(people(evidence))),
        ("Found", (!found.is_empty()).then(|| found.join(" "))),
        ("How sure", sure(evidence)),
        ("Times", inputs.and_then(wants::busy)),
        ("Limits", Some(limits::short(evidence))),
        ("Next", Some(next(evidence))),
    ];
    let line = |(label, text): (&'static str, Option<String>)| text.map(|text| SummaryLine { label, text });
    lines.into_iter().filter_map(line).collect()
}

fn compared(evidence: &Evidence<'_>) -> String {
    let Some(study) = evidence.study else {
        let mut items: Vec<&str> =
            evidence.groups.iter().flat_map(|group| &group.items).map(String::as_str).collect();
        items.sort_unstable();
        items.dedup();
        return format!("{}: {}.", capital(&counted(items.len(), "item")), named(&items));
    };
    let objects: Vec<&str> = study.file.objects.iter().map(|object| object.name.as_str()).collect();
    let on = format!("{} ({})", counted(objects.len(), "object"), named(&objects));
    // Files of a study's own may show anything.
    let kind = if study.shown_files().is_some() { "" } else { " of isosurface extraction" };
    let methods = counted(study.methods.len(), "method");
    format!("{methods}{kind} on {on}. They are {}.", which(study))
}

/// The methods in words: crossed factors by their levels, others by their labels.
fn which(study: &Study) -> String {
    let phrases = |factor: Factor| -> Vec<&str> {
        study.levels(factor).into_iter().map(|level| study.level(level).phrase.as_str()).collect()
    };
    if let Some([outer, inner]) = two_factors(study) {
        let [outer, inner] = [phrases(outer), phrases(inner)];
        if outer.len() * inner.len() == study.methods.len() {
            return format!("{}, each on {}", list(&inner), list(&outer));
        }
    }
    let labels: Vec<&str> = study.methods.iter().map(|method: &Method| method.label.as_str()).collect();
    named(&labels)
}

fn people(evidence: &Evidence<'_>) -> String {
    let answers = evidence.shown.len();
    if answers == 0 {
        return "Nobody's answers are analysed.".into();
    }
    let mut text = format!(
        "{} gave {} to {} about pairs.",
        capital(&counted(evidence.participants(), "participant")),
        counted(answers, "answer"),
        counted(evidence.questions(), "question")
    );
    match evidence.study.and_then(asked::instruction) {
        Some(asked) => text.push_str(&format!(" They were asked: {}", asked::ended(asked))),
        None => text.push_str(" The source files do not say what they were asked."),
    }
    text
}

/// The method whose triangles are the most regular, over all objects.
fn regular(inputs: &Inputs<'_>) -> Option<String> {
    let study = inputs.study;
    let meshes = MeshSet::of(inputs, Purpose::Benchmark);
    let mean = |method: &Method| {
        let ratio = |object| known(&meshes.at(object, method.id)?.judged().quality.radius_ratio, |d| d.mean);
        let all: Option<Vec<f64>> = (0..study.file.objects.len()).map(ratio).collect();
        all.map(|all| all.iter().sum::<f64>() / all.len() as f64)
    };
    let means: Vec<(f64, &Method)> =
        study.methods.iter().filter_map(|method| Some((mean(method)?, method))).collect();
    if means.len() < 2 {
        return None;
    }
    let best = means.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let worst = means.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let part = region::alone(study).map_or(String::new(), |alone| format!(" {alone}"));
    Some(format!(
        "{} has the most regular triangles{part}: its mean radius ratio is {}, and that of {} is {} (1 is equilateral).",
        capital(&best.1.label),
        number(best.0, 2),
        worst.1.label,
        number(worst.0, 2)
    ))
}

/// What the results survive.
fn sure(evidence: &Evidence<'_>) -> Option<String> {
    let tested = || evidence.hypotheses.iter().filter(|h| h.is_tested() && !h.is_question());
    tested().next()?;
    let holding: Vec<_> = tested().filter(|h| h.differs()).collect();
    let survive = holding.iter().filter(|h| h.adjusted_over_all.is_none_or(|p| p <= h.rules.level)).count();
    let survive = match (survive, holding.len()) {
        (_, 0) => String::new(),
        (1, 1) => " It also holds with one correction over all tests.".into(),
        (0, 1) => " It does not hold with one correction over all tests.".into(),
        (of, _) => {
            let verb = if of == 1 { "holds" } else { "hold" };
            format!(" {of} of these also {verb} with one correction over all tests.")
        }
    };
    Some(format!(
        "{} at the level of {}, with the person as the unit and p adjusted within families.{survive}",
        of_all(holding.len(), tested().count(), "contrast", ["holds", "hold"]),
        evidence.rules().level
    ))
}

/// Whether people's tastes were shown to differ, by more than any two items do on average.
fn differ_more_than_items(preferences: &Preferences<'_>) -> bool {
    let found = &preferences.conclusions;
    let is_shown = found.about(About::People).is_some_and(Conclusion::holds);
    is_shown && found.spread.is_some_and(|spread| spread.of.sd > spread.largest_difference)
}

fn next(evidence: &Evidence<'_>) -> String {
    let concluded = evidence.preferences.map_or_else(Vec::new, Preferences::concluded);
    // Where nobody leans, more people who do not lean change nothing.
    let is_undecided =
        |of: &Conclusion| matches!(of.verdict, Verdict::Undecided | Verdict::NotJudged(Why::TooFew));
    let undecided = concluded.iter().filter(|(_, of)| is_undecided(of)).count();
    if evidence.shown.is_empty() {
        return "Ask people: isostudy design power says how many, and isostudy bundle makes what they see."
            .into();
    }
    // More answers of people who answer by the side would not help.
    let is_large =
        evidence.preferences.and_then(told::side_share).is_some_and(|(_, share)| share >= LARGE_SIDE);
    if evidence.is_side_favoured() && is_large {
        return "Find out why people answer by the side before you ask more of them: look at the page, the instruction and the \
                people who broke a rule."
            .into();
    }
    if limits::sides_are_confounded(evidence) {
        return "Ask new people with the sides of each pair exchanged for half of them: configs/balanced.toml is such a \
                study."
            .into();
    }
    if evidence.preferences.is_some_and(differ_more_than_items) {
        return "Find out who likes what: people differ more than what they saw does, and more of the same people would not decide \
                it. Ask them about themselves, and compare those who answer alike."
            .into();
    }
    if undecided > 0 && evidence.study.is_none() {
        let (contrasts, stay) =
            (capital(&counted(undecided, "contrast")), if undecided == 1 { "stays" } else { "stay" });
        let them = if undecided == 1 { "it" } else { "them" };
        return format!("{contrasts} {stay} undecided: more people may decide {them}.");
    }
    if undecided > 0 {
        return format!(
            "{} {} undecided: isostudy design power says how many people would decide {}.",
            capital(&counted(undecided, "contrast")),
            if undecided == 1 { "stays" } else { "stay" },
            if undecided == 1 { "it" } else { "them" }
        );
    }
    "Ask about other objects: these results are about the ones that were shown.".into()
}
