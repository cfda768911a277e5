//! Extraction of chunks of all levels.

use isostudy_field::{Plain, ScalarField, StudyField};

use super::divided::Divisions;
use super::duals::{Known, Needed, Seams};
use super::error::{COARSEST, LevelError};
use super::layer::layers;
use super::neighbours::{DIRECTIONS, Neighbours};
use super::stitching::{Decision, Stitching};
use super::windows::{self, LevelSamples, LevelWindow, Values, Windows};
use crate::chunks::relative::{self, Seen, back};
use crate::chunks::{Chunk, ChunkError, ChunkExtractor, ChunkSettings, Normals, World};
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
    kind: LevelKind,
    settings: ChunkSettings,
    /// By level, as they are asked for.
    extractors: Vec<Option<ChunkExtractor>>,
    /// A layer of a neighbour's cells.
    layer: Chunk,
    stitching: Stitching,
    /// Vertices of neighbours' cells.
    known: Known,
    /// Samples of a level that were taken from a finer one.
    derived: Vec<f32>,
}

impl LevelExtractor {
    /// An extractor for chunks of all levels, of which `grid` has the cells of the finest. It has no buffers yet.
    ///
    /// # Errors
    /// [`LevelError::Method`]; [`LevelError::Chunk`] for what [`ChunkExtractor::try_new`] refuses.
    pub fn try_new(grid: &Grid, method: &Method, settings: &ChunkSettings) -> Result<Self, LevelError> {
        let kind = LevelKind::of(method).ok_or(LevelError::Method)?;
        if settings.normals == Normals::Samples {
            return Err(ChunkError::NormalsNeedSamples.into());
        }
        if !settings.keys {
            return Err(ChunkError::LevelsNeedKeys.into());
        }
        let mut made = Self {
            grid: *grid,
            method: *method,
            kind,
            settings: *settings,
            extractors: Vec::new(),
            layer: Chunk::default(),
            stitching: Stitching::default(),
            known: Known::default(),
            derived: Vec::new(),
        };
        made.at(0)?;
        Ok(made)
    }

    /// The grid of level 0.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Makes room for chunks of the levels below `levels` with so many vertices and twice as many triangles, and for their seams, as
    /// [`ChunkExtractor::reserve`] does for one level.
    ///
    /// # Errors
    /// [`LevelError::Level`]; [`LevelError::Chunk`] if there is no memory.
    pub fn reserve(&mut self, levels: u32, vertices: usize) -> Result<(), LevelError> {
        for level in 0..levels {
            self.at(level)?.reserve(vertices)?;
        }
        self.layer.reserve(vertices);
        Ok(())
    }

    /// Makes the tables of the method and of the seams between levels, and buffers for chunks of so many cells a side of the levels below
    /// `levels`, as [`ChunkExtractor::warm_up`] does for one level. Cells with rare sets of divided edges have no table yet.
    ///
    /// # Errors
    /// [`LevelError::Level`]; as [`ChunkExtractor::warm_up`].
    pub fn warm_up(&mut self, levels: u32, cells: u32) -> Result<(), LevelError> {
        for level in 0..levels {
            self.at(level)?.warm_up(cells)?;
        }
        #[cfg(feature = "cubes")]
        if let LevelKind::Cubes(_) = self.kind
            && levels > 1
        {
            self.stitching.make_kinds();
        }
        Ok(())
    }

