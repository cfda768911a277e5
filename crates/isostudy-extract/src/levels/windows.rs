//! Samples of several levels, in boxes of cells, in place of a field.
//!
//! Seams look at values at corners of the finer of two grids, and between them where a vertex lies in a cell. At a corner they get the
//! sample itself, whatever the size of its coordinates; between corners they get the trilinear interpolant.

use glam::Vec3;
use isostudy_field::StudyField;

use super::error::{COARSEST, LevelError};
use super::layer::point;
use super::neighbours::{DIRECTIONS, Neighbours};
use crate::lattice::CellBox;
use crate::lattice::endless::Grid;
use crate::memory::refill;

/// The samples of a box of cells of a level: those at corners, x fastest, then y, one more along each axis than there are cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelWindow<'a> {
    /// The level whose cells they are.
    pub level: u32,
    /// The box.
    pub cells: CellBox,
    /// One for each corner.
    pub samples: &'a [f32],
}

impl LevelWindow<'_> {
    /// The same as seen from a corner of a level.
    pub(super) fn seen_from(self, level: u32, corner: [i32; 3]) -> Self {
        let there = corner.map(|i| match level.checked_sub(self.level) {
            Some(finer) => i64::from(i) << finer,
            None => i64::from(i) >> (self.level - level),
        });
        let seen = |from: [i32; 3]| {
            let limits = (i64::from(i32::MIN), i64::from(i32::MAX));
            [0, 1, 2].map(|axis| (i64::from(from[axis]) - there[axis]).clamp(limits.0, limits.1) as i32)
        };
        Self { cells: CellBox { start: seen(self.cells.start), end: seen(self.cells.end) }, ..self }
    }

    fn counts(&self) -> [usize; 3] {
        self.cells.size().map(|n| n as usize + 1)
    }

    fn at(&self, corner: [i32; 3]) -> Option<f32> {
        let is_there =
            (0..3).all(|axis| self.cells.start[axis] <= corner[axis] && corner[axis] <= self.cells.end[axis]);
        let [nx, ny, _] = self.counts();
        let [x, y, z] = [0, 1, 2].map(|axis| corner[axis].wrapping_sub(self.cells.start[axis]) as usize);
        is_there.then(|| self.samples[(z * ny + y) * nx + x])
    }
}

/// All windows that are given for a chunk.
#[derive(Clone, Copy)]
pub(super) struct Windows<'a>(pub(super) &'a [LevelWindow<'a>]);

impl<'a> Windows<'a> {
    /// Looks whether the windows have as many samples as corners, and one value where corners of two levels are in one place.
    ///
    /// # Errors
    /// [`LevelError::Level`], [`LevelError::Chunk`] for a wrong number of samples, [`LevelError::Disagree`].
    pub(super) fn check(self) -> Result<(), LevelError> {
        for window in self.0 {
            if window.level > COARSEST {
                return Err(LevelError::Level { level: window.level });
            }
            let corners: u64 = window.counts().iter().map(|&n| n as u64).product();
            if window.cells.is_empty() || window.samples.len() as u64 != corners {
                let given = window.samples.len() as u64;
                return Err(LevelError::Samples { level: window.level, given, wanted: corners });
            }
        }
        for (i, one) in self.0.iter().enumerate() {
            for other in &self.0[i + 1..] {
                agree(one, other)?;
            }
        }
        Ok(())
    }

    /// The sample at a corner of a level: one that is given, or else that of a finer level in the same place.
    fn at(self, level: u32, corner: [i32; 3]) -> Option<f32> {
        let of = |window: &LevelWindow| {
            let finer = level.checked_sub(window.level)?;
            let factor = 1_i32.checked_shl(finer)?;
            let [x, y, z] = corner.map(|i| i.checked_mul(factor));
            window.at([x?, y?, z?])
        };
        let own = self.0.iter().filter(|window| window.level == level).find_map(of);
        own.or_else(|| self.0.iter().filter(|window| window.level != level).find_map(of))
    }

    /// Whether there are samples at all corners of a box of cells of a level.
    ///
    /// # Errors
    /// [`LevelError::Missing`].
    pub(super) fn has(self, level: u32, cells: CellBox) -> Result<(), LevelError> {
        let contains = |window: &LevelWindow| {
            let Some(factor) = level.checked_sub(window.level).and_then(|finer| 1_i32.checked_shl(finer))
            else {
                return false;
            };
            let scaled = [cells.start, cells.end].map(|corner| corner.map(|i| i.saturating_mul(factor)));
            window.cells.contains_box(&CellBox { start: scaled[0], end: scaled[1] })
        };
        let is_there = self.0.iter().any(contains);
        if is_there { Ok(()) } else { Err(LevelError::Missing { level, cells }) }
    }

    /// The samples of a box of cells of a level, as they are or taken from a finer level into `derived`.
    ///
    /// # Errors
    /// [`LevelError::Missing`].
    pub(super) fn of_box<'d>(
        self,
        level: u32,
        cells: CellBox,
        derived: &'d mut Vec<f32>,
    ) -> Result<(CellBox, &'d [f32]), LevelError>
    where
        'a: 'd,
    {
        let is_it = |window: &&LevelWindow| window.level == level && window.cells.contains_box(&cells);
        if let Some(window) = self.0.iter().find(is_it) {
            return Ok((window.cells, window.samples));
        }
        let [nx, ny, nz] = cells.size().map(|n| n as usize + 1);
        derived.clear();
        refill(derived, nx * ny * nz, 0.0)?;
        let missing = || LevelError::Missing { level, cells };
        for (i, sample) in derived.iter_mut().enumerate() {
            let place = [i % nx, i / nx % ny, i / nx / ny];
            let corner = [0, 1, 2].map(|axis| cells.start[axis].wrapping_add(place[axis] as i32));
            *sample = self.at(level, corner).ok_or_else(missing)?;
        }
        Ok((cells, derived))
    }
}

/// Whether two windows have the same samples where their corners are in the same places.
fn agree(one: &LevelWindow, other: &LevelWindow) -> Result<(), LevelError> {
    let (fine, coarse) = if one.level <= other.level { (one, other) } else { (other, one) };
    let factor = 1_i64 << (coarse.level - fine.level);
    let ranges = [0, 1, 2].map(|axis| {
        let (low, high) = (i64::from(fine.cells.start[axis]), i64::from(fine.cells.end[axis]));
        let first = (-(-low).div_euclid(factor)).max(coarse.cells.start[axis].into());
        first..=high.div_euclid(factor).min(coarse.cells.end[axis].into())
    });
    let [xs, ys, zs] = ranges;
    for z in zs {
        for y in ys.clone() {
            for x in xs.clone() {
                let corner = [x, y, z];
                let samples = [(fine, factor), (coarse, 1)]
                    .map(|(of, times)| of.at(corner.map(|i| (i * times) as i32)));
                if let [Some(a), Some(b)] = samples
                    && a != b
                    && !(a.is_nan() && b.is_nan())
                {
                    return Err(LevelError::Disagree {
                        levels: [fine.level, coarse.level],
                        corner: corner.map(|i| i as i32),
                        samples: [a, b],
                    });
                }
            }
        }
    }
    Ok(())
}

/// What seams ask for values: a field, or the samples of a level.
#[derive(Clone, Copy)]
pub(super) enum Values<'a> {
    Field(&'a dyn StudyField),
    Samples(&'a LevelSamples<'a>),
}

impl<'a> Values<'a> {
    /// The value at a corner of a grid, which is that of the samples' level.
    pub(super) fn at(self, grid: &Grid, corner: [i32; 3]) -> f32 {
        match self {
            Self::Field(field) => field.sample(Vec3::from(point(grid, corner))),
            Self::Samples(samples) => samples.at(corner),
        }
    }

    /// The values between.
    pub(super) fn field(self) -> &'a dyn StudyField {
        match self {
            Self::Field(field) => field,
            Self::Samples(samples) => samples,
        }
    }
}

