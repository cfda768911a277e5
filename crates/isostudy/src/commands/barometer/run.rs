//! `isostudy barometer run`: all workloads, by all engines that can be started.

use super::given::{self, ENGINES, Given};
use super::measuring::{Asked, MESH, Running, in_a_line};
use super::page;
use crate::consent;
use crate::digests::Digests;
use crate::machine;
use crate::outcome::Outcome;
use crate::store::{remove_if_there, sha256, write_whole};
use crate::terminal::counted;
use anyhow::{Context, Result, bail};
use clap::Args;
use isostudy_barometer::engine::{Engine, Takes, Ties};
use isostudy_barometer::packed::{Conformance, Packed};
use isostudy_barometer::ranks::{Quantity, rank};
use isostudy_barometer::recording::{About, ConformanceRow, EngineRow, Row, State, write};
use isostudy_mesh::{TriangleMesh, write_ply};
use isostudy_program::{Program, Request, Samples, write_samples};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A request may take so long.
const TIME_LIMIT: Duration = Duration::from_secs(90);
/// A program may have so much memory.
const MEMORY_LIMIT: u64 = 10 << 30;
/// Random grids along each side of a volume.
const GRIDS_A_SIDE: usize = 20;
/// Volumes of random grids: 104,000 grids.
const VOLUMES: u64 = 13;
/// An engine that has taken so long for random grids is given no more of them.
const LONGEST_FOR_GRIDS: Duration = Duration::from_secs(20);
/// Draws volumes and the order of turns.
const SEED: u64 = 41;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder with engines.toml and files of workloads
    folder: PathBuf,
    /// Folder of the recording; what it has of an earlier run is kept
    #[arg(short, long, value_name = "FOLDER", default_value = "results/barometer")]
    out: PathBuf,
    /// Only what is marked as quick, three rounds, and 2,000 random grids
    #[arg(long)]
    quick: bool,
    /// Time each engine so often
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: Option<u32>,
    /// Only this engine; may be given several times
    #[arg(long, value_name = "ID")]
    engine: Vec<String>,
    /// Only this workload; may be given several times
    #[arg(long, value_name = "ID")]
    workload: Vec<String>,
    /// The day, as the recording tells it, such as 2026-11-28
    #[arg(long, value_name = "DATE")]
    date: Option<String>,
    /// Run the programs that engines.toml names, and remember that they are allowed
    #[arg(long)]
    allow_programs: bool,
}

/// What results depend on beside workloads and engines' tables.
struct Known {
    rows: Vec<EngineRow>,
    machine: String,
    /// Of the files that commands name.
    digests: RefCell<Digests>,
}

/// All that an engine's results depend on: its table, what it told, and the files that its command names.
#[derive(Serialize)]
struct Identity<'a> {
    build: [&'static str; 2],
    machine: &'a str,
    engine: &'a Engine,
    told: Option<&'a EngineRow>,
    files: Vec<String>,
}

impl Known {
    fn identity<'a>(&'a self, running: &'a Running) -> Result<Identity<'a>> {
        let engine = running.engine;
        let digest = |file: &PathBuf| self.digests.borrow_mut().of(file);
        let files = running.program.files()?.iter().map(digest).collect::<Result<_>>()?;
        Ok(Identity {
            build: [env!("ISOSTUDY_COMMIT"), env!("ISOSTUDY_DIRTY")],
            machine: &self.machine,
            engine,
            told: self.rows.iter().find(|row| row.engine == engine.id),
            files,
        })
    }
}

/// What is kept of a part, with a digest of all that it depends on.
#[derive(Serialize, Deserialize)]
struct Part<T> {
    of: String,
    found: T,
}

