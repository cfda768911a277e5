//! How many points, edges and tetrahedra a lattice has, and what storing them takes.

use super::layout::PADDING_LAYERS;
use super::{Arrangement, DIRECTIONS, Lattice};

/// A vertex number for each of the fourteen edges, and a set of the edges that cross the surface.
const BYTES_PER_EDGE_RECORD: u64 = (DIRECTIONS * size_of::<u32>() + size_of::<u16>()) as u64;
/// The value of the field.
const BYTES_PER_SAMPLE: u64 = size_of::<f32>() as u64;
/// A side; a value, where it is and its slope; a span.
const BYTES_PER_TILE: u64 = 1 + 20 + 12;
/// Which of a row's points are to be sampled: a number, a place, a value.
const BYTES_PER_COLUMN: u64 = 8 + 4 + 4;
/// Along x and y of either kind of point.
const BYTES_PER_COORDINATE: u64 = 4;
/// Scratch of the vertex stage: inside or outside.
const BYTES_PER_SIDE: u64 = 1;
/// Where points differ in their edges: the number of a point's record.
const BYTES_PER_RECORD_NUMBER: u64 = size_of::<u32>() as u64;

/// Counts of the whole lattice. `x`, `y`, `z` are the cells along each axis.
impl Lattice {
    /// Sample points of a stored lattice: `(x+2)(y+2)(2z+3)` body-centred, which includes unused fillers,
    /// `(x+1)(y+1)(z+1)` simple cubic and with five tetrahedra, `(2x+1)(2y+1)(2z+1)` face-centred, where the middles of
    /// cube edges are fillers. Accumulated positions sample all of them; streaming leaves out what it can.
    pub fn stored_samples(&self) -> u64 {
        self.stored_grid().iter().map(|&n| u64::from(n)).product()
    }

    /// Sample points that belong to a tetrahedron: `2xyz + 3(xy+xz+yz) + (x+y+z) + 1` body-centred,
    /// `(x+1)(y+1)(z+1)` simple cubic and with five tetrahedra, `5xyz + 2(xy+xz+yz) + (x+y+z) + 1` face-centred.
    pub fn needed_samples(&self) -> u64 {
        self.polynomial(match self.arrangement {
            Arrangement::BodyCentred => [2, 3, 1, 1],
            Arrangement::SimpleCubic | Arrangement::FiveTetrahedra => [1, 1, 1, 1],
            Arrangement::FaceCentred => [5, 2, 1, 1],
        })
    }

    /// Places for an edge's vertex that are stored: fourteen a stored sample point. Where points differ in their edges,
    /// those that belong to a tetrahedron.
    pub fn stored_edges(&self) -> u64 {
        match self.arrangement.uniform() {
            Some(_) => DIRECTIONS as u64 * self.stored_samples(),
            None => self.needed_edges(),
        }
    }

    /// Edges that belong to a tetrahedron: `14xyz + 11(xy+xz+yz) + (x+y+z)` body-centred,
    /// `7xyz + 3(xy+xz+yz) + (x+y+z)` simple cubic, `6xyz + 3(xy+xz+yz) + (x+y+z)` with five tetrahedra,
    /// `29xyz + 6(xy+xz+yz) + (x+y+z)` face-centred.
    pub fn needed_edges(&self) -> u64 {
        self.polynomial(match self.arrangement {
            Arrangement::BodyCentred => [14, 11, 1, 0],
            Arrangement::SimpleCubic => [7, 3, 1, 0],
            Arrangement::FiveTetrahedra => [6, 3, 1, 0],
            Arrangement::FaceCentred => [29, 6, 1, 0],
        })
    }

    /// Tetrahedra: `12xyz + 4(xy+xz+yz)` body-centred, `6xyz` simple cubic, `5xyz` and `24xyz`.
    pub fn tetrahedra(&self) -> u64 {
        self.polynomial(match self.arrangement {
            Arrangement::BodyCentred => [12, 4, 0, 0],
            Arrangement::SimpleCubic => [6, 0, 0, 0],
            Arrangement::FiveTetrahedra => [5, 0, 0, 0],
            Arrangement::FaceCentred => [24, 0, 0, 0],
        })
    }

