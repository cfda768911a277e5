//! The answers themselves, and how they fall on each question.

use isostudy_design::{Comparison, Study};
use isostudy_inference::ballots::is_asked;
use isostudy_inference::tally::{QuestionCount, Tally};
use isostudy_responses::Responses;
use isostudy_statistics::interval::{self, Interval};
use isostudy_table::{Cell, Columns, Table};
use std::collections::BTreeSet;

/// More respondents than this make no table that anybody reads; the answers are in their file.
const MOST_COLUMNS: usize = 200;

/// One row a question, one column a respondent (appendix D); what was not answered is missing. None for a crowd.
///
/// Who is `excluded` has no column.
pub(super) fn answers(study: &Study, answers: &Responses, excluded: &BTreeSet<usize>) -> Option<Table> {
    if answers.participants.len() > MOST_COLUMNS {
        return None;
    }
    let mut said = vec![vec![String::new(); answers.participants.len()]; study.comparisons.len()];
    for answer in answers.answers.iter().filter(|answer| is_asked(study, answer)) {
        let cell = &mut said[answer.question as usize][answer.participant as usize];
        let space = if cell.is_empty() { "" } else { " " };
        *cell = format!("{cell}{space}{}", answers.declared_step(answer).code());
    }
    let respondents = (0..answers.participants.len()).filter(|participant| !excluded.contains(participant));
    let caption = match answers.has_steps() {
        true => {
            "Answers: LL left much better, L left better, NP equal, R right better, RR right much better; one column a respondent"
        }
        false => "Answers: L left, NP no preference, R right; one column a respondent",
    };
    let mut table = Columns::over(study.comparisons.iter().zip(&said))
        .column("question", "Question", |(comparison, _)| Cell::text(&comparison.question))
        .columns_of(respondents, |all, i| {
            let (name, heading) = (format!("respondent_{}", i + 1), (i + 1).to_string());
            all.column(name, heading, move |(_, said)| match said[i].as_str() {
                "" => Cell::Missing,
                said => Cell::text(said),
            })
        })
        .into_table("answers", caption);
    let turned = |a: &isostudy_responses::Answer| a.left != answers.questions[a.question as usize].left;
    if answers.answers.iter().any(|a| is_asked(study, a) && turned(a)) {
        let note = "Sides are the questionnaire's; answers to a pair shown the other way round are turned.";
        table.notes.push(note.into());
    }
    Some(table)
}

/// Left, none and right of every question, with the right side's share among decided answers.
pub(super) fn counts(study: &Study, tally: &Tally, sides_differ: bool) -> Table {
    type Row<'a> = (&'a Study, &'a Comparison, &'a QuestionCount);
    fn right((.., of): &Row<'_>) -> Option<Interval> {
        interval::wilson(of.right, of.answers())
    }
    let rows = study.comparisons.iter().zip(&tally.questions).map(|(asked, of)| (study, asked, of));
    let table = Columns::over(rows)
        .column("question", "Question", |(_, asked, _)| Cell::text(&asked.question))
        .column("object", "Object", |(study, asked, _)| Cell::text(&study.file.objects[asked.object].name))
        .column("left", "Left", |(_, asked, _)| Cell::text(&asked.left))
        .column("right", "Right", |(_, asked, _)| Cell::text(&asked.right))
        .column("left_answers", "Answers left", |(.., of)| Cell::count(of.left))
        .column("no_preference", "No preference", |(.., of)| Cell::count(of.none))
        .column("right_answers", "Answers right", |(.., of)| Cell::count(of.right))
        .column("right_share", "Right of all", |(.., of)| {
            Cell::number((of.answers() > 0).then(|| of.right as f64 / of.answers() as f64), 3)
        })
        .column("right_share_low", "from", |row| Cell::number(right(row).map(|i| i.low), 3))
        .column("right_share_high", "to", |row| Cell::number(right(row).map(|i| i.high), 3))
        .into_table("answer_counts", "Answers per question");
    let sum = |count: fn(&QuestionCount) -> u64| tally.questions.iter().map(count).sum::<u64>();
    let sums = [sum(|of| of.left), sum(|of| of.none), sum(|of| of.right)];
    table.with_note(format!(
        "All questions: {} for the one listed on the left, {} without preference, {} for the one listed on the right{}. From and to: Wilson's interval at 95 %, for one \
         question at a time; it may not be pooled over questions, because the same people answer all of them.",
        sums[0],
        sums[1],
        sums[2],
        if sides_differ { "; people saw them on either side" } else { "" },
    ))
}
