//! Where the samples of a box of cells are, one after the other.

use isostudy_field::ScalarField;

use crate::lattice::{Arrangement, Border, Lattice};

/// The samples of a box of cells as [`Source::Window`](crate::Source::Window) wants them: row by row, x fastest.
///
/// Places are in half cells of the whole grid, `[2 x, 2 y, 2 z]` for the lowest corner of cell `[x, y, z]` and one more
/// along each axis for its centre. Simple cubic lattices and those of five tetrahedra have corners only, in one block of
/// `x + 1` by `y + 1` by `z + 1`; body-centred ones corners and centres, face-centred ones the centres of faces too.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleLayout {
    lattice: Lattice,
    border: Border,
}

impl SampleLayout {
    pub(super) fn new(lattice: Lattice, border: Border) -> Self {
        Self { lattice, border }
    }

    /// How many samples there are, fillers that nobody looks at included.
    pub fn len(&self) -> usize {
        self.lattice.stored_samples() as usize
    }

    /// Never: a box has a cell.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Samples of a row, rows of a layer, layers.
    pub fn size(&self) -> [usize; 3] {
        self.lattice.stored_grid().map(|n| n as usize)
    }

    /// Where the sample of a point is, given in half cells; `None` if the lattice has no such point in the box.
    pub fn index(&self, halves: [i64; 3]) -> Option<usize> {
        let odd = halves.iter().filter(|half| *half % 2 != 0).count();
        let halved = |i: i64| i.div_euclid(2);
        let [x, y, z] = halves;
        let stored = match (self.lattice.arrangement(), odd) {
            (Arrangement::BodyCentred, 0) => [halved(x), halved(y), z + 1],
            (Arrangement::BodyCentred, 3) => [halved(x) + 1, halved(y) + 1, z + 1],
            (Arrangement::SimpleCubic | Arrangement::FiveTetrahedra, 0) => halves.map(halved),
            (Arrangement::FaceCentred, 0 | 2 | 3) => halves,
            _ => return None,
        };
        let (first, size) = (self.lattice.first_stored(), self.size());
        let place = [0, 1, 2].map(|axis| stored[axis] - first[axis]);
        let is_there = (0..3).all(|axis| (0..size[axis] as i64).contains(&place[axis]));
        let [x, y, z] = place.map(|i| i as usize);
        is_there.then(|| (z * size[1] + y) * size[0] + x)
    }

    /// The point of a sample, in half cells; `None` for a filler, or beyond the last.
    pub fn point(&self, index: usize) -> Option<[i64; 3]> {
        let [nx, ny, nz] = self.size();
        if index >= nx * ny * nz {
            return None;
        }
        let [x, y, z] = self.lattice.stored([index % nx, index / nx % ny, index / nx / ny]);
        let halves = match self.lattice.arrangement() {
            Arrangement::BodyCentred if z % 2 == 0 => [2 * x - 1, 2 * y - 1, z - 1],
            Arrangement::BodyCentred => [2 * x, 2 * y, z - 1],
            Arrangement::SimpleCubic | Arrangement::FiveTetrahedra => [2 * x, 2 * y, 2 * z],
            Arrangement::FaceCentred => [x, y, z],
        };
        (self.index(halves) == Some(index)).then_some(halves)
    }

    /// Where a sample is taken; `None` for a filler, or beyond the last.
    pub fn position(&self, index: usize) -> Option<[f32; 3]> {
        let halves = self.point(index)?;
        Some([0, 1, 2].map(|axis| self.lattice.coordinate(axis, halves[axis], self.border)))
    }

    /// Takes all samples of a field, into the room that there is. Fillers are `NaN`.
    pub fn fill(&self, field: &dyn ScalarField, samples: &mut Vec<f32>) {
        samples.clear();
        samples.extend((0..self.len()).map(|i| self.position(i).map_or(f32::NAN, |p| field.sample(p))));
    }
}
