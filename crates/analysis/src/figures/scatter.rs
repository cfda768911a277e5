//! A panel of marks over two axes.

use super::axis::Axis;
use super::bars::frame;
use super::canvas::{Align, BLACK, Canvas, Colour};
use super::marks::Mark;
use super::style::GRID;

const LEFT: f64 = 80.0;
const RIGHT: f64 = 26.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = 44.0;
const EM: f64 = 11.0;

/// Where a name stands.
#[derive(Debug, Clone, Copy)]
pub(super) enum Corner {
    LowerRight,
    UpperLeft,
}

/// A panel.
pub(super) struct Scatter {
    pub(super) heading: String,
    pub(super) labels: (String, String),
    pub(super) x: Axis,
    pub(super) y: Axis,
    /// Lines under the marks.
    pub(super) lines: Vec<(Colour, Vec<(f64, f64)>)>,
    /// A dashed line at this height.
    pub(super) dashed: Option<f64>,
    pub(super) marks: Vec<((f64, f64), Mark)>,
    /// Names of points: below on the right, or above on the left.
    pub(super) names: Vec<((f64, f64), String, Corner)>,
}

impl Scatter {
    /// Draws the panel into a rectangle.
    pub(super) fn draw(&self, canvas: &mut Canvas, from: (f64, f64), to: (f64, f64)) {
        let (left, right) = (from.0 + LEFT, to.0 - RIGHT);
        let (top, bottom) = (from.1 + TOP, to.1 - BOTTOM);
        frame(canvas, &self.y, &self.labels.1, (left, right), (bottom, top));
        let place = |(x, y): (f64, f64)| (self.x.place(x, left, right), self.y.place(y, bottom, top));
        for (&tick, text) in self.x.ticks.iter().zip(self.x.labels()) {
            let x = self.x.place(tick, left, right);
            canvas.line(vec![(x, top), (x, bottom + 4.0)], GRID, 0.5);
            canvas.text(text, (x, bottom + 16.0), EM, Align::Middle);
        }
        canvas.line(vec![(left, bottom), (right, bottom)], BLACK, 1.0);
        canvas.text(&self.labels.0, ((left + right) / 2.0, bottom + 34.0), EM, Align::Middle);
        canvas.text(&self.heading, ((left + right) / 2.0, from.1 + 20.0), 12.5, Align::Middle);
        if let Some(height) = self.dashed {
            canvas.dashes(left, right, self.y.place(height, bottom, top), BLACK);
        }
        for (colour, line) in &self.lines {
            canvas.line(line.iter().map(|&point| place(point)).collect(), *colour, 1.5);
        }
        for (at, mark) in &self.marks {
            mark.draw(canvas, place(*at));
        }
        for (at, name, corner) in &self.names {
            let (x, y) = place(*at);
            match corner {
                Corner::LowerRight => canvas.text(name, (x + 8.0, y + 1.1 * EM), EM, Align::Start),
                Corner::UpperLeft => canvas.text(name, (x - 8.0, y - 0.4 * EM), EM, Align::End),
            }
        }
    }
}
