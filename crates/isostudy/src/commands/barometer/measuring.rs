//! One workload: every engine is judged, and those that are right are timed in turn.

use super::given::Sampled;
use anyhow::{Context, Result};
use isostudy_barometer::engine::Engine;
use isostudy_barometer::recording::{Row, State};
use isostudy_barometer::workload::{Group, Truth, Workload};
use isostudy_barometer::{Fault, Verdict, judge};
use isostudy_mesh::{TriangleMesh, write_ply};
use isostudy_program::{Answer, Program, ProgramError, Request, Samples, Worker, write_samples};
use isostudy_trilinear::topology;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;
use std::path::{Path, PathBuf};

/// An engine and its process.
pub(super) struct Running<'a> {
    pub(super) engine: &'a Engine,
    pub(super) program: Program,
    /// Started anew where it was killed; `None` where it does not start.
    pub(super) worker: Option<Worker>,
    /// Resident before the first request.
    pub(super) resting_bytes: u64,
    /// Whether it is the second process of an engine, which is there for noise alone.
    pub(super) is_second: bool,
    /// Seconds per sample of the slowest answer on a grid that is not small.
    seconds_a_sample: f64,
}

/// An engine that would take longer for an answer is not asked, so that a run ends.
const LONGEST_S: f64 = 20.0;
/// An engine that took longer for an answer is timed once.
const LONG_S: f64 = 1.0;
/// Samples of a grid that says something about larger ones.
const NOT_SMALL: f64 = 5e4;

impl<'a> Running<'a> {
    pub(super) fn start(engine: &'a Engine, program: Program) -> Result<Self, ProgramError> {
        let worker = Worker::start(&program)?;
        let resting_bytes = status_bytes(&worker, "VmRSS").unwrap_or_default();
        Ok(Self {
            engine,
            program,
            worker: Some(worker),
            resting_bytes,
            is_second: false,
            seconds_a_sample: 0.0,
        })
    }

    /// Asks, starting the program again if its last answer ended it.
    pub(super) fn ask(&mut self, request: &Request) -> Result<Answer, ProgramError> {
        if !self.worker.as_ref().is_some_and(Worker::is_running) {
            self.worker = None;
            self.worker = Some(Worker::start(&self.program)?);
        }
        self.worker.as_mut().expect("it was started").extract(request)
    }

    pub(super) fn folder(&self) -> Option<PathBuf> {
        self.worker.as_ref().map(|worker| worker.folder().to_owned())
    }

    /// Has the system forget the most memory that the process had.
    fn forget_peak(&self) {
        if let Some(worker) = &self.worker {
            // Where it cannot be forgotten, the peak is that of all requests: an upper bound.
            _ = std::fs::write(format!("/proc/{}/clear_refs", worker.process()), "5");
        }
    }

    /// The most that was resident since, less what was before the first request.
    fn peak_bytes(&self) -> Option<u64> {
        let peak = status_bytes(self.worker.as_ref()?, "VmHWM")?;
        Some(peak.saturating_sub(self.resting_bytes))
    }
}

/// A line of the process's status, in bytes.
fn status_bytes(worker: &Worker, name: &str) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{}/status", worker.process())).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? << 10)
}

/// A workload with its samples in files, and where to keep what is wrong.
pub(super) struct Asked<'a> {
    pub(super) group: Group,
    pub(super) workload: &'a Workload,
    boxes: Vec<(Sampled, PathBuf)>,
    wrong: PathBuf,
    _folder: tempfile::TempDir,
}

impl<'a> Asked<'a> {
    pub(super) fn new(group: Group, workload: &'a Workload, boxes: Vec<Sampled>, out: &Path) -> Result<Self> {
        let folder = tempfile::tempdir()?;
        let boxes = boxes.into_iter().enumerate().map(|(i, sampled)| {
            let path = folder.path().join(format!("{i}.f32"));
            write_samples(&path, &sampled.values).with_context(|| path.display().to_string())?;
            Ok((sampled, path))
        });
        let boxes = boxes.collect::<Result<_>>()?;
        Ok(Self { group, workload, boxes, wrong: out.join("wrong").join(&workload.id), _folder: folder })
    }

    fn request<'r>(&self, (sampled, path): &'r (Sampled, PathBuf), mesh: Option<&'r Path>) -> Request<'r> {
        Request {
            samples: Samples::File(path),
            size: sampled.counts.map(|n| n as u32),
            origin: sampled.origin,
            spacing: sampled.spacing,
            isovalue: f64::from(sampled.isovalue),
            mesh,
            may_be_empty: false,
        }
    }

    /// What is known of each box: of one, what the file says; of several, what follows from its samples.
    fn truth(&self, sampled: &Sampled, engine: &Engine) -> Truth {
        if self.boxes.len() == 1 {
            return self.workload.truth;
        }
        let samples = isostudy_trilinear::Samples::try_new(sampled.counts, &sampled.values);
        let surface = samples.and_then(|samples| topology(&samples, sampled.isovalue, engine.ties.into()));
        let surface = surface.unwrap_or_default();
        Truth {
            components: surface.components.len() as u64,
            euler: surface.euler_characteristic(),
            boundary: surface.boundary_loops(),
            volume: None,
            area: None,
            within: self.workload.truth.within,
        }
    }

