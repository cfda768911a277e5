//! One workload: every engine is judged, and those that are right are timed in turn.

use super::given::Sampled;
use anyhow::{Context, Result};
use isostudy_barometer::engine::{Engine, Takes, Ties};
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
    /// Whether it is the second process of an engine, which is there for noise alone.
    pub(super) is_second: bool,
    /// Seconds per sample of its last answer on a grid that is not small; 0 before.
    pub(super) seconds_a_sample: f64,
}

/// An engine that would take longer for an answer is not asked, so that a run ends.
const LONGEST_S: f64 = 5.0;
/// An engine that took longer for a workload is timed no more: the answer that was judged may be the only one.
const LONG_S: f64 = 1.0;
/// Samples of a grid that says something about larger ones.
const NOT_SMALL: f64 = 5e4;

impl<'a> Running<'a> {
    pub(super) fn start(engine: &'a Engine, program: Program) -> Result<Self, ProgramError> {
        let worker = Some(Worker::start(&program)?);
        Ok(Self { engine, program, worker, is_second: false, seconds_a_sample: 0.0 })
    }

    /// Asks, starting the program again if its last answer ended it.
    pub(super) fn ask(&mut self, request: &Request) -> Result<Answer, ProgramError> {
        if !self.worker.as_ref().is_some_and(Worker::is_running) {
            self.worker = None;
            self.worker = Some(Worker::start(&self.program)?);
        }
        self.worker.as_mut().expect("it was started").extract(request)
    }

    /// Learns from a row how long a larger grid will take.
    pub(super) fn learn(&mut self, row: &Row, samples: f64) {
        if let Some(seconds) = row.judged_s.filter(|_| samples > NOT_SMALL) {
            self.seconds_a_sample = seconds / samples;
        }
    }

    /// The most memory of a process that is started for this request, and of all that it starts, less what it had before.
    fn memory_for(&self, request: &Request) -> Result<Option<u64>, ProgramError> {
        let mut worker = Worker::start(&self.program)?;
        let before = worker.memory();
        let after = worker.extract(request)?.memory;
        Ok(before.zip(after).map(|(before, after)| after.peak_bytes.saturating_sub(before.resident_bytes)))
    }
}

/// Where a program writes its mesh, in its own folder.
pub(super) const MESH: &str = "mesh.ply";

