//! Extraction of one chunk after the other.

mod warm_up;

use std::fmt;

use glam::Vec3;
use isostudy_field::{Aabb, Plain, StoredSamples, StudyField, Watched};

use super::chunk::Chunk;
use super::error::ChunkError;
use super::layout::SampleLayout;
use super::part::cut_out;
#[cfg(feature = "tetrahedra")]
use super::piece::collapsed;
use super::relative::{self, Seen, back};
use super::settings::{ChunkSettings, Normals};
use super::settled::{MOST_EXTRA, Settled};
use super::world::{Place, World};
use crate::execution::control::Control;
use crate::extraction::{ExtractError, Extraction, check};
use crate::extractor::{Extractor, Way};
use crate::lattice::BoxGrid;
use crate::lattice::endless::Grid;
use crate::lattice::{Arrangement, Border, CellBox, Lattice};
use crate::memory::refill;
use crate::method::{Method, MethodError};
use crate::placement::FieldTargets;
use crate::sampling::level::Level;
use crate::settings::{ExtractSettings, Placement, Positions};
use crate::source::{NormalsOf, Source};
use crate::surface::normals::accumulate;

/// Of what decides about a surface component, this much is tried at first beyond the chunk.
const FIRST_MARGIN: u32 = 8;
/// Cells at either end of `i32` that no chunk of a grid without an end has, so that there is room for windows.
const MARGIN: i32 = 1 << 10;

/// Extracts boxes of cells of a grid, such that neighbours fit to the bit, and all of a box [weld](crate::weld_chunks) to
/// the mesh that [`extract`](crate::by_lattice::extract) makes of the whole, byte for byte.
///
/// To decide as the whole would, more is sampled than the chunk's own cells ([`window`](Self::window)): two cells on every
/// side, or one where cubes are cut each by itself ([`Arrangement`](crate::Arrangement)) or not at all
/// ([`Cubes`](crate::Cubes)), or three for duals with patches; one more with [`Placement::Projected`],
/// two with [`Placement::Relaxed`], and one for each step of [`SurfaceNets::smoothing`](crate::SurfaceNets::smoothing). Edges
/// collapse in an order that runs through a whole connected piece of surface, and an early collapse can decide a late one anywhere on it: with edge collapse the window therefore grows until it holds
/// every piece of surface that enters the chunk, if need be to the whole box, and there must be one. For terrain that
/// is edited all the time take [`Clustering::Integrated`](crate::Clustering), which regularises triangles without
/// looking farther than a neighbour.
///
/// Its buffers are used again, wherever the next chunk is: from the second one of a size on,
/// [`extract_into`](Self::extract_into) allocates nothing on the calling thread alone, as long as the surface does not outgrow
/// those before it and no edge is collapsed. The exceptions are small: tables of integrated clustering that a point is the first to
/// need, but after [`reserve`](Self::reserve); what [`Clustering::Warp`](crate::Clustering::Warp) keeps of a chunk's edges; steps of
/// [`SurfaceNets::smoothing`](crate::SurfaceNets::smoothing); nets in a cell at the window's side whose signs no chunk before had; and
/// faces and cells that [`Faces::Decider`](crate::Faces) or [`Faces::Trilinear`](crate::Faces) can only decide without rounding.
///
/// ```
/// use isostudy_extract::{Arrangement, Chunk, ChunkExtractor, ChunkSettings, Control, Grid, Method, Tetrahedra, from_fn};
///
/// let grid = Grid::try_new([0.0; 3], 0.1)?;
/// let method = Method::Tetrahedra(Tetrahedra::new(Arrangement::BodyCentred));
/// let mut extractor = ChunkExtractor::try_new(&grid, &method, &ChunkSettings::default())?;
/// let ball = from_fn(|[x, y, z]| 1.0 - (x * x + y * y + z * z).sqrt());
/// let mut chunk = Chunk::default();
/// extractor.extract_into(&ball, grid.chunk([-1, 0, 0], 16), Control::default(), &mut chunk)?;
/// assert!(chunk.triangles.len() > 500 && chunk.positions.iter().all(|p| p[0] < 0.1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A box in chunks is the whole:
///
/// ```
/// use isostudy_extract::{Arrangement, BoxGrid, ChunkExtractor, ChunkSettings, Control, Method, Tetrahedra, weld_chunks};
/// use isostudy_extract::by_lattice::{ExtractSettings, extract};
/// use isostudy_extract::Execution;
/// use isostudy_field::{Sphere, StudyField};
/// # use glam::Vec3;
/// # use isostudy_mesh::Bounds;
/// # let bounds = Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) };
/// let grid = BoxGrid { bounds, spacing: 0.05 };
/// let method = Method::Tetrahedra(Tetrahedra::new(Arrangement::BodyCentred));
/// let sphere: &dyn StudyField = &Sphere { radius: 1.0 };
/// let mut extractor = ChunkExtractor::in_box(&grid, &method, &ChunkSettings::default())?;
/// let mut chunks = Vec::new();
/// for cells in extractor.grid(16) {
///     chunks.push(extractor.extract(sphere, cells, Control::default())?);
/// }
/// let lattice = grid.lattice(Arrangement::BodyCentred)?;
/// let whole = extract(sphere, &lattice, &ExtractSettings::default(), &Execution::default())?;
/// assert_eq!(weld_chunks(&chunks)?, whole.mesh);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ChunkExtractor {
    world: World,
    how: ByWindow,
    /// Of a box, its lattice.
    whole: Option<Lattice>,
    /// `None` with edge collapse.
    halo: Option<u32>,
    extractor: Extractor,
    extraction: Extraction,
    samples: Vec<f32>,
    numbers: Vec<u32>,
    targets: FieldTargets,
    settled: Settled,
}

