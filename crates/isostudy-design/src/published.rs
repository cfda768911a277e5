//! Published numbers, as a study supplies them for comparison.

use crate::check::ConfigError;
use crate::method::{ConfigurationId, MethodId};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// One row of the published benchmark. Times are means over the published run, in seconds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "names as in `record::Counts` and `record::BenchSample`")]
pub struct BenchmarkRow {
    pub id: ConfigurationId,
    pub cells_x: u32,
    pub cells_y: u32,
    pub cells_z: u32,
    pub tetrahedra: u64,
    pub tetrahedra_evaluated: u64,
    pub vertices: u64,
    pub triangles: u64,
    pub discarded_as_published: u64,
    pub allocation_s: f64,
    pub sampling_s: f64,
    pub vertex_s: f64,
    pub geometry_s: f64,
    pub normals_s: f64,
    /// The published total: the first four stages, normals left out.
    pub total_without_normals_s: f64,
    pub stored_samples: u64,
    /// As printed; the simple cubic formula has a wrong sign.
    pub needed_samples: u64,
    pub stored_edges: u64,
    /// As printed; the simple cubic formula has a wrong sign.
    pub needed_edges: u64,
    pub sample_bytes: u64,
    pub edge_bytes: u64,
    pub vertex_bytes: u64,
    pub index_bytes: u64,
    /// Discarded over discarded plus kept, 0 to 1, over-count included.
    pub discard_fraction: f64,
    pub area_mean: f64,
    pub area_sd: f64,
    pub area_max: f64,
    pub aspect_ratio_mean: f64,
    pub aspect_ratio_sd: f64,
    pub aspect_ratio_max: f64,
}

/// Reads a published benchmark; lines that begin with `#` are comments.
///
/// # Errors
/// If the file cannot be read or a row or column is not as it should be, naming file, row and column.
pub fn read_benchmark(path: &Path) -> Result<Vec<BenchmarkRow>, ConfigError> {
    crate::read::read_table(path)
}

/// What a published preference number is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PreferenceKind {
    /// A method's factor within a comparison group.
    Group,
    /// The sum of a method's group factors.
    Overall,
    /// Mean of the sums over an arrangement; `of` is its code.
    ArrangementMean,
    /// Mean of the sums over a clustering; `of` is its code.
    ClusteringMean,
}

/// One number of the published preference tables, as printed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreferenceCell {
    /// What the number is.
    pub kind: PreferenceKind,
    /// The group's id; empty unless `kind` is `group`.
    pub group: String,
    /// The method, for `group` and `overall`; the arrangement's or clustering's code for the means.
    pub of: String,
    /// The printed number.
    pub factor: f64,
}

/// A claim in the published text.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// Names the quantity; the analysis knows how to compute it.
    pub id: String,
    /// What the text says, in our words.
    pub statement: String,
    /// The number, where there is one.
    pub value: Option<f64>,
    /// Unit of the number: `%`, `ratio`, or empty.
    pub unit: String,
}

impl PreferenceCell {
    /// The method that `of` names, for cells of kind `group` and `overall`.
    pub fn method(&self) -> Option<MethodId> {
        self.of.parse().ok()
    }
}
