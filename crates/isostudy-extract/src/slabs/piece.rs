//! The surface in a slab, and its vertices while they are made.

use std::collections::TryReserveError;
use std::time::Duration;

use glam::Vec3;

use crate::duals::Pattern;
use crate::extraction::ExtractError;
use crate::lattice::{Lattice, Part};
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
    /// Where they are of samples.
    pub(crate) normals: Vec<Vec3>,
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
    /// Empty, to be traced or not, of a part or of all.
    pub(crate) fn clear(&mut self, traced: bool, part: Option<Part>) {
        self.positions.clear();
        self.targets.clear();
        self.normals.clear();
        self.surface.triangles.clear();
        let triangles = std::mem::take(&mut self.surface.triangles);
        let mut trace = traced.then(|| self.surface.trace.take().unwrap_or_default());
        if let Some(trace) = &mut trace {
            trace.start(part);
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
    /// Of samples; none where others are asked for.
    pub(crate) normals: Vec<Vec3>,
    /// Where they are asked for.
    pub(crate) keys: Option<Vec<VertexKey>>,
    /// As [`Trace::patterns`](crate::surface::trace::Trace::patterns).
    pub(crate) patterns: Vec<Pattern>,
    /// Whether some are not of the part that is asked for.
    pub(crate) has_spare: bool,
    /// Lattice edges of the slab's own layers that cross the surface, seen from either end.
    pub(crate) crossing_ends: u64,
}

impl Vertices {
    /// None yet, in the room of an empty piece.
    pub(crate) fn within(piece: &mut Piece) -> Self {
        Self {
            positions: std::mem::take(&mut piece.positions),
            targets: std::mem::take(&mut piece.targets),
            normals: std::mem::take(&mut piece.normals),
            keys: piece.surface.trace.as_mut().map(|trace| std::mem::take(&mut trace.keys)),
            patterns: piece
                .surface
                .trace
                .as_mut()
                .map(|trace| std::mem::take(&mut trace.patterns))
                .unwrap_or_default(),
            ..Self::default()
        }
    }

    /// Makes room for so many more vertices, with normals by samples or without.
    #[inline]
    pub(crate) fn reserve(&mut self, more: usize, has_normals: bool) -> Result<(), TryReserveError> {
        self.positions.try_reserve(more)?;
        if has_normals {
            self.normals.try_reserve(more)?;
        }
        match &mut self.keys {
            Some(keys) => keys.try_reserve(more),
            None => Ok(()),
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
        (piece.positions, piece.targets, piece.normals) = (self.positions, self.targets, self.normals);
        piece.crossing_ends = self.crossing_ends;
        if let (Some(trace), Some(keys)) = (&mut piece.surface.trace, self.keys) {
            (trace.keys, trace.has_spare) = (keys, self.has_spare);
            trace.patterns = self.patterns;
        }
    }
}
