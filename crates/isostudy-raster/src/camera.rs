//! A perspective camera, and the grid of pixels behind it.

use crate::RasterError;
use glam::Vec3;

/// A perspective camera. Right-handed, z up in the world; the picture's x runs right, y down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Position, in the mesh's unit of length.
    pub eye: Vec3,
    /// The point in the middle of the picture.
    pub target: Vec3,
    /// The direction that points up in the picture; any length.
    pub up: Vec3,
    /// Angle between the picture's upper and lower border, radians.
    pub vertical_fov_rad: f32,
    /// What is nearer along the line of sight is cut off.
    pub near: f32,
    /// What is further along the line of sight is cut off.
    pub far: f32,
}

/// The size of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Viewport {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Samples along each side of a pixel: 1 (none) to 8. Samples sit on a regular grid; a pixel is their mean.
    pub supersampling: u32,
}

/// A gibibyte and a half of depth and level.
const MOST_SAMPLES: f64 = (1u64 << 28) as f64;

impl Camera {
    /// A camera that has all of a box in its picture, from the side of +x and -y and somewhat above. The box needs an
    /// extent along one axis at least.
    pub fn around(bounds: &isostudy_mesh::Bounds) -> Self {
        let (target, radius) = ((bounds.min + bounds.max) * 0.5, bounds.size().length() * 0.5);
        let vertical_fov_rad = 0.6;
        // A ball of that radius touches the picture's border.
        let distance = radius / libm::sinf(0.5 * vertical_fov_rad);
        Camera {
            eye: target + Vec3::new(0.66, -0.66, 0.36).normalize() * distance,
            target,
            up: Vec3::Z,
            vertical_fov_rad,
            near: (distance - radius) * 0.5,
            far: distance + 2.0 * radius,
        }
    }

    /// Where `point` falls, in pixels from the upper left corner (pixel centres at .5), and its distance along the
    /// line of sight; `None` nearer than `near` or beyond `far`. The position may lie outside the picture.
    pub fn project(&self, point: Vec3, viewport: &Viewport) -> Option<([f32; 2], f32)> {
        let view = View::new(self, viewport);
        let p = view.view_point(point);
        let scale = 1.0 / viewport.supersampling as f32;
        (p.z >= self.near && p.z <= self.far).then(|| (view.sample_position(p).map(|v| v * scale), p.z))
    }

    /// Right, up and forward: unit vectors across each other.
    pub(crate) fn axes(&self) -> [Vec3; 3] {
        let forward = (self.target - self.eye).normalize_or_zero();
        // Looking straight up or down leaves `right` open: any axis across the line of sight will do.
        let right =
            forward.cross(self.up).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
        [right, right.cross(forward), forward]
    }

    pub(crate) fn check(&self) -> Result<(), RasterError> {
        let setting =
            |setting, value: f32, allowed| RasterError::Setting { setting, value: value as f64, allowed };
        if !(self.eye.is_finite() && self.target.is_finite() && self.up.is_finite()) {
            return Err(setting("camera position", f32::NAN, "finite"));
        }
        if (self.target - self.eye).length() == 0.0 {
            return Err(setting("camera distance", 0.0, "more than 0"));
        }
        if !(1e-3..=3.1).contains(&self.vertical_fov_rad) {
            return Err(setting("vertical_fov_rad", self.vertical_fov_rad, "0.001 to 3.1"));
        }
        if !(self.near > 0.0 && self.near.is_finite()) {
            return Err(setting("near", self.near, "more than 0"));
        }
        // Written so that NaN fails.
        if self.far.partial_cmp(&self.near) != Some(std::cmp::Ordering::Greater) {
            return Err(setting("far", self.far, "more than near"));
        }
        Ok(())
    }
}

impl Viewport {
    pub(crate) fn check(&self) -> Result<(), RasterError> {
        let side = |setting, value: u32| match value {
            1..=16384 => Ok(()),
            _ => Err(RasterError::Setting { setting, value: value as f64, allowed: "1 to 16384" }),
        };
        side("width", self.width)?;
        side("height", self.height)?;
        let wrong = |setting, value, allowed| Err(RasterError::Setting { setting, value, allowed });
        if !(1..=8).contains(&self.supersampling) {
            return wrong("supersampling", self.supersampling as f64, "1 to 8");
        }
        let samples = self.width as f64 * self.height as f64 * (self.supersampling as f64).powi(2);
        if samples > MOST_SAMPLES {
            return wrong("samples in a picture", samples, "up to 2^28");
        }
        Ok(())
    }
}

/// The camera's axes and scale, ready for many points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View {
    eye: Vec3,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    /// Samples at distance 1 along the line of sight a unit of length.
    focal: f32,
    centre: [f32; 2],
}

impl View {
    pub(crate) fn new(camera: &Camera, viewport: &Viewport) -> View {
        let [right, up, forward] = camera.axes();
        let samples = |pixels: u32| (pixels * viewport.supersampling) as f32;
        View {
            eye: camera.eye,
            right,
            up,
            forward,
            focal: samples(viewport.height) * 0.5 / libm::tanf(camera.vertical_fov_rad * 0.5),
            centre: [samples(viewport.width) * 0.5, samples(viewport.height) * 0.5],
        }
    }

    /// x right, y up, z along the line of sight.
    #[inline]
    pub(crate) fn view_point(&self, point: Vec3) -> Vec3 {
        let p = point - self.eye;
        Vec3::new(self.right.dot(p), self.up.dot(p), self.forward.dot(p))
    }

    /// Samples from the upper left corner of a point in front of the camera, given in view coordinates.
    #[inline]
    pub(crate) fn sample_position(&self, p: Vec3) -> [f32; 2] {
        let scale = self.focal / p.z;
        [self.centre[0] + p.x * scale, self.centre[1] - p.y * scale]
    }

    /// `|x| / z` and `|y| / z` at `margin` samples beyond the middle of the picture.
    pub(crate) fn slope(&self, margin: f32) -> f32 {
        margin / self.focal
    }
}
