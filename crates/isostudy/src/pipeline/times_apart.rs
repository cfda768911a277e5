//! Times beside those of the benchmark, where the study asks for them: chunk by chunk, and from stored samples. Object by object, so
//! that a killed run goes on; the methods of an object take turns, so that a slow minute of the machine is nobody's.

use super::Pipeline;
use crate::chunk_times::chunk_times;
use crate::prepare::{Prepared, Wanted};
use crate::source_digests;
use crate::store::{FileStamp, Inputs, Stamp};
use crate::stored_times::stored_times;
use crate::terminal::progress::Step;
use anyhow::{Context, Result};
use isostudy_design::record::Purpose;
use isostudy_design::{Configuration, ConfigurationId};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The bar moves within an object.
const TICKS_AN_OBJECT: usize = 1000;

impl Pipeline<'_> {
    /// Times the chunks of every configuration with its object's own cubes, or of those of the object with one place; nothing where the
    /// study asks for none.
    pub(super) fn chunk_times(&self, object: Option<usize>) -> Result<Vec<Stamp>> {
        let section = &self.study.file.benchmark;
        if section.chunks == 0 {
            return Ok(Vec::new());
        }
        let time = |all: &[Prepared<'_>], progress: &dyn Fn(usize, usize)| {
            chunk_times(all, section.chunks, section.short_iterations, progress)
        };
        self.timed_apart("chunks", object, time, |of| &of.id)
    }

    /// Times every configuration with its object's own cubes from stored samples, or those of the object with one place; nothing where
    /// the study does not ask for it.
    pub(super) fn stored_times(&self, object: Option<usize>) -> Result<Vec<Stamp>> {
        let section = &self.study.file.benchmark;
        if !section.stored {
            return Ok(Vec::new());
        }
        let time = |all: &[Prepared<'_>], progress: &dyn Fn(usize, usize)| {
            stored_times(all, section.chunks, section.short_iterations, progress)
        };
        self.timed_apart("stored", object, time, |of| &of.id)
    }

    /// A stage for each object, with a file `bench/NAME/ID.json` for each of its configurations with its own cubes that has times.
    fn timed_apart<T: Serialize>(
        &self,
        name: &'static str,
        object: Option<usize>,
        time: impl Fn(&[Prepared<'_>], &dyn Fn(usize, usize)) -> Result<Vec<T>>,
        id: impl Fn(&T) -> &ConfigurationId,
    ) -> Result<Vec<Stamp>> {
        let section = &self.study.file.benchmark;
        // Another look is the same work once more.
        let is_timed = |c: &&Configuration| {
            object.is_none_or(|object| object == c.object)
                && self.study.method(c.id.method).budget.is_none()
                && !self.study.is_repeated(c.id.method)
        };
        let selected: Vec<&Configuration> = self.selected(&[]).into_iter().filter(is_timed).collect();
        let objects: Vec<&[&Configuration]> = selected.chunk_by(|a, b| a.object == b.object).collect();
        let step = Step::begin(name, objects.len(), objects.len() * TICKS_AN_OBJECT);
        let mut stamps = Vec::new();
        for (place, configurations) in objects.into_iter().enumerate() {
            let object = self.study.object(configurations[0]);
            let mut inputs = Inputs::of_sources(source_digests::TIMINGS)
                .value("machine", &self.machine(&format!("{name}/{}", object.id))?.lasting())
                .value("spacing", &object.benchmark_spacing)
                .value("plan", &(section.chunks, section.short_iterations));
            for configuration in configurations {
                let of = self.extraction_inputs(configuration, Purpose::Benchmark)?;
                inputs = inputs.text("configuration", &of.finish());
            }
            let stamp = self.stage(&format!("{name}/{}", object.id), inputs, |writer| {
                let prepare = |of: &&Configuration| self.prepare(of, Wanted::For(Purpose::Benchmark));
                let all = configurations.iter().map(prepare).collect::<Result<Vec<_>>>()?;
                let times = time(&all, &step.within(TICKS_AN_OBJECT))?;
                times
                    .iter()
                    .try_for_each(|of| writer.write_json(&format!("bench/{name}/{}.json", id(of)), of))
            })?;
            step.count(stamp.redone);
            step.reach((place + 1) * TICKS_AN_OBJECT);
            stamps.push(stamp);
        }
        step.end();
        Ok(stamps)
    }

    /// The records of stages of [`timed_apart`](Self::timed_apart).
    pub(super) fn times_apart<T: DeserializeOwned>(&self, stamps: &[Stamp]) -> Result<Vec<T>> {
        let read = |file: &FileStamp| {
            let text = self.store.read_file(file)?;
            serde_json::from_slice(&text).with_context(|| file.path.clone())
        };
        stamps.iter().flat_map(|stamp| &stamp.files).map(read).collect()
    }
}
