//! On what an answer was given, where the file says it: the columns that isostudy's own page records.

use std::num::NonZeroU32;

/// Columns of the long format that say it, in the order of [`Screen`].
pub const SCREEN_COLUMNS: [&str; 9] = [
    "viewport_width",
    "viewport_height",
    "pixel_ratio",
    "surface_px",
    "layout",
    "input",
    "dropped",
    "hidden_ms",
    "shown_as",
];

/// How many of [`SCREEN_COLUMNS`] are numbers, and which.
const NUMBERS: [usize; 6] = [0, 1, 2, 3, 6, 7];
/// What the others may say.
const WORDS: [(usize, &[&str]); 3] =
    [(4, &["beside", "stacked"]), (5, &["mouse", "touch", "pen", "keyboard"]), (8, &["gif", "mp4", "webm"])];

/// On what an answer was given; whatever was not recorded is `None`. Widths and heights are in CSS pixels.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Screen {
    /// Width of the window.
    pub viewport_width: Option<f32>,
    /// Height of the window.
    pub viewport_height: Option<f32>,
    /// Pixels of the screen for one CSS pixel.
    pub pixel_ratio: Option<f32>,
    /// Largest width that each surface had.
    pub surface_px: Option<f32>,
    /// `beside` or `stacked`.
    pub layout: Option<&'static str>,
    /// `mouse`, `touch`, `pen` or `keyboard`.
    pub input: Option<&'static str>,
    /// Frames that the browser did not show.
    pub dropped: Option<f32>,
    /// Milliseconds for which the page was out of sight.
    pub hidden_ms: Option<f32>,
    /// `gif`, `mp4` or `webm`: how the pair was stored.
    pub shown_as: Option<&'static str>,
}

/// The number of a screen in [`Responses::screens`](crate::Responses::screens).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScreenId(NonZeroU32);

impl ScreenId {
    /// The id of a place in [`Responses::screens`](crate::Responses::screens), counted from 0.
    ///
    /// # Panics
    /// For the last of all numbers, which no file has.
    pub fn new(place: u32) -> Self {
        Self(place.checked_add(1).and_then(NonZeroU32::new).expect("fewer screens than numbers"))
    }

    /// The place in [`Responses::screens`](crate::Responses::screens), counted from 0.
    pub fn place(self) -> usize {
        self.0.get() as usize - 1
    }
}

impl Screen {
    /// The cells of [`SCREEN_COLUMNS`].
    pub(crate) fn cells(&self) -> [String; 9] {
        let number = |value: Option<f32>| value.map_or(String::new(), |value| value.to_string());
        let word = |value: Option<&str>| value.unwrap_or_default().to_owned();
        [
            number(self.viewport_width),
            number(self.viewport_height),
            number(self.pixel_ratio),
            number(self.surface_px),
            word(self.layout),
            word(self.input),
            number(self.dropped),
            number(self.hidden_ms),
            word(self.shown_as),
        ]
    }

    /// Takes a cell of one of [`SCREEN_COLUMNS`], which is not empty.
    ///
    /// # Errors
    /// What it can be.
    pub(crate) fn set(&mut self, column: usize, cell: &str) -> Result<(), String> {
        if NUMBERS.contains(&column) {
            let sound = |value: &f32| value.is_finite() && *value >= 0.0;
            let value = Some(cell.parse().ok().filter(sound).ok_or("not a number from 0")?);
            match column {
                0 => self.viewport_width = value,
                1 => self.viewport_height = value,
                2 => self.pixel_ratio = value,
                3 => self.surface_px = value,
                6 => self.dropped = value,
                _ => self.hidden_ms = value,
            }
            return Ok(());
        }
        let known = WORDS.iter().find(|(of, _)| *of == column).map_or(&[][..], |(_, words)| words);
        let word = known.iter().copied().find(|word| *word == cell);
        let value = Some(word.ok_or_else(|| format!("not one of {}", known.join(", ")))?);
        match column {
            4 => self.layout = value,
            5 => self.input = value,
            _ => self.shown_as = value,
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_come_back() {
        let cells = ["390", "844", "2.625", "266", "stacked", "touch", "3", "0", "webm"];
        let mut screen = Screen::default();
        assert_eq!(screen.cells(), <[String; 9]>::default());
        for (column, cell) in cells.iter().enumerate() {
            screen.set(column, cell).unwrap();
            for wrong in ["-1", "inf", "Safari"] {
                assert!(Screen::default().set(column, wrong).is_err(), "{} {wrong}", SCREEN_COLUMNS[column]);
            }
        }
        assert_eq!(screen.cells(), cells);
        assert_eq!(
            (screen.viewport_width, screen.input, screen.dropped),
            (Some(390.0), Some("touch"), Some(3.0))
        );
    }
}
