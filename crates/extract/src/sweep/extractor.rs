//! The driver: slabs to threads, pieces to one mesh.

use std::collections::TryReserveError;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use glam::Vec3;
use mesh::TriangleMesh;

use super::faces::FaceTables;
use super::grid::Grid;
use super::rule::{ClusterRule, Guarded, Published, Unclustered};
use super::slab::{Job, Piece, SlabTimes, Workspace, sweep};
use super::source::Source;
use crate::extraction::{Counts, ExtractError, Extraction, StageTimes, check};
use crate::lattice::{Border, Lattice};
use crate::level::Level;
use crate::placement::{self, CrossingPlacer};
use crate::settings::{Clustering, Execution, ExtractSettings, Positions, Topology};
use crate::split;
use crate::spot::Apart;
use crate::stored;
use crate::trace::Trace;
use field::Kept;

/// Slabs a thread, so that an uneven surface still keeps all threads busy.
const SLABS_PER_THREAD: usize = 2;
/// A slab has at least this many layers: the halo on either side costs up to four more.
const LEAST_LAYERS: usize = 16;

/// Told how many layers of how many are done.
type Progress = Box<dyn Fn(usize, usize) + Send + Sync>;

/// An extractor that keeps its buffers, for one surface after another.
///
/// With indexed positions it streams: memory grows with a layer of the lattice and with the mesh. From the second
/// volume of a size on, with one thread, unless edges are collapsed or vertices placed otherwise than at the mean of
/// interpolated crossings, [`extract_into`](Self::extract_into) allocates nothing, as long as the surface does not
/// outgrow those before it; an [`Asteroid`](field::Asteroid) other than the one before has its tables made again.
///
/// ```
/// use extract::{Arrangement, Execution, ExtractSettings, Extraction, Extractor, Lattice};
/// use field::{ScalarField, Sphere};
/// # use glam::Vec3;
/// # use mesh::Bounds;
/// # let bounds = Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) };
/// let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.1)?;
/// let mut extractor = Extractor::new();
/// let mut extraction = Extraction::default();
/// for radius in [0.8, 0.9, 1.0] {
///     let sphere: &dyn ScalarField = &Sphere { radius };
///     let (settings, execution) = (ExtractSettings::default(), Execution { threads: 1 });
///     extractor.extract_into(sphere.into(), &lattice, &settings, &execution, &mut extraction)?;
///     assert_eq!(extraction.counts.vertices * 2, extraction.counts.triangles + 4);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Default)]
pub struct Extractor {
    plan: Option<Plan>,
    workspaces: Vec<Workspace>,
    pieces: Vec<Piece>,
    kept: Kept,
    progress: Option<Progress>,
    /// Where the last mesh came from, if `traced`.
    pub(crate) trace: Trace,
    pub(crate) traced: bool,
    pub(super) most_vertices: MostVertices,
}

/// How many vertices a mesh may have.
#[derive(Debug, Clone, Copy)]
pub(super) struct MostVertices(pub(super) u32);

impl Default for MostVertices {
    /// What a 32-bit index can name.
    fn default() -> Self {
        Self(u32::MAX)
    }
}

/// What depends on the lattice and its border alone; the tables on its arrangement only.
struct Plan {
    grid: Grid,
    tables: FaceTables,
}

impl Plan {
    /// The one there is, if it fits.
    fn new(lattice: &Lattice, border: Border, before: Option<Self>) -> Result<Self, TryReserveError> {
        match before {
            Some(plan) if plan.grid.lattice == *lattice && plan.grid.border == border => Ok(plan),
            Some(plan) if plan.grid.lattice.arrangement() == lattice.arrangement() => {
                Ok(Self { grid: Grid::new(lattice, border)?, tables: plan.tables })
            }
            _ => {
                let grid = Grid::new(lattice, border)?;
                let tables = FaceTables::new(&grid);
                Ok(Self { grid, tables })
            }
        }
    }
}

