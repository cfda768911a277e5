//! The range of the samples in any box of a grid: a pyramid of bricks, each twice as wide as those below.

use std::collections::TryReserveError;

/// Steps from sample to sample along the edge of the smallest brick. The smaller it is, the fewer samples are taken between.
pub(super) const EDGES: [usize; 4] = [4, 8, 16, 32];
/// Beyond this, differences may overflow, and interpolation makes what is not in the range of its samples.
const LARGEST: f32 = 1e37;

/// The least and the greatest value of a brick; `NaN` where a sample is not finite, or too large.
type Range = [f32; 2];

/// Of no sample yet.
const EMPTY: Range = [f32::INFINITY, f32::NEG_INFINITY];

#[derive(Debug, Clone)]
struct Level {
    counts: [usize; 3],
    bricks: Vec<Range>,
}

/// The ranges of all bricks.
#[derive(Debug, Clone)]
pub(super) struct Ranges {
    /// Steps from sample to sample along the edge of the smallest brick.
    edge: usize,
    levels: Vec<Level>,
}

impl Ranges {
    /// The smallest edge whose ranges take no more than so many bytes, up to [`EDGES`]' last.
    pub(super) fn edge_within(counts: [usize; 3], bytes: u64) -> usize {
        let fits = EDGES.into_iter().find(|&edge| Self::bytes(counts, edge) <= bytes);
        fits.unwrap_or(EDGES[EDGES.len() - 1])
    }

    /// How many layers of the smallest bricks there are.
    pub(super) fn layers(counts: [usize; 3], edge: usize) -> usize {
        bricks_over(counts, edge)[2]
    }

    /// What those of so many samples take.
    pub(super) fn bytes(counts: [usize; 3], edge: usize) -> u64 {
        let mut bricks = bricks_over(counts, edge);
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
        self.levels.iter().map(|level| size_of::<Range>() * level.bricks.capacity()).sum()
    }

