//! The cases of a study's sweep: meshes measured and pictured, and times. A block of a pair's cases is a job, and leaves one file of the
//! long data set that all blocks make up.

use super::meshes::TICKS_A_MESH;
use super::worker::Measurement;
use super::{Making, Pipeline};
use crate::made;
use crate::picture::{self, Drawn};
use crate::prepare::{Spacings, Wanted, prepare};
use crate::store::{Inputs, Stamp, Store, Writer, remove_if_there};
use crate::terminal::progress::Step;
use crate::{machine, source_digests};
use anyhow::{Context, Result};
use isostudy_bench::Plan;
use isostudy_design::Configuration;
use isostudy_design::config::Look;
use isostudy_design::record::{BenchRun, MeshRecord, Purpose};
use isostudy_design::sweep::{Case, Sweep, Swept};
use isostudy_extract::{Execution, Extractor};
use isostudy_inference::cases::{SweepFound, SweepSums};
use isostudy_report::{CaseMesh, CaseTimes, LongFrame, case_meshes, case_times, measured_cases, timed_cases};
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::PathBuf;

/// Of the files' columns: another layout has another digest.
const LAYOUT: u32 = 1;

/// Cases of one pair that one job does.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block<'s> {
    /// Which pair.
    pub(super) configuration: &'s Configuration,
    /// The pair's place in the sweep.
    pair: usize,
    /// From 0, within the pair.
    number: u64,
}

/// What is made of cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Of {
    Meshes,
    Times,
}

impl Of {
    fn name(self) -> &'static str {
        match self {
            Self::Meshes => "meshes",
            Self::Times => "times",
        }
    }
}

impl Block<'_> {
    /// `sweep/meshes/hills/mc/00002`.
    pub(super) fn id(&self, of: Of) -> String {
        let id = &self.configuration.id;
        format!("sweep/{}/{}/{}/{:05}", of.name(), id.object, id.method, self.number)
    }

    /// Its file, in folders whose names say the object and the method, as data frames read them.
    pub(super) fn file(&self, of: Of) -> String {
        let id = &self.configuration.id;
        format!("sweep/{}/object={}/method={}/{:05}.parquet", of.name(), id.object, id.method, self.number)
    }

    fn picture(&self, case: &Case<'_>) -> String {
        let id = &self.configuration.id;
        format!("sweep/pictures/object={}/method={}/{:06}.png", id.object, id.method, case.number)
    }
}

/// All blocks of a sweep, pair by pair.
pub(super) fn blocks<'s>(sweep: &Sweep<'s>) -> impl Iterator<Item = Block<'s>> {
    let of_job = u64::from(sweep.section.cases_per_job);
    sweep.pairs.iter().enumerate().flat_map(move |(pair, of)| {
        let configuration = of.configuration;
        (0..of.cases.div_ceil(of_job)).map(move |number| Block { configuration, pair, number })
    })
}

/// Cases that have the same object, one after the other.
fn by_object<'c, 's>(cases: &'c [Case<'s>], pair: &Swept<'_>) -> impl Iterator<Item = &'c [Case<'s>]> {
    let of_object = pair.settings_of_object();
    cases.chunk_by(move |a, b| a.settings[..of_object] == b.settings[..of_object])
}

