//! What the extractors of cubes, cut or not, know of the layers in sight: samples by place, and rows that lie on one side.

use crate::sampling::bits::between;

/// Where all points of a row are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum State {
    #[default]
    Outside,
    Inside,
    Mixed,
}

impl State {
    /// That of a row of `nx` columns. Of each word, the bits `used` are points.
    pub(crate) fn of(sides: &[u64], used: u64, nx: usize) -> Self {
        let (mut any, mut all) = (0, !0);
        for (word, &sides) in sides.iter().enumerate() {
            let used = used & between(word, 0, nx);
            any |= sides & used;
            all &= sides | !used;
        }
        match (any, all) {
            (0, _) => Self::Outside,
            (_, u64::MAX) => Self::Inside,
            _ => Self::Mixed,
        }
    }
}

/// Samples by place: all of a lattice, or a ring of layers.
#[derive(Clone, Copy)]
pub(crate) struct Values<'a> {
    values: &'a [f32],
    size: [usize; 3],
    slots: usize,
}

impl<'a> Values<'a> {
    /// Samples of a lattice of so many points along the axes, in a ring of so many layers.
    pub(crate) fn new(values: &'a [f32], size: [usize; 3], slots: usize) -> Self {
        Self { values, size, slots }
    }

    /// That of a point whose sample was taken.
    #[inline]
    pub(crate) fn at(&self, [x, y, z]: [usize; 3]) -> f32 {
        self.values[(z % self.slots * self.size[1] + y) * self.size[0] + x]
    }

    /// All of them, where a lattice has all in memory.
    pub(crate) fn all(&self) -> &'a [f32] {
        self.values
    }

    /// Those of a row.
    #[inline]
    pub(crate) fn row(&self, y: usize, z: usize) -> &'a [f32] {
        &self.values[(z % self.slots * self.size[1] + y) * self.size[0]..][..self.size[0]]
    }

    /// At the corners of a cube.
    pub(crate) fn corners(&self, [x, y, z]: [usize; 3]) -> [f32; 8] {
        std::array::from_fn(|c| self.at([x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)]))
    }
}
