//! How a method makes a mesh, as the study file says it.

use serde::{Deserialize, Serialize};

/// The kind of recipe that the short form, arrangements crossed with clusterings, is written out as.
pub const TETRAHEDRA: &str = "tetrahedra";

/// How a method makes a mesh: a kind, and the keys that this kind has. A study knows no more of it; whoever makes meshes reads the
/// keys and refuses those that it does not know.
///
/// As text, and so in digests, keys are in alphabetical order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// Which family of methods.
    pub kind: String,
    /// The family's own keys.
    #[serde(flatten)]
    pub settings: toml::Table,
}

impl Recipe {
    /// That of a method whose stimuli are files: none. No study file writes its kind.
    pub(crate) fn of_files() -> Self {
        Self { kind: "files".into(), settings: toml::Table::new() }
    }
}
