//! Extraction of chunks of all levels.

use isostudy_field::{Plain, StudyField};

use super::divided::Divisions;
use super::duals::{Known, Needed, Seams};
use super::error::{COARSEST, LevelError};
use super::layer::layers;
use super::neighbours::Neighbours;
use super::stitching::{Decision, Stitching};
use crate::chunks::{Chunk, ChunkExtractor, ChunkSettings};
use crate::cubes::Faces;
use crate::execution::control::Control;
use crate::lattice::CellBox;
use crate::lattice::endless::Grid;
use crate::method::Method;
use crate::source::Source;

/// Extracts boxes of cells of several levels, with the seams to neighbours that are coarser or finer by one level: all chunks of a world
/// [weld](crate::weld_chunks) to a closed mesh.
///
/// Level 0 is the finest. Level `n` has the cells of [`Grid::coarser(n)`](Grid::coarser).
///
/// ```
/// use isostudy_extract::{ChunkSettings, Control, Cubes, Grid, LevelExtractor, Method, Neighbours, from_fn, weld_chunks};
/// use isostudy_mesh::topology::topology;
///
/// let grid = Grid::try_new([0.0; 3], 0.25)?;
/// let method = Method::Cubes(Cubes::default());
/// let mut extractor = LevelExtractor::try_new(&grid, &method, &ChunkSettings::default())?;
/// let ball = from_fn(|[x, y, z]| 3.1 - (x * x + y * y + z * z).sqrt());
/// // East of the middle chunks of level 0 with 16 cells a side, west of it of level 1 with 8.
/// let mut chunks = Vec::new();
/// for corner in 0..8 {
///     let id = [corner & 1, corner >> 1 & 1, corner >> 2].map(|i| i - 1);
///     let level = if id[0] < 0 { 1 } else { 0 };
///     let level_at = |d: [i32; 3]| if id[0] + d[0] < 0 { 1 } else { 0 };
///     let neighbours = Neighbours::try_new(level, level_at)?;
///     let cells = grid.coarser(level)?.chunk(id, 16 >> level);
///     chunks.push(extractor.extract(&ball, level, cells, &neighbours, Control::default())?);
/// }
/// let report = topology(&weld_chunks(&chunks)?);
/// assert!(report.is_closed_manifold() && report.euler_characteristic == 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Guaranteed
///
/// - A chunk of the level without neighbours of other levels is that of a [`ChunkExtractor`] on the level's grid.
/// - Chunks that were all told the truth about their neighbours have no open edge between them, whatever the field. Of marching cubes
///   they are a manifold.
/// - A vertex on a seam is the neighbour's own to the bit, and so is its normal.
///
/// # Not guaranteed
///
/// - A field finer than a level's cells may differ there from what the next level has; what only the finer one sees ends in the coarse
///   cells at the seam. Its triangles may face any way.
/// - With [`Faces::Trilinear`], coarse cells at a finer neighbour have no tunnels.
#[derive(Debug)]
pub struct LevelExtractor {
    grid: Grid,
    method: Method,
    settings: ChunkSettings,
    /// By level, as they are asked for.
    extractors: Vec<Option<ChunkExtractor>>,
    /// A layer of a neighbour's cells.
    layer: Chunk,
    stitching: Stitching,
    /// Vertices of neighbours' cells.
    known: Known,
}

impl LevelExtractor {
    /// An extractor for chunks of all levels, of which `grid` has the cells of the finest. It has no buffers yet.
    ///
    /// # Errors
    /// [`LevelError::Method`]; [`LevelError::Chunk`] for what [`ChunkExtractor::try_new`] refuses.
    pub fn try_new(grid: &Grid, method: &Method, settings: &ChunkSettings) -> Result<Self, LevelError> {
        let has_levels = match method {
            Method::Cubes(_) => true,
            Method::SurfaceNets(nets) => !nets.patches,
            Method::DualContouring(nets) => !nets.patches,
            _ => false,
        };
        if !has_levels {
            return Err(LevelError::Method);
        }
        let mut made = Self {
            grid: *grid,
            method: *method,
            settings: *settings,
            extractors: Vec::new(),
            layer: Chunk::default(),
            stitching: Stitching::default(),
            known: Known::default(),
        };
        made.at(0)?;
        Ok(made)
    }

    /// The grid of level 0.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The neighbours as far as they matter to a chunk's mesh: of two that are equal here, nothing needs to be extracted again.
    pub fn seen(&self, neighbours: &Neighbours) -> Neighbours {
        let axes = |direction: [i32; 3]| (0..3).filter(move |&axis| direction[axis] != 0);
        if !matches!(self.method, Method::Cubes(_)) {
            return neighbours
                .only(|direction, _| direction.iter().all(|&d| d <= 0) && axes(direction).count() < 3);
        }
        neighbours.only(|direction, _| neighbours.dividing().any(|dividing| dividing == direction))
    }

    /// Extracts the surface in a box of cells of a level, as [`extract_into`](Self::extract_into).
    ///
    /// # Errors
    /// The same.
    pub fn extract<'s, 'c>(
        &mut self,
        field: impl Into<Source<'s>>,
        level: u32,
        cells: CellBox,
        neighbours: &Neighbours,
        control: impl Into<Control<'c>>,
    ) -> Result<Chunk, LevelError> {
        let mut chunk = Chunk::default();
        self.extract_into(field, level, cells, neighbours, control, &mut chunk)?;
        Ok(chunk)
    }