    /// Judges and times all engines.
    pub(super) fn measure(
        &self,
        engines: &mut [Running],
        rounds: u32,
        random: &mut Pcg64,
    ) -> Result<Vec<Row>> {
        // What an earlier run kept is of other engines, or of other samples.
        if self.wrong.exists() {
            std::fs::remove_dir_all(&self.wrong).with_context(|| self.wrong.display().to_string())?;
        }
        let mut rows = Vec::new();
        for running in engines.iter_mut() {
            rows.push(self.judge(running)?);
        }
        let mut times: Vec<Vec<f64>> = vec![Vec::new(); engines.len()];
        let mut order: Vec<usize> = (0..engines.len()).filter(|&e| rows[e].state == State::Right).collect();
        for round in 0..rounds {
            if round > 0 {
                order.retain(|&e| times[e].iter().sum::<f64>() < LONG_S);
            }
            order.shuffle(random);
            for &e in &order {
                match self.time(&mut engines[e]) {
                    Ok(time) => times[e].push(time),
                    Err(error) => {
                        rows[e].state = State::Failed;
                        rows[e].faults = short(&error.to_string());
                    }
                }
            }
            order.retain(|&e| rows[e].state == State::Right);
        }
        for (row, times) in rows.iter_mut().zip(&mut times).filter(|(row, _)| row.state == State::Right) {
            times.sort_by(f64::total_cmp);
            let at = |share: f64| times.get((share * (times.len() - 1) as f64).round() as usize).copied();
            (row.low_s, row.time_s, row.high_s) = (at(0.25), at(0.5), at(0.75));
            row.rounds = times.len() as u32;
        }
        Ok(rows)
    }

    /// Seconds of all boxes, by the engine's own clock where it has one.
    fn time(&self, running: &mut Running) -> Result<f64, ProgramError> {
        let mut time = 0.0;
        for of in &self.boxes {
            let request = Request { may_be_empty: true, ..self.request(of, None) };
            let answer = running.ask(&request)?;
            time += answer.extraction_s.unwrap_or_else(|| answer.wall.as_secs_f64());
        }
        Ok(time)
    }

    fn judge(&self, running: &mut Running) -> Result<Row> {
        let engine = running.engine;
        let mut row = Row {
            workload: self.workload.id.clone(),
            group: self.group,
            engine: engine.id.clone(),
            state: State::Right,
            faults: String::new(),
            triangles: None,
            time_s: None,
            low_s: None,
            high_s: None,
            rounds: 0,
            memory_bytes: None,
            radius_ratio: None,
            off_cells: None,
        };
        if engine.closes && self.workload.truth.boundary > 0 {
            row.state = State::NotAsked;
            row.faults = "it closes the surface at the sides of the box".into();
            return Ok(row);
        }
        let samples: f64 = self.boxes.iter().map(|(of, _)| of.values.len() as f64).sum();
        if running.seconds_a_sample * samples > LONGEST_S {
            row.state = State::NotAsked;
            row.faults = format!("it would take more than {LONGEST_S} s, by its time on a smaller grid");
            return Ok(row);
        }
        let mut verdict = Verdict::default();
        let mut waited = 0.0;
        let mut meshes = Vec::new();
        let mut memory = 0;
        for of in &self.boxes {
            let mesh = running.folder().unwrap_or_default().join("mesh.ply");
            running.forget_peak();
            match running.ask(&self.request(of, Some(&mesh))) {
                Ok(answer) => {
                    waited += answer.wall.as_secs_f64();
                    memory = memory.max(running.peak_bytes().unwrap_or_default());
                    let mesh = answer.mesh.unwrap_or_default();
                    let truth = self.truth(&of.0, engine);
                    verdict.add(&judge(&mesh, &of.0.grid(), &truth, engine.ties, engine.soup));
                    meshes.push(mesh);
                }
                Err(error) => {
                    row.state = State::Failed;
                    row.faults = short(&error.to_string());
                    return Ok(row);
                }
            }
        }
        if samples > NOT_SMALL {
            running.seconds_a_sample = running.seconds_a_sample.max(waited / samples);
        }
        row.triangles = Some(verdict.measures.triangles);
        row.radius_ratio = Some(verdict.measures.radius_ratio);
        row.off_cells = Some(verdict.measures.off_cells);
        row.memory_bytes = (memory > 0).then_some(memory);
        if !verdict.is_right() {
            row.state = State::Wrong;
            row.faults = verdict.faults.iter().map(in_words).collect::<Vec<_>>().join("; ");
            if !running.is_second {
                self.keep(engine, &meshes)?;
            }
        }
        Ok(row)
    }

    /// Keeps a wrong mesh with its samples, for whoever wants to see it.
    fn keep(&self, engine: &Engine, meshes: &[TriangleMesh]) -> Result<()> {
        std::fs::create_dir_all(&self.wrong).with_context(|| self.wrong.display().to_string())?;
        for (i, ((sampled, path), mesh)) in self.boxes.iter().zip(meshes).enumerate() {
            let at = |name: String| self.wrong.join(name);
            std::fs::copy(path, at(format!("{i}.f32")))?;
            let Sampled { counts, origin, spacing, isovalue, is_smooth, .. } = sampled;
            let truth = self.truth(sampled, engine);
            let about = serde_json::json!({
                "counts": counts, "origin": origin, "spacing": spacing, "isovalue": isovalue, "smooth": is_smooth,
                "truth": truth, "soup": engine.soup,
            });
            std::fs::write(at(format!("{i}.{}.json", engine.id)), about.to_string())?;
            let mut file = Vec::new();
            write_ply(mesh, &mut file)?;
            std::fs::write(at(format!("{i}.{}.ply", engine.id)), file)?;
        }
        Ok(())
    }
}

fn in_words(fault: &Fault) -> String {
    let number = |value: f64| match value.fract() == 0.0 {
        true => format!("{value}"),
        false => format!("{value:.3}"),
    };
    format!("{} {}, expected {}", number(fault.found), fault.kind.words(), number(fault.expected))
}

/// The first line, and no more of it than a table can show.
fn short(text: &str) -> String {
    let line = text.lines().next().unwrap_or_default();
    line.chars().take(160).collect()
}
