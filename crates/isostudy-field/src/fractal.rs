//! Sums of gradient noise at doubling frequencies.

use glam::DVec3;

use crate::noise::{NOISE_SLOPE, Near, noise, noise_and_gradient, noise_range, noise_row};

/// The most octaves of a [`Fractal`].
pub const MOST_OCTAVES: u32 = 16;

/// Where an octave's lattice lies in that of the one before: not on it, since noise is 0 at all its points. Not along z,
/// so that a plane z = 0 is one of whole numbers in all octaves, where noise takes half the time.
const SHIFT: DVec3 = DVec3::new(0.381_966_011_250_105_1, 0.618_033_988_749_894_9, 0.0);

/// How many places are worked on at a time.
pub(crate) const ROW: usize = 64;
/// Of fewer, each is worked on alone: there is nothing to share.
pub(crate) const FEW: usize = 4;

/// What an octave makes of the noise `n`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseShape {
    /// `n`, in [-1, 1]: fractional Brownian motion.
    Plain,
    /// `(1 - |n|)^2`, in [0, 1]: sharp crests between smooth hollows.
    Ridged,
    /// `|n|`, in [0, 1]: round bumps between sharp creases.
    Billowed,
}

/// A weighted mean of octaves of [`noise`]: `sum gain^k shape(noise(2^k p + k s, seed + k)) / sum gain^k`, k from 0, with
/// `s` = (0.3819660112501051, 0.6180339887498949, 0), and seeds modulo 2^32. One octave of the plain shape is the noise itself. The same to the bit on every machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fractal {
    shape: NoiseShape,
    seed: u32,
    octaves: u32,
    /// They add up to 1, up to rounding.
    weights: [f64; MOST_OCTAVES as usize],
}

impl Fractal {
    /// `octaves` from 1 to [`MOST_OCTAVES`] and `gain` from 0 to 1; what lies beyond is taken for the nearer end.
    pub fn new(shape: NoiseShape, octaves: u32, gain: f64, seed: u32) -> Self {
        let octaves = octaves.clamp(1, MOST_OCTAVES);
        let gain = if gain.is_nan() { 0.0 } else { gain.clamp(0.0, 1.0) };
        let mut weights = [0.0; MOST_OCTAVES as usize];
        let (mut weight, mut sum) = (1.0, 0.0);
        for slot in &mut weights[..octaves as usize] {
            *slot = weight;
            sum += weight;
            weight *= gain;
        }
        Self { shape, seed, octaves, weights: weights.map(|weight| weight / sum) }
    }

    /// The value at `p`: in the shape's range, but for rounding. `NaN` at what is not finite.
    pub fn value(&self, p: DVec3) -> f64 {
        let mut sum = 0.0;
        for (octave, weight) in self.octaves() {
            sum += self.shaped(noise(octave.place(p), octave.seed)) * weight;
        }
        sum
    }

    /// [`value`](Self::value) at `(x[i], y[i], z[i])` into `values[i]`, to the bit. It is faster where places that follow each other are
    /// near each other. All slices have the same length.
    pub fn values(&self, [x, y, z]: [&[f64]; 3], values: &mut [f64]) {
        if values.len() < FEW {
            for (i, value) in values.iter_mut().enumerate() {
                *value = self.value(DVec3::new(x[i], y[i], z[i]));
            }
            return;
        }
        for first in (0..values.len()).step_by(ROW) {
            let part = first..values.len().min(first + ROW);
            let places = [x, y, z].map(|along| &along[part.clone()]);
            self.values_of_part(places, &mut values[part]);
        }
    }

