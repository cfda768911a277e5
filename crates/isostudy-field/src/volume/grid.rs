//! Where the samples of a volume lie.

use glam::{DMat3, DVec3};
use isostudy_mesh::Bounds;

use super::VolumeFieldError;
use super::bricks::Bricks;
use super::ranges::{EDGES, Ranges};

/// A regular grid of samples: all that can be said of a volume before its samples are there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeGrid {
    pub(super) counts: [usize; 3],
    pub(super) origin: DVec3,
    pub(super) steps: DMat3,
    pub(super) to_index: DMat3,
}

impl VolumeGrid {
    /// Sample `(i, j, k)` lies at `origin + i * steps[0] + j * steps[1] + k * steps[2]`.
    ///
    /// # Errors
    /// [`VolumeFieldError::Counts`], [`VolumeFieldError::Flat`], [`VolumeFieldError::Steps`].
    pub fn try_new(
        counts: [usize; 3],
        origin: [f64; 3],
        steps: [[f64; 3]; 3],
    ) -> Result<Self, VolumeFieldError> {
        if counts.contains(&0) {
            return Err(VolumeFieldError::Counts { counts, samples: 0 });
        }
        if counts.contains(&1) {
            return Err(VolumeFieldError::Flat { counts });
        }
        let matrix = DMat3::from_cols_array_2d(&steps);
        let lengths = matrix.x_axis.length() * matrix.y_axis.length() * matrix.z_axis.length();
        let start = DVec3::from_array(origin);
        let to_index = matrix.inverse();
        let is_sound = start.is_finite() && to_index.is_finite() && lengths.is_finite();
        if !is_sound || matrix.determinant().abs() <= 1e-6 * lengths {
            return Err(VolumeFieldError::Steps { steps, origin });
        }
        Ok(Self { counts, origin: start, steps: matrix, to_index })
    }

    /// Samples along each axis of the grid.
    pub fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// A box that a surface which was closed ([`VolumeField::closing_at`](super::VolumeField::closing_at)) stays clear of:
    /// half a shortest step more than it needs.
    pub fn closing_bounds(&self) -> Bounds {
        self.bounds().grown(1.5 * self.spacing())
    }

    /// The smallest box round all samples; none wider than `f32` can tell from a point.
    pub fn bounds(&self) -> Bounds {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for corner in 0..8 {
            let index =
                std::array::from_fn(|k| if corner >> k & 1 == 1 { self.counts[k] - 1 } else { 0 } as f64);
            let p = self.origin + self.steps * DVec3::from_array(index);
            (min, max) = (min.min(p), max.max(p));
        }
        Bounds { min: min.as_vec3(), max: max.as_vec3() }
    }

    /// The shortest distance from sample to sample.
    pub fn spacing(&self) -> f32 {
        self.shortest_step() as f32
    }

    pub(super) fn shortest_step(&self) -> f64 {
        let steps = [self.steps.x_axis, self.steps.y_axis, self.steps.z_axis];
        steps.iter().map(|step| step.length()).fold(f64::INFINITY, f64::min)
    }

    /// Whether the grid's axes are those of space, in any order and direction.
    pub fn is_axis_aligned(&self) -> bool {
        let axes = [self.steps.x_axis, self.steps.y_axis, self.steps.z_axis];
        axes.iter().all(|step| step.abs().max_element() >= (1.0 - 1e-9) * step.length())
    }

    /// Bytes that a [`VolumeField`](super::VolumeField) keeps beside samples in memory: the ranges of their bricks.
    pub fn range_bytes(&self) -> u64 {
        Ranges::bytes(self.counts, EDGES[0])
    }

    /// Bytes that a field of samples that are [not in memory](super::VolumeField::try_stored) keeps, which was given `memory_bytes`: bricks of
    /// samples, and their ranges.
    pub fn stored_bytes(&self, memory_bytes: u64) -> [u64; 2] {
        let half = memory_bytes / 2;
        let ranges = Ranges::bytes(self.counts, Ranges::edge_within(self.counts, half));
        [Bricks::bytes(self.counts, half), ranges]
    }
}
