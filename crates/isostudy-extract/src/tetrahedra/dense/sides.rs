//! Which side of the isovalue stored sample points are on.

use crate::lattice::{DIRECTIONS, Layout, PADDING_LAYERS};

/// One byte a sample point, 1 inside, with room at both ends so that every step to a neighbour stays in it.
#[derive(Debug)]
pub(crate) struct Sides {
    bytes: Vec<u8>,
    padding: usize,
}

impl Sides {
    pub(crate) fn new(layout: &Layout) -> Self {
        let padding = PADDING_LAYERS * layout.layer_len();
        Self { bytes: vec![0; layout.len() + 2 * padding], padding }
    }

    /// Inside is a value above the isovalue; equal is outside, and so is `NaN`.
    pub(crate) fn fill(&mut self, samples: &[f32], isovalue: f32) {
        for (side, value) in self.bytes[self.padding..].iter_mut().zip(samples) {
            *side = u8::from(isovalue - value < 0.0);
        }
    }

    pub(crate) fn is_inside(&self, point: usize) -> bool {
        self.bytes[self.padding + point] != 0
    }

    /// Marks the points of a row that differ from any of their fourteen neighbours.
    pub(crate) fn mark_active(&self, first: usize, steps: &[isize; DIRECTIONS], active: &mut [u8]) {
        let row = |start: usize| &self.bytes[start..start + active.len()];
        let here = row(self.padding + first);
        let rows = steps.map(|step| {
            row((self.padding + first).checked_add_signed(step).expect("a point of the lattice"))
        });
        for (i, mark) in active.iter_mut().enumerate() {
            *mark = rows.iter().fold(0, |mark, row| mark | (row[i] ^ here[i]));
        }
    }
}
