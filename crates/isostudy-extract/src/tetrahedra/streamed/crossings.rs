//! Where signs differ from those of neighbours, 64 points at a time.

use super::grid::{LINES, Neighbourhood, UniformGrid};
use super::signs::{MIXED, Signs};
use crate::lattice::DIRECTIONS;
use crate::sampling::bits::between;

/// The sign bits of a row and of the rows that its points' neighbours lie in.
pub(super) struct Lines<'a> {
    around: &'a Neighbourhood,
    words: [&'a [u64]; LINES],
    used: usize,
}

/// A word of points, some of which have a crossing.
pub(super) struct Crossings {
    /// Which word of the row.
    pub(super) word: usize,
    /// Sides of the points.
    pub(super) sides: u64,
    /// Points with a neighbour on the other side, perhaps one beyond the lattice.
    pub(super) active: u64,
    /// The same for each direction.
    pub(super) differ: [u64; DIRECTIONS],
}

impl<'a> Lines<'a> {
    /// `None` where all points and all their neighbours are on one side. `rows` are those of
    /// [`UniformGrid::rows`], `places` the first places of their layers.
    #[inline]
    pub(super) fn new(
        signs: &'a Signs,
        around: &'a Neighbourhood,
        rows: &[(usize, usize); LINES],
        places: &[usize; LINES],
        used: usize,
    ) -> Option<Self> {
        let places: [usize; LINES] = std::array::from_fn(|i| places[rows[i].0] + rows[i].1);
        let state = signs.states[places[0]];
        if state != MIXED && places.iter().all(|&place| signs.states[place] == state) {
            return None;
        }
        Some(Self { around, words: places.map(|place| signs.row_at(place)), used })
    }

    /// Visits the words that have a crossing, in order, up to the first error.
    #[inline(always)]
    pub(super) fn visit<E>(
        &self,
        grid: &UniformGrid,
        mut each: impl FnMut(Crossings) -> Result<(), E>,
    ) -> Result<(), E> {
        let (mut before, mut here) = (Common::of(&self.words, 0), Common::of(&self.words, 1));
        for word in 0..grid.words {
            let after = Common::of(&self.words, word + 2);
            let is_uniform = here.is_uniform(before, after);
            (before, here) = (here, after);
            if is_uniform {
                continue;
            }
            let sides = self.words[0][word + 1];
            let mut differ = [0; DIRECTIONS];
            let mut active = 0;
            for (d, differ) in differ.iter_mut().enumerate() {
                let line = self.words[self.around.line[d] % LINES];
                let (low, right) = self.around.funnel[d];
                *differ = sides ^ (line[word + low] >> right | line[word + low + 1] << 1 << (63 - right));
                active |= *differ;
            }
            each(Crossings { word, sides, active: active & between(word, 0, self.used), differ })?;
        }
        Ok(())
    }
}

/// Bits that any of the rows round a word of points has, and bits that all have.
#[derive(Debug, Clone, Copy)]
struct Common {
    any: u64,
    all: u64,
}

impl Common {
    #[inline(always)]
    fn of(signs: &[&[u64]; LINES], word: usize) -> Self {
        signs.iter().fold(Self { any: 0, all: !0 }, |common, line| Self {
            any: common.any | line[word],
            all: common.all & line[word],
        })
    }

    /// Whether the points of the word and all their neighbours are on one side; `before` and `after` are the words
    /// on either side.
    #[inline(always)]
    fn is_uniform(self, before: Self, after: Self) -> bool {
        let outside = self.any | before.any >> 63 | after.any & 1;
        outside == 0 || (self.all == !0 && before.all >> 63 & after.all & 1 != 0)
    }
}
