//! Samples on a grid, and the side of each.

use thiserror::Error;

/// Samples on a regular grid, x fastest.
#[derive(Debug, Clone, Copy)]
pub struct Samples<'a> {
    counts: [usize; 3],
    values: &'a [f32],
}

/// Which side a sample is on that equals the isovalue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Ties {
    /// Outside, as if the isovalue were larger by less than any number: inside is a value above it. The rule of this project.
    #[default]
    Outside,
    /// Inside, as if it were smaller: inside is a value not below it. VTK's rule.
    Inside,
}

/// Why samples have no level set.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SamplesError {
    /// The counts along the axes do not make the number of samples.
    #[error("{samples} samples, and {counts:?} along the axes")]
    Counts {
        /// As given.
        counts: [usize; 3],
        /// How many samples there are.
        samples: usize,
    },
    /// An axis has fewer than two samples, so that there is no cell.
    #[error("{counts:?} samples along the axes; there must be two or more along each")]
    Flat {
        /// As given.
        counts: [usize; 3],
    },
    /// More samples than a 32-bit index can name.
    #[error("{samples} samples exceed the limit of {}", u32::MAX / 3)]
    TooMany {
        /// How many there are.
        samples: usize,
    },
    /// A sample is infinite or not a number: nothing is between it and its neighbours.
    #[error("sample {place:?} is {value}; all samples must be finite")]
    NotFinite {
        /// Its place along each axis.
        place: [usize; 3],
        /// What it is.
        value: f32,
    },
    /// The isovalue is infinite or not a number.
    #[error("isovalue must be finite, not {value}")]
    Isovalue {
        /// What was given.
        value: f32,
    },
}

impl<'a> Samples<'a> {
    /// `counts[0] * counts[1] * counts[2]` samples, the first axis fastest.
    ///
    /// # Errors
    /// [`SamplesError`].
    pub fn try_new(counts: [usize; 3], values: &'a [f32]) -> Result<Self, SamplesError> {
        let samples = values.len();
        let product = counts.iter().try_fold(1usize, |product, &n| product.checked_mul(n));
        if product != Some(samples) {
            return Err(SamplesError::Counts { counts, samples });
        }
        if counts.iter().any(|&n| n < 2) {
            return Err(SamplesError::Flat { counts });
        }
        if samples > (u32::MAX / 3) as usize {
            return Err(SamplesError::TooMany { samples });
        }
        if let Some(i) = values.iter().position(|value| !value.is_finite()) {
            let [nx, ny, _] = counts;
            return Err(SamplesError::NotFinite {
                place: [i % nx, i / nx % ny, i / nx / ny],
                value: values[i],
            });
        }
        Ok(Self { counts, values })
    }

    /// Samples along each axis.
    pub fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// The samples, the first axis fastest.
    pub fn values(&self) -> &'a [f32] {
        self.values
    }
}
