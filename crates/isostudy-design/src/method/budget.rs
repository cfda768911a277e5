//! What decides a method's resolution in place of the object's spacing.

use super::MethodId;
use serde::{Deserialize, Serialize};

/// What of another method's mesh must be met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Its triangles.
    Triangles,
    /// Its samples.
    Samples,
    /// The time of its extraction.
    Time,
}

impl Quantity {
    /// The key, and what is as much, for people.
    pub fn names(self) -> [&'static str; 2] {
        match self {
            Self::Triangles => ["triangles_of", "triangles"],
            Self::Samples => ["samples_of", "samples"],
            Self::Time => ["time_of", "time"],
        }
    }

    /// How near is near enough, if the study does not say it: times differ from one extraction to the next.
    fn within(self) -> f64 {
        match self {
            Self::Triangles | Self::Samples => 0.01,
            Self::Time => 0.05,
        }
    }
}

/// Another method of the study whose mesh must be met, by choice of the spacing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Keys", into = "Keys")]
pub struct BudgetSection {
    /// What must be met.
    pub quantity: Quantity,
    /// Whose.
    pub of: MethodId,
    /// The share of it by which the mesh may have more or less.
    pub within: f64,
}

impl BudgetSection {
    /// As much of a method's quantity, to 1 %, or 5 % of its time.
    pub fn new(quantity: Quantity, of: MethodId) -> Self {
        Self { quantity, of, within: quantity.within() }
    }
}

/// As it is written.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    #[serde(skip_serializing_if = "Option::is_none")]
    triangles_of: Option<MethodId>,
    #[serde(skip_serializing_if = "Option::is_none")]
    samples_of: Option<MethodId>,
    #[serde(skip_serializing_if = "Option::is_none")]
    time_of: Option<MethodId>,
    #[serde(skip_serializing_if = "Option::is_none")]
    within: Option<f64>,
}

impl TryFrom<Keys> for BudgetSection {
    type Error = &'static str;

    fn try_from(keys: Keys) -> Result<Self, Self::Error> {
        let (quantity, of) = match (keys.triangles_of, keys.samples_of, keys.time_of) {
            (Some(of), None, None) => (Quantity::Triangles, of),
            (None, Some(of), None) => (Quantity::Samples, of),
            (None, None, Some(of)) => (Quantity::Time, of),
            _ => return Err("match needs one of the keys triangles_of, samples_of and time_of"),
        };
        Ok(Self { within: keys.within.unwrap_or_else(|| quantity.within()), ..Self::new(quantity, of) })
    }
}

impl From<BudgetSection> for Keys {
    fn from(BudgetSection { quantity, of, within }: BudgetSection) -> Self {
        let within = (within != quantity.within()).then_some(within);
        let keys = Self { within, ..Self::default() };
        match quantity {
            Quantity::Triangles => Self { triangles_of: Some(of), ..keys },
            Quantity::Samples => Self { samples_of: Some(of), ..keys },
            Quantity::Time => Self { time_of: Some(of), ..keys },
        }
    }
}