impl fmt::Debug for ChunkExtractor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ChunkExtractor").field("world", &self.world).finish_non_exhaustive()
    }
}

impl ChunkExtractor {
    /// An extractor for chunks of a grid without an end, without buffers yet.
    ///
    /// # Errors
    /// [`ChunkError::Settings`], [`ChunkError::Method`], [`ChunkError::Accumulated`], [`ChunkError::Placement`], [`ChunkError::EndlessCollapse`], and
    /// [`ChunkError::Extract`] where the method's settings do not go together or the isovalue is not finite.
    pub fn try_new(grid: &Grid, method: &Method, settings: &ChunkSettings) -> Result<Self, ChunkError> {
        let extractor = Self::new(Place::Endless(*grid), method, settings)?;
        if extractor.halo.is_none() {
            return Err(ChunkError::EndlessCollapse);
        }
        Ok(extractor)
    }

    /// The same for a box of cells, which ends where the box does.
    ///
    /// # Errors
    /// The same, but for [`ChunkError::EndlessCollapse`]; [`ChunkError::Extract`] if the box is no grid for the method, too.
    pub fn in_box(grid: &BoxGrid, method: &Method, settings: &ChunkSettings) -> Result<Self, ChunkError> {
        if settings.relative {
            return Err(ChunkError::RelativeInBox);
        }
        Self::new(Place::Box(*grid), method, settings)
    }

