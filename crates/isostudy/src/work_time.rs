//! How long a study's meshes take and how large they are, estimated before the first is made.

use crate::fields::Fields;
use crate::prepare::{Wanted, grid};
use crate::recipe::{Recipe, recipe};
use anyhow::{Result, bail};
use isostudy_design::config::LimitsSection;
use isostudy_design::record::Purpose;
use isostudy_design::sweep::Sweep;
use isostudy_design::{Configuration, Study};
use isostudy_extract::{Execution, Extractor, Method};
use isostudy_field::StudyField;
use isostudy_mesh::TriangleMesh;
use std::collections::BTreeMap;
use std::time::Instant;

/// Cells a second, and far less than any method needs: what ends in time at this pace is not tried.
const SLOWEST: f64 = 1e6;
/// Cells along the longest side of an object's box, in the two trials of each configuration.
const TRIALS: [u32; 2] = [16, 32];
/// How often each mesh is made where an answer hangs on it.
const REPEATS: usize = 3;
/// How times grow with the cells along a side: with their square, as the surface, up to their cube, as the volume.
const POWERS: [f64; 2] = [2.0, 3.0];

/// What is made of a configuration at one spacing.
struct Work<'a> {
    configuration: &'a Configuration,
    method: Method,
    purpose: Purpose,
    /// Cells along the longest side, and in all.
    cells: [f64; 2],
    /// How often the mesh is extracted, and how often one is measured.
    times: f64,
    measured: f64,
    /// Of a sweep's cases.
    is_swept: bool,
}

/// Refuses a study of more than `limits.hours`. One that is far below by any measure is not tried; of the others each configuration is
/// extracted on 16 and on 32 cells, three times on one thread, and the least time grows from there as it did between them. On each object
/// one mesh is measured, which stands for the others.
///
/// Programs, animations and pages are not in it, nor is `isostudy bench`.
///
/// # Errors
/// If it takes longer, with the number and what takes most; if a field cannot be made.
pub(crate) fn check(study: &Study) -> Result<()> {
    let mut works = works(study)?;
    let hours = study.file.limits.hours.unwrap_or(LimitsSection::HOURS);
    let limit_s = 3600.0 * hours;
    if works.iter().map(Work::all_cells).sum::<f64>() / SLOWEST <= limit_s {
        return Ok(());
    }
    // What is most likely too much comes first, and what comes after too much is not tried.
    works.sort_by(|a, b| b.all_cells().total_cmp(&a.all_cells()));
    let mut trials = Trials { repeats: REPEATS, ..Trials::new(study) };
    let mut total_s = 0.0;
    for work in &works {
        let cost = trials.of(work)?;
        total_s += work.times * cost.extracting_s + work.measured * cost.measuring_s;
        if total_s > limit_s {
            let first = works[0].place(study);
            bail!(
                "{}: making, measuring and timing the meshes takes {:.1} hours or more by trials on {} and {} cells; limits.hours allows \
                 {hours}. {first} has the most cells. A larger spacing or fewer benchmark.short_iterations take less",
                study.path.display(),
                total_s / 3600.0,
                TRIALS[0],
                TRIALS[1],
            );
        }
    }
    Ok(())
}

/// Everything that an extractor of ours makes for `isostudy study`.
fn works(study: &Study) -> Result<Vec<Work<'_>>> {
    let section = &study.file.benchmark;
    let timed =
        f64::from(section.warmup) + f64::from(section.short_iterations) + f64::from(u8::from(section.memory));
    let mut works = Vec::new();
    for configuration in &study.configurations {
        let object = study.object(configuration);
        for (purpose, times) in [(Purpose::Benchmark, 1.0 + timed), (Purpose::Stimulus, 1.0)] {
            let spacing = Wanted::For(purpose).spacing(object);
            works.extend(Work::of(study, configuration, purpose, spacing, times)?);
        }
    }
    if let Some(sweep) = study.sweep() {
        works.extend(cases(study, &sweep)?);
    }
    Ok(works)
}

/// The cases of a sweep, as if their settings were the study's own: at each resolution all of them as one work.
fn cases<'a>(study: &'a Study, sweep: &Sweep<'a>) -> Result<Vec<Work<'a>>> {
    let section = sweep.section;
    let timed = match section.times {
        0 => 0.0,
        // Peak memory takes one more.
        times => f64::from(times + study.file.benchmark.warmup + 1),
    };
    let mut works = Vec::new();
    for pair in &sweep.pairs {
        let count = pair.cases as f64 / section.cells.len() as f64;
        for &cells in &section.cells {
            let spacing = Wanted::Cells(cells, Purpose::Benchmark).spacing(study.object(pair.configuration));
            let work =
                Work::of(study, pair.configuration, Purpose::Benchmark, spacing, count * (1.0 + timed))?;
            works.extend(work.map(|work| Work { measured: count, is_swept: true, ..work }));
        }
    }
    Ok(works)
}

/// What one mesh is expected to take.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cost {
    pub(crate) extracting_s: f64,
    /// Its distances to the isosurface and back.
    pub(crate) measuring_s: f64,
    /// Of the mesh itself.
    pub(crate) mesh_bytes: f64,
}

/// Trials of a study's configurations, each made once.
pub(crate) struct Trials<'a> {
    study: &'a Study,
    fields: Fields<'a>,
    repeats: usize,
    /// Whether measuring is tried too, which takes seconds for each object.
    measures: bool,
    /// By the place of an object, and a method.
    known: Vec<(usize, Method, Tried)>,
    /// Seconds to measure any mesh, and for each byte of it, for each object of which one was.
    measured: BTreeMap<usize, [f64; 2]>,
}