    /// The same for at most [`ROW`] places: octave by octave, in the order of one value.
    fn values_of_part(&self, places: [&[f64]; 3], values: &mut [f64]) {
        let (mut of_octave, mut found) = ([[0.0; ROW]; 3], [0.0; ROW]);
        let found = &mut found[..values.len()];
        values.fill(0.0);
        for (octave, weight) in self.octaves() {
            for ((to, from), shift) in of_octave.iter_mut().zip(places).zip(octave.shift.to_array()) {
                for (to, from) in to.iter_mut().zip(from) {
                    *to = from * octave.frequency + shift;
                }
            }
            noise_row(of_octave.each_ref().map(|along| &along[..found.len()]), octave.seed, found);
            for (sum, n) in values.iter_mut().zip(&*found) {
                *sum += self.shaped(*n) * weight;
            }
        }
    }

    /// [`value`](Self::value) to the bit, and its gradient; where the noise of an octave is 0, that of one side of the crest or crease.
    pub fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        let (mut sum, mut gradient) = (0.0, DVec3::ZERO);
        for (octave, weight) in self.octaves() {
            let (n, of_noise) = noise_and_gradient(octave.place(p), octave.seed);
            sum += self.shaped(n) * weight;
            gradient += of_noise * (self.shaped_slope(n) * octave.frequency * weight);
        }
        (sum, gradient)
    }

    /// A bound on the change a unit of length: that of the noise, times 2^k for octave k, and times 2 where it is squared.
    pub fn slope(&self) -> f64 {
        let steepness = if self.shape == NoiseShape::Ridged { 2.0 } else { 1.0 };
        self.octaves().map(|(octave, weight)| octave.frequency * weight * steepness * NOISE_SLOPE).sum()
    }

    /// A range that holds every value in the box from `low` to `high`, which are finite.
    pub fn range(&self, low: DVec3, high: DVec3) -> (f64, f64) {
        if self.shape == NoiseShape::Plain {
            return self.plain_range(low, high);
        }
        let mut range = (0.0, 0.0);
        for (octave, weight) in self.octaves() {
            let of_noise = noise_range(octave.place(low), octave.place(high), octave.seed);
            let (least, greatest) = self.shaped_range(of_noise);
            range = (range.0 + least * weight, range.1 + greatest * weight);
        }
        (range.0 - 1e-12, range.1 + 1e-12)
    }

    /// Gradients are added before their size is taken: those of different octaves may cancel.
    fn plain_range(&self, low: DVec3, high: DVec3) -> (f64, f64) {
        let (mut middle, mut gradient, mut off) = (0.0, DVec3::ZERO, 1e-12);
        for (octave, weight) in self.octaves() {
            match Near::of(octave.place(low), octave.place(high), octave.seed) {
                Some(near) => {
                    middle += near.value * weight;
                    gradient += near.gradient * (octave.frequency * weight);
                    off += near.off * weight;
                }
                None => off += weight,
            }
        }
        off += gradient.abs().dot((high - low) * 0.5);
        ((middle - off).max(-1.0 - 1e-12), (middle + off).min(1.0 + 1e-12))
    }

    /// The least and the greatest value that there can be, but for rounding.
    pub fn bounds(&self) -> (f64, f64) {
        if self.shape == NoiseShape::Plain { (-1.0, 1.0) } else { (0.0, 1.0) }
    }

    #[inline]
    fn shaped(&self, n: f64) -> f64 {
        match self.shape {
            NoiseShape::Plain => n,
            NoiseShape::Ridged => (1.0 - n.abs()) * (1.0 - n.abs()),
            NoiseShape::Billowed => n.abs(),
        }
    }

    /// How the shape changes with the noise.
    fn shaped_slope(&self, n: f64) -> f64 {
        match self.shape {
            NoiseShape::Plain => 1.0,
            NoiseShape::Ridged => -2.0 * (1.0 - n.abs()) * n.signum(),
            NoiseShape::Billowed => n.signum(),
        }
    }

    fn shaped_range(&self, (low, high): (f64, f64)) -> (f64, f64) {
        let greatest = high.max(-low);
        let least = low.max(-high).max(0.0);
        match self.shape {
            NoiseShape::Plain => (low, high),
            NoiseShape::Ridged => (self.shaped(greatest), self.shaped(least)),
            NoiseShape::Billowed => (least, greatest),
        }
    }

    /// Each octave with its weight.
    fn octaves(&self) -> impl Iterator<Item = (Octave, f64)> {
        let first = Octave { seed: self.seed, frequency: 1.0, shift: DVec3::ZERO };
        let all = std::iter::successors(Some(first), |octave| {
            Some(Octave {
                seed: octave.seed.wrapping_add(1),
                frequency: octave.frequency * 2.0,
                shift: octave.shift + SHIFT,
            })
        });
        all.zip(self.weights).take(self.octaves as usize)
    }
}

