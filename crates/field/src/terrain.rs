//! Ground with hills, cliffs and caves.

mod relief;
mod settings;

use glam::{DVec3, Vec3};
use mesh::Bounds;

use crate::ScalarField;
use crate::fractal::{Fractal, NoiseShape};
use relief::Relief;
pub use settings::{TerrainCharacter, TerrainError, TerrainSettings};

/// How many octaves of noise the caves' walls and the overhangs have.
const SHIFT_OCTAVES: u32 = 2;
/// Caves are lower than they are wide.
const CAVE_STRETCH: f64 = 1.4;
/// How far noise typically is from 0, at a length of one cell away: makes a cave's value about a distance.
const CAVE_SLOPE: f64 = 1.5;
/// Two noises have squares with a sum below `t^2` in a share of about this times `t^2` of space.
const HOLLOW: f64 = 10.5;

/// A piece of ground, `z` up, inside where there is rock.
///
/// With all lengths in widths, `w` the height over the lower face of the bounds and `q` the place:
///
/// - ground: `ground + relief r - w`, where `r` in [-1, 1] is a mixture of plain, ridged and billowed
///   [`Fractal`] noise on the horizontal place, terraced where asked for;
/// - overhangs: the horizontal place is shifted by two 3D noises of `q / overhang_period`, times `overhang`;
/// - caves: the least of that and `c (n1^2 + n2^2 - t^2) / 2t`, with two 3D noises of `q / cave_period`: tunnels along the
///   curves on which both are 0. `t` is chosen by `caves`, and `c` so that the value is about a distance;
/// - walls: the least of that and the distance to the nearest wall, where the terrain is closed.
///
/// The value is all this in the unit of the coordinates. It is about the vertical distance to the ground, or the horizontal
/// distance to a wall, not the distance to the nearest surface.
///
/// # Guaranteed
/// - Values are computed in `f64` with sums, products, quotients and comparisons in a fixed order, and rounded once: the same
///   on every machine. (The threshold `t` takes a square root, which IEEE 754 rounds correctly.)
/// - [`range`](ScalarField::range) and [`slope`](ScalarField::slope) follow from the bounds of [`noise`](super::noise).
/// - Closed, and extracted in its own bounds with guarded topology, the mesh has no boundary.
/// - Without overhangs and caves, no vertical line meets the ground twice.
///
/// # Not guaranteed
/// - That the rock is in one piece: caves may cut parts loose, and so may large overhangs.
/// - That the ground stays within the bounds: what would rise above them is cut off flat by the upper wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terrain {
    settings: TerrainSettings,
    bounds: Bounds,
    /// Units of the coordinates in a width.
    width: f64,
    origin: DVec3,
    /// The upper corner of the bounds in widths from the lower one.
    size: DVec3,
    relief: Relief,
    shifts: [Fractal; 2],
    caves: [Fractal; 2],
    /// Of the caves' noise, where their walls are.
    threshold: f64,
    /// What makes a cave's value a length, in widths.
    cave_scale: f64,
}

impl Terrain {
    /// Bounds in which the characters look their best: 2 by 2 by 1, round the origin.
    pub const DEFAULT_BOUNDS: Bounds =
        Bounds { min: Vec3::new(-1.0, -1.0, -0.5), max: Vec3::new(1.0, 1.0, 0.5) };

