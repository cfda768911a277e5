//! The range of the samples in any box of a grid: a pyramid of bricks, each twice as wide as those below.

use std::collections::TryReserveError;

/// Steps from sample to sample along the edge of the smallest brick.
const BRICK: usize = 4;
/// Beyond this, differences may overflow, and interpolation makes what is not in the range of its samples.
const LARGEST: f32 = 1e37;

/// The least and the greatest value of a brick; `NaN` where a sample is not finite, or too large.
type Range = [f32; 2];

const UNKNOWN: Range = [f32::NAN; 2];

#[derive(Debug, Clone)]
struct Level {
    counts: [usize; 3],
    bricks: Vec<Range>,
}

/// The ranges of all bricks.
#[derive(Debug, Clone)]
pub(super) struct Ranges(Vec<Level>);

impl Ranges {
    pub(super) fn new(counts: [usize; 3], values: &[f32]) -> Result<Self, TryReserveError> {
        let mut levels = vec![Level::of(counts, values)?];
        while levels[levels.len() - 1].counts != [1; 3] {
            levels.push(levels[levels.len() - 1].halved()?);
        }
        Ok(Self(levels))
    }

    /// What those of so many samples take.
    pub(super) fn bytes(counts: [usize; 3]) -> u64 {
        let mut bricks = bricks_over(counts);
        let mut all = 0;
        loop {
            all += bricks.iter().map(|&n| n as u64).product::<u64>();
            if bricks == [1; 3] {
                return all * size_of::<Range>() as u64;
            }
            bricks = halved(bricks);
        }
    }

    /// What these take.
    #[cfg(test)]
    pub(super) fn held(&self) -> usize {
        self.0.iter().map(|level| size_of::<Range>() * level.bricks.capacity()).sum()
    }

    /// The range of the samples from `first` to `last`, both included, or of some more.
    pub(super) fn of(&self, first: [usize; 3], last: [usize; 3]) -> Option<(f32, f32)> {
        // A brick holds the samples at both of its ends.
        let mut low: [usize; 3] = std::array::from_fn(|k| (first[k] / BRICK).min(self.0[0].counts[k] - 1));
        let mut high: [usize; 3] = std::array::from_fn(|k| low[k].max(last[k].saturating_sub(1) / BRICK));
        let mut level = 0;
        while (0..3).any(|k| high[k] > low[k] + 2) {
            (low, high, level) = (low.map(|i| i / 2), high.map(|i| i / 2), level + 1);
        }
        let Level { counts, bricks } = &self.0[level];
        let mut range = [f32::INFINITY, f32::NEG_INFINITY];
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    range = union(range, bricks[x + counts[0] * (y + counts[1] * z)]);
                }
            }
        }
        (range[0] <= range[1]).then_some((range[0], range[1]))
    }
}

/// The smallest bricks over so many samples.
fn bricks_over(counts: [usize; 3]) -> [usize; 3] {
    counts.map(|n| n.saturating_sub(1).div_ceil(BRICK).max(1))
}

fn halved(bricks: [usize; 3]) -> [usize; 3] {
    bricks.map(|n| n.div_ceil(2))
}

impl Level {
    fn of(counts: [usize; 3], values: &[f32]) -> Result<Self, TryReserveError> {
        let of_samples = |at: usize| if values[at].abs() <= LARGEST { [values[at]; 2] } else { UNKNOWN };
        Self::over(counts, bricks_over(counts), BRICK, BRICK + 1, of_samples)
    }

    fn halved(&self) -> Result<Self, TryReserveError> {
        Self::over(self.counts, halved(self.counts), 2, 2, |at| self.bricks[at])
    }

    /// Bricks over a grid of ranges, `wide` of them along each edge, `apart` from brick to brick.
    fn over(
        below: [usize; 3],
        counts: [usize; 3],
        apart: usize,
        wide: usize,
        of: impl Fn(usize) -> Range,
    ) -> Result<Self, TryReserveError> {
        let mut bricks = Vec::new();
        bricks.try_reserve_exact(counts.iter().product())?;
        let part = |k: usize, i: usize| i * apart..below[k].min(i * apart + wide);
        for z in 0..counts[2] {
            for y in 0..counts[1] {
                for x in 0..counts[0] {
                    let mut range = [f32::INFINITY, f32::NEG_INFINITY];
                    for k in part(2, z) {
                        for j in part(1, y) {
                            let row = below[0] * (j + below[1] * k);
                            range = part(0, x).fold(range, |range, i| union(range, of(row + i)));
                        }
                    }
                    bricks.push(range);
                }
            }
        }
        Ok(Self { counts, bricks })
    }
}

/// `NaN` if one of them is.
fn union(a: Range, b: Range) -> Range {
    let low = if a[0] < b[0] || a[0].is_nan() { a[0] } else { b[0] };
    let high = if a[1] > b[1] || a[1].is_nan() { a[1] } else { b[1] };
    [low, high]
}
