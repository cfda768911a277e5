//! Series of volumes in one file: a fourth axis, of frames.

use std::path::Path;

use crate::error::{Problem, VolumeError};
use crate::header::{Frame, Unread};
use crate::nrrd::{self, FrameAxis};

/// What a frame takes beside its samples.
const OF_A_FRAME: u64 = 64;

/// Volumes on one grid, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumeSeries {
    /// How many samples there are along each axis of the grid; none is zero.
    pub counts: [usize; 3],
    /// Where the first sample lies.
    pub origin: [f64; 3],
    /// From one sample to the next, along each axis of the grid. Finite, and no two in one plane with the third.
    pub steps: [[f64; 3]; 3],
    /// The samples of each frame, the first axis fastest. They may be infinite or NaN where the file's are.
    pub frames: Vec<Vec<f32>>,
}

/// A series of which the header was read, and no sample.
#[derive(Debug)]
pub struct UnreadSeries {
    all: Unread,
    axis: FrameAxis,
}

/// Reads the header of a series in one file, `.nrrd` or `.nhdr` with four axes, and none of its samples.
///
/// The axis of frames is the one that has no direction where the others have one. Otherwise it is that of the kind `time`, or `list`, or
/// the last. Axes of length 1 beyond four are passed over. Frames may be one.
///
/// # Errors
/// [`VolumeError`], with the file, and the line of the header where one is to blame.
pub fn open_series(path: &Path) -> Result<UnreadSeries, VolumeError> {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match ending.as_str() {
        "nrrd" | "nhdr" => nrrd::open_series(path).map(|(all, axis)| UnreadSeries { all, axis }),
        _ => {
            let problem = Problem::unsupported("ending", &ending, "a series in one file is .nrrd or .nhdr");
            Err(problem.in_file(path))
        }
    }
}

impl UnreadSeries {
    /// Where the samples of each frame lie.
    pub fn frame(&self) -> Frame {
        self.all.frame()
    }

    /// How many frames there are; not zero.
    pub fn frames(&self) -> usize {
        self.axis.frames
    }

    /// What the samples take in memory while they are taken apart: one frame more than there are, or all of them twice where frames are
    /// not the last axis.
    pub fn memory_bytes(&self) -> u64 {
        let all = self.all.memory_bytes();
        let samples = self.frame_samples() as u64;
        let twice = if self.axis.before as u64 == samples { samples * crate::SAMPLE_BYTES } else { all };
        all.saturating_add(twice).saturating_add(OF_A_FRAME * self.axis.frames as u64)
    }

    /// Reads the samples. `limit_bytes` bounds [`memory_bytes`](Self::memory_bytes).
    ///
    /// # Errors
    /// As [`read`](crate::read); [`Problem::TooManySamples`] before anything is read.
    pub fn read(self, limit_bytes: u64) -> Result<VolumeSeries, VolumeError> {
        let (needed, samples, FrameAxis { frames: count, before }) =
            (self.memory_bytes(), self.frame_samples(), self.axis);
        if needed > limit_bytes {
            let sizes = self.frame().counts.map(|n| n as u64).into_iter().chain([count as u64]).collect();
            let limit = limit_bytes / crate::SAMPLE_BYTES;
            let problem = Problem::TooManySamples { sizes, needed: Some(needed), limit };
            return Err(problem.in_file(self.all.path()));
        }
        let path = self.all.path().to_owned();
        let volume = self.all.read(limit_bytes)?;
        let mut values = volume.values;
        let mut frames = Vec::new();
        if before == samples {
            for number in (1..count).rev() {
                frames.push(values.split_off(number * samples));
                values.shrink_to_fit();
            }
            frames.push(values);
            frames.reverse();
        } else {
            for number in 0..count {
                let mut frame = Vec::new();
                let reserved = frame.try_reserve_exact(samples);
                reserved.map_err(|_| Problem::OutOfMemory { samples: samples as u64 }.in_file(&path))?;
                for together in values.chunks_exact(before * count) {
                    frame.extend_from_slice(&together[number * before..][..before]);
                }
                frames.push(frame);
            }
        }
        let (counts, origin, steps) = (volume.counts, volume.origin, volume.steps);
        Ok(VolumeSeries { counts, origin, steps, frames })
    }

    fn frame_samples(&self) -> usize {
        // No overflow: countable with the frames.
        self.frame().counts.iter().product()
    }
}
