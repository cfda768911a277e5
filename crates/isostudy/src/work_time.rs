//! How long a study's meshes take, estimated before the first is made.

use crate::fields::Fields;
use crate::prepare::{Wanted, grid};
use crate::recipe::{Recipe, recipe};
use anyhow::{Result, bail};
use isostudy_design::config::LimitsSection;
use isostudy_design::record::Purpose;
use isostudy_design::{Configuration, Study};
use isostudy_extract::{Execution, Extractor, Method};
use isostudy_field::StudyField;
use std::time::Instant;

/// Cells a second, and far less than any method needs: what ends in time at this pace is not tried.
const SLOWEST: f64 = 1e6;
/// Cells along the longest side of an object's box, in the two trials of each configuration.
const TRIALS: [u32; 2] = [16, 32];
/// How often each mesh is made.
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
    /// How often the mesh is extracted.
    times: f64,
}

/// Refuses a study of more than `limits.hours`. One that is far below by any measure is not tried; of the others each configuration is
/// extracted and measured on 16 and on 32 cells, three times on one thread, and the least time grows from there as it did between them.
///
/// Distances are measured once. Programs, animations and pages are not in it, nor is `isostudy bench`.
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
    let fields = Fields::new(study);
    let mut known: Vec<(&Work, Tried)> = Vec::new();
    let mut total_s = 0.0;
    for work in &works {
        // Both purposes have one method, unless positions are accumulated.
        let of_the_same = known.iter().find(|(other, _)| {
            other.configuration.id == work.configuration.id && other.method == work.method
        });
        let tried = match of_the_same {
            Some((_, tried)) => *tried,
            None => tried(study, &fields, work)?,
        };
        known.push((work, tried));
        total_s += work.seconds(tried);
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
            let Recipe::Extractor(method) = recipe(study, configuration.id.method, purpose)? else {
                continue;
            };
            let spacing = Wanted::For(purpose).spacing(object);
            let sides = [0, 1, 2].map(|axis| ((object.max[axis] - object.min[axis]) / spacing).max(1.0));
            let cells = [sides.into_iter().fold(1.0, f64::max), sides.into_iter().product()];
            works.push(Work { configuration, method, purpose, cells, times });
        }
    }
    Ok(works)
}

/// Seconds to extract and to measure a mesh, in each of the trials.
type Tried = [[f64; 2]; 2];

/// Tries a configuration. One that cannot be tried takes no time: others say what is wrong with it.
fn tried(study: &Study, fields: &Fields<'_>, work: &Work) -> Result<Tried> {
    let object = study.object(work.configuration);
    let made = fields.get(work.configuration.object)?;
    let field: &dyn StudyField = &*made.field;
    let execution = Execution { threads: 1 };
    let mut tried = [[f64::INFINITY, 0.0]; 2];
    for (cells, seconds) in TRIALS.into_iter().zip(&mut tried) {
        let grid = grid(object, Wanted::Cells(cells, work.purpose).spacing(object));
        // The least of them is the least disturbed by whatever else runs.
        for repeat in 0..REPEATS {
            let began = Instant::now();
            let extraction =
                work.method.extract(&mut Extractor::new(), field.into(), &grid, made.isovalue, &execution);
            let Ok(extraction) = extraction else { return Ok(Tried::default()) };
            seconds[0] = began.elapsed().as_secs_f64().min(seconds[0]);
            if repeat == 0 {
                let began = Instant::now();
                let of =
                    isostudy_extract::accuracy(&extraction.mesh, field, made.isovalue, &grid, &execution);
                seconds[1] = if of.is_ok() { began.elapsed().as_secs_f64() } else { 0.0 };
            }
        }
    }
    Ok(tried)
}

impl Work<'_> {
    /// Cells of all its extractions.
    fn all_cells(&self) -> f64 {
        self.times * self.cells[1]
    }

    /// `ss_bi with objects[0].benchmark_spacing = 0.002`.
    fn place(&self, study: &Study) -> String {
        let Self { configuration, purpose, .. } = self;
        let key = match purpose {
            Purpose::Stimulus => "stimulus_spacing",
            Purpose::Benchmark | Purpose::Indexed => "benchmark_spacing",
        };
        let spacing = Wanted::For(*purpose).spacing(study.object(configuration));
        format!("{} with objects[{}].{key} = {spacing:?}", configuration.id, configuration.object)
    }

    /// Seconds for all of it, by trials.
    fn seconds(&self, [coarse, fine]: Tried) -> f64 {
        let ratio = f64::from(TRIALS[1]) / f64::from(TRIALS[0]);
        let [extracting, measuring] = [0, 1].map(|k| {
            let power = (fine[k] / coarse[k]).log2() / ratio.log2();
            let power = if power.is_nan() { POWERS[0] } else { power.clamp(POWERS[0], POWERS[1]) };
            fine[k] * (self.cells[0] / f64::from(TRIALS[1])).powf(power)
        });
        self.times * extracting + measuring
    }
}
