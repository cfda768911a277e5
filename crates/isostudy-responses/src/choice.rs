//! One answer's content.

/// What was chosen of the two that were shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Choice {
    /// What was on the left.
    Left,
    /// No preference.
    NoPreference,
    /// What was on the right.
    Right,
}

impl Choice {
    /// The three choices, left to right.
    pub const ALL: [Self; 3] = [Self::Left, Self::NoPreference, Self::Right];

    /// How a study's own table writes it: `L`, `NP`, `R`.
    pub fn code(self) -> &'static str {
        match self {
            Self::Left => "L",
            Self::NoPreference => "NP",
            Self::Right => "R",
        }
    }

    /// How the long format writes it: `left`, `none`, `right`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::NoPreference => "none",
            Self::Right => "right",
        }
    }

    /// The same answer, seen with the sides swapped.
    pub fn swapped(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::NoPreference => Self::NoPreference,
            Self::Right => Self::Left,
        }
    }
}
