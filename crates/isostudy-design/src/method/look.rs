//! How a method's animation shows its mesh.

use serde::{Deserialize, Serialize};

/// How an animation that people are shown shows the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StimulusLook {
    /// Interpolated vertex normals, as published.
    #[default]
    Smooth,
    /// One normal a triangle.
    Flat,
    /// Smooth with triangle edges on top.
    SmoothWireframe,
    /// Smooth, but sharp over edges that turn by `shading.crease_deg` or more.
    Creased,
}
