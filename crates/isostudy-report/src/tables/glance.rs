//! Every contrast in a row, verdict first.

use crate::standing::Standing;
use isostudy_inference::conclusions::Conclusion;
use isostudy_inference::glance::Row;
use isostudy_statistics::interval::Interval;
use isostudy_table::digits::number;
use isostudy_table::{Cell, Columns, Table};

/// Nothing if nothing was tested.
pub(crate) fn contrasts(rows: &[(&Row, &Conclusion)]) -> Option<Table> {
    if rows.is_empty() {
        return None;
    }
    let answers = |row: &Row, place: usize| row.answers.map_or(Cell::Missing, |of| Cell::count(of[place]));
    let mut table = Columns::over(rows)
        .column("verdict", "Verdict", |row| Cell::text(verdict(row)))
        .column("contrast", "Preference", |(row, _)| Cell::text(row.name()))
        .column("share", "Share for the first", |(row, _)| Cell::Number(row.share, 3))
        .column("low", "from", |(row, _)| Cell::number(row.interval.map(|i| i.low), 3))
        .column("high", "to", |(row, _)| Cell::number(row.interval.map(|i| i.high), 3))
        .column("answers_first", "Answers for", |(row, _)| answers(row, 0))
        .column("answers_none", "Neither", |(row, _)| answers(row, 1))
        .column("answers_second", "Answers against", |(row, _)| answers(row, 2))
        .column("people_first", "People for", |(row, _)| Cell::count(row.people[0]))
        .column("people_undecided", "Undecided", |(row, _)| Cell::count(row.people[1]))
        .column("people_second", "People against", |(row, _)| Cell::count(row.people[2]))
        .column("p_adjusted", "p adjusted", |(row, _)| Cell::P(row.adjusted, 4))
        .into_table("contrasts", "Every contrast at a glance");
    let [shares, differences] = [false, true].map(|differences| part(rows, differences));
    table.parts = [shares, differences].into_iter().filter(|part| !part.rows.is_empty()).collect();
    if let [only] = &mut table.parts[..] {
        only.caption.clone_from(&table.caption);
    }
    table.notes.push(
        "Share: the mean over people of their share of answers for the first, an answer without preference counting half; \
         0.5 is no preference. In brackets: 95 % interval over people. Answers and people: for the first, undecided, for the \
         second. p: exact sign-flip test over people, adjusted within its family. Verdict: whether p is at most the study's \
         level; \u{201c}open\u{201d} does not say that there is no preference."
            .into(),
    );
    Some(table)
}

/// In a word; a part may go against what is preferred over all.
fn verdict((row, found): &(&Row, &Conclusion)) -> &'static str {
    match Standing::of(found) {
        Standing::Holds if row.is_against() => "holds against",
        standing => standing.label(),
    }
}

/// What people read: intervals and counts of a row in one cell each.
fn part(rows: &[(&Row, &Conclusion)], differences: bool) -> Table {
    let caption = if differences { "How much a preference depends on something else" } else { "Preferences" };
    let share = if differences { "Difference of shares" } else { "Share for the first" };
    let digits = |share: f64| number(share, 2);
    let within = |i: Interval| format!(" ({} to {})", digits(i.low), digits(i.high));
    let counts = |[a, b, c]: [u64; 3]| Cell::text(format!("{a} : {b} : {c}"));
    Columns::over(rows.iter().filter(|(row, _)| row.is_difference == differences))
        .column("verdict", "Verdict", |row| Cell::text(verdict(row)))
        .column("contrast", "Preference", |(row, _)| Cell::text(row.name()))
        .column("share", share, |(row, _)| {
            Cell::text(digits(row.share) + &row.interval.map_or(String::new(), within))
        })
        .columns_if(!differences, |all| {
            let heading = "Answers for : neither : against";
            all.column("answers", heading, |(row, _)| counts(row.answers.unwrap_or_default()))
        })
        .column("people", "People for : undecided : against", |(row, _)| counts(row.people))
        .column("p_adjusted", "p adjusted", |(row, _)| Cell::P(row.adjusted, 3))
        .into_table("contrasts", caption)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;
    use isostudy_inference::Preferences;

    #[test]
    fn a_row_says_what_the_answers_are() {
        let study = fixture::study();
        let answered = fixture::answered(&study);
        let preferences = Preferences::of_study(&study, &answered);
        let table = contrasts(&preferences.concluded()).unwrap();
        assert_eq!((table.rows.len(), table.parts[0].rows.len(), table.parts[1].rows.len()), (43, 25, 18));
        let shown = table.parts[0].shown_rows();
        let row = shown.iter().find(|row| row[1] == "Integrated clustering over no clustering").unwrap();
        // 93 of 108 halves; the interval is that of docs/statistics.md, 0.46 to 0.99 on scores from -1 to 1.
        assert_eq!(
            row[..4],
            ["holds", "Integrated clustering over no clustering", "0.86 (0.73 to 0.99)", "92 : 2 : 14"]
        );
        // 0.00098: small everywhere.
        assert_eq!(row[5], "< 0.001");
        assert!(table.to_html_cards().contains("data-label=\"p adjusted\">&lt; 0.001</td>"));
        let markdown = table.to_markdown();
        assert!(
            markdown.contains("| open | Edge collapse over no clustering, on the sphere |"),
            "{markdown}"
        );
    }

    #[test]
    fn nothing_tested_has_no_table() {
        assert_eq!(contrasts(&[]), None);
    }
}