    /// The neighbours as far as they matter to a chunk's mesh: of two that are equal here, nothing needs to be extracted again.
    pub fn seen(&self, neighbours: &Neighbours) -> Neighbours {
        let axes = |direction: [i32; 3]| (0..3).filter(move |&axis| direction[axis] != 0);
        if matches!(self.kind, LevelKind::Duals { .. }) {
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
        let (source, control) = (field.into(), control.into());
        let job = |given| Job { given, level, cells, neighbours, control };
        let corner = self.grid_of(level).map_or([0.0; 3], |grid| grid.position(cells.start));
        let is_relative = self.settings.relative;
        let result = match source {
            Source::Field(field) if is_relative => {
                let field: &dyn ScalarField = &Seen { field, corner };
                self.relative(job(Given::Field(field.into(), &Plain(field))), chunk)
            }
            Source::Study(field) if is_relative => {
                let field: &dyn StudyField = &Seen { field, corner };
                self.relative(job(Given::Field(field.into(), field)), chunk)
            }
            Source::Field(field) => self.work(&job(Given::Field(source, &Plain(field))), chunk),
            Source::Study(field) => self.work(&job(Given::Field(source, field)), chunk),
            Source::Samples(_) | Source::Stored(_) | Source::Bricks(_) | Source::Window { .. } => {
                Err(LevelError::NeedsField)
            }
        };
        if result.is_err() {
            chunk.clear();
        }
        result
    }

    /// The boxes of cells whose samples [`extract_samples_into`](Self::extract_samples_into) looks at, with their levels. The first one is round the
    /// chunk's own cells, of its level. The others are along the sides and edges where a neighbour of another level is seen, of that
    /// level.
    ///
    /// # Errors
    /// [`LevelError::Level`], [`LevelError::Finest`], [`LevelError::Odd`]; [`LevelError::Chunk`] for a box that is no chunk.
    pub fn windows(
        &mut self,
        level: u32,
        cells: CellBox,
        neighbours: &Neighbours,
    ) -> Result<Vec<(u32, CellBox)>, LevelError> {
        self.at(level)?.window(cells)?;
        // What chunks of each level look at; a cell that is made anew, or gets a vertex; and one for differences at its sides.
        let more = self.method.family().halo().ok_or(LevelError::Method)?.max(2) + 1;
        windows::needed(level, cells, &self.seen(neighbours), more)
    }

    /// Extracts the surface between samples in a box of cells of a level, as [`extract_into`](Self::extract_into) does of a field.
    ///
    /// `given` are windows that have what [`windows`](Self::windows) names: the same ones, or larger ones. A level may be left out where a finer
    /// one is given in the same place: **its samples are those of the finer level at its corners**, every second one along each
    /// axis. Whoever makes the samples of coarser levels must do the same, or else seams would not fit; where two windows differ,
    /// that is an error.
    ///
    /// The mesh has the bits that a field with these values would give, but for vertices that seams put into cells: for these the
    /// samples are interpolated.
    ///
    /// ```
    /// use isostudy_extract::{Chunk, ChunkSettings, Control, Cubes, Grid, LevelExtractor, LevelWindow, Method, Neighbours};
    ///
    /// let voxel = |level: u32, [x, y, z]: [i32; 3]| 9.3 - f64::from((x * x + y * y + z * z) << (2 * level)).sqrt() as f32;
    ///
    /// let grid = Grid::try_new([0.0; 3], 1.0)?;
    /// let mut extractor = LevelExtractor::try_new(&grid, &Method::Cubes(Cubes::default()), &ChunkSettings::default())?;
    /// let (level, cells) = (1, grid.coarser(1)?.chunk([0, 0, 0], 8));
    /// // Chunks of level 0 lie west of it.
    /// let neighbours = Neighbours::try_new(level, |[x, _, _]| if x < 0 { 0 } else { 1 })?;
    ///
    /// let mut samples = Vec::new();
    /// for (level, cells) in extractor.windows(level, cells, &neighbours)? {
    ///     let mut of_window = Vec::new();
    ///     for z in cells.start[2]..=cells.end[2] {
    ///         for y in cells.start[1]..=cells.end[1] {
    ///             of_window.extend((cells.start[0]..=cells.end[0]).map(|x| voxel(level, [x, y, z])));
    ///         }
    ///     }
    ///     samples.push((level, cells, of_window));
    /// }
    /// let windows: Vec<LevelWindow> =
    ///     samples.iter().map(|(level, cells, samples)| LevelWindow { level: *level, cells: *cells, samples }).collect();
    /// let mut chunk = Chunk::default();
    /// extractor.extract_samples_into(&windows, level, cells, &neighbours, Control::default(), &mut chunk)?;
    /// assert!(chunk.seam > 10);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`extract_into`](Self::extract_into); [`LevelError::Samples`], [`LevelError::Missing`], [`LevelError::Disagree`]; [`LevelError::Chunk`] for a
    /// method or normals that need a field.
    pub fn extract_samples_into<'c>(
        &mut self,
        given: &[LevelWindow],
        level: u32,
        cells: CellBox,
        neighbours: &Neighbours,
        control: impl Into<Control<'c>>,
        chunk: &mut Chunk,
    ) -> Result<(), LevelError> {
        let job =
            Job { given: Given::Windows(Windows(given)), level, cells, neighbours, control: control.into() };
        let result = self.of_windows(Windows(given), &job, chunk);
        if result.is_err() {
            chunk.clear();
        }
        result
    }

