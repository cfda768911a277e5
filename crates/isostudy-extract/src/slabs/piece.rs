//! The surface in a slab, and its vertices while they are made.

use std::collections::TryReserveError;
use std::time::Duration;

use glam::Vec3;

use crate::extraction::ExtractError;
use crate::lattice::Lattice;
use crate::memory::push;
use crate::surface::trace::VertexKey;
use crate::surface::triangulation::Triangulation;

/// The surface in a slab.
///
/// Vertices are numbered from the lowest layer that the slab's triangles can touch, so that the numbers of the whole
/// surface are these plus a constant, in the layers above and below the slab too.
#[derive(Debug, Default)]
pub(crate) struct Piece {
    /// Of the slab's own layers.
    pub(crate) positions: Vec<Vec3>,
    /// Where the placer wants them.
    pub(crate) targets: Vec<Vec3>,
    pub(crate) surface: Triangulation,
    /// Vertices numbered in the layers below the slab.
    pub(crate) below: u64,
    pub(crate) crossing_ends: u64,
    /// Triangles that may touch a vertex below the slab, all before this one.
    pub(crate) head: usize,
    /// Triangles that may touch a vertex above the slab, all from this one on.
    pub(crate) tail: usize,
    pub(crate) times: SlabTimes,
}

/// Time spent in the passes.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SlabTimes {
    pub(crate) sampling: Duration,
    pub(crate) vertex: Duration,
    pub(crate) geometry: Duration,
}

impl Piece {
    /// Empty, to be traced or not.
    pub(crate) fn clear(&mut self, traced: bool) {
        self.positions.clear();
        self.targets.clear();
        self.surface.triangles.clear();
        let triangles = std::mem::take(&mut self.surface.triangles);
        let mut trace = traced.then(|| self.surface.trace.take().unwrap_or_default());
        if let Some(trace) = &mut trace {
            trace.clear();
        }
        self.surface = Triangulation { triangles, trace, ..Triangulation::default() };
        (self.below, self.crossing_ends, self.head, self.tail) = (0, 0, 0, 0);
        self.times = SlabTimes::default();
    }
}

/// The vertices of a slab, while they are made.
#[derive(Debug, Default)]
pub(crate) struct Vertices {
    /// How many were numbered, those beyond the slab's own layers too.
    pub(crate) numbered: u64,
    pub(crate) positions: Vec<Vec3>,
    /// Where the settings want them, if elsewhere.
    pub(crate) targets: Vec<Vec3>,
    /// Where they are asked for.
    pub(crate) keys: Option<Vec<VertexKey>>,
    /// Lattice edges of the slab's own layers that cross the surface, seen from either end.
    pub(crate) crossing_ends: u64,
}

impl Vertices {
    /// None yet, in the room of an empty piece.
    pub(crate) fn within(piece: &mut Piece) -> Self {
        Self {
            positions: std::mem::take(&mut piece.positions),
            targets: std::mem::take(&mut piece.targets),
            keys: piece.surface.trace.as_mut().map(|trace| std::mem::take(&mut trace.keys)),
            ..Self::default()
        }
    }

    /// Names the vertex that was placed last, where keys are asked for.
    pub(crate) fn name(
        &mut self,
        lattice: &Lattice,
        place: [usize; 3],
        number: usize,
    ) -> Result<(), TryReserveError> {
        if let Some(keys) = &mut self.keys {
            push(keys, VertexKey::new(lattice.arrangement(), lattice.stored(place), number))?;
        }
        Ok(())
    }

    /// # Errors
    /// [`ExtractError::TooManyVertices`].
    pub(crate) fn check(&self, most: u32) -> Result<(), ExtractError> {
        match self.numbered > u64::from(most) {
            true => Err(ExtractError::TooManyVertices { limit: most }),
            false => Ok(()),
        }
    }

    /// Makes them those of a slab's piece.
    pub(crate) fn give_to(self, piece: &mut Piece) {
        (piece.positions, piece.targets) = (self.positions, self.targets);
        piece.crossing_ends = self.crossing_ends;
        if let (Some(trace), Some(keys)) = (&mut piece.surface.trace, self.keys) {
            trace.keys = keys;
        }
    }
}
