//! From a pixel's samples to its palette index where colours stand for numbers.
//!
//! The mean of two levels is no level here, so colours are averaged and searched for, pixel by pixel.

use crate::Palette;
use crate::level_colours::LevelColours;
use crate::nearest::Search;
use crate::samples::{BACKGROUND, Samples};

/// Palette indices for pixels of `supersampling` squared samples.
pub(crate) struct ColourIndex {
    colours: LevelColours,
    search: Search,
    supersampling: usize,
}

impl ColourIndex {
    pub(crate) fn new(colours: LevelColours, palette: &Palette, supersampling: u32) -> ColourIndex {
        ColourIndex { colours, search: Search::new(palette), supersampling: supersampling as usize }
    }

    /// The picture as palette indices, row by row.
    pub(crate) fn index(&self, samples: &Samples) -> Vec<u8> {
        let s = self.supersampling;
        let width = samples.width / s;
        let background = self.search.nearest(self.colours.of(BACKGROUND));
        let mut indices = vec![background; width * (samples.height / s)];
        let [columns, rows] = samples.touched_pixels(s);
        let mut levels = Vec::with_capacity(s * s);
        // Neighbours inside a triangle have the same levels.
        let (mut last, mut found) = (Vec::with_capacity(s * s), background);
        for y in rows {
            for x in columns.clone() {
                levels.clear();
                for row in 0..s {
                    let from = (y * s + row) * samples.stride + x * s;
                    levels.extend_from_slice(&samples.level[from..from + s]);
                }
                if levels != last {
                    found = self.search.nearest(self.colours.mean(&levels));
                    last.clone_from(&levels);
                }
                indices[y * width + x] = found;
            }
        }
        indices
    }
}
