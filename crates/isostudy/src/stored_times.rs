//! What a mesh costs where its object's samples are stored, as a game keeps voxels: from the samples to the mesh.

use crate::chunk_times::{Chunks, goes_in_chunks, in_turn, places, time_in_turn};
use crate::prepare::Prepared;
use crate::recipe::Recipe;
use anyhow::{Context, Result};
use isostudy_design::record::StoredTimes;
use isostudy_extract::{Arrangement, Execution, Extraction, Extractor, Method, Source};
use isostudy_field::{Beyond, VolumeField};
use isostudy_program::{Program, Samples, Worker, write_samples};
use std::hint::black_box;
use std::path::PathBuf;

/// Times configurations of one object with the same cubes from the samples at their corners: the whole mesh, then chunks of so many
/// cells a side, 0 for none, and edits as [`chunk_times`](crate::chunk_times::chunk_times) has them. They work in turn. Each number is
/// of one extraction on one thread, after one that is not counted. Every method is given the same samples. One that asks for values or
/// gradients between them has them by trilinear interpolation, which is in its time. Not in the result are meshes out of files, fronts,
/// and the cells of a grid, whose values are stored anyway. `progress` is told how much of how much is done.
///
/// # Errors
/// If anything cannot be extracted.
pub(crate) fn stored_times(
    all: &[Prepared<'_>],
    cells: u32,
    rounds: u32,
    progress: &dyn Fn(usize, usize),
) -> Result<Vec<StoredTimes>> {
    let volume = all.iter().find_map(|prepared| Some((prepared, prepared.extractor()?)));
    let volume = volume.map(|(prepared, of)| Volume::of(prepared, &of)).transpose()?;
    let mut works = Vec::new();
    for prepared in all {
        let work = match (&prepared.recipe, &volume) {
            (Recipe::Extractor(method), Some(volume)) => Work::Extractor(volume.source(method)),
            (Recipe::Program(program), _) => Work::start(prepared, program)?,
            _ => continue,
        };
        let mut work = Timed { prepared, work, whole_s: Vec::new() };
        work.whole()?;
        work.whole_s.clear();
        works.push(work);
    }
    in_turn(&mut works, rounds as usize, Timed::whole)?;
    let mut in_chunks = Vec::new();
    for (place, work) in works.iter().enumerate().filter(|_| cells > 0) {
        let (Some(of), Work::Extractor(source)) = (work.prepared.extractor(), &work.work) else { continue };
        if goes_in_chunks(work.prepared) {
            let begun = Chunks::begin(&of, &work.prepared.finish, *source, cells)?;
            in_chunks.extend(begun.map(|chunks| (place, of, chunks)));
        }
    }
    if let Some((_, of, _)) = in_chunks.first() {
        let places = places(of)?;
        let mut chunks: Vec<&mut Chunks<'_>> = in_chunks.iter_mut().map(|(_, _, chunks)| chunks).collect();
        time_in_turn(&mut chunks, rounds, &places, progress)?;
    }
    let record = |(place, work): (usize, &Timed<'_>)| {
        let chunks = in_chunks.iter().find(|(of, _, _)| *of == place).map(|(_, _, chunks)| chunks);
        StoredTimes {
            id: work.prepared.id.clone(),
            is_between: matches!(work.work, Work::Extractor(Source::Study(_))),
            whole_s: work.whole_s.clone(),
            timed: chunks.map_or(0, |chunks| chunks.timed.len() as u64),
            chunk_s: chunks.map_or_else(Vec::new, |chunks| chunks.chunk_s.clone()),
            edit_s: chunks.map_or_else(Vec::new, Chunks::edit_s),
        }
    };
    Ok(works.iter().enumerate().map(record).collect())
}

/// The samples of an object, which all methods of ours are given.
struct Volume {
    samples: Vec<f32>,
    field: VolumeField,
}

impl Volume {
    fn of(prepared: &Prepared<'_>, of: &isostudy_bench::Prepared<'_>) -> Result<Self> {
        let counts = of.grid.lattice(Arrangement::SimpleCubic)?.cells();
        let samples = prepared.samples(counts);
        let (spacing, along) = (f64::from(of.grid.spacing), counts.map(|cells| cells as usize + 1));
        let steps = [0, 1, 2].map(|axis| [0, 1, 2].map(|of| if of == axis { spacing } else { 0.0 }));
        let origin = of.grid.bounds.min.to_array().map(f64::from);
        let field = VolumeField::try_new(along, samples.clone(), origin, steps, Beyond::Continued)?;
        Ok(Self { samples, field })
    }

    /// The samples for a method that asks for nothing else; for the others what lies between them, too.
    fn source(&self, method: &Method) -> Source<'_> {
        if method.is_of_corners() { Source::Samples(&self.samples) } else { Source::Study(&self.field) }
    }
}

/// One configuration in front of the clock.
struct Timed<'a> {
    prepared: &'a Prepared<'a>,
    work: Work<'a>,
    whole_s: Vec<f64>,
}

enum Work<'a> {
    Extractor(Source<'a>),
    /// A program is given all samples in a file; its own word says how long it took from there.
    Program {
        worker: Box<Worker>,
        cells: [u32; 3],
        samples: PathBuf,
        /// The mesh is asked for only where there is something to be done with it.
        mesh: Option<PathBuf>,
    },
}

impl Work<'_> {
    fn start(prepared: &Prepared<'_>, program: &Program) -> Result<Self> {
        let cells = prepared.cells()?;
        let worker = Worker::start(program).with_context(|| prepared.id.to_string())?;
        let [samples, mesh] = ["samples.f32", "mesh.ply"].map(|name| worker.folder().join(name));
        write_samples(&samples, &prepared.samples(cells))?;
        let mesh = Some(mesh).filter(|_| !prepared.finish.is_empty());
        Ok(Self::Program { worker: Box::new(worker), cells, samples, mesh })
    }
}

impl Timed<'_> {
    /// Times the whole mesh once more.
    fn whole(&mut self) -> Result<()> {
        let prepared = self.prepared;
        let seconds = match &mut self.work {
            Work::Extractor(source) => {
                let of = prepared.extractor().context("an extractor has a source")?;
                let execution = Execution { threads: 1 };
                let made =
                    of.method.extract(&mut Extractor::new(), *source, &of.grid, of.isovalue, &execution)?;
                let Extraction { times, mesh, .. } = black_box(made);
                (times.total() - times.normals).as_secs_f64() + prepared.finishing_s(mesh)?
            }
            Work::Program { worker, cells, samples, mesh } => {
                let request = prepared.request(Samples::File(samples), *cells, mesh.as_deref());
                let answer = worker.extract(&request).with_context(|| prepared.id.to_string())?;
                let finishing = answer.mesh.map_or(Ok(0.0), |mesh| prepared.finishing_s(mesh))?;
                answer.extraction_s.unwrap_or(answer.wall.as_secs_f64()) + finishing
            }
        };
        self.whole_s.push(seconds);
        Ok(())
    }
}
