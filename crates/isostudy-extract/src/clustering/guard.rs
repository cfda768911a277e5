//! Which crossings may share a vertex so that the surface stays a manifold, whatever the samples.
//!
//! The rule looks at one lattice point: its crossings, those of them that are near, and the lattice edges it has.
//! Near crossings fall into islands on the link (`link.rs`). An island that is *strict* becomes one vertex; of any
//! other the largest strict part that is safe, its *core*, becomes one and the rest stays apart. A lattice edge
//! between two points of one side with the whole ring round it on the other side is a *thread*: it may not be in
//! clusters at both its ends, so the end that sees it in a positive direction gives way.
//!
//! Nothing here depends on how nearness was decided, as long as every crossing is near exactly one end. Why the
//! rule suffices, inside and at the volume's boundary, is in docs/manifold.md.

mod link;
mod shapes;

#[cfg(test)]
mod tests;

use std::sync::OnceLock;

use crate::lattice::{ALL_DIRECTIONS, Arrangement, DIRECTIONS, DirectionSet, Uniform, members};
use link::Link;

/// The tables of one arrangement. Sets of directions are in the order of its `Directions`.
#[derive(Debug)]
pub(crate) struct Guard {
    /// Sorted by present directions; the whole sphere is the last.
    links: Vec<Link>,
    /// By near crossings.
    classes: Box<[Class]>,
    /// By crossings, one bit each: whether any positive direction is a thread.
    threads: Box<[u64]>,
    /// One of each pair of opposite directions: the same seven lattice edges on both lattices.
    positive: DirectionSet,
    /// Each direction's number on the body-centred lattice, through the linear map that makes the two one.
    canonical: [u8; DIRECTIONS],
}

/// What the near crossings of a point inside the volume become.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Class {
    /// There are none.
    Empty,
    /// One vertex.
    One,
    /// [`Guard::partition`] tells.
    Ask,
}

/// The near crossings of a point, shared out to vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Partition {
    /// How many vertices.
    pub(crate) count: u8,
    /// By direction, the vertex, in order of its first direction; [`Partition::NONE`] where no crossing is near.
    pub(crate) of: [u8; DIRECTIONS],
}

impl Partition {
    /// No near crossing in this direction.
    pub(crate) const NONE: u8 = u8::MAX;
}

impl Guard {
    /// The tables, made on first use.
    pub(crate) fn get(arrangement: Arrangement) -> &'static Self {
        static BODY_CENTRED: OnceLock<Guard> = OnceLock::new();
        static SIMPLE_CUBIC: OnceLock<Guard> = OnceLock::new();
        let guard = match arrangement.expect_uniform() {
            Uniform::BodyCentred => &BODY_CENTRED,
            Uniform::SimpleCubic => &SIMPLE_CUBIC,
        };
        guard.get_or_init(|| Self::new(arrangement))
    }

    fn new(arrangement: Arrangement) -> Self {
        let directions = arrangement.directions();
        let simple = Arrangement::SimpleCubic.directions();
        let canonical = match arrangement.expect_uniform() {
            Uniform::BodyCentred => std::array::from_fn(|d| d as u8),
            Uniform::SimpleCubic => simple.in_body_centred(),
        };
        let positive_simple = (0..DIRECTIONS).filter(|&d| simple.is_forward(d as u8));
        let positive = positive_simple.fold(0, |set, d| {
            let canonical_positive = simple.in_body_centred()[d];
            set | 1 << canonical.iter().position(|&c| c == canonical_positive).expect("a permutation")
        });
        debug_assert!(members(positive).all(|d| positive >> directions.opposite[d] & 1 == 0));
        let mut guard = Self {
            links: shapes::links(arrangement),
            classes: Box::default(),
            threads: Box::default(),
            positive,
            canonical,
        };
        guard.classes = (0..1 << DIRECTIONS).map(|near| guard.class_of_near(near)).collect();
        guard.threads = vec![0; (1 << DIRECTIONS) / 64].into_boxed_slice();
        for crossing in 0..1u16 << DIRECTIONS {
            let blocked = guard.blocked(guard.sphere(), crossing) != 0;
            guard.threads[usize::from(crossing / 64)] |= u64::from(blocked) << (crossing % 64);
        }
        guard
    }

    /// Makes the tables that are made otherwise when a point first needs them.
    pub(crate) fn complete(&self) {
        self.links.iter().for_each(|link| link.complete(|set| self.rank(set)));
    }

    /// What becomes of the near crossings of a point that has all fourteen lattice edges: two loads.
    #[inline]
    pub(crate) fn class(&self, crossing: DirectionSet, near: DirectionSet) -> Class {
        match self.classes[usize::from(near)] {
            Class::One if self.has_thread(crossing) => Class::Ask,
            class => class,
        }
    }

    /// What becomes of the near crossings of a point that has the lattice edges `present`.
    ///
    /// # Panics
    /// If something is near and `present` are not the lattice edges of any point of the arrangement.
    pub(crate) fn partition(
        &self,
        crossing: DirectionSet,
        near: DirectionSet,
        present: DirectionSet,
    ) -> Partition {
        let mut partition = Partition { count: 0, of: [Partition::NONE; DIRECTIONS] };
        if near == 0 {
            return partition;
        }
        let link = self.link(present);
        let blocked = self.blocked(link, crossing);
        let mut cores = [0; DIRECTIONS];
        for island in link.islands(near) {
            if let Some(core) = self.core(link, island, blocked, crossing) {
                cores[core.trailing_zeros() as usize] = core;
            }
        }
        for first in members(near) {
            if partition.of[first] == Partition::NONE {
                for direction in members(cores[first] | 1 << first) {
                    partition.of[direction] = partition.count;
                }
                partition.count += 1;
            }
        }
        partition
    }

    /// The part of an island that becomes one vertex.
    fn core(
        &self,
        link: &Link,
        island: DirectionSet,
        blocked: DirectionSet,
        crossing: DirectionSet,
    ) -> Option<DirectionSet> {
        let rank = |set| self.rank(set);
        if island.count_ones() == 1 || island & blocked == 0 && link.has_strict(island, rank) {
            return Some(island);
        }
        link.core(island, blocked, crossing, rank)
    }

    /// The rings of all threads in positive directions. A ring through the boundary is never whole.
    fn blocked(&self, link: &Link, crossing: DirectionSet) -> DirectionSet {
        members(self.positive & link.present() & !crossing)
            .map(|direction| link.ring(direction))
            .filter(|ring| ring & !crossing == 0)
            .fold(0, |blocked, ring| blocked | ring)
    }

    #[inline]
    fn has_thread(&self, crossing: DirectionSet) -> bool {
        self.threads[usize::from(crossing / 64)] >> (crossing % 64) & 1 == 1
    }

    fn class_of_near(&self, near: DirectionSet) -> Class {
        match near.count_ones() {
            0 => Class::Empty,
            1 => Class::One,
            _ if self.sphere().has_strict(near, |set| self.rank(set)) => Class::One,
            _ => Class::Ask,
        }
    }

    fn sphere(&self) -> &Link {
        self.link(ALL_DIRECTIONS)
    }

    fn link(&self, present: DirectionSet) -> &Link {
        let place = self.links.binary_search_by_key(&present, Link::present);
        &self.links[place.expect("a point has the lattice edges of its place")]
    }

    /// Orders sets of one size, alike on both lattices.
    fn rank(&self, set: DirectionSet) -> u16 {
        members(set).fold(0, |rank, direction| rank | 1 << self.canonical[direction])
    }
}
