//! How surfaces are shown: `[turntable]`, `[shading]`, `[[stills]]`.

use super::whole;
use crate::method::{ConfigurationId, StimulusLook};
use serde::{Deserialize, Serialize};

/// How the animations are taken.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TurntableSection {
    /// Frame width in pixels.
    #[serde(deserialize_with = "whole")]
    pub width: u32,
    /// Frame height in pixels.
    #[serde(deserialize_with = "whole")]
    pub height: u32,
    /// Frames a turn.
    #[serde(deserialize_with = "whole")]
    pub frames: u32,
    /// Nominal seconds a turn; a frame's delay is rounded down to whole centiseconds.
    pub duration_s: f64,
    /// The paper's elevation parameter u in radians.
    pub elevation_rad: f64,
    /// Near plane.
    pub near: f64,
    /// Far plane.
    pub far: f64,
    /// Samples along each side of a pixel.
    #[serde(deserialize_with = "whole")]
    pub supersampling: u32,
    /// How the animations show the surface, and so the pairs.
    #[serde(default, skip_serializing_if = "is_default")]
    pub look: StimulusLook,
}

impl From<StimulusLook> for Look {
    fn from(look: StimulusLook) -> Self {
        match look {
            StimulusLook::Smooth => Self::Smooth,
            StimulusLook::Flat => Self::Flat,
            StimulusLook::SmoothWireframe => Self::SmoothWireframe,
            StimulusLook::Creased => Self::Creased,
        }
    }
}

impl TurntableSection {
    /// Centiseconds that a frame lasts: a whole number, since GIFs hold no other.
    pub fn delay_cs(&self) -> f64 {
        (100.0 * self.duration_s / f64::from(self.frames)).floor()
    }

    /// Milliseconds that a turn really takes.
    pub fn loop_ms(&self) -> u32 {
        (10.0 * self.delay_cs() * f64::from(self.frames)) as u32
    }
}

/// What the light is fixed to while the object turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LightFollows {
    /// The scene, as published: half of the turn shows the dark side.
    #[default]
    Scene,
    /// The camera: light falls on every frame as it does on the first.
    Camera,
}

/// How surfaces are coloured; colours are red, green, blue from 0 to 1.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShadingSection {
    /// Direction in which light travels, not normalised.
    pub light: [f64; 3],
    /// Colour towards the light.
    pub lit: [f64; 3],
    /// Colour away from the light.
    pub shade: [f64; 3],
    /// Colour of the highlight.
    pub highlight: [f64; 3],
    /// Colour behind the object.
    pub background: [f64; 3],
    /// What the light is fixed to.
    #[serde(default, skip_serializing_if = "is_default")]
    pub light_follows: LightFollows,
    /// Share of the light that comes from all sides.
    #[serde(default, skip_serializing_if = "is_default")]
    pub ambient: f64,
    /// Distance at the bad end of the scale of [`Look::Error`], in spacings.
    #[serde(default = "error_scale", skip_serializing_if = "is_error_scale")]
    pub error_scale: f64,
    /// Degrees by which two triangles turn at an edge that [`Look::Creased`] keeps sharp, at least.
    #[serde(default = "crease_deg", skip_serializing_if = "is_crease_deg")]
    pub crease_deg: f64,
}

/// A tenth of a spacing: what is off by more is seen in the shape.
fn error_scale() -> f64 {
    0.1
}

fn is_error_scale(value: &f64) -> bool {
    *value == error_scale()
}

/// Below the 45 degrees of a right angle that is bevelled evenly, so that the bevel is seen.
fn crease_deg() -> f64 {
    40.0
}

fn is_crease_deg(value: &f64) -> bool {
    *value == crease_deg()
}

/// A key that was left out, or might as well have been, is not written: digests of what was made before there was such a
/// key stay as they are.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// How a still shows the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Look {
    /// Interpolated vertex normals.
    Smooth,
    /// One normal a triangle.
    Flat,
    /// Triangle edges only.
    Wireframe,
    /// Smooth with triangle edges on top.
    SmoothWireframe,
    /// Each triangle in the colour of its radius ratio, with a scale.
    Quality,
    /// Each triangle in the colour of its distance to the isosurface, with a scale.
    Error,
    /// Smooth, but sharp over edges that turn by `shading.crease_deg` or more.
    Creased,
}

impl Look {
    /// The name used in captions.
    pub fn label(self) -> &'static str {
        match self {
            Self::Smooth => "smooth",
            Self::Flat => "flat",
            Self::Wireframe => "wireframe",
            Self::SmoothWireframe => "smooth + wireframe",
            Self::Quality => "quality of triangles",
            Self::Error => "error of triangles",
            Self::Creased => "smooth with creases",
        }
    }

    /// The name used in the study file and in names of files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Smooth => "smooth",
            Self::Flat => "flat",
            Self::Wireframe => "wireframe",
            Self::SmoothWireframe => "smooth-wireframe",
            Self::Quality => "quality",
            Self::Error => "error",
            Self::Creased => "creased",
        }
    }
}

/// A figure of still pictures: one configuration in several looks.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StillSection {
    /// File name without extension.
    pub id: String,
    /// Caption.
    pub caption: String,
    /// What is shown.
    pub configuration: ConfigurationId,
    /// Cube edge.
    pub spacing: f64,
    /// The looks, left to right.
    pub looks: Vec<Look>,
    /// Whether each look is made as an animation of one turn as well.
    #[serde(default, skip_serializing_if = "is_default")]
    pub turntable: bool,
}
