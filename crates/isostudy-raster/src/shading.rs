//! The material: a colour from one number.

use crate::{Camera, RasterError};
use glam::Vec3;

/// Brightness of a colour that stands for a number where the surface faces away from the light.
const DARKEST: f32 = 0.8;

/// How a surface is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Look {
    /// Vertex normals, interpolated.
    Smooth,
    /// One normal a triangle, from its corners.
    Flat,
    /// Triangle edges in the smooth surface's colour on the background. Hidden edges are left out: with them the
    /// far side's net crosses the near side's and neither can be read.
    Wireframe,
    /// The smooth surface with its triangle edges over it, in [`Shading::wire`].
    SmoothWireframe,
    /// As [`Look::Smooth`], but sharp over edges that turn by [`Shading::crease_deg`] or more.
    Creased,
}

/// What a turntable's light is fixed to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum LightFollows {
    /// The scene: the object turns under it, and half of the turn shows its dark side.
    #[default]
    Scene,
    /// The camera: light falls on every frame as it does on the first.
    Camera,
}

/// Light, material and line colours, red, green, blue in 0..1 as written to the 8-bit frame (no gamma step).
///
/// The default is the shader of Costen (2026) with its constants; `light_follows`, `ambient`, `wire`,
/// `wire_width_px` and `crease_deg` are ours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shading {
    /// The direction light travels, L. Not normalised: the original's has length 1.0198.
    pub light: [f32; 3],
    /// What the light is fixed to in a turntable. A still has one frame, so that both are the same there.
    pub light_follows: LightFollows,
    /// Share of the light that comes from all sides, 0 to 1; 0 is as published, with 1 nothing is shaded.
    pub ambient: f32,
    /// Colour towards the light, A.
    pub lit: [f32; 3],
    /// Colour at the terminator, B; a tenth of it faces away from the light.
    pub shade: [f32; 3],
    /// Colour of the highlight, W.
    pub highlight: [f32; 3],
    /// Colour where there is no surface.
    pub background: [f32; 3],
    /// Colour of the lines in [`Look::SmoothWireframe`].
    pub wire: [f32; 3],
    /// Width of lines in pixels, half of it on either side of an edge.
    pub wire_width_px: f32,
    /// Degrees between the normals of two triangles from which on their edge is sharp in [`Look::Creased`], 0 to 180:
    /// see [`corner_normals`](isostudy_mesh::corner_normals).
    pub crease_deg: f32,
}

impl Default for Shading {
    fn default() -> Self {
        Shading {
            light: [-0.6, 0.2, -0.8],
            light_follows: LightFollows::Scene,
            ambient: 0.0,
            lit: [0.949, 0.553, 0.027],
            shade: [0.212, 0.071, 0.310],
            highlight: [1.0, 0.95, 0.8],
            background: [0.004, 0.509, 0.506],
            wire: [0.03, 0.02, 0.05],
            wire_width_px: 1.0,
            crease_deg: 40.0,
        }
    }
}

impl Shading {
    /// `d = n . (-L)`: 1.0198 facing the light by default, negative when turned away. The normal is taken as it
    /// comes: an interpolated one is shorter than 1 and stays so.
    pub fn exposure(&self, normal: Vec3) -> f32 {
        -normal.dot(Vec3::from(self.light))
    }

    /// The largest `d` of a unit normal, `|L|`.
    pub fn max_exposure(&self) -> f32 {
        Vec3::from(self.light).length()
    }

    /// The surface colour at exposure `d`, clamped to 0..1 a channel (what an 8-bit frame does):
    /// `back = mix(B, 0.1 B, -d)`, `front = mix(A, W, d^3)`, `mix(back, front, clamp(d, 0, 1))` with
    /// `mix(a, b, t) = a + (b - a) t`, t unclamped. Of that, `mix(_, A, ambient)`.
    pub fn colour(&self, d: f32) -> [f32; 3] {
        let (lit, shade, highlight) =
            (Vec3::from(self.lit), Vec3::from(self.shade), Vec3::from(self.highlight));
        let back = mix(shade, shade * 0.1, -d);
        let front = mix(lit, highlight, d * d * d);
        let directed = mix(back, front, d.clamp(0.0, 1.0)).clamp(Vec3::ZERO, Vec3::ONE);
        mix(directed, lit, self.ambient).to_array()
    }

