//! A sample point and what lies round it.

use glam::Vec3;

use crate::lattice::DIRECTIONS;

/// What is known at a sample point of the lattice.
pub(crate) struct Surroundings {
    pub(crate) position: Vec3,
    /// Field minus isovalue.
    pub(crate) difference: f32,
    /// The same at the neighbours; not a number where there is none.
    pub(crate) neighbours: [f32; DIRECTIONS],
    /// The ways there, where they are not all as long as the spacing says.
    pub(crate) ways: Option<[Vec3; DIRECTIONS]>,
}
