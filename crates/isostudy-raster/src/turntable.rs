//! A turn around the z axis.

use crate::{Camera, RasterError, Viewport};
use glam::Vec3;

/// A camera that circles the z axis once, and the pictures it takes.
///
/// The defaults are the GIF tool's of Costen (2026) for the sphere; per object the author changed `distance` and
/// `vertical_fov_rad` (asteroid 1.6 and 60 deg; bunny 1.2 and 50 deg).
#[derive(Debug, Clone, PartialEq)]
pub struct Turntable {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Pictures in a turn.
    pub frames: u32,
    /// Nominal length of a turn, seconds; the delay between frames is cut to whole centiseconds.
    pub duration_s: f64,
    /// Height of the circle's middle over the origin, which is in the middle of the picture; 0 as published.
    pub middle_z: f32,
    /// The original's distance parameter D. The eye is [`Turntable::eye_distance`] from the middle, which is more.
    pub distance: f32,
    /// The original's elevation parameter u, radians. The eye stands lower: [`Turntable::eye_elevation_rad`].
    pub elevation_rad: f32,
    /// Angle between the picture's upper and lower border, radians.
    pub vertical_fov_rad: f32,
    /// Near plane.
    pub near: f32,
    /// Far plane.
    pub far: f32,
    /// Samples along each side of a pixel. The original had 1; 2 here.
    pub supersampling: u32,
}

impl Default for Turntable {
    fn default() -> Self {
        Turntable {
            width: 512,
            height: 512,
            frames: 120,
            duration_s: 8.0,
            middle_z: 0.0,
            distance: 1.2,
            elevation_rad: std::f32::consts::PI / 6.0,
            vertical_fov_rad: 1.57,
            near: 1e-4,
            far: 100.0,
            supersampling: 2,
        }
    }
}

impl Turntable {
    /// A turn in which a ball of `radius` round the origin touches the picture's border all the time; what has nothing to
    /// do with distances is as by default. `radius` must be above 0.
    pub fn around(radius: f32) -> Self {
        let vertical_fov_rad = 0.6;
        let eye_distance = radius / libm::sinf(0.5 * vertical_fov_rad);
        let unit = Turntable { distance: 1.0, ..Turntable::default() };
        Turntable {
            distance: eye_distance / unit.eye_distance(),
            vertical_fov_rad,
            near: (eye_distance - radius) * 0.5,
            far: eye_distance + 2.0 * radius,
            ..unit
        }
    }

    /// The camera of picture `frame`: with t = 2 pi frame / frames, D `distance` and u `elevation_rad`,
    /// `eye = D ((cos t - sin t) cos u, (sin t + cos t) cos u, sin u)` from the middle, looking at it, z up.
    ///
    /// Seen from above the eye runs counter-clockwise, so the object seems to turn clockwise. `frame` may exceed
    /// `frames`: the turn repeats.
    pub fn camera(&self, frame: u32) -> Camera {
        let t = std::f64::consts::TAU * frame as f64 / self.frames.max(1) as f64;
        // Not the platform's sine: the same bytes on every machine.
        let ((sin_t, cos_t), (sin_u, cos_u)) = (libm::sincos(t), libm::sincos(self.elevation_rad as f64));
        let (d, middle) = (self.distance as f64, Vec3::Z * self.middle_z);
        let eye = [d * (cos_t - sin_t) * cos_u, d * (sin_t + cos_t) * cos_u, d * sin_u];
        Camera {
            eye: Vec3::from(eye.map(|v| v as f32)) + middle,
            target: middle,
            up: Vec3::Z,
            vertical_fov_rad: self.vertical_fov_rad,
            near: self.near,
            far: self.far,
        }
    }

    /// The picture size.
    pub fn viewport(&self) -> Viewport {
        Viewport { width: self.width, height: self.height, supersampling: self.supersampling }
    }

    /// True distance of the eye from the middle, `D sqrt(2 cos^2 u + sin^2 u)`: 1.323 D at u = 30 deg.
    pub fn eye_distance(&self) -> f32 {
        self.offset_of_eye().length()
    }

    /// True elevation of the eye over the middle, radians, `atan(tan u / sqrt 2)`: 22.2 deg at u = 30 deg.
    pub fn eye_elevation_rad(&self) -> f32 {
        let eye = self.offset_of_eye();
        eye.z.atan2(eye.truncate().length())
    }

    fn offset_of_eye(&self) -> Vec3 {
        let Camera { eye, target, .. } = self.camera(0);
        eye - target
    }

    /// Time between frames in centiseconds, `floor(100 duration / frames)`: 6 for 8 s in 120 frames.
    pub fn frame_delay_cs(&self) -> u16 {
        // 100 * 1.2 / 120 is a hair under 1 in binary: the epsilon keeps what is whole on paper whole.
        (100.0 * self.duration_s / self.frames.max(1) as f64 + 1e-9).floor().clamp(0.0, u16::MAX as f64)
            as u16
    }

    pub(crate) fn check(&self) -> Result<(), RasterError> {
        let wrong = |setting, value, allowed| Err(RasterError::Setting { setting, value, allowed });
        if self.frames == 0 {
            return wrong("frames", 0.0, "1 or more");
        }
        if !(self.duration_s > 0.0 && self.duration_s.is_finite() && self.frame_delay_cs() > 0) {
            return wrong("duration_s", self.duration_s, "at least 1 centisecond a frame");
        }
        self.viewport().check()?;
        self.camera(0).check()
    }
}
