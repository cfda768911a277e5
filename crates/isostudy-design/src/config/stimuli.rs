//! `[stimuli]`: how what people see is made, from turntables or from files of one's own.

use super::whole;
use crate::method::ConfigurationId;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// How stimuli are made.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StimuliSection {
    /// Whole-number enlargement of a pair in the file, nearest neighbour.
    #[serde(default = "once", deserialize_with = "whole")]
    pub pair_scale: u32,
    /// What is shown in place of meshes: a file for each object with each method.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<ShownFile>,
    /// Seconds that films take, or for which still pictures are looked at before an answer is taken.
    #[serde(default = "some_seconds", skip_serializing_if = "is_some_seconds")]
    pub duration_s: f64,
}

fn once() -> u32 {
    1
}

/// What `duration_s` is unless given.
pub(crate) const STIMULI_SECONDS: f64 = 3.0;

fn some_seconds() -> f64 {
    STIMULI_SECONDS
}

fn is_some_seconds(value: &f64) -> bool {
    *value == some_seconds()
}

/// A file that is shown as it is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShownFile {
    /// The object and the method that it is of.
    pub configuration: ConfigurationId,
    /// A picture, a film or a mesh; its kind is what its name ends with.
    pub file: String,
}

/// What a file shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShownFileKind {
    /// A still picture or a film, in its own pixels.
    Film,
    /// A mesh, which is drawn as the study's turntable and shading say.
    Mesh,
}

/// What names of films end with.
pub(crate) const STIMULUS_FILMS: [&str; 4] = ["png", "gif", "mp4", "webm"];
/// What names of meshes end with.
pub(crate) const STIMULUS_MESHES: [&str; 4] = ["glb", "ply", "obj", "stl"];

impl ShownFile {
    /// `None` for a name that ends with what is not read.
    pub fn kind(&self) -> Option<ShownFileKind> {
        let ending = Path::new(&self.file).extension()?.to_string_lossy().to_lowercase();
        if STIMULUS_FILMS.contains(&&*ending) {
            return Some(ShownFileKind::Film);
        }
        STIMULUS_MESHES.contains(&&*ending).then_some(ShownFileKind::Mesh)
    }
}

impl StimuliSection {
    /// What the study's files show, which are all of one kind; `None` for a study that makes its own meshes.
    pub fn shown_files(&self) -> Option<ShownFileKind> {
        self.files.first().and_then(ShownFile::kind)
    }

    /// The file of a configuration.
    pub fn file_of(&self, id: &ConfigurationId) -> Option<&ShownFile> {
        self.files.iter().find(|shown| shown.configuration == *id)
    }
}
