//! What a server asks newcomers about, in a study that asks where an answer tells most.

use isostudy_design::Study;
use isostudy_design::forms::FormEntry;
use isostudy_inference::{NextQuestions, Outcome};
use isostudy_serve::record::Choice;
use isostudy_serve::{Asked, Chooser};
use std::sync::Arc;

/// What chooses questions of a study; `None` where they stay as they are planned.
pub(super) fn chooser(study: &Study) -> Option<Chooser> {
    let next = NextQuestions::of(study)?;
    let choose = move |others: &[Asked<'_>], planned: &FormEntry, person: usize| {
        let answered = others.iter().flat_map(|(form, choices)| {
            form.questions
                .iter()
                .zip(*choices)
                .filter_map(|(code, choice)| Some((code.as_str(), outcome(*choice)?)))
        });
        FormEntry { questions: next.choose(answered, &planned.questions, person), ..planned.clone() }
    };
    Some(Chooser(Arc::new(choose)))
}

/// What an answer says of the two.
fn outcome(choice: Choice) -> Option<Outcome> {
    match choice {
        Choice::L | Choice::Ll => Some(Outcome::Left),
        Choice::Np => Some(Outcome::Tie),
        Choice::R | Choice::Rr => Some(Outcome::Right),
        Choice::Number(_) => None,
    }
}
