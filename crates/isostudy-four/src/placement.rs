//! Where samples lie.

use glam::DVec3;

use crate::error::FourError;

/// A lattice of samples: sample `(i, j, k)` is number `i + counts[0] * (j + counts[1] * k)`, and lies at
/// `origin + i * steps[0] + j * steps[1] + k * steps[2]`. Lengths are in the unit of the steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Samples along each axis.
    pub counts: [usize; 3],
    /// Where the first sample lies.
    pub origin: [f64; 3],
    /// From one sample to the next, along each axis. They may be turned, sheared and mirrored.
    pub steps: [[f64; 3]; 3],
}

impl Placement {
    /// The first sample at the origin, and the others at whole coordinates.
    pub fn unit(counts: [usize; 3]) -> Self {
        Self::even(counts, [0.0; 3], 1.0)
    }

    /// Samples at one distance along x, y and z.
    pub fn even(counts: [usize; 3], origin: [f64; 3], spacing: f64) -> Self {
        let mut steps = [[0.0; 3]; 3];
        (0..3).for_each(|axis| steps[axis][axis] = spacing);
        Self { counts, origin, steps }
    }

    /// The number of samples.
    ///
    /// # Panics
    /// If they cannot be counted.
    pub fn samples(&self) -> usize {
        self.counts.iter().try_fold(1, |product: usize, &n| product.checked_mul(n)).expect("countable")
    }

    /// Whether the steps are a left-handed system, so that what turns to the left in the lattice turns to the right in space.
    pub fn is_mirrored(&self) -> bool {
        let [a, b, c] = self.steps.map(DVec3::from);
        a.cross(b).dot(c) < 0.0
    }

    /// The place of coordinates in the lattice.
    pub(crate) fn at(&self, lattice: [f64; 3]) -> DVec3 {
        let [a, b, c] = self.steps.map(DVec3::from);
        DVec3::from(self.origin) + lattice[0] * a + lattice[1] * b + lattice[2] * c
    }

    /// The samples of a frame are as many as there should be, and finite.
    pub(crate) fn check(&self, frame: usize, samples: &[f32]) -> Result<(), FourError> {
        let counts = self.counts;
        if counts.iter().any(|&n| n < 2) {
            return Err(FourError::Flat { counts });
        }
        let wanted = self.samples();
        if samples.len() != wanted {
            return Err(FourError::Samples { frame, found: samples.len(), wanted });
        }
        match samples.iter().position(|value| !value.is_finite()) {
            None => Ok(()),
            Some(number) => {
                let place = [0, 1, 2].map(|axis| match axis {
                    0 => number % counts[0],
                    1 => number / counts[0] % counts[1],
                    _ => number / counts[0] / counts[1],
                });
                Err(FourError::NotFinite { frame, place, value: samples[number] })
            }
        }
    }
}

pub(crate) fn check_isovalue(isovalue: f32) -> Result<(), FourError> {
    if isovalue.is_finite() { Ok(()) } else { Err(FourError::Isovalue { isovalue }) }
}
