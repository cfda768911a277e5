//! The page that shows any two meshes of a study side by side.

use crate::check::{Checker, ConfigError, short};
use serde::{Deserialize, Serialize};

/// The page that shows any two meshes of a study side by side.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViewerSection {
    /// Folder with the library that draws the meshes. It need not be there: then there is no viewer, and the pages say so.
    pub three: String,
    /// At which multiples of its stimulus spacing each mesh is shown.
    #[serde(default = "as_stimuli")]
    pub resolutions: Vec<f64>,
}

impl ViewerSection {
    /// The multiples of the stimulus spacing, from fine to coarse.
    pub fn from_fine_to_coarse(&self) -> Vec<f64> {
        let mut sorted = self.resolutions.clone();
        sorted.sort_by(f64::total_cmp);
        sorted
    }

    /// Whether every value may stand in a study file.
    pub(crate) fn check(&self, c: &Checker<'_>) -> Result<(), ConfigError> {
        if self.three.trim().is_empty() {
            return c.refuse("viewer.three", "\"\"", "must name a folder");
        }
        if self.resolutions.is_empty() {
            return c.refuse("viewer.resolutions", "[]", "must list at least one");
        }
        c.numbers("viewer.resolutions", &self.resolutions, 0.125, 16.0)?;
        let written: Vec<String> = self.resolutions.iter().map(|&of| short(of)).collect();
        c.distinct(|i| format!("viewer.resolutions[{i}]"), &written)
    }
}

fn as_stimuli() -> Vec<f64> {
    vec![1.0]
}