impl Extractor {
    /// An extractor without buffers yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Calls `progress` with the layers done and the layers there are, from any of the threads, while extracting.
    /// Does not apply to accumulated positions.
    pub fn with_progress(mut self, progress: impl Fn(usize, usize) + Send + Sync + 'static) -> Self {
        self.progress = Some(Box::new(progress));
        self
    }

    /// Extracts a surface, as [`extract`](crate::extract).
    ///
    /// # Errors
    /// As [`extract_into`](Self::extract_into).
    pub fn extract(
        &mut self,
        source: Source,
        lattice: &Lattice,
        settings: &ExtractSettings,
        execution: &Execution,
    ) -> Result<Extraction, ExtractError> {
        let mut extraction = Extraction::default();
        self.extract_into(source, lattice, settings, execution, &mut extraction)?;
        Ok(extraction)
    }

    /// Extracts a surface into `extraction`, whose vectors are used again. After an error it is empty.
    ///
    /// # Errors
    /// As [`extract`](crate::extract); [`ExtractError::SampleCount`] when given samples are not as many as the
    /// lattice has, [`ExtractError::SamplesAccumulated`] when they come with accumulated positions,
    /// [`ExtractError::PlacementNeedsField`] when they come with a placement that calls the field.
    pub fn extract_into(
        &mut self,
        source: Source,
        lattice: &Lattice,
        settings: &ExtractSettings,
        execution: &Execution,
        extraction: &mut Extraction,
    ) -> Result<(), ExtractError> {
        let result = self.try_extract_into(source, lattice, settings, execution, extraction);
        if result.is_err() {
            let TriangleMesh { positions, normals, triangles } = &mut extraction.mesh;
            positions.clear();
            normals.clear();
            triangles.clear();
            (extraction.counts, extraction.times) = Default::default();
        }
        result
    }

    fn try_extract_into(
        &mut self,
        source: Source,
        lattice: &Lattice,
        settings: &ExtractSettings,
        execution: &Execution,
        extraction: &mut Extraction,
    ) -> Result<(), ExtractError> {
        check(settings, lattice.arrangement())?;
        placement::check(settings, matches!(source, Source::Field(_)))?;
        if let Source::Samples(samples) = source {
            let (given, wanted) = (samples.len() as u64, lattice.stored_samples());
            if given != wanted {
                return Err(ExtractError::SampleCount { given, wanted });
            }
        }
        if settings.positions != Positions::Indexed {
            let Source::Field(field) = source else { return Err(ExtractError::SamplesAccumulated) };
            *extraction = stored::extract(field, lattice, settings, execution, self.most_vertices.0)?;
            return Ok(());
        }
        let start = Instant::now();
        let mut kept = std::mem::take(&mut self.kept);
        let prepared = match source {
            Source::Field(field) => field.prepared(&mut kept),
            Source::Samples(_) => None,
        };
        let source = prepared.map_or(source, Source::Field);
        if lattice.arrangement().uniform().is_none() {
            let trace = self.traced.then_some(&mut self.trace);
            let most = self.most_vertices.0;
            let result = split::extract(source, lattice, settings, execution, most, trace, extraction);
            self.kept = kept;
            return result;
        }
        let plan = Plan::new(lattice, Border::of(settings), self.plan.take()).map_err(|_| {
            ExtractError::OutOfMemory { bytes: lattice.memory_bytes_for(settings, execution) }
        })?;
        let arrangement = lattice.arrangement();
        let merges = match settings.clustering {
            Clustering::None | Clustering::EdgeCollapse => false,
            Clustering::Integrated | Clustering::IntegratedCollapse => true,
        };
        let result = match (merges, settings.topology) {
            (false, Topology::Guarded) => {
                self.run(&plan, &Unclustered::<false>, source, settings, execution, extraction, start)
            }
            (false, Topology::Published) => {
                self.run(&plan, &Unclustered::<true>, source, settings, execution, extraction, start)
            }
            (true, Topology::Guarded) => {
                let rule = Guarded::new(arrangement);
                self.run(&plan, &rule, source, settings, execution, extraction, start)
            }
            (true, Topology::Published) => {
                let rule = Published::new(arrangement);
                self.run(&plan, &rule, source, settings, execution, extraction, start)
            }
        };
        (self.plan, self.kept) = (Some(plan), kept);
        result
    }