/// A workload with its samples in files, and where to keep what is wrong.
pub(super) struct Asked<'a> {
    pub(super) group: Group,
    pub(super) workload: &'a Workload,
    boxes: Vec<(Sampled, PathBuf)>,
    /// Of several boxes what follows from the samples of each, with ties outside and inside.
    truths: [Vec<Truth>; 2],
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
        let boxes = boxes.collect::<Result<Vec<(Sampled, PathBuf)>>>()?;
        let mut truths = [Vec::new(), Vec::new()];
        if boxes.len() > 1 {
            for (truths, ties) in truths.iter_mut().zip([Ties::Outside, Ties::Inside]) {
                *truths = boxes.iter().map(|(of, _)| truth_of_samples(of, ties)).collect::<Result<_>>()?;
            }
        }
        let wrong = out.join("wrong").join(&workload.id);
        Ok(Self { group, workload, boxes, truths, wrong, _folder: folder })
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

    /// What is known of a box: of a single one, what the file says; of several, what follows from its samples.
    fn truth(&self, number: usize, engine: &Engine) -> &Truth {
        let of_samples = &self.truths[usize::from(engine.ties == Ties::Inside)];
        of_samples.get(number).unwrap_or(&self.workload.truth)
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
        let mut answered = Vec::new();
        for running in engines.iter_mut() {
            let (row, counts) = self.judge(running)?;
            rows.push(row);
            answered.push(counts);
        }
        let mut times: Vec<Vec<f64>> = vec![Vec::new(); engines.len()];
        let mut order: Vec<usize> = (0..engines.len()).filter(|&e| rows[e].state == State::Right).collect();
        order.retain(|&e| match rows[e].judged_s {
            Some(seconds) if seconds > LONG_S => {
                times[e].push(seconds);
                false
            }
            _ => true,
        });
        for _ in 0..rounds {
            order.shuffle(random);
            for &e in &order {
                match self.time(&mut engines[e], answered[e]) {
                    Ok(time) => times[e].push(time),
                    Err(words) => (rows[e].state, rows[e].faults) = (State::Failed, words),
                }
            }
            order.retain(|&e| {
                rows[e].state == State::Right && times[e].last().is_some_and(|time| *time < LONG_S)
            });
        }
        for (row, times) in rows.iter_mut().zip(&mut times).filter(|(row, _)| row.state == State::Right) {
            times.sort_by(f64::total_cmp);
            let at = |share: f64| {
                let place = share * (times.len() - 1) as f64;
                let [low, high] = [place.floor(), place.ceil()].map(|i| times[i as usize]);
                low + (high - low) * place.fract()
            };
            [row.low_s, row.time_s, row.high_s] = [0.25, 0.5, 0.75].map(|share| Some(at(share)));
            row.rounds = times.len() as u32;
        }
        if self.workload.memory {
            for (row, running) in rows.iter_mut().zip(engines.iter()).filter(|(_, of)| !of.is_second) {
                if row.state == State::Right {
                    // An engine that fails now has failed at nothing that is judged.
                    row.memory_bytes = running.memory_for(&self.request(&self.boxes[0], None)).ok().flatten();
                }
            }
        }
        Ok(rows)
    }

    /// Seconds of all boxes, by the engine's own clock where it has one. An answer that is not the one that was judged has no time.
    fn time(&self, running: &mut Running, judged: [u64; 2]) -> Result<f64, String> {
        let (mut time, mut answered) = (0.0, [0; 2]);
        for of in &self.boxes {
            let request = Request { may_be_empty: true, ..self.request(of, None) };
            let answer = running.ask(&request).map_err(|error| in_a_line(&error.to_string()))?;
            time += seconds(&answer, running.engine);
            answered = [answered[0] + answer.vertices, answered[1] + answer.triangles];
        }
        if answered != judged {
            let [vertices, triangles] = answered;
            return Err(format!(
                "{vertices} vertices and {triangles} triangles when it was timed, {} and {} when it was judged",
                judged[0], judged[1]
            ));
        }
        Ok(time)
    }

    /// The row, and how many vertices and triangles were answered.
    fn judge(&self, running: &mut Running) -> Result<(Row, [u64; 2])> {
        let engine = running.engine;
        let surface = self.workload.surface.as_ref().unwrap_or(&self.workload.id);
        let mut row = Row {
            workload: self.workload.id.clone(),
            group: self.group,
            surface: surface.clone(),
            engine: engine.id.clone(),
            state: State::Right,
            faults: String::new(),
            triangles: None,
            time_s: None,
            low_s: None,
            high_s: None,
            rounds: 0,
            judged_s: None,
            memory_bytes: None,
            radius_ratio: None,
            off_cells: None,
        };
        let mut counts = [0; 2];
        if let Some(why) = self.why_not(running) {
            (row.state, row.faults) = (State::NotAsked, why);
            return Ok((row, counts));
        }
        let mut verdict = Verdict::default();
        let mut meshes = Vec::new();
        let mut judged_s = 0.0;
        for (number, of) in self.boxes.iter().enumerate() {
            match running.ask(&self.request(of, Some(Path::new(MESH)))) {
                Ok(answer) => {
                    judged_s += seconds(&answer, engine);
                    counts = [counts[0] + answer.vertices, counts[1] + answer.triangles];
                    let mesh = answer.mesh.unwrap_or_default();
                    let truth = self.truth(number, engine);
                    verdict.add(&judge(&mesh, &of.0.grid(), truth, engine.ties, engine.soup));
                    meshes.push(mesh);
                }
                Err(error) => {
                    (row.state, row.faults) = (State::Failed, in_a_line(&error.to_string()));
                    return Ok((row, counts));
                }
            }
        }
        row.judged_s = Some(judged_s);
        running.learn(&row, self.samples());
        row.triangles = Some(verdict.measures.triangles);
        row.radius_ratio = Some(verdict.measures.radius_ratio);
        let is_smooth = self.boxes.iter().all(|(of, _)| of.is_smooth);
        row.off_cells = is_smooth.then_some(verdict.measures.off_cells);
        if !verdict.is_right() {
            row.state = State::Wrong;
            let words = |fault: &Fault| in_words(fault, self.boxes.len());
            row.faults = verdict.faults.iter().map(words).collect::<Vec<_>>().join("; ");
            if !running.is_second {
                self.keep(engine, &meshes, &verdict)?;
            }
        }
        Ok((row, counts))
    }

    /// Samples of all boxes.
    fn samples(&self) -> f64 {
        self.boxes.iter().map(|(of, _)| of.values.len() as f64).sum()
    }

    /// Why an engine is not asked.
    fn why_not(&self, running: &Running) -> Option<String> {
        let engine = running.engine;
        if engine.closes && self.workload.truth.boundary > 0 {
            return Some("it closes the surface at the sides of the box".into());
        }
        if !self.boxes.iter().all(|(of, _)| engine.grids.contain(of.counts, of.spacing)) {
            return Some("it takes other grids: see `grids` in engines.toml".into());
        }
        (running.seconds_a_sample * self.samples() > LONGEST_S)
            .then(|| format!("it would take more than {LONGEST_S} s, by its time on a smaller grid"))
    }

    /// Keeps a wrong mesh with its samples, for whoever wants to see it.
    fn keep(&self, engine: &Engine, meshes: &[TriangleMesh], verdict: &Verdict) -> Result<()> {
        std::fs::create_dir_all(&self.wrong).with_context(|| self.wrong.display().to_string())?;
        for (i, ((sampled, path), mesh)) in self.boxes.iter().zip(meshes).enumerate() {
            let at = |name: String| self.wrong.join(name);
            std::fs::copy(path, at(format!("{i}.f32")))?;
            let Sampled { counts, origin, spacing, isovalue, is_smooth, .. } = sampled;
            let truth = self.truth(i, engine);
            let kinds: Vec<_> = verdict.faults.iter().map(|fault| fault.kind).collect();
            let about = serde_json::json!({
                "counts": counts, "origin": origin, "spacing": spacing, "isovalue": isovalue, "smooth": is_smooth,
                "truth": truth, "soup": engine.soup, "ties": engine.ties, "kinds": kinds,
            });
            std::fs::write(at(format!("{i}.{}.json", engine.id)), about.to_string())?;
            let mut file = Vec::new();
            write_ply(mesh, &mut file)?;
            std::fs::write(at(format!("{i}.{}.ply", engine.id)), file)?;
        }
        Ok(())
    }
}

