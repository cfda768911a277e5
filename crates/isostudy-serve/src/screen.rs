//! On what an answer was given: window, input, and what the browser did not show. Nothing here names a browser or a device.

use serde::{Deserialize, Serialize};

/// Longest time for one answer that is believed, in milliseconds: a day.
pub const LONGEST_MS: u32 = 86_400_000;

/// Whether the two surfaces were side by side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Layout {
    /// Side by side.
    Beside,
    /// The left one over the right one.
    Stacked,
}

/// What an answer was given with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Input {
    /// A mouse, or what acts as one.
    Mouse,
    /// A finger.
    Touch,
    /// A pen.
    Pen,
    /// Keys.
    Keyboard,
}

/// As what a pair was shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ShownAs {
    /// An animation.
    Gif,
    /// A still picture.
    Png,
    /// H.264 video.
    Mp4,
    /// VP9 video.
    WebM,
    /// Models that the participant turns.
    Model,
}

/// On what an answer was given. Widths and heights are in CSS pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Screen {
    /// Width of the window.
    pub viewport_width: u32,
    /// Height of the window.
    pub viewport_height: u32,
    /// Pixels of the screen for one CSS pixel, in thousandths at most.
    pub pixel_ratio: f64,
    /// Largest width that each surface had.
    pub surface_px: u32,
    /// How the surfaces stood when it was given.
    pub layout: Layout,
    /// What it was given with.
    pub input: Input,
    /// Frames of the pair that nobody can have seen, since the browser drew nothing while it was their turn.
    pub dropped: u32,
    /// Milliseconds for which the page was out of sight after the pair was first seen.
    pub hidden_ms: u32,
    /// As what the pair was shown.
    pub shown_as: ShownAs,
    /// Degrees by which models were turned, there and back: of models alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turned_deg: Option<u32>,
}

/// Columns of answers, in the order of [`Screen`].
pub use isostudy_responses::SCREEN_COLUMNS as COLUMNS;

/// Largest window that is believed.
const LARGEST_PX: u32 = 100_000;
/// Most degrees that are believed, ten thousand turns.
const MOST_DEG: u32 = 3_600_000;
/// Steps in which windows are told to others.
const STEP_PX: u32 = 50;

impl Screen {
    /// Whether a browser can have said it.
    pub fn is_sound(&self) -> bool {
        let Self { viewport_width, viewport_height, pixel_ratio, surface_px, .. } = *self;
        [viewport_width, viewport_height, surface_px].iter().all(|&pixels| pixels <= LARGEST_PX)
            && (0.01..=100.0).contains(&pixel_ratio)
            && self.hidden_ms <= LONGEST_MS
            && self.turned_deg.is_none_or(|deg| deg <= MOST_DEG && self.shown_as == ShownAs::Model)
    }

    /// As it can be given to others: windows, which may be as large as nobody else's, rounded down to whole steps of 50 pixels.
    pub fn rounded(self) -> Self {
        let down = |pixels: u32| pixels / STEP_PX * STEP_PX;
        Self {
            viewport_width: down(self.viewport_width),
            viewport_height: down(self.viewport_height),
            surface_px: down(self.surface_px),
            ..self
        }
    }
}

/// The cells of an answer's [`COLUMNS`]: empty where nothing was recorded.
pub(crate) fn cells(screen: Option<&Screen>) -> [String; COLUMNS.len()] {
    let Some(screen) = screen else { return Default::default() };
    let said = serde_json::to_value(screen).expect("numbers and words alone");
    COLUMNS.map(|name| match &said[name] {
        serde_json::Value::String(word) => word.clone(),
        // What the page has no number for.
        serde_json::Value::Null => String::new(),
        // A whole ratio has no point.
        number => number.as_f64().map_or(String::new(), |number| number.to_string()),
    })
}

/// The answer's screen from its [`COLUMNS`], as text; `None` where all are empty.
///
/// # Errors
/// What is wrong, where some are there and not all, or one is none of what it can be.
pub(crate) fn of_cells(cells: &[String; COLUMNS.len()]) -> Result<Option<Screen>, String> {
    if cells.iter().all(String::is_empty) {
        return Ok(None);
    }
    let mut said = serde_json::Map::new();
    for (name, cell) in COLUMNS.iter().zip(cells) {
        if *name == "turned_deg" && cell.is_empty() {
            continue;
        }
        let number = cell.parse::<serde_json::Number>().map(serde_json::Value::Number);
        said.insert((*name).to_owned(), number.unwrap_or_else(|_| cell.as_str().into()));
    }
    let screen: Screen = serde_json::from_value(said.into()).map_err(|error| error.to_string())?;
    if screen.is_sound() { Ok(Some(screen)) } else { Err("no screen has such a size".into()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PHONE: Screen = Screen {
        viewport_width: 390,
        viewport_height: 844,
        pixel_ratio: 2.625,
        surface_px: 266,
        layout: Layout::Stacked,
        input: Input::Touch,
        dropped: 3,
        hidden_ms: 0,
        shown_as: ShownAs::Model,
        turned_deg: Some(147),
    };

    #[test]
    fn cells_say_what_was_recorded() {
        let expected =
            ["390", "844", "2.625", "266", "stacked", "touch", "3", "0", "model", "147"].map(String::from);
        assert_eq!(cells(Some(&PHONE)), expected);
        assert_eq!(of_cells(&expected), Ok(Some(PHONE)));
        assert_eq!(of_cells(&cells(None)), Ok(None));
        let mut turntable = expected.clone();
        turntable[8] = "gif".into();
        assert!(of_cells(&turntable).is_err(), "an animation cannot be turned");
        turntable[9] = String::new();
        assert_eq!(of_cells(&turntable).map(|screen| cells(screen.as_ref())), Ok(turntable));
        for wrong in ["", "sideways", "-1", "1e9"] {
            // Whatever was not turned has no degrees.
            for column in 0..COLUMNS.len() - usize::from(wrong.is_empty()) {
                let mut changed = expected.clone();
                changed[column] = wrong.into();
                assert!(of_cells(&changed).is_err(), "{} {wrong}", COLUMNS[column]);
            }
        }
    }

    #[test]
    fn others_see_no_windows_of_a_kind() {
        let Screen { viewport_width, viewport_height, surface_px, .. } = PHONE.rounded();
        assert_eq!((viewport_width, viewport_height, surface_px), (350, 800, 250));
        assert_eq!(
            Screen { viewport_width: 390, viewport_height: 844, surface_px: 266, ..PHONE.rounded() },
            PHONE
        );
    }
}
