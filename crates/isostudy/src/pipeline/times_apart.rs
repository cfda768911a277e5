//! Times beside those of the benchmark, where the study asks for them: chunk by chunk, and from stored samples. Configuration by
//! configuration, so that a killed run goes on.

use super::Pipeline;
use crate::chunk_times::chunk_times;
use crate::prepare::{Prepared, Wanted};
use crate::store::{Inputs, Stamp};
use crate::stored_times::stored_times;
use crate::terminal::progress::Step;
use crate::{machine, source_digests};
use anyhow::{Context, Result};
use isostudy_design::Configuration;
use isostudy_design::record::Purpose;
use serde::Serialize;
use serde::de::DeserializeOwned;

impl Pipeline<'_> {
    /// Times the chunks of every configuration with its object's own cubes; nothing where the study asks for none.
    pub(super) fn chunk_times(&self) -> Result<Vec<Stamp>> {
        let section = &self.study.file.benchmark;
        if section.chunks == 0 {
            return Ok(Vec::new());
        }
        self.timed_apart("chunks", |of| chunk_times(of, section.chunks, section.short_iterations))
    }

    /// Times every configuration with its object's own cubes from stored samples; nothing where the study does not ask for it.
    pub(super) fn stored_times(&self) -> Result<Vec<Stamp>> {
        let section = &self.study.file.benchmark;
        if !section.stored {
            return Ok(Vec::new());
        }
        self.timed_apart("stored", |of| stored_times(of, section.chunks, section.short_iterations))
    }

    /// A stage and a file `bench/NAME/ID.json` for each configuration with its object's own cubes.
    fn timed_apart<T: Serialize>(
        &self,
        name: &'static str,
        time: impl Fn(&Prepared<'_>) -> Result<Option<T>>,
    ) -> Result<Vec<Stamp>> {
        let section = &self.study.file.benchmark;
        // Another look is the same work once more.
        let is_timed = |c: &&Configuration| {
            self.study.method(c.id.method).budget.is_none() && !self.study.is_repeated(c.id.method)
        };
        let selected: Vec<&Configuration> = self.selected(&[]).into_iter().filter(is_timed).collect();
        let step = Step::begin(name, selected.len(), selected.len());
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
            let stamp = self.stage(&format!("{name}/{id}"), inputs, |writer| {
                let times = time(&self.prepare(configuration, Wanted::For(Purpose::Benchmark))?)?;
                writer.write_json(&format!("bench/{name}/{id}.json"), &times)
            })?;
            step.count(stamp.redone);
            step.tick(1);
            stamps.push(stamp);
        }
        step.end();
        Ok(stamps)
    }

    /// The records of stages of [`timed_apart`](Self::timed_apart); nothing of what was not timed.
    pub(super) fn times_apart<T: DeserializeOwned>(&self, stamps: &[Stamp]) -> Result<Vec<T>> {
        let read = |stamp: &Stamp| -> Result<Option<T>> {
            let file = stamp.file(".json");
            let text = std::fs::read(self.store.root().join(file)).with_context(|| file.to_owned())?;
            serde_json::from_slice(&text).with_context(|| file.to_owned())
        };
        stamps.iter().filter_map(|stamp| read(stamp).transpose()).collect()
    }
}
