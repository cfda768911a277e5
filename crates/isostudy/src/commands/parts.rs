//! Simulations in parts: `--part 3/100` writes what one part counted, and `--merge` reads the files of all parts.
//!
//! A file says which simulation it is of, and is refused by any other. `docs/self-test.md` lists its keys.

use crate::source_digests::SIMULATIONS;
use crate::store::{Inputs, sha256, write_whole};
use crate::terminal::grouped;
use crate::{input, store};
use anyhow::{Context, Result, bail, ensure};
use isostudy_design::Study;
use isostudy_inference::series::{Part, Series, Unfit, whole};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// The version of the file.
const SCHEMA: u32 = 1;
/// How many missing parts are named.
const NAMED: usize = 10;
/// How many studies may be simulated for each line or share.
pub(super) const STUDIES: RangeInclusive<u64> = 100..=10_000_000;

/// A part as it is typed, such as `3/100`.
pub(super) fn part(text: &str) -> Result<Part, String> {
    let numbers = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
    numbers.and_then(|(number, of)| Part::new(number, of)).ok_or_else(|| {
        format!("allowed: K/N, such as 3/100 for the third of 100 parts; N is at most {}", Part::MOST)
    })
}

/// What is simulated.
pub(super) struct Simulation<'a> {
    /// The command without its arguments.
    pub(super) command: &'static str,
    /// The study whose forms are answered, if it is of one.
    pub(super) study: Option<&'a Study>,
}

#[derive(Deserialize)]
struct Versioned {
    schema: u32,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    schema: u32,
    /// Of the contents, as they are written.
    sha256: String,
    contents: Contents,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Contents {
    command: String,
    version: String,
    /// Digest of the sources that simulate. Two states of the program may have one version.
    sources: String,
    study_sha256: Option<String>,
    arguments: Map<String, Value>,
    part: u64,
    parts: u64,
    series: Vec<Counted>,
}

/// A [`Series`].
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Counted {
    name: String,
    studies: u64,
    first: u64,
    end: u64,
    counts: Vec<u64>,
}

impl From<&Series> for Counted {
    fn from(of: &Series) -> Self {
        let (first, end) = (of.studies.start, of.studies.end);
        Self { name: of.name.clone(), studies: of.all, first, end, counts: of.counts.clone() }
    }
}

impl From<Counted> for Series {
    fn from(Counted { name, studies, first, end, counts }: Counted) -> Self {
        Self { name, all: studies, studies: first..end, counts }
    }
}

/// The program, as two files must have it to be of one simulation.
fn sources() -> String {
    Inputs::of_sources(SIMULATIONS).finish()
}

impl Simulation<'_> {
    fn study_sha256(&self) -> Option<&str> {
        self.study.map(|study| study.sha256.as_str())
    }

    /// Writes what a part counted, and returns a line that says so. `arguments` is all that the simulated studies depend on, as a map.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn write(
        &self,
        path: &Path,
        arguments: &impl Serialize,
        part: Part,
        series: &[Series],
    ) -> Result<String> {
        write_whole(path, &self.file(arguments, part, series)?)?;
        let studies = grouped(series.iter().map(|of| of.studies.end - of.studies.start).sum());
        Ok(format!("{}: {}, {studies} simulated studies", path.display(), named(part)))
    }

    /// The file of a part.
    pub(super) fn file(&self, arguments: &impl Serialize, part: Part, series: &[Series]) -> Result<Vec<u8>> {
        let contents = Contents {
            command: self.command.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            sources: sources(),
            study_sha256: self.study_sha256().map(Into::into),
            arguments: serde_json::from_value(serde_json::to_value(arguments)?)?,
            part: part.number(),
            parts: part.of(),
            series: series.iter().map(Counted::from).collect(),
        };
        let sha256 = sha256(&serde_json::to_vec(&contents)?);
        let mut json = serde_json::to_vec(&File { schema: SCHEMA, sha256, contents })?;
        json.push(b'\n');
        Ok(json)
    }

    /// Reads parts of this simulation, in any order.
    ///
    /// # Errors
    /// If a file cannot be read, is damaged, or is of another simulation, program, study or arguments; the file is named.
    pub(super) fn read(&self, paths: &[PathBuf]) -> Result<Parts> {
        let mut arguments = Map::new();
        let mut parts = Vec::new();
        for path in paths {
            let contents = contents(path)?;
            self.check(path, &contents)?;
            if parts.is_empty() {
                arguments = contents.arguments;
            } else if let Some((key, here, there)) = difference(&contents.arguments, &arguments) {
                bail!(
                    "{}: {key} is {here}, and {there} in {}. All parts must have the same arguments",
                    path.display(),
                    paths[0].display()
                );
            }
            let part = Part::new(contents.part, contents.parts).with_context(|| {
                format!("{}: there is no part {} of {}", path.display(), contents.part, contents.parts)
            })?;
            parts.push((part, contents.series.into_iter().map(Series::from).collect()));
        }
        Ok(Parts { paths: paths.to_vec(), arguments, parts })
    }

    /// Whether a file is of this simulation by this program.
    fn check(&self, path: &Path, contents: &Contents) -> Result<()> {
        let path = path.display();
        ensure!(
            contents.command == self.command,
            "{path}: is a part of `isostudy {}`, and not of `isostudy {}`",
            contents.command,
            self.command
        );
        let version = env!("CARGO_PKG_VERSION");
        ensure!(
            contents.version == version,
            "{path}: isostudy {} wrote it, and this is {version}. Merge with the program that wrote it",
            contents.version
        );
        ensure!(
            contents.sources == sources(),
            "{path}: isostudy {version} wrote it, built from other sources. Merge with the program that wrote it"
        );
        if let Some(study) = self.study {
            ensure!(
                contents.study_sha256.as_ref() == Some(&study.sha256),
                "{path}: is not of {} as that file is now. All parts must have the same study file",
                study.path.display()
            );
        }
        Ok(())
    }
}