impl<'a> Trials<'a> {
    pub(crate) fn new(study: &'a Study) -> Self {
        let fields = Fields::new(study);
        Self { study, fields, repeats: 1, measures: true, known: Vec::new(), measured: BTreeMap::new() }
    }

    /// Those of extractions alone: [`Cost::measuring_s`] is 0.
    pub(crate) fn of_extractions(study: &'a Study) -> Self {
        Self { measures: false, ..Self::new(study) }
    }

    /// What a mesh of a configuration at a spacing takes; `None` of what is no extractor of ours.
    ///
    /// # Errors
    /// If its recipe or its field cannot be made.
    pub(crate) fn cost(
        &mut self,
        configuration: &'a Configuration,
        purpose: Purpose,
        spacing: f64,
    ) -> Result<Option<Cost>> {
        let work = Work::of(self.study, configuration, purpose, spacing, 1.0)?;
        work.map(|work| self.of(&work)).transpose()
    }

    fn of(&mut self, work: &Work<'_>) -> Result<Cost> {
        let object = work.configuration.object;
        let known = self.known.iter().find(|(other, method, _)| *other == object && *method == work.method);
        if let Some((.., tried)) = known {
            return Ok(work.cost(*tried));
        }
        let tried = self.tried(work)?;
        self.known.push((object, work.method, tried));
        Ok(work.cost(tried))
    }

    /// Tries a configuration. One that cannot be tried takes no time: others say what is wrong with it.
    fn tried(&mut self, work: &Work<'_>) -> Result<Tried> {
        let object = self.study.object(work.configuration);
        let made = self.fields.get(work.configuration.object)?;
        let field: &dyn StudyField = &*made.field;
        let execution = Execution { threads: 1 };
        let is_first = !self.measured.contains_key(&work.configuration.object);
        let mut tried = [[f64::INFINITY, 0.0, 0.0]; 2];
        for (cells, found) in TRIALS.into_iter().zip(&mut tried) {
            let grid = grid(object, Wanted::Cells(cells, work.purpose).spacing(object));
            let mut mesh = TriangleMesh::default();
            // The least of them is the least disturbed by whatever else runs.
            for _ in 0..self.repeats {
                let began = Instant::now();
                let extraction = work.method.extract(
                    &mut Extractor::new(),
                    field.into(),
                    &grid,
                    made.isovalue,
                    &execution,
                );
                let Ok(extraction) = extraction else { return Ok(Tried::default()) };
                found[0] = began.elapsed().as_secs_f64().min(found[0]);
                mesh = extraction.mesh;
            }
            found[2] = (24 * mesh.positions.len() + 12 * mesh.triangles.len()) as f64;
            // Most of what measuring costs is the field's, so one mesh stands for those of all methods.
            if is_first && self.measures {
                let began = Instant::now();
                let of = isostudy_extract::accuracy(&mesh, field, made.isovalue, &grid, &execution);
                found[1] = if of.is_ok() { began.elapsed().as_secs_f64() } else { 0.0 };
            }
        }
        let [coarse, fine] = tried;
        let growth = (fine[1] - coarse[1]) / (fine[2] - coarse[2]);
        let line =
            [coarse[1] - growth * coarse[2], growth].map(|of| if of.is_finite() { of.max(0.0) } else { 0.0 });
        let [at_all, of_byte] = *self.measured.entry(work.configuration.object).or_insert(line);
        for found in &mut tried {
            found[1] = at_all + of_byte * found[2];
        }
        Ok(tried)
    }
}

/// Seconds to extract and to measure a mesh, and its bytes, in each of the trials.
type Tried = [[f64; 3]; 2];

impl<'a> Work<'a> {
    /// `None` of what is no extractor of ours.
    fn of(
        study: &Study,
        configuration: &'a Configuration,
        purpose: Purpose,
        spacing: f64,
        times: f64,
    ) -> Result<Option<Self>> {
        let Recipe::Extractor(method) = recipe(study, configuration.id.method, purpose)? else {
            return Ok(None);
        };
        let object = study.object(configuration);
        let sides = [0, 1, 2].map(|axis| ((object.max[axis] - object.min[axis]) / spacing).max(1.0));
        let cells = [sides.into_iter().fold(1.0, f64::max), sides.into_iter().product()];
        Ok(Some(Self { configuration, method, purpose, cells, times, measured: 1.0, is_swept: false }))
    }

    /// Cells of all its extractions.
    fn all_cells(&self) -> f64 {
        self.times * self.cells[1]
    }

    /// `ss_bi with objects[0].benchmark_spacing = 0.002`.
    fn place(&self, study: &Study) -> String {
        let Self { configuration, purpose, .. } = self;
        if self.is_swept {
            let count = self.measured;
            return format!(
                "{} with {:.0} in sweep.cells, in {count:.0} cases,",
                configuration.id, self.cells[0]
            );
        }
        let key = match purpose {
            Purpose::Stimulus => "stimulus_spacing",
            Purpose::Benchmark | Purpose::Indexed => "benchmark_spacing",
        };
        let spacing = Wanted::For(*purpose).spacing(study.object(configuration));
        format!("{} with objects[{}].{key} = {spacing:?}", configuration.id, configuration.object)
    }

    /// By trials.
    fn cost(&self, [coarse, fine]: Tried) -> Cost {
        let ratio = f64::from(TRIALS[1]) / f64::from(TRIALS[0]);
        let [extracting_s, measuring_s, mesh_bytes] = [0, 1, 2].map(|k| {
            let power = (fine[k] / coarse[k]).log2() / ratio.log2();
            let power = if power.is_nan() { POWERS[0] } else { power.clamp(POWERS[0], POWERS[1]) };
            fine[k] * (self.cells[0] / f64::from(TRIALS[1])).powf(power)
        });
        Cost { extracting_s, measuring_s, mesh_bytes }
    }
}
