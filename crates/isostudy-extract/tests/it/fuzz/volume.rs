//! A random volume: few samples, many of them at the isovalue, some of them no numbers, on axes that may be turned.

use isostudy_extract::BoxGrid;
use isostudy_field::{Beyond, StudyField, VolumeField, Walled};

use crate::fields::Numbers;

/// Samples, the isovalue, and how the volume is cut into chunks.
#[derive(Debug, Clone)]
pub(crate) struct Volume {
    /// Samples along each axis, two at least.
    pub(crate) counts: [usize; 3],
    /// All of them, x fastest.
    pub(crate) values: Vec<f32>,
    pub(crate) origin: [f64; 3],
    /// From one sample to the next along each axis.
    pub(crate) steps: [[f64; 3]; 3],
    pub(crate) isovalue: f32,
    /// How many cells more than half of the box's the first chunks have.
    pub(crate) chunk: u32,
    /// Of the eight chunks round the middle those that are of the finer level, one bit an octant.
    pub(crate) fine: u32,
    /// Threads that must not show. With one nothing is asked, as most times: threads take longer to start than all else.
    pub(crate) threads: usize,
}

/// One unit along each axis.
pub(super) const STRAIGHT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Most samples along an axis.
const MOST: u64 = 9;

/// Samples that are few, so that many are equal.
const PLAIN: [f32; 12] = [-1.0, 1.0, 0.0, 0.5, -0.5, 2.0, -0.25, 0.1, 3.0, 127.0, 128.0, -0.0];
/// Samples that nobody wants.
const ODD: [f32; 12] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    1e30,
    -1e30,
    1e-45,
    -1e-45,
    f32::MIN_POSITIVE,
    1e-40,
    16_777_216.0,
];

impl Volume {
    /// Of a seed.
    pub(crate) fn random(seed: u64) -> Self {
        let mut numbers = Numbers::new(seed);
        // Two draws of three are small: most of what goes wrong does so in a few cells.
        let mut counts = [(); 3].map(|()| 2 + numbers.below(MOST - 1).min(numbers.below(MOST - 1)) as usize);
        if numbers.below(4) == 0 {
            counts[numbers.below(3) as usize] = 2;
        }
        let palette = palette(&mut numbers);
        let isovalue = isovalue(&palette, &mut numbers);
        let values = values(counts, &palette, &mut numbers);
        let (origin, steps) = frame(&mut numbers);
        let chunk = numbers.below(4) as u32;
        let fine = numbers.below(256) as u32;
        let threads = if numbers.below(4) == 0 { 3 } else { 1 };
        let mut volume = Self { counts, values, origin, steps, isovalue, chunk, fine, threads };
        if numbers.below(2) == 0 {
            volume.end_outside(&palette);
        }
        volume
    }

    /// Makes all outermost samples outside, by a sample that is drawn anyway where one will do.
    fn end_outside(&mut self, palette: &[f32]) {
        let isovalue = self.isovalue;
        let outside = palette.iter().copied().find(|&v| is_outside(v, isovalue)).unwrap_or(f32::NAN);
        let counts = self.counts;
        for (value, place) in self.values.iter_mut().zip(places(counts)) {
            if !is_inner(place, counts) {
                *value = outside;
            }
        }
    }

    /// Whether no outermost sample is inside: then the surface stays clear of the box.
    pub(super) fn ends_outside(&self) -> bool {
        let mut outermost =
            self.values.iter().zip(places(self.counts)).filter(|(_, place)| !is_inner(*place, self.counts));
        outermost.all(|(&value, _)| is_outside(value, self.isovalue))
    }

    /// The same between samples too, where their interpolation is rounded.
    fn stays_outside(&self) -> bool {
        let largest =
            self.values.iter().filter(|v| v.is_finite()).fold(0.0, |most: f32, v| most.max(v.abs()));
        let rounding = if self.steps == STRAIGHT { 0.0 } else { 1e-6 * largest };
        Self { isovalue: self.isovalue - rounding, ..self.clone() }.ends_outside()
    }

    /// The same without one plane of samples across an axis; `None` if too few would be left.
    pub(super) fn without(&self, axis: usize, plane: usize) -> Option<Self> {
        if self.counts[axis] <= 2 || plane >= self.counts[axis] {
            return None;
        }
        let kept = self.values.iter().zip(places(self.counts)).filter(|(_, place)| place[axis] != plane);
        let mut counts = self.counts;
        counts[axis] -= 1;
        Some(Self { values: kept.map(|(&value, _)| value).collect(), counts, ..self.clone() })
    }

    /// The interpolated samples as `isostudy extract --volume` takes them: where axes are turned the surface is closed at the
    /// volume's sides, which no box can cut off. `None` if no sample is a finite number.
    pub(super) fn field(&self) -> Option<Sampled> {
        let volume = self.interpolated()?;
        let spacing = volume.spacing();
        if volume.is_axis_aligned() {
            let grid = BoxGrid { bounds: volume.bounds(), spacing };
            return Some(Sampled { field: Box::new(volume), grid, closed: self.stays_outside() });
        }
        let volume = volume.with_beyond(Beyond::Falling).closing_at(self.isovalue);
        let grid = BoxGrid { bounds: volume.closing_bounds(), spacing };
        let field = Box::new(Walled::new(volume, grid.bounds, self.isovalue));
        Some(Sampled { field, grid, closed: true })
    }

