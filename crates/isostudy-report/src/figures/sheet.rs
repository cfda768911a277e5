//! The sheets that figures are drawn on, and what differs between them.

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