/// What the trilinear interpolant of a box has for a surface.
fn truth_of_samples(sampled: &Sampled, ties: Ties) -> Result<Truth> {
    let samples = isostudy_trilinear::Samples::try_new(sampled.counts, &sampled.values)?;
    let surface = topology(&samples, sampled.isovalue, ties.into())?;
    Ok(Truth {
        components: surface.components.len() as u64,
        euler: surface.euler_characteristic(),
        boundary: surface.boundary_loops(),
        volume: None,
        area: None,
        within: 1.0,
    })
}

/// Seconds of an answer. What an engine that calls a field spends in it is a part of its time.
fn seconds(answer: &Answer, engine: &Engine) -> f64 {
    let callback_s = if engine.takes == Takes::Field { answer.callback_s.unwrap_or_default() } else { 0.0 };
    answer.extraction_s.map_or_else(|| answer.wall.as_secs_f64(), |seconds| seconds + callback_s)
}

fn in_words(fault: &Fault, boxes: usize) -> String {
    let number = |value: f64| match value.fract() == 0.0 {
        true => format!("{value}"),
        false => format!("{value:.3}"),
    };
    let words =
        format!("{} {}, expected {}", number(fault.found), fault.kind.words(), number(fault.expected));
    if boxes > 1 { format!("{words}, and the like in {} of {boxes} grids", fault.boxes) } else { words }
}

/// As much as a table can show.
pub(super) fn in_a_line(text: &str) -> String {
    let line: Vec<&str> = text.split_whitespace().collect();
    line.join(" ").chars().take(300).collect()
}
