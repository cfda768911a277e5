//! The fields with C's calling convention, for extractors that call them from another language.

use extract::{Asteroid, ScalarField, Sphere};
use glam::Vec3;

/// The sphere's.
#[unsafe(no_mangle)]
pub extern "C" fn sphere(x: f32, y: f32, z: f32) -> f32 {
    Sphere { radius: 1.0 }.sample(Vec3::new(x, y, z))
}

/// The asteroid's.
#[unsafe(no_mangle)]
pub extern "C" fn asteroid(x: f32, y: f32, z: f32) -> f32 {
    Asteroid::default().sample(Vec3::new(x, y, z))
}
