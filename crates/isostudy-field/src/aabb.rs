//! A box in plain numbers.

use isostudy_mesh::Bounds;

/// A box in line with the axes, in the unit of the field's coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// The corner with the least coordinates.
    pub min: [f32; 3],
    /// The corner with the greatest.
    pub max: [f32; 3],
}

impl Aabb {
    /// The cube round a ball.
    pub fn around(centre: [f32; 3], radius: f32) -> Self {
        Self { min: centre.map(|c| c - radius), max: centre.map(|c| c + radius) }
    }

    /// Whether the boxes have a point in common. With a coordinate that is not a number it is `true`.
    pub fn meets(&self, other: &Self) -> bool {
        (0..3).all(|axis| !(self.min[axis] > other.max[axis] || self.max[axis] < other.min[axis]))
    }
}

impl From<Bounds> for Aabb {
    fn from(bounds: Bounds) -> Self {
        Self { min: bounds.min.into(), max: bounds.max.into() }
    }
}

impl From<Aabb> for Bounds {
    fn from(aabb: Aabb) -> Self {
        Self { min: aabb.min.into(), max: aabb.max.into() }
    }
}
