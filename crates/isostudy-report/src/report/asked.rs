//! What a study asked, and how many answers it asked for: what was not asked is not missing.

use isostudy_design::Study;
use isostudy_design::forms::{Questionnaire, Role};
use isostudy_inference::answered::Answered;

/// What people were asked about each pair, as far as the study says it.
pub(super) fn instruction(study: &Study) -> Option<&str> {
    let of_answers = study.file.responses.as_ref().and_then(|section| section.asked.as_deref());
    of_answers.or_else(|| study.file.forms.as_ref().map(|forms| forms.prompt.as_str()))
}

/// A text with a full stop, unless it ends a sentence already.
pub(super) fn ended(text: &str) -> String {
    let end = if text.ends_with(['.', '?', '!']) { "" } else { "." };
    format!("{text}{end}")
}

/// The comparisons on the forms of those who count. Where the file names nobody, what was asked is what was answered. Whose form is not known was asked what was answered, where questions are
/// dealt into blocks, and everything elsewhere.
pub(super) fn asked(study: &Study, answered: &Answered) -> usize {
    // Of ratings and sets it follows from the answers that there are.
    let of_pairs = study.file.forms.as_ref().is_none_or(|forms| forms.way.is_of_pairs());
    if answered.responses.names_nobody() || !of_pairs {
        return answered.shown.len();
    }
    let mut given = vec![0; answered.responses.participants.len()];
    answered.shown.iter().for_each(|ballot| given[ballot.participant()] += 1);
    let questionnaire = Questionnaire::of(study).filter(|of| of.blocks() > 1);
    let of_person = |(person, given): (usize, &usize)| {
        let Some(questionnaire) = &questionnaire else { return study.comparisons.len() };
        let form = answered.responses.participants[person].form.as_deref();
        let number = form.and_then(|form| form.parse::<usize>().ok()).filter(|&number| number > 0);
        let comparisons = |number: usize| {
            let form = questionnaire.form(number - 1);
            form.trials.iter().filter(|trial| trial.role == Role::Comparison).count()
        };
        number.map_or(*given, comparisons)
    };
    given.iter().enumerate().filter(|(_, given)| **given > 0).map(of_person).sum()
}