    /// What [`extract`](crate::by_lattice::extract) allocates with accumulated positions before it knows the surface: samples, edge
    /// records and scratch. With indexed positions it is [`streaming_bytes`](Self::streaming_bytes), far less;
    /// [`memory_bytes_for`](Self::memory_bytes_for) chooses. The mesh comes on top.
    ///
    /// Arrangements whose points differ in their edges have no accumulated positions; of them this is what storing would
    /// take: samples, sides and one number a point.
    pub fn memory_bytes(&self) -> u64 {
        if self.arrangement.uniform().is_none() {
            return self.stored_samples() * (BYTES_PER_SAMPLE + BYTES_PER_SIDE + BYTES_PER_RECORD_NUMBER);
        }
        let layer: u64 = self.stored_grid()[..2].iter().map(|&n| u64::from(n)).product();
        let padding = 2 * PADDING_LAYERS as u64 * layer * BYTES_PER_SIDE;
        self.stored_samples() * (BYTES_PER_SAMPLE + BYTES_PER_EDGE_RECORD + BYTES_PER_SIDE) + padding
    }

    /// What streaming extraction (indexed positions) of a field holds of the lattice at a time on `threads` threads: a
    /// few layers of samples, sign bits and point records each, and what is known of tiles of two by two columns; and
    /// the coordinates along each axis, once. The mesh comes on top.
    pub fn streaming_bytes(&self, threads: u64) -> u64 {
        let [x, y, z] = self.stored_grid().map(u64::from);
        if self.arrangement.uniform().is_none() {
            return self.split_bytes(threads);
        }
        // Layers that a lattice edge can reach.
        let reach = match self.arrangement {
            Arrangement::BodyCentred => 2,
            _ => 1,
        };
        let words = x.div_ceil(64);
        let samples_and_signs = x * BYTES_PER_SAMPLE + 8 * words + 8 * (words + 2) + 1;
        let records = 8 * x + 8 * words;
        let tiles = x.div_ceil(2) * y.div_ceil(2) * BYTES_PER_TILE;
        let rows = y * ((3 * reach + 1) * samples_and_signs + (2 * reach + 1) * records);
        threads * (rows + tiles + x * BYTES_PER_COLUMN) + (2 * (x + y) + z) * BYTES_PER_COORDINATE
    }

    /// The same where points differ in their edges. Rows of bits have a word more at either end; tiles have two cells
    /// along a side; records are those of crossings, which come on top like the mesh.
    fn split_bytes(&self, threads: u64) -> u64 {
        let [x, y, z] = self.stored_grid().map(u64::from);
        // Layers that a lattice edge can reach, and columns of coordinates that are there once more.
        let (reach, again) = match self.arrangement {
            Arrangement::FaceCentred => (2, x),
            _ => (1, 0),
        };
        let words = x.div_ceil(64);
        // Of samples, whether they were taken, sides and crossings.
        let in_sight = x * BYTES_PER_SAMPLE + 3 * 8 * (words + 2) + BYTES_PER_SIDE;
        let starts = words * BYTES_PER_RECORD_NUMBER;
        let tiles = x.div_ceil(2 * reach) * y.div_ceil(2 * reach) * BYTES_PER_TILE;
        let rows = y * ((3 * reach + 1) * in_sight + (reach + 1) * starts);
        threads * (rows + tiles + x * BYTES_PER_COLUMN) + (x + y + z + again) * BYTES_PER_COORDINATE
    }

    /// Bytes of the stored samples.
    pub(crate) fn sample_bytes(&self) -> u64 {
        self.stored_samples() * BYTES_PER_SAMPLE
    }

    /// Bytes of the stored edge records.
    pub(crate) fn edge_bytes(&self) -> u64 {
        let bytes_a_point = match self.arrangement.uniform() {
            Some(_) => BYTES_PER_EDGE_RECORD,
            None => BYTES_PER_RECORD_NUMBER,
        };
        self.stored_samples() * bytes_a_point
    }

    /// Stored sample points along x, y and z.
    pub(crate) fn stored_grid(&self) -> [u32; 3] {
        self.grid_of(self.cells)
    }

    /// The same of a lattice with so many cells.
    pub(crate) fn grid_of(&self, [x, y, z]: [u32; 3]) -> [u32; 3] {
        match self.arrangement {
            Arrangement::BodyCentred => [x + 2, y + 2, 2 * z + 3],
            Arrangement::SimpleCubic | Arrangement::FiveTetrahedra => [x + 1, y + 1, z + 1],
            Arrangement::FaceCentred => [2 * x + 1, 2 * y + 1, 2 * z + 1],
        }
    }

    /// `a xyz + b (xy + xz + yz) + c (x + y + z) + d`. No overflow: [`Lattice::MAX_SAMPLES`].
    fn polynomial(&self, [a, b, c, d]: [i64; 4]) -> u64 {
        let [x, y, z] = self.cells.map(i64::from);
        (a * x * y * z + b * (x * y + x * z + y * z) + c * (x + y + z) + d) as u64
    }
}
