//! Answers in the formats of other programs.

use crate::choice::Choice;
use crate::formats::long::joined;
use crate::screen::SCREEN_COLUMNS;
use crate::value::{Answer, Question, Responses};
use isostudy_design::forms::Role;
use isostudy_table::formula::escape;
use std::io::Write;

/// What to do with answers without preference where a format has none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ties {
    /// Refuse to write.
    #[default]
    Refuse,
    /// Write one win each way. A tie then weighs as much as two answers, though not where [`read`](crate::read) reads it again.
    Split,
    /// Leave them out.
    Drop,
}

/// What was written, and what was not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Written {
    /// Rows under the header.
    pub rows: u64,
    /// Answers without preference among those written.
    pub ties: u64,
    /// Answers to controls that were left out, since they compare nothing.
    pub controls: u64,
    /// Answers to repeats that were left out, since they only check other answers.
    pub repeats: u64,
}

/// Why nothing, or not everything, was written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The format has no ties.
    #[error(
        "{format} has no answers without preference, and there are {ties}: give `--ties split` or `--ties drop`"
    )]
    Ties {
        /// The format.
        format: &'static str,
        /// How many there are.
        ties: u64,
    },
    /// What the system said.
    #[error("writing answers")]
    Io(#[from] csv::Error),
}

/// Columns of the long format as it is written.
pub const LONG_WRITTEN: [&str; 12] = [
    "participant",
    "form",
    "order",
    "question",
    "object",
    "group",
    "left",
    "right",
    "choice",
    "rt_ms",
    "role",
    "stimulus",
];

/// [`LONG_WRITTEN`] and [`SCREEN_COLUMNS`].
pub const LONG_WRITTEN_WITH_SCREENS: [&str; LONG_WRITTEN.len() + SCREEN_COLUMNS.len()] =
    joined(&LONG_WRITTEN, &SCREEN_COLUMNS);

/// The columns of [`LONG_WRITTEN`], `sides_unknown` where sides were not recorded, and those of [`SCREEN_COLUMNS`] where any answer says
/// them: everything, with the sides as they were shown; controls and repeats are marked by their role. Cells that a spreadsheet would run as a formula are escaped; reading the
/// file gives the same answers.
///
/// # Errors
/// If `out` cannot be written to.
pub fn write_long(responses: &Responses, out: impl Write) -> Result<Written, WriteError> {
    let mut writer = csv::Writer::from_writer(out);
    let with_screens = !responses.screens.is_empty();
    let others = if with_screens { &SCREEN_COLUMNS[..] } else { &[] };
    // Left and right are then the order of two names, and whoever reads the file must know that.
    let unknown = (!responses.sides_recorded).then_some("sides_unknown");
    writer.write_record(LONG_WRITTEN.iter().chain(unknown.as_slice()).chain(others))?;
    let mut written = Written::default();
    for answer in &responses.answers {
        let participant = &responses.participants[answer.participant as usize];
        let question = &responses.questions[answer.question as usize];
        let [left, right] = [answer.left, answer.right].map(|item| responses.items[item as usize].as_str());
        let order = answer.order.map_or(String::new(), |order| order.to_string());
        let rt_ms = answer.rt_ms.map_or(String::new(), |time| time.to_string());
        let texts = [
            participant.id.as_str(),
            participant.form.as_deref().unwrap_or(""),
            &order,
            &question.id,
            &question.object,
            &question.group,
            left,
            right,
            answer.step().name(),
            &rt_ms,
            role_name(question.role),
            responses.stimulus(answer).unwrap_or(""),
        ];
        let screen = responses.screen(answer).copied().unwrap_or_default().cells();
        let screen = screen.iter().map(String::as_str).filter(|_| with_screens);
        let texts = texts.into_iter().chain(unknown.map(|_| "yes")).chain(screen);
        writer.write_record(texts.map(|text| escape(text).into_owned()))?;
        written.rows += 1;
    }
    written.ties = count(responses, |_, answer| answer.choice == Choice::NoPreference);
    writer.flush().map_err(csv::Error::from)?;
    Ok(written)
}

