//! The samples of a volume by place: all of them in memory, or bricks of them, read when they are asked for.

use std::collections::TryReserveError;
use std::fmt;
use std::sync::{Arc, Mutex};

use super::stored::StoredSamples;

/// Cells along the edge of a brick. It has the samples at all their corners, so bricks side by side share a face.
const EDGE: usize = 16;
/// Places that a brick can be kept in.
const WAYS: usize = 8;
/// A brick's number where there is none.
const NONE: u64 = u64::MAX;

/// The samples of a volume.
#[derive(Debug, Clone)]
pub(super) enum Samples {
    /// All of them, the first axis fastest.
    Whole(Arc<Vec<f32>>),
    Stored(Arc<Bricks>),
}

/// Samples round a cell: that at its lowest corner, and from one sample to the next along each axis.
pub(super) struct Near<'a> {
    pub(super) values: &'a [f32],
    pub(super) at: usize,
    pub(super) strides: [usize; 3],
}

/// Samples as one thread looks at them: it keeps the brick that it looked at last.
pub(super) enum Reader<'a> {
    Whole(&'a [f32], [usize; 3]),
    Stored(&'a Bricks, Option<(u64, Arc<Vec<f32>>)>),
}

impl Samples {
    /// A reader of so many samples along each axis.
    #[inline]
    pub(super) fn reader(&self, [nx, ny, _]: [usize; 3]) -> Reader<'_> {
        match self {
            Self::Whole(values) => Reader::Whole(values, [1, nx, nx * ny]),
            Self::Stored(bricks) => Reader::Stored(bricks, None),
        }
    }
}

impl Reader<'_> {
    /// The samples from `corner` on, and one farther along each axis where there is one.
    #[inline]
    pub(super) fn near(&mut self, corner: [usize; 3]) -> Near<'_> {
        match self {
            Self::Whole(values, strides) => {
                let at = corner[0] + corner[1] * strides[1] + corner[2] * strides[2];
                Near { values, at, strides: *strides }
            }
            Self::Stored(bricks, kept) => {
                let (number, brick) = bricks.around(corner);
                if kept.as_ref().is_none_or(|kept| kept.0 != number) {
                    *kept = None;
                }
                let (_, values) = kept.get_or_insert_with(|| (number, bricks.get(number, brick)));
                let (inner, [nx, ny, _]) =
                    ([0, 1, 2].map(|k| corner[k] - EDGE * brick[k]), bricks.size(brick));
                let strides = [1, nx, nx * ny];
                Near { values, at: inner[0] + inner[1] * strides[1] + inner[2] * strides[2], strides }
            }
        }
    }
}

/// Bricks of stored samples, of which those that were asked for last are kept, up to a number that does not grow.
///
/// A brick can be kept in one of a few places, which it shares with others by chance. The one of these that was asked for longest ago makes
/// room for it. Which bricks are kept depends on the threads; their samples do not.
pub(super) struct Bricks {
    samples: Arc<dyn StoredSamples>,
    counts: [usize; 3],
    /// Along each axis.
    bricks: [usize; 3],
    /// Each with as many places.
    sets: Vec<Mutex<Set>>,
}

struct Set {
    places: Vec<Place>,
    /// How often one of them was asked for.
    time: u64,
}

struct Place {
    brick: u64,
    values: Arc<Vec<f32>>,
    /// When it was asked for last.
    asked: u64,
}

impl fmt::Debug for Bricks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Bricks")
            .field("counts", &self.counts)
            .field("sets", &self.sets.len())
            .finish_non_exhaustive()
    }
}

/// How many bricks there are along each axis.
fn bricks_over(counts: [usize; 3]) -> [usize; 3] {
    counts.map(|n| n.saturating_sub(1).div_ceil(EDGE).max(1))
}

/// Sets, and places in each, that hold no more than so many bytes; one at least.
fn sets_and_places(counts: [usize; 3], bytes: u64) -> (usize, usize) {
    let all = bricks_over(counts).iter().map(|&n| n as u64).product::<u64>();
    let most = (bytes / brick_bytes(counts)).clamp(1, all) as usize;
    if most < WAYS { (1, most) } else { (most / WAYS, WAYS) }
}

fn brick_bytes(counts: [usize; 3]) -> u64 {
    counts.map(|n| n.min(EDGE + 1) as u64).iter().product::<u64>() * size_of::<f32>() as u64
}

impl Bricks {
    /// What bricks of so many samples take that are to take `bytes`: not more, unless one takes more.
    pub(super) fn bytes(counts: [usize; 3], bytes: u64) -> u64 {
        let (sets, places) = sets_and_places(counts, bytes);
        (sets * places) as u64 * brick_bytes(counts)
    }

    /// None is read yet; all memory is asked for.
    pub(super) fn new(samples: Arc<dyn StoredSamples>, bytes: u64) -> Result<Self, TryReserveError> {
        let counts = samples.counts();
        let (sets, places) = sets_and_places(counts, bytes);
        let length = brick_bytes(counts) as usize / size_of::<f32>();
        let place = || -> Result<Place, TryReserveError> {
            let mut values = Vec::new();
            values.try_reserve_exact(length)?;
            Ok(Place { brick: NONE, values: Arc::new(values), asked: 0 })
        };
        let set = || -> Result<Mutex<Set>, TryReserveError> {
            Ok(Mutex::new(Set { places: (0..places).map(|_| place()).collect::<Result<_, _>>()?, time: 0 }))
        };
        let sets = (0..sets).map(|_| set()).collect::<Result<_, _>>()?;
        Ok(Self { samples, counts, bricks: bricks_over(counts), sets })
    }

    /// The brick with a sample and those one farther along each axis, where there are such; and its number.
    fn around(&self, corner: [usize; 3]) -> (u64, [usize; 3]) {
        // The last samples have no cell of their own.
        let brick = [0, 1, 2].map(|k| (corner[k] / EDGE).min(self.bricks[k] - 1));
        let [bx, by, _] = self.bricks;
        (((brick[2] * by + brick[1]) * bx + brick[0]) as u64, brick)
    }

    /// Samples of a brick along each axis.
    fn size(&self, brick: [usize; 3]) -> [usize; 3] {
        [0, 1, 2].map(|k| (EDGE + 1).min(self.counts[k] - EDGE * brick[k]))
    }

    /// The samples of a brick; not numbers where they cannot be read, which whoever reads them knows.
    fn get(&self, number: u64, brick: [usize; 3]) -> Arc<Vec<f32>> {
        // Neighbours go to sets of their own.
        let mixed = number.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        let set = &self.sets[(mixed % self.sets.len() as u64) as usize];
        let Set { places, time } = &mut *set.lock().expect("nothing panics with it");
        *time += 1;
        if let Some(place) = places.iter_mut().find(|place| place.brick == number) {
            place.asked = *time;
            return Arc::clone(&place.values);
        }
        let place = places.iter_mut().min_by_key(|place| place.asked).expect("a set has a place");
        (place.brick, place.asked) = (number, *time);
        if Arc::get_mut(&mut place.values).is_none() {
            // Another thread still looks at the brick that was here.
            place.values = Arc::default();
        }
        let values = Arc::get_mut(&mut place.values).expect("nobody else has it");
        let size = self.size(brick);
        values.clear();
        values.resize(size.iter().product(), f32::NAN);
        if self.samples.read_box(brick.map(|i| EDGE * i), size, values).is_err() {
            values.fill(f32::NAN);
        }
        Arc::clone(&place.values)
    }
}