    #[allow(clippy::too_many_arguments, reason = "the rest of `try_extract_into` for one rule")]
    fn run<R: ClusterRule>(
        &mut self,
        plan: &Plan,
        rule: &R,
        source: Source,
        settings: &ExtractSettings,
        execution: &Execution,
        extraction: &mut Extraction,
        start: Instant,
    ) -> Result<(), ExtractError> {
        let grid = &plan.grid;
        let layers = grid.size[2];
        let (threads, slabs) = threads_and_slabs(execution, layers);
        let bytes = grid.lattice.sweep_bytes(threads as u64);
        self.workspaces.resize_with(threads, Workspace::default);
        self.pieces.resize_with(slabs, Piece::default);
        for workspace in &mut self.workspaces {
            workspace.fit(grid, source).map_err(|_| ExtractError::OutOfMemory { bytes })?;
        }
        // The first piece is written where the whole mesh will be.
        self.pieces[0].positions = std::mem::take(&mut extraction.mesh.positions);
        self.pieces[0].surface.triangles = std::mem::take(&mut extraction.mesh.triangles);
        let allocation = start.elapsed();

        let sweeping = Instant::now();
        let done = AtomicUsize::new(0);
        let progress = |more: usize| {
            if let Some(progress) = &self.progress {
                progress(done.fetch_add(more, Ordering::Relaxed) + more, layers);
            }
        };
        let level = match source {
            Source::Field(field) => {
                Some(Level { field, isovalue: settings.isovalue, spacing: grid.lattice.spacing() })
            }
            Source::Samples(_) => None,
        };
        let placer = CrossingPlacer::new(&grid.lattice, settings, level);
        let job = Job {
            grid,
            tables: &plan.tables,
            rule,
            source,
            isovalue: settings.isovalue,
            apart: Apart::new(&grid.lattice, settings.topology),
            most_vertices: self.most_vertices.0,
            placer: placer.as_ref(),
            traced: self.traced,
            progress: &progress,
        };
        sweep_all(&job, &mut self.workspaces, &mut self.pieces)?;
        let mut times = shares(&self.pieces, sweeping.elapsed());
        times.allocation = allocation;

        let joining = Instant::now();
        let seams = join(&mut self.pieces, self.most_vertices.0)?;
        let (first, rest) = self.pieces.split_first_mut().expect("there is a slab");
        let crossing_ends: u64 =
            first.crossing_ends + rest.iter().map(|piece| piece.crossing_ends).sum::<u64>();
        if let Some(trace) = &mut first.surface.trace {
            std::mem::swap(&mut self.trace, trace);
        }
        let mesh = &mut extraction.mesh;
        mesh.positions = std::mem::take(&mut first.positions);
        let surface = &mut first.surface;
        let (lattice, targets) = (&grid.lattice, std::mem::take(&mut first.targets));
        let collapsing =
            placement::finish(level, lattice, settings, execution, &targets, &mut mesh.positions, surface)?;
        mesh.triangles = std::mem::take(&mut surface.triangles);
        times.clustering = collapsing.unwrap_or_default();
        times.geometry += joining.elapsed() - times.clustering;

        let making_normals = Instant::now();
        let seams = if collapsing.is_some() { None } else { Some(&seams) };
        make_normals(mesh, seams, threads)?;
        times.normals = making_normals.elapsed();

        extraction.times = times;
        extraction.counts = Counts::of(&grid.lattice, mesh, surface, crossing_ends / 2);
        Ok(())
    }
}

