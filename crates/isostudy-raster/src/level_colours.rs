//! The colour of every sample level.

use crate::samples::{BACKGROUND, LevelScale, SHADES, TINTS, TOP_LEVEL, tint_and_shade};
use crate::{Shading, map_colour};

/// Colours in 0..255, one a level, unrounded.
pub(crate) struct LevelColours {
    surface: Vec<[f32; 3]>,
    background: [f32; 3],
    wire: [f32; 3],
}

impl LevelColours {
    /// Those of the material.
    pub(crate) fn new(shading: &Shading) -> LevelColours {
        let scale = LevelScale::new(shading.max_exposure());
        let surface = (0..=TOP_LEVEL as usize).map(|l| shading.colour(scale.exposure(l as f32)));
        Self::with(surface, shading)
    }

    /// Those of numbers, shaded.
    pub(crate) fn of_numbers(shading: &Shading) -> LevelColours {
        let scale = LevelScale::new(shading.max_exposure());
        let colour = |level: usize| {
            let (place, exposure) = tint_and_shade(level.max(1), &scale);
            map_colour(place).map(|v| v * shading.brightness(exposure))
        };
        Self::with((0..=TINTS * SHADES).map(colour), shading)
    }

    fn with(surface: impl Iterator<Item = [f32; 3]>, shading: &Shading) -> LevelColours {
        let in_255 = |colour: [f32; 3]| colour.map(|v| v.clamp(0.0, 1.0) * 255.0);
        LevelColours {
            surface: surface.map(in_255).collect(),
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
