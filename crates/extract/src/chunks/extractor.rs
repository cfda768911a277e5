//! Extraction of one chunk after the other.

use std::collections::TryReserveError;

use mesh::TriangleMesh;

use super::chunk::Chunk;
use crate::collapse::collapse_traced;
use crate::cubes::Rule;
use crate::extraction::{ExtractError, Extraction, check};
use crate::extractor::Extractor;
use crate::grid::Grid;
use crate::lattice::{CellBox, Lattice};
use crate::memory::{collected, filled, push};
use crate::method::Cubes;
use crate::normals::vertex_normals;
use crate::settings::{Clustering, Execution, ExtractSettings, Placement, Positions};
use crate::source::Source;

/// Of what decides about a surface component, this much is tried at first beyond the chunk.
const FIRST_MARGIN: u32 = 8;
const NOWHERE: u32 = u32::MAX;

/// Extracts boxes of cells of a lattice, such that neighbours fit and all of them [weld](crate::weld_chunks) to the mesh
/// that [`extract`](crate::extract) makes of the whole, byte for byte. Its buffers are used again.
///
/// To decide as the whole would, more is sampled than the chunk's own cells ([`Chunk::window`]): without edge collapse
/// two cells on every side, or one where cubes are cut each by itself ([`Arrangement`](crate::Arrangement)). Edges
/// collapse in an order that runs through a whole connected piece of surface, and an early collapse can decide a late
/// one anywhere on it: with edge collapse the window therefore grows until it holds every piece of surface that enters
/// the chunk, if need be to the whole lattice. For terrain that is edited all the time take
/// [`Clustering::Integrated`], which regularises triangles without looking farther than a neighbour.
///
/// ```
/// use extract::{Arrangement, ChunkExtractor, Execution, ExtractSettings, Lattice, extract, weld_chunks};
/// use field::{ScalarField, Sphere};
/// # use glam::Vec3;
/// # use mesh::Bounds;
/// # let bounds = Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) };
/// let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.05)?;
/// let (settings, execution) = (ExtractSettings::default(), Execution::default());
/// let sphere: &dyn ScalarField = &Sphere { radius: 1.0 };
/// let mut extractor = ChunkExtractor::try_new(&lattice, &settings)?;
/// let mut chunks = Vec::new();
/// for cells in extractor.grid(16) {
///     chunks.push(extractor.extract(sphere.into(), cells, &execution)?);
/// }
/// assert_eq!(weld_chunks(&chunks)?, extract(sphere, &lattice, &settings, &execution)?.mesh);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ChunkExtractor {
    lattice: Lattice,
    settings: ExtractSettings,
    cubes: Option<Rule>,
    extractor: Extractor,
    extraction: Extraction,
    samples: Vec<f32>,
}

/// Why a chunk cannot be extracted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChunkError {
    /// The settings or the samples are not valid, or there is no memory.
    #[error(transparent)]
    Extract(#[from] ExtractError),
    /// A box without a cell, or with cells that the lattice does not have.
    #[error("cells {:?} to {:?} are not a box of cells of a lattice of {lattice:?}", given.start, given.end)]
    Cells {
        /// What was given.
        given: CellBox,
        /// [`Lattice::cells`].
        lattice: [u32; 3],
    },
    /// [`Positions::Accumulated`]: a position depends on all before it.
    #[error("chunks need indexed positions")]
    Accumulated,
    /// Vertices that are moved elsewhere: whether one may move depends on its neighbours, whose moves depend on theirs.
    #[error(
        "chunks have vertices at the mean of interpolated crossings, not {placement:?}{}",
        if *refine_crossings { " with refined crossings" } else { "" }
    )]
    Placement {
        /// What was given.
        placement: Placement,
        /// What was given.
        refine_crossings: bool,
    },
}

impl From<TryReserveError> for ChunkError {
    fn from(error: TryReserveError) -> Self {
        Self::Extract(error.into())
    }
}