    fn new(place: Place, method: &Method, settings: &ChunkSettings) -> Result<Self, ChunkError> {
        method.family().check_own()?;
        let how = ByWindow::new(method, settings.isovalue).ok_or(ChunkError::Method)?;
        let world = World { place, method: *method, settings: *settings, level: None };
        let ByWindow { arrangement, settings, .. } = how;
        check(&settings, arrangement)?;
        if settings.positions != Positions::Indexed {
            return Err(ChunkError::Accumulated);
        }
        let (placement, refine_crossings) = (settings.placement, settings.refine_crossings);
        let moves_here = match placement {
            Placement::MeanOfCrossings => true,
            Placement::Projected | Placement::Relaxed => !settings.clustering.collapses(),
            Placement::CurvatureWeighted => false,
        };
        if !moves_here || refine_crossings {
            return Err(ChunkError::Placement { placement, refine_crossings });
        }
        let whole = match place {
            Place::Endless(_) => None,
            Place::Box(grid) => Some(grid.lattice(arrangement)?),
        };
        let mut extractor = Extractor::new();
        let family = method.family();
        let (normals, halo) = match world.settings.normals {
            Normals::Triangles | Normals::Field => (NormalsOf::Triangles, family.halo()),
            Normals::Samples => {
                let halo = family.halo_with_normals_of_samples().ok_or(ChunkError::NormalsNeedSamples)?;
                (NormalsOf::Samples, Some(halo))
            }
            Normals::None => (NormalsOf::Nothing, family.halo_without_normals()),
        };
        extractor.normals = normals;
        extractor.traced =
            world.settings.keys || normals == NormalsOf::Triangles || !family.makes_wanted_alone();
        Ok(Self {
            world,
            how,
            whole,
            halo,
            extractor,
            extraction: Extraction::default(),
            samples: Vec::new(),
            numbers: Vec::new(),
            targets: FieldTargets::default(),
            settled: Settled::default(),
        })
    }

