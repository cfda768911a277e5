//! Frames of samples, one after the other.

use isostudy_mesh::TriangleMesh;

use crate::cells::count_tetrahedra;
use crate::crossings::Level;
use crate::error::FourError;
use crate::placement::{Placement, check_isovalue};
use crate::space_time::SpaceTime;

/// A series of volumes on one lattice: samples in four dimensions. Frame `n` is at time `n`, and the last coordinate is time.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    placement: Placement,
    frames: Vec<Vec<f32>>,
}

impl Series {
    /// The series of these frames.
    ///
    /// # Errors
    /// [`FourError::Few`], [`FourError::Flat`], [`FourError::Samples`], [`FourError::NotFinite`].
    pub fn try_new(placement: Placement, frames: Vec<Vec<f32>>) -> Result<Self, FourError> {
        if frames.len() < 2 {
            return Err(FourError::Few { frames: frames.len() });
        }
        frames.iter().enumerate().try_for_each(|(number, samples)| placement.check(number, samples))?;
        Ok(Self { placement, frames })
    }

    /// Where the samples of each frame lie.
    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    /// The samples, frame by frame.
    pub fn frames(&self) -> &[Vec<f32>] {
        &self.frames
    }

    /// The surface in space-time.
    ///
    /// # Errors
    /// [`FourError::Isovalue`], [`FourError::TooMany`].
    pub fn extract(&self, isovalue: f32) -> Result<SpaceTime, FourError> {
        check_isovalue(isovalue)?;
        SpaceTime::of(&self.placement, &self.levels(isovalue, 0, self.frames.len()), 0)
    }

    /// The surface at one time: [`SpaceTime::slice`], to the bit. Only what is between the two frames next to it is extracted.
    ///
    /// # Errors
    /// [`FourError::Isovalue`], [`FourError::Time`], [`FourError::TooMany`].
    pub fn slice(&self, isovalue: f32, time: f64) -> Result<TriangleMesh, FourError> {
        check_isovalue(isovalue)?;
        let first = self.first_frame(time)?;
        SpaceTime::of(&self.placement, &self.levels(isovalue, first, first + 2), first)?.slice(time)
    }

    /// Bytes that [`extract`](Self::extract) takes at most, beside the samples: the surface, and what finds its vertices.
    ///
    /// # Errors
    /// [`FourError::Isovalue`].
    pub fn extract_bytes(&self, isovalue: f32) -> Result<u64, FourError> {
        check_isovalue(isovalue)?;
        Ok(self.bytes(isovalue, 0, self.frames.len(), 0))
    }

    /// Bytes that [`slice`](Self::slice) takes at most, beside the samples.
    ///
    /// # Errors
    /// [`FourError::Isovalue`], [`FourError::Time`].
    pub fn slice_bytes(&self, isovalue: f32, time: f64) -> Result<u64, FourError> {
        check_isovalue(isovalue)?;
        let first = self.first_frame(time)?;
        Ok(self.bytes(isovalue, first, first + 2, OF_A_CUT))
    }

    fn bytes(&self, isovalue: f32, from: usize, to: usize, of_a_cut: u64) -> u64 {
        let levels = self.levels(isovalue, from, to);
        let tetrahedra: u64 =
            levels.windows(2).map(|pair| count_tetrahedra(self.placement.counts, [pair[0], pair[1]])).sum();
        tetrahedra * (OF_A_TETRAHEDRON + of_a_cut) + 3 * OF_A_SAMPLE * self.placement.samples() as u64
    }

    /// The frame before a time; for the last frame the one before it.
    fn first_frame(&self, time: f64) -> Result<usize, FourError> {
        let last = self.frames.len() - 1;
        if !(0.0..=last as f64).contains(&time) {
            return Err(FourError::Time { time, last });
        }
        Ok((time as usize).min(last - 1))
    }

    fn levels(&self, isovalue: f32, from: usize, to: usize) -> Vec<Level<'_>> {
        self.frames[from..to].iter().map(|samples| Level { samples, isovalue }).collect()
    }
}

/// Four numbers of vertices, twice while layers are put together, and room to grow; and its share of vertices, of which a closed
/// manifold has fewer than tetrahedra.
const OF_A_TETRAHEDRON: u64 = 3 * 16 + 2 * 32;
/// Four crossings, sorted; two triangles of vertices.
const OF_A_CUT: u64 = 2 * (4 * 8 + 2 * 24 + 2 * 12 + 4 * 12);
/// The numbers of vertices, along axes or to the next frame.
const OF_A_SAMPLE: u64 = 5;