impl Lattice {
    /// What [`extract`](crate::extract) holds of the lattice at a time with these settings:
    /// [`memory_bytes`](Self::memory_bytes) or [`sweep_bytes`](Self::sweep_bytes). The mesh comes on top.
    pub fn memory_bytes_for(&self, settings: &ExtractSettings, execution: &Execution) -> u64 {
        match settings.positions {
            Positions::Indexed => {
                let layers = self.stored_grid()[2] as usize;
                self.sweep_bytes(threads_and_slabs(execution, layers).0 as u64)
            }
            Positions::Accumulated { .. } => self.memory_bytes(),
        }
    }
}

/// How many threads there is work for, and how many slabs they share.
pub(crate) fn threads_and_slabs(execution: &Execution, layers: usize) -> (usize, usize) {
    let threads = match execution.threads {
        0 => std::thread::available_parallelism().map_or(1, |n| n.get()),
        threads => threads,
    };
    let most = (layers / LEAST_LAYERS).max(1);
    let slabs = if threads == 1 { 1 } else { threads.saturating_mul(SLABS_PER_THREAD).min(most) };
    (threads.min(slabs), slabs)
}

/// Sweeps all slabs, each by the thread that comes first. Which one that is does not show.
fn sweep_all<R: ClusterRule>(
    job: &Job<R>,
    workspaces: &mut [Workspace],
    pieces: &mut [Piece],
) -> Result<(), ExtractError> {
    let layers = job.grid.size[2];
    let slabs = pieces.len();
    let slab = |i: usize| i * layers / slabs..(i + 1) * layers / slabs;
    if let ([workspace], [piece]) = (&mut *workspaces, &mut *pieces) {
        return sweep(job, slab(0), workspace, piece);
    }
    let threads = workspaces.len();
    let queue = std::sync::Mutex::new(pieces.iter_mut().enumerate());
    let work = |workspace: &mut Workspace| -> Result<(), ExtractError> {
        loop {
            let next = queue.lock().expect("no thread panics").next();
            let Some((i, piece)) = next else { return Ok(()) };
            sweep(job, slab(i), workspace, piece)?;
        }
    };
    std::thread::scope(|scope| {
        let (own, others) = workspaces.split_first_mut().expect("there is a thread");
        let handles = others
            .iter_mut()
            .map(|workspace| {
                std::thread::Builder::new()
                    .spawn_scoped(scope, || work(workspace))
                    .map_err(|error| ExtractError::Threads { threads, reason: error.to_string() })
            })
            .collect::<Result<Vec<_>, _>>()?;
        work(own)?;
        handles
            .into_iter()
            .try_for_each(|handle| handle.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })
}

/// Wall-clock time, divided as the threads spent theirs.
pub(crate) fn shares(pieces: &[Piece], elapsed: Duration) -> StageTimes {
    let sum = |of: fn(&SlabTimes) -> Duration| pieces.iter().map(|piece| of(&piece.times)).sum::<Duration>();
    let [sampling, vertex, geometry] = [sum(|t| t.sampling), sum(|t| t.vertex), sum(|t| t.geometry)];
    let all = (sampling + vertex + geometry).as_secs_f64().max(f64::MIN_POSITIVE);
    let share = |part: Duration| elapsed.mul_f64((part.as_secs_f64() / all).min(1.0));
    let (sampling, vertex) = (share(sampling), share(vertex));
    // The rest, so that nothing is lost to rounding.
    let geometry = elapsed.saturating_sub(sampling + vertex);
    StageTimes { sampling, vertex, geometry, ..StageTimes::default() }
}

/// A slab's part of the whole mesh.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seam {
    /// Vertices before the slab's own.
    vertices: usize,
    /// Triangles before `head` may touch vertices of the slab below; those from `tail` on, of the slab above.
    head: usize,
    tail: usize,
}

