//! The answers themselves, and how they fall on each question.

use crate::answers::Answers;
use crate::interval;
use crate::table::{Cell, Column, Table};
use crate::tally::Tally;
use design::Study;

/// One row a question, one column a respondent (appendix D).
pub(super) fn answers(study: &Study, answers: &Answers) -> Table {
    let mut table = Table::new(
        "answers",
        "Answers: L left, NP no preference, R right; one column a respondent",
        &[("question", "Question")],
    );
    let respondents = 1..=answers.respondents();
    table
        .columns
        .extend(respondents.map(|i| Column { name: format!("respondent_{i}"), heading: i.to_string() }));
    for (i, comparison) in study.comparisons.iter().enumerate() {
        let mut row = vec![Cell::text(&comparison.question)];
        row.extend(answers.to_question(i).into_iter().map(|choice| Cell::text(choice.code())));
        table.push(row);
    }
    table
}

/// Left, none and right of every question, with the right side's share among decided answers.
pub(super) fn counts(study: &Study, tally: &Tally) -> Table {
    let mut table = Table::new(
        "answer_counts",
        "Answers per question",
        &[
            ("question", "Question"),
            ("object", "Object"),
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
    let mut sums = [0; 3];
    for (comparison, count) in study.comparisons.iter().zip(&tally.questions) {
        let all = count.left + count.none + count.right;
        let interval = interval::wilson(count.right, all);
        for (sum, n) in sums.iter_mut().zip([count.left, count.none, count.right]) {
            *sum += n;
        }
        table.push(vec![
            Cell::text(&comparison.question),
            Cell::text(&study.file.objects[comparison.object].name),
            Cell::text(&comparison.left),
            Cell::text(&comparison.right),
            Cell::count(count.left),
            Cell::count(count.none),
            Cell::count(count.right),
            Cell::number((all > 0).then(|| count.right as f64 / all as f64), 3),
            Cell::number(interval.map(|i| i.low), 3),
            Cell::number(interval.map(|i| i.high), 3),
        ]);
    }
    table.notes.push(format!(
        "All questions: {} left, {} without preference, {} right. From and to: Wilson's interval at 95 %, for one \
         question at a time; it may not be pooled over questions, because the same people answer all of them.",
        sums[0], sums[1], sums[2]
    ));
    table
}
