//! All contrasts in one forest plot: two things a block, a row for all answers and for each part of them.

use super::OVERVIEW;
use super::axis::Axis;
use super::draft::{Unfinished, canvas_with_legend};
use super::forest::{self, Block, Row};
use super::legend::Swatch;
use super::marks::Mark;
use super::sheet::Sheet;
use crate::words::capital;
use isostudy_inference::conclusions::Conclusion;
use isostudy_inference::glance;

/// A contrast, and what was found of it.
type Concluded<'a> = (&'a glance::Row, &'a Conclusion);

/// More rows than this are read in the table alone.
const MOST: usize = 120;
/// What is said of a row beside it.
const COLUMNS: &str = "answers\tpeople\tadjusted p";
const SHARES: &str = "share of answers for the first: 0.5 is no preference";
/// Between the two panels.
const GAP: f64 = 34.0;

/// Nothing if nothing was tested, or too much.
pub(super) fn contrasts(rows: &[Concluded<'_>], sheet: Sheet) -> Option<Unfinished> {
    if rows.is_empty() || rows.len() > MOST {
        return None;
    }
    let [shares, differences] = [false, true].map(|differences| blocks(rows, differences));
    let legend = legend("a preference, or a difference, holds");
    let gap = if differences.is_empty() { 0.0 } else { GAP };
    let height = forest::height(sheet, &shares) + gap + forest::height(sheet, &differences);
    let height = if differences.is_empty() { forest::height(sheet, &shares) } else { height };
    let (mut canvas, top) = canvas_with_legend(sheet, &legend, height + GAP);
    forest::remark_heading(&mut canvas, COLUMNS, top);
    forest::draw(&mut canvas, &shares, &Axis::spanning(0.0, 1.0), SHARES, 0.5, top);
    if !differences.is_empty() {
        let top = top + forest::height(sheet, &shares) + gap;
        let (low, high) = forest::range(&differences, 0.0);
        let label = "difference of two such shares: 0 is none";
        forest::draw(&mut canvas, &differences, &Axis::spanning(low, high), label, 0.0, top);
    }
    let caption = "All contrasts. Share: mean over people of their answers for the first, an answer without preference counting \
                   half. Beside a row stand three groups of numbers, on a phone the third alone. The first: answers for the first, for \
                   neither and for the second. The second: people who lean to the first, to neither and to the second. The third: \
                   p of the exact sign-flip test, adjusted within its family. Below: by how much two such shares differ."
        .into();
    Some(Unfinished { name: "contrasts", caption, canvas })
}

/// Of the contrasts over all answers more are not read at once.
const MOST_AT_ONCE: usize = 12;

/// The contrasts over all answers alone, such that they fit on a screen; nothing if there are none, or too many for that.
pub(super) fn overview(rows: &[Concluded<'_>], sheet: Sheet) -> Option<Unfinished> {
    let whole: Vec<&Concluded<'_>> =
        rows.iter().filter(|(row, _)| !row.is_difference && row.is_whole).collect();
    if whole.is_empty() || whole.len() > MOST_AT_ONCE {
        return None;
    }
    let rows = whole.iter().map(|of| Row { label: capital(&of.0.pair()), ..forest_row(of) }).collect();
    let blocks = [Block { heading: String::new(), rows }];
    let legend = legend("a preference holds");
    let (mut canvas, top) = canvas_with_legend(sheet, &legend, forest::height(sheet, &blocks));
    forest::remark_heading(&mut canvas, COLUMNS, top);
    forest::draw(&mut canvas, &blocks, &Axis::spanning(0.0, 1.0), SHARES, 0.5, top);
    let caption = "What people preferred, over all their answers. Share: mean over people of their answers for the first, an answer \
                   without preference counting half. The figure of contrasts has the same for each object and for parts of the methods."
        .into();
    Some(Unfinished { name: OVERVIEW, caption, canvas })
}

fn legend(holds: &str) -> [(Swatch, String); 3] {
    [
        (Swatch::Mark(Mark::nth(0, true)), holds.to_owned()),
        (Swatch::Mark(Mark::nth(0, false)), "open, equal or too few".to_owned()),
        forest::interval_entry(),
    ]
}

/// A row with its place for a label.
fn forest_row((row, found): &Concluded<'_>) -> Row {
    let counts = |[a, b, c]: [u64; 3]| format!("{a}:{b}:{c}");
    let parts = [row.answers.map_or(String::new(), counts), counts(row.people), p(row.adjusted)];
    Row {
        label: if row.place.is_empty() { "all answers".into() } else { row.place.clone() },
        value: Some(row.share),
        interval: row.interval,
        mark: Mark::nth(0, found.holds()),
        remark: parts.join("\t"),
    }
}

fn blocks(rows: &[Concluded<'_>], differences: bool) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    for of in rows.iter().filter(|(row, _)| row.is_difference == differences) {
        let heading = capital(&of.0.pair());
        if blocks.last().is_none_or(|last| last.heading != heading) {
            blocks.push(Block { heading, rows: Vec::new() });
        }
        blocks.last_mut().expect("one was pushed").rows.push(forest_row(of));
    }
    blocks
}

fn p(p: f64) -> String {
    if p < 0.001 { "p < 0.001".into() } else { format!("p = {p:.3}") }
}