/// Runs what has not been run, and writes the recording.
///
/// # Errors
/// If a file cannot be read or written, or a program is not allowed.
pub(super) fn run(arguments: &Arguments) -> Result<Outcome> {
    let mut given = given::read(&arguments.folder)?;
    select(arguments, &mut given)?;
    let (rounds, volumes, side) =
        if arguments.quick { (3, 2, GRIDS_A_SIDE / 2) } else { (5, VOLUMES, GRIDS_A_SIDE) };
    // Who asks for a workload waits for nothing else.
    let volumes = if arguments.workload.is_empty() { volumes } else { 0 };
    let rounds = arguments.rounds.unwrap_or(rounds);
    let out = &arguments.out;
    std::fs::create_dir_all(out.join("parts")).with_context(|| out.display().to_string())?;

    let base = arguments.folder.clone();
    let program = |engine: &Engine| Program {
        command: engine.command.clone(),
        base: base.clone(),
        time_limit: TIME_LIMIT,
        memory_limit_bytes: Some(MEMORY_LIMIT),
        sandbox: false,
    };
    // Those whose program is not there are absent, and no error: few machines have all.
    let (there, missing): (Vec<&Engine>, Vec<&Engine>) =
        given.engines.engines.iter().partition(|engine| program(engine).check().is_ok());
    let programs: Vec<(String, Program)> =
        there.iter().map(|engine| (engine.id.clone(), program(engine))).collect();
    consent::ask_for(&arguments.folder.join(ENGINES), &programs, arguments.allow_programs, false)?;

    let mut engines = Vec::new();
    let mut about_engines = Vec::new();
    for engine in there {
        match Running::start(engine, program(engine)) {
            Ok(running) => {
                let ready = running.worker.as_ref().map(|worker| worker.ready().clone());
                let ready = ready.with_context(|| engine.id.clone())?;
                about_engines.push(row_of(engine, &ready.version, ready.note.as_deref().unwrap_or(""), true));
                engines.push(running);
            }
            Err(error) => about_engines.push(row_of(engine, "", &in_a_line(&error.to_string()), false)),
        }
    }
    for engine in missing {
        let why = program(engine).check().err().map(|error| error.to_string()).unwrap_or_default();
        about_engines.push(row_of(engine, "", &why, false));
    }
    for left_out in about_engines.iter().filter(|row| !row.ran) {
        tell!("{} is left out: {}", left_out.engine, left_out.note);
        if arguments.engine.contains(&left_out.engine) {
            bail!("{}: it was asked for, and is not there", left_out.engine);
        }
    }
    if engines.is_empty() {
        bail!("{}: none of the engines is there", arguments.folder.display());
    }
    tell!(
        "{} and {}",
        counted(engines.len() as u64, "engine"),
        counted(given.workloads.len() as u64, "workload")
    );

    // One engine in two processes says what is noise.
    let ours = engines.iter().position(|running| running.engine.ours).unwrap_or(0);
    let first = engines[ours].engine;
    let again = Engine { id: format!("{} again", first.id), ..first.clone() };
    engines.push(Running { is_second: true, ..Running::start(&again, program(&again))? });
    let machine = machine::read().model.unwrap_or_default();
    let known = Known { rows: about_engines.clone(), machine, digests: RefCell::default() };

    let rows = measure(out, &given, &mut engines, &known, rounds)?;
    let (conformance, with_tunnels) = conformance(out, &mut engines, &known, volumes, side)?;
    let noise = noise(&rows, &first.id, &again.id);
    let noise_of_scores = noise_of_scores(&rows, [&first.id, &again.id]);
    let rows: Vec<Row> = rows.into_iter().filter(|row| row.engine != again.id).collect();
    for absent in &given.engines.absent {
        about_engines.push(EngineRow {
            engine: absent.id.clone(),
            name: absent.name.clone(),
            version: String::new(),
            license: String::new(),
            install: String::new(),
            family: String::new(),
            takes: Takes::Samples,
            ours: false,
            note: absent.why.clone(),
            ran: false,
        });
    }
    let machine = machine::read();
    let grids = volumes * (side as u64).pow(3);
    let about = About {
        schema: 1,
        date: arguments.date.clone().unwrap_or_default(),
        cpu: machine.model.clone().unwrap_or_default(),
        cpus: std::thread::available_parallelism().map_or(0, usize::from) as u32,
        commit: machine.build.commit.clone().unwrap_or_default(),
        profile: format!("{}, opt-level {}", machine.build.profile, machine.build.opt_level),
        rounds,
        noise,
        noise_of_scores,
        grids,
        grids_with_tunnels: with_tunnels,
    };
    record(out, "measurements.csv", &rows)?;
    record(out, "engines.csv", &about_engines)?;
    record(out, "conformance.csv", &conformance)?;
    write_whole(&out.join("about.toml"), toml::to_string(&about)?.as_bytes())?;
    page::write(out)?;
    tell!("{}: the recording, and index.html", out.display());
    Ok(Outcome::Done)
}

