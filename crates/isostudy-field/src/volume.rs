//! Samples on a regular grid, interpolated.

mod bricks;
mod grid;
mod ranges;
mod stored;

use std::collections::TryReserveError;
use std::error::Error;
use std::fmt;
use std::sync::Arc;

use glam::{DMat3, DVec3, Vec3};
use isostudy_mesh::Bounds;

use self::bricks::{Bricks, Near, Reader, Samples};
pub use self::grid::VolumeGrid;
use self::ranges::{EDGES, Ranges, Scan, Scanned};
pub use self::stored::{StoredSamples, UnreadSamples};
use super::{SAFE, StudyField};

/// What a volume's value is beyond its outermost samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Beyond {
    /// That of the nearest point of the volume: a surface that reaches the volume's end goes on, and is cut off by the
    /// lattice's box.
    #[default]
    Continued,
    /// The same, less the difference between the largest and the smallest sample for each step from sample to sample:
    /// what is inside ends, and its surface closes, less than a step beyond the volume's end.
    Falling,
    /// The same, but more: for a field that is turned round ([`Negated`](crate::Negated)).
    Rising,
}

/// How much the value changes beyond the volume; positive.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fall {
    /// For each step from sample to sample, along the axis with the most of them.
    Step(f32),
    /// For each unit of length.
    Length(f64),
}

/// Why samples make no field.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum VolumeFieldError {
    /// An axis has no samples, or the counts do not make the number of samples.
    Counts {
        /// As given.
        counts: [usize; 3],
        /// How many samples there are.
        samples: usize,
    },
    /// An axis has one sample, so that there is nothing between samples and the volume is flat.
    Flat {
        /// As given.
        counts: [usize; 3],
    },
    /// The steps from sample to sample are not finite or span no space.
    Steps {
        /// As given.
        steps: [[f64; 3]; 3],
        /// As given.
        origin: [f64; 3],
    },
    /// No sample is a finite number.
    NoNumbers,
    /// Memory that is not to be had.
    OutOfMemory,
    /// Stored samples that cannot be read.
    Unread(UnreadSamples),
}

impl fmt::Display for VolumeFieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Counts { counts, samples } => write!(f, "{samples} samples, and {counts:?} along the axes"),
            Self::Flat { counts } => write!(
                f,
                "{counts:?} samples along the axes; there must be two or more along each, or the volume is flat"
            ),
            Self::Steps { steps, origin } => {
                write!(f, "the steps {steps:?} from sample to sample, from {origin:?}, span no space")
            }
            Self::NoNumbers => f.write_str("none of the samples is a finite number"),
            Self::OutOfMemory => f.write_str("no memory for the bounds of the samples"),
            Self::Unread(why) => write!(f, "{why}"),
        }
    }
}

impl Error for VolumeFieldError {}

impl From<TryReserveError> for VolumeFieldError {
    fn from(_: TryReserveError) -> Self {
        Self::OutOfMemory
    }
}

impl From<UnreadSamples> for VolumeFieldError {
    fn from(why: UnreadSamples) -> Self {
        Self::Unread(why)
    }
}

/// Samples on a regular grid with an interpolated value between them: trilinear, in single precision, continuous, and
/// at a sample the sample. Inside is what is brighter than the isovalue.
///
/// The grid may be turned, mirrored and sheared; it is sampled in the space its steps are in, so that triangles
/// always face outward there. [`Beyond`] says what is outside the volume. Between a sample that is `NaN` or infinite and
/// its neighbours the value is `NaN`, which counts as outside; at the neighbours it is theirs, on all sides alike, as far
/// as single-precision coordinates can tell that they are met.
///
/// Blocks whose samples are all on one side are never sampled: a tree keeps the range of the samples. Copies share samples and tree.
///
/// Samples need not be in memory ([`StoredSamples`]): then bricks of them are read where they are wanted, and those that were asked for last
/// are kept. The values are the same, to the bit, but where samples cannot be read: there they are not numbers, and whoever gave the
/// samples has to be asked whether it was so.
#[derive(Debug, Clone)]
pub struct VolumeField {
    grid: VolumeGrid,
    /// Shared by copies, as the ranges are.
    samples: Samples,
    beyond: Beyond,
    /// The least and the greatest sample that is finite.
    value_range: (f32, f32),
    /// How the value changes beyond the volume.
    fall: Fall,
    ranges: Arc<Ranges>,
}

