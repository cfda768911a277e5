//! The fourteen directions of a lattice edge and how they link up.
//!
//! Both lattices are one combinatorial object: the linear map (1,0,0) -> (-1,1,1)/2, (0,1,0) -> (1,-1,1)/2,
//! (0,0,1) -> (1,1,-1)/2 takes the six tetrahedra of a cube to those of the body-centred lattice. So everything
//! here follows from the offsets; only their order, which fixes vertex numbering, is each arrangement's own.

use super::{Arrangement, Uniform};

/// How many lattice edges meet at an interior point.
pub(crate) const DIRECTIONS: usize = 14;

/// A set of directions, one bit each.
pub(crate) type DirectionSet = u16;

/// An offset in half cells.
pub(crate) type Offset = [i8; 3];

/// All of them.
pub(crate) const ALL_DIRECTIONS: DirectionSet = (1 << DIRECTIONS) - 1;

/// The directions of one arrangement.
#[derive(Debug)]
pub(crate) struct Directions {
    /// To the neighbour, in half cells. The order is the original program's (Costen 2026): vertices are numbered
    /// in it, and the edge collapse walks edges by vertex number.
    pub(crate) offsets: [Offset; DIRECTIONS],
    /// Back again.
    pub(crate) opposite: [u8; DIRECTIONS],
    /// Directions whose far ends are lattice neighbours of this one's: the two edges share a tetrahedron face.
    pub(crate) links: [DirectionSet; DIRECTIONS],
}

impl Arrangement {
    /// The directions of this arrangement, which is a uniform one.
    pub(crate) fn directions(self) -> &'static Directions {
        match self.expect_uniform() {
            Uniform::BodyCentred => &BODY_CENTRED,
            Uniform::SimpleCubic => &SIMPLE_CUBIC,
        }
    }
}

static BODY_CENTRED: Directions = Directions::new([
    [2, 0, 0],
    [-2, 0, 0],
    [0, 2, 0],
    [0, -2, 0],
    [0, 0, 2],
    [0, 0, -2],
    [1, 1, 1],
    [-1, 1, 1],
    [1, -1, 1],
    [-1, -1, 1],
    [1, 1, -1],
    [-1, 1, -1],
    [1, -1, -1],
    [-1, -1, -1],
]);

static SIMPLE_CUBIC: Directions = Directions::new([
    [2, 0, 0],
    [-2, 0, 0],
    [0, 2, 0],
    [0, -2, 0],
    [0, 0, 2],
    [0, 0, -2],
    [2, 2, 0],
    [-2, -2, 0],
    [2, 0, 2],
    [-2, 0, -2],
    [0, 2, 2],
    [0, -2, -2],
    [2, 2, 2],
    [-2, -2, -2],
]);

impl Directions {
    const fn new(offsets: [Offset; DIRECTIONS]) -> Self {
        let mut opposite = [0; DIRECTIONS];
        let mut links = [0; DIRECTIONS];
        let mut a = 0;
        while a < DIRECTIONS {
            match find(&offsets, difference([0; 3], offsets[a])) {
                Some(back) => opposite[a] = back,
                None => panic!("every direction has an opposite"),
            }
            let mut b = 0;
            while b < DIRECTIONS {
                if find(&offsets, difference(offsets[b], offsets[a])).is_some() {
                    links[a] |= 1 << b;
                }
                b += 1;
            }
            a += 1;
        }
        Self { offsets, opposite, links }
    }

    /// The direction from the far end of `a` to the far end of `b`.
    pub(crate) fn between(&self, a: u8, b: u8) -> Option<u8> {
        find(&self.offsets, difference(self.offsets[b as usize], self.offsets[a as usize]))
    }

    /// Of simple cubic directions, each one's number on the body-centred lattice, by the linear map.
    pub(crate) fn in_body_centred(&self) -> [u8; DIRECTIONS] {
        self.offsets.map(|[x, y, z]| {
            let image = [(y + z - x) / 2, (x + z - y) / 2, (x + y - z) / 2];
            find(&BODY_CENTRED.offsets, image).expect("the map takes neighbours to neighbours")
        })
    }

    /// Whether the neighbour in this direction is stored later than the point.
    pub(crate) fn is_forward(&self, direction: u8) -> bool {
        let [x, y, z] = self.offsets[direction as usize];
        (z, y, x) > (0, 0, 0)
    }
}

/// The members of a set, in direction order.
pub(crate) fn members(mut set: DirectionSet) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let first = set.trailing_zeros() as usize;
        (set != 0).then(|| {
            set &= set - 1;
            first
        })
    })
}

const fn difference(a: Offset, b: Offset) -> Offset {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

const fn find(offsets: &[Offset; DIRECTIONS], wanted: Offset) -> Option<u8> {
    let mut i = 0;
    while i < DIRECTIONS {
        let offset = offsets[i];
        if offset[0] == wanted[0] && offset[1] == wanted[1] && offset[2] == wanted[2] {
            return Some(i as u8);
        }
        i += 1;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: [Arrangement; 2] = [Arrangement::BodyCentred, Arrangement::SimpleCubic];

    #[test]
    fn link_graph_is_the_tetrakis_cube() {
        for arrangement in BOTH {
            let links = &arrangement.directions().links;
            let count: u32 = links.iter().map(|set| set.count_ones()).sum();
            assert_eq!(count, 2 * 36, "{arrangement:?} edges");
            let mut degrees: Vec<u32> = links.iter().map(|set| set.count_ones()).collect();
            degrees.sort_unstable();
            assert_eq!(degrees, [[4; 6].as_slice(), [6; 8].as_slice()].concat());
            let triangles: u32 = (0..DIRECTIONS)
                .flat_map(|a| members(links[a]).map(move |b| (links[a] & links[b]).count_ones()))
                .sum();
            assert_eq!(triangles, 6 * 24, "{arrangement:?} triangles");
        }
    }

    #[test]
    fn links_go_both_ways_and_opposites_undo() {
        for arrangement in BOTH {
            let directions = arrangement.directions();
            for a in 0..DIRECTIONS {
                assert_eq!(directions.opposite[directions.opposite[a] as usize] as usize, a);
                assert_eq!(directions.links[a] >> a & 1, 0, "no direction links to itself");
                assert_ne!(directions.is_forward(a as u8), directions.is_forward(directions.opposite[a]));
                for b in members(directions.links[a]) {
                    assert_eq!(directions.links[b] >> a & 1, 1);
                    assert!(directions.between(a as u8, b as u8).is_some());
                }
            }
        }
    }

    #[test]
    fn the_linear_map_takes_one_lattice_to_the_other() {
        let simple = Arrangement::SimpleCubic.directions();
        let body = Arrangement::BodyCentred.directions();
        let map = simple.in_body_centred().map(usize::from);
        for a in 0..DIRECTIONS {
            let mapped = members(simple.links[a]).fold(0, |set, b| set | 1 << map[b]);
            assert_eq!(mapped, body.links[map[a]], "links of {:?}", simple.offsets[a]);
        }
    }
}