fn select(arguments: &Arguments, given: &mut Given) -> Result<()> {
    for id in &arguments.engine {
        if !given.engines.engines.iter().any(|engine| engine.id == *id) {
            bail!("{}: there is no engine {id}", arguments.folder.join(ENGINES).display());
        }
    }
    for id in &arguments.workload {
        if !given.workloads.iter().any(|(_, workload)| workload.id == *id) {
            bail!("{}: there is no workload {id}", arguments.folder.display());
        }
    }
    let wanted = |ids: &[String], id: &String, quick: bool| {
        if ids.is_empty() { !arguments.quick || quick } else { ids.contains(id) }
    };
    given.engines.engines.retain(|engine| wanted(&arguments.engine, &engine.id, engine.quick));
    given.workloads.retain(|(_, workload)| wanted(&arguments.workload, &workload.id, workload.quick));
    Ok(())
}

fn row_of(engine: &Engine, version: &str, note: &str, ran: bool) -> EngineRow {
    EngineRow {
        engine: engine.id.clone(),
        name: engine.name.clone(),
        version: version.to_owned(),
        license: engine.license.clone(),
        install: engine.install.clone(),
        family: engine.family.clone(),
        takes: engine.takes,
        ours: engine.ours,
        note: note.to_owned(),
        ran,
    }
}

fn record<T: Serialize>(out: &Path, name: &str, rows: &[T]) -> Result<()> {
    let mut bytes = Vec::new();
    write(rows, &mut bytes)?;
    write_whole(&out.join(name), &bytes)
}

/// A part that is there, if it is of the same; else it is made, and kept.
fn part<T: Serialize + DeserializeOwned>(
    path: &Path,
    of: &impl Serialize,
    make: impl FnOnce() -> Result<T>,
) -> Result<T> {
    let of = sha256(serde_json::to_string(of)?.as_bytes());
    if let Ok(bytes) = std::fs::read(path)
        && let Ok(kept) = serde_json::from_slice::<Part<T>>(&bytes)
        && kept.of == of
    {
        return Ok(kept.found);
    }
    let found = make()?;
    let kept = Part { of, found };
    write_whole(path, &serde_json::to_vec(&kept)?)?;
    Ok(kept.found)
}

fn measure(
    out: &Path,
    given: &Given,
    engines: &mut [Running],
    known: &Known,
    rounds: u32,
) -> Result<Vec<Row>> {
    let mut all = Vec::new();
    let identities = engines.iter().map(|of| known.identity(of)).collect::<Result<Vec<_>>>()?;
    let identities = serde_json::to_string(&identities)?;
    let count = given.workloads.len();
    for (i, (group, workload)) in given.workloads.iter().enumerate() {
        let (at, id) = (i + 1, &workload.id);
        if let Some(file) = given.missing(workload) {
            tell!(
                "{at} of {count}: {id}: {} is not there; scripts/fetch-samples.sh and make bunny fetch it",
                file.display()
            );
            continue;
        }
        let path = out.join("parts").join(format!("{id}.json"));
        let mut is_new = false;
        let rows = part(&path, &(&identities, workload, rounds), || {
            is_new = true;
            tell!("{at} of {count}: {id}");
            let boxes = given::sampled(&given.folder, workload).with_context(|| format!("workload {id}"))?;
            let mut random = Pcg64::seed_from_u64(SEED + i as u64);
            Asked::new(*group, workload, boxes, out)?.measure(engines, rounds, &mut random)
        })?;
        if !is_new {
            tell!("{at} of {count}: {id}, kept");
            let samples = workload.samples.iter().map(|&n| f64::from(n)).product::<f64>();
            let boxes = workload.boxes.iter().map(|&n| f64::from(n)).product::<f64>();
            for (running, row) in engines.iter_mut().zip(&rows) {
                running.learn(row, samples * boxes);
            }
        }
        all.extend(rows);
    }
    Ok(all)
}

