//! On what an answer was given, where the file says it: the columns that isostudy's own page records.

use std::num::NonZeroU32;

/// A column: its name, and what of a [`Screen`] it says.
enum Column {
    /// A number from 0.
    Number(&'static str, fn(&mut Screen) -> &mut Option<f32>),
    /// One of some words.
    Word(&'static str, &'static [&'static str], fn(&mut Screen) -> &mut Option<&'static str>),
}

const COLUMNS: [Column; 10] = [
    Column::Number("viewport_width", |screen| &mut screen.viewport_width),
    Column::Number("viewport_height", |screen| &mut screen.viewport_height),
    Column::Number("pixel_ratio", |screen| &mut screen.pixel_ratio),
    Column::Number("surface_px", |screen| &mut screen.surface_px),
    Column::Word("layout", &["beside", "stacked"], |screen| &mut screen.layout),
    Column::Word("input", &["mouse", "touch", "pen", "keyboard"], |screen| &mut screen.input),
    Column::Number("dropped", |screen| &mut screen.dropped),
    Column::Number("hidden_ms", |screen| &mut screen.hidden_ms),
    Column::Word("shown_as", &["gif", "mp4", "webm", "model"], |screen| &mut screen.shown_as),
    Column::Number("turned_deg", |screen| &mut screen.turned_deg),
];

/// Columns of the long format that say it, in the order of [`Screen`].
pub const SCREEN_COLUMNS: [&str; COLUMNS.len()] = {
    let mut names = [""; COLUMNS.len()];
    let mut place = 0;
    while place < names.len() {
        names[place] = match COLUMNS[place] {
            Column::Number(name, _) | Column::Word(name, ..) => name,
        };
        place += 1;
    }
    names
};

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
    /// `gif`, `mp4`, `webm` or `model`: as what the pair was shown.
    pub shown_as: Option<&'static str>,
    /// Degrees by which the models were turned, there and back; `None` of what cannot be turned.
    pub turned_deg: Option<f32>,
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
    pub(crate) fn cells(mut self) -> [String; COLUMNS.len()] {
        COLUMNS.map(|column| match column {
            Column::Number(_, of) => of(&mut self).map_or(String::new(), |value| value.to_string()),
            Column::Word(_, _, of) => of(&mut self).unwrap_or_default().to_owned(),
        })
    }

    /// Takes a cell of one of [`SCREEN_COLUMNS`], which is not empty.
    ///
    /// # Errors
    /// What it can be.
    pub(crate) fn set(&mut self, column: usize, cell: &str) -> Result<(), String> {
        match COLUMNS[column] {
            Column::Number(_, of) => {
                let sound = |value: &f32| value.is_finite() && *value >= 0.0;
                *of(self) = Some(cell.parse().ok().filter(sound).ok_or("not a number from 0")?);
            }
            Column::Word(_, known, of) => {
                let word = known.iter().copied().find(|word| *word == cell);
                *of(self) = Some(word.ok_or_else(|| format!("not one of {}", known.join(", ")))?);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_come_back() {
        let cells = ["390", "844", "2.625", "266", "stacked", "touch", "3", "0", "model", "147"];
        let mut screen = Screen::default();
        assert_eq!(screen.cells(), <[String; 10]>::default());
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
