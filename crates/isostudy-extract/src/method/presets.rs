//! Methods that have a name.
//!
//! The first letter of two is the arrangement: body-centred, simple cubic, mirrored five tetrahedra, face-centred. The second is
//! the clustering: unclustered, integrated, post-processed by an edge collapse, integrated and then collapsed, warped.

use std::sync::OnceLock;

use super::{Method, kinds};

/// A method with a name.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Preset {
    /// 2 to 16 of a to z, 0 to 9 and `-`, a letter first. No two presets have one id.
    pub id: &'static str,
    /// The same in words. No two presets have one label.
    pub label: &'static str,
    /// What it is.
    pub method: Method,
    /// Where it was published: authors and year.
    pub source: &'static str,
}

/// The named methods, in a fixed order: kind by kind, then in the same order those that are there [for comparison](Method::is_for_comparison).
pub fn presets() -> &'static [Preset] {
    static PRESETS: OnceLock<Vec<Preset>> = OnceLock::new();
    PRESETS.get_or_init(|| {
        let mut presets: Vec<Preset> = kinds().iter().flat_map(|kind| kind.presets).copied().collect();
        presets.sort_by_key(|preset| preset.method.is_for_comparison());
        presets
    })
}