impl VolumeField {
    /// A field of `counts[0] * counts[1] * counts[2]` samples, the first axis fastest. Sample `(i, j, k)` lies at
    /// `origin + i * steps[0] + j * steps[1] + k * steps[2]`.
    ///
    /// # Errors
    /// [`VolumeFieldError`].
    pub fn try_new(
        counts: [usize; 3],
        values: Vec<f32>,
        origin: [f64; 3],
        steps: [[f64; 3]; 3],
        beyond: Beyond,
    ) -> Result<Self, VolumeFieldError> {
        let product = counts.iter().try_fold(1usize, |product, &n| product.checked_mul(n));
        if product != Some(values.len()) || values.is_empty() {
            return Err(VolumeFieldError::Counts { counts, samples: values.len() });
        }
        let grid = VolumeGrid::try_new(counts, origin, steps)?;
        let mut scan = Scan::new(counts, EDGES[0])?;
        values.chunks_exact(counts[0] * counts[1]).for_each(|layer| scan.add(layer));
        let (ranges, value_range) = Scanned::ranges(counts, EDGES[0], [scan.finish()])?;
        Self::of(grid, Samples::Whole(Arc::new(values)), beyond, value_range, ranges)
    }

    /// A field of samples that are not in memory. They are read once, layer by layer on so many `threads`, for the range of each block. From
    /// then on bricks of them are read where they are wanted.
    ///
    /// Bricks that are kept take half of `memory_bytes`, or what one of 17 samples a side takes. Ranges take the other half at most; where
    /// they would take more, they are those of larger blocks, and more samples are taken between. [`VolumeGrid::stored_bytes`] says it all.
    ///
    /// # Errors
    /// [`VolumeFieldError`].
    pub fn try_stored(
        samples: Arc<dyn StoredSamples>,
        origin: [f64; 3],
        steps: [[f64; 3]; 3],
        beyond: Beyond,
        memory_bytes: u64,
        threads: usize,
    ) -> Result<Self, VolumeFieldError> {
        let counts = samples.counts();
        let grid = VolumeGrid::try_new(counts, origin, steps)?;
        let edge = Ranges::edge_within(counts, memory_bytes / 2);
        let layers = Ranges::layers(counts, edge);
        let threads = threads.clamp(1, layers);
        let scan = |part: usize| {
            let [first, end] = [part, part + 1].map(|part| part * layers / threads * edge);
            scan_layers(&*samples, edge, first, (end + 1).min(counts[2]))
        };
        let parts = std::thread::scope(|scope| {
            let others: Vec<_> = (1..threads).map(|part| scope.spawn(move || scan(part))).collect();
            let first = std::iter::once(scan(0));
            let join = |thread: std::thread::ScopedJoinHandle<'_, _>| {
                thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
            };
            first.chain(others.into_iter().map(join)).collect::<Result<Vec<_>, VolumeFieldError>>()
        })?;
        let (ranges, value_range) = Scanned::ranges(counts, edge, parts)?;
        let bricks = Bricks::new(samples, memory_bytes / 2)?;
        Self::of(grid, Samples::Stored(Arc::new(bricks)), beyond, value_range, ranges)
    }

    fn of(
        grid: VolumeGrid,
        samples: Samples,
        beyond: Beyond,
        value_range: (f32, f32),
        ranges: Ranges,
    ) -> Result<Self, VolumeFieldError> {
        let (low, high) = value_range;
        if low > high {
            return Err(VolumeFieldError::NoNumbers);
        }
        let fall = Fall::Step(if high > low { (high - low).min(f32::MAX) } else { 1.0 });
        Ok(Self { grid, samples, beyond, value_range, fall, ranges: Arc::new(ranges) })
    }

    /// The same with something else beyond the outermost samples.
    pub fn with_beyond(self, beyond: Beyond) -> Self {
        Self { beyond, ..self }
    }

    /// The same with a surface that closes round everything beyond `isovalue`, however long the steps are and however the
    /// grid is turned: beyond the outermost samples the value falls, or rises if that was asked for, with the distance
    /// from the volume, and no point that is one shortest step ([`spacing`](Self::spacing)) or more away from it is
    /// inside. [`closing_bounds`](Self::closing_bounds) is a box with room for that.
    pub fn closing_at(self, isovalue: f32) -> Self {
        let (low, high) = (f64::from(self.value_range.0), f64::from(self.value_range.1));
        let (beyond, depth) = match self.beyond {
            Beyond::Continued | Beyond::Falling => (Beyond::Falling, high - f64::from(isovalue)),
            Beyond::Rising => (Beyond::Rising, f64::from(isovalue) - low),
        };
        let change = depth.max(high - low);
        // Nothing is inside, or all samples are equal.
        let change = if change > 0.0 { change } else { 1.0 };
        Self { beyond, fall: Fall::Length(change / self.grid.shortest_step()), ..self }
    }

    /// Where its samples lie.
    pub fn grid(&self) -> &VolumeGrid {
        &self.grid
    }

    /// [`VolumeGrid::closing_bounds`].
    pub fn closing_bounds(&self) -> Bounds {
        self.grid.closing_bounds()
    }

    /// [`VolumeGrid::bounds`].
    pub fn bounds(&self) -> Bounds {
        self.grid.bounds()
    }

    /// [`VolumeGrid::spacing`].
    pub fn spacing(&self) -> f32 {
        self.grid.spacing()
    }

    /// [`VolumeGrid::is_axis_aligned`].
    pub fn is_axis_aligned(&self) -> bool {
        self.grid.is_axis_aligned()
    }

    /// The smallest and the largest sample; those that are not finite aside.
    pub fn value_range(&self) -> (f32, f32) {
        self.value_range
    }

    /// The value at `p`, with the one at the nearest point of the volume, given in steps.
    #[inline]
    fn value(&self, p: Vec3, interpolated: impl FnOnce(DVec3) -> f32) -> f32 {
        let index = self.grid.to_index * (p.as_dvec3() - self.grid.origin);
        if !index.is_finite() {
            return f32::NAN;
        }
        let last = DVec3::from_array(self.grid.counts.map(|n| (n - 1) as f64));
        let nearest = index.clamp(DVec3::ZERO, last);
        let value = interpolated(nearest);
        let way = index - nearest;
        let away = match self.fall {
            Fall::Step(fall) => fall * way.abs().max_element() as f32,
            // Only a number too large for `f32` is infinite, which is as good as far beyond the isovalue.
            Fall::Length(fall) => (fall * (self.grid.steps * way).length()) as f32,
        };
        match self.beyond {
            Beyond::Continued => value,
            Beyond::Falling => value - away,
            Beyond::Rising => value + away,
        }
    }

    #[inline]
    fn interpolated(&self, reader: &mut Reader, index: DVec3) -> f32 {
        let (mut corner, mut part) = ([0; 3], [0.0f32; 3]);
        for k in 0..3 {
            let mut first = index[k] as usize;
            part[k] = (index[k] - first as f64) as f32;
            // At a sample the sample: `a + (b - a)` is not `b` where one of them is far larger.
            if part[k] == 1.0 {
                (first, part[k]) = (first + 1, 0.0);
            }
            corner[k] = first;
        }
        let Near { values, at, strides } = reader.near(corner);
        let step = |k: usize| if corner[k] + 1 < self.grid.counts[k] { strides[k] } else { 0 };
        let [along, up, back] = [step(0), step(1), step(2)];
        let between = |a: f32, b: f32, part: f32| a + (b - a) * part;
        let along_x = |at: usize| between(values[at], values[at + along], part[0]);
        let along_y = |at: usize| between(along_x(at), along_x(at + up), part[1]);
        between(along_y(at), along_y(at + back), part[2])
    }

    /// The value at `p`, which is next to a sample that is not finite, or to very different ones. On a plane, an edge or a
    /// corner of a cell only the samples there count.
    #[cold]
    fn value_with_care(&self, reader: &mut Reader, p: Vec3) -> f32 {
        // A few units in the last place of the coordinates, in steps.
        let coordinates = 2.5e-7 * (p.as_dvec3().abs() + self.grid.origin.abs());
        let slack: [f64; 3] = std::array::from_fn(|k| self.grid.to_index.row(k).abs().dot(coordinates));
        self.value(p, |index| {
            let first = index.to_array().map(|index| index as usize);
            // The cell that a point on its upper side is of, at the volume's end.
            let cell = [0, 1, 2].map(|k| first[k].min(self.grid.counts[k] - 2));
            let Near { values, at, strides } = reader.near(cell);
            // Samples, and the weight of each.
            let (mut corners, mut count) = ([(at, 1.0); 8], 1);
            for k in 0..3 {
                let met = index[k].round();
                let step = |sample: usize| (sample - cell[k]) * strides[k];
                if (index[k] - met).abs() <= slack[k] {
                    corners[..count].iter_mut().for_each(|corner| corner.0 += step(met as usize));
                    continue;
                }
                let part = index[k].fract();
                for i in 0..count {
                    let (at, weight) = corners[i];
                    corners[i] = (at + step(first[k]), weight * (1.0 - part));
                    corners[count + i] = (at + step(first[k] + 1), weight * part);
                }
                count *= 2;
            }
            let value: f64 =
                corners[..count].iter().map(|&(at, weight)| f64::from(values[at]) * weight).sum();
            if value.is_finite() { value as f32 } else { f32::NAN }
        })
    }

    #[inline]
    fn sample_by(&self, reader: &mut Reader, p: Vec3) -> f32 {
        let value = self.value(p, |index| self.interpolated(reader, index));
        if value.is_finite() { value } else { self.value_with_care(reader, p) }
    }
}

