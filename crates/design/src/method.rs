//! Arrangements, clusterings and the ids that the paper gives to their combinations.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// How sample points are laid out in space.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Arrangement {
    /// Body-centred cubic: two interleaved cubic grids. Code `b`.
    BodyCentred,
    /// Simple cubic: one cubic grid. Code `s`.
    SimpleCubic,
    /// One cubic grid with five tetrahedra a cube, neighbours mirrored. Code `m`; not in the paper.
    FiveTetrahedra,
    /// Cube corners, face centres and cube centres, 24 tetrahedra a cube. Code `f`; not in the paper.
    FaceCentred,
}

/// How the vertices round a sample point are merged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clustering {
    /// No merging: plain marching tetrahedra. Code `u`.
    None,
    /// Merging inside the vertex stage. Code `i`.
    Integrated,
    /// Short edges collapsed after extraction. Code `p`.
    EdgeCollapse,
    /// Merging inside the vertex stage, then short edges collapsed. Code `c`; not in the paper.
    IntegratedCollapse,
}

impl Arrangement {
    /// The paper's one-letter code, and two more.
    pub fn code(self) -> char {
        match self {
            Self::BodyCentred => 'b',
            Self::SimpleCubic => 's',
            Self::FiveTetrahedra => 'm',
            Self::FaceCentred => 'f',
        }
    }

    /// Whether there is such a clustering for it: integrated clustering is for the paper's two.
    pub fn supports(self, clustering: Clustering) -> bool {
        match (self, clustering) {
            (Self::BodyCentred | Self::SimpleCubic, _) => true,
            (Self::FiveTetrahedra | Self::FaceCentred, Clustering::None | Clustering::EdgeCollapse) => true,
            (
                Self::FiveTetrahedra | Self::FaceCentred,
                Clustering::Integrated | Clustering::IntegratedCollapse,
            ) => false,
        }
    }

    /// The name used in tables and figures.
    pub fn label(self) -> &'static str {
        match self {
            Self::BodyCentred => "body-centred",
            Self::SimpleCubic => "simple cubic",
            Self::FiveTetrahedra => "five tetrahedra",
            Self::FaceCentred => "face-centred",
        }
    }
}

impl Clustering {
    /// The paper's one-letter code.
    pub fn code(self) -> char {
        match self {
            Self::None => 'u',
            Self::Integrated => 'i',
            Self::EdgeCollapse => 'p',
            Self::IntegratedCollapse => 'c',
        }
    }

    /// The name used in tables and figures.
    pub fn label(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Integrated => "integrated",
            Self::EdgeCollapse => "edge collapse",
            Self::IntegratedCollapse => "integrated + collapse",
        }
    }
}

/// An arrangement with a clustering, written as two letters: `bi` is body-centred, integrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Method {
    /// How sample points are laid out.
    pub arrangement: Arrangement,
    /// How vertices are merged.
    pub clustering: Clustering,
}

impl Method {
    /// The name used in tables and figures, such as `body-centred, integrated`.
    pub fn label(self) -> String {
        format!("{}, {}", self.arrangement.label(), self.clustering.label())
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.arrangement.code(), self.clustering.code())
    }
}

/// Why a text is not an id.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ParseIdError {
    /// Not a two-letter method code.
    #[error(
        "\"{0}\" is not a method: write an arrangement (b, s, m, f) and a clustering (u, i, p, c), as in \"bi\""
    )]
    Method(String),
    /// Not of the form object, underscore, method.
    #[error("\"{0}\" is not a configuration: write an object, an underscore and a method, as in \"ss_bi\"")]
    Configuration(String),
}

impl FromStr for Method {
    type Err = ParseIdError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut letters = text.chars();
        let arrangement = match letters.next() {
            Some('b') => Arrangement::BodyCentred,
            Some('s') => Arrangement::SimpleCubic,
            Some('m') => Arrangement::FiveTetrahedra,
            Some('f') => Arrangement::FaceCentred,
            _ => return Err(ParseIdError::Method(text.into())),
        };
        let clustering = match letters.next() {
            Some('u') => Clustering::None,
            Some('i') => Clustering::Integrated,
            Some('p') => Clustering::EdgeCollapse,
            Some('c') => Clustering::IntegratedCollapse,
            _ => return Err(ParseIdError::Method(text.into())),
        };
        match letters.next() {
            None => Ok(Self { arrangement, clustering }),
            Some(_) => Err(ParseIdError::Method(text.into())),
        }
    }
}

/// An object's id and a method: `ss_bi` is the sphere, body-centred, integrated.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ConfigurationId {
    /// The object's id, such as `ss`.
    pub object: String,
    /// Arrangement and clustering.
    pub method: Method,
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
serde_as_text!(Method);
serde_as_text!(ConfigurationId);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_the_papers() {
        let id: ConfigurationId = "as_sp".parse().unwrap();
        assert_eq!(id.object, "as");
        assert_eq!(id.method.arrangement, Arrangement::SimpleCubic);
        assert_eq!(id.method.clustering, Clustering::EdgeCollapse);
        assert_eq!(id.to_string(), "as_sp");
    }

    #[test]
    fn anything_else_is_refused() {
        for text in ["", "_", "ss", "ss_", "_bi", "ss_b", "ss_bix", "ss_xi", "ss_bü"] {
            assert!(text.parse::<ConfigurationId>().is_err(), "{text}");
        }
    }
}
