//! All contrasts in one forest plot: two things a block, a row for all answers and for each part of them.

use super::axis::Axis;
use super::draft::{Unfinished, canvas_with_legend};
use super::forest::{self, Block, Row};
use super::legend::Swatch;
use super::marks::Mark;
use crate::words::capital;
use isostudy_inference::conclusions::Conclusion;
use isostudy_inference::glance;

/// More rows than this are read in the table alone.
const MOST: usize = 120;
/// Between the two panels.
const GAP: f64 = 34.0;

/// Nothing if nothing was tested, or too much.
pub(super) fn contrasts(rows: &[(&glance::Row, &Conclusion)]) -> Option<Unfinished> {
    if rows.is_empty() || rows.len() > MOST {
        return None;
    }
    let [shares, differences] = [false, true].map(|differences| blocks(rows, differences));
    let legend = [
        (Swatch::Mark(Mark::nth(0, true)), "a preference, or a difference, holds".to_owned()),
        (Swatch::Mark(Mark::nth(0, false)), "open, equal or too few".to_owned()),
        forest::interval_entry(),
    ];
    let gap = if differences.is_empty() { 0.0 } else { GAP };
    let height = forest::height(&shares) + gap + forest::height(&differences);
    let height = if differences.is_empty() { forest::height(&shares) } else { height };
    let (mut canvas, top) = canvas_with_legend(&legend, height + GAP);
    let top = forest::remark_heading(&mut canvas, "answers\tpeople\tadjusted p", top);
    let label = "share of answers for the first: 0.5 is no preference";
    forest::draw(&mut canvas, &shares, &Axis::spanning(0.0, 1.0), label, 0.5, top);
    if !differences.is_empty() {
        let top = top + forest::height(&shares) + gap;
        let (low, high) = forest::range(&differences, 0.0);
        let label = "difference of two such shares: 0 is none";
        forest::draw(&mut canvas, &differences, &Axis::spanning(low, high), label, 0.0, top);
    }
    let caption = "All contrasts. Share: mean over people of their answers for the first, an answer without preference counting \
                   half. On the right stand three groups of numbers. The first: answers for the first, for neither and for the second. \
                   The second: people who lean to the first, to neither and to the second. The third: p of the exact sign-flip test, adjusted \
                   within its family. Below: by how much two \
                   such shares differ."
        .into();
    Some(Unfinished { name: "contrasts", caption, canvas })
}

fn blocks(rows: &[(&glance::Row, &Conclusion)], differences: bool) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    for (row, found) in rows.iter().filter(|(row, _)| row.is_difference == differences) {
        let heading = capital(&row.pair());
        if blocks.last().is_none_or(|last| last.heading != heading) {
            blocks.push(Block { heading, rows: Vec::new() });
        }
        let counts = |[a, b, c]: [u64; 3]| format!("{a}:{b}:{c}");
        let parts = [row.answers.map_or(String::new(), counts), counts(row.people), p(row.adjusted)];
        let label = if row.place.is_empty() { "all answers".into() } else { row.place.clone() };
        blocks.last_mut().expect("one was pushed").rows.push(Row {
            label,
            value: Some(row.share),
            interval: row.interval,
            mark: Mark::nth(0, found.holds()),
            remark: parts.join("\t"),
        });
    }
    blocks
}

fn p(p: f64) -> String {
    if p < 0.001 { "p < 0.001".into() } else { format!("p = {p:.3}") }
}