/// What forms and the long format call a role.
fn role_name(role: Role) -> &'static str {
    match role {
        Role::Training => "training",
        Role::Comparison => "comparison",
        Role::Control => "control",
        Role::Repeat => "repeat",
    }
}

/// Comparisons for pwcmp: `observer,session,scene,condition_A,condition_B,is_A_selected`; A was on the left. `names` are the items'; the
/// scene is the object, or the group.
///
/// # Errors
/// [`WriteError::Ties`] before anything is written; else if `out` cannot be written to.
///
/// # Panics
/// If there are fewer names than items.
pub fn write_pwcmp(
    responses: &Responses,
    names: &[String],
    ties: Ties,
    out: impl Write,
) -> Result<Written, WriteError> {
    let mut written = counted(responses);
    if ties == Ties::Refuse && written.ties > 0 {
        return Err(WriteError::Ties { format: "pwcmp", ties: written.ties });
    }
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(["observer", "session", "scene", "condition_A", "condition_B", "is_A_selected"])?;
    for answer in comparing(responses) {
        let participant = &responses.participants[answer.participant as usize];
        let question = &responses.questions[answer.question as usize];
        let scene = if question.object.is_empty() { &question.group } else { &question.object };
        let scene = if scene.is_empty() { "all" } else { scene };
        let session = participant.form.as_deref().unwrap_or("1");
        let [left, right] = [answer.left, answer.right].map(|item| names[item as usize].as_str());
        let selected: &[&str] = match (answer.choice, ties) {
            (Choice::Left, _) => &["1"],
            (Choice::Right, _) => &["0"],
            (Choice::NoPreference, Ties::Split) => &["1", "0"],
            (Choice::NoPreference, _) => &[],
        };
        for selected in selected {
            let texts = [&participant.id, session, scene, left, right, selected];
            writer.write_record(texts.map(|text| escape(text).into_owned()))?;
            written.rows += 1;
        }
    }
    writer.flush().map_err(csv::Error::from)?;
    Ok(written)
}

/// Comparisons for arenakit: `model_a,model_b,winner,item_id,voter_id`; `model_a` was on the left, the winner is `a`, `b` or `tie`.
/// `names` are the items'.
///
/// # Errors
/// If `out` cannot be written to.
///
/// # Panics
/// If there are fewer names than items.
pub fn write_arenakit(
    responses: &Responses,
    names: &[String],
    out: impl Write,
) -> Result<Written, WriteError> {
    let mut written = counted(responses);
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(["model_a", "model_b", "winner", "item_id", "voter_id"])?;
    for answer in comparing(responses) {
        let [left, right] = [answer.left, answer.right].map(|item| names[item as usize].as_str());
        let winner = match answer.choice {
            Choice::Left => "a",
            Choice::NoPreference => "tie",
            Choice::Right => "b",
        };
        let question = &responses.questions[answer.question as usize].id;
        let voter = &responses.participants[answer.participant as usize].id;
        writer.write_record([left, right, winner, question, voter].map(|text| escape(text).into_owned()))?;
        written.rows += 1;
    }
    writer.flush().map_err(csv::Error::from)?;
    Ok(written)
}

/// Answers to comparisons, which controls and repeats only check.
fn comparing(responses: &Responses) -> impl Iterator<Item = &Answer> {
    let is_comparison = |answer: &&Answer| responses.questions[answer.question as usize].is_comparison();
    responses.answers.iter().filter(is_comparison)
}

fn counted(responses: &Responses) -> Written {
    let of = |role: Role| count(responses, |question, _| question.role == role);
    let ties = count(responses, |question, answer| {
        question.is_comparison() && answer.choice == Choice::NoPreference
    });
    Written { rows: 0, ties, controls: of(Role::Control), repeats: of(Role::Repeat) }
}

fn count(responses: &Responses, which: impl Fn(&Question, &Answer) -> bool) -> u64 {
    let fits = |answer: &&Answer| which(&responses.questions[answer.question as usize], answer);
    responses.answers.iter().filter(fits).count() as u64
}
