//! People of whom nothing is kept but that they were there.

use serde::Serialize;

/// Why somebody left, as it is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Departure {
    Withdrawn,
    ScreenedOut,
    Full,
}

impl Departure {
    pub(super) const ALL: [Self; 3] = [Self::Withdrawn, Self::ScreenedOut, Self::Full];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Withdrawn => "withdrawn",
            Self::ScreenedOut => "screened-out",
            Self::Full => "full",
        }
    }
}

/// How many people have left of whom nothing is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Departures {
    /// Who had their answers deleted.
    pub withdrawn: u64,
    /// Whom the study does not ask.
    pub screened_out: u64,
    /// Who came when enough people had said the same of themselves.
    pub full: u64,
}
