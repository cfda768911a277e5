//! What of the analysis is a choice, who made it when, and what would come out under another choice.

use super::evidence::Evidence;
use super::names;
use crate::statement::Block;
use crate::statement::{Finding, Standing};
use crate::words::{counted, list, p};
use isostudy_design::Study;
use isostudy_design::config::{Declaration, FamilyRule, StoppingBoundary};
use isostudy_inference::hypotheses::Hypothesis;

pub(super) fn findings(evidence: &Evidence<'_>) -> Vec<Block> {
    let mut found = vec![match evidence.study {
        Some(study) => of_study(study, evidence),
        None => Finding::new(
            Standing::Noted,
            "No study declares how these answers are analysed. Level 0.05, margin 0.2 and the families of tests are fixed in \
             the program."
                .to_owned(),
        ),
    }];
    found.extend(evidence.study.and_then(|study| look(study, evidence)));
    found.extend(over_all(evidence));
    found.into_iter().map(Block::Finding).collect()
}

fn of_study(study: &Study, evidence: &Evidence<'_>) -> Finding {
    let section = &study.file.analysis;
    let when = match section.declaration(None) {
        Declaration::Undeclared => {
            "The study does not say when its analysis was fixed, so nothing rules out that it was fitted to the answers.".into()
        }
        Declaration::BeforeAnswers { declared, first_answer } => {
            let same_day = match declared == first_answer {
                true => " Nothing says which of the two came first on that day.",
                false => "",
            };
            format!("The analysis was fixed on {declared}, and the first answer was given on {first_answer}.{same_day}")
        }
        Declaration::AfterAnswers { declared, first_answer: Some(first) } => format!(
            "The analysis was fixed on {declared}, after the first answer of {first}. Its choices could have been fitted to the answers."
        ),
        Declaration::AfterAnswers { declared, first_answer: None } => format!(
            "The analysis was fixed on {declared}, when the answers were known. Its choices could have been fitted to them."
        ),
        Declaration::Unknown { declared } => format!(
            "The analysis was fixed on {declared}. Nothing says when the first answer was given."
        ),
    };
    let families = match section.families {
        FamilyRule::ByKind => "each kind of contrast is corrected by itself",
        FamilyRule::One => "all contrasts are corrected together",
    };
    let primary = match section.primary.len() {
        0 => String::new(),
        _ => format!(" Primary contrasts, corrected first and apart: {}.", list(&section.primary)),
    };
    let exclude = match section.exclude.len() {
        0 => "Everybody counts.".to_owned(),
        _ => {
            let rules: Vec<&str> = section.exclude.iter().map(|rule| rule.code()).collect();
            format!(
                "Left out: {} who broke {} {}.",
                counted(evidence.excluded, "participant"),
                if rules.len() == 1 { "the rule" } else { "one of the rules" },
                list(&rules)
            )
        }
    };
    let text = format!(
        "{when} It uses level {} and margin {}; {families}.{primary} {exclude} SHA-256 of the study file: {}.",
        section.level, section.margin, study.sha256
    );
    Finding::new(Standing::Noted, text)
}

/// Which planned look these answers are, and what it asks for.
fn look(study: &Study, evidence: &Evidence<'_>) -> Option<Finding> {
    let section = &study.file.analysis;
    let rule = section.stopping.as_ref()?;
    let look = evidence.hypotheses.iter().find_map(|of| of.look.as_ref())?;
    let needed: Vec<String> = rule.looks.iter().map(ToString::to_string).collect();
    let boundary = match rule.boundary {
        StoppingBoundary::OBrienFleming => "O'Brien and Fleming's",
        StoppingBoundary::Pocock => "Pocock's",
    };
    let text = format!(
        "The study planned {} at {} participants, by {boundary} boundary. These answers are look {}. p of primary contrasts is the \
         repeated p of this look: one test alone reaches level {} there with {}.",
        counted(look.planned(), "look"),
        list(&needed),
        look.number(),
        section.level,
        p(look.nominal(section.level)),
    );
    Some(Finding::new(Standing::Noted, text))
}

/// What one correction over all tests leaves of the results.
fn over_all(evidence: &Evidence<'_>) -> Option<Finding> {
    let tested: Vec<&Hypothesis> =
        evidence.hypotheses.iter().filter(|h| h.is_tested() && !h.is_question()).collect();
    let holding: Vec<&&Hypothesis> = tested.iter().filter(|h| h.differs()).collect();
    let lost: Vec<&&&Hypothesis> =
        holding.iter().filter(|h| h.adjusted_over_all.is_some_and(|p| p > h.rules.level)).collect();
    if holding.is_empty() || tested.len() < 2 {
        return None;
    }
    let results = counted(holding.len(), "result");
    let verb = if holding.len() == 1 { "holds" } else { "hold" };
    Some(match lost.is_empty() {
        true => {
            let text = format!(
                "With one correction over all {} (Holm), the {results} that {verb} still {verb}.",
                counted(tested.len(), "test")
            );
            Finding::new(Standing::Holds, text)
        }
        false => {
            let names: Vec<String> = lost
                .iter()
                .map(|h| {
                    format!("{} ({})", names::hypothesis(evidence, h), p(h.adjusted_over_all.unwrap_or(1.0)))
                })
                .collect();
            let text = format!(
                "Of the {results} that {verb}, {} would not with one correction over all {} (Holm): {}.",
                lost.len(),
                counted(tested.len(), "test"),
                list(&names)
            );
            Finding::new(Standing::Open, text)
        }
    })
}
