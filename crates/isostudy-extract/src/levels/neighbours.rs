//! What is round a chunk.

use super::error::LevelError;

/// All directions, x fastest, the middle one to the chunk itself.
pub(super) const DIRECTIONS: [[i32; 3]; 27] = {
    let mut all = [[0; 3]; 27];
    let mut i = 0;
    while i < 27 {
        all[i] = [i as i32 % 3 - 1, i as i32 / 3 % 3 - 1, i as i32 / 9 - 1];
        i += 1;
    }
    all
};

/// Of which levels the chunks round a chunk are: at its 6 sides, its 12 edges and its 8 corners.
///
/// It is small, and can be compared: a chunk is to be extracted again when its neighbours change, as far as the method
/// [sees](crate::LevelExtractor::seen) them.
///
/// ```
/// use isostudy_extract::Neighbours;
///
/// // A chunk of level 1, with chunks of level 0 to the east of it.
/// let neighbours = Neighbours::try_new(1, |[x, _, _]| if x > 0 { 0 } else { 1 })?;
/// assert_eq!((neighbours.step([1, 0, 0]), neighbours.step([0, 1, 1])), (-1, 0));
/// # Ok::<(), isostudy_extract::LevelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Neighbours {
    steps: [i8; 27],
}

impl Neighbours {
    /// All of the chunk's own level.
    pub const SAME: Self = Self { steps: [0; 27] };

    /// The neighbours of a chunk of a level. `level_at` is asked for the level of what touches the chunk in a direction, whose parts are
    /// each -1, 0 or 1 and not all 0: one that is not 0 leads to a side, two to an edge, three to a corner. Where several chunks touch it
    /// there, the finest counts.
    ///
    /// # Errors
    /// [`LevelError::Step`] if the levels at a side or an edge differ from the chunk's by more than one.
    pub fn try_new(level: u32, mut level_at: impl FnMut([i32; 3]) -> u32) -> Result<Self, LevelError> {
        let mut steps = [0; 27];
        for (step, direction) in steps.iter_mut().zip(DIRECTIONS) {
            let axes = direction.iter().filter(|&&d| d != 0).count();
            if axes == 0 {
                continue;
            }
            let there = level_at(direction);
            let difference = i64::from(there) - i64::from(level);
            if axes < 3 && difference.abs() > 1 {
                return Err(LevelError::Step { direction, levels: [level, there] });
            }
            *step = difference.signum() as i8;
        }
        Ok(Self { steps })
    }

    /// 1 where the neighbour in a direction is coarser, -1 where it is finer, else 0. Parts of the direction are taken as -1, 0 or 1.
    pub fn step(&self, direction: [i32; 3]) -> i32 {
        self.steps[number(direction)].into()
    }

    /// Whether some neighbour is finer.
    pub(super) fn has_finer(&self) -> bool {
        self.steps.iter().any(|&step| step < 0)
    }

    /// The directions to finer neighbours that divide something of the chunk's cells: sides, and edges between sides that are not divided.
    pub(super) fn dividing(&self) -> impl Iterator<Item = [i32; 3]> + use<> {
        let of = *self;
        DIRECTIONS.into_iter().filter(move |&direction| {
            let mut sides = (0..3).filter(|&axis| direction[axis] != 0).map(|axis| {
                let mut side = [0; 3];
                side[axis] = direction[axis];
                side
            });
            match direction.iter().filter(|&&d| d != 0).count() {
                1 => of.step(direction) < 0,
                2 => of.step(direction) < 0 && sides.all(|side| of.step(side) >= 0),
                _ => false,
            }
        })
    }

    /// Those in some directions; the others are of the chunk's own level.
    pub(super) fn only(mut self, matters: impl Fn([i32; 3], i32) -> bool) -> Self {
        for (step, direction) in self.steps.iter_mut().zip(DIRECTIONS) {
            if !matters(direction, (*step).into()) {
                *step = 0;
            }
        }
        self
    }
}

pub(super) fn number(direction: [i32; 3]) -> usize {
    let [x, y, z] = direction.map(|d| (d.signum() + 1) as usize);
    x + 3 * y + 9 * z
}
