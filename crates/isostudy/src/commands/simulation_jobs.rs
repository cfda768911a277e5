//! Simulations of a study as jobs beside its others: parts of `isostudy design power`, and what follows from all of them.

use super::design::power;
use crate::pipeline::Planned;
use crate::source_digests::SIMULATIONS;
use crate::store::{Inputs, Stamp, Store};
use anyhow::{Context, Result, bail};
use isostudy_design::Study;
use isostudy_inference::series::Part;

/// What the ids of these jobs begin with.
const POWER: &str = "power/";
/// Bytes that a process of a simulation takes.
const BYTES: u64 = 256 << 20;

/// A job of a simulation: one part of it, or what follows from so many parts.
#[derive(Debug, Clone, Copy)]
pub(super) enum SimulationJob {
    Part(Part),
    All(u64),
}

impl SimulationJob {
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

    /// All jobs of a simulation in so many parts: the parts, then what follows from them.
    pub(super) fn all(parts: u64) -> Vec<Self> {
        let part = |number| Part::new(number, parts).map(Self::Part);
        (1..=parts).filter_map(part).chain([Self::All(parts)]).collect()
    }

    fn id(self) -> String {
        match self {
            Self::Part(part) => format!("{POWER}{}-of-{}", part.number(), part.of()),
            Self::All(of) => format!("{POWER}all-of-{of}"),
        }
    }

    /// The file of a part.
    fn file(part: Part) -> String {
        format!("{POWER}parts/{}-of-{}.json", part.number(), part.of())
    }

    fn inputs(self, study: &Study) -> Result<Inputs> {
        Ok(Inputs::of_sources(SIMULATIONS)
            .text("study", &study.sha256)
            .value("assumed", &power::assumed(study)?)
            .text("job", &self.id()))
    }

    /// As a scheduler needs to know it. How long it takes is not known before.
    ///
    /// # Errors
    /// If the study asks nothing.
    pub(super) fn planned(self, study: &Study) -> Result<Planned> {
        let needs = match self {
            Self::Part(_) => Vec::new(),
            Self::All(of) => (1..=of).filter_map(|n| Some(Self::Part(Part::new(n, of)?).id())).collect(),
        };
        let outputs = match self {
            Self::Part(part) => vec![Self::file(part)],
            Self::All(_) => vec![format!("{POWER}power.svg")],
        };
        Ok(Planned {
            id: self.id(),
            kind: "simulation",
            needs,
            inputs: vec![study.path.display().to_string()],
            outputs,
            digest: self.inputs(study)?.finish(),
            exclusive: false,
            machine: None,
            expected_s: None,
            expected_bytes: Some(BYTES),
        })
    }

    /// Does the job, unless it is done.
    ///
    /// # Errors
    /// If the digest is another than was planned; if a part that is needed was not simulated; as the simulation.
    pub(super) fn carry_out(self, study: &Study, store: &Store, digest: Option<&String>) -> Result<Stamp> {
        let (id, inputs) = (self.id(), self.inputs(study)?);
        let now = inputs.clone().finish();
        if let Some(planned) = digest
            && *planned != now
        {
            bail!(
                "{id}: {} or its answers have changed since the plan was made: the job's digest is {now}, and no longer {planned}. \
                 Make the plan again",
                study.path.display()
            );
        }
        match self {
            Self::Part(part) => store.stage(&id, inputs, |writer| {
                writer.write(&Self::file(part), &power::part_file(study, part)?)
            }),
            Self::All(of) => {
                let mut paths = Vec::new();
                for part in (1..=of).filter_map(|number| Part::new(number, of)) {
                    let needed = Self::Part(part);
                    if store.peek(&needed.id(), needed.inputs(study)?).is_none() {
                        bail!("{} is not up to date, and job {id} needs it: it comes first", needed.id());
                    }
                    paths.push(store.root().join(Self::file(part)));
                }
                store.stage(&id, inputs, |writer| {
                    for (name, bytes) in power::files_of_parts(study, &paths)? {
                        writer.write(&format!("{POWER}{name}"), &bytes)?;
                    }
                    Ok(())
                })
            }
        }
    }
}