    /// How bright a colour that stands for a number is at exposure `d`: from [`DARKEST`] turned away from the light to
    /// 1 towards it, evenly, so that no part of the surface is too dark to be read.
    pub(crate) fn brightness(&self, d: f32) -> f32 {
        let towards = (0.5 + 0.5 * d / self.max_exposure().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        let directed = DARKEST + (1.0 - DARKEST) * towards;
        directed + (1.0 - directed) * self.ambient
    }

    /// The same with a light that stands to `camera` as this one stands to `first`.
    pub(crate) fn turned(&self, first: &Camera, camera: &Camera) -> Shading {
        let light = Vec3::from(self.light);
        let [right, up, forward] = camera.axes();
        let [x, y, z] = first.axes().map(|axis| axis.dot(light));
        Shading { light: (right * x + up * y + forward * z).to_array(), ..*self }
    }

    pub(crate) fn check(&self) -> Result<(), RasterError> {
        let wrong = |setting, value: f32, allowed| {
            Err(RasterError::Setting { setting, value: value as f64, allowed })
        };
        match (self.ambient, self.crease_deg) {
            (0.0..=1.0, 0.0..=180.0) => Ok(()),
            (0.0..=1.0, value) => wrong("crease_deg", value, "0 to 180"),
            (value, _) => wrong("ambient", value, "0 to 1"),
        }
    }
}

/// A colour in 0..1 to the nearest of 256 levels.
pub(crate) fn to_levels(colour: [f32; 3]) -> [u8; 3] {
    colour.map(|v| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8)
}

fn mix(a: Vec3, b: Vec3, t: f32) -> Vec3 {
    a + (b - a) * t
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand, from the formula: d = 0 gives B; d = 1 gives W; d = -1 gives a tenth of B; d = 0.5 gives
    /// 0.5 (1.45 B) + 0.5 (A + (W - A) / 8).
    #[test]
    fn colours_are_the_formulas() {
        let shading = Shading::default();
        let close = |d: f32, expected: [f32; 3]| {
            let got = shading.colour(d);
            assert!(
                (0..3).all(|c| (got[c] - expected[c]).abs() < 1e-6),
                "d = {d}: {got:?} is not {expected:?}"
            );
        };
        close(0.0, [0.212, 0.071, 0.310]);
        close(1.0, [1.0, 0.95, 0.8]);
        close(-1.0, [0.0212, 0.0071, 0.0310]);
        close(0.5, [0.6313875, 0.3527875, 0.2865625]);
    }

    /// Half of the light from all sides: half-way to A, whatever the exposure.
    #[test]
    fn ambient_light_leads_to_the_lit_colour() {
        let shading = Shading { ambient: 0.5, ..Shading::default() };
        let got = shading.colour(-1.0);
        let want = [(0.0212 + 0.949) / 2.0, (0.0071 + 0.553) / 2.0, (0.0310 + 0.027) / 2.0];
        assert!((0..3).all(|c| (got[c] - want[c]).abs() < 1e-6), "{got:?}");
        let even = Shading { ambient: 1.0, ..Shading::default() };
        let is_lit = |d| (0..3).all(|c| (even.colour(d)[c] - even.lit[c]).abs() < 1e-6);
        assert!([-1.0, 0.0, 0.9].into_iter().all(is_lit));
        assert_eq!(even.brightness(-1.0), 1.0);
        let away = shading.brightness(-shading.max_exposure());
        assert!((away - (0.8 + 1.0) / 2.0).abs() < 1e-6, "{away}");
    }

    #[test]
    fn the_light_is_not_normalised() {
        let shading = Shading::default();
        assert!((shading.max_exposure() - 1.0198039).abs() < 1e-6);
        assert_eq!(shading.exposure(Vec3::Z), 0.8);
        assert_eq!(shading.exposure(Vec3::Z * 0.5), 0.4);
    }
}