    /// A terrain in `bounds`, which are those that it is meant to be extracted in.
    ///
    /// # Errors
    /// A setting out of its range; bounds that are empty, not finite, or longer than 1e18.
    pub fn try_new(settings: TerrainSettings, bounds: Bounds) -> Result<Self, TerrainError> {
        settings.check()?;
        let (origin, end) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let size = end - origin;
        if !(size.min_element() > 0.0 && size.max_element() <= 1e18 && origin.is_finite()) {
            return Err(TerrainError::Bounds);
        }
        let width = size.x.max(size.y);
        // Seeds far apart: an octave's is one more than that of the octave before.
        let part = |number: u32| settings.seed.wrapping_mul(0x9e37_79b9).wrapping_add(number << 8);
        let of_shift = |number| Fractal::new(NoiseShape::Plain, SHIFT_OCTAVES, 0.5, part(number));
        let of_cave = |number| Fractal::new(NoiseShape::Plain, SHIFT_OCTAVES, 0.3, part(number));
        let threshold = (settings.caves / HOLLOW).sqrt();
        Ok(Self {
            settings,
            bounds,
            width,
            origin,
            size: size / width,
            relief: Relief::new(&settings, part(0)),
            shifts: [of_shift(4), of_shift(5)],
            caves: [of_cave(6), of_cave(7)],
            threshold,
            cave_scale: settings.cave_period / CAVE_SLOPE,
        })
    }

    /// The bounds that the terrain was made for.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// What it was made with.
    pub fn settings(&self) -> &TerrainSettings {
        &self.settings
    }

    fn has_overhangs(&self) -> bool {
        self.settings.overhang > 0.0
    }

    /// In widths, at a place in widths from the lower corner of the bounds.
    fn value(&self, q: DVec3) -> f64 {
        let mut value = self.ground(q);
        if self.settings.closed {
            value = value.min(self.to_wall(q));
        }
        // In the air caves change nothing, and need not be known.
        if self.settings.caves > 0.0 && value > self.least_of_caves() {
            value = value.min(self.cave(self.caves.map(|cave| cave.value(self.cave_place(q)))));
        }
        value
    }

    /// How far the ground is above a place.
    fn ground(&self, q: DVec3) -> f64 {
        let shift = if self.has_overhangs() {
            let place = q / self.settings.overhang_period;
            self.shifts.map(|shift| shift.value(place) * self.settings.overhang)
        } else {
            [0.0; 2]
        };
        self.relief.height(q.x + shift[0], q.y + shift[1]) - q.z
    }

    /// From the nearest wall, positive between them.
    fn to_wall(&self, q: DVec3) -> f64 {
        let inner = q.min(self.size - q);
        inner.x.min(inner.y).min(inner.z) - self.settings.margin
    }

    fn cave_place(&self, q: DVec3) -> DVec3 {
        DVec3::new(q.x, q.y, q.z * CAVE_STRETCH) / self.settings.cave_period
    }

    fn cave(&self, [a, b]: [f64; 2]) -> f64 {
        (a * a + b * b - self.threshold * self.threshold) * (self.cave_scale / (2.0 * self.threshold))
    }

    /// The value in the middle of a cave.
    fn least_of_caves(&self) -> f64 {
        self.cave([0.0; 2])
    }

    /// The ranges of the parts in a box, in widths.
    fn parts(&self, low: DVec3, high: DVec3) -> Parts {
        let mut shifted = [(low.x, high.x), (low.y, high.y)];
        if self.has_overhangs() {
            let period = self.settings.overhang_period;
            for (side, shift) in shifted.iter_mut().zip(&self.shifts) {
                let (least, greatest) = shift.range(low / period, high / period);
                *side = (side.0 + least * self.settings.overhang, side.1 + greatest * self.settings.overhang);
            }
        }
        let height = self.relief.range(shifted);
        let ground = (height.0 - high.z, height.1 - low.z);
        let wall = self.settings.closed.then(|| {
            let (below, above) = (low, self.size - high);
            let nearest = below.min(above).min_element();
            // Each side's distance is least at one of the ends, and nowhere greater than at its own better end.
            let farthest = high.min(self.size - low).min_element();
            (nearest - self.settings.margin, farthest - self.settings.margin)
        });
        let highest = wall.map_or(ground.1, |wall| wall.1.min(ground.1));
        let caves = (self.settings.caves > 0.0 && highest > self.least_of_caves())
            .then(|| self.caves.map(|cave| cave.range(self.cave_place(low), self.cave_place(high))));
        Parts { ground, wall, caves }
    }

