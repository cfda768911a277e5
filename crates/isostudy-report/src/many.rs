//! Tables and page of many answers.

use crate::report::{Report, SummaryLine};
use crate::statement::{Block, Section};
use crate::tables::models::model_tables;
use crate::words::{counted, people, whole};
use isostudy_inference::many::{ItemFactor, PairTest};
use isostudy_inference::{Fraction, MANY_ANSWERS, MANY_ITEMS, Many};
use isostudy_table::{Cell, Columns, Table};

/// The tables of many answers that fit a page: `factors`, `worths`, `models`.
pub fn many_tables(many: &Many<'_>, sides_recorded: bool) -> Vec<Table> {
    let mut tables = vec![factors(many)];
    tables.extend(model_tables(&many.models, sides_recorded));
    tables
}

fn factors(many: &Many<'_>) -> Table {
    let group = |of: &ItemFactor| &many.groups[of.group];
    let share = |share: Fraction| Cell::Number(share.value(), 3);
    let table = Columns::over(&many.factors)
        .column("group", "Group", |of| Cell::text(&group(of).name))
        .column("item", "Item", |of| Cell::text(&group(of).items[of.item]))
        .column("wins", "Wins", |of| Cell::count(of.counts[0]))
        .column("no_preference", "No preference", |of| Cell::count(of.counts[1]))
        .column("losses", "Losses", |of| Cell::count(of.counts[2]))
        .column("answers", "Answers of the group", |of| Cell::count(of.answers))
        .column("factor", "Factor", |of| share(of.factor()))
        .column("won_of_shown", "Won of shown", |of| share(of.appearance_share()))
        .into_table("factors", "How often each item was chosen");
    table.with_note(
        "Factor: wins over all answers of the group. Won of shown: wins over the answers that showed the item.",
    )
}

/// Every pair of items that was compared, as CSV with the names of columns that `tests.csv` has: of a thousand items there are half
/// a million pairs, which no page shows.
pub fn pairs_csv(many: &Many<'_>) -> String {
    let group = |of: &PairTest| &many.groups[of.group];
    let name = |of: &PairTest, item: usize| Cell::text(&group(of).items[of.items[item]]);
    Columns::over(&many.tests)
        .column("family", "", |of| Cell::text(&group(of).name))
        .column("first_item", "", |of| name(of, 0))
        .column("second_item", "", |of| name(of, 1))
        .column("first", "", |of| Cell::count(of.counts[0]))
        .column("no_preference", "", |of| Cell::count(of.counts[1]))
        .column("second", "", |of| Cell::count(of.counts[2]))
        .column("participants", "", |of| Cell::count(of.people))
        .column("p_sign_flip", "", |of| Cell::P(of.p, 5))
        .column("p_adjusted", "", |of| Cell::P(of.adjusted, 4))
        .column("mean", "", |of| Cell::of_sum(Some(of.mean), 3))
        .column("low", "", |of| Cell::of_sum(of.interval.map(|i| i.low), 3))
        .column("high", "", |of| Cell::of_sum(of.interval.map(|i| i.high), 3))
        .column("p_equivalence", "", |of| Cell::p(of.equivalence, 4))
        .into_table("pairs", "")
        .to_csv()
}

/// What was found in many answers, in one sentence or two.
pub fn found_in_many(many: &Many<'_>) -> String {
    let level = isostudy_inference::hypotheses::ALPHA;
    let differ = many.tests.iter().filter(|test| test.adjusted <= level).count();
    format!(
        "People prefer one item to the other in {} of {}. p is corrected for all pairs of a group.",
        whole(differ as u64),
        counted(many.tests.len(), "pair"),
    )
}

/// That answers were counted as many, and what this leaves out.
pub fn told_of_many(many: &Many<'_>) -> String {
    let items = many.groups.iter().map(|group| group.items.len()).max().unwrap_or(0);
    format!(
        "{} about up to {} in a group are counted as many answers. Up to {} answers and {MANY_ITEMS} items are analysed in full.",
        counted(many.answers, "answer"),
        counted(items, "item"),
        whole(MANY_ANSWERS as u64),
    )
}

/// The report of many answers.
pub fn report_of_many(title: &str, many: &Many<'_>, tables: &[Table], assumptions: Vec<String>) -> Report {
    let line = |label: &'static str, text: String| SummaryLine { label, text };
    let mut lead = vec![
        format!("{} gave {}.", people(many.people), counted(many.answers, "answer")),
        told_of_many(many),
    ];
    lead.extend(assumptions);
    let blocks = tables.iter().cloned().map(Block::Folded).collect();
    let pairs = "tables/pairs.csv has a row for each pair of items: the answers, the exact sign-flip test of people's scores, and \
                 the mean score with its interval.";
    Report {
        title: title.into(),
        summary: vec![line("Found", found_in_many(many)), line("By whom", lead[0].clone())],
        methods: None,
        lead,
        limits: vec![
            "Intervals of worths are t intervals of a sandwich variance with people as clusters. Nothing is resampled.".into(),
            "Nobody is screened, no probe looks for defects, and pairs are not tested object by object.".into(),
        ],
        sections: vec![
            Section { id: "worths", heading: "How much each is liked, on one scale", blocks },
            Section {
                id: "preferences",
                heading: "What was preferred to what",
                blocks: vec![Block::Text(found_in_many(many)), Block::Text(pairs.into())],
            },
        ],
    }
}
