//! Simulations of a study as jobs beside its others: parts of `isostudy design power`, and what follows from all of them.

use super::design::power;
use crate::pipeline::Planned;
use crate::source_digests::{SIMULATIONS, TABLES};
use crate::store::{Inputs, Stamp, Store};
use anyhow::{Context, Result, bail};
use isostudy_design::Study;
use isostudy_inference::power::Assumptions;
use isostudy_inference::series::Part;

/// What the ids of these jobs begin with.
const POWER: &str = "power/";
/// Bytes that a process of a simulation is given: it took 18 MB of 1,000 people and 27 questions.
const BYTES: u64 = 256 << 20;

/// The simulation of a study's power, with the assumptions that hold where nothing but the study is given.
pub(super) struct PowerJobs<'s> {
    study: &'s Study,
    assumptions: Assumptions,
}

/// One part, or what follows from so many parts.
#[derive(Debug, Clone, Copy)]
pub(super) enum PowerJob {
    Part(Part),
    All(u64),
}

impl PowerJob {
    /// The job with an id, such as `power/3-of-20` or `power/all-of-20`; `None` of a job that is no simulation.
    ///
    /// # Errors
    /// If there is no such part.
    pub(super) fn of(id: &str) -> Result<Option<Self>> {
        let Some(rest) = id.strip_prefix(POWER) else { return Ok(None) };
        let job = rest.split_once("-of-").and_then(|(which, of)| {
            let of: u64 = of.parse().ok()?;
            match which {
                "all" => Part::new(1, of).map(|_| Self::All(of)),
                number => Part::new(number.parse().ok()?, of).map(Self::Part),
            }
        });
        job.map(Some).with_context(|| {
            format!("{id}: is no part of a simulation; allowed: such as power/3-of-20, and power/all-of-20")
        })
    }

    fn id(self) -> String {
        match self {
            Self::Part(part) => format!("{POWER}{}-of-{}", part.number(), part.of()),
            Self::All(of) => format!("{POWER}all-of-{of}"),
        }
    }
}

fn parts(of: u64) -> impl Iterator<Item = Part> {
    (1..=of).filter_map(move |number| Part::new(number, of))
}

/// The file of a part.
fn file(part: Part) -> String {
    format!("{POWER}parts/{}-of-{}.json", part.number(), part.of())
}

impl<'s> PowerJobs<'s> {
    /// Of a study. Where it has answers, the spread between people is estimated from them, which is said.
    ///
    /// # Errors
    /// If the study asks nothing, or its answers cannot be read.
    pub(super) fn of(study: &'s Study) -> Result<Self> {
        Ok(Self { study, assumptions: power::default_assumptions(study)? })
    }

    fn inputs(&self, job: PowerJob) -> Inputs {
        let sources = match job {
            PowerJob::Part(_) => SIMULATIONS,
            PowerJob::All(_) => TABLES,
        };
        Inputs::of_sources(sources)
            .text("simulated by", &SIMULATIONS.concat())
            .text("study", &self.study.sha256)
            .value("assumed", &power::assumed(&self.assumptions))
            .text("job", &job.id())
    }

    /// All jobs of a simulation in so many parts, as a scheduler needs to know them. How long they take is not known before.
    pub(super) fn planned(&self, of: u64) -> Vec<Planned> {
        let planned = |job: PowerJob| {
            let (needs, outputs) = match job {
                PowerJob::Part(part) => (Vec::new(), vec![file(part)]),
                PowerJob::All(of) => (
                    parts(of).map(|part| PowerJob::Part(part).id()).collect(),
                    vec![format!("{POWER}power.svg"), format!("{POWER}power.png")],
                ),
            };
            Planned {
                id: job.id(),
                kind: "simulation",
                needs,
                inputs: vec![self.study.path.display().to_string()],
                outputs,
                digest: self.inputs(job).finish(),
                exclusive: false,
                machine: None,
                expected_s: None,
                expected_bytes: Some(BYTES),
            }
        };
        parts(of).map(PowerJob::Part).chain([PowerJob::All(of)]).map(planned).collect()
    }

    /// Does a job, unless it is done.
    ///
    /// # Errors
    /// If the digest is another than was planned; if a part that is needed was not simulated; as the simulation.
    pub(super) fn carry_out(&self, job: PowerJob, store: &Store, digest: Option<&String>) -> Result<Stamp> {
        let (id, inputs) = (job.id(), self.inputs(job));
        let now = inputs.clone().finish();
        if let Some(planned) = digest
            && *planned != now
        {
            bail!(
                "{id}: {} or its answers have changed since the plan was made: the job's digest is {now}, and no longer {planned}. \
                 Make the plan again",
                self.study.path.display()
            );
        }
        match job {
            PowerJob::Part(part) => store.stage(&id, inputs, |writer| {
                writer.write(&file(part), &power::part_file(self.study, &self.assumptions, part)?)
            }),
            PowerJob::All(of) => {
                let mut paths = Vec::new();
                for part in parts(of) {
                    let needed = PowerJob::Part(part);
                    if store.peek(&needed.id(), self.inputs(needed)).is_none() {
                        bail!("{} is not up to date, and job {id} needs it: it comes first", needed.id());
                    }
                    paths.push(store.root().join(file(part)));
                }
                store.stage(&id, inputs, |writer| {
                    for (name, bytes) in power::files_of_parts(self.study, &paths)? {
                        writer.write(&format!("{POWER}{name}"), &bytes)?;
                    }
                    Ok(())
                })
            }
        }
    }
}
