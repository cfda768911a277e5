//! A figure before it is painted.

use super::canvas::Canvas;
use super::error::FigureError;
use super::legend::{self, Swatch};
use crate::figure::Figure;

/// Width of every figure in units.
pub(super) const WIDTH: f64 = 1000.0;

/// Objects in rows of three panels at most, as evenly as they go.
pub(super) fn in_rows(objects: &[usize]) -> Vec<&[usize]> {
    const MOST: usize = 3;
    let rows = objects.len().div_ceil(MOST).max(1);
    objects.chunks(objects.len().div_ceil(rows).max(1)).collect()
}

/// A figure before it is painted.
pub(super) struct Unfinished {
    pub(super) name: &'static str,
    pub(super) caption: String,
    pub(super) canvas: Canvas,
}

impl Unfinished {
    pub(super) fn finish(self) -> Result<Figure, FigureError> {
        Ok(Figure {
            svg: self.canvas.to_svg(self.name)?,
            png: self.canvas.to_png(self.name)?,
            name: self.name.into(),
            caption: self.caption,
        })
    }
}

/// A canvas with its legend drawn, and where the space under the legend begins.
pub(super) fn canvas_with_legend(entries: &[(Swatch, String)], content_height: f64) -> (Canvas, f64) {
    const MARGIN: f64 = 10.0;
    const LEFT: f64 = 80.0;
    let top = MARGIN + legend::height(entries, WIDTH - LEFT);
    let mut canvas = Canvas::new(WIDTH, top + content_height + MARGIN);
    legend::draw(&mut canvas, entries, LEFT, MARGIN);
    (canvas, top)
}