fn conformance(
    out: &Path,
    engines: &mut [Running],
    known: &Known,
    volumes: u64,
    side: usize,
) -> Result<(Vec<ConformanceRow>, u64)> {
    let packed: Vec<Packed> = (0..volumes).map(|volume| Packed::new(side, SEED + volume)).collect();
    let counted_path = out.join("parts/conformance.json");
    let with_tunnels = part(&counted_path, &(volumes, side), || {
        Ok(packed.iter().map(|packed| packed.with_tunnels(Ties::Outside)).sum::<u64>())
    })?;
    let mut rows = Vec::new();
    if packed.is_empty() {
        return Ok((rows, 0));
    }
    let count = engines.iter().filter(|running| !running.is_second).count();
    for (i, running) in engines.iter_mut().filter(|running| !running.is_second).enumerate() {
        let engine = running.engine;
        let path = out.join("parts").join(format!("conformance-{}.json", engine.id));
        let identity = serde_json::to_string(&known.identity(running)?)?;
        let row = part(&path, &(identity, volumes, side), || {
            tell!("random grids, engine {} of {count}: {}", i + 1, engine.id);
            let kept = out.join("wrong/random-grids");
            for ending in ["ply", "json"] {
                remove_if_there(&kept.join(format!("{}.{ending}", engine.id)))?;
            }
            let begun = Instant::now();
            let mut found = Conformance::default();
            let mut failed = String::new();
            for (volume, packed) in packed.iter().enumerate() {
                if begun.elapsed() > LONGEST_FOR_GRIDS {
                    break;
                }
                let request = Request {
                    samples: Samples::Values(packed.values()),
                    size: [packed.samples() as u32; 3],
                    origin: [0.0; 3],
                    spacing: [1.0; 3],
                    isovalue: 0.0,
                    mesh: Some(Path::new(MESH)),
                    may_be_empty: false,
                };
                match running.ask(&request) {
                    Ok(answer) => {
                        let mesh = answer.mesh.unwrap_or_default();
                        packed.check(&mesh, engine.ties, engine.soup, volume as u64, &mut found);
                        if volume == 0 && !found.wrong.is_empty() {
                            keep_grids(out, engine, packed, &found, &mesh)?;
                        }
                    }
                    Err(error) => {
                        // What was found before it failed stays.
                        failed = in_a_line(&error.to_string());
                        break;
                    }
                }
            }
            let wrong: Vec<String> =
                found.wrong.iter().map(|[volume, grid]| format!("{volume}:{grid}")).collect();
            Ok(ConformanceRow {
                engine: engine.id.clone(),
                grids: found.grids,
                right: found.right,
                same_topology: found.same_topology,
                closed_manifold: found.closed_manifold,
                wrong: wrong.join(" "),
                failed,
            })
        })?;
        rows.push(row);
    }
    Ok((rows, with_tunnels))
}

/// Keeps the mesh of the first volume of grids, for whoever wants to see what is wrong.
fn keep_grids(
    out: &Path,
    engine: &Engine,
    packed: &Packed,
    found: &Conformance,
    mesh: &TriangleMesh,
) -> Result<()> {
    let folder = out.join("wrong/random-grids");
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    write_samples(&folder.join("0.f32"), packed.values())?;
    let grids: Vec<u64> = found.wrong.iter().map(|[_, grid]| *grid).collect();
    let about = serde_json::json!({ "samples": packed.samples(), "grids": grids, "soup": engine.soup });
    write_whole(&folder.join(format!("{}.json", engine.id)), about.to_string().as_bytes())?;
    let mut file = Vec::new();
    write_ply(mesh, &mut file)?;
    write_whole(&folder.join(format!("{}.ply", engine.id)), &file)
}

/// By what ratio the scores of one engine in two processes may differ: at most from the lower end of one interval to the upper end of the
/// other, which is more than the interval of the ratio.
fn noise_of_scores(rows: &[Row], ids: [&String; 2]) -> f64 {
    let rows: Vec<Row> = rows.iter().filter(|row| ids.contains(&&row.engine)).cloned().collect();
    let ranking = rank(&rows, Quantity::Time, 0.0, 1.0, SEED);
    let [one, other] = ids.map(|id| ranking.standings.iter().find(|of| of.engine == *id));
    one.zip(other).map_or(1.0, |(one, other)| (one.high / other.low).max(other.high / one.low))
}

/// The ratio of an engine's times in two processes, from the 5th to the 95th percentile over workloads.
fn noise(rows: &[Row], one: &str, other: &str) -> [f64; 2] {
    let time = |engine: &str, workload: &str| {
        let row = rows.iter().find(|row| row.engine == engine && row.workload == workload)?;
        row.time_s.filter(|_| row.state == State::Right)
    };
    let mut ratios: Vec<f64> = rows
        .iter()
        .filter(|row| row.engine == one)
        .filter_map(|row| Some(time(other, &row.workload)? / time(one, &row.workload)?))
        .collect();
    ratios.sort_by(f64::total_cmp);
    let at = |share: f64| ratios.get((share * ratios.len().saturating_sub(1) as f64).round() as usize);
    [0.05, 0.95].map(|share| at(share).copied().unwrap_or(1.0))
}
