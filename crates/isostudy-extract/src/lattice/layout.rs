//! Where sample points are stored and which neighbours each one has.

use super::directions::Offset;
use super::{DIRECTIONS, DirectionSet, Lattice, Uniform};

/// No step to a neighbour is longer than this many layers.
pub(crate) const PADDING_LAYERS: usize = 3;

/// What a sample point is in its cube.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PointKind {
    Centre,
    Corner,
}

/// Sample points row by row, x fastest. The body-centred lattice stacks half-layers in z, centres on even ones and
/// corners on odd ones, all with the row length of the centres; the corners' last row and column are fillers.
#[derive(Debug, Clone)]
pub(crate) struct Layout {
    arrangement: Uniform,
    /// Stored points along each axis.
    grid: [usize; 3],
    /// Step to the neighbour in storage, by kind of point.
    steps: [[isize; DIRECTIONS]; 2],
    /// Directions that have an edge, by kind of point and place along the three axes.
    incident: [[DirectionSet; 27]; 2],
}

/// Where a point lies along an axis: at the low end, at the high end, or between.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Low,
    Inner,
    High,
}

const PLACES: [Place; 3] = [Place::Low, Place::Inner, Place::High];

impl Layout {
    pub(crate) fn new(lattice: &Lattice) -> Self {
        let arrangement = lattice.arrangement().expect_uniform();
        let grid = lattice.stored_grid().map(|n| n as usize);
        let mut layout = Self { arrangement, grid, steps: [[0; DIRECTIONS]; 2], incident: [[0; 27]; 2] };
        for (direction, &offset) in lattice.arrangement().directions().offsets.iter().enumerate() {
            for kind in [PointKind::Centre, PointKind::Corner] {
                layout.steps[kind as usize][direction] = layout.step(kind, offset);
                for (code, set) in layout.incident[kind as usize].iter_mut().enumerate() {
                    let place = [PLACES[code % 3], PLACES[code / 3 % 3], PLACES[code / 9]];
                    if has_edge(arrangement, kind, place, offset) {
                        *set |= 1 << direction;
                    }
                }
            }
        }
        layout
    }

    /// How many points are stored.
    pub(crate) fn len(&self) -> usize {
        self.grid.iter().product()
    }

    /// Points a row, rows a layer, layers.
    pub(crate) fn grid(&self) -> [usize; 3] {
        self.grid
    }

    /// Points of a layer.
    pub(crate) fn layer_len(&self) -> usize {
        self.grid[0] * self.grid[1]
    }

    /// What the points of a layer are.
    pub(crate) fn kind(&self, layer: usize) -> PointKind {
        match self.arrangement {
            Uniform::BodyCentred if layer.is_multiple_of(2) => PointKind::Centre,
            _ => PointKind::Corner,
        }
    }

    /// Points a row and rows a layer that are not fillers.
    pub(crate) fn used(&self, kind: PointKind) -> [usize; 2] {
        let filler = usize::from(self.arrangement == Uniform::BodyCentred && kind == PointKind::Corner);
        [self.grid[0] - filler, self.grid[1] - filler]
    }

    /// Steps in storage to the neighbours of a point.
    pub(crate) fn steps(&self, kind: PointKind) -> &[isize; DIRECTIONS] {
        &self.steps[kind as usize]
    }

    /// Directions in which the point has an edge of the lattice: one that belongs to a tetrahedron. A centre
    /// outside the box on two axes has none.
    pub(crate) fn incident(&self, kind: PointKind, [x, y, z]: [usize; 3]) -> DirectionSet {
        let [nx, ny] = self.used(kind);
        let (z, nz) = match self.arrangement {
            Uniform::SimpleCubic => (z, self.grid[2]),
            Uniform::BodyCentred => (z / 2, (self.grid[2] - 1) / 2 + usize::from(kind == PointKind::Centre)),
        };
        let code = place(x, nx) as usize + 3 * place(y, ny) as usize + 9 * place(z, nz) as usize;
        self.incident[kind as usize][code]
    }

    /// The point that all tetrahedra of a cell share: its centre, or its lowest corner.
    pub(crate) fn base(&self, [x, y, z]: [usize; 3]) -> usize {
        match self.arrangement {
            Uniform::BodyCentred => self.index([x + 1, y + 1, 2 * z + 2]),
            Uniform::SimpleCubic => self.index([x, y, z]),
        }
    }

