//! What the vertex pass leaves at every point with a crossing for the triangle pass: eight bytes.

use std::collections::TryReserveError;

use super::grid::UniformGrid;
use crate::clustering::clusters::Clusters;
use crate::lattice::{DIRECTIONS, DirectionSet, members};
use crate::memory::refill;

const ALL: u64 = (1 << DIRECTIONS) - 1;
const NEAR: u32 = 32;
const CROSSING: u32 = NEAR + DIRECTIONS as u32;
const INSIDE: u32 = CROSSING + DIRECTIONS as u32;
const NUMBERING: u32 = INSIDE + 1;

/// Lists of a layer for which there is room from the start.
const MOST_LISTS: usize = 1024;

/// How the near crossings of a point are numbered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u64)]
pub(super) enum Numbering {
    /// All have the first vertex.
    One = 0,
    /// Each has its own, in direction order.
    Ranked = 1,
    /// As a list says; `first` is the place in it.
    Listed = 2,
}

/// `first` vertex, near and crossing edges, side and numbering of a point.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Record(u64);

impl Record {
    #[inline]
    pub(super) fn new(
        first: u32,
        near: DirectionSet,
        crossing: DirectionSet,
        inside: bool,
        numbering: Numbering,
    ) -> Self {
        Self(
            u64::from(first)
                | u64::from(near) << NEAR
                | u64::from(crossing) << CROSSING
                | u64::from(inside) << INSIDE
                | (numbering as u64) << NUMBERING,
        )
    }

    #[inline]
    pub(super) fn first(self) -> u32 {
        self.0 as u32
    }

    #[inline]
    pub(super) fn near(self) -> DirectionSet {
        (self.0 >> NEAR & ALL) as DirectionSet
    }

    #[inline]
    pub(super) fn crossing(self) -> DirectionSet {
        (self.0 >> CROSSING & ALL) as DirectionSet
    }

    #[inline]
    pub(super) fn inside(self) -> bool {
        self.0 >> INSIDE & 1 != 0
    }

    /// Whether all near crossings have the first vertex. Of several records, whether that holds for all: their
    /// numbering bits may be combined first.
    #[inline]
    pub(super) fn is_one(self) -> bool {
        self.0 >> NUMBERING == 0
    }

    /// Whether the crossing in a direction is this end's.
    #[inline]
    pub(super) fn owns(self, direction: u8) -> usize {
        (self.0 >> (NEAR + u32::from(direction)) & 1) as usize
    }

    /// The bits of either, for [`is_one`](Self::is_one).
    #[inline]
    pub(super) fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// Vertex numbers of a point whose crossings are partly merged: four bits a direction, added to `first`.
#[derive(Debug, Clone, Copy)]
struct List {
    first: u32,
    numbers: u64,
}

/// A ring of layers. Records are written and read only where a point has a crossing, so nothing is ever cleared but
/// the bits that tell where that is.
#[derive(Debug, Default)]
pub(super) struct Records {
    records: Vec<Record>,
    active: Vec<u64>,
    lists: Vec<Vec<List>>,
    size: [usize; 2],
    words: usize,
    slots: usize,
}

impl Records {
    pub(super) fn fit(&mut self, grid: &UniformGrid) -> Result<(), TryReserveError> {
        (self.size, self.words, self.slots) = ([grid.size[0], grid.size[1]], grid.words, grid.slots());
        refill(&mut self.records, grid.layer_len() * self.slots, Record::default())?;
        refill(&mut self.active, self.words * self.size[1] * self.slots, 0)?;
        self.lists.resize_with(self.slots, Vec::new);
        // Few points of a layer have one: room for more than they take, so that a window that moves need not ask for it.
        let room = (grid.layer_len() / 4).min(MOST_LISTS);
        self.lists.iter_mut().try_for_each(|lists| lists.try_reserve_exact(room.saturating_sub(lists.len())))
    }

    /// Forgets what was in the slot of a layer.
    pub(super) fn open_layer(&mut self, layer: usize) {
        let slot = layer % self.slots;
        let len = self.words * self.size[1];
        self.active[slot * len..(slot + 1) * len].fill(0);
        self.lists[slot].clear();
    }

    /// Where the records of a row start.
    #[inline]
    pub(super) fn row_start(&self, row: usize, layer: usize) -> usize {
        (layer % self.slots * self.size[1] + row) * self.size[0]
    }

    #[inline]
    pub(super) fn at(&self, place: usize) -> Record {
        self.records[place]
    }

    #[inline]
    pub(super) fn set(&mut self, place: usize, record: Record) {
        self.records[place] = record;
    }

    #[inline]
    fn active_start(&self, row: usize, layer: usize) -> usize {
        (layer % self.slots * self.size[1] + row) * self.words
    }

    #[inline]
    pub(super) fn set_active(&mut self, row: usize, layer: usize, word: usize, bits: u64) {
        let start = self.active_start(row, layer);
        self.active[start + word] = bits;
    }

    #[inline]
    pub(super) fn active(&self, row: usize, layer: usize) -> &[u64] {
        let start = self.active_start(row, layer);
        &self.active[start..start + self.words]
    }

    /// Makes room for the partitions of so many points.
    #[inline]
    pub(super) fn reserve_lists(&mut self, layer: usize, points: usize) -> Result<(), TryReserveError> {
        self.lists[layer % self.slots].try_reserve(points)
    }

    /// Stores a partition, for which there is room; returns its place.
    pub(super) fn list(&mut self, layer: usize, first: u32, clusters: &Clusters) -> u32 {
        let mut numbers = 0;
        for (i, &set) in clusters.sets().iter().enumerate() {
            for direction in members(set) {
                numbers |= (i as u64) << (4 * direction);
            }
        }
        let lists = &mut self.lists[layer % self.slots];
        lists.push(List { first, numbers });
        lists.len() as u32 - 1
    }

    /// The vertex of a near crossing of a record in `layer`.
    #[inline]
    pub(super) fn vertex(&self, record: Record, layer: usize, direction: u8) -> u32 {
        let numbering = record.0 >> NUMBERING;
        if numbering == Numbering::One as u64 {
            record.first()
        } else if numbering == Numbering::Ranked as u64 {
            let before = record.near() & ((1 << direction) - 1);
            record.first() + before.count_ones()
        } else {
            let list = self.lists[layer % self.slots][record.first() as usize];
            list.first + (list.numbers >> (4 * direction) & 15) as u32
        }
    }
}
