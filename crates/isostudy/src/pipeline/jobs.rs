//! A study as jobs that any machine can do: which there are, what each needs and costs, and one of them done.
//!
//! A job is a stage of the pipeline, by the stage's own name, or all that follows from the others. What does a study in one run and what
//! does it job by job are the same functions: a job looks up every stage but its own.

mod costs;
mod files;

use super::cases::{Block, Of, blocks};
use super::films::pair_stage;
use super::meshes::{TICKS_A_MESH, purpose_name};
use super::stimuli::MadeWith;
use super::tables::study_inputs;
use super::timings::machine_stage;
use super::viewer::has_library;
use super::{Making, Pipeline, PlanLength};
use crate::prepare::Wanted;
use crate::recipe::{self, Recipe, recipe};
use crate::store::{Inputs, Stamp};
use crate::terminal::progress::Step;
use crate::work_time::Trials;
use crate::{shown_files, source_digests};
use anyhow::{Context, Result, bail};
use files::NamedFiles;
use isostudy_design::config::StillSection;
use isostudy_design::forms::Stimulus;
use isostudy_design::record::Purpose;
use isostudy_design::wording::did_you_mean;
use isostudy_design::{Configuration, ConfigurationId, Study};
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::PoisonError;

/// The job that makes tables, figures and pages of all the others.
pub(crate) const REPORT: &str = "report";