/// The samples of one level as a field.
pub(super) struct LevelSamples<'a> {
    pub(super) windows: Windows<'a>,
    pub(super) level: u32,
    pub(super) grid: Grid,
}

impl LevelSamples<'_> {
    /// The sample at a corner. It is there at all corners that seams look at, since the windows were found to have them.
    fn at(&self, corner: [i32; 3]) -> f32 {
        self.windows.at(self.level, corner).unwrap_or(f32::NAN)
    }
}

impl StudyField for LevelSamples<'_> {
    fn sample(&self, p: Vec3) -> f32 {
        let (origin, spacing) = (self.grid.origin(), self.grid.spacing());
        let steps = [0, 1, 2].map(|axis| (f64::from(p[axis]) - origin[axis]) / spacing);
        let low = steps.map(|step| step.floor());
        let ratio = [0, 1, 2].map(|axis| steps[axis] - low[axis]);
        let low = low.map(|step| step as i32);
        let mut sum = 0.0;
        for c in 0..8_usize {
            let corner = [0, 1, 2].map(|axis| low[axis].saturating_add((c >> axis & 1) as i32));
            let weight = |axis: usize| if c >> axis & 1 != 0 { ratio[axis] } else { 1.0 - ratio[axis] };
            let weight = weight(0) * weight(1) * weight(2);
            // What has no weight need not be a number, nor be there.
            if weight > 0.0 {
                sum += weight * f64::from(self.at(corner));
            }
        }
        sum as f32
    }
}

/// The boxes of cells, with their levels, whose samples the chunk of a box depends on, where each box is given so many cells more on every
/// side: of the chunk's own level, and of each neighbour that is [seen](crate::LevelExtractor::seen) and of another level.
///
/// # Errors
/// [`LevelError::Odd`], [`LevelError::Finest`].
pub(super) fn needed(
    level: u32,
    cells: CellBox,
    seen: &Neighbours,
    more: u32,
) -> Result<Vec<(u32, CellBox)>, LevelError> {
    let everywhere = CellBox { start: [i32::MIN; 3], end: [i32::MAX; 3] };
    let mut boxes = vec![(level, cells.grown(more, &everywhere))];
    for direction in DIRECTIONS {
        let step = seen.step(direction);
        let corners = [cells.start, cells.end];
        let [start, end] = match step {
            0 => continue,
            ..0 if level == 0 => return Err(LevelError::Finest),
            ..0 => corners.map(|corner| corner.map(|i| i.saturating_mul(2))),
            1.. if corners.iter().flatten().any(|i| i % 2 != 0) => return Err(LevelError::Odd { cells }),
            1.. => corners.map(|corner| corner.map(|i| i >> 1)),
        };
        let side = |axis: usize, low: bool| match direction[axis].signum() {
            0 if low => start[axis],
            -1 => start[axis],
            _ => end[axis],
        };
        let at_side = CellBox {
            start: [0, 1, 2].map(|axis| side(axis, true)),
            end: [0, 1, 2].map(|axis| side(axis, false)),
        };
        boxes.push((level.saturating_add_signed(step), at_side.grown(more, &everywhere)));
    }
    Ok(boxes)
}
