//! Tables of answers that no study file explains: items, groups and questions are what the answers name.

use crate::tables;
use isostudy_inference::Preferences;
use isostudy_inference::ballots::outcome;
use isostudy_inference::open_groups::group_of_question;
use isostudy_responses::Responses;
use isostudy_statistics::interval;
use isostudy_table::{Cell, Table};

/// Every table about answers that no study explains: `answer_counts`, `tests`, `worths`, `models`, `respondents`, `screened`,
/// `audit` and `screens`, as far as they have rows.
pub fn answer_tables(preferences: &Preferences<'_>) -> Vec<Table> {
    let mut tables = vec![counts(preferences.responses)];
    tables.retain(|table| !table.rows.is_empty());
    tables.extend(tables::of_preferences(preferences));
    tables
}

/// How every question was answered, the item with the lower place in the [`Responses`] on the left.
fn counts(answers: &Responses) -> Table {
    let mut table = Table::new(
        "answer_counts",
        "Answers per question",
        &[
            ("group", "Group"),
            ("object", "Object"),
            ("question", "Question"),
            ("left", "Left"),
            ("right", "Right"),
            ("left_answers", "Answers left"),
            ("no_preference", "No preference"),
            ("right_answers", "Answers right"),
            ("right_share", "Right of all"),
            ("right_share_low", "from"),
            ("right_share_high", "to"),
        ],
    );
    let mut counts = vec![[0_u64; 3]; answers.questions.len()];
    for answer in &answers.answers {
        let straight = answer.left <= answer.right;
        let place = match outcome(answer.choice).index() {
            place if straight => place,
            place => 2 - place,
        };
        counts[answer.question as usize][place] += 1;
    }
    let groups = group_of_question(answers);
    for ((question, group), [left, none, right]) in answers.questions.iter().zip(groups).zip(counts) {
        let [first, second] = [question.left.min(question.right), question.left.max(question.right)];
        let all = left + none + right;
        let interval = interval::wilson(right, all);
        table.push(vec![
            Cell::text(group),
            Cell::text(&question.object),
            Cell::text(&question.id),
            Cell::text(&answers.items[first as usize]),
            Cell::text(&answers.items[second as usize]),
            Cell::count(left),
            Cell::count(none),
            Cell::count(right),
            Cell::number((all > 0).then(|| right as f64 / all as f64), 3),
            Cell::number(interval.map(|i| i.low), 3),
            Cell::number(interval.map(|i| i.high), 3),
        ]);
    }
    table.notes.push(
        "Left and right are the order of names, not the sides that people saw. From and to: Wilson's \
         interval at 95 %, for one question at a time."
            .into(),
    );
    table
}
