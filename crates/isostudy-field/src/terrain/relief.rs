//! The height of the ground, before overhangs and caves.

use glam::DVec3;

use super::TerrainSettings;
use crate::fractal::{Fractal, NoiseShape, ROW};

/// The part of a terrace's height that its riser takes of the way.
const RISER: f64 = 0.2;
/// How much of a terrace stays a slope, so that treads are not flat.
const SLOPING: f64 = 0.25;

/// Heights over a plane, in widths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Relief {
    ground: f64,
    relief: f64,
    period: f64,
    terrace: f64,
    /// Plain, ridged and billowed, each with its share.
    parts: [(Fractal, f64); 3],
}

impl Relief {
    pub(super) fn new(settings: &TerrainSettings, seed: u32) -> Self {
        let TerrainSettings { ground, relief, period, terrace, ridged, billowed, .. } = *settings;
        let of = |shape, number: u32| {
            Fractal::new(shape, settings.octaves, settings.gain, seed.wrapping_add(number << 8))
        };
        let parts = [
            (of(NoiseShape::Plain, 1), 1.0 - ridged - billowed),
            (of(NoiseShape::Ridged, 2), ridged),
            (of(NoiseShape::Billowed, 3), billowed),
        ];
        Self { ground, relief, period, terrace, parts }
    }

    pub(super) fn height(&self, x: f64, y: f64) -> f64 {
        let place = DVec3::new(x / self.period, y / self.period, 0.0);
        let mut sum = 0.0;
        for (noise, share) in self.shared() {
            sum += centred(noise, noise.value(place)) * share;
        }
        self.ground + self.terraced(self.relief * sum)
    }

    /// The heights at `(x[i], y[i])` into `heights[i]`, each [`height`](Self::height) to the bit.
    pub(super) fn heights(&self, x: &[f64], y: &[f64], heights: &mut [f64]) {
        let count = heights.len();
        let (mut places, mut found) = ([[0.0; ROW]; 3], [0.0; ROW]);
        for (to, from) in places.iter_mut().zip([x, y]) {
            for (to, from) in to.iter_mut().zip(from) {
                *to = from / self.period;
            }
        }
        heights.fill(0.0);
        for (noise, share) in self.shared() {
            noise.values(places.each_ref().map(|along| &along[..count]), &mut found[..count]);
            for (sum, value) in heights.iter_mut().zip(&found) {
                *sum += centred(noise, *value) * share;
            }
        }
        for height in heights {
            *height = self.ground + self.terraced(self.relief * *height);
        }
    }

    /// The height, and how it changes along x and y.
    pub(super) fn height_and_slopes(&self, x: f64, y: f64) -> (f64, [f64; 2]) {
        let place = DVec3::new(x / self.period, y / self.period, 0.0);
        let (mut sum, mut slopes) = (0.0, DVec3::ZERO);
        for (noise, share) in self.shared() {
            let (value, gradient) = noise.value_and_gradient(place);
            sum += centred(noise, value) * share;
            slopes += gradient * (centring(noise) * share);
        }
        let height = self.relief * sum;
        let slopes = slopes * (self.terraced_slope(height) * self.relief / self.period);
        (self.ground + self.terraced(height), [slopes.x, slopes.y])
    }

    /// Heights over a rectangle, each side from low to high.
    pub(super) fn range(&self, [x, y]: [(f64, f64); 2]) -> (f64, f64) {
        let low = DVec3::new(x.0 / self.period, y.0 / self.period, 0.0);
        let high = DVec3::new(x.1 / self.period, y.1 / self.period, 0.0);
        let mut sum = (0.0, 0.0);
        for (noise, share) in self.shared() {
            let (least, greatest) = noise.range(low, high);
            sum = (sum.0 + centred(noise, least) * share, sum.1 + centred(noise, greatest) * share);
        }
        // Terraces grow with the height.
        (
            self.ground + self.terraced(self.relief * sum.0) - 1e-12,
            self.ground + self.terraced(self.relief * sum.1) + 1e-12,
        )
    }

    /// No height is below the first or above the second.
    pub(super) fn bounds(&self) -> (f64, f64) {
        let share: f64 = self.shared().map(|(_, share)| share).sum();
        let farthest = self.relief * share * (1.0 + 1e-9);
        (self.ground + self.terraced(-farthest) - 1e-12, self.ground + self.terraced(farthest) + 1e-12)
    }

    /// A bound on the change of the height a unit of length.
    pub(super) fn slope(&self) -> f64 {
        let noise: f64 = self.shared().map(|(noise, share)| centring(noise) * noise.slope() * share).sum();
        let steeper = if self.terrace > 0.0 { SLOPING + (1.0 - SLOPING) * 1.5 / RISER } else { 1.0 };
        self.relief / self.period * noise * steeper
    }

    fn shared(&self) -> impl Iterator<Item = (&Fractal, f64)> {
        self.parts.iter().filter(|(_, share)| *share > 0.0).map(|(noise, share)| (noise, *share))
    }

    /// A height with terraces: it keeps every multiple of theirs, grows throughout, and is at most
    /// `SLOPING + (1 - SLOPING) 1.5 / RISER` times as steep.
    fn terraced(&self, height: f64) -> f64 {
        if self.terrace == 0.0 {
            return height;
        }
        let steps = height / self.terrace;
        let below = steps.floor();
        let part = steps - below;
        let way = riser_way(part);
        let rise = way * way * (3.0 - 2.0 * way);
        (below + SLOPING * part + (1.0 - SLOPING) * rise) * self.terrace
    }

    /// How fast it grows with the height without terraces.
    fn terraced_slope(&self, height: f64) -> f64 {
        if self.terrace == 0.0 {
            return 1.0;
        }
        let steps = height / self.terrace;
        let way = riser_way(steps - steps.floor());
        SLOPING + (1.0 - SLOPING) * 6.0 * way * (1.0 - way) / RISER
    }
}

/// How much of a riser is below a part of its terrace, 0 to 1.
fn riser_way(part: f64) -> f64 {
    ((part - (1.0 - RISER)) / RISER).max(0.0)
}

/// From the shape's range to [-1, 1].
fn centred(noise: &Fractal, value: f64) -> f64 {
    let (low, high) = noise.bounds();
    ((value - low) + (value - high)) / (high - low)
}

fn centring(noise: &Fractal) -> f64 {
    let (low, high) = noise.bounds();
    2.0 / (high - low)
}
