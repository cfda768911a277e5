//! What a study compares: methods, the objects that they are applied to, and the factors in which methods differ.

mod budget;
mod crossing;
mod factor;
mod look;
mod recipe;

pub use budget::{BudgetSection, Quantity};
pub use crossing::{Arrangement, Clustering, Crossed};
pub(crate) use crossing::{expand, is_summed};
pub use factor::{Factor, FactorSpec, Level, LevelSpec};
pub use look::StimulusLook;
pub use recipe::{Recipe, TETRAHEDRA};

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// The longest id of a method, in bytes.
const LONGEST: usize = 16;

/// A method's id: 1 to 16 of a-z, 0-9 and hyphen, a letter first. Ids are ordered as text, which means nothing: what has an
/// order has that of the study.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MethodId {
    /// Filled up with zeros, so that it can be copied: ids are passed by every answer and sample.
    text: [u8; LONGEST],
}

impl MethodId {
    /// The id as text.
    pub fn as_str(&self) -> &str {
        let length = self.text.iter().position(|&byte| byte == 0).unwrap_or(LONGEST);
        std::str::from_utf8(&self.text[..length]).expect("ids are ASCII")
    }
}

impl fmt::Display for MethodId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Debug for MethodId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

/// Why a text is not an id.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ParseIdError {
    /// Not a method's id.
    #[error(
        "\"{0}\" is not a method's id: write 1 to {LONGEST} of a-z, 0-9 and hyphen, a letter first, as in \"bi\""
    )]
    Method(String),
    /// Not of the form object, underscore, method.
    #[error("\"{0}\" is not a configuration: write an object, an underscore and a method, as in \"ss_bi\"")]
    Configuration(String),
}

impl FromStr for MethodId {
    type Err = ParseIdError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let plain = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'-';
        let first = text.bytes().next().is_some_and(|byte| byte.is_ascii_lowercase());
        if !first || text.len() > LONGEST || !text.bytes().all(plain) {
            return Err(ParseIdError::Method(text.into()));
        }
        let mut id = Self { text: [0; LONGEST] };
        id.text[..text.len()].copy_from_slice(text.as_bytes());
        Ok(id)
    }
}

/// A method of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Method {
    /// Its id, unique in the study.
    pub id: MethodId,
    /// The name used in tables and figures, such as `body-centred, integrated`.
    pub label: String,
    /// The name used in sentences, such as `integrated clustering on the body-centred lattice`.
    pub phrase: String,
    /// How a mesh is made.
    pub recipe: Recipe,
    /// What decides its resolution in place of the object's spacing.
    pub budget: Option<BudgetSection>,
    /// How its meshes look in animations; `None` as all do.
    pub look: Option<StimulusLook>,
    /// Why no choice names it; `None` of those that are compared.
    pub apart: Option<String>,
    /// For each declared factor of the study, by place, the level that the method is an example of, by place.
    pub levels: Vec<Option<usize>>,
}

/// An object's id and a method's: `ss_bi` is the sphere with the method `bi`.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ConfigurationId {
    /// The object's id, such as `ss`.
    pub object: String,
    /// The method's id, such as `bi`.
    pub method: MethodId,
}

impl fmt::Display for ConfigurationId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}_{}", self.object, self.method)
    }
}

impl FromStr for ConfigurationId {
    type Err = ParseIdError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (object, method) =
            text.rsplit_once('_').ok_or_else(|| ParseIdError::Configuration(text.into()))?;
        if object.is_empty() {
            return Err(ParseIdError::Configuration(text.into()));
        }
        Ok(Self { object: object.into(), method: method.parse()? })
    }
}

/// Serialise through the text form.
macro_rules! serde_as_text {
    ($type:ty) => {
        impl Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_str(self)
            }
        }
        impl<'de> Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
            }
        }
    };
}
serde_as_text!(MethodId);
serde_as_text!(ConfigurationId);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_printed_as_they_are_read() {
        for text in ["as_sp", "ss_vtk-flying-edges", "ss_a", "ss_sixteen-letters0"] {
            let method = text.split('_').nth(1).unwrap();
            match text.parse::<ConfigurationId>() {
                Ok(id) => assert_eq!((id.to_string().as_str(), id.method.as_str()), (text, method)),
                Err(error) => assert!(method.len() > LONGEST, "{error}"),
            }
        }
    }

    #[test]
    fn anything_else_is_refused() {
        for text in [
            "",
            "_",
            "ss",
            "ss_",
            "_bi",
            "ss_B",
            "ss_1b",
            "ss_-b",
            "ss_b i",
            "ss_b\u{fc}",
            "ss_seventeen-letters",
        ] {
            assert!(text.parse::<ConfigurationId>().is_err(), "{text}");
        }
    }
}