impl ChunkExtractor {
    /// An extractor for chunks of `lattice`, without buffers yet.
    ///
    /// # Errors
    /// [`ChunkError::Accumulated`], [`ChunkError::Placement`], and [`ChunkError::Extract`] where no mesh could be made
    /// of the whole either.
    pub fn try_new(lattice: &Lattice, settings: &ExtractSettings) -> Result<Self, ChunkError> {
        check(settings, lattice.arrangement())?;
        if settings.positions != Positions::Indexed {
            return Err(ChunkError::Accumulated);
        }
        if settings.placement != Placement::MeanOfCrossings || settings.refine_crossings {
            let (placement, refine_crossings) = (settings.placement, settings.refine_crossings);
            return Err(ChunkError::Placement { placement, refine_crossings });
        }
        let mut extractor = Extractor::new();
        extractor.traced = true;
        let (lattice, settings) = (lattice.clone(), *settings);
        let extraction = Extraction::default();
        Ok(Self { lattice, settings, cubes: None, extractor, extraction, samples: Vec::new() })
    }

    /// The same for marching cubes, on the grid's own cubes.
    ///
    /// # Errors
    /// As [`try_new`](Self::try_new); [`ChunkError::Extract`] also for a grid that is none for the method.
    pub fn of_cubes(cubes: &Cubes, grid: &Grid, isovalue: f32) -> Result<Self, ChunkError> {
        let lattice = grid.lattice(Cubes::ARRANGEMENT).map_err(ExtractError::from)?;
        let extractor = Self::try_new(&lattice, &cubes.settings(isovalue))?;
        Ok(Self { cubes: Some(cubes.rule()), ..extractor })
    }

