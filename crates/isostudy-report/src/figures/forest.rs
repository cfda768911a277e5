//! Estimates with their intervals, a row each, in blocks under a heading.

use super::axis::Axis;
use super::canvas::{Align, BLACK, Canvas};
use super::draft::WIDTH;
use super::legend;
use super::marks::Mark;
use super::style::GRID;
use isostudy_statistics::interval::Interval;

const ROW: f64 = 21.0;
const HEADING: f64 = 30.0;
const BOTTOM: f64 = 44.0;
/// Room for labels on the left and remarks on the right.
const LABELS: (f64, f64) = (265.0, 235.0);
const EM: f64 = 11.0;

/// One estimate.
pub(super) struct Row {
    pub(super) label: String,
    pub(super) value: Option<f64>,
    pub(super) interval: Option<Interval>,
    pub(super) mark: Mark,
    pub(super) remark: String,
}

/// Rows under a heading.
pub(super) struct Block {
    pub(super) heading: String,
    pub(super) rows: Vec<Row>,
}

pub(super) fn height(blocks: &[Block]) -> f64 {
    blocks.iter().map(|b| HEADING + ROW * b.rows.len() as f64).sum::<f64>() + BOTTOM
}

/// The smallest and largest of all values and interval ends, `also` included.
pub(super) fn range(blocks: &[Block], also: f64) -> (f64, f64) {
    let rows = blocks.iter().flat_map(|b| &b.rows);
    let ends = rows.flat_map(|r| {
        let interval = r.interval.map(|i| [i.low, i.high]);
        r.value.into_iter().chain(interval.into_iter().flatten())
    });
    ends.fold((also, also), |(low, high), x| (low.min(x), high.max(x)))
}

/// Draws the blocks from `top`, with a line where the value is `reference`.
pub(super) fn draw(
    canvas: &mut Canvas,
    blocks: &[Block],
    axis: &Axis,
    axis_label: &str,
    reference: f64,
    top: f64,
) {
    let (left, right) = (LABELS.0, WIDTH - LABELS.1);
    let bottom = top + height(blocks) - BOTTOM;
    let x = |value: f64| axis.place(value, left, right);
    for (&tick, text) in axis.ticks.iter().zip(axis.labels()) {
        canvas.line(vec![(x(tick), top + 8.0), (x(tick), bottom + 4.0)], GRID, 0.5);
        canvas.text(text, (x(tick), bottom + 17.0), EM, Align::Middle);
    }
    canvas.line(vec![(x(reference), top + 8.0), (x(reference), bottom + 4.0)], BLACK, 0.75);
    canvas.text(axis_label, ((left + right) / 2.0, bottom + 36.0), 12.0, Align::Middle);
    let mut y = top;
    for block in blocks {
        canvas.text(&block.heading, (20.0, y + HEADING - 9.0), 12.5, Align::Start);
        y += HEADING;
        for row in &block.rows {
            let middle = y + ROW / 2.0;
            canvas.text(&row.label, (left - 14.0, middle + 0.36 * EM), EM, Align::End);
            remark(canvas, &row.remark, right + 14.0, middle + 0.36 * EM);
            if let Some(interval) = row.interval {
                bar(canvas, x(interval.low), x(interval.high), middle);
            }
            if let Some(value) = row.value {
                row.mark.draw(canvas, (x(value), middle));
            }
            y += ROW;
        }
    }
}

/// Says what the remarks are, above them; returns where the blocks begin.
pub(super) fn remark_heading(canvas: &mut Canvas, text: &str, top: f64) -> f64 {
    remark(canvas, text, WIDTH - LABELS.1 + 14.0, top + HEADING - 9.0);
    top
}

/// Tabs part a remark into columns.
fn remark(canvas: &mut Canvas, text: &str, x: f64, baseline: f64) {
    const COLUMNS: [f64; 3] = [0.0, 78.0, 142.0];
    for (part, column) in text.split('\t').zip(COLUMNS) {
        canvas.text(part, (x + column, baseline), EM, Align::Start);
    }
}

fn bar(canvas: &mut Canvas, from: f64, to: f64, y: f64) {
    canvas.line(vec![(from, y), (to, y)], BLACK, 1.5);
    for x in [from, to] {
        canvas.line(vec![(x, y - 4.0), (x, y + 4.0)], BLACK, 1.5);
    }
}

/// The legend's entry of an interval.
pub(super) fn interval_entry() -> (legend::Swatch, String) {
    (legend::Swatch::Whisker, "95 % t interval over respondents".into())
}