    /// What its chunks are chunks of.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The box in boxes of so many cells a side, x fastest; the last ones on each axis may be smaller. With 0 there are none,
    /// and none of a grid without an end.
    pub fn grid(&self, cells: u32) -> impl Iterator<Item = CellBox> + use<> {
        let all = self.whole.as_ref().map_or([0; 3], Lattice::cells);
        let [nx, ny, nz] = all.map(|n| n.checked_div(cells).map_or(0, |_| n.div_ceil(cells)));
        let boxes = (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
        boxes.map(move |place| {
            let start = place.map(|i| i * cells);
            let end = [0, 1, 2].map(|axis| start[axis].saturating_add(cells).min(all[axis]));
            CellBox { start: start.map(|i| i as i32), end: end.map(|i| i as i32) }
        })
    }

    /// The cells whose samples the chunk of a box depends on. `None` with edge collapse, where the surface decides.
    ///
    /// # Errors
    /// [`ChunkError::Cells`].
    pub fn window(&self, cells: CellBox) -> Result<Option<CellBox>, ChunkError> {
        let whole = self.check(cells)?;
        Ok(self.halo.map(|halo| cells.grown(halo, &whole)))
    }

    /// Where the samples of a box of cells are in a [`Source::Window`].
    ///
    /// # Errors
    /// [`ChunkError::Cells`]; [`ChunkError::Extract`] for more samples than there may be.
    pub fn layout(&self, cells: CellBox) -> Result<SampleLayout, ChunkError> {
        self.check(cells)?;
        Ok(SampleLayout::new(self.lattice(cells)?, Border::of(&self.how.settings)))
    }

    /// Extracts the surface in a box of cells, as [`extract_into`](Self::extract_into).
    ///
    /// # Errors
    /// The same.
    pub fn extract<'s, 'c>(
        &mut self,
        source: impl Into<Source<'s>>,
        cells: CellBox,
        control: impl Into<Control<'c>>,
    ) -> Result<Chunk, ChunkError> {
        let mut chunk = Chunk::default();
        self.extract_into(source, cells, control, &mut chunk)?;
        Ok(chunk)
    }

    /// Extracts the surface in a box of cells into `chunk`, whose vectors are used again. After an error it is empty and of no
    /// world; the extractor is as good as before.
    ///
    /// The chunk depends on the source, the grid, the method, the settings and the box, never on `control`. With chunks in
    /// several threads, each with an extractor of its own, the calling thread alone is best, which is the default.
    ///
    /// # Errors
    /// [`ChunkError::Cells`], [`ChunkError::Window`], [`ChunkError::EndlessSamples`], [`ChunkError::NormalsNeedField`],
    /// [`ChunkError::Unsettled`]; [`ChunkError::Extract`] for what [`extract`](crate::by_lattice::extract) refuses.
    pub fn extract_into<'s, 'c>(
        &mut self,
        source: impl Into<Source<'s>>,
        cells: CellBox,
        control: impl Into<Control<'c>>,
        chunk: &mut Chunk,
    ) -> Result<(), ChunkError> {
        let (source, control) = (source.into(), control.into());
        let result = match self.world.settings.relative {
            true => self.relative(source, cells, control, chunk),
            false => self.absolute(source, cells, control, chunk),
        };
        if result.is_err() {
            chunk.clear();
        }
        result
    }

    /// Extracts a box as if it began at the origin.
    fn relative(
        &mut self,
        source: Source,
        cells: CellBox,
        control: Control,
        chunk: &mut Chunk,
    ) -> Result<(), ChunkError> {
        self.check(cells)?;
        let (start, corner) = (cells.start, self.world.position(cells.start));
        let here = relative::moved(cells, back(start));
        match source {
            Source::Field(field) => {
                let seen = Seen { field, corner };
                self.absolute(Source::Field(&seen), here, control, chunk)
            }
            Source::Study(field) => {
                let seen = Seen { field, corner };
                self.absolute(Source::Study(&seen), here, control, chunk)
            }
            Source::Window { cells, samples } => {
                let cells = relative::moved(cells, back(start));
                self.absolute(Source::Window { cells, samples }, here, control, chunk)
            }
            Source::Samples(_) | Source::Stored(_) | Source::Bricks(_) => Err(ChunkError::EndlessSamples),
        }?;
        relative::name(chunk, 0, start, self.world);
        Ok(())
    }

    fn absolute(
        &mut self,
        source: Source,
        cells: CellBox,
        control: Control,
        chunk: &mut Chunk,
    ) -> Result<(), ChunkError> {
        match source {
            // In debug builds somebody looks whether it keeps its promises.
            Source::Field(field) if cfg!(debug_assertions) => {
                self.of_field(&Watched::new(field), cells, control, chunk)
            }
            Source::Field(field) => self.of_field(&Plain(field), cells, control, chunk),
            Source::Study(field) => self.of_field(field, cells, control, chunk),
            Source::Samples(samples) => match &self.whole {
                Some(whole) => {
                    let whole = whole.cell_box();
                    self.of_samples((whole, samples), cells, control, chunk)
                }
                None => Err(ChunkError::EndlessSamples),
            },
            Source::Stored(samples) => match &self.whole {
                Some(whole) => {
                    let whole = whole.clone();
                    self.of_stored(&whole, samples, cells, control, chunk)
                }
                None => Err(ChunkError::EndlessSamples),
            },
            // A chunk reads its own window alone.
            Source::Bricks(bricks) => {
                self.absolute(Source::Samples(bricks.samples().values()), cells, control, chunk)
            }
            Source::Window { cells: given, samples } => {
                self.of_samples((given, samples), cells, control, chunk)
            }
        }
    }

    fn of_samples(
        &mut self,
        (given, samples): (CellBox, &[f32]),
        cells: CellBox,
        control: Control,
        chunk: &mut Chunk,
    ) -> Result<(), ChunkError> {
        self.check_that_samples_suffice()?;
        self.check(given)?;
        let lattice = self.lattice(given)?;
        let (found, wanted) = (samples.len() as u64, lattice.stored_samples());
        if found != wanted {
            return Err(ExtractError::SampleCount { given: found, wanted }.into());
        }
        self.by_windows(Given::Samples(&lattice, samples), cells, control, chunk)
    }

    /// Of samples that are not in memory: those of each window are read.
    fn of_stored(
        &mut self,
        whole: &Lattice,
        samples: &dyn StoredSamples,
        cells: CellBox,
        control: Control,
        chunk: &mut Chunk,
    ) -> Result<(), ChunkError> {
        self.check_that_samples_suffice()?;
        let (given, wanted) = (samples.counts(), whole.stored_grid().map(|n| n as usize));
        if given != wanted {
            return Err(ExtractError::StoredCounts { given, wanted }.into());
        }
        self.by_windows(Given::Stored(whole, samples), cells, control, chunk)
    }

    /// # Errors
    /// If a field is wanted, between the samples or for normals.
    fn check_that_samples_suffice(&self) -> Result<(), ChunkError> {
        crate::placement::check(&self.how.settings, false)?;
        if self.world.method.family().calls_the_field_always() {
            return Err(MethodError::NeedsField.into());
        }
        match self.world.settings.normals {
            Normals::Field => Err(ChunkError::NormalsNeedField),
            _ => Ok(()),
        }
    }

    fn of_field(
        &mut self,
        field: &dyn StudyField,
        cells: CellBox,
        control: Control,
        chunk: &mut Chunk,
    ) -> Result<(), ChunkError> {
        if self.world.settings.normals == Normals::Samples {
            return Err(ChunkError::NormalsNeedSamples);
        }
        self.by_windows(Given::Field(field), cells, control, chunk)?;
        if self.world.settings.normals == Normals::Field {
            let (isovalue, spacing) = (self.how.settings.isovalue, self.spacing());
            let level = Level { field, isovalue, spacing };
            for (p, normal) in chunk.positions.iter().zip(&mut chunk.normals) {
                if let Some(outward) = level.normal(Vec3::from(*p)) {
                    *normal = outward.to_array();
                }
            }
        }
        Ok(())
    }

    /// Finds the window that decides, and cuts the chunk out of its surface.
    fn by_windows(
        &mut self,
        given: Given,
        cells: CellBox,
        control: Control,
        chunk: &mut Chunk,
    ) -> Result<(), ChunkError> {
        let whole = self.check(cells)?;
        let placement = self.how.settings.placement;
        let Some(halo) = self.halo else {
            return self.by_growing_windows(given, cells, whole, control, chunk);
        };
        let mut extra = 0;
        loop {
            let window = cells.grown(halo + extra, &whole);
            let is_settled = if let Given::Field(field) = given
                && self.is_on_one_side(field, &self.lattice(window)?)
            {
                let lattice = self.lattice(window)?;
                self.start(chunk, cells, &lattice);
                chunk.close();
                return Ok(());
            } else {
                // Normals of triangles are of all that have a vertex of the chunk.
                let beyond = u32::from(self.extractor.normals == NormalsOf::Triangles);
                let wanted = (placement == Placement::MeanOfCrossings).then(|| cells.grown(beyond, &window));
                let lattice = self.extract_window(given, window, wanted, control)?;
                let is_settled = match given {
                    #[cfg(any(feature = "tetrahedra", feature = "cubes"))]
                    Given::Field(field) if placement.calls_the_field() => {
                        self.move_vertices(field, cells, &lattice, &whole, control)?
                    }
                    _ => true,
                };
                self.start(chunk, cells, &lattice);
                is_settled.then_some(lattice)
            };
            if let Some(lattice) = is_settled {
                let (mesh, trace) = (&self.extraction.mesh, self.extractor.trace());
                cut_out(mesh, trace, &lattice, &mut self.numbers, &self.world.settings, chunk)?;
                chunk.close();
                return Ok(());
            }
            extra = (2 * extra).max(4);
            if extra > MOST_EXTRA {
                return Err(ChunkError::Unsettled);
            }
        }
    }

    /// Where edges are collapsed: lets the window grow until it holds every piece of surface that enters the chunk.
    #[cfg(feature = "tetrahedra")]
    fn by_growing_windows(
        &mut self,
        given: Given,
        cells: CellBox,
        whole: CellBox,
        control: Control,
        chunk: &mut Chunk,
    ) -> Result<(), ChunkError> {
        let (halo, normals) = (self.how.halo, self.world.settings.normals);
        let mut margin = halo + FIRST_MARGIN;
        loop {
            let window = cells.grown(margin, &whole);
            let lattice = self.extract_window(given, window, None, control)?;
            self.start(chunk, cells, &lattice);
            chunk.numbered_by_use = true;
            let (mesh, trace) = (&self.extraction.mesh, &self.extractor.trace);
            let as_in_whole = window.shrunk(halo, &whole);
            let looks = (self.how.settings.topology, normals);
            if collapsed(mesh, trace, &lattice, as_in_whole, looks, chunk)? {
                if !self.world.settings.keys {
                    chunk.keys.clear();
                    chunk.triangle_cells.clear();
                }
                chunk.close();
                return Ok(());
            }
            margin = margin.saturating_mul(2);
        }
    }

    #[cfg(not(feature = "tetrahedra"))]
    fn by_growing_windows(
        &mut self,
        _: Given,
        _: CellBox,
        _: CellBox,
        _: Control,
        _: &mut Chunk,
    ) -> Result<(), ChunkError> {
        unreachable!("only tetrahedra have edges that collapse")
    }

    /// All cells that there are.
    fn check(&self, cells: CellBox) -> Result<CellBox, ChunkError> {
        let whole = match &self.whole {
            Some(whole) => whole.cell_box(),
            None => CellBox { start: [i32::MIN + MARGIN; 3], end: [i32::MAX - MARGIN; 3] },
        };
        if cells.is_empty() || !whole.contains_box(&cells) {
            return Err(ChunkError::Cells { given: cells, whole });
        }
        Ok(if self.whole.is_some() { whole } else { CellBox { start: [i32::MIN; 3], end: [i32::MAX; 3] } })
    }

    /// The cells of a box as a lattice.
    fn lattice(&self, cells: CellBox) -> Result<Lattice, ChunkError> {
        match (&self.whole, &self.world.place) {
            (Some(whole), _) => Ok(whole.window(cells)?),
            (None, Place::Endless(grid)) => {
                let grid = if self.world.settings.relative { grid.at_origin() } else { *grid };
                Ok(Lattice::endless(self.how.arrangement, &grid, cells)?)
            }
            (None, Place::Box(grid)) => Ok(grid.lattice(self.how.arrangement)?.window(cells)?),
        }
    }

    fn spacing(&self) -> f32 {
        match &self.world.place {
            Place::Endless(grid) => grid.spacing() as f32,
            Place::Box(grid) => grid.spacing,
        }
    }

    fn start(&self, chunk: &mut Chunk, cells: CellBox, window: &Lattice) {
        chunk.start(&self.world, cells, window.cell_box(), Aabb::from(window.sampled_bounds()));
    }

    /// Whether the field says that no surface is in a window. What streaming would find out, without its preparations.
    fn is_on_one_side(&self, field: &dyn StudyField, window: &Lattice) -> bool {
        let bounds = window.sampled_bounds();
        // Some fields can tell without a value.
        let range = field.range(bounds, f32::NAN).and_then(|(low, high)| {
            let needs_value = low.is_nan() || high.is_nan();
            if needs_value {
                field.range(bounds, field.sample((bounds.min + bounds.max) * 0.5))
            } else {
                Some((low, high))
            }
        });
        range
            .is_some_and(|(low, high)| low > self.how.settings.isovalue || high <= self.how.settings.isovalue)
    }

    /// Extracts the lattice within a box, or the cells of it that are `wanted`, with its trace, before vertices are moved or edges collapsed.
    fn extract_window(
        &mut self,
        given: Given,
        window: CellBox,
        wanted: Option<CellBox>,
        control: Control,
    ) -> Result<Lattice, ChunkError> {
        let lattice = self.lattice(window)?;
        let source = match given {
            Given::Field(field) => Source::Study(field),
            Given::Samples(from, samples) if from.cell_box() == window => Source::Samples(samples),
            Given::Samples(from, samples) => {
                if !from.cell_box().contains_box(&window) {
                    return Err(ChunkError::Window { given: from.cell_box(), wanted: window });
                }
                let size = lattice.stored_grid().map(|n| n as usize);
                let [stride, rows, _] = from.stored_grid().map(|n| n as usize);
                let (first, all) = (lattice.first_stored(), from.first_stored());
                let [x, y, z] = [0, 1, 2].map(|axis| (first[axis] - all[axis]) as usize);
                self.samples.clear();
                self.samples.try_reserve(size.iter().product())?;
                for (k, j) in (0..size[2]).flat_map(|k| (0..size[1]).map(move |j| (k, j))) {
                    let start = ((z + k) * rows + y + j) * stride + x;
                    self.samples.extend_from_slice(&samples[start..start + size[0]]);
                }
                Source::Samples(&self.samples)
            }
            Given::Stored(from, samples) => {
                let size = lattice.stored_grid().map(|n| n as usize);
                let (first, all) = (lattice.first_stored(), from.first_stored());
                let first = [0, 1, 2].map(|axis| (first[axis] - all[axis]) as usize);
                self.samples.clear();
                refill(&mut self.samples, size.iter().product(), 0.0)?;
                samples.read_box(first, size, &mut self.samples).map_err(ExtractError::Unread)?;
                Source::Samples(&self.samples)
            }
        };
        let settings = ExtractSettings {
            clustering: self.how.settings.clustering.before_collapse(),
            placement: Placement::MeanOfCrossings,
            ..self.how.settings
        };
        let extraction = &mut self.extraction;
        self.extractor.wanted = wanted;
        self.extractor.extract_by(self.how.way, source, &lattice, &settings, control, extraction)?;
        Ok(lattice)
    }

    /// Moves the vertices of a window to where the placement wants them. `false` if it is not large enough to know for all
    /// that the chunk depends on.
    #[cfg(any(feature = "tetrahedra", feature = "cubes"))]
    fn move_vertices(
        &mut self,
        field: &dyn StudyField,
        cells: CellBox,
        window: &Lattice,
        whole: &CellBox,
        control: Control,
    ) -> Result<bool, ChunkError> {
        let mesh = &mut self.extraction.mesh;
        let (placement, isovalue) = (self.how.settings.placement, self.how.settings.isovalue);
        let level = Level { field, isovalue, spacing: window.spacing() };
        let (positions, triangles) = (&mut mesh.positions, &mesh.triangles);
        let (bounds, threads) = (window.bounds(), control.threads);
        let targets = self.targets.find(&level, &bounds, placement, threads, positions, triangles)?;
        // A target among its neighbours needs them all.
        let ring = self.halo.map_or(0, |halo| halo - 1);
        let known = window.cell_box().shrunk(ring, whole);
        // The normals of the chunk's vertices look at their neighbours.
        let wanted = cells.grown(1, whole);
        let is_settled = self.settled.advance(
            (positions, triangles, &self.extractor.trace),
            targets,
            window,
            [known, wanted],
        )?;
        mesh.normals.clear();
        if self.world.settings.normals != Normals::None {
            refill(&mut mesh.normals, mesh.positions.len(), Vec3::ZERO)?;
            accumulate(&mesh.positions, &mesh.triangles, &mut mesh.normals);
        }
        Ok(is_settled)
    }
}

/// What is given, as windows are cut from it.
#[derive(Clone, Copy)]
enum Given<'a> {
    Field(&'a dyn StudyField),
    /// Of a box, all samples.
    Samples(&'a Lattice, &'a [f32]),
    /// The same, to be read.
    Stored(&'a Lattice, &'a dyn StoredSamples),
}

/// How the cells of a window are extracted.
#[derive(Debug, Clone, Copy)]
struct ByWindow {
    arrangement: Arrangement,
    settings: ExtractSettings,
    /// By cubes that are not cut any further, which then are the arrangement's.
    way: Option<Way>,
    /// How many cells from the rim of a window on its mesh is that of the whole, before vertices are moved or edges
    /// collapsed.
    halo: u32,
}

impl ByWindow {
    /// `None` for a method that makes no chunks.
    fn new(method: &Method, isovalue: f32) -> Option<Self> {
        let family = method.family();
        let (arrangement, settings, way) = (family.arrangement(), family.settings(isovalue), family.way());
        Some(Self { arrangement, settings, way, halo: family.unmoved_halo()? })
    }
}