    fn of_windows(&mut self, given: Windows, job: &Job, chunk: &mut Chunk) -> Result<(), LevelError> {
        given.check()?;
        for (level, cells) in self.windows(job.level, job.cells, job.neighbours)? {
            given.has(level, cells)?;
        }
        if !self.settings.relative {
            return self.work(job, chunk);
        }
        // A window of a level far finer may begin elsewhere than at a corner of the chunk's level; the chunk does not.
        let start = job.cells.start;
        let moved: Vec<LevelWindow> =
            given.0.iter().map(|window| window.seen_from(job.level, start)).collect();
        self.relative(Job { given: Given::Windows(Windows(&moved)), ..*job }, chunk)
    }

    /// Extracts a box as if it began at the origin.
    fn relative(&mut self, job: Job, chunk: &mut Chunk) -> Result<(), LevelError> {
        let start = job.cells.start;
        if start.iter().any(|i| i % 2 != 0) && (0..27).any(|i| job.neighbours.step(DIRECTIONS[i]) > 0) {
            return Err(LevelError::Odd { cells: job.cells });
        }
        self.at(job.level)?.window(job.cells)?;
        let cells = relative::moved(job.cells, back(start));
        self.work(&Job { cells, ..job }, chunk)?;
        let world = World::of_level(self.grid_of(job.level)?, self.method, self.settings, job.level);
        relative::name(chunk, job.level, start, world);
        Ok(())
    }

    fn work(&mut self, job: &Job, chunk: &mut Chunk) -> Result<(), LevelError> {
        let Job { given, level, cells, neighbours, control } = *job;
        if level == 0 && neighbours.has_finer() {
            return Err(LevelError::Finest);
        }
        self.extract_box(level, given, cells, control, chunk)?;
        chunk.level = level;
        match self.kind {
            #[cfg(feature = "cubes")]
            LevelKind::Cubes(faces) => self.cubes(faces, job, chunk)?,
            LevelKind::Duals { is_sharp } => self.duals(is_sharp, job, chunk)?,
        }
        chunk.close_level(level);
        Ok(())
    }

    /// Makes the cells at finer neighbours anew.
    #[cfg(feature = "cubes")]
    fn cubes(&mut self, faces: Faces, job: &Job, chunk: &mut Chunk) -> Result<(), LevelError> {
        let Job { given, level, cells, neighbours, control } = *job;
        let own = chunk.keys.len();
        if neighbours.dividing().next().is_some() {
            let (fine, divisions) = (level - 1, Divisions::new(cells, neighbours));
            let mut stitching = std::mem::take(&mut self.stitching);
            stitching.begin(&divisions, chunk)?;
            for cells in layers(cells, neighbours) {
                self.extract_layer(fine, given, cells, control)?;
                stitching.learn(&self.layer, fine, &divisions, chunk)?;
                chunk.also_sampled(&self.layer);
            }
            let grid = self.frame(fine)?;
            let ChunkSettings { isovalue, normals, .. } = self.settings;
            let samples = given.samples(fine, &grid);
            let values = given.values(samples.as_ref());
            let decision = Decision { faces, values, isovalue, normals, grid: &grid };
            stitching.fill(&decision, &divisions, chunk)?;
            self.stitching = stitching;
        }
        chunk.keys[..own].iter_mut().for_each(|key| *key = key.at_level(level));
        Ok(chunk.drop_unused(|_| false)?)
    }