    /// The range of the samples from `first` to `last`, both included, or of some more.
    pub(super) fn of(&self, first: [usize; 3], last: [usize; 3]) -> Option<(f32, f32)> {
        let Self { edge, ref levels } = *self;
        // A brick holds the samples at both of its ends.
        let mut low: [usize; 3] = std::array::from_fn(|k| (first[k] / edge).min(levels[0].counts[k] - 1));
        let mut high: [usize; 3] = std::array::from_fn(|k| low[k].max(last[k].saturating_sub(1) / edge));
        let mut level = 0;
        while (0..3).any(|k| high[k] > low[k] + 2) {
            (low, high, level) = (low.map(|i| i / 2), high.map(|i| i / 2), level + 1);
        }
        let Level { counts, bricks } = &levels[level];
        let mut range = EMPTY;
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

/// Finds the ranges of bricks while the samples go by, layer by layer from the lowest.
#[derive(Debug)]
pub(super) struct Scan {
    counts: [usize; 3],
    edge: usize,
    /// Along each axis.
    bricks: [usize; 3],
    /// Those of the layers of bricks that are complete.
    found: Vec<Range>,
    /// Of each row of bricks in the layer of bricks that is not, the least and the greatest sample of each column.
    least: Vec<f32>,
    greatest: Vec<f32>,
    layers: usize,
    /// The least and the greatest sample that is finite.
    finite: (f32, f32),
}

impl Scan {
    /// Before the first layer; the smallest bricks are `edge` steps wide.
    pub(super) fn new(counts: [usize; 3], edge: usize) -> Result<Self, TryReserveError> {
        let bricks = bricks_over(counts, edge);
        let mut found = Vec::new();
        found.try_reserve_exact(bricks.iter().product())?;
        let columns = bricks[1] * counts[0];
        let filled = |value| -> Result<Vec<f32>, TryReserveError> {
            let mut vector = Vec::new();
            vector.try_reserve_exact(columns)?;
            vector.resize(columns, value);
            Ok(vector)
        };
        let (least, greatest) = (filled(EMPTY[0])?, filled(EMPTY[1])?);
        Ok(Self { counts, edge, bricks, found, least, greatest, layers: 0, finite: EMPTY.into() })
    }

    /// The next layer, all of its samples.
    pub(super) fn add(&mut self, samples: &[f32]) {
        self.finite = either(self.finite, finite_range(samples));
        self.add_to_bricks(samples);
        let (layer, last) = (self.layers, self.counts[2] - 1);
        self.layers += 1;
        // Bricks hold the samples at both of their ends: those of this layer may be of two.
        if layer == last || layer > 0 && layer.is_multiple_of(self.edge) {
            self.close_bricks();
            if layer < last {
                self.add_to_bricks(samples);
            }
        }
    }

    fn add_to_bricks(&mut self, samples: &[f32]) {
        let Self { counts: [nx, ny, _], edge, .. } = *self;
        let rows = self.least.chunks_exact_mut(nx).zip(self.greatest.chunks_exact_mut(nx)).enumerate();
        for (brick, (least, greatest)) in rows {
            for row in brick * edge..=(brick * edge + edge).min(ny - 1) {
                let samples = &samples[row * nx..][..nx];
                for ((&value, least), greatest) in samples.iter().zip(&mut *least).zip(&mut *greatest) {
                    let value = if value.abs() <= LARGEST { value } else { f32::NAN };
                    [*least, *greatest] = union([value; 2], [*least, *greatest]);
                }
            }
        }
    }

    /// Ends a layer of bricks.
    fn close_bricks(&mut self) {
        let Self { counts: [nx, ..], edge, .. } = *self;
        for (least, greatest) in self.least.chunks_exact(nx).zip(self.greatest.chunks_exact(nx)) {
            for brick in 0..self.bricks[0] {
                let columns = brick * edge..(brick * edge + edge + 1).min(nx);
                let ranges = columns.map(|column| [least[column], greatest[column]]);
                self.found.push(ranges.fold(EMPTY, union));
            }
        }
        self.least.fill(EMPTY[0]);
        self.greatest.fill(EMPTY[1]);
    }

    /// What was found, after the last layer.
    pub(super) fn finish(self) -> Scanned {
        assert_eq!(self.layers, self.counts[2], "layers");
        Scanned { bricks: self.found, finite: self.finite }
    }
}

/// The ranges of the smallest bricks of a volume, or of some layers of them.
#[derive(Debug)]
pub(super) struct Scanned {
    bricks: Vec<Range>,
    finite: (f32, f32),
}

impl Scanned {
    /// Those of all layers, which parts have found one after the other from the lowest; and the least and the greatest finite sample, where
    /// the least is the greater one if none is finite.
    pub(super) fn ranges(
        counts: [usize; 3],
        edge: usize,
        parts: impl IntoIterator<Item = Self>,
    ) -> Result<(Ranges, (f32, f32)), TryReserveError> {
        let mut all = Self { bricks: Vec::new(), finite: EMPTY.into() };
        for part in parts {
            all.finite = either(all.finite, part.finite);
            if all.bricks.is_empty() {
                all.bricks = part.bricks;
                continue;
            }
            all.bricks.try_reserve_exact(part.bricks.len())?;
            all.bricks.extend(part.bricks);
        }
        let mut levels = vec![Level { counts: bricks_over(counts, edge), bricks: all.bricks }];
        assert_eq!(levels[0].bricks.len(), levels[0].counts.iter().product::<usize>(), "bricks");
        while levels[levels.len() - 1].counts != [1; 3] {
            levels.push(levels[levels.len() - 1].halved()?);
        }
        Ok((Ranges { edge, levels }, all.finite))
    }
}

/// The least and the greatest of some samples that are finite; infinity and its negative if none is.
fn finite_range(samples: &[f32]) -> (f32, f32) {
    // Eight at a time, since one by one takes as long as all else.
    let (mut least, mut greatest) = ([EMPTY[0]; 8], [EMPTY[1]; 8]);
    let (eights, rest) = samples.as_chunks::<8>();
    for eight in eights {
        for (i, &value) in eight.iter().enumerate() {
            let is_finite = value.is_finite();
            least[i] = if is_finite && value < least[i] { value } else { least[i] };
            greatest[i] = if is_finite && value > greatest[i] { value } else { greatest[i] };
        }
    }
    let rest = rest.iter().filter(|value| value.is_finite()).map(|&value| (value, value));
    least.into_iter().zip(greatest).chain(rest).fold(EMPTY.into(), either)
}

fn either(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    (a.0.min(b.0), a.1.max(b.1))
}

/// The smallest bricks over so many samples.
fn bricks_over(counts: [usize; 3], edge: usize) -> [usize; 3] {
    counts.map(|n| n.saturating_sub(1).div_ceil(edge).max(1))
}

fn halved(bricks: [usize; 3]) -> [usize; 3] {
    bricks.map(|n| n.div_ceil(2))
}

impl Level {
    /// Bricks twice as wide.
    fn halved(&self) -> Result<Self, TryReserveError> {
        let (below, counts) = (self.counts, halved(self.counts));
        let mut bricks = Vec::new();
        bricks.try_reserve_exact(counts.iter().product())?;
        let two = |k: usize, i: usize| 2 * i..below[k].min(2 * i + 2);
        for z in 0..counts[2] {
            for y in 0..counts[1] {
                for x in 0..counts[0] {
                    let mut range = EMPTY;
                    for k in two(2, z) {
                        for j in two(1, y) {
                            let row = below[0] * (j + below[1] * k);
                            range = two(0, x).fold(range, |range, i| union(range, self.bricks[row + i]));
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers without end, many of them odd.
    fn samples(counts: [usize; 3], seed: u64, odd: bool) -> Vec<f32> {
        let mut state = seed;
        let mut next = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % below
        };
        (0..counts.iter().product::<usize>())
            .map(|_| match next(200) {
                0 if odd => f32::NAN,
                1 if odd => f32::INFINITY,
                2 if odd => f32::NEG_INFINITY,
                3 if odd => 3e38,
                _ => next(1000) as f32 - 500.0,
            })
            .collect()
    }

    fn scanned(counts: [usize; 3], edge: usize, samples: &[f32]) -> (Ranges, (f32, f32)) {
        let mut scan = Scan::new(counts, edge).unwrap();
        samples.chunks_exact(counts[0] * counts[1]).for_each(|layer| scan.add(layer));
        Scanned::ranges(counts, edge, [scan.finish()]).unwrap()
    }

    /// The bricks of each level by their definition: all samples from one end to the other, both included.
    #[test]
    fn bricks_have_the_range_of_their_samples_with_those_at_their_ends() {
        for (counts, edge) in [
            ([2, 2, 2], 4),
            ([9, 9, 9], 4),
            ([9, 9, 9], 8),
            ([5, 14, 8], 4),
            ([17, 6, 30], 8),
            ([13, 11, 12], 3),
        ] {
            for odd in [false, true] {
                let samples = samples(counts, 1, odd);
                let (ranges, _) = scanned(counts, edge, &samples);
                for (level, of) in ranges.levels.iter().enumerate() {
                    let wide = edge << level;
                    assert_eq!(of.counts, counts.map(|n| (n - 1).div_ceil(wide).max(1)), "{counts:?}");
                    for (i, range) in of.bricks.iter().enumerate() {
                        let [bx, by, _] = of.counts;
                        let brick = [i % bx, i / bx % by, i / bx / by];
                        let end = |k: usize| (brick[k] * wide + wide).min(counts[k] - 1);
                        let mut want = EMPTY;
                        for z in brick[2] * wide..=end(2) {
                            for y in brick[1] * wide..=end(1) {
                                for x in brick[0] * wide..=end(0) {
                                    let value = samples[(z * counts[1] + y) * counts[0] + x];
                                    want = union(
                                        want,
                                        if value.abs() <= LARGEST { [value; 2] } else { [f32::NAN; 2] },
                                    );
                                }
                            }
                        }
                        assert_eq!(
                            range.map(f32::to_bits),
                            want.map(f32::to_bits),
                            "{counts:?} {edge} {brick:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn finite_samples_have_a_range_whatever_the_others_are() {
        for counts in [[2, 2, 2], [7, 5, 3], [40, 30, 2]] {
            for odd in [false, true] {
                let samples = samples(counts, 7, odd);
                let finite = samples.iter().copied().filter(|v| v.is_finite());
                let want = finite.fold(EMPTY.into(), |range, v| either(range, (v, v)));
                assert_eq!(scanned(counts, 4, &samples).1, want, "{counts:?} {odd}");
            }
        }
        assert_eq!(scanned([3, 2, 2], 4, &[f32::NAN; 12]).1, EMPTY.into());
    }

    #[test]
    fn ranges_take_what_was_said_before_there_were_any() {
        for counts in [[2, 2, 2], [5, 6, 7], [9, 2, 33], [70, 40, 17]] {
            for edge in [4, 8] {
                let (made, _) = scanned(counts, edge, &vec![0.0; counts.iter().product()]);
                assert_eq!(Ranges::bytes(counts, edge), made.held() as u64, "{counts:?}");
            }
        }
    }
}
