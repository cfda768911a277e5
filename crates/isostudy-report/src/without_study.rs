//! Tables of answers that no study file explains: items, groups and questions are what the answers name.

use crate::tables;
use isostudy_inference::Preferences;
use isostudy_inference::ballots::outcome;
use isostudy_inference::open_groups::group_of_question;
use isostudy_responses::{Question, Responses};
use isostudy_statistics::interval::{self, Interval};
use isostudy_table::{Cell, Columns, Table};

/// Every table about answers that no study explains: `answer_counts`, `tests`, `worths`, `models`, `respondents`, `screened`,
/// `audit` and `screens`, as far as they have rows.
pub fn answer_tables(preferences: &Preferences<'_>) -> Vec<Table> {
    let mut tables = vec![counts(preferences.responses)];
    tables.retain(|table| !table.rows.is_empty());
    tables.extend(tables::of_preferences(preferences));
    tables
}

/// A question, and how often the item with the lower place, neither and the other were chosen.
struct Row<'a> {
    answers: &'a Responses,
    question: &'a Question,
    group: &'a str,
    counts: [u64; 3],
}

impl Row<'_> {
    fn item(&self, item: u32) -> &str {
        &self.answers.items[item as usize]
    }

    fn all(&self) -> u64 {
        self.counts.iter().sum()
    }

    fn interval(&self) -> Option<Interval> {
        interval::wilson(self.counts[2], self.all())
    }
}

/// How every question was answered, the item with the lower place in the [`Responses`] on the left.
fn counts(answers: &Responses) -> Table {
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
    let rows = answers.questions.iter().zip(&groups).zip(counts);
    let rows = rows.map(|((question, group), counts)| Row { answers, question, group, counts });
    let table = Columns::over(rows)
        .column("group", "Group", |of| Cell::text(of.group))
        .column("object", "Object", |of| Cell::text(&of.question.object))
        .column("question", "Question", |of| Cell::text(&of.question.id))
        .column("left", "Left", |of| Cell::text(of.item(of.question.left.min(of.question.right))))
        .column("right", "Right", |of| Cell::text(of.item(of.question.left.max(of.question.right))))
        .column("left_answers", "Answers left", |of| Cell::count(of.counts[0]))
        .column("no_preference", "No preference", |of| Cell::count(of.counts[1]))
        .column("right_answers", "Answers right", |of| Cell::count(of.counts[2]))
        .column("right_share", "Right of all", |of| {
            Cell::number((of.all() > 0).then(|| of.counts[2] as f64 / of.all() as f64), 3)
        })
        .column("right_share_low", "from", |of| Cell::number(of.interval().map(|i| i.low), 3))
        .column("right_share_high", "to", |of| Cell::number(of.interval().map(|i| i.high), 3))
        .into_table("answer_counts", "Answers per question");
    table.with_note(
        "Left and right are the order of names, not the sides that people saw. From and to: Wilson's \
         interval at 95 %, for one question at a time.",
    )
}
