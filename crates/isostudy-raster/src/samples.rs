//! The sample grid: depth and exposure level of what is nearest.

use crate::Viewport;
use glam::Vec4;

/// Level of a sample that shows the background.
pub(crate) const BACKGROUND: f32 = 0.0;
/// Level of a sample that shows a line.
pub(crate) const WIRE: f32 = 65536.0;
/// Highest level of a surface, the lowest is 1.
pub(crate) const TOP_LEVEL: f32 = 16383.0;
/// Levels of brightness that a colour for a number has.
pub(crate) const SHADES: usize = 128;
/// Colours for numbers. With [`SHADES`] they are as many as there are levels.
pub(crate) const TINTS: usize = 127;
/// Samples the fill works on at once; rows have as many to spare at their end.
pub(crate) const LANES: usize = 4;

/// Exposures as levels from 1 to [`TOP_LEVEL`], evenly over `-max..=max`; fractions are kept until a pixel is looked
/// up. By default a whole level is 0.00012 in d, and under 0.08 of an 8-bit level in every channel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LevelScale {
    max: f32,
    per_unit: f32,
}

impl LevelScale {
    pub(crate) fn new(max_exposure: f32) -> LevelScale {
        let max = max_exposure.max(f32::MIN_POSITIVE.sqrt());
        LevelScale { max, per_unit: (TOP_LEVEL - 1.0) / (2.0 * max) }
    }

    /// The levels of four exposures, clamped.
    #[inline]
    pub(crate) fn levels(&self, exposures: Vec4) -> Vec4 {
        let levels = (exposures + self.max) * self.per_unit + 1.0;
        levels.clamp(Vec4::ONE, Vec4::splat(TOP_LEVEL))
    }

    pub(crate) fn exposure(&self, level: f32) -> f32 {
        (level - 1.0) / self.per_unit - self.max
    }
}

/// Levels for surfaces that are coloured by numbers: whole, `1 + tint * SHADES + shade`, from those of their exposures and
/// from places on the scale, 0 to 1. [`tint_and_shade`] is the way back.
#[inline]
pub(crate) fn coloured_levels(exposure_levels: Vec4, places: Vec4) -> Vec4 {
    const LAST: f32 = (SHADES - 1) as f32;
    let shades = ((exposure_levels - 1.0) * (LAST / (TOP_LEVEL - 1.0)) + 0.5).floor();
    let tints = (places.clamp(Vec4::ZERO, Vec4::ONE) * (TINTS - 1) as f32 + 0.5).floor();
    tints * SHADES as f32 + shades + 1.0
}

/// Place on the scale and exposure of a level that [`coloured_levels`] gave.
pub(crate) fn tint_and_shade(level: usize, scale: &LevelScale) -> (f32, f32) {
    let (tint, shade) = ((level - 1) / SHADES, (level - 1) % SHADES);
    let exposure_level = 1.0 + shade as f32 * ((TOP_LEVEL - 1.0) / (SHADES - 1) as f32);
    (tint as f32 / (TINTS - 1) as f32, scale.exposure(exposure_level))
}

/// Samples of one picture, row by row.
#[derive(Debug)]
pub(crate) struct Samples {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// From a row's start to the next; more than `width`. What lies between is never shown.
    pub(crate) stride: usize,
    /// 1 / distance along the line of sight; 0 where nothing is.
    pub(crate) nearness: Vec<f32>,
    pub(crate) level: Vec<f32>,
    /// Rows and columns that may differ from the background.
    touched: Touched,
}

/// A half-open rectangle of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Touched {
    x: [usize; 2],
    y: [usize; 2],
}

const NOTHING: Touched = Touched { x: [usize::MAX, 0], y: [usize::MAX, 0] };

impl Samples {
    pub(crate) fn new(viewport: &Viewport) -> Samples {
        let [width, height] =
            [viewport.width, viewport.height].map(|v| v as usize * viewport.supersampling as usize);
        let stride = width + LANES;
        Samples {
            width,
            height,
            stride,
            nearness: vec![0.0; stride * height],
            level: vec![BACKGROUND; stride * height],
            touched: NOTHING,
        }
    }

    /// Back to the background; costs only what was touched.
    pub(crate) fn clear(&mut self) {
        let Touched { x, y } = self.touched;
        for row in y[0]..y[1] {
            let row = row * self.stride;
            self.nearness[row + x[0]..row + x[1]].fill(0.0);
            self.level[row + x[0]..row + x[1]].fill(BACKGROUND);
        }
        self.touched = NOTHING;
    }

    #[inline]
    pub(crate) fn touch(&mut self, x: [usize; 2], y: [usize; 2]) {
        let t = &mut self.touched;
        t.x = [t.x[0].min(x[0]), t.x[1].max(x[1])];
        t.y = [t.y[0].min(y[0]), t.y[1].max(y[1])];
    }

    /// The pixels (half-open ranges of columns and rows) that may differ from the background.
    pub(crate) fn touched_pixels(&self, supersampling: usize) -> [std::ops::Range<usize>; 2] {
        let Touched { x, y } = self.touched;
        [x, y]
            .map(|[from, to]| if from < to { from / supersampling..to.div_ceil(supersampling) } else { 0..0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_of_colours_are_told_apart_and_lead_back() {
        let scale = LevelScale::new(1.0);
        assert!(TINTS * SHADES <= TOP_LEVEL as usize);
        for place in [0.0, 0.25, 0.5, 0.8, 1.0] {
            for exposure in [-1.0, -0.3, 0.0, 0.7, 1.0] {
                let levels = coloured_levels(scale.levels(Vec4::splat(exposure)), Vec4::splat(place));
                let (p, d) = tint_and_shade(levels.x as usize, &scale);
                assert!((p - place).abs() <= 0.5 / 126.0 + 1e-6, "{place}: {p}");
                assert!((d - exposure).abs() <= 1.0 / 127.0 + 1e-5, "{exposure}: {d}");
            }
        }
    }
}
