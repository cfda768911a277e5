//! Which near crossings become one vertex: the one place where a clustering rule plugs in.

use std::sync::OnceLock;

use crate::clustering::clusters::Clusters;
use crate::clustering::guard::{Class, Guard};
use crate::lattice::{ALL_DIRECTIONS, Arrangement, DIRECTIONS, DirectionSet, Directions};
use crate::tetrahedra::ties::Ties;

/// A rule that sees one point: its crossing edges, those nearer to it, and those that belong to the lattice.
pub(super) trait ClusterRule: Sync {
    /// Which end a crossing in the middle of its edge is near to.
    const TIES: Ties;

    /// Whether all near crossings surely are one vertex. A table look-up: `false` only sends the point to
    /// [`partition`](Self::partition). Asked with at least one near crossing.
    fn is_one(&self, crossing: DirectionSet, near: DirectionSet, present: DirectionSet) -> bool;

    /// The clusters, in order of their first direction.
    fn partition(&self, crossing: DirectionSet, near: DirectionSet, present: DirectionSet) -> Clusters;
}

/// Every crossing its own vertex; as published, one in the middle of its edge has two.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unclustered<const PUBLISHED: bool>;

impl<const PUBLISHED: bool> ClusterRule for Unclustered<PUBLISHED> {
    const TIES: Ties = if PUBLISHED { Ties::BothEnds } else { Ties::InsideEnd };

    #[inline(always)]
    fn is_one(&self, _: DirectionSet, near: DirectionSet, _: DirectionSet) -> bool {
        near & (near - 1) == 0
    }

    fn partition(&self, _: DirectionSet, near: DirectionSet, _: DirectionSet) -> Clusters {
        Clusters::single(near)
    }
}

/// The published rules, which look at the near crossings only.
#[derive(Debug, Clone, Copy)]
pub(super) struct Published {
    directions: &'static Directions,
    one: &'static [bool; 1 << DIRECTIONS],
}

impl Published {
    pub(super) fn new(arrangement: Arrangement) -> Self {
        static TABLES: [OnceLock<Box<[bool; 1 << DIRECTIONS]>>; 2] = [OnceLock::new(), OnceLock::new()];
        let directions = arrangement.directions();
        let one = TABLES[arrangement as usize].get_or_init(|| {
            let mut table = Box::new([false; 1 << DIRECTIONS]);
            for (near, one) in table.iter_mut().enumerate() {
                *one = Clusters::integrated(near as DirectionSet, directions).sets().len() == 1;
            }
            table
        });
        Self { directions, one }
    }
}

impl ClusterRule for Published {
    const TIES: Ties = Ties::BothEnds;

    #[inline(always)]
    fn is_one(&self, _: DirectionSet, near: DirectionSet, _: DirectionSet) -> bool {
        self.one[usize::from(near) % self.one.len()]
    }

    fn partition(&self, _: DirectionSet, near: DirectionSet, _: DirectionSet) -> Clusters {
        Clusters::integrated(near, self.directions)
    }
}

/// The rules that keep the surface a manifold, which look at the place in the box and at the far crossings too.
#[derive(Debug, Clone, Copy)]
pub(super) struct Guarded(&'static Guard);

impl Guarded {
    pub(super) fn new(arrangement: Arrangement) -> Self {
        Self(Guard::get(arrangement))
    }
}

impl ClusterRule for Guarded {
    const TIES: Ties = Ties::InsideEnd;

    #[inline(always)]
    fn is_one(&self, crossing: DirectionSet, near: DirectionSet, present: DirectionSet) -> bool {
        if present == ALL_DIRECTIONS {
            self.0.class(crossing, near) == Class::One
        } else {
            near & (near - 1) == 0
        }
    }

    fn partition(&self, crossing: DirectionSet, near: DirectionSet, present: DirectionSet) -> Clusters {
        Clusters::from_partition(&self.0.partition(crossing, near, present))
    }
}