impl<'a> Pipeline<'a> {
    fn declared_sweep(&self) -> Result<&Sweep<'a>> {
        self.sweep.as_ref().with_context(|| format!("{}: there is no [sweep]", self.study.path.display()))
    }

    fn cases_of(&self, block: &Block<'_>) -> Result<(&Sweep<'a>, &Swept<'a>, Range<u64>)> {
        let sweep = self.declared_sweep()?;
        let (pair, of_job) = (&sweep.pairs[block.pair], u64::from(sweep.section.cases_per_job));
        let first = block.number * of_job;
        Ok((sweep, pair, first..pair.cases.min(first + of_job)))
    }

    /// Cells per axis of each case of a block.
    pub(super) fn cells_of(&self, block: &Block<'_>) -> Result<Vec<u32>> {
        let (sweep, pair, range) = self.cases_of(block)?;
        Ok(range.map(|number| sweep.case(pair, number).cells).collect())
    }

    /// Everything that a block depends on.
    pub(super) fn case_inputs(&self, block: &Block<'_>, of: Of) -> Result<Inputs> {
        let (sweep, pair, range) = self.cases_of(block)?;
        let mut inputs = self
            .extraction_inputs(block.configuration, Purpose::Benchmark)?
            .value("layout", &LAYOUT)
            .value("settings", &sweep.section.settings.iter().map(|of| &of.key).collect::<Vec<_>>())
            .value("columns", &columns(sweep));
        // Numbers name no files.
        let is_plain = |value: &toml::Value| value.is_integer() || value.is_float() || value.is_bool();
        let may_name_files = pair.settings().any(|setting| !sweep.values(setting).iter().all(is_plain));
        for number in range {
            let case = sweep.case(pair, number);
            let chosen: Vec<(usize, &toml::Value)> =
                case.settings.iter().map(|chosen| (chosen.setting, chosen.value)).collect();
            inputs = inputs.value("case", &(case.number, case.cells, chosen));
            if may_name_files {
                let study = sweep.study_of(pair, &case.settings)?;
                let own = Pipeline::new(&study, Store::nowhere(self.store.root()), self.threads);
                let own = own.extraction_inputs(block.configuration, Purpose::Benchmark)?;
                inputs = inputs.text("with its settings", &own.finish());
            }
        }
        let file = &self.study.file;
        Ok(match of {
            Of::Meshes if sweep.section.pictures => inputs
                .text("pictures", &source_digests::PICTURES.concat())
                .value("camera", &self.study.object(block.configuration).camera)
                .value("turntable", &file.turntable)
                .value("shading", &file.shading),
            Of::Meshes => inputs,
            Of::Times => inputs
                .text("timings", &source_digests::TIMINGS.concat())
                .value("plan", &(sweep.section.times, file.benchmark.warmup))
                .value("threads", &(file.benchmark.threads, file.benchmark.pin)),
        })
    }

    /// Extracts, measures and pictures a block's cases.
    pub(super) fn case_meshes(&self, block: &Block<'_>, step: &Step) -> Result<Stamp> {
        let (sweep, pair, range) = self.cases_of(block)?;
        self.stage(&block.id(Of::Meshes), self.case_inputs(block, Of::Meshes)?, |writer| {
            let cases: Vec<Case<'_>> = range.map(|number| sweep.case(pair, number)).collect();
            let mut made = Vec::new();
            for cases in by_object(&cases, pair) {
                let study = sweep.study_of(pair, &cases[0].settings)?;
                // What is found of the object serves all of its cases here.
                let pipeline = Pipeline::new(&study, Store::nowhere(self.store.root()), self.threads);
                for case in cases {
                    let result = pipeline.case_mesh((sweep, pair), block, case, writer, step);
                    let result = result.with_context(|| said(sweep, pair, case));
                    made.push(CaseMesh { case: case.clone(), made: self.or_left_out(result)? });
                }
            }
            write_rows(writer, &block.file(Of::Meshes), &case_meshes(self.study, sweep, &made))
        })
    }

    /// Times a block's cases, each in processes of its own.
    pub(super) fn case_times(&self, block: &Block<'_>, step: &Step) -> Result<Stamp> {
        let (sweep, pair, range) = self.cases_of(block)?;
        let name = block.id(Of::Times);
        let journal = |number: u64| self.store.journal(&format!("{name}.{number}"));
        let stamp = self.stage(&name, self.case_inputs(block, Of::Times)?, |writer| {
            let mut made = Vec::new();
            for number in range.clone() {
                let case = sweep.case(pair, number);
                let result = self.case_run((block.pair, pair), &case, journal(number), step);
                let result = result.with_context(|| said(sweep, pair, &case));
                made.push(CaseTimes { made: self.or_left_out(result)?, case });
            }
            write_rows(writer, &block.file(Of::Times), &case_times(sweep, &made))
        })?;
        range.into_iter().try_for_each(|number| remove_if_there(&journal(number)))?;
        Ok(stamp)
    }

    /// Does the whole sweep, and returns a digest of all that it left; `None` of a study without one.
    pub(super) fn sweep_cases(&self) -> Result<Option<String>> {
        let Some(sweep) = &self.sweep else { return Ok(None) };
        let kinds: &[Of] = if sweep.section.times > 0 { &[Of::Meshes, Of::Times] } else { &[Of::Meshes] };
        let count = blocks(sweep).count() * kinds.len();
        let step = Step::begin("sweep", count, count * TICKS_A_MESH);
        let (mut digest, mut reached) = (Inputs::default(), 0);
        for &of in kinds {
            for block in blocks(sweep) {
                let stamp = self.case_block(&block, of, &step)?;
                step.count(stamp.redone);
                digest = digest.stamp(&stamp);
                reached += TICKS_A_MESH;
                step.reach(reached);
            }
        }
        step.end();
        Ok(Some(digest.finish()))
    }

    pub(super) fn case_block(&self, block: &Block<'_>, of: Of, step: &Step) -> Result<Stamp> {
        match of {
            Of::Meshes => self.case_meshes(block, step),
            Of::Times => self.case_times(block, step),
        }
    }

    /// What the finished sweep says, read file by file.
    pub(super) fn sweep_found(&self) -> Result<Option<SweepFound>> {
        let Some(sweep) = &self.sweep else { return Ok(None) };
        let mut sums = SweepSums::new(sweep);
        let step = Step::begin("sweep", 0, 0);
        for block in blocks(sweep) {
            let in_region = self.study.object(block.configuration).region.is_some();
            let rows = |of: Of| self.store.read(&self.case_block(&block, of, &step)?, ".parquet");
            let file = block.file(Of::Meshes);
            let mut without_mesh = BTreeSet::new();
            for (number, measures) in measured_cases(rows(Of::Meshes)?, in_region).context(file)? {
                sums.add(block.pair, number, measures.as_deref());
                if measures.is_none() {
                    without_mesh.insert(number);
                }
            }
            if sweep.section.times == 0 {
                continue;
            }
            for (number, time) in timed_cases(rows(Of::Times)?).with_context(|| block.file(Of::Times))? {
                if let Some((machine, seconds)) = time {
                    // To find nothing takes another time than a mesh.
                    let seconds = Some(seconds).filter(|_| !without_mesh.contains(&number));
                    sums.add_time(block.pair, number, &machine, seconds);
                }
            }
        }
        Ok(Some(sums.found()))
    }

    /// The mesh of a case, whose object this pipeline has.
    fn case_mesh(
        &self,
        (sweep, pair): (&Sweep<'_>, &Swept<'_>),
        block: &Block<'_>,
        case: &Case<'_>,
        writer: &mut Writer<'_>,
        step: &Step,
    ) -> Result<Result<MeshRecord, String>> {
        let study = sweep.study_of(pair, &case.settings)?;
        let wanted = Wanted::Cells(case.cells, Purpose::Benchmark);
        let spacings = Spacings::default();
        let prepared = prepare(&study, &self.fields, &spacings, block.configuration, wanted)?;
        let mut extractor = Extractor::new().with_progress(step.within(0));
        // On one thread, so that calls of the field are counted.
        let made = prepared.make_any(&mut extractor, &Execution { threads: 1 })?;
        if made.mesh.triangles.is_empty() {
            return Ok(Err("no surface: no triangle is left".into()));
        }
        let spacing = wanted.spacing(study.object(block.configuration));
        let spacings = [spacing, spacing];
        let (mesh, record) =
            self.measured(block.configuration, Purpose::Benchmark, &prepared, made, spacings)?;
        if sweep.section.pictures {
            let file = &study.file;
            let turntable = picture::turntable(&file.turntable, &study.object(block.configuration).camera);
            let drawn = Drawn::new(&mesh, Look::Flat, || unreachable!("flat surfaces have no numbers"))?;
            let frame = drawn.first_frame(&mesh, &turntable, &picture::shading(&file.shading))?;
            writer.write(&block.picture(case), &isostudy_raster::pixmap_to_png(&frame))?;
        }
        Ok(Ok(record))
    }

    fn case_run(
        &self,
        (place, pair): (usize, &Swept<'_>),
        case: &Case<'_>,
        journal: PathBuf,
        step: &Step,
    ) -> Result<Result<BenchRun, String>> {
        let (sweep, benchmark) = (self.declared_sweep()?, &self.study.file.benchmark);
        let study = sweep.study_of(pair, &case.settings)?;
        let machine = machine::read();
        let plan = Plan {
            study: self.study.file.study.id.clone(),
            workloads: Pipeline::new(&study, Store::nowhere(self.store.root()), self.threads)
                .workloads(&[pair.configuration], Some(case.cells))?,
            warmup: benchmark.warmup,
            iterations: sweep.section.times,
            batches: 1,
            until: None,
            aa_iterations: 0,
            memory: true,
            allocations: false,
            seed: self.study.file.study.seed,
            threads: benchmark.threads,
            pin: benchmark.pin,
            target: self.study.target.clone(),
        };
        let key = Inputs::of_sources(source_digests::TIMINGS)
            .value("machine", &machine.lasting())
            .value("plan", &plan)
            .finish();
        let measurement = Measurement {
            plan: &plan,
            configurations: vec![pair.configuration],
            cells: Some(case.cells),
            case: Some((place, case.number)),
        };
        let run = self.run(&measurement, machine, &journal, &key, step, &|_| false)?;
        Ok(match run.failed.first() {
            Some(failed) => Err(failed.reason.clone()),
            None => Ok(run),
        })
    }

    /// A case whose program or front is to blame has none, and the others go on; see [`fail`](Self::fail).
    fn or_left_out<T>(&self, made: Result<Result<T, String>>) -> Result<Result<T, String>> {
        match made {
            Ok(made) => Ok(made),
            Err(error) => match made::own_failure(&error) {
                Some(why) if !matches!(self.making, Making::Only(_)) || made::fails_again(&error) => {
                    Ok(Err(why))
                }
                _ => Err(error),
            },
        }
    }
}

/// `ss_bi, case 12: 32 cells per axis, method.edge_clamp = 0.2`.
fn said(sweep: &Sweep<'_>, pair: &Swept<'_>, case: &Case<'_>) -> String {
    let settings = case.settings.iter().map(|of| format!(", {} = {}", sweep.name(of.setting), of.value));
    let settings: String = settings.collect();
    format!("{}, case {}: {} cells per axis{settings}", pair.configuration.id, case.number, case.cells)
}

fn write_rows(writer: &mut Writer<'_>, path: &str, rows: &LongFrame) -> Result<()> {
    writer.write(path, &rows.to_parquet().with_context(|| path.to_owned())?)
}

/// What decides the types of the columns of settings, which all files have in common.
fn columns(sweep: &Sweep<'_>) -> Vec<[bool; 3]> {
    let kinds = |setting: usize| {
        let all = |is: fn(&toml::Value) -> bool| sweep.values(setting).iter().all(is);
        [
            all(toml::Value::is_integer),
            all(|value| value.is_integer() || value.is_float()),
            all(toml::Value::is_bool),
        ]
    };
    (0..sweep.section.settings.len()).map(kinds).collect()
}
