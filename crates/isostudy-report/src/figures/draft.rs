//! A figure before it is painted.

use super::canvas::Canvas;
use super::error::FigureError;
use super::legend::{self, Swatch};
use super::sheet::Sheet;
use crate::figure::Figure;

/// A figure before it is painted.
pub(super) struct Unfinished {
    pub(super) name: &'static str,
    pub(super) caption: String,
    pub(super) canvas: Canvas,
}

impl Unfinished {
    /// A figure that is not drawn for phones.
    pub(super) fn finish(self) -> Result<Figure, FigureError> {
        Ok(Figure {
            svg: self.canvas.to_svg(self.name)?,
            narrow: None,
            png: self.canvas.to_png(self.name)?,
            name: self.name.into(),
            caption: self.caption,
        })
    }

    /// One that is, too: `narrow` is the same on the narrow sheet.
    pub(super) fn finish_with(self, narrow: Self) -> Result<Figure, FigureError> {
        assert_eq!(self.name, narrow.name, "the same figures are drawn on both sheets");
        let narrow = narrow.canvas.to_svg(narrow.name)?;
        Ok(Figure { narrow: Some(narrow), ..self.finish()? })
    }
}

/// A canvas with its legend drawn, and where the space under the legend begins.
pub(super) fn canvas_with_legend(
    sheet: Sheet,
    entries: &[(Swatch, String)],
    content_height: f64,
) -> (Canvas, f64) {
    const MARGIN: f64 = 10.0;
    let left = sheet.length(80.0, 0.0);
    let top = MARGIN + legend::height(entries, sheet, sheet.width() - left);
    let mut canvas = Canvas::on(sheet, top + content_height + MARGIN);
    legend::draw(&mut canvas, entries, left, MARGIN);
    (canvas, top)
}
