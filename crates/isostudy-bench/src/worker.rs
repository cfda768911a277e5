//! What the measuring process does: it reads requests, a line each, and answers each with a line, in JSON.

use crate::allocations::{AllocationCounts, allocations};
use crate::error::BenchError;
use crate::load::resident_bytes;
use crate::meter::Meter;
use crate::reference::Reference;
use crate::run::{Measurement, PeakBytes};
use crate::stages::{StageSeconds, Timed};
use isostudy_extract::{BoxGrid, Execution, Extraction, Extractor, Method, MethodError};
use isostudy_field::StudyField;
use serde::{Deserialize, Serialize};
use std::hint::black_box;
use std::io::{self, BufRead, Write};
use std::time::{Duration, Instant};

/// What is done to an extraction's mesh, or why that cannot be.
pub type Finish<'f> = &'f dyn Fn(Extraction) -> Result<Extraction, String>;

/// A configuration, ready to extract.
#[derive(Clone, Copy)]
pub struct Prepared<'a> {
    /// What is sampled.
    pub field: &'a dyn StudyField,
    /// What decides the mesh.
    pub method: Method,
    /// Where the field is sampled.
    pub grid: BoxGrid,
    /// The value of the surface.
    pub isovalue: f32,
}

impl Prepared<'_> {
    /// The mesh, with buffers of its own.
    ///
    /// # Errors
    /// As [`Method::extract`].
    pub fn extract(&self, execution: &Execution) -> Result<Extraction, MethodError> {
        self.extract_with(&mut Extractor::new(), execution)
    }

    /// The same with an extractor that is there, for its buffers and its progress.
    ///
    /// # Errors
    /// As [`Method::extract`].
    pub fn extract_with(
        &self,
        extractor: &mut Extractor,
        execution: &Execution,
    ) -> Result<Extraction, MethodError> {
        self.method.extract(extractor, self.field.into(), &self.grid, self.isovalue, execution)
    }
}

impl Prepared<'_> {
    /// Extracts once and says how long each stage took, and what was counted meanwhile. What finishes the mesh, if anything does, is a
    /// stage of its own.
    ///
    /// # Errors
    /// Why it cannot be extracted or finished.
    pub fn time(&self, threads: u32, finish: Option<Finish<'_>>) -> Result<Timed, String> {
        let meter = Meter::begin();
        let made = self.made(&Execution { threads: threads as usize }, finish);
        let counters = meter.end();
        let (Extraction { times, .. }, finishing) = black_box(made?);
        let stages = StageSeconds { finishing_s: finishing.as_secs_f64(), ..StageSeconds::from(&times) };
        Ok(Timed { stages, counters })
    }

    /// The finished mesh, and how long finishing took.
    fn made(
        &self,
        execution: &Execution,
        finish: Option<Finish<'_>>,
    ) -> Result<(Extraction, Duration), String> {
        let extraction = self.extract(execution).map_err(|error| error.to_string())?;
        let Some(finish) = finish else { return Ok((extraction, Duration::ZERO)) };
        let began = Instant::now();
        let finished = finish(extraction)?;
        Ok((finished, began.elapsed()))
    }

    /// What an extraction asks of the allocator, on one thread, which must be alone in the process; `None` where nobody counts
    /// ([`count_allocations`](crate::count_allocations)). Finishing counts in the total alone.
    ///
    /// # Errors
    /// Why it cannot be extracted or finished.
    pub fn allocations(&self, finish: Option<Finish<'_>>) -> Result<Option<AllocationCounts>, String> {
        allocations(|execution| self.made(execution, finish).map(|(extraction, _)| extraction))
    }

    /// Extracts and finishes once, and says how much memory that took.
    ///
    /// # Errors
    /// As [`time`](Self::time).
    pub fn memory(&self, threads: u32, finish: Option<Finish<'_>>) -> Result<Option<PeakBytes>, String> {
        let before = resident_bytes();
        self.time(threads, finish)?;
        Ok(before.zip(resident_bytes()).map(|([before_bytes, peak_before_bytes], [_, peak_bytes])| {
            PeakBytes { before_bytes, peak_before_bytes, peak_bytes }
        }))
    }
}

/// What can be timed: configurations, by number. Whatever comes before an extraction is untimed.
pub trait Measured {
    /// Extracts once and says how long each stage took; dropping the mesh is in none. `threads` are those of the sampling stage,
    /// 0 for every core.
    ///
    /// # Errors
    /// Why it cannot be extracted, for people.
    fn time(&mut self, number: usize, threads: u32) -> Result<Timed, String>;