    /// Extracts the surface in a box of cells of a level, with its seams, into `chunk`, whose vectors are used again. After an error it
    /// is empty and of no world; the extractor is as good as before.
    ///
    /// [`Chunk::seam`] says how many triangles are of seams. A chunk that was edited, or got other
    /// neighbours as far as they are [seen](Self::seen), is to be extracted again; [`Chunk::is_touched_by`] knows of seams, too.
    ///
    /// # Errors
    /// [`LevelError::Level`], [`LevelError::Finest`], [`LevelError::Odd`], [`LevelError::NeedsField`] for samples;
    /// [`LevelError::Chunk`] for what [`ChunkExtractor::extract_into`] refuses.
    pub fn extract_into<'s, 'c>(
        &mut self,
        field: impl Into<Source<'s>>,
        level: u32,
        cells: CellBox,
        neighbours: &Neighbours,
        control: impl Into<Control<'c>>,
        chunk: &mut Chunk,
    ) -> Result<(), LevelError> {
        let source = field.into();
        let job = Job { source, level, cells, neighbours, control: control.into() };
        let result = match source {
            Source::Field(field) => self.work(&Plain(field), &job, chunk),
            Source::Study(field) => self.work(field, &job, chunk),
            Source::Samples(_) | Source::Stored(_) | Source::Bricks(_) | Source::Window { .. } => {
                Err(LevelError::NeedsField)
            }
        };
        if result.is_err() {
            chunk.clear();
        }
        result
    }

    fn work(&mut self, field: &dyn StudyField, job: &Job, chunk: &mut Chunk) -> Result<(), LevelError> {
        let Job { source, level, cells, neighbours, control } = *job;
        if level == 0 && neighbours.has_finer() {
            return Err(LevelError::Finest);
        }
        self.at(level)?.extract_into(source, cells, control, chunk)?;
        chunk.level = level;
        match self.method {
            Method::Cubes(cubes) => self.cubes(field, cubes.faces, job, chunk)?,
            _ => self.duals(field, job, chunk)?,
        }
        chunk.close_level(level);
        Ok(())
    }

    /// Makes the cells at finer neighbours anew.
    fn cubes(
        &mut self,
        field: &dyn StudyField,
        faces: Faces,
        job: &Job,
        chunk: &mut Chunk,
    ) -> Result<(), LevelError> {
        let Job { source, level, cells, neighbours, control } = *job;
        let own = chunk.keys.len();
        if neighbours.dividing().next().is_some() {
            let (fine, divisions) = (level - 1, Divisions::new(cells, neighbours));
            let mut stitching = std::mem::take(&mut self.stitching);
            stitching.begin(&divisions, chunk)?;
            for cells in layers(cells, neighbours) {
                self.extract_layer(fine, source, cells, control)?;
                stitching.learn(&self.layer, fine, &divisions, chunk)?;
                chunk.also_sampled(&self.layer);
            }
            let grid = self.grid_of(fine)?;
            let ChunkSettings { isovalue, normals } = self.settings;
            let decision = Decision { faces, field, isovalue, normals, grid: &grid };
            stitching.fill(&decision, &divisions, chunk)?;
            self.stitching = stitching;
        }
        chunk.keys[..own].iter_mut().for_each(|key| *key = key.at_level(level));
        Ok(chunk.drop_unused(|_| false)?)
    }

    /// Puts polygons of several levels in the place of those at sides whose neighbours are of another level.
    fn duals(&mut self, field: &dyn StudyField, job: &Job, chunk: &mut Chunk) -> Result<(), LevelError> {
        let Job { source, level, cells, neighbours, control } = *job;
        let own = chunk.keys.len();
        let grid = |step: i32| level.checked_add_signed(step).and_then(|level| self.grid_of(level).ok());
        let seams = Seams {
            field,
            isovalue: self.settings.isovalue,
            normals: self.settings.normals,
            is_sharp: matches!(self.method, Method::DualContouring(_)),
            level,
            cells,
            neighbours,
            grids: [grid(-1), grid(0), grid(1)],
        };
        self.known.clear();
        for Needed { step, cells } in seams.needed()? {
            let there = level.saturating_add_signed(step);
            self.extract_layer(there, source, cells, control)?;
            self.known.learn(&self.layer, there)?;
            chunk.also_sampled(&self.layer);
        }
        seams.remove(chunk);
        seams.add(&self.known, chunk)?;
        chunk.keys[..own].iter_mut().for_each(|key| *key = key.at_level(level));
        // Those of its own cells stay: neighbours may have a polygon at them.
        Ok(chunk.drop_unused(|key| key.level() == level && cells.contains(key.cell()))?)
    }

    /// Extracts cells of a level into `self.layer`.
    fn extract_layer(
        &mut self,
        level: u32,
        source: Source,
        cells: CellBox,
        control: Control,
    ) -> Result<(), LevelError> {
        let mut layer = std::mem::take(&mut self.layer);
        let extracted = self.at(level).and_then(|extractor| {
            extractor.extract_into(source, cells, control, &mut layer)?;
            Ok(())
        });
        self.layer = layer;
        extracted
    }

    fn grid_of(&self, level: u32) -> Result<Grid, LevelError> {
        self.grid.coarser(level).map_err(|_| LevelError::Level { level })
    }

    /// The extractor of a level.
    fn at(&mut self, level: u32) -> Result<&mut ChunkExtractor, LevelError> {
        let i = level as usize;
        if level > COARSEST {
            return Err(LevelError::Level { level });
        }
        if self.extractors.len() <= i {
            self.extractors.resize_with(i + 1, || None);
        }
        let made = match self.extractors[i].take() {
            Some(made) => made,
            None => ChunkExtractor::try_new(&self.grid_of(level)?, &self.method, &self.settings)?,
        };
        Ok(self.extractors[i].insert(made))
    }
}

/// What is to be extracted.
#[derive(Clone, Copy)]
struct Job<'a> {
    source: Source<'a>,
    level: u32,
    cells: CellBox,
    neighbours: &'a Neighbours,
    control: Control<'a>,
}