    /// A box in widths; `None` if it is not one.
    fn in_widths(&self, bounds: Bounds) -> Option<(DVec3, DVec3)> {
        let (low, high) = (self.place(bounds.min), self.place(bounds.max));
        (low.is_finite() && high.is_finite() && low.cmple(high).all()).then_some((low, high))
    }

    fn place(&self, p: Vec3) -> DVec3 {
        (p.as_dvec3() - self.origin) / self.width
    }

    fn cave_range(&self, [a, b]: [(f64, f64); 2]) -> (f64, f64) {
        let [(a, far_a), (b, far_b)] = [a, b].map(|(low, high)| (low.max(-high).max(0.0), high.max(-low)));
        (self.cave([a, b]), self.cave([far_a, far_b]))
    }

    /// Of `n1` and `n2` alone, by the chain rule: at most `c / t` times the steeper noise's slope times their greatest
    /// distance from 0, in the plane of both.
    fn cave_slope(&self, ranges: [(f64, f64); 2]) -> f64 {
        let [a, b] = ranges.map(|(low, high)| high.max(-low));
        let slopes = self.caves.map(|cave| cave.slope() * CAVE_STRETCH / self.settings.cave_period);
        (a * slopes[0] + b * slopes[1]) * (self.cave_scale / self.threshold)
    }
}

/// What is known of the terrain's parts in a box.
struct Parts {
    ground: (f64, f64),
    wall: Option<(f64, f64)>,
    /// Of both noises.
    caves: Option<[(f64, f64); 2]>,
}

/// Ranges that hold what rounding makes of a value.
fn widened((low, high): (f64, f64), size: f64) -> (f64, f64) {
    let rounding = 1e-12 * (1.0 + size);
    (low - rounding, high + rounding)
}

impl ScalarField for Terrain {
    fn sample(&self, p: Vec3) -> f32 {
        let value = self.value(self.place(p));
        // The least of a number and none is the number.
        if p.is_finite() { (value * self.width) as f32 } else { f32::NAN }
    }

    /// No value is needed.
    fn range(&self, bounds: Bounds, _value: f32) -> Option<(f32, f32)> {
        let (low, high) = self.in_widths(bounds)?;
        let parts = self.parts(low, high);
        let mut range = parts.ground;
        let others = [parts.wall, parts.caves.map(|ranges| self.cave_range(ranges))];
        for (least, greatest) in others.into_iter().flatten() {
            range = (range.0.min(least), range.1.min(greatest));
        }
        let size = low.abs().max(high.abs()).max_element();
        let (low, high) = widened(range, size);
        // Rounding keeps order, so the ends hold every rounded value.
        Some(((low * self.width) as f32, (high * self.width) as f32))
    }

    /// The steepest of the parts that can be the least somewhere in the box.
    fn slope(&self, bounds: Bounds) -> Option<f32> {
        let (low, high) = self.in_widths(bounds)?;
        let parts = self.parts(low, high);
        let caves = parts.caves.map(|ranges| (self.cave_range(ranges), self.cave_slope(ranges)));
        let shift_slope = if self.has_overhangs() {
            let [a, b] = self.shifts.map(|shift| shift.slope());
            (a * a + b * b).sqrt() * self.settings.overhang / self.settings.overhang_period
        } else {
            0.0
        };
        let ground_slope = 1.0 + self.relief.slope() * (1.0 + shift_slope);
        let known = [Some((parts.ground, ground_slope)), parts.wall.map(|wall| (wall, 1.0)), caves];
        let least_high = known.iter().flatten().map(|((_, high), _)| *high).fold(f64::INFINITY, f64::min);
        let steepest = known
            .into_iter()
            .flatten()
            .filter(|((low, _), _)| *low <= least_high + 1e-9)
            .map(|(_, slope)| slope)
            .fold(0.0, f64::max);
        Some((steepest * (1.0 + 1e-6)) as f32)
    }
}