    /// Extracts once and says how much memory that took; `None` where it is not told.
    ///
    /// # Errors
    /// As [`time`](Self::time).
    fn memory(&mut self, number: usize, threads: u32) -> Result<Option<PeakBytes>, String>;

    /// Extracts and says what was asked of the allocator; `None` where nobody counts, which is so unless said otherwise.
    ///
    /// # Errors
    /// As [`time`](Self::time).
    fn allocations(&mut self, number: usize) -> Result<Option<AllocationCounts>, String> {
        let _ = number;
        Ok(None)
    }
}

impl<'a, F: FnMut(usize) -> Result<Prepared<'a>, String>> Measured for F {
    fn time(&mut self, number: usize, threads: u32) -> Result<Timed, String> {
        self(number)?.time(threads, None)
    }

    fn memory(&mut self, number: usize, threads: u32) -> Result<Option<PeakBytes>, String> {
        self(number)?.memory(threads, None)
    }

    fn allocations(&mut self, number: usize) -> Result<Option<AllocationCounts>, String> {
        self(number)?.allocations(None)
    }
}

/// What the measuring process is asked; configurations are numbered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Request {
    /// Extract once and say how long each stage took.
    Time(usize),
    /// Extract once and say how much memory that took.
    Memory(usize),
    /// Extract and say what was asked of the allocator.
    Allocations(usize),
}

/// What it answers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reply {
    /// Said once, unasked: ready, pinned to these CPUs.
    Ready(Option<Vec<u32>>),
    /// To [`Request::Time`].
    Measurement(Measurement),
    /// To [`Request::Memory`]; `None` where it is not told.
    Memory(Option<PeakBytes>),
    /// To [`Request::Allocations`]; `None` where nobody counts.
    Allocations(Option<AllocationCounts>),
    /// To any: why not.
    Failed(String),
}

/// Answers requests until there are no more. `threads` are those of the sampling stage, 0 for every core.
///
/// # Errors
/// If a request cannot be read or understood or an answer not written. What an extraction refuses is an answer.
pub fn serve(
    requests: impl BufRead,
    mut replies: impl Write,
    pinned: Option<Vec<u32>>,
    threads: u32,
    measured: &mut dyn Measured,
) -> io::Result<()> {
    let mut reference = Reference::on(threads);
    let mut say = |reply: &Reply| {
        writeln!(replies, "{}", serde_json::to_string(reply)?)?;
        replies.flush()
    };
    say(&Reply::Ready(pinned))?;
    for line in requests.lines() {
        let reply = match serde_json::from_str(&line?)? {
            Request::Time(number) => {
                let reference_s = Some(reference.time().as_secs_f64());
                let measurement = |Timed { stages, counters }| {
                    Reply::Measurement(Measurement { stages, reference_s, counters })
                };
                measured.time(number, threads).map(measurement)
            }
            Request::Memory(number) => measured.memory(number, threads).map(Reply::Memory),
            Request::Allocations(number) => measured.allocations(number).map(Reply::Allocations),
        };
        say(&reply.unwrap_or_else(Reply::Failed))?;
    }
    Ok(())
}

impl Reply {
    /// The answer to [`Request::Time`].
    pub(crate) fn measurement(self) -> Result<Measurement, BenchError> {
        match self {
            Self::Measurement(measurement) => Ok(measurement),
            other => Err(other.unexpected()),
        }
    }

    /// The answer to [`Request::Memory`].
    pub(crate) fn memory(self) -> Result<Option<PeakBytes>, BenchError> {
        match self {
            Self::Memory(memory) => Ok(memory),
            other => Err(other.unexpected()),
        }
    }

    /// The answer to [`Request::Allocations`].
    pub(crate) fn allocations(self) -> Result<Option<AllocationCounts>, BenchError> {
        match self {
            Self::Allocations(counts) => Ok(counts),
            other => Err(other.unexpected()),
        }
    }

    /// What is said unasked.
    pub(crate) fn ready(self) -> Result<Option<Vec<u32>>, BenchError> {
        match self {
            Self::Ready(pinned) => Ok(pinned),
            other => Err(other.unexpected()),
        }
    }

