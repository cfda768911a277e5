//! Why a step cannot be applied.

use isostudy_mesh::MeshError;
use isostudy_mesh::glam::Vec3;

/// What is wrong with a step's settings.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingError {
    /// A length or share is out of its range.
    #[error("{key} = {value:?}: must be {allowed}")]
    Range {
        /// The key.
        key: &'static str,
        /// What it says.
        value: f64,
        /// What it may say.
        allowed: &'static str,
    },
    /// A count is out of its range.
    #[error("{key} = {value}: must be {allowed}")]
    Count {
        /// The key.
        key: &'static str,
        /// What it says.
        value: u64,
        /// What it may say.
        allowed: String,
    },
    /// None of the keys that say where a step ends.
    #[error("decimate needs one of triangles, ratio and error")]
    NoGoal,
    /// Two keys that say the same.
    #[error("decimate takes triangles or ratio, not both")]
    TwoGoals,
}

/// Why a step cannot be applied to a mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FinishError {
    /// Its settings are none.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// The mesh cannot be computed with.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Fewer triangles are asked for than one.
    #[error("ratio = {ratio:?} of {triangles} triangles is less than one triangle")]
    Nothing {
        /// The share.
        ratio: f64,
        /// Triangles of the mesh.
        triangles: usize,
    },
    /// Vertices that stay are more than points are asked for.
    #[error(
        "points = {points}: {staying} vertices of borders and of faults stay, and count among the points; there must be more points"
    )]
    StayingVertices {
        /// Points asked for.
        points: u64,
        /// Vertices that stay.
        staying: u64,
    },
    /// Points lie so close that their coordinates are the same.
    #[error(
        "points = {points}: single precision cannot tell two of them apart, at {at}; there must be fewer points"
    )]
    TooClose {
        /// Points asked for.
        points: u64,
        /// Where two of them are.
        at: Vec3,
    },
    /// No triangle has an area to spread points over.
    #[error("no triangle has an area, so points cannot be spread")]
    NoArea,
    /// The step works on whole meshes alone.
    #[error("{step} needs the whole mesh; only decimate works on chunks, with their borders locked")]
    Chunk {
        /// The step.
        step: &'static str,
    },
}
