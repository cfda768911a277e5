//! What a questionnaire may leave out, and what its author should know: no fault, and said all the same.

use crate::config::{AboutKind, FormsSection};
use crate::study::Study;

/// What participants are not told of their rights, and what may name them, a sentence each. None for a study that asks nobody.
pub fn notices(study: &Study) -> Vec<String> {
    study.file.forms.as_ref().map_or_else(Vec::new, |forms| [unsaid(forms), private(forms)].concat())
}

fn unsaid(forms: &FormsSection) -> Vec<String> {
    [
        (forms.contact.is_none(), "forms.contact is missing: participants are not told whom they can ask"),
        (
            forms.ethics.is_none(),
            "forms.ethics is missing: participants are not told who has approved the study",
        ),
        (
            forms.least_age.is_none(),
            "forms.least_age is missing: participants are not told how old they must be",
        ),
        (
            forms.retention_days.is_none(),
            "forms.retention_days is missing: participants are not told for how long answers are kept",
        ),
    ]
    .into_iter()
    .filter(|(is_missing, _)| *is_missing)
    .map(|(_, text)| text.to_owned())
    .collect()
}

fn private(forms: &FormsSection) -> Vec<String> {
    let asks = forms.about.iter().filter(|about| about.kind == AboutKind::Text);
    let mut said: Vec<String> = asks
        .map(|about| {
            format!(
                "privacy: the question {} takes words, in which people may name themselves or others",
                about.id
            )
        })
        .collect();
    if forms.comment {
        said.push("privacy: forms.comment takes words, in which people may name themselves or others".into());
    }
    if !said.is_empty() {
        said.push(
            "privacy: `isostudy deidentify` never writes such words; who shares them has to read them first"
                .into(),
        );
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::tests::load;

    #[test]
    fn what_is_not_said_is_asked_for_and_words_are_warned_of() {
        let mut study = load("balanced.toml");
        let about =
            |study: &Study, word: &str| notices(study).iter().filter(|text| text.contains(word)).count();
        assert_eq!((about(&study, "is missing"), about(&study, "privacy")), (4, 0));
        let forms = study.file.forms.as_mut().unwrap();
        forms.contact = Some("study@example.org".into());
        forms.retention_days = Some(30);
        forms.comment = true;
        assert_eq!((about(&study, "is missing"), about(&study, "privacy")), (2, 2));
        study.file.forms = None;
        assert_eq!(notices(&study), [""; 0]);
    }
}
