//! Estimates with their intervals, a row each, in blocks under a heading.

use super::axis::Axis;
use super::canvas::{Align, BLACK, Canvas, WHITE, text_width, wrapped};
use super::legend;
use super::marks::Mark;
use super::sheet::Sheet;
use super::style::GRID;
use isostudy_statistics::interval::Interval;

const ROW: f64 = 21.0;
const HEADING: f64 = 30.0;
const BOTTOM: f64 = 44.0;
/// Room for labels on the left, at least, and for remarks on the right.
const LABELS: (f64, f64) = (265.0, 235.0);
/// Between a label and the axis.
const GAP: f64 = 14.0;
/// Labels that are longer are cut by the edge: an axis has to be left.
const MOST_LABEL: f64 = 480.0;
/// On a narrow sheet a row has its label and its remark above it, and the axis takes the width between these margins.
const MARGINS: (f64, f64) = (10.0, 14.0);
const NARROW_ROW: f64 = 36.0;
const HEADING_LINE: f64 = 17.0;

/// One estimate.
pub(super) struct Row {
    pub(super) label: String,
    pub(super) value: Option<f64>,
    pub(super) interval: Option<Interval>,
    pub(super) mark: Mark,
    pub(super) remark: String,
}

impl Row {
    /// Where what is drawn of it begins and ends.
    fn ends(&self) -> Option<(f64, f64)> {
        let interval = self.interval.map(|interval| (interval.low, interval.high));
        interval.or(self.value.map(|value| (value, value)))
    }
}

/// Rows under a heading.
pub(super) struct Block {
    pub(super) heading: String,
    pub(super) rows: Vec<Row>,
}

impl Block {
    /// The lines of its heading.
    fn heading(&self, sheet: Sheet) -> Vec<String> {
        wrapped(&self.heading, 12.5, sheet.length(f64::INFINITY, sheet.width()))
    }

    fn heading_height(&self, sheet: Sheet) -> f64 {
        HEADING + HEADING_LINE * (self.heading(sheet).len() - 1) as f64
    }
}

pub(super) fn height(sheet: Sheet, blocks: &[Block]) -> f64 {
    let row = sheet.length(ROW, NARROW_ROW);
    blocks.iter().map(|b| b.heading_height(sheet) + row * b.rows.len() as f64).sum::<f64>() + BOTTOM
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
    let sheet = canvas.sheet();
    let (em, width) = (sheet.em(), sheet.width());
    let (left, right) = match sheet {
        Sheet::Wide => (label_room(blocks, em), width - LABELS.1),
        Sheet::Narrow => (MARGINS.0, width - MARGINS.1),
    };
    let bottom = top + height(sheet, blocks) - BOTTOM;
    let x = |value: f64| axis.place(value, left, right);
    for &tick in &axis.ticks {
        canvas.line(vec![(x(tick), top + 8.0), (x(tick), bottom + 4.0)], GRID, 0.5);
    }
    for (at, text) in axis.labels_between(left, right, em) {
        canvas.text_within(text, (at, bottom + 17.0), (0.0, width), em);
    }
    canvas.line(vec![(x(reference), top + 8.0), (x(reference), bottom + 4.0)], BLACK, 0.75);
    let middle = (left + right) / 2.0;
    canvas.text_within(axis_label, (middle, bottom + 36.0), (0.0, width), sheet.large_em());
    let mut y = top;
    for block in blocks {
        for (line, text) in block.heading(sheet).into_iter().enumerate() {
            let baseline = y + HEADING - 9.0 + HEADING_LINE * line as f64;
            over_lines(canvas, text, (sheet.length(20.0, 0.0), baseline), 12.5, Align::Start);
        }
        y += block.heading_height(sheet);
        for row in &block.rows {
            let middle = match sheet {
                Sheet::Wide => y + ROW / 2.0,
                Sheet::Narrow => y + NARROW_ROW - 11.0,
            };
            if let Some(interval) = row.interval {
                bar(canvas, x(interval.low), x(interval.high), middle);
            }
            if let Some(value) = row.value {
                row.mark.draw(canvas, (x(value), middle));
            }
            match sheet {
                Sheet::Wide => {
                    canvas.text(&row.label, (left - GAP, middle + 0.36 * em), em, Align::End);
                    remark(canvas, &row.remark, right + GAP, middle + 0.36 * em);
                }
                Sheet::Narrow => {
                    let baseline = y + 13.0;
                    over_lines(canvas, row.label.clone(), (0.0, baseline), em, Align::Start);
                    // Of several columns the last, as far as there is room.
                    let last = row.remark.rsplit('\t').next().unwrap_or_default();
                    let room = text_width(last, em);
                    let (from, to) = row.ends().map_or((0.0, width), |(low, high)| (x(low), x(high)));
                    if text_width(&row.label, em) + em + room <= width {
                        over_lines(canvas, last.into(), (width, baseline), em, Align::End);
                    } else if to + em + room <= width {
                        over_lines(canvas, last.into(), (width, middle + 0.36 * em), em, Align::End);
                    } else if from - em >= room {
                        over_lines(canvas, last.into(), (0.0, middle + 0.36 * em), em, Align::Start);
                    }
                }
            }
            y += sheet.length(ROW, NARROW_ROW);
        }
    }
}

/// What labels take on a wide sheet.
fn label_room(blocks: &[Block], em: f64) -> f64 {
    let labels = blocks.iter().flat_map(|block| &block.rows).map(|row| text_width(&row.label, em));
    labels.map(|width| width + 2.0 * GAP).fold(LABELS.0, f64::max).min(MOST_LABEL)
}

/// Text that covers the lines under it, since on a narrow sheet it stands in the plot.
fn over_lines(canvas: &mut Canvas, text: String, (x, baseline): (f64, f64), em: f64, align: Align) {
    if canvas.sheet().is_narrow() && !text.is_empty() {
        let width = text_width(&text, em);
        let left = if align == Align::End { x - width } else { x };
        let right = (left + width + 2.0).min(canvas.sheet().width());
        canvas.rectangle((left, baseline - em), (right, baseline + 0.3 * em), WHITE);
    }
    canvas.text(text, (x, baseline), em, align);
}

/// Says what the remarks are, above them; on a narrow sheet each says so itself.
pub(super) fn remark_heading(canvas: &mut Canvas, text: &str, top: f64) {
    if !canvas.sheet().is_narrow() {
        remark(canvas, text, canvas.sheet().width() - LABELS.1 + GAP, top + HEADING - 9.0);
    }
}

/// Tabs part a remark into columns.
fn remark(canvas: &mut Canvas, text: &str, x: f64, baseline: f64) {
    const COLUMNS: [f64; 3] = [0.0, 78.0, 142.0];
    for (part, column) in text.split('\t').zip(COLUMNS) {
        canvas.text(part, (x + column, baseline), canvas.sheet().em(), Align::Start);
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
