//! Extraction of chunks of all levels.

use std::collections::{HashMap, TryReserveError};

use isostudy_field::{Plain, StudyField};

use super::duals::{Known, Needed, Seams};
use super::error::{COARSEST, LevelError};
use super::layer::{Plane, layer};
use super::neighbours::Neighbours;
use super::shift::Shift;
use super::transitions::{Corner, Decision, triangulate};
use crate::chunks::{Chunk, ChunkExtractor, ChunkSettings, OfLevels};
use crate::cubes::Faces;
use crate::execution::control::Control;
use crate::lattice::CellBox;
use crate::lattice::endless::Grid;
use crate::memory::push;
use crate::method::Method;
use crate::sampling::level::Level;
use crate::source::Source;
use crate::surface::trace::VertexKey;

/// Settings of chunks of several levels. Those that weld have the same.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct LevelSettings {
    /// As for chunks of one level.
    pub chunks: ChunkSettings,
    /// How far chunks of marching cubes stand back from finer ones, in cells of their own: 0 to 0.5. With 0, the default, the seams lie in
    /// the sides of the chunks; then their triangles face along an axis, which shows in flat shading.
    pub width: f32,
}

impl LevelSettings {
    /// The same with settings of chunks.
    pub fn with_chunks(self, chunks: ChunkSettings) -> Self {
        Self { chunks, ..self }
    }

    /// The same with a width of transitions.
    pub fn with_width(self, width: f32) -> Self {
        Self { width, ..self }
    }
}

/// Extracts boxes of cells of several levels, with the seams to neighbours that are coarser or finer by one level: all chunks of a world
/// [weld](crate::weld_chunks) to a closed mesh.
///
/// Level 0 is the finest. Level `n` has the cells of [`Grid::coarser(n)`](Grid::coarser).
///
/// ```
/// use isostudy_extract::{Control, Cubes, Grid, LevelExtractor, LevelSettings, Method, Neighbours, from_fn, weld_chunks};
/// use isostudy_mesh::topology::topology;
///
/// let grid = Grid::try_new([0.0; 3], 0.25)?;
/// let method = Method::Cubes(Cubes::default());
/// let settings = LevelSettings::default().with_width(0.25);
/// let mut extractor = LevelExtractor::try_new(&grid, &method, &settings)?;
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
/// - Chunks that were all told the truth about their neighbours have no open edge between them, whatever the field.
/// - A vertex on a seam is the neighbour's own to the bit, and so is its normal.
///
/// # Not guaranteed
///
/// - A field finer than a level's cells may differ there from what the next level has; the seam then has a piece of surface that lies in
///   the side between the chunks.
#[derive(Debug)]
pub struct LevelExtractor {
    grid: Grid,
    method: Method,
    settings: LevelSettings,
    /// By level, as they are asked for.
    extractors: Vec<Option<ChunkExtractor>>,
    /// A layer of a neighbour's cells.
    layer: Chunk,
    plane: Plane,
    /// Vertices of neighbours' cells.
    known: Known,
    /// Vertices of other levels that a chunk has, by key.
    added: HashMap<VertexKey, u32>,
}