    /// The kind of [`base`](Self::base).
    pub(crate) fn base_kind(&self) -> PointKind {
        match self.arrangement {
            Uniform::BodyCentred => PointKind::Centre,
            Uniform::SimpleCubic => PointKind::Corner,
        }
    }

    /// The step to a neighbour, apart: points along the row, rows, layers.
    ///
    /// The centre grid is half a cube lower than the corner grid, so that from a centre the corner on the high side
    /// has the centre's own number, and from a corner the centre on the low side has the corner's.
    pub(crate) fn hop(&self, kind: PointKind, [x, y, z]: Offset) -> [isize; 3] {
        let halve = |offset: i8| match kind {
            PointKind::Centre => isize::from(offset).div_euclid(2),
            PointKind::Corner => (isize::from(offset) + 1).div_euclid(2),
        };
        let layers = match self.arrangement {
            Uniform::BodyCentred => isize::from(z),
            Uniform::SimpleCubic => isize::from(z / 2),
        };
        [halve(x), halve(y), layers]
    }

    /// Place in storage of a point.
    pub(crate) fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.grid[1] + y) * self.grid[0] + x
    }

    fn step(&self, kind: PointKind, offset: Offset) -> isize {
        let [x, y, z] = self.hop(kind, offset);
        (z * self.grid[1] as isize + y) * self.grid[0] as isize + x
    }
}

fn place(i: usize, n: usize) -> Place {
    if i == 0 {
        Place::Low
    } else if i + 1 == n {
        Place::High
    } else {
        Place::Inner
    }
}

fn has_edge(arrangement: Uniform, kind: PointKind, place: [Place; 3], offset: Offset) -> bool {
    let outward = |axis: usize| match place[axis] {
        Place::Low => offset[axis] < 0,
        Place::Inner => false,
        Place::High => offset[axis] > 0,
    };
    let leaves = (0..3).filter(|&axis| outward(axis)).count();
    match (arrangement, kind) {
        (Uniform::SimpleCubic, _) => leaves == 0,
        (Uniform::BodyCentred, PointKind::Corner) => {
            // A diagonal may leave through one face, to the layer of centres outside it.
            let diagonal = offset.iter().all(|&o| o != 0);
            leaves <= usize::from(diagonal)
        }
        (Uniform::BodyCentred, PointKind::Centre) => {
            let mut outside = (0..3).filter(|&axis| place[axis] != Place::Inner);
            match (outside.next(), outside.next()) {
                (None, _) => true,
                // From outside the box, edges lead into it only.
                (Some(axis), None) => offset[axis] != 0 && !outward(axis),
                _ => false,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Arrangement, members};
    use glam::Vec3;
    use isostudy_mesh::Bounds;

    fn lattice(arrangement: Arrangement, cells: [f32; 3]) -> Lattice {
        let bounds = Bounds { min: Vec3::ZERO, max: Vec3::from_array(cells) };
        Lattice::try_new(arrangement, bounds, 1.0).unwrap()
    }

    /// Walks every point and edge and compares with the formulas.
    #[test]
    fn incident_sets_are_the_needed_points_and_edges() {
        for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
            for cells in [[1.0, 1.0, 1.0], [4.0, 3.0, 5.0], [1.0, 2.0, 1.0]] {
                let lattice = lattice(arrangement, cells);
                let layout = Layout::new(&lattice);
                let opposite = &arrangement.directions().opposite;
                let mut sets = vec![0; layout.len()];
                for z in 0..layout.grid()[2] {
                    let kind = layout.kind(z);
                    let [nx, ny] = layout.used(kind);
                    for (y, x) in (0..ny).flat_map(|y| (0..nx).map(move |x| (y, x))) {
                        sets[layout.index([x, y, z])] = layout.incident(kind, [x, y, z]);
                    }
                }
                for (i, &set) in sets.iter().enumerate() {
                    let kind = layout.kind(i / layout.layer_len());
                    for direction in members(set) {
                        let neighbour = i.checked_add_signed(layout.steps(kind)[direction]).unwrap();
                        let back = sets[neighbour] >> opposite[direction] & 1;
                        assert_eq!(back, 1, "{arrangement:?} {cells:?} point {i} direction {direction}");
                    }
                }
                let points = sets.iter().filter(|&&set| set != 0).count() as u64;
                let edges: u64 = sets.iter().map(|set| u64::from(set.count_ones())).sum();
                assert_eq!(points, lattice.needed_samples(), "{arrangement:?} {cells:?} points");
                assert_eq!(edges, 2 * lattice.needed_edges(), "{arrangement:?} {cells:?} edges");
            }
        }
    }
}