    fn unexpected(self) -> BenchError {
        match self {
            Self::Failed(reason) => BenchError::Execution(reason.into()),
            other => BenchError::Process(format!("unexpected answer {other:?}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use isostudy_extract::{Arrangement, Clustering, Positions, StageTimes, Tetrahedra};
    use isostudy_field::Sphere;
    use isostudy_mesh::Bounds;

    fn sphere(method: Tetrahedra) -> Prepared<'static> {
        let bounds = Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) };
        let grid = BoxGrid { bounds, spacing: 0.5 };
        Prepared { field: &Sphere { radius: 1.0 }, method: Method::Tetrahedra(method), grid, isovalue: 0.0 }
    }

    fn replies(requests: &[Request]) -> Vec<Reply> {
        let lines: Vec<String> =
            requests.iter().map(|request| serde_json::to_string(request).unwrap()).collect();
        let mut out = Vec::new();
        let plain = Tetrahedra::new(Arrangement::BodyCentred);
        let subject = &mut |number| match number {
            0 => Ok(sphere(plain.with_clustering(Clustering::EdgeCollapse))),
            1 => {
                let positions = Positions::Accumulated { chunks: 0 };
                Ok(sphere(plain.with_positions(positions)))
            }
            _ => Err("there are two subjects".into()),
        };
        serve(lines.join("\n").as_bytes(), &mut out, Some(vec![3]), 1, subject).unwrap();
        String::from_utf8(out).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    #[test]
    fn each_stage_goes_where_it_belongs() {
        let ms = Duration::from_millis;
        let times = StageTimes {
            allocation: ms(1),
            sampling: ms(20),
            vertex: ms(300),
            geometry: ms(4000),
            clustering: ms(50_000),
            normals: ms(600_000),
        };
        let stages = StageSeconds::from(&times);
        let expected = StageSeconds {
            allocation_s: 0.001,
            sampling_s: 0.02,
            vertex_s: 0.3,
            geometry_s: 4.0,
            clustering_s: 50.0,
            normals_s: 600.0,
            finishing_s: 0.0,
        };
        assert_eq!(stages, expected);
        assert!((stages.total() - times.total().as_secs_f64()).abs() < 1e-9);
    }

    #[test]
    fn requests_are_answered_in_order() {
        let [ready, measurement, memory] = &replies(&[Request::Time(0), Request::Memory(0)])[..] else {
            panic!()
        };
        assert_eq!(*ready, Reply::Ready(Some(vec![3])));
        let Reply::Measurement(measurement) = measurement else { panic!("{measurement:?}") };
        assert!(measurement.stages.clustering_s > 0.0 && measurement.reference_s > Some(0.0));
        let Reply::Memory(memory) = memory else { panic!("{memory:?}") };
        if let Some(memory) = memory {
            assert!(memory.before_bytes > 0 && memory.peak_bytes >= memory.peak_before_bytes);
            assert!(memory.peak_before_bytes >= memory.before_bytes);
        }
    }

    #[test]
    fn finishing_is_a_stage_of_its_own_and_in_the_total() {
        let of = sphere(Tetrahedra::new(Arrangement::BodyCentred));
        let wait = Duration::from_millis(20);
        let slow = |extraction| {
            std::thread::sleep(wait);
            Ok(extraction)
        };
        let stages = of.time(1, Some(&slow)).unwrap().stages;
        assert!(stages.finishing_s >= wait.as_secs_f64());
        assert!(stages.total() >= stages.finishing_s + stages.geometry_s);
        assert_eq!(of.time(1, None).unwrap().stages.finishing_s, 0.0);
        let refused = of.time(1, Some(&|_| Err("no".into())));
        assert_eq!(refused, Err("no".into()));
    }

    #[test]
    fn what_cannot_be_extracted_is_an_answer() {
        let answers = replies(&[Request::Time(1), Request::Memory(2)]);
        assert!(matches!(&answers[1], Reply::Failed(reason) if reason.contains("chunk")), "{answers:?}");
        assert_eq!(answers[2], Reply::Failed("there are two subjects".into()));
        assert_eq!(answers[2].clone().measurement().unwrap_err().to_string(), "there are two subjects");
        assert!(answers[0].clone().memory().unwrap_err().to_string().contains("unexpected answer Ready"));
    }

    #[test]
    fn what_is_no_request_ends_the_process() {
        let mut never = |_| -> Result<Prepared<'static>, String> { unreachable!() };
        assert!(serve("{\"sing\":1}\n".as_bytes(), &mut Vec::new(), None, 1, &mut never).is_err());
    }
}
