//! The sphere of directions round a lattice point, and which sets on it may become one vertex.

use std::cmp::Reverse;
use std::sync::OnceLock;

use crate::lattice::{DIRECTIONS, DirectionSet, members};

/// Stands for everything beyond the volume, on the link of a point at its boundary: joined to all directions along
/// the boundary, so that the disc of directions becomes a sphere. Never in a set that is asked about.
pub(super) const BEYOND: u8 = DIRECTIONS as u8;
const BEYOND_SET: u16 = 1 << BEYOND;
const NODES: usize = DIRECTIONS + 1;
const NOBODY: u8 = u8::MAX;

/// The link of a lattice point: its directions, joined where two lattice edges share a triangle, with a triangle
/// where three share a tetrahedron. Always a triangulated sphere, with the help of [`BEYOND`] at the boundary.
#[derive(Debug)]
pub(super) struct Link {
    /// Directions that have a lattice edge.
    present: DirectionSet,
    /// All nodes: the same, and [`BEYOND`] at the boundary of the volume.
    nodes: u16,
    /// The nodes joined to a node.
    around: [u16; NODES],
    /// `next[w][u]` follows `u` in the ring round `w`.
    next: [[u8; NODES]; NODES],
    /// Made when first asked for: most links at the boundary are never needed.
    strict: OnceLock<StrictSets>,
}

#[derive(Debug)]
struct StrictSets {
    /// Larger sets first.
    in_order: Vec<DirectionSet>,
    /// One bit a set.
    member: Box<[u64]>,
}

impl Link {
    /// From the triangles, each with its corners in the same turning sense.
    pub(super) fn new(triangles: &[[u8; 3]]) -> Self {
        let mut link = Self {
            present: 0,
            nodes: 0,
            around: [0; NODES],
            next: [[NOBODY; NODES]; NODES],
            strict: OnceLock::new(),
        };
        for &triangle in triangles {
            link.add(triangle);
        }
        link.present = link.nodes;
        // Sides with a triangle on one side only run along the boundary of the volume.
        let open: Vec<[u8; 2]> = triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .filter(|&[a, b]| link.next[b as usize][a as usize] == NOBODY)
            .collect();
        for [a, b] in open {
            link.add([b, a, BEYOND]);
        }
        link
    }

    fn add(&mut self, triangle: [u8; 3]) {
        for k in 0..3 {
            let [w, u, v] = [0, 1, 2].map(|i| triangle[(k + i) % 3] as usize);
            self.nodes |= 1 << w;
            self.around[w] |= 1 << u | 1 << v;
            self.next[w][u] = v as u8;
        }
    }

    pub(super) fn present(&self) -> DirectionSet {
        self.present
    }

    /// The ring round the lattice edge in `direction`, as a set.
    pub(super) fn ring(&self, direction: usize) -> u16 {
        self.around[direction]
    }

    /// Connected components.
    pub(super) fn islands(&self, set: u16) -> impl Iterator<Item = u16> + '_ {
        let mut rest = set;
        std::iter::from_fn(move || {
            (rest != 0).then(|| {
                let island = self.island_of_lowest(rest);
                rest &= !island;
                island
            })
        })
    }

    fn island_of_lowest(&self, set: u16) -> u16 {
        let mut island = 0;
        let mut frontier = set & set.wrapping_neg();
        while frontier != 0 {
            let node = frontier.trailing_zeros() as usize;
            island |= 1 << node;
            frontier = (frontier | self.around[node] & set) & !island;
        }
        island
    }

    fn is_connected(&self, set: u16) -> bool {
        set != 0 && self.island_of_lowest(set) == set
    }

    /// Whether `set` may become one vertex: it has two members or more and
    ///
    /// - (a) it is connected;
    /// - (b) so is the rest, which has at least three nodes;
    /// - (c) round every node of the rest it covers nothing or one arc, never the whole ring.
    pub(super) fn is_strict(&self, set: DirectionSet) -> bool {
        let rest = self.nodes & !set;
        set.count_ones() >= 2
            && rest.count_ones() >= 3
            && self.is_connected(set)
            && self.is_connected(rest)
            && members(rest).all(|w| self.covers_one_arc(set, w))
    }

    fn covers_one_arc(&self, set: DirectionSet, w: usize) -> bool {
        let covered = set & self.around[w];
        let ends = members(covered).filter(|&u| set >> self.next[w][u] & 1 == 0).count();
        // No end is a whole ring.
        covered == 0 || ends == 1
    }

    /// Looks [`is_strict`](Self::is_strict) up.
    pub(super) fn has_strict(&self, set: DirectionSet, rank: impl Fn(DirectionSet) -> u16) -> bool {
        self.strict(rank).member[usize::from(set / 64)] >> (set % 64) & 1 == 1
    }

    /// The largest strict part of `island` that avoids `blocked` and leaves nobody walled in: (d) each crossing left
    /// out sees another crossing, or the boundary, on its ring. Ties go to the lower `rank`.
    pub(super) fn core(
        &self,
        island: DirectionSet,
        blocked: DirectionSet,
        crossing: DirectionSet,
        rank: impl Fn(DirectionSet) -> u16,
    ) -> Option<DirectionSet> {
        let free = island & !blocked;
        let not_walled_in = |core: DirectionSet| {
            let visible = (crossing | BEYOND_SET) & !core;
            members(island & !core).all(|w| self.around[w] & visible != 0)
        };
        self.strict(rank).in_order.iter().copied().find(|&core| core & !free == 0 && not_walled_in(core))
    }

    /// Makes the table that is made otherwise at first use.
    pub(super) fn complete(&self, rank: impl Fn(DirectionSet) -> u16) {
        self.strict(rank);
    }

    /// `rank` breaks ties between sets of one size.
    fn strict(&self, rank: impl Fn(DirectionSet) -> u16) -> &StrictSets {
        self.strict.get_or_init(|| {
            let mut in_order: Vec<_> =
                (0..1 << DIRECTIONS).filter(|set| set & !self.present == 0 && self.is_strict(*set)).collect();
            in_order.sort_by_cached_key(|&set| (Reverse(set.count_ones()), rank(set)));
            let mut member = vec![0; (1 << DIRECTIONS) / 64].into_boxed_slice();
            for &set in &in_order {
                member[usize::from(set / 64)] |= 1 << (set % 64);
            }
            StrictSets { in_order, member }
        })
    }

    #[cfg(test)]
    pub(super) fn strict_sets(&self) -> Vec<DirectionSet> {
        (0..1 << DIRECTIONS).filter(|set| set & !self.present == 0 && self.is_strict(*set)).collect()
    }

    #[cfg(test)]
    pub(super) fn is_connected_for_tests(&self, set: u16) -> bool {
        self.is_connected(set)
    }

    #[cfg(test)]
    pub(super) fn nodes(&self) -> u16 {
        self.nodes
    }

    /// The ring round a node, in order, from its lowest member; [`BEYOND`] included.
    #[cfg(test)]
    pub(super) fn ring_in_order(&self, w: usize) -> Vec<u8> {
        let first = self.around[w].trailing_zeros() as u8;
        let mut ring = vec![first];
        loop {
            let next = self.next[w][*ring.last().unwrap() as usize];
            if next == first || ring.len() > NODES {
                return ring;
            }
            ring.push(next);
        }
    }
}
