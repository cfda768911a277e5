//! Samples as labels: whole numbers that name what is there.

use thiserror::Error;

use crate::Volume;

/// The first number that is no label: from here on samples in single precision are not all whole numbers apart.
pub const LABELS_END: u32 = 1 << 24;

/// A sample that is no label.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("the sample {place:?} is {value}; labels are whole numbers from 0 to {}", LABELS_END - 1)]
pub struct NotALabel {
    /// Where, along the axes of the grid.
    pub place: [usize; 3],
    /// What stands there.
    pub value: f32,
}

impl Volume {
    /// The samples as labels, in their order. The type in the file does not matter, its numbers do.
    ///
    /// # Errors
    /// [`NotALabel`], for the first sample that is negative, no whole number, or too large.
    pub fn labels(&self) -> Result<Vec<u32>, NotALabel> {
        let label = |(i, &value): (usize, &f32)| {
            let number = value as u32;
            if number as f32 == value && number < LABELS_END {
                return Ok(number);
            }
            let [nx, ny, _] = self.counts;
            Err(NotALabel { place: [i % nx, i / nx % ny, i / nx / ny], value })
        };
        self.values.iter().enumerate().map(label).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_whole_numbers() {
        let of = |value: f32| {
            let mut values = vec![3.0; 24];
            values[1 + 2 * (2 + 3)] = value;
            let steps = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            Volume { counts: [2, 3, 4], origin: [0.0; 3], steps, values }.labels()
        };
        for (value, label) in [(0.0, 0), (-0.0, 0), (7.0, 7), (16_777_215.0, 16_777_215)] {
            assert_eq!(of(value).unwrap()[11], label);
        }
        for value in [0.5, -1.0, 16_777_216.0, f32::NAN, f32::INFINITY, -1e-9] {
            let error = of(value).unwrap_err();
            assert_eq!(error.place, [1, 2, 1]);
            assert_eq!(error.value.to_bits(), value.to_bits());
        }
        let said = of(0.5).unwrap_err().to_string();
        assert_eq!(said, "the sample [1, 2, 1] is 0.5; labels are whole numbers from 0 to 16777215");
    }
}
