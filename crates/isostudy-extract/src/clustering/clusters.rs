//! Which crossings near a sample point become one vertex.
//!
//! A sample point sees a set of near crossings, by direction. Two are adjacent when their edges share a tetrahedron
//! face. Connected components of that graph are islands; an island that is a disc on the sphere of directions can
//! become one vertex. The published rules below look at the number of crossings and at the holes between them; they
//! do not always keep the surface manifold. The `guard` module's do.

use crate::clustering::guard::Partition;
use crate::lattice::{ALL_DIRECTIONS as ALL, DIRECTIONS, DirectionSet, Directions, members};

/// From this many near crossings on, none are merged. Costen's text says more than 10, the program 12 or more; on
/// the evaluation's asteroid the results are the same.
const CROWDED: u32 = 12;

/// A partition of the near crossings of a sample point: one vertex a cluster, in order of the first direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Clusters {
    sets: [DirectionSet; DIRECTIONS],
    len: usize,
}

impl Clusters {
    /// Every crossing its own vertex.
    pub(crate) fn single(near: DirectionSet) -> Self {
        let mut clusters = Self::none();
        let mut rest = near;
        while rest != 0 {
            clusters.push(rest & rest.wrapping_neg());
            rest &= rest - 1;
        }
        clusters
    }

    /// Integrated clustering by the rules of Costen (2026), in their order.
    pub(crate) fn integrated(near: DirectionSet, directions: &Directions) -> Self {
        let count = near.count_ones();
        if count <= 1 || count >= CROWDED {
            return Self::single(near);
        }
        let most_adjacent = members(near).map(|d| (directions.links[d] & near).count_ones()).max();
        match most_adjacent {
            None | Some(0) => Self::single(near),
            // One crossing touches all others: this comes before the test for loops.
            Some(most) if most == count - 1 => Self::none().with(near),
            // The far crossings fall apart: the near ones enclose some of them, a loop.
            _ if Self::islands(ALL & !near, directions).len > 1 => Self::single(near),
            _ => Self::islands(near, directions),
        }
    }

    /// All crossings one vertex; none if there are none.
    pub(crate) fn whole(near: DirectionSet) -> Self {
        if near == 0 { Self::none() } else { Self::none().with(near) }
    }

    /// By cluster number.
    pub(crate) fn from_partition(partition: &Partition) -> Self {
        let mut clusters = Self { sets: [0; DIRECTIONS], len: usize::from(partition.count) };
        for (direction, &cluster) in partition.of.iter().enumerate() {
            if cluster != Partition::NONE {
                clusters.sets[usize::from(cluster)] |= 1 << direction;
            }
        }
        clusters
    }

    /// The clusters, each a set of directions.
    pub(crate) fn sets(&self) -> &[DirectionSet] {
        &self.sets[..self.len]
    }

    /// Connected components of `set` among adjacent directions.
    pub(crate) fn islands(set: DirectionSet, directions: &Directions) -> Self {
        let mut islands = Self::none();
        let mut rest = set;
        while rest != 0 {
            let mut island = 0;
            let mut frontier = rest & rest.wrapping_neg();
            while frontier != 0 {
                let direction = frontier.trailing_zeros() as usize;
                island |= 1 << direction;
                frontier = (frontier | directions.links[direction] & set) & !island;
            }
            islands.push(island);
            rest &= !island;
        }
        islands
    }

    fn none() -> Self {
        Self { sets: [0; DIRECTIONS], len: 0 }
    }

    fn with(mut self, set: DirectionSet) -> Self {
        self.push(set);
        self
    }

    fn push(&mut self, set: DirectionSet) {
        self.sets[self.len] = set;
        self.len += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Arrangement;

    fn set(directions: &Directions, offsets: &[[i8; 3]]) -> DirectionSet {
        offsets.iter().fold(0, |set, wanted| {
            set | 1 << directions.offsets.iter().position(|offset| offset == wanted).unwrap()
        })
    }

    #[test]
    fn every_set_is_partitioned_in_order() {
        for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
            for near in 0..=ALL {
                let clusters = Clusters::integrated(near, arrangement.directions());
                let union = clusters.sets().iter().fold(0, |union, set| {
                    assert_eq!(union & set, 0, "{near:014b} overlaps");
                    union | set
                });
                assert_eq!(union, near);
                assert!(clusters.sets().is_sorted_by_key(|set| set.trailing_zeros()));
                assert!(clusters.sets().iter().all(|&set| set != 0));
            }
        }
    }

    #[test]
    fn island_counts_are_those_of_the_sphere_of_directions() {
        // Counted independently for the manifold guard: masks of 14 directions by number of islands.
        for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
            let mut masks = [0; 7];
            for near in 0..=ALL {
                masks[Clusters::islands(near, arrangement.directions()).len] += 1;
            }
            assert_eq!(masks, [1, 11_890, 3_733, 672, 81, 6, 1], "{arrangement:?}");
        }
    }

    #[test]
    fn rules_apply_in_their_order() {
        let body = Arrangement::BodyCentred.directions();
        let count = |offsets: &[[i8; 3]]| Clusters::integrated(set(body, offsets), body).sets().len();
        let far_apart = [[2, 0, 0], [-2, 0, 0], [0, 2, 0]];
        assert_eq!(count(&far_apart), 3, "no adjacent pair");
        let star = [[1, 1, 1], [2, 0, 0], [0, 2, 0], [0, 0, 2]];
        assert_eq!(count(&star), 1, "one direction touches all others");
        let belt = [[1, 1, 1], [1, -1, 1], [1, -1, -1], [1, 1, -1], [0, 0, 2]];
        assert_eq!(count(&belt), 5, "a ring that encloses +x");
        let cap = [[1, 1, 1], [1, -1, 1], [1, -1, -1], [1, 1, -1], [2, 0, 0]];
        assert_eq!(count(&cap), 1, "the same ring, filled");
        let two = [[1, 1, 1], [2, 0, 0], [-1, -1, -1], [-2, 0, 0]];
        assert_eq!(count(&two), 2, "two islands");
        assert_eq!(Clusters::integrated(ALL >> 2, body).sets().len(), 12, "crowded");
        assert_eq!(Clusters::integrated(ALL >> 3, body).sets().len(), 1, "eleven in one island");
    }
}