    /// Puts polygons of several levels in the place of those at sides whose neighbours are of another level.
    fn duals(&mut self, is_sharp: bool, job: &Job, chunk: &mut Chunk) -> Result<(), LevelError> {
        let Job { given, level, cells, neighbours, control } = *job;
        let own = chunk.keys.len();
        let grid = |step: i32| level.checked_add_signed(step).and_then(|level| self.frame(level).ok());
        let grids = [grid(-1), grid(0), grid(1)];
        let step = [-1, 0, 1];
        let samples = [0, 1, 2].map(|i| {
            let there = grids[i].as_ref()?;
            given.samples(level.saturating_add_signed(step[i]), there)
        });
        let seams = Seams {
            values: [0, 1, 2].map(|i| given.values(samples[i].as_ref().or(samples[1].as_ref()))),
            isovalue: self.settings.isovalue,
            normals: self.settings.normals,
            is_sharp,
            level,
            cells,
            neighbours,
            grids,
        };
        self.known.clear();
        for Needed { step, cells } in seams.needed()? {
            let there = level.saturating_add_signed(step);
            self.extract_layer(there, given, cells, control)?;
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
        given: Given,
        cells: CellBox,
        control: Control,
    ) -> Result<(), LevelError> {
        let mut layer = std::mem::take(&mut self.layer);
        let extracted = self.extract_box(level, given, cells, control, &mut layer);
        self.layer = layer;
        extracted
    }

    /// Extracts cells of a level, without seams.
    fn extract_box(
        &mut self,
        level: u32,
        given: Given,
        cells: CellBox,
        control: Control,
        chunk: &mut Chunk,
    ) -> Result<(), LevelError> {
        let windows = match given {
            Given::Field(source, _) => {
                self.at(level)?.extract_into(source, cells, control, chunk)?;
                return Ok(());
            }
            Given::Windows(windows) => windows,
        };
        let mut derived = std::mem::take(&mut self.derived);
        let mut extract = || {
            let extractor = self.at(level)?;
            let window = extractor.window(cells)?.ok_or(LevelError::Method)?;
            let (cells_given, samples) = windows.of_box(level, window, &mut derived)?;
            extractor.extract_into(Source::Window { cells: cells_given, samples }, cells, control, chunk)?;
            Ok(())
        };
        let extracted = extract();
        self.derived = derived;
        extracted
    }

    /// The grid that chunks of a level are extracted in.
    fn frame(&self, level: u32) -> Result<Grid, LevelError> {
        let grid = self.grid_of(level)?;
        Ok(if self.settings.relative { grid.at_origin() } else { grid })
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
            None => {
                // Where positions are relative, cells begin at the origin already.
                let settings = self.settings.with_relative_positions(false);
                ChunkExtractor::try_new(&self.frame(level)?, &self.method, &settings)?
            }
        };
        Ok(self.extractors[i].insert(made))
    }
}

/// How seams of a method are made.
#[derive(Debug, Clone, Copy)]
enum LevelKind {
    /// Coarse cells take what finer ones have on their sides.
    #[cfg(feature = "cubes")]
    Cubes(Faces),
    /// Polygons round minimal edges.
    Duals {
        /// Whether vertices are where tangent planes meet.
        is_sharp: bool,
    },
}

impl LevelKind {
    /// `None` for a method without levels.
    fn of(method: &Method) -> Option<Self> {
        match method {
            #[cfg(feature = "cubes")]
            Method::Cubes(cubes) => Some(Self::Cubes(cubes.faces)),
            #[cfg(feature = "surface-nets")]
            Method::SurfaceNets(nets) => (!nets.patches).then_some(Self::Duals { is_sharp: false }),
            #[cfg(feature = "dual-contouring")]
            Method::DualContouring(nets) => (!nets.patches).then_some(Self::Duals { is_sharp: true }),
            _ => None,
        }
    }
}

/// What is to be extracted.
#[derive(Clone, Copy)]
struct Job<'a> {
    given: Given<'a>,
    level: u32,
    cells: CellBox,
    neighbours: &'a Neighbours,
    control: Control<'a>,
}

/// What is extracted from.
#[derive(Clone, Copy)]
enum Given<'a> {
    /// As it came, and for seams.
    Field(Source<'a>, &'a dyn StudyField),
    Windows(Windows<'a>),
}

impl<'a> Given<'a> {
    /// The samples of a level, if there are samples.
    fn samples(self, level: u32, grid: &Grid) -> Option<LevelSamples<'a>> {
        match self {
            Self::Field(..) => None,
            Self::Windows(windows) => Some(LevelSamples { windows, level, grid: *grid }),
        }
    }

    /// What seams ask for values.
    fn values(self, samples: Option<&'a LevelSamples<'a>>) -> Values<'a> {
        match (self, samples) {
            (Self::Field(_, field), _) => Values::Field(field),
            (Self::Windows(_), Some(samples)) => Values::Samples(samples),
            (Self::Windows(_), None) => unreachable!("the own level has samples"),
        }
    }
}