/// What a file holds, if it is whole.
fn contents(path: &Path) -> Result<Contents> {
    let text = input::text(path)?;
    let path = path.display();
    let damaged = || format!("{path}: is damaged, or is no part of a simulation");
    let Versioned { schema } = serde_json::from_str(&text).with_context(damaged)?;
    ensure!(
        schema == SCHEMA,
        "{path}: schema = {schema}: this version reads {SCHEMA}. Merge with the program that wrote it"
    );
    let file: File = serde_json::from_str(&text).with_context(damaged)?;
    ensure!(
        store::sha256(&serde_json::to_vec(&file.contents)?) == file.sha256,
        "{path}: is damaged: its contents do not have the SHA-256 that it says. Simulate this part again"
    );
    Ok(file.contents)
}

/// The first argument in which two parts differ, and its values.
fn difference<'a>(
    here: &'a Map<String, Value>,
    there: &'a Map<String, Value>,
) -> Option<(&'a str, String, String)> {
    let shown = |value: Option<&Value>| value.map_or_else(|| "not there".to_owned(), ToString::to_string);
    let key = here.keys().chain(there.keys()).find(|&key| here.get(key) != there.get(key))?;
    Some((key, shown(here.get(key)), shown(there.get(key))))
}

fn named(part: Part) -> String {
    format!("part {} of {}", part.number(), part.of())
}

/// Parts of one simulation.
#[derive(Debug)]
pub(super) struct Parts {
    paths: Vec<PathBuf>,
    arguments: Map<String, Value>,
    parts: Vec<(Part, Vec<Series>)>,
}

impl Parts {
    /// What all were simulated with, if `check` finds nothing wrong.
    ///
    /// # Errors
    /// If arguments are missing or wrong; the first file is named.
    pub(super) fn arguments<T: DeserializeOwned>(&self, check: impl Fn(&T) -> Result<()>) -> Result<T> {
        let of_file = || format!("{}: arguments", self.paths[0].display());
        let read = serde_json::from_value(Value::Object(self.arguments.clone())).with_context(of_file)?;
        check(&read).with_context(of_file)?;
        Ok(read)
    }

    /// What one run counts that simulates everything.
    ///
    /// # Errors
    /// If a part is missing, is there twice, or holds something else; the files are named.
    pub(super) fn whole(&self, blank: Vec<Series>) -> Result<Vec<Series>> {
        let path = |place: usize| self.paths[place].display();
        let part = |place: usize| named(self.parts[place].0);
        match whole(blank, &self.parts) {
            Ok(series) => Ok(series),
            Err(Unfit::Cuts([a, b])) => {
                bail!("{}: is {}, and {} is {}", path(b), part(b), path(a), part(a))
            }
            Err(Unfit::Twice([a, b])) if self.paths[a] == self.paths[b] => {
                bail!("{}: {} is given twice", path(b), part(b))
            }
            Err(Unfit::Twice([a, b])) => bail!("{}: is {}, and so is {}", path(b), part(b), path(a)),
            Err(Unfit::Contents(a)) => bail!("{}: does not hold what {} counts", path(a), part(a)),
            Err(Unfit::Missing(numbers)) => {
                let named: Vec<String> = numbers.iter().take(NAMED).map(ToString::to_string).collect();
                let more = match numbers.len() - named.len() {
                    0 => String::new(),
                    more => format!(", and {more} more"),
                };
                let of = self.parts[0].0.of();
                bail!(
                    "{}: is one of {of} parts. These parts are missing: {}{more}",
                    path(0),
                    named.join(", ")
                )
            }
            Err(other) => bail!("{}: {other:?}", path(0)),
        }
    }
}

#[cfg(test)]
mod tests;