    /// The lattice in boxes of so many cells a side, x fastest; the last ones on each axis may be smaller. With 0 there
    /// are none.
    pub fn grid(&self, cells: u32) -> impl Iterator<Item = CellBox> + use<> {
        let all = self.lattice.cells();
        let [nx, ny, nz] = all.map(|n| n.checked_div(cells).map_or(0, |_| n.div_ceil(cells)));
        let boxes = (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
        boxes.map(move |place| {
            let start = place.map(|i| i * cells);
            CellBox { start, end: [0, 1, 2].map(|axis| start[axis].saturating_add(cells).min(all[axis])) }
        })
    }

    /// Extracts the surface in a box of cells. `source` is that of the whole lattice: a field, or all its samples.
    ///
    /// The chunk depends on the source, the lattice, the settings and the box, never on `execution`. With chunks in
    /// several threads, each with an extractor of its own, one thread each is best.
    ///
    /// # Errors
    /// [`ChunkError::Cells`]; [`ChunkError::Extract`] for what [`extract`](crate::extract) refuses.
    pub fn extract(
        &mut self,
        source: Source,
        cells: CellBox,
        execution: &Execution,
    ) -> Result<Chunk, ChunkError> {
        let whole = self.lattice.cell_box();
        if cells.is_empty() || (0..3).any(|axis| cells.end[axis] > whole.end[axis]) {
            return Err(ChunkError::Cells { given: cells, lattice: self.lattice.cells() });
        }
        let unmerged = match self.settings.clustering {
            Clustering::None | Clustering::Integrated => {
                let window = cells.grown(self.halo(), &whole);
                if self.is_on_one_side(source, window) {
                    return Ok(self.empty(cells, window));
                }
                self.extract_window(source, window, self.settings.clustering, execution)?;
                return Ok(self.part(cells, window)?);
            }
            Clustering::EdgeCollapse => Clustering::None,
            Clustering::IntegratedCollapse => Clustering::Integrated,
        };
        let mut margin = self.halo() + FIRST_MARGIN;
        loop {
            let window = cells.grown(margin, &whole);
            self.extract_window(source, window, unmerged, execution)?;
            if let Some(chunk) = self.collapsed_part(cells, window)? {
                return Ok(chunk);
            }
            margin = margin.saturating_mul(2);
        }
    }

    /// Whether the field says that no surface is in a window. What the sweep would find out, without its preparations.
    fn is_on_one_side(&self, source: Source, window: CellBox) -> bool {
        let Source::Field(field) = source else { return false };
        let bounds = self.lattice.window(window).sampled_bounds();
        // Some fields can tell without a value.
        let range = field.range(bounds, f32::NAN).and_then(|(low, high)| {
            let needs_value = low.is_nan() || high.is_nan();
            if needs_value {
                field.range(bounds, field.sample((bounds.min + bounds.max) * 0.5))
            } else {
                Some((low, high))
            }
        });
        range.is_some_and(|(low, high)| low > self.settings.isovalue || high <= self.settings.isovalue)
    }

    /// How many cells beyond a triangle's own its vertices and their normals depend on: a vertex of a cell is one of its
    /// neighbours' too, their other vertices give it its normal, and those depend on samples one lattice edge away.
    /// Where cubes are cut each by itself the last step leads no farther.
    fn halo(&self) -> u32 {
        if self.lattice.arrangement().uniform().is_some() && self.cubes.is_none() { 2 } else { 1 }
    }

    /// Extracts the lattice within a box, with its trace.
    fn extract_window(
        &mut self,
        source: Source,
        window: CellBox,
        clustering: Clustering,
        execution: &Execution,
    ) -> Result<(), ChunkError> {
        let lattice = self.lattice.window(window);
        let source = match source {
            Source::Field(_) => source,
            Source::Samples(all) => {
                let (given, wanted) = (all.len() as u64, self.lattice.stored_samples());
                if given != wanted {
                    return Err(ExtractError::SampleCount { given, wanted }.into());
                }
                let [nx, ny, nz] = lattice.stored_grid().map(|n| n as usize);
                self.samples.clear();
                self.samples.try_reserve(nx * ny * nz)?;
                for (z, y) in (0..nz).flat_map(|z| (0..ny).map(move |y| (z, y))) {
                    let first = lattice.point_number([0, y, z]) as usize;
                    self.samples.extend_from_slice(&all[first..first + nx]);
                }
                Source::Samples(&self.samples)
            }
        };
        let settings = ExtractSettings { clustering, ..self.settings };
        let extraction = &mut self.extraction;
        match self.cubes {
            None => self.extractor.extract_into(source, &lattice, &settings, execution, extraction)?,
            Some(rule) => {
                self.extractor.extract_cubes_into(source, &lattice, &settings, rule, execution, extraction)?
            }
        }
        Ok(())
    }

    /// The chunk's triangles of the window, with the vertices that they use and those of the chunk's own points.
    fn part(&self, cells: CellBox, window: CellBox) -> Result<Chunk, TryReserveError> {
        let (mesh, trace) = (&self.extraction.mesh, &self.extractor.trace);
        let own = |&t: &usize| cells.contains(self.lattice.cell_of_number(trace.cells[t]));
        let mut numbers = collected(trace.keys.iter().map(|key| {
            let own = cells.contains(self.lattice.cell_of_point(key.point()));
            if own { 0 } else { NOWHERE }
        }))?;
        let mut chunk = self.empty(cells, window);
        for t in (0..mesh.triangles.len()).filter(own) {
            push(&mut chunk.mesh.triangles, mesh.triangles[t])?;
            push(&mut chunk.triangle_cells, trace.cells[t])?;
            mesh.triangles[t].iter().for_each(|&v| numbers[v as usize] = 0);
        }
        for (v, number) in numbers.iter_mut().enumerate().filter(|(_, number)| **number != NOWHERE) {
            *number = chunk.keys.len() as u32;
            push(&mut chunk.keys, trace.keys[v])?;
            push(&mut chunk.mesh.positions, mesh.positions[v])?;
            push(&mut chunk.mesh.normals, mesh.normals[v])?;
        }
        chunk.mesh.triangles.iter_mut().flatten().for_each(|v| *v = numbers[*v as usize]);
        Ok(chunk)
    }

    /// The same after collapsing edges. `None` if a piece of surface in the chunk leaves the part of the window that is
    /// as in the whole: what happens to it beyond may matter.
    ///
    /// A piece, connected through shared vertices, that lies in that part is a piece of the whole mesh, with the same
    /// vertices and triangles in the same order. Collapses look at nothing but the piece they are in, and go in an order
    /// that other pieces interleave with and do not change: by vertex numbers as published; guarded, each taken from the
    /// queue is the shortest of its own piece, and a further pass over a piece in which nothing collapsed finds nothing
    /// again.
    fn collapsed_part(&self, cells: CellBox, window: CellBox) -> Result<Option<Chunk>, TryReserveError> {
        let (mesh, trace) = (&self.extraction.mesh, &self.extractor.trace);
        let as_in_whole = window.shrunk(self.halo(), &self.lattice.cell_box());
        let mut pieces = Pieces::of(mesh)?;
        // What is known of each piece, at its root.
        let mut enters = filled(mesh.positions.len(), false)?;
        let mut leaves = filled(mesh.positions.len(), false)?;
        for (triangle, &cell) in mesh.triangles.iter().zip(&trace.cells) {
            let (cell, root) = (self.lattice.cell_of_number(cell), pieces.root(triangle[0]));
            enters[root] |= cells.contains(cell);
            leaves[root] |= !as_in_whole.contains(cell);
        }
        if enters.iter().zip(&leaves).any(|(enters, leaves)| *enters && *leaves) {
            return Ok(None);
        }

        // Those pieces as a mesh of their own.
        let mut numbers = filled(mesh.positions.len(), NOWHERE)?;
        let (mut positions, mut keys) = (Vec::new(), Vec::new());
        for v in 0..mesh.positions.len() {
            if enters[pieces.root(v as u32)] {
                numbers[v] = positions.len() as u32;
                push(&mut positions, mesh.positions[v])?;
                push(&mut keys, trace.keys[v])?;
            }
        }
        let (mut triangles, mut triangle_cells) = (Vec::new(), Vec::new());
        for (triangle, &cell) in mesh.triangles.iter().zip(&trace.cells) {
            if enters[pieces.root(triangle[0])] {
                push(&mut triangles, triangle.map(|v| numbers[v as usize]))?;
                push(&mut triangle_cells, cell)?;
            }
        }
        let after = collapse_traced(self.settings.topology, self.lattice.spacing(), positions, &triangles)?;
        let normals = vertex_normals(&after.positions, &after.triangles)?;

        let mut chunk = self.empty(cells, window);
        let mut numbers = filled(after.positions.len(), NOWHERE)?;
        for (triangle, &before) in after.triangles.iter().zip(&after.triangles_before) {
            let cell = triangle_cells[before as usize];
            if !cells.contains(self.lattice.cell_of_number(cell)) {
                continue;
            }
            for &v in triangle {
                let v = v as usize;
                if numbers[v] == NOWHERE {
                    numbers[v] = chunk.keys.len() as u32;
                    push(&mut chunk.keys, keys[after.vertices_before[v] as usize])?;
                    push(&mut chunk.mesh.positions, after.positions[v])?;
                    push(&mut chunk.mesh.normals, normals[v])?;
                }
            }
            push(&mut chunk.mesh.triangles, triangle.map(|v| numbers[v as usize]))?;
            push(&mut chunk.triangle_cells, cell)?;
        }
        Ok(Some(chunk))
    }

    fn empty(&self, cells: CellBox, window: CellBox) -> Chunk {
        let numbered_by_use = match self.settings.clustering {
            Clustering::None | Clustering::Integrated => false,
            Clustering::EdgeCollapse | Clustering::IntegratedCollapse => true,
        };
        Chunk {
            cells,
            mesh: TriangleMesh::default(),
            keys: Vec::new(),
            triangle_cells: Vec::new(),
            window,
            sampled: self.lattice.window(window).sampled_bounds(),
            numbered_by_use,
        }
    }
}

/// The vertices of each connected piece of a mesh.
struct Pieces {
    towards_root: Vec<u32>,
}

impl Pieces {
    fn of(mesh: &TriangleMesh) -> Result<Self, TryReserveError> {
        let mut pieces = Self { towards_root: collected(0..mesh.positions.len() as u32)? };
        for &[a, b, c] in &mesh.triangles {
            for other in [b, c] {
                let (one, other) = (pieces.root(a), pieces.root(other));
                pieces.towards_root[one.max(other)] = one.min(other) as u32;
            }
        }
        Ok(pieces)
    }

    fn root(&mut self, vertex: u32) -> usize {
        let mut v = vertex as usize;
        while self.towards_root[v] as usize != v {
            self.towards_root[v] = self.towards_root[self.towards_root[v] as usize];
            v = self.towards_root[v] as usize;
        }
        v
    }
}