    /// The same, as it is.
    pub(super) fn interpolated(&self) -> Option<VolumeField> {
        let Self { counts, ref values, origin, steps, .. } = *self;
        VolumeField::try_new(counts, values.clone(), origin, steps, Beyond::Continued).ok()
    }
}

/// A field, and where it is looked at.
pub(super) struct Sampled {
    pub(super) field: Box<dyn StudyField>,
    pub(super) grid: BoxGrid,
    /// Whether the surface stays clear of the box.
    pub(super) closed: bool,
}

/// A value equal to the isovalue is outside, and so is one that is no number.
fn is_outside(value: f32, isovalue: f32) -> bool {
    value.is_nan() || value <= isovalue
}

/// All places, x fastest.
fn places(counts: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = counts;
    (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
}

fn is_inner(place: [usize; 3], counts: [usize; 3]) -> bool {
    (0..3).all(|axis| place[axis] > 0 && place[axis] + 1 < counts[axis])
}

fn pick<T: Copy>(from: &[T], numbers: &mut Numbers) -> T {
    from[numbers.below(from.len() as u64) as usize]
}

/// Two to six samples, of which some may be odd; both sides of something most times.
fn palette(numbers: &mut Numbers) -> Vec<f32> {
    let mut palette: Vec<f32> = (0..2 + numbers.below(5)).map(|_| pick(&PLAIN, numbers)).collect();
    if numbers.below(3) == 0 {
        palette.extend((0..1 + numbers.below(2)).map(|_| pick(&ODD, numbers)));
    }
    palette
}

/// A sample, most times; else what lies between two, or nought.
fn isovalue(palette: &[f32], numbers: &mut Numbers) -> f32 {
    let finite: Vec<f32> = palette.iter().copied().filter(|v| v.is_finite()).collect();
    let (one, other) = (pick(&finite, numbers), pick(&finite, numbers));
    match numbers.below(6) {
        0 => 0.0,
        1 | 2 => 0.5 * one + 0.5 * other,
        _ => one,
    }
}

/// Noise of the palette, few samples of it in another, a ball of it, or a ball with noise of all numbers.
fn values(counts: [usize; 3], palette: &[f32], numbers: &mut Numbers) -> Vec<f32> {
    let kind = numbers.below(5);
    let rest = pick(palette, numbers);
    let centre = counts.map(|n| numbers.below(2 * n as u64 - 1) as f32 / 2.0);
    let radius = 0.5 + numbers.below(16) as f32 / 4.0;
    let mut value = |place: [usize; 3]| {
        let distance = (0..3).map(|axis| (place[axis] as f32 - centre[axis]).powi(2)).sum::<f32>().sqrt();
        let noise = numbers.below(1 << 24) as f32 / (1 << 23) as f32 - 1.0;
        match kind {
            0 | 1 => pick(palette, numbers),
            2 if numbers.below(6) == 0 => pick(palette, numbers),
            2 => rest,
            3 if numbers.below(12) == 0 => pick(palette, numbers),
            3 => (radius - distance).round(),
            _ if numbers.below(8) == 0 => pick(palette, numbers),
            _ => radius - distance + noise,
        }
    };
    places(counts).map(&mut value).collect()
}

/// Where the samples lie: straight, with other steps, exchanged and mirrored, turned or sheared.
fn frame(numbers: &mut Numbers) -> ([f64; 3], [[f64; 3]; 3]) {
    let kind = numbers.below(6);
    if kind < 2 {
        return ([0.0; 3], STRAIGHT);
    }
    let mut step = || pick(&[0.5, 0.75, 1.0, 1.25, 2.0], numbers);
    let [a, b, c] = [step(), step(), step()];
    let origin = [(); 3].map(|()| numbers.below(9) as f64 * 0.75 - 3.0);
    let steps = match kind {
        2 => [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]],
        3 => [[0.0, -a, 0.0], [b, 0.0, 0.0], [0.0, 0.0, -c]],
        // The columns of a rotation by 3-4-5 and of one by 5-12-13 about another axis, and its mirror image.
        4 => {
            let side = if numbers.below(2) == 0 { c } else { -c };
            [
                [0.6 * a, 0.8 * a, 0.0],
                [-0.8 * b * 5.0 / 13.0, 0.6 * b * 5.0 / 13.0, b * 12.0 / 13.0],
                [0.8 * side * 12.0 / 13.0, -0.6 * side * 12.0 / 13.0, side * 5.0 / 13.0],
            ]
        }
        _ => [[a, 0.0, 0.0], [0.25 * b, b, 0.0], [-0.5 * c, 0.25 * c, c]],
    };
    (origin, steps)
}
