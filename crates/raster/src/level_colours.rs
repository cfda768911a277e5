//! The colour of every sample level.

use crate::Shading;
use crate::samples::{BACKGROUND, LevelScale, TOP_LEVEL};

/// Colours in 0..255, one a level, unrounded.
pub(crate) struct LevelColours {
    surface: Vec<[f32; 3]>,
    background: [f32; 3],
    wire: [f32; 3],
}

impl LevelColours {
    pub(crate) fn new(shading: &Shading) -> LevelColours {
        let scale = LevelScale::new(shading.max_exposure());
        let in_255 = |colour: [f32; 3]| colour.map(|v| v.clamp(0.0, 1.0) * 255.0);
        LevelColours {
            surface: (0..=TOP_LEVEL as usize)
                .map(|l| in_255(shading.colour(scale.exposure(l as f32))))
                .collect(),
            background: in_255(shading.background),
            wire: in_255(shading.wire),
        }
    }

    #[inline]
    pub(crate) fn of(&self, level: f32) -> [f32; 3] {
        if level == BACKGROUND {
            self.background
        } else if level > TOP_LEVEL {
            self.wire
        } else {
            self.surface[(level + 0.5) as usize]
        }
    }

    /// The mean over a pixel's samples: what anti-aliasing shows.
    #[inline]
    pub(crate) fn mean(&self, levels: &[f32]) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for &level in levels {
            let colour = self.of(level);
            sum = [0, 1, 2].map(|c| sum[c] + colour[c]);
        }
        sum.map(|v| v / levels.len() as f32)
    }
}
