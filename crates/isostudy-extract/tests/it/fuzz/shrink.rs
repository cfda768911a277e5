//! From a volume that breaks a promise to the smallest that still does: planes of samples go, axes straighten, and samples become one of
//! three. proptest asks for the next, and says which of them still fail.

use proptest::prelude::*;
use proptest::strategy::{NewTree, ValueTree};
use proptest::test_runner::TestRunner;

use super::volume::{STRAIGHT, Volume};

/// Random volumes that shrink.
#[derive(Debug)]
pub(super) struct Volumes;

impl Strategy for Volumes {
    type Tree = Shrinking;
    type Value = Volume;

    fn new_tree(&self, runner: &mut TestRunner) -> NewTree<Self> {
        let seed = any::<u64>().new_tree(runner)?.current();
        Ok(Shrinking::new(Volume::random(seed)))
    }
}

/// One way to make a volume simpler.
#[derive(Debug, Clone, Copy)]
enum Edit {
    /// Half the planes across an axis go: the lower or the upper ones.
    Half(usize, bool),
    /// A plane across an axis goes.
    Plane(usize, usize),
    /// Steps of one along the axes of space.
    Straight,
    /// An isovalue of nought, with all samples -1, 0 or 1 as they lie to the isovalue.
    Signs,
    /// Chunks of one cell.
    Chunk,
    /// Fewer chunks that are fine.
    Fine(u32),
    /// Another sample in a place.
    Sample(usize, f32),
}

/// A volume that fails, and one that may.
#[derive(Debug)]
pub(super) struct Shrinking {
    failing: Volume,
    tried: Volume,
    /// What can be tried of the one that fails, from which on, and how many of them were not tried since it is what it is.
    edits: Vec<Edit>,
    next: usize,
    left: usize,
}

impl Shrinking {
    pub(super) fn new(failing: Volume) -> Self {
        let (tried, edits) = (failing.clone(), edits(&failing));
        Self { left: edits.len(), failing, tried, edits, next: 0 }
    }

    /// Puts the next volume to be tried in place; the failing one if there is none.
    fn try_next(&mut self) -> bool {
        while self.left > 0 {
            let edit = self.edits[self.next % self.edits.len()];
            (self.next, self.left) = (self.next + 1, self.left - 1);
            if let Some(simpler) = simpler(&self.failing, edit) {
                self.tried = simpler;
                return true;
            }
        }
        self.tried = self.failing.clone();
        false
    }
}

impl ValueTree for Shrinking {
    type Value = Volume;

    fn current(&self) -> Volume {
        self.tried.clone()
    }

    /// The volume tried fails too.
    fn simplify(&mut self) -> bool {
        self.failing = self.tried.clone();
        self.edits = edits(&self.failing);
        self.left = self.edits.len();
        self.next = self.next.checked_rem(self.edits.len()).unwrap_or(0);
        self.try_next()
    }

    /// It does not.
    fn complicate(&mut self) -> bool {
        self.try_next()
    }
}

/// All edits of a volume; those that take most away first.
fn edits(volume: &Volume) -> Vec<Edit> {
    let mut edits = Vec::new();
    for axis in 0..3 {
        edits.extend([Edit::Half(axis, false), Edit::Half(axis, true)]);
    }
    for axis in 0..3 {
        edits.extend((0..volume.counts[axis]).map(|plane| Edit::Plane(axis, plane)));
    }
    edits.extend([Edit::Straight, Edit::Signs, Edit::Chunk]);
    edits.extend((0..8).map(Edit::Fine));
    let isovalue = volume.isovalue;
    let simple = [isovalue - 1.0, isovalue + 1.0, isovalue];
    edits.extend((0..volume.values.len()).flat_map(|at| simple.map(|value| Edit::Sample(at, value))));
    edits
}

/// The volume after an edit; `None` if it is no simpler.
fn simpler(volume: &Volume, edit: Edit) -> Option<Volume> {
    let same = volume.clone();
    match edit {
        Edit::Half(axis, upper) => {
            let count = volume.counts[axis];
            let gone = if upper { count.div_ceil(2)..count } else { 0..count / 2 };
            // One plane is an edit of its own.
            (gone.len() > 1).then_some(())?;
            gone.rev().try_fold(same, |volume, plane| volume.without(axis, plane))
        }
        Edit::Plane(axis, plane) => volume.without(axis, plane),
        Edit::Straight => {
            let is_straight = volume.steps == STRAIGHT && volume.origin == [0.0; 3];
            (!is_straight).then_some(Volume { steps: STRAIGHT, origin: [0.0; 3], ..same })
        }
        Edit::Signs => {
            let sign =
                |&value: &f32| value.partial_cmp(&volume.isovalue).map_or(value, |o| f32::from(o as i8));
            let values: Vec<f32> = volume.values.iter().map(sign).collect();
            let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            let is_simpler = volume.isovalue.to_bits() != 0 || bits(&values) != bits(&volume.values);
            is_simpler.then_some(Volume { values, isovalue: 0.0, ..same })
        }
        Edit::Chunk => (volume.chunk > 1).then_some(Volume { chunk: 1, ..same }),
        Edit::Fine(octant) => {
            (volume.fine >> octant & 1 != 0).then_some(Volume { fine: volume.fine & !(1 << octant), ..same })
        }
        Edit::Sample(at, value) => {
            let rank = |value| rank(value, volume.isovalue);
            (rank(value) < rank(volume.values[at])).then(|| {
                let mut simpler = same;
                simpler.values[at] = value;
                simpler
            })
        }
    }
}

/// How far a sample is from the simplest, which is one below the isovalue. Where the isovalue is so large that one more is no other
/// number, nothing is simpler.
fn rank(value: f32, isovalue: f32) -> u32 {
    if value == isovalue - 1.0 && value < isovalue {
        0
    } else if value == isovalue + 1.0 && value > isovalue {
        1
    } else if value.to_bits() == isovalue.to_bits() {
        2
    } else {
        3
    }
}
