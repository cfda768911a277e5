//! A figure before it is painted, and the sheets that it is drawn on.

use super::canvas::Canvas;
use super::error::FigureError;
use super::legend::{self, Swatch};
use crate::figure::Figure;

/// What a figure is drawn on: a page of a laptop, or once more that of a phone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sheet {
    /// Panels stand side by side.
    Wide,
    /// Panels stand one below the other. As wide as a phone's screen of 390 pixels leaves between the margins of a page, so that
    /// letters are as large as they are drawn.
    Narrow,
}

impl Sheet {
    /// In units.
    pub(super) fn width(self) -> f64 {
        match self {
            Self::Wide => 1000.0,
            Self::Narrow => 360.0,
        }
    }

    /// The smallest letters. On a phone they can hardly be smaller than those of the page.
    pub(super) fn em(self) -> f64 {
        match self {
            Self::Wide => 11.0,
            Self::Narrow => 12.0,
        }
    }

    /// The letters of legends, headings and axes.
    pub(super) fn large_em(self) -> f64 {
        match self {
            Self::Wide => 12.0,
            Self::Narrow => 12.5,
        }
    }

    /// How many panels stand side by side where `most` would do on a wide sheet.
    pub(super) fn columns(self, most: usize) -> usize {
        match self {
            Self::Wide => most.max(1),
            Self::Narrow => 1,
        }
    }

    /// A length that a phone has less room for.
    pub(super) fn length(self, wide: f64, narrow: f64) -> f64 {
        match self {
            Self::Wide => wide,
            Self::Narrow => narrow,
        }
    }

    pub(super) fn is_narrow(self) -> bool {
        self == Self::Narrow
    }

    /// Objects in rows of three panels at most, as evenly as they go.
    pub(super) fn in_rows(self, objects: &[usize]) -> Vec<&[usize]> {
        let rows = objects.len().div_ceil(self.columns(3)).max(1);
        objects.chunks(objects.len().div_ceil(rows).max(1)).collect()
    }
}

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