/// A part of a study that is done by itself.
#[derive(Debug, Clone)]
enum Job<'s> {
    Budget(Purpose, &'s Configuration),
    Mesh(Purpose, &'s Configuration),
    /// What all films of a study have in common.
    Films,
    Turntable(&'s Configuration),
    Pair(Stimulus),
    Still(&'s StillSection),
    /// At this multiple of the stimulus spacing.
    ViewerMesh(&'s Configuration, f64),
    Timings,
    /// On the machine that the study calls so.
    OnMachine(&'s str),
    /// Of the object with this place.
    Chunks(usize),
    Stored(usize),
    /// Cases of the sweep.
    Cases(Of, Block<'s>),
    Report,
}

/// A job, as a scheduler needs to know it.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Planned {
    /// What `isostudy job` calls it.
    pub(crate) id: String,
    pub(crate) kind: &'static str,
    /// Jobs that come first.
    pub(crate) needs: Vec<String>,
    /// Files that it reads beside what those jobs leave: the study file, and what its object and its method name.
    pub(crate) inputs: Vec<String>,
    /// Files that it leaves in the folder of results; none are listed of the report.
    pub(crate) outputs: Vec<String>,
    /// Of everything that it depends on, the jobs that it needs included.
    pub(crate) digest: String,
    /// Whether nothing else may run on its node.
    pub(crate) exclusive: bool,
    /// What the study calls the machine that has to do it; `None` where any may.
    pub(crate) machine: Option<String>,
    /// On one core, unless it is exclusive; `None` for what a program or a family makes, which is not tried.
    pub(crate) expected_s: Option<f64>,
    pub(crate) expected_bytes: Option<u64>,
}

impl Job<'_> {
    fn id(&self, study: &Study) -> String {
        match self {
            Self::Budget(purpose, of) => format!("budget/{}/{}", purpose_name(*purpose), of.id),
            Self::Mesh(purpose, of) => format!("mesh/{}/{}", purpose_name(*purpose), of.id),
            Self::Films => "films".into(),
            Self::Turntable(of) => format!("turntable/{}", of.id),
            Self::Pair(of) => pair_stage(of),
            Self::Still(of) => format!("still/{}", of.id),
            Self::ViewerMesh(of, factor) => format!("viewer/{}/{factor}", of.id),
            Self::Timings => "bench/short".into(),
            Self::OnMachine(name) => machine_stage(name),
            Self::Chunks(object) => format!("chunks/{}", study.file.objects[*object].id),
            Self::Stored(object) => format!("stored/{}", study.file.objects[*object].id),
            Self::Cases(of, block) => block.id(*of),
            Self::Report => REPORT.into(),
        }
    }

    fn kind(&self) -> &'static str {
        match self {
            Self::Budget(..) => "budget",
            Self::Mesh(..) => "mesh",
            Self::Films => "films",
            Self::Turntable(_) => "turntable",
            Self::Pair(_) => "pair",
            Self::Still(_) => "still",
            Self::ViewerMesh(..) => "viewer mesh",
            Self::Cases(Of::Meshes, _) => "cases",
            Self::Timings
            | Self::OnMachine(_)
            | Self::Chunks(_)
            | Self::Stored(_)
            | Self::Cases(Of::Times, _) => "timing",
            Self::Report => REPORT,
        }
    }

    /// Whether another job among all those before it has to be done first. What may fail is timed only where its meshes did not.
    fn needs(&self, other: &Job<'_>, may_fail: &[&Configuration]) -> bool {
        match (self, other) {
            (Self::Report, _) => true,
            (Self::Cases(..), _) => false,
            (
                Self::Timings | Self::OnMachine(_) | Self::Chunks(_) | Self::Stored(_),
                Job::Mesh(purpose, of),
            ) => *purpose != Purpose::Indexed && may_fail.contains(of),
            (Self::Chunks(_) | Self::Stored(_), Job::Timings) => true,
            (Self::Mesh(purpose, of), Job::Budget(for_, other)) => purpose == for_ && of == other,
            (Self::Turntable(of) | Self::ViewerMesh(of, _), Job::Mesh(Purpose::Stimulus, other)) => {
                of == other
            }
            (Self::Pair(of), Job::Turntable(other)) => of.shown.contains(&other.id),
            (Self::Pair(_), Job::Films) => true,
            (Self::Timings | Self::OnMachine(_), Job::Budget(Purpose::Benchmark, _)) => true,
            _ => false,
        }
    }
}

impl<'a> Pipeline<'a> {
    /// Every job of the study, each after those that it needs.
    ///
    /// # Errors
    /// If a recipe, a field or a file that the study names cannot be read.
    pub(crate) fn planned(&self) -> Result<Vec<Planned>> {
        let jobs = self.jobs()?;
        let mut costs = Trials::new(self.study);
        let named = NamedFiles::of(self.study)?;
        let mut planned = Vec::new();
        for (job, (needs, digest)) in jobs.iter().zip(self.needs_and_digests(&jobs)?) {
            let (expected_s, expected_bytes) = self.cost(job, &mut costs)?;
            planned.push(Planned {
                id: job.id(self.study),
                kind: job.kind(),
                needs: needs.iter().map(|&other| jobs[other].id(self.study)).collect(),
                inputs: named.of_job(self.study, job),
                outputs: self.outputs(job),
                digest,
                exclusive: job.kind() == "timing",
                machine: match job {
                    Job::OnMachine(name) => Some((*name).to_owned()),
                    _ => None,
                },
                expected_s,
                expected_bytes,
            });
        }
        Ok(planned)
    }

    /// Of each job the places of those that it needs, which are before it, and its digest.
    fn needs_and_digests(&self, jobs: &[Job<'_>]) -> Result<Vec<(Vec<usize>, String)>> {
        let may_fail = self.may_fail()?;
        let mut known = vec![None; jobs.len()];
        let places = 0..jobs.len();
        places
            .map(|place| {
                let digest = self.digest(place, jobs, &may_fail, &mut known)?;
                Ok((needed(place, jobs, &may_fail), digest))
            })
            .collect()
    }

    /// The digest of a job, and of those that it needs on the way: a job of a million is not to wait for all others.
    fn digest(
        &self,
        place: usize,
        jobs: &[Job<'_>],
        may_fail: &[&Configuration],
        known: &mut Vec<Option<String>>,
    ) -> Result<String> {
        if let Some(digest) = &known[place] {
            return Ok(digest.clone());
        }
        let mut digest = Inputs::default().text("job", &self.own_inputs(&jobs[place])?.finish());
        for other in needed(place, jobs, may_fail) {
            digest = digest.text(&jobs[other].id(self.study), &self.digest(other, jobs, may_fail, known)?);
        }
        let digest = digest.finish();
        known[place] = Some(digest.clone());
        Ok(digest)
    }

    /// Does one job and nothing else; it is not done again where it is up to date. Returns why what it makes is left out, where a
    /// program or a family is to blame. What is found of an object serves the next job on it as well.
    ///
    /// # Errors
    /// If the study has no such job; if a job that it needs is not up to date; what the job returns.
    pub(crate) fn job(&mut self, id: &str) -> Result<Option<String>> {
        let (study, jobs) = (self.study, self.jobs()?);
        let place = place(study, &jobs, id)?;
        self.making = Making::Only(id.to_owned());
        self.carry_out(&jobs[place])?;
        let left_out = std::mem::take(&mut *self.failed.write().unwrap_or_else(PoisonError::into_inner));
        Ok(left_out.into_iter().next().map(|(of, why)| format!("{of}: {why}")))
    }

    /// Checks that jobs still have the digests that a plan gave them.
    ///
    /// # Errors
    /// The first that has another; if the study has no such job.
    pub(crate) fn check_digests(&self, ids: &[String], digests: &[String]) -> Result<()> {
        if digests.is_empty() {
            return Ok(());
        }
        let (jobs, may_fail) = (self.jobs()?, self.may_fail()?);
        let mut known = vec![None; jobs.len()];
        for (id, digest) in ids.iter().zip(digests) {
            let now = self.digest(place(self.study, &jobs, id)?, &jobs, &may_fail, &mut known)?;
            if now != *digest {
                bail!(
                    "{id}: {} or a file that it names has changed since the plan was made: the job's digest is {now}, and no longer \
                     {digest}. Make the plan again",
                    self.study.path.display()
                );
            }
        }
        Ok(())
    }

    /// All jobs, in the order in which one run does them.
    fn jobs(&self) -> Result<Vec<Job<'a>>> {
        let study = self.study;
        let all = || study.configurations.iter();
        if study.shown_files().is_some() {
            let of_meshes = all().filter(|_| !study.shows_films());
            let mut jobs: Vec<Job<'_>> =
                of_meshes.clone().map(|of| Job::Mesh(Purpose::Stimulus, of)).collect();
            jobs.extend(of_meshes.map(Job::Turntable));
            jobs.extend(study.shows_films().then_some(Job::Films));
            jobs.extend(study.stimuli().into_iter().map(Job::Pair));
            jobs.push(Job::Report);
            return Ok(jobs);
        }
        let mut purposes = vec![Purpose::Benchmark, Purpose::Stimulus];
        if recipe::sums_positions(study)? {
            purposes.push(Purpose::Indexed);
        }
        let mut jobs = Vec::new();
        for &purpose in &purposes {
            let with_budget = all().filter(|of| study.method(of.id.method).budget.is_some());
            jobs.extend(with_budget.map(|of| Job::Budget(purpose, of)));
        }
        jobs.extend(purposes.iter().flat_map(|&purpose| all().map(move |of| Job::Mesh(purpose, of))));
        jobs.extend(all().map(Job::Turntable));
        jobs.extend(study.stimuli().into_iter().map(Job::Pair));
        jobs.extend(study.file.stills.iter().map(Job::Still));
        jobs.push(Job::Timings);
        jobs.extend(study.file.benchmark.machines.iter().map(|name| Job::OnMachine(name)));
        let objects = 0..study.file.objects.len();
        let section = &study.file.benchmark;
        jobs.extend(objects.clone().filter(|_| section.chunks > 0).map(Job::Chunks));
        jobs.extend(objects.filter(|_| section.stored).map(Job::Stored));
        if let Some(viewer) = &study.file.viewer
            && has_library(study, viewer)?
        {
            let factors = viewer.from_fine_to_coarse();
            jobs.extend(all().flat_map(|of| {
                factors.iter().map(move |&factor| Job::ViewerMesh(of, factor)).collect::<Vec<_>>()
            }));
        }
        if let Some(sweep) = &self.sweep {
            jobs.extend(blocks(sweep).map(|block| Job::Cases(Of::Meshes, block)));
            let timed = blocks(sweep).filter(|_| sweep.section.times > 0);
            jobs.extend(timed.map(|block| Job::Cases(Of::Times, block)));
        }
        jobs.push(Job::Report);
        Ok(jobs)
    }

    fn carry_out(&self, job: &Job<'_>) -> Result<()> {
        match job {
            Job::Budget(purpose, of) => self.budgets(&[*purpose], std::slice::from_ref(&of.id)),
            Job::Mesh(_, of) if self.study.shown_files().is_some() => {
                self.shown_meshes(std::slice::from_ref(&of.id)).map(drop)
            }
            Job::Mesh(purpose, of) => self.meshes(&[*purpose], std::slice::from_ref(&of.id)).map(drop),
            Job::Films => self.films().map(drop),
            Job::Turntable(of) => self.with_stimuli(std::slice::from_ref(&of.id), |_, _| Ok(())),
            Job::Pair(of) if self.study.shows_films() => self.film_pair(of, &self.films()?).map(drop),
            Job::Pair(of) => self.with_stimuli(&of.shown, |pipeline, turntables| {
                pipeline.pair(of, &turntables.iter().collect::<Vec<_>>()).map(drop)
            }),
            Job::Still(of) => {
                let step = Step::begin("stills", 1, TICKS_A_MESH);
                if let Err(error) = self.still(of, &step) {
                    self.fail(&of.configuration, error)?;
                }
                step.end();
                Ok(())
            }
            Job::ViewerMesh(of, factor) => {
                let meshes = self.stimulus_meshes(std::slice::from_ref(&of.id))?;
                self.levels_of(&meshes, &self.selected(std::slice::from_ref(&of.id)), &[*factor]).map(drop)
            }
            Job::Timings => self.short_timings().map(drop),
            Job::OnMachine(name) => self.timings_after_meshes(&PlanLength::On((*name).into())).map(drop),
            Job::Chunks(object) => {
                self.short_timings()?;
                self.chunk_times(Some(*object)).map(drop)
            }
            Job::Stored(object) => {
                self.short_timings()?;
                self.stored_times(Some(*object)).map(drop)
            }
            Job::Cases(of, block) => {
                let step = Step::begin("sweep", 1, TICKS_A_MESH);
                let stamp = self.case_block(block, *of, &step)?;
                step.count(stamp.redone);
                step.end();
                Ok(())
            }
            Job::Report => unreachable!("a report takes the whole folder: `Pipeline::report`"),
        }
    }

    fn short_timings(&self) -> Result<Stamp> {
        self.timings_after_meshes(&PlanLength::Short)
    }

    /// The timings of what did not fail before.
    fn timings_after_meshes(&self, length: &PlanLength) -> Result<Stamp> {
        let may_fail: Vec<ConfigurationId> = self.may_fail()?.into_iter().map(|of| of.id.clone()).collect();
        if !may_fail.is_empty() {
            self.all_meshes(&may_fail)?;
        }
        self.budgets(&[Purpose::Benchmark], &[])?;
        self.timings(length)
    }

    /// What programs and families make: the others go on without what fails of it.
    fn may_fail(&self) -> Result<Vec<&'a Configuration>> {
        let mut may_fail = Vec::new();
        if self.study.shown_files().is_some() {
            return Ok(may_fail);
        }
        for of in &self.study.configurations {
            if matches!(
                recipe(self.study, of.id.method, Purpose::Benchmark)?,
                Recipe::Program(_) | Recipe::Family(_)
            ) {
                may_fail.push(of);
            }
        }
        Ok(may_fail)
    }

    /// Turntables of some configurations, in their order, unless one of them is left out.
    fn with_stimuli(
        &self,
        ids: &[ConfigurationId],
        work: impl FnOnce(&Self, &[Stamp]) -> Result<()>,
    ) -> Result<()> {
        let meshes = self.stimulus_meshes(ids)?;
        let (codes, _) = self.study.code_names();
        let frames = self.study.file.turntable.frames as usize;
        let step = Step::begin("turntables", ids.len(), ids.len() * frames);
        let mut stamps = Vec::new();
        for id in ids {
            let Some(configuration) = self.selected(std::slice::from_ref(id)).first().copied() else {
                step.end();
                return Ok(());
            };
            let place = self.study.configurations.iter().position(|of| of == configuration);
            let code = &codes[place.context("one of the study's own")?];
            let stamp = self.turntable(configuration, code, &meshes, &step)?;
            step.count(stamp.redone);
            stamps.push(stamp);
        }
        step.end();
        work(self, &stamps)
    }

    /// What a job depends on beside those that it needs. A stage may depend on what they find; this is known before.
    fn own_inputs(&self, job: &Job<'_>) -> Result<Inputs> {
        let file = &self.study.file;
        let inputs = match job {
            Job::Budget(purpose, of) => {
                let budget = self.study.method(of.id.method).budget.context("it has one")?;
                let other = ConfigurationId { object: of.id.object.clone(), method: budget.of };
                let other = self.study.configurations.iter().find(|c| c.id == other);
                let other = other.context("methods are crossed with objects")?;
                self.extraction_inputs(of, *purpose)?
                    .value("budget", &budget)
                    .text("of", &self.extraction_inputs(other, *purpose)?.finish())
                    .value("spacing", &Wanted::For(*purpose).spacing(self.study.object(of)))
            }
            Job::Mesh(purpose, of) => self
                .extraction_inputs(of, *purpose)?
                .value("spacing", &Wanted::For(*purpose).spacing(self.study.object(of))),
            Job::Films => {
                let inputs =
                    Inputs::of_sources(source_digests::PICTURES).value("duration", &file.stimuli.duration_s);
                let digests = shown_files::digests(self.study)?;
                digests.iter().fold(inputs, |inputs, (file, digest)| inputs.text(file, digest))
            }
            Job::Turntable(of) => Inputs::of_sources(source_digests::PICTURES)
                .value("outputs", &self.outputs(job))
                .value("settings", &MadeWith::of(self.study, of))
                .value("looks", &self.study.looks()),
            Job::Pair(of) => Inputs::of_sources(source_digests::PICTURES)
                .text("code", &of.code)
                .value("scale", &file.stimuli.pair_scale),
            Job::Still(of) => {
                let configuration = self.study.configurations.iter().find(|c| c.id == of.configuration);
                let configuration = configuration.context("checked when the study was read")?;
                self.extraction_inputs(configuration, Purpose::Stimulus)?
                    .text("sources", &source_digests::PICTURES.concat())
                    .value("still", of)
                    .value("camera", &self.study.object(configuration).camera)
                    .value("turntable", &file.turntable)
                    .value("shading", &file.shading)
            }
            Job::ViewerMesh(of, factor) => self
                .extraction_inputs(of, Purpose::Stimulus)?
                .value("spacing", &Wanted::For(Purpose::Stimulus).spacing(self.study.object(of)))
                .value("factor", factor)
                .value("crease", &file.shading.crease_deg),
            Job::Timings | Job::OnMachine(_) => {
                let mut inputs =
                    Inputs::of_sources(source_digests::TIMINGS).value("benchmark", &file.benchmark);
                for of in &self.study.configurations {
                    inputs = inputs.text("of", &self.extraction_inputs(of, Purpose::Benchmark)?.finish());
                }
                inputs.value("target", &self.study.target)
            }
            Job::Chunks(object) | Job::Stored(object) => {
                let section = &file.benchmark;
                let mut inputs = Inputs::of_sources(source_digests::TIMINGS)
                    .value("spacing", &file.objects[*object].benchmark_spacing)
                    .value("plan", &(section.chunks, section.short_iterations));
                for of in self.study.configurations.iter().filter(|of| of.object == *object) {
                    inputs = inputs.text("of", &self.extraction_inputs(of, Purpose::Benchmark)?.finish());
                }
                inputs
            }
            Job::Cases(of, block) => self.case_inputs(block, *of)?,
            Job::Report => study_inputs(self.study)?,
        };
        Ok(inputs.text("id", &job.id(self.study)))
    }
}

/// The places of the jobs that one needs, which are before it.
fn needed(place: usize, jobs: &[Job<'_>], may_fail: &[&Configuration]) -> Vec<usize> {
    (0..place).filter(|&other| jobs[place].needs(&jobs[other], may_fail)).collect()
}

/// Where a job is among all.
fn place(study: &Study, jobs: &[Job<'_>], id: &str) -> Result<usize> {
    if let Some(found) = jobs.iter().position(|job| job.id(study) == id) {
        return Ok(found);
    }
    if let Some(viewer) = study.file.viewer.as_ref().filter(|_| id.starts_with("viewer/"))
        && !has_library(study, viewer)?
    {
        let folder = study.resolve(&viewer.three);
        bail!(
            "{id}: viewer.three names {}, which this machine does not have; `make three` fetches it",
            folder.display()
        );
    }
    let ids: Vec<String> = jobs.iter().map(|job| job.id(study)).collect();
    None.with_context(|| {
        let meant = did_you_mean(id, ids.iter().map(String::as_str));
        format!("{id}: is no job of {}{meant}; `isostudy plan` lists them", study.path.display())
    })
}

/// Jobs of one kind.
#[derive(Debug, Default)]
pub(crate) struct OfKind {
    pub(crate) jobs: u64,
    /// What those are expected to take of which it is known.
    pub(crate) seconds: f64,
    /// How many it is not known of.
    pub(crate) unknown: u64,
}

/// The jobs of each kind together.
pub(crate) fn by_kind(planned: &[Planned]) -> BTreeMap<&'static str, OfKind> {
    let mut kinds: BTreeMap<&'static str, OfKind> = BTreeMap::new();
    for job in planned {
        let of = kinds.entry(job.kind).or_default();
        of.jobs += 1;
        of.seconds += job.expected_s.unwrap_or(0.0);
        of.unknown += u64::from(job.expected_s.is_none());
    }
    kinds
}
