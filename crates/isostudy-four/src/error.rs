//! What can be wrong with a series, an isovalue or a time.

use thiserror::Error;

/// Why there is no surface. Frames count from 0.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FourError {
    /// Space-time needs two ends.
    #[error("there must be two frames or more, not {frames}")]
    Few {
        /// How many there are.
        frames: usize,
    },
    /// No cell fits between so few samples.
    #[error("there must be two samples or more along each axis, not {counts:?}")]
    Flat {
        /// Samples along the axes.
        counts: [usize; 3],
    },
    /// A frame has not as many samples as its size says.
    #[error("frame {frame} has {found} samples; {wanted} are needed")]
    Samples {
        /// Which frame.
        frame: usize,
        /// How many it has.
        found: usize,
        /// The product of the counts.
        wanted: usize,
    },
    /// A sample is NaN or infinite. Nothing can be interpolated there.
    #[error("frame {frame}: the sample at {place:?} is {value}; samples must be finite")]
    NotFinite {
        /// Which frame.
        frame: usize,
        /// Where, along the axes of the grid.
        place: [usize; 3],
        /// The sample.
        value: f32,
    },
    /// The isovalue is no number.
    #[error("the isovalue must be finite, not {isovalue}")]
    Isovalue {
        /// As given.
        isovalue: f32,
    },
    /// Nothing is between two isovalues.
    #[error("the first isovalue must be below the second: {low} and {high}")]
    Order {
        /// The first.
        low: f32,
        /// The second.
        high: f32,
    },
    /// The time is not in the series.
    #[error("time {time} is outside of the series, which goes from 0 to {last}")]
    Time {
        /// As given.
        time: f64,
        /// The number of the last frame.
        last: usize,
    },
    /// Vertices are numbered in 32 bits.
    #[error("there are more than {} vertices", u32::MAX)]
    TooMany,
}
