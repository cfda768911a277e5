//! The configurations of a study in front of the clock: extractors of ours, and programs that stay started.

use crate::prepare::Prepared;
use crate::recipe::Recipe;
use isostudy_bench::{AllocationCounts, Asked, Finish, Measured, PeakBytes, StageSeconds, Timed};
use isostudy_design::record::Counters;
use isostudy_extract::Extraction;
use isostudy_mesh::TriangleMesh;
use isostudy_program::{Answer, Program, Samples, Worker, write_samples};
use std::collections::HashMap;
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

/// Makes a configuration ready, by number.
type Prepare<'a> = dyn FnMut(usize) -> Result<Prepared<'a>, String> + 'a;

/// What is timed in one measuring process.
pub(crate) struct Clock<'a> {
    prepare: Box<Prepare<'a>>,
    running: HashMap<usize, Running>,
}

/// A program that is started, and the samples that it is given.
struct Running {
    worker: Worker,
    /// The mesh that it makes, where there are finishing steps to be timed.
    mesh: Option<TriangleMesh>,
    samples: PathBuf,
    cells: [u32; 3],
}

impl<'a> Clock<'a> {
    pub(crate) fn new(prepare: impl FnMut(usize) -> Result<Prepared<'a>, String> + 'a) -> Self {
        Self { prepare: Box::new(prepare), running: HashMap::new() }
    }

    /// Asks a program once, started before and with its samples written, neither of which is timed.
    fn ask(&mut self, number: usize, prepared: &Prepared<'_>, program: &Program) -> Result<Answer, String> {
        let running = self.started(number, prepared, program)?;
        let request = prepared.request(Samples::File(&running.samples), running.cells, None);
        running.worker.extract(&request).map_err(|error| format!("{}: {error}", prepared.id))
    }

    /// The mesh that a program makes, asked for once and not timed; an empty one if it sends none.
    fn mesh(
        &mut self,
        number: usize,
        prepared: &Prepared<'_>,
        program: &Program,
    ) -> Result<TriangleMesh, String> {
        let running = self.started(number, prepared, program)?;
        if running.mesh.is_none() {
            let path = running.worker.folder().join("mesh.ply");
            let request = prepared.request(Samples::File(&running.samples), running.cells, Some(&path));
            let answer = running.worker.extract(&request);
            running.mesh = answer.map_err(|error| format!("{}: {error}", prepared.id))?.mesh;
        }
        Ok(running.mesh.clone().unwrap_or_default())
    }

    fn started(
        &mut self,
        number: usize,
        prepared: &Prepared<'_>,
        program: &Program,
    ) -> Result<&mut Running, String> {
        let text = |error: &dyn std::fmt::Display| format!("{}: {error}", prepared.id);
        if self.running.get(&number).is_none_or(|running| !running.worker.is_running()) {
            let cells = prepared.cells().map_err(|error| text(&format!("{error:#}")))?;
            let worker = Worker::start(program).map_err(|error| text(&error))?;
            let samples = worker.folder().join("samples.f32");
            write_samples(&samples, &prepared.samples(cells)).map_err(|error| text(&error))?;
            self.running.insert(number, Running { worker, mesh: None, samples, cells });
        }
        self.running.get_mut(&number).ok_or_else(|| text(&"not started"))
    }
}

