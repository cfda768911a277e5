//! Ground with hills, cliffs and caves.

mod relief;
mod settings;

use glam::{DVec3, Vec3};
use isostudy_mesh::Bounds;

use crate::StudyField;
use crate::fractal::{FEW, Fractal, NoiseShape, ROW};
use relief::Relief;
pub use settings::{TerrainCharacter, TerrainError, TerrainSettings};

/// How many octaves of noise overhangs and caves have.
const SHIFT_OCTAVES: u32 = 2;
/// Overhangs change faster with the height than along the ground, so that cliffs lean over and the ground is not torn.
const SHIFT_STRETCH: f64 = 2.0;
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
/// - overhangs: the horizontal place is shifted by two 3D noises of `q / overhang_period`, times `overhang`; they change twice
///   as fast along z;
/// - caves: the least of that and `c (n1^2 + n2^2 - t^2) / 2t`, with two 3D noises of `q / cave_period`, 1.4 times as
///   fast along z: tunnels along the curves on which both are 0. `t` is chosen by `caves`, and `c` so that the value is about a distance;
/// - walls: the least of that and the distance to the nearest wall, where the terrain is closed.
///
/// The value is all this in the unit of the coordinates. It is about the vertical distance to the ground, or the horizontal
/// distance to a wall, not the distance to the nearest surface.
///
/// # Guaranteed
/// - Values are computed in `f64` with sums, products, quotients and comparisons in a fixed order, and rounded once: the same
///   on every machine. (The threshold `t` takes a square root, which IEEE 754 rounds correctly.)
/// - [`range`](StudyField::range) and [`slope`](StudyField::slope) follow from the bounds of [`noise`](crate::noise()).
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
    steepest: f32,
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
        let mut terrain = Self {
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
            steepest: 0.0,
        };
        terrain.steepest = terrain.greatest_slope();
        Ok(terrain)
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
            value = value.min(self.wall(q));
        }
        // In the air caves change nothing, and need not be known.
        if self.settings.caves > 0.0 && value > self.least_of_caves() {
            value = value.min(self.cave(self.caves.map(|cave| cave.value(self.cave_place(q)))));
        }
        value
    }

    /// The values at no more than [`ROW`] places, each [`value`](Self::value) to the bit.
    fn values(&self, places: &[DVec3], values: &mut [f64]) {
        let count = places.len();
        let mut x = [0.0; ROW];
        let mut y = [0.0; ROW];
        for ((x, y), q) in x.iter_mut().zip(&mut y).zip(places) {
            (*x, *y) = (q.x, q.y);
        }
        if self.has_overhangs() {
            let shifted = Columns::of(places.iter().map(|q| self.shift_place(*q)));
            for (along, shift) in [&mut x, &mut y].into_iter().zip(&self.shifts) {
                shift.values(shifted.columns(), &mut values[..count]);
                for (along, shift) in along.iter_mut().zip(&*values) {
                    *along += shift * self.settings.overhang;
                }
            }
        }
        self.relief.heights(&x[..count], &y[..count], values);
        for (value, q) in values.iter_mut().zip(places) {
            *value -= q.z;
            if self.settings.closed {
                *value = value.min(self.wall(*q));
            }
        }
        if self.settings.caves > 0.0 {
            self.dig(places, values);
        }
    }

    /// Takes the caves out of the values at so many places. In the air they change nothing, and need not be known.
    fn dig(&self, places: &[DVec3], values: &mut [f64]) {
        let least = self.least_of_caves();
        let (mut rock, mut in_rock) = ([0; ROW], 0);
        for (i, value) in values.iter().enumerate() {
            if *value > least {
                rock[in_rock] = i;
                in_rock += 1;
            }
        }
        let rock = &rock[..in_rock];
        let dug = Columns::of(rock.iter().map(|&i| self.cave_place(places[i])));
        let mut found = [[0.0; ROW]; 2];
        for (found, cave) in found.iter_mut().zip(&self.caves) {
            cave.values(dug.columns(), &mut found[..in_rock]);
        }
        for (k, &i) in rock.iter().enumerate() {
            values[i] = values[i].min(self.cave([found[0][k], found[1][k]]));
        }
    }

    /// How far the ground is above a place.
    fn ground(&self, q: DVec3) -> f64 {
        let shift = if self.has_overhangs() {
            let place = self.shift_place(q);
            self.shifts.map(|shift| shift.value(place) * self.settings.overhang)
        } else {
            [0.0; 2]
        };
        self.relief.height(q.x + shift[0], q.y + shift[1]) - q.z
    }

    /// The same with its gradient.
    fn ground_and_gradient(&self, q: DVec3) -> (f64, DVec3) {
        let mut shifts = [(0.0, DVec3::ZERO); 2];
        if self.has_overhangs() {
            let (place, stretch) = (self.shift_place(q), DVec3::new(1.0, 1.0, SHIFT_STRETCH));
            shifts = self.shifts.map(|shift| {
                let (value, gradient) = shift.value_and_gradient(place);
                let of_place = gradient * stretch / self.settings.overhang_period;
                (value * self.settings.overhang, of_place * self.settings.overhang)
            });
        }
        let [(x, along_x), (y, along_y)] = shifts;
        let (height, slopes) = self.relief.height_and_slopes(q.x + x, q.y + y);
        let gradient = (DVec3::X + along_x) * slopes[0] + (DVec3::Y + along_y) * slopes[1] - DVec3::Z;
        (height - q.z, gradient)
    }

    /// From the nearest wall, positive between them.
    fn wall(&self, q: DVec3) -> f64 {
        let inner = q.min(self.size - q);
        inner.x.min(inner.y).min(inner.z) - self.settings.margin
    }

    /// Away from the nearest wall.
    fn wall_gradient(&self, q: DVec3) -> DVec3 {
        let inner = q.min(self.size - q);
        let axis = (0..3).fold(0, |least, axis| if inner[axis] < inner[least] { axis } else { least });
        DVec3::AXES[axis] * if q[axis] <= self.size[axis] - q[axis] { 1.0 } else { -1.0 }
    }

    /// The gradient of the value, which is without a unit: that of the part which is least.
    fn value_gradient(&self, q: DVec3) -> DVec3 {
        let (mut value, mut gradient) = self.ground_and_gradient(q);
        if self.settings.closed && self.wall(q) < value {
            (value, gradient) = (self.wall(q), self.wall_gradient(q));
        }
        if self.settings.caves > 0.0 && value > self.least_of_caves() {
            let [a, b] = self.caves.map(|cave| cave.value_and_gradient(self.cave_place(q)));
            if self.cave([a.0, b.0]) < value {
                let stretch = DVec3::new(1.0, 1.0, CAVE_STRETCH) / self.settings.cave_period;
                gradient = (a.1 * a.0 + b.1 * b.0) * stretch * (self.cave_scale / self.threshold);
            }
        }
        gradient
    }

    fn shift_place(&self, q: DVec3) -> DVec3 {
        DVec3::new(q.x, q.y, q.z * SHIFT_STRETCH) / self.settings.overhang_period
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

    /// A range that holds every value in a box, in widths. Where less than all of the noise tells the value's sign, no more is asked,
    /// and the range is wider than need be.
    fn range_in_widths(&self, low: DVec3, high: DVec3) -> (f64, f64) {
        let walls = self.range_of_walls(low, high);
        let heights = self.relief.bounds();
        let mut ground = (heights.0 - high.z, heights.1 - low.z);
        if ground.0 <= 0.0 && ground.1.min(walls.1) > 0.0 {
            ground = self.range_of_ground(low, high);
        }
        let mut range = (ground.0.min(walls.0), ground.1.min(walls.1));
        if self.settings.caves > 0.0 {
            // A cave makes no air solid.
            let caves =
                if range.1 > 0.0 { self.range_of_caves(low, high) } else { (self.least_of_caves(), 0.0) };
            range = (range.0.min(caves.0), range.1.min(caves.1));
        }
        let rounding = 1e-12 * (1.0 + low.abs().max(high.abs()).max_element());
        (range.0 - rounding, range.1 + rounding)
    }

    /// A wall's distance is nowhere less than at one end of the box, and nowhere greater than at its own better end.
    fn range_of_walls(&self, low: DVec3, high: DVec3) -> (f64, f64) {
        if !self.settings.closed {
            return (f64::INFINITY, f64::INFINITY);
        }
        let nearest = low.min(self.size - high).min_element();
        let farthest = high.min(self.size - low).min_element();
        (nearest - self.settings.margin, farthest - self.settings.margin)
    }

    fn range_of_ground(&self, low: DVec3, high: DVec3) -> (f64, f64) {
        let mut shifted = [(low.x, high.x), (low.y, high.y)];
        if self.has_overhangs() {
            for (side, shift) in shifted.iter_mut().zip(&self.shifts) {
                let (least, greatest) = shift.range(self.shift_place(low), self.shift_place(high));
                *side = (side.0 + least * self.settings.overhang, side.1 + greatest * self.settings.overhang);
            }
        }
        let (least, greatest) = self.relief.range(shifted);
        (least - high.z, greatest - low.z)
    }

    fn range_of_caves(&self, low: DVec3, high: DVec3) -> (f64, f64) {
        let [a, b] = self.caves.map(|cave| {
            let (low, high) = cave.range(self.cave_place(low), self.cave_place(high));
            // Of the magnitude.
            (low.max(-high).max(0.0), high.max(-low))
        });
        (self.cave([a.0, b.0]), self.cave([a.1, b.1]))
    }

    /// The steepest of the parts, by the chain rule: a wall has 1, the ground 1 along z and the relief's on the shifted
    /// place, and a cave `c / t (|n1| s1 + |n2| s2)` with slopes `s` of its noise.
    fn greatest_slope(&self) -> f32 {
        let settings = &self.settings;
        let of_shift = {
            let [a, b] = self.shifts.map(|shift| shift.slope());
            (a * a + b * b).sqrt() * SHIFT_STRETCH * settings.overhang / settings.overhang_period
        };
        let ground = 1.0 + self.relief.slope() * (1.0 + of_shift);
        let [a, b] = self.caves.map(|cave| cave.slope() * CAVE_STRETCH / settings.cave_period);
        let caves = if settings.caves > 0.0 { (a + b) * self.cave_scale / self.threshold } else { 0.0 };
        (ground.max(caves) * (1.0 + 1e-6)) as f32
    }

    /// A box in widths; `None` if it is not one.
    fn in_widths(&self, bounds: Bounds) -> Option<(DVec3, DVec3)> {
        let (low, high) = (self.place(bounds.min), self.place(bounds.max));
        (low.is_finite() && high.is_finite() && low.cmple(high).all()).then_some((low, high))
    }

    fn place(&self, p: Vec3) -> DVec3 {
        (p.as_dvec3() - self.origin) / self.width
    }

    /// The values at points by number.
    fn sample_many(&self, point: impl Fn(usize) -> Vec3, values: &mut [f32]) {
        if values.len() < FEW {
            for (i, value) in values.iter_mut().enumerate() {
                *value = self.sample(point(i));
            }
            return;
        }
        let (mut places, mut found) = ([DVec3::ZERO; ROW], [0.0; ROW]);
        for (part, values) in values.chunks_mut(ROW).enumerate() {
            let point = |i: usize| point(part * ROW + i);
            for (i, place) in places[..values.len()].iter_mut().enumerate() {
                *place = self.place(point(i));
            }
            self.values(&places[..values.len()], &mut found[..values.len()]);
            for (i, value) in values.iter_mut().enumerate() {
                *value = self.rounded(point(i), found[i]);
            }
        }
    }

    /// In the unit of the coordinates, from a value in widths.
    fn rounded(&self, p: Vec3, value: f64) -> f32 {
        // The least of a number and none is the number.
        if p.is_finite() { (value * self.width) as f32 } else { f32::NAN }
    }
}