/// Appends all pieces to the first one, with vertex numbers of the whole.
pub(crate) fn join(pieces: &mut [Piece], most_vertices: u32) -> Result<Vec<Seam>, ExtractError> {
    let (first, rest) = pieces.split_first_mut().expect("there is a slab");
    let mut seams = Vec::new();
    if rest.is_empty() {
        return Ok(seams);
    }
    let total: usize = first.positions.len() + rest.iter().map(|piece| piece.positions.len()).sum::<usize>();
    if total as u64 > u64::from(most_vertices) {
        return Err(ExtractError::TooManyVertices { limit: most_vertices });
    }
    let triangles: usize = rest.iter().map(|piece| piece.surface.triangles.len()).sum();
    first.positions.try_reserve(total - first.positions.len()).map_err(|_| ExtractError::NoMemoryForMesh)?;
    first.surface.triangles.try_reserve(triangles).map_err(|_| ExtractError::NoMemoryForMesh)?;
    let targets: usize = rest.iter().map(|piece| piece.targets.len()).sum();
    first.targets.try_reserve(targets).map_err(|_| ExtractError::NoMemoryForMesh)?;
    seams.push(Seam { vertices: 0, head: first.head, tail: first.tail });
    for piece in rest {
        let base = first.surface.triangles.len();
        seams.push(Seam {
            vertices: first.positions.len(),
            head: base + piece.head,
            tail: base + piece.tail,
        });
        let shift = (first.positions.len() as u32).wrapping_sub(piece.below as u32);
        let global = |triangle: &[u32; 3]| triangle.map(|vertex| vertex.wrapping_add(shift));
        first.surface.triangles.extend(piece.surface.triangles.iter().map(global));
        first.positions.extend_from_slice(&piece.positions);
        first.targets.append(&mut piece.targets);
        if let (Some(whole), Some(trace)) = (&mut first.surface.trace, &mut piece.surface.trace) {
            whole.keys.append(&mut trace.keys);
            whole.cells.append(&mut trace.cells);
        }
        first.surface.tetrahedra_evaluated += piece.surface.tetrahedra_evaluated;
        first.surface.discarded += piece.surface.discarded;
        first.surface.discarded_as_published += piece.surface.discarded_as_published;
    }
    Ok(seams)
}

/// Area-weighted mean normals, as [`vertex_normals`](crate::normals::vertex_normals), to the bit: each vertex adds up
/// its triangles in their order. With seams, each thread does the vertices of a run of slabs.
pub(crate) fn make_normals(
    mesh: &mut TriangleMesh,
    seams: Option<&Vec<Seam>>,
    threads: usize,
) -> Result<(), ExtractError> {
    let TriangleMesh { positions, normals, triangles } = mesh;
    normals.clear();
    super::refill(normals, positions.len(), Vec3::ZERO).map_err(|_| ExtractError::NoMemoryForMesh)?;
    let seams = seams.filter(|seams| threads > 1 && seams.len() > 1);
    let Some(seams) = seams else {
        crate::normals::accumulate(positions, triangles, normals);
        return Ok(());
    };
    std::thread::scope(|scope| {
        let mut rest: &mut [Vec3] = normals;
        for thread in 0..threads {
            let [first, end] = [thread, thread + 1].map(|t| t * seams.len() / threads);
            let low = seams[first].vertices;
            let high = seams.get(end).map_or(positions.len(), |seam| seam.vertices);
            let from = if first == 0 { 0 } else { seams[first - 1].tail };
            let to = seams.get(end).map_or(triangles.len(), |seam| seam.head);
            let (mine, others) = rest.split_at_mut(high - low);
            rest = others;
            let (positions, triangles) = (&*positions, &triangles[from..to]);
            let mut work = move || crate::normals::accumulate_some(positions, triangles, low as u32, mine);
            if thread + 1 == threads {
                work();
            } else {
                std::thread::Builder::new()
                    .spawn_scoped(scope, work)
                    .map_err(|error| ExtractError::Threads { threads, reason: error.to_string() })?;
            }
        }
        Ok(())
    })
}
