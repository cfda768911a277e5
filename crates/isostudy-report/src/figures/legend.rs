//! Legends: swatches with names, in as many rows as they need.

use super::canvas::{Align, BLACK, Canvas, Colour, WHITE, text_width, wrapped};
use super::marks::Mark;
use super::sheet::Sheet;
use super::style::Fill;

/// What stands before a name.
#[derive(Debug, Clone, Copy)]
pub(super) enum Swatch {
    Area(Fill),
    /// A published value.
    Diamond,
    /// An interval.
    Whisker,
    /// The largest value possible.
    Dashes,
    /// A mark told by its shape.
    Mark(Mark),
    /// A line of this colour.
    Line(Colour),
}

const ROW: f64 = 20.0;
/// From a swatch's left edge to its name, and from a name to the next swatch.
const SWATCH: f64 = 24.0;
const GAP: f64 = 22.0;

/// Height of the legend on a part of a sheet of this width.
pub(super) fn height(entries: &[(Swatch, String)], sheet: Sheet, width: f64) -> f64 {
    place(entries, sheet, width).iter().map(|at| (at.row + at.lines.len()) as f64 * ROW).fold(0.0, f64::max)
        + 6.0
}

/// Draws the legend from `left`, its upper edge at `top`.
pub(super) fn draw(canvas: &mut Canvas, entries: &[(Swatch, String)], left: f64, top: f64) {
    let sheet = canvas.sheet();
    let em = sheet.large_em();
    for ((swatch, _), at) in entries.iter().zip(place(entries, sheet, sheet.width() - left)) {
        let (x, middle) = (left + at.x, top + ROW * (at.row as f64 + 0.5));
        match swatch {
            Swatch::Area(fill) => fill.paint(canvas, (x, middle - 6.0), (x + 18.0, middle + 6.0)),
            Swatch::Diamond => diamond(canvas, (x + 9.0, middle)),
            Swatch::Whisker => whisker(canvas, x + 9.0, middle - 7.0, middle + 7.0),
            Swatch::Mark(mark) => mark.draw(canvas, (x + 9.0, middle)),
            Swatch::Line(colour) => canvas.line(vec![(x, middle), (x + 18.0, middle)], *colour, 1.5),
            Swatch::Dashes => canvas.dashes(x, x + 18.0, middle, BLACK),
        }
        for (line, text) in at.lines.into_iter().enumerate() {
            let baseline = middle + ROW * line as f64 + 0.36 * em;
            canvas.text(text, (x + SWATCH, baseline), em, Align::Start);
        }
    }
}

/// The mark of a published value.
pub(super) fn diamond(canvas: &mut Canvas, (x, y): (f64, f64)) {
    let at = |r: f64| vec![(x, y - r), (x + r, y), (x, y + r), (x - r, y)];
    canvas.polygon(at(5.0), WHITE);
    canvas.polygon(at(4.0), BLACK);
    canvas.polygon(at(2.5), WHITE);
}

/// An interval's line with its two ends, white-edged so that it shows on any fill.
pub(super) fn whisker(canvas: &mut Canvas, x: f64, y0: f64, y1: f64) {
    for (colour, width, reach) in [(WHITE, 3.0, 4.5), (BLACK, 1.0, 4.0)] {
        canvas.line(vec![(x, y0), (x, y1)], colour, width);
        for y in [y0, y1] {
            canvas.line(vec![(x - reach, y), (x + reach, y)], colour, width);
        }
    }
}

/// Where an entry stands: its offset from the left, its first row, and the lines of its name.
struct Place {
    x: f64,
    row: usize,
    lines: Vec<String>,
}

fn place(entries: &[(Swatch, String)], sheet: Sheet, width: f64) -> Vec<Place> {
    let em = sheet.large_em();
    let (mut x, mut row, mut rows) = (0.0, 0, 1);
    let mut places = Vec::new();
    for (_, name) in entries {
        let lines = wrapped(name, em, width - SWATCH);
        let needs = SWATCH + lines.iter().map(|line| text_width(line, em)).fold(0.0, f64::max);
        if x > 0.0 && x + needs > width {
            (x, row, rows) = (0.0, row + rows, 1);
        }
        rows = rows.max(lines.len());
        places.push(Place { x, row, lines });
        x += needs + GAP;
    }
    places
}