struct Octave {
    seed: u32,
    frequency: f64,
    shift: DVec3,
}

impl Octave {
    fn place(&self, p: DVec3) -> DVec3 {
        p * self.frequency + self.shift
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fractal() -> impl Strategy<Value = Fractal> {
        let shape = prop::sample::select(vec![NoiseShape::Plain, NoiseShape::Ridged, NoiseShape::Billowed]);
        (shape, 1..=MOST_OCTAVES, 0.0..=1.0, any::<u32>())
            .prop_map(|(shape, octaves, gain, seed)| Fractal::new(shape, octaves, gain, seed))
    }

    fn point(size: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2_000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn values_stay_in_range_and_below_the_slope(
            fractal in fractal(),
            low in point(20.0),
            size in prop_oneof![point(1e-4), point(0.05), point(2.0)],
            parts in prop::collection::vec(prop::array::uniform3(0.0..=1.0f64), 12),
        ) {
            let high = low + size.abs();
            let (least, greatest) = fractal.range(low, high);
            let (bottom, top) = fractal.bounds();
            prop_assert!(bottom - 1e-11 <= least && greatest <= top + 1e-11);
            let mut before: Option<(DVec3, f64)> = None;
            for part in parts {
                let p = (low + size.abs() * DVec3::from_array(part)).clamp(low, high);
                let value = fractal.value(p);
                prop_assert!(least <= value && value <= greatest, "{value} not in {least}..{greatest}");
                if let Some((q, other)) = before {
                    prop_assert!((value - other).abs() <= fractal.slope() * p.distance(q) + 1e-12);
                }
                before = Some((p, value));
            }
        }
    }

    #[test]
    fn one_plain_octave_is_the_noise() {
        for i in 0..100 {
            let p = DVec3::new(0.37, -1.21, 0.83) * f64::from(i);
            assert_eq!(Fractal::new(NoiseShape::Plain, 1, 0.5, 8).value(p).to_bits(), noise(p, 8).to_bits());
        }
    }

    #[test]
    fn what_is_out_of_range_is_taken_for_the_nearer_end() {
        let of = |octaves, gain| Fractal::new(NoiseShape::Plain, octaves, gain, 3);
        assert_eq!((of(0, 0.5), of(99, 0.5)), (of(1, 0.5), of(16, 0.5)));
        assert_eq!((of(4, -1.0), of(4, 7.0), of(4, f64::NAN)), (of(4, 0.0), of(4, 1.0), of(4, 0.0)));
    }

    /// `scripts/noise_values.py`.
    #[test]
    fn values_are_those_of_an_independent_program() {
        for (shape, octaves, gain, seed, bits) in [
            (NoiseShape::Plain, 5, 0.5, 2, 0x3fa2_aeb9_afc1_23e2u64),
            (NoiseShape::Ridged, 4, 0.5, 9, 0x3fe8_b60e_33c3_cabc),
            (NoiseShape::Billowed, 3, 0.4, 4_294_967_290, 0x3fd7_ffc2_85e9_4e59),
        ] {
            let value = Fractal::new(shape, octaves, gain, seed).value(DVec3::new(0.3, -1.7, 2.45));
            assert_eq!(value.to_bits(), bits, "{shape:?}: {value}");
        }
    }
}