impl Measured for Clock<'_> {
    fn time(&mut self, number: usize, threads: u32) -> Result<Timed, String> {
        let prepared = (self.prepare)(number)?;
        match &prepared.recipe {
            Recipe::Program(program) => {
                let sampling_s = sampling(&prepared, threads)?;
                let answer = self.ask(number, &prepared, program)?;
                // A program says how long it took, not what each stage did: it is all in one.
                let geometry_s = answer.extraction_s.unwrap_or(answer.wall.as_secs_f64());
                let finishing_s = finishing_s(&prepared, || self.mesh(number, &prepared, program))?;
                let stages = StageSeconds { sampling_s, geometry_s, finishing_s, ..StageSeconds::default() };
                let counters = Counters {
                    cpu_s: answer.cpu.map(|cpu| cpu.as_secs_f64()),
                    outside_s: Some(answer.wall.as_secs_f64()),
                    ..Counters::default()
                };
                Ok(Timed { stages, counters })
            }
            Recipe::Family(family) => {
                let began = Instant::now();
                let mesh = family.mesh(&prepared.asked(prepared.field));
                let mesh = mesh.map_err(|error| format!("{}: {error:#}", prepared.id))?;
                // The field is asked on the way, if at all: there is one stage.
                let geometry_s = began.elapsed().as_secs_f64();
                let finishing_s = finishing_s(&prepared, || Ok(mesh))?;
                let stages = StageSeconds { geometry_s, finishing_s, ..StageSeconds::default() };
                Ok(Timed { stages, counters: Counters::default() })
            }
            _ => extractor(&prepared)?
                .time(threads, steps(&prepared, &|of| finished_extraction(&prepared, of))),
        }
    }

    fn memory(&mut self, number: usize, threads: u32) -> Result<Option<PeakBytes>, String> {
        let prepared = (self.prepare)(number)?;
        match &prepared.recipe {
            Recipe::Program(program) => {
                // Started anew, so that no earlier extraction is in its peak.
                self.running.remove(&number);
                let before = self.started(number, &prepared, program)?.worker.memory();
                let answer = self.ask(number, &prepared, program)?;
                Ok(before.zip(answer.memory).map(|(before, after)| PeakBytes {
                    before_bytes: before.resident_bytes,
                    peak_before_bytes: before.peak_bytes,
                    peak_bytes: after.peak_bytes,
                }))
            }
            Recipe::Family(_) => Ok(None),
            _ => extractor(&prepared)?
                .memory(threads, steps(&prepared, &|of| finished_extraction(&prepared, of))),
        }
    }

    /// Of a program and of a family it is not known.
    fn allocations(&mut self, number: usize) -> Result<Option<AllocationCounts>, String> {
        let prepared = (self.prepare)(number)?;
        match &prepared.recipe {
            Recipe::Program(_) | Recipe::Family(_) => Ok(None),
            _ => {
                extractor(&prepared)?.allocations(steps(&prepared, &|of| finished_extraction(&prepared, of)))
            }
        }
    }
}

/// What this process's allocator was asked for until now.
pub(crate) fn asked() -> Asked {
    let stats = stats_alloc::INSTRUMENTED_SYSTEM.stats();
    let calls = (stats.allocations + stats.reallocations) as u64;
    Asked { calls, bytes: stats.bytes_allocated as u64 }
}

/// Seconds to compute all the samples that a program is given, so that its total, too, is from field to mesh.
fn sampling(prepared: &Prepared<'_>, threads: u32) -> Result<f64, String> {
    let text = |error: &dyn std::fmt::Display| format!("{}: {error:#}", prepared.id);
    let cells = prepared.cells().map_err(|error| text(&error))?;
    let threads = rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build();
    threads.map_err(|error| text(&error))?.install(|| {
        let began = Instant::now();
        black_box(prepared.samples(cells));
        Ok(began.elapsed().as_secs_f64())
    })
}

/// What finishes a mesh; `None` where nothing does.
fn steps<'f>(prepared: &Prepared<'_>, finish: Finish<'f>) -> Option<Finish<'f>> {
    (!prepared.finish.is_empty()).then_some(finish)
}

fn finished_extraction(prepared: &Prepared<'_>, of: Extraction) -> Result<Extraction, String> {
    let mesh = prepared.finished(of.mesh).map_err(|error| format!("{}: {error:#}", prepared.id))?;
    Ok(Extraction { mesh, ..of })
}

/// Seconds that the finishing steps take, of a mesh that is asked for where there are any.
fn finishing_s(
    prepared: &Prepared<'_>,
    mesh: impl FnOnce() -> Result<TriangleMesh, String>,
) -> Result<f64, String> {
    if prepared.finish.is_empty() {
        return Ok(0.0);
    }
    prepared.finishing_s(mesh()?).map_err(|error| format!("{}: {error:#}", prepared.id))
}

fn extractor<'a>(prepared: &Prepared<'a>) -> Result<isostudy_bench::Prepared<'a>, String> {
    prepared.extractor().ok_or_else(|| format!("{}: there is nothing to time", prepared.id))
}