/// Reads the layers of samples from `first` to before `end`, and finds the ranges of the bricks between.
fn scan_layers(
    samples: &dyn StoredSamples,
    edge: usize,
    first: usize,
    end: usize,
) -> Result<Scanned, VolumeFieldError> {
    let [nx, ny, _] = samples.counts();
    let mut scan = Scan::new([nx, ny, end - first], edge)?;
    let mut layer = Vec::new();
    layer.try_reserve_exact(nx * ny)?;
    layer.resize(nx * ny, 0.0);
    for z in first..end {
        samples.read_box([0, 0, z], [nx, ny, 1], &mut layer)?;
        scan.add(&layer);
    }
    Ok(scan.finish())
}

impl StudyField for VolumeField {
    fn sample(&self, p: Vec3) -> f32 {
        self.sample_by(&mut self.samples.reader(self.grid.counts), p)
    }

    /// With one look for a brick that several points are in.
    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        let mut reader = self.samples.reader(self.grid.counts);
        for (value, &x) in values.iter_mut().zip(x) {
            *value = self.sample_by(&mut reader, Vec3::new(x, y, z));
        }
    }

    /// That of the samples round the box.
    fn range(&self, bounds: Bounds, _value: f32) -> Option<(f32, f32)> {
        let (min, max) = (bounds.min.as_dvec3() - self.grid.origin, bounds.max.as_dvec3() - self.grid.origin);
        let centre = self.grid.to_index * ((min + max) * 0.5);
        let size = (max - min) * 0.5;
        let turned = DMat3::from_cols(
            self.grid.to_index.x_axis.abs(),
            self.grid.to_index.y_axis.abs(),
            self.grid.to_index.z_axis.abs(),
        );
        let half = turned * size + DVec3::splat(1e-9) + centre.abs() * 1e-12;
        if !centre.is_finite() || !half.is_finite() {
            return None;
        }
        let last = DVec3::from_array(self.grid.counts.map(|n| (n - 1) as f64));
        let (low, high) =
            ((centre - half).clamp(DVec3::ZERO, last), (centre + half).clamp(DVec3::ZERO, last));
        let first = low.to_array().map(|v| v as usize);
        let end = high.to_array().map(|v| v.ceil() as usize);
        let (mut least, mut most) = self.ranges.of(first, end)?;
        // Equal samples interpolate to themselves; others with rounding.
        if least < most {
            let rounding = least.abs().max(most.abs()) * (SAFE - 1.0);
            (least, most) = (least - rounding, most + rounding);
        }
        let outside = (low - (centre - half)).max(centre + half - high);
        let away = SAFE
            * match self.fall {
                Fall::Step(fall) => fall * outside.max_element() as f32,
                Fall::Length(fall) => {
                    let lengths = [self.grid.steps.x_axis, self.grid.steps.y_axis, self.grid.steps.z_axis]
                        .map(DVec3::length);
                    (fall * outside.dot(DVec3::from_array(lengths))) as f32
                }
            };
        match self.beyond {
            Beyond::Continued => {}
            Beyond::Falling => least -= away,
            Beyond::Rising => most += away,
        }
        Some((least, most))
    }
}