/// Up to [`ROW`] places, axis by axis.
struct Columns {
    along: [[f64; ROW]; 3],
    count: usize,
}

impl Columns {
    fn of(places: impl Iterator<Item = DVec3>) -> Self {
        let mut of = Self { along: [[0.0; ROW]; 3], count: 0 };
        for p in places {
            for (along, v) in of.along.iter_mut().zip(p.to_array()) {
                along[of.count] = v;
            }
            of.count += 1;
        }
        of
    }

    fn columns(&self) -> [&[f64]; 3] {
        self.along.each_ref().map(|along| &along[..self.count])
    }
}

impl StudyField for Terrain {
    fn sample(&self, p: Vec3) -> f32 {
        self.rounded(p, self.value(self.place(p)))
    }

    /// Noise is looked up cell by cell, of which a row has several points.
    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        self.sample_many(|i| Vec3::new(x[i], y, z), values);
    }

    fn sample_near(&self, points: &[Vec3], values: &mut [f32], _before: Option<(Vec3, f32)>) {
        self.sample_many(|i| points[i], values);
    }

    fn values_at_once(&self) -> usize {
        16
    }

    /// No value is needed.
    fn range(&self, bounds: Bounds, _value: f32) -> Option<(f32, f32)> {
        let (low, high) = self.in_widths(bounds)?;
        let (low, high) = self.range_in_widths(low, high);
        // Rounding keeps order, so the ends hold every rounded value.
        Some(((low * self.width) as f32, (high * self.width) as f32))
    }

    /// That of the ground, the walls or the caves, whichever is least there, by the chain rule.
    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        Some(self.value_gradient(self.place(p)).as_vec3()).filter(|gradient| gradient.is_finite())
    }

    /// The same everywhere. A bound of the box's own was tried: it saved 1 sample in 100 and cost as much as a range.
    fn slope(&self, bounds: Bounds) -> Option<f32> {
        self.in_widths(bounds).map(|_| self.steepest)
    }
}
