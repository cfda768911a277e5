//! Legends: swatches with names, in as many rows as they need.

use super::canvas::{Align, BLACK, Canvas, Colour, WHITE, text_width};
use super::marks::Mark;
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

const EM: f64 = 12.0;
const ROW: f64 = 20.0;

/// Height of the legend on a canvas of this width.
pub(super) fn height(entries: &[(Swatch, String)], width: f64) -> f64 {
    place(entries, width).last().map_or(0.0, |&(_, row)| (row + 1) as f64 * ROW) + 6.0
}

/// Draws the legend from `left`, its upper edge at `top`.
pub(super) fn draw(canvas: &mut Canvas, entries: &[(Swatch, String)], left: f64, top: f64) {
    let places = place(entries, canvas.width() - left);
    for ((swatch, name), (x, row)) in entries.iter().zip(places) {
        let (x, middle) = (left + x, top + ROW * (row as f64 + 0.5));
        match swatch {
            Swatch::Area(fill) => fill.paint(canvas, (x, middle - 6.0), (x + 18.0, middle + 6.0)),
            Swatch::Diamond => diamond(canvas, (x + 9.0, middle)),
            Swatch::Whisker => whisker(canvas, x + 9.0, middle - 7.0, middle + 7.0),
            Swatch::Mark(mark) => mark.draw(canvas, (x + 9.0, middle)),
            Swatch::Line(colour) => canvas.line(vec![(x, middle), (x + 18.0, middle)], *colour, 1.5),
            Swatch::Dashes => canvas.dashes(x, x + 18.0, middle, BLACK),
        }
        canvas.text(name, (x + 24.0, middle + 0.36 * EM), EM, Align::Start);
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

/// Offset from the left and row of each entry.
fn place(entries: &[(Swatch, String)], width: f64) -> Vec<(f64, usize)> {
    let (mut x, mut row) = (0.0, 0);
    let mut places = Vec::new();
    for (_, name) in entries {
        let needs = 24.0 + text_width(name, EM) + 22.0;
        if x > 0.0 && x + needs - 22.0 > width {
            (x, row) = (0.0, row + 1);
        }
        places.push((x, row));
        x += needs;
    }
    places
}
