//! The sweep over resolutions and threads: each pair of them a benchmark run of its own, so that a killed sweep goes on.

use super::Pipeline;
use super::formats::{write_figure, write_table};
use super::worker::{Measurement, swept};
use crate::input;
use crate::made::Made;
use crate::prepare::{self, Wanted};
use crate::store::{Inputs, Stamp, remove_if_there};
use crate::terminal::progress::Step;
use crate::{machine, source_digests};
use anyhow::{Context, Result, bail};
use isostudy_bench::Plan;
use isostudy_design::Configuration;
use isostudy_design::config::ThreadSweepSection;
use isostudy_design::machine::Machine;
use isostudy_design::record::{Purpose, SweepMesh};
use isostudy_extract::{Execution, Extractor};
use isostudy_timing::sweep::SweepLevel;

impl Pipeline<'_> {
    /// Measures what is not up to date, writes tables and figures, and returns the tables as Markdown.
    pub(crate) fn thread_sweep(&self) -> Result<Vec<String>> {
        let file = &self.study.file;
        let Some(section) = &file.benchmark.sweep else {
            bail!("{}: there is no [benchmark.sweep]; configs/paper.toml has one", self.study.path.display());
        };
        prepare::check_thread_sweep(self.study, section, isostudy_bench::read_machine().memory_bytes)?;
        let machine = machine::read();
        let (mut levels, mut meshes, mut stamps) = (Vec::new(), Vec::new(), Vec::new());
        // Threads inside: what is compared is measured close together.
        for &cells in &section.cells {
            let stamp = self.sweep_meshes(section, cells)?;
            let bytes = input::bytes(&self.store.root().join(stamp.file(".json")))?;
            let made: Vec<SweepMesh> = serde_json::from_slice(&bytes)?;
            for configuration in self.swept(section)? {
                if !made.iter().any(|mesh| mesh.id == configuration.id) {
                    self.leave_out(&configuration.id, format!("sweep: no mesh at {cells} cells per axis"));
                }
            }
            meshes.extend(made);
            stamps.push(stamp);
            for &threads in &section.threads {
                let stamp = self.sweep_level(section, cells, threads, &machine)?;
                let run = self.bench_run(&stamp)?;
                self.leave_out_failed(&run.failed);
                levels.push(SweepLevel { cells, threads, run });
                stamps.push(stamp);
            }
        }
        let found = isostudy_timing::sweep::sweep(&file.study.id, &levels, &meshes);
        let tables = isostudy_timing::sweep::sweep_tables(&found);
        let mut inputs = Inputs::of_sources(source_digests::TABLES);
        for stamp in &stamps {
            inputs = inputs.stamp(stamp);
        }
        self.store.stage("bench/sweep", inputs, |writer| {
            writer.write_json("bench/sweep/sweep.json", &found)?;
            for table in &tables {
                write_table(writer, "bench/sweep", table)?;
            }
            for figure in isostudy_report::sweep_figures(self.study, &found)? {
                write_figure(writer, "bench/sweep", &figure)?;
            }
            Ok(())
        })?;
        Ok(tables.iter().filter(|t| t.name != "sweep").map(isostudy_table::Table::to_markdown).collect())
    }

    /// One resolution on so many threads.
    fn sweep_level(
        &self,
        section: &ThreadSweepSection,
        cells: u32,
        threads: u32,
        machine: &Machine,
    ) -> Result<Stamp> {
        let configurations = self.swept(section)?;
        let inputs = || -> Result<Inputs> {
            let inputs = Inputs::of_sources(source_digests::TIMINGS).value("machine", &machine.lasting());
            Ok(self
                .sweep_inputs(inputs, section, cells)?
                .value("plan", &self.sweep_plan(section, cells, threads)?))
        };
        let plan = self.sweep_plan(section, cells, threads)?;
        let name = format!("bench/sweep/{cells:04}-{threads}");
        let (journal, key) = (self.store.journal(&name), inputs()?.finish());
        tell!("sweep: {cells} cells per axis, threads: {threads}");
        let step = Step::begin("sweep", configurations.len() * plan.iterations as usize, 0);
        let measurement = Measurement { plan: &plan, configurations, cells: Some(cells), case: None };
        let stamp = self.stage(&name, inputs()?, |writer| {
            let run = self.run(&measurement, machine.clone(), &journal, &key, &step, &|_| false)?;
            writer.write_json(&format!("{name}/run.json"), &run)?;
            writer.write(&format!("{name}/samples.csv"), isostudy_bench::samples_csv(&run.samples).as_bytes())
        })?;
        remove_if_there(&journal)?;
        step.count_all(stamp.redone);
        step.end();
        Ok(stamp)
    }

    fn sweep_plan(&self, section: &ThreadSweepSection, cells: u32, threads: u32) -> Result<Plan> {
        let benchmark = &self.study.file.benchmark;
        Ok(Plan {
            study: self.study.file.study.id.clone(),
            workloads: self.workloads(&self.swept(section)?, Some(cells))?,
            warmup: benchmark.warmup,
            iterations: section.iterations,
            batches: 1,
            until: None,
            aa_iterations: 0,
            memory: true,
            allocations: false,
            seed: self.study.file.study.seed,
            threads,
            pin: benchmark.pin,
            target: self.study.target.clone(),
        })
    }

    /// What is asked of the extractor at a resolution.
    fn sweep_inputs(&self, inputs: Inputs, section: &ThreadSweepSection, cells: u32) -> Result<Inputs> {
        Ok(inputs.value("workloads", &self.workloads(&self.swept(section)?, Some(cells))?))
    }

    /// What is extracted at a resolution, untimed.
    fn sweep_meshes(&self, section: &ThreadSweepSection, cells: u32) -> Result<Stamp> {
        let inputs = self.sweep_inputs(Inputs::of_sources(source_digests::MESHES), section, cells)?;
        let configurations = self.swept(section)?;
        self.stage(&format!("bench/sweep/{cells:04}-meshes"), inputs, |writer| {
            let mut meshes: Vec<SweepMesh> = Vec::new();
            for configuration in &configurations {
                match self.sweep_mesh(configuration, cells) {
                    Ok(mesh) => meshes.push(mesh),
                    Err(error) => self.fail(&configuration.id, error)?,
                }
            }
            writer.write_json(&format!("bench/sweep/{cells:04}-meshes.json"), &meshes)
        })
    }

    /// The configurations of the sweep that have not failed.
    fn swept(&self, section: &ThreadSweepSection) -> Result<Vec<&Configuration>> {
        let mut swept = swept(self.study, section)?;
        swept.retain(|configuration| !self.has_failed(&configuration.id));
        Ok(swept)
    }

    fn sweep_mesh(&self, configuration: &Configuration, cells: u32) -> Result<SweepMesh> {
        let wanted = Wanted::Cells(cells, Purpose::Indexed);
        let prepared = self.prepare(configuration, wanted)?;
        let Made { mesh, counts, .. } = prepared
            .make_any(&mut Extractor::new(), &Execution { threads: self.threads })
            .with_context(|| format!("{} at {cells} cells per axis", configuration.id))?;
        let quality = isostudy_mesh::quality::quality(&mesh);
        Ok(SweepMesh {
            id: configuration.id.clone(),
            cells,
            needed_samples: counts.samples.unwrap_or_default(),
            vertices: counts.vertices,
            triangles: counts.triangles,
            radius_ratio_mean: quality.radius_ratio.mean,
            edge_ratio_mean: quality.edge_ratio.mean,
            published_aspect_ratio_mean: quality.published_aspect_ratio.mean,
        })
    }
}