impl LevelExtractor {
    /// An extractor for chunks of all levels, of which `grid` has the cells of the finest. It has no buffers yet.
    ///
    /// # Errors
    /// [`LevelError::Method`], [`LevelError::Width`]; [`LevelError::Chunk`] for what [`ChunkExtractor::try_new`] refuses.
    pub fn try_new(grid: &Grid, method: &Method, settings: &LevelSettings) -> Result<Self, LevelError> {
        let has_levels = match method {
            Method::Cubes(_) => true,
            Method::SurfaceNets(nets) => !nets.patches,
            Method::DualContouring(nets) => !nets.patches,
            _ => false,
        };
        if !has_levels {
            return Err(LevelError::Method);
        }
        let width = settings.width;
        if !(0.0..=0.5).contains(&width) {
            return Err(LevelError::Width { width });
        }
        let mut made = Self {
            grid: *grid,
            method: *method,
            settings: *settings,
            extractors: Vec::new(),
            layer: Chunk::default(),
            plane: Plane::default(),
            known: Known::default(),
            added: HashMap::new(),
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
        if self.settings.width > 0.0 {
            // Where a finer chunk touches a corner of the chunk, all that touch it decide on its place.
            return neighbours.only(|direction, _| neighbours.has_finer_at(direction));
        }
        // One at an edge decides whether vertices in the edge are its own, too, if those at both sides are finer.
        let is_finer = |direction: [i32; 3]| {
            axes(direction).all(|axis| {
                let mut side = [0; 3];
                side[axis] = direction[axis];
                neighbours.step(side) < 0
            })
        };
        neighbours.only(|direction, _| is_finer(direction) && axes(direction).count() < 3)
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
            Source::Samples(_) | Source::Bricks(_) | Source::Window { .. } => Err(LevelError::NeedsField),
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
        chunk.close_level(OfLevels { level, width: self.settings.width });
        Ok(())
    }

    /// Adds transition cells, and moves the chunk's own vertices back from them.
    fn cubes(
        &mut self,
        field: &dyn StudyField,
        faces: Faces,
        job: &Job,
        chunk: &mut Chunk,
    ) -> Result<(), LevelError> {
        let Job { level, cells, neighbours, .. } = *job;
        let own = chunk.keys.len();
        self.added.clear();
        for side in (0..6).map(|side| (side / 2, side % 2 != 0)) {
            let mut direction = [0; 3];
            direction[side.0] = if side.1 { 1 } else { -1 };
            if neighbours.step(direction) < 0 {
                self.transitions(field, faces, side, job, (chunk, own))?;
            }
        }
        let (width, grid) = (self.settings.width, self.grid_of(level)?);
        let shift = Shift::new(cells, &grid, neighbours, width);
        let (isovalue, spacing) = (self.settings.chunks.isovalue, grid.spacing() as f32);
        let surface = Level { field, isovalue, spacing };
        for (key, p) in chunk.keys[..own].iter_mut().zip(&mut chunk.positions) {
            if width > 0.0 {
                *p = shift.moved(*key, *p, &surface);
            }
            *key = key.at_level(level, shift.copy(*key));
        }
        Ok(())
    }

    /// Puts polygons of several levels in the place of those at sides whose neighbours are of another level.
    fn duals(&mut self, field: &dyn StudyField, job: &Job, chunk: &mut Chunk) -> Result<(), LevelError> {
        let Job { source, level, cells, neighbours, control } = *job;
        let own = chunk.keys.len();
        let grid = |step: i32| level.checked_add_signed(step).and_then(|level| self.grid_of(level).ok());
        let seams = Seams {
            field,
            isovalue: self.settings.chunks.isovalue,
            normals: self.settings.chunks.normals,
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
        chunk.keys[..own].iter_mut().for_each(|key| *key = key.at_level(level, 0));
        Ok(chunk.drop_strangers()?)
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

    /// Adds the transition cells of a side.
    fn transitions(
        &mut self,
        field: &dyn StudyField,
        faces: Faces,
        side: (usize, bool),
        job: &Job,
        (chunk, own): (&mut Chunk, usize),
    ) -> Result<(), LevelError> {
        let Job { source, level, cells, control, .. } = *job;
        let (across, is_high) = side;
        let fine = level - 1;
        let grid = self.grid_of(fine)?;
        let ends = [cells.start, cells.end].map(|corner| corner.map(|i| i.saturating_mul(2)));
        let cells_there = layer(across, ends[usize::from(is_high)][across], ends);
        self.extract_layer(fine, source, cells_there, control)?;
        let isovalue = self.settings.chunks.isovalue;
        self.plane.read(across, &self.layer, (field, isovalue), &grid)?;
        let Self { layer, plane, added, .. } = self;
        let decision = Decision { faces, field, isovalue, grid: &grid };
        let mut triangles: Vec<([i32; 3], [Corner; 3])> = Vec::new();
        let take = |cell, triangle| push(&mut triangles, (cell, triangle));
        triangulate((chunk, own), side, plane, &decision, take)?;
        for (cell, triangle) in triangles {
            let mut numbers = [0; 3];
            for (number, corner) in numbers.iter_mut().zip(triangle) {
                *number = match corner {
                    Corner::Own(v) => v,
                    Corner::Fine(v) => add(added, chunk, layer, v, fine)?,
                };
            }
            push(&mut chunk.triangles, numbers)?;
            push(&mut chunk.triangle_cells, chunk.cells.number(cell))?;
            chunk.seam += 1;
        }
        chunk.also_sampled(layer);
        Ok(())
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
            None => ChunkExtractor::try_new(&self.grid_of(level)?, &self.method, &self.settings.chunks)?,
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

/// The number that a vertex of a layer of another level has in a chunk; the next one, if it is new.
fn add(
    added: &mut HashMap<VertexKey, u32>,
    chunk: &mut Chunk,
    layer: &Chunk,
    v: u32,
    level: u32,
) -> Result<u32, TryReserveError> {
    let v = v as usize;
    let key = layer.keys[v].at_level(level, 0);
    if let Some(&number) = added.get(&key) {
        return Ok(number);
    }
    let number = chunk.keys.len() as u32;
    added.try_reserve(1)?;
    added.insert(key, number);
    push(&mut chunk.keys, key)?;
    push(&mut chunk.positions, layer.positions[v])?;
    if let Some(&normal) = layer.normals.get(v) {
        push(&mut chunk.normals, normal)?;
    }
    Ok(number)
}
