//! Times chunk by chunk, where the study asks for them: configuration by configuration, so that a killed run goes on.

use super::Pipeline;
use crate::chunk_times::chunk_times;
use crate::prepare::Wanted;
use crate::store::{Inputs, Stamp};
use crate::terminal::progress::Step;
use crate::{machine, source_digests};
use anyhow::{Context, Result};
use isostudy_design::Configuration;
use isostudy_design::record::{ChunkTimes, Purpose};

impl Pipeline<'_> {
    /// Times the chunks of every configuration with its object's own cubes; nothing where the study asks for none.
    pub(super) fn chunk_times(&self) -> Result<Vec<Stamp>> {
        let section = &self.study.file.benchmark;
        if section.chunks == 0 {
            return Ok(Vec::new());
        }
        let has_own_cubes = |c: &&Configuration| self.study.method(c.id.method).budget.is_none();
        let selected: Vec<&Configuration> = self.selected(&[]).into_iter().filter(has_own_cubes).collect();
        let step = Step::begin("chunks", selected.len(), selected.len());
        let machine = machine::read();
        let mut stamps = Vec::new();
        for configuration in selected {
            let inputs = self
                .extraction_inputs(configuration, Purpose::Benchmark)?
                .text("sources", &Inputs::of_sources(source_digests::TIMINGS).finish())
                .value("machine", &machine.lasting())
                .value("spacing", &self.study.object(configuration).benchmark_spacing)
                .value("plan", &(section.chunks, section.short_iterations));
            let id = &configuration.id;
            let stamp = self.stage(&format!("chunks/{id}"), inputs, |writer| {
                let prepared = self.prepare(configuration, Wanted::For(Purpose::Benchmark))?;
                let times = chunk_times(&prepared, section.chunks, section.short_iterations)?;
                writer.write_json(&format!("bench/chunks/{id}.json"), &times)
            })?;
            step.count(stamp.redone);
            step.tick(1);
            stamps.push(stamp);
        }
        step.end();
        Ok(stamps)
    }

    /// The records of [`chunk_times`](Self::chunk_times); nothing of what makes no chunks.
    pub(super) fn chunk_records(&self, stamps: &[Stamp]) -> Result<Vec<ChunkTimes>> {
        let read = |stamp: &Stamp| -> Result<Option<ChunkTimes>> {
            let file = stamp.file(".json");
            let text = std::fs::read(self.store.root().join(file)).with_context(|| file.to_owned())?;
            serde_json::from_slice(&text).with_context(|| file.to_owned())
        };
        stamps.iter().filter_map(|stamp| read(stamp).transpose()).collect()
    }
}
