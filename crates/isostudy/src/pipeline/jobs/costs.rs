//! What a job is expected to take.

use super::Job;
use crate::fields;
use crate::memory::{Needs, OfVolume};
use crate::pipeline::Pipeline;
use crate::pipeline::cases::{Block, Of};
use crate::prepare::{self, Wanted};
use crate::recipe::{Recipe, recipe};
use crate::work_time::Trials;
use anyhow::{Context, Result};
use isostudy_design::Configuration;
use isostudy_design::record::Purpose;
use isostudy_extract::Execution;

/// What a process takes beside the grid, the volume and the mesh.
const PROCESS_BYTES: f64 = 96.0 * 1024.0 * 1024.0;
/// How often a mesh is in memory while it is measured: itself, trees over it, and the points of its surface.
const MESHES_HELD: f64 = 10.0;
/// Seconds for a pixel of an animation, drawn at the usual supersampling and compressed.
const PIXEL_S: f64 = 1.5e-7;
/// Seconds for tables and pages, for each configuration.
const PAGES_S: f64 = 0.25;
/// To read a film or a mesh that is there, and what it unfolds to.
const SHOWN_S: f64 = 1.0;
const SHOWN_BYTES: f64 = 256.0 * 1024.0 * 1024.0;
const PAGES_BYTES: f64 = 4.0 * 1024.0 * 1024.0;

impl<'a> Pipeline<'a> {
    /// Seconds and bytes that a job is expected to take.
    pub(super) fn cost(&self, job: &Job<'a>, trials: &mut Trials<'a>) -> Result<(Option<f64>, Option<u64>)> {
        let file = &self.study.file;
        let pixels = f64::from(file.turntable.width) * f64::from(file.turntable.height);
        let drawn = pixels * f64::from(file.turntable.frames) * PIXEL_S;
        let light = |seconds: f64, bytes: f64| (Some(seconds), Some((PROCESS_BYTES + bytes) as u64));
        // Frames are held as they are drawn, and once more as they are compressed.
        let frames = 3.0 * pixels * f64::from(file.turntable.frames);
        let scale = f64::from(file.stimuli.pair_scale);
        Ok(match job {
            Job::Budget(purpose, of) => {
                let spacing = Wanted::For(*purpose).spacing(self.study.object(of));
                // About as many steps as bisection takes.
                self.mesh_cost(of, *purpose, spacing, [8.0, 0.0], trials)?
            }
            Job::Films => light(SHOWN_S * self.study.configurations.len() as f64, SHOWN_BYTES),
            Job::Mesh(..) if self.study.shown_files().is_some() => light(SHOWN_S, SHOWN_BYTES),
            Job::Mesh(purpose, of) => {
                let spacing = Wanted::For(*purpose).spacing(self.study.object(of));
                self.mesh_cost(of, *purpose, spacing, [1.0, 1.0], trials)?
            }
            Job::ViewerMesh(of, factor) => {
                let spacing = factor * Wanted::For(Purpose::Stimulus).spacing(self.study.object(of));
                self.mesh_cost(of, Purpose::Stimulus, spacing, [1.0, 1.0], trials)?
            }
            Job::Still(of) => {
                let configuration = self.study.configurations.iter().find(|c| c.id == of.configuration);
                let configuration = configuration.context("checked when the study was read")?;
                self.mesh_cost(configuration, Purpose::Stimulus, of.spacing, [1.0, 1.0], trials)?
            }
            Job::Turntable(_) => light(drawn, frames),
            Job::Pair(_) => light(drawn, frames * (1.0 + 2.0 * scale * scale)),
            Job::Timings | Job::OnMachine(_) => {
                let section = &file.benchmark;
                let rounds = match job {
                    // With the A/A block, peak memory and what is allocated.
                    Job::OnMachine(_) => section.iterations + section.aa_iterations + 2,
                    _ => section.short_iterations + u32::from(section.memory),
                };
                let times = f64::from(section.warmup + rounds);
                self.times_cost(&|_| true, times, trials)?
            }
            Job::Chunks(object) | Job::Stored(object) => {
                // Chunks share less than a whole does; edits come after them.
                let times = 3.0 * f64::from(file.benchmark.short_iterations);
                self.times_cost(&|of| of.object == *object, times, trials)?
            }
            Job::Cases(of, block) => {
                let times =
                    self.sweep.as_ref().map_or(0, |sweep| sweep.section.times + file.benchmark.warmup);
                let often = match of {
                    Of::Meshes => [1.0, 1.0],
                    // Peak memory takes one more.
                    Of::Times => [f64::from(times + 1), 0.0],
                };
                self.cases_cost(block, often, trials)?
            }
            Job::Report => {
                let configurations = self.study.configurations.len() as f64;
                light(PAGES_S * configurations, PAGES_BYTES * configurations)
            }
        })
    }

    /// Of a mesh that is extracted and measured so often.
    fn mesh_cost(
        &self,
        of: &'a Configuration,
        purpose: Purpose,
        spacing: f64,
        [extracted, measured]: [f64; 2],
        trials: &mut Trials<'a>,
    ) -> Result<(Option<f64>, Option<u64>)> {
        let Some(cost) = trials.cost(of, purpose, spacing)? else { return Ok((None, None)) };
        let Recipe::Extractor(method) = recipe(self.study, of.id.method, purpose)? else {
            return Ok((None, None));
        };
        let volume: Option<OfVolume> = fields::volume(self.study, of.object)?;
        let grid = prepare::grid(self.study.object(of), spacing);
        let needs = Needs::of(volume).with(&method, &grid, &Execution { threads: 1 })?.total() as f64;
        let bytes = PROCESS_BYTES + needs + MESHES_HELD * cost.mesh_bytes;
        Ok((Some(extracted * cost.extracting_s + measured * cost.measuring_s), Some(bytes as u64)))
    }

    /// Of the cases of a block, as if their settings were the configuration's own.
    fn cases_cost(
        &self,
        block: &Block<'a>,
        often: [f64; 2],
        trials: &mut Trials<'a>,
    ) -> Result<(Option<f64>, Option<u64>)> {
        let (mut seconds, mut bytes) = (0.0, 0);
        let mut cells = self.cells_of(block)?;
        cells.sort_unstable();
        for same in cells.chunk_by(|a, b| a == b) {
            let wanted = Wanted::Cells(same[0], Purpose::Benchmark);
            let spacing = wanted.spacing(self.study.object(block.configuration));
            let of = self.mesh_cost(block.configuration, Purpose::Benchmark, spacing, often, trials)?;
            let (Some(s), Some(b)) = of else { return Ok((None, None)) };
            seconds += same.len() as f64 * s;
            bytes = bytes.max(b);
        }
        Ok((Some(seconds), Some(bytes)))
    }

    /// Of some configurations that are extracted so often; `None` where one of them cannot be tried.
    fn times_cost(
        &self,
        which: &dyn Fn(&Configuration) -> bool,
        times: f64,
        trials: &mut Trials<'a>,
    ) -> Result<(Option<f64>, Option<u64>)> {
        let (mut seconds, mut bytes) = (0.0, PROCESS_BYTES as u64);
        for of in self.study.configurations.iter().filter(|of| which(of)) {
            let spacing = Wanted::For(Purpose::Benchmark).spacing(self.study.object(of));
            let (s, b) = self.mesh_cost(of, Purpose::Benchmark, spacing, [times, 0.0], trials)?;
            let (Some(s), Some(b)) = (s, b) else { return Ok((None, None)) };
            seconds += s;
            bytes = bytes.max(b);
        }
        Ok((Some(seconds), Some(bytes)))
    }
}
