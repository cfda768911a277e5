//! What decides a method's resolution in place of the object's spacing.

use super::MethodId;
use serde::{Deserialize, Serialize};

/// Another method of the study whose mesh must be met, by choice of the spacing: one of the three.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum BudgetSection {
    /// As many triangles, to 1 %.
    TrianglesOf(MethodId),
    /// As many samples, to 1 %.
    SamplesOf(MethodId),
    /// As much time for an extraction, to 5 %.
    TimeOf(MethodId),
}

impl BudgetSection {
    /// The method whose mesh must be met.
    pub fn of(self) -> MethodId {
        match self {
            Self::TrianglesOf(id) | Self::SamplesOf(id) | Self::TimeOf(id) => id,
        }
    }

    /// The key, and what is as much, for people.
    pub fn names(self) -> [&'static str; 2] {
        match self {
            Self::TrianglesOf(_) => ["triangles_of", "triangles"],
            Self::SamplesOf(_) => ["samples_of", "samples"],
            Self::TimeOf(_) => ["time_of", "time"],
        }
    }
}
