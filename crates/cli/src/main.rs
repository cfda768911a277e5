//! The `isostudy` command: arguments, files, progress and exit codes. What is computed is computed in the rooms.

mod args;
mod comparing;
mod manifest;
mod picture;
mod pipeline;
mod progress;
mod records;
mod rooms;
mod store;
mod subject;

use analysis::Answers;
use anyhow::{Context, Result};
use args::{Analyse, Bench, BenchVerb, Cli, Command, Run, Selection};
use clap::Parser;
use design::{ConfigurationId, Published, Study};
use pipeline::{Pipeline, PlanLength};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use store::Store;

/// The work was done, but something in it is not as it should be.
const CHECK_FAILED: u8 = 1;
/// Wrong usage or input; clap uses the same.
const INPUT_ERROR: u8 = 2;

fn main() -> ExitCode {
    match run(Cli::parse().command) {
        Ok(Outcome::Sound) => ExitCode::SUCCESS,
        Ok(Outcome::CheckFailed) => ExitCode::from(CHECK_FAILED),
        Err(error) => {
            eprintln!("isostudy: {error:#}");
            ExitCode::from(INPUT_ERROR)
        }
    }
}

/// How work that could be done came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    Sound,
    CheckFailed,
}

fn run(command: Command) -> Result<Outcome> {
    match command {
        Command::Study(run) => return with_page(&run, |pipeline| pipeline.study()),
        Command::Report(run) => return with_page(&run, |pipeline| pipeline.report()),
        Command::Extract(selection) => with_selection(&selection, |pipeline, only, out| {
            pipeline.all_meshes(only)?;
            say(&out.join("meshes").display().to_string())
        }),
        Command::Turntable(selection) => with_selection(&selection, |pipeline, only, out| {
            let meshes = pipeline.stimulus_meshes(only)?;
            pipeline.turntables(&meshes, only)?;
            say(&out.join("stimuli/turntables").display().to_string())
        }),
        Command::Pairs(run) => with_pipeline(&run, |pipeline, out| {
            let meshes = pipeline.stimulus_meshes(&[])?;
            let turntables = pipeline.turntables(&meshes, &[])?;
            pipeline.pairs(&turntables)?;
            say(&out.join("stimuli/pairs").display().to_string())
        }),
        Command::Bench(bench) => return time(&bench),
        Command::Analyse(arguments) => analyse(&arguments),
        Command::Validate(arguments) => validate(&arguments.study),
    }?;
    Ok(Outcome::Sound)
}

fn time(arguments: &Bench) -> Result<Outcome> {
    match &arguments.verb {
        Some(BenchVerb::Compare(arguments)) => return comparing::compare(arguments),
        Some(BenchVerb::Import(arguments)) => comparing::import(arguments),
        Some(BenchVerb::Worker(arguments)) => pipeline::measure(arguments),
        None => {
            let run = arguments.run.as_ref().context("a study file is needed")?;
            let length = if arguments.short { PlanLength::Short } else { PlanLength::Full };
            with_pipeline(run, |pipeline, _| {
                let timings = pipeline.timings(length)?;
                for table in pipeline.timing_statements(&timings)? {
                    say(&table)?;
                }
                Ok(())
            })
        }
    }?;
    Ok(Outcome::Sound)
}

/// Work that ends with the page. A published number that differs from ours without a known reason fails it.
fn with_page(run: &Run, work: impl FnOnce(&mut Pipeline<'_>) -> Result<Vec<String>>) -> Result<Outcome> {
    let mut outcome = Outcome::Sound;
    with_pipeline(run, |pipeline, out| {
        for difference in work(pipeline)? {
            eprintln!("differs from what was published: {difference}");
            outcome = Outcome::CheckFailed;
        }
        say(&out.join("index.html").display().to_string())
    })?;
    Ok(outcome)
}

fn with_pipeline(run: &Run, work: impl FnOnce(&mut Pipeline<'_>, &Path) -> Result<()>) -> Result<()> {
    let study = load(&run.study)?;
    let threads = run.threads as usize;
    if threads > 0 {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    }
    let out = run.out.clone().unwrap_or_else(|| default_folder(&study));
    let store = Store::open(&out, run.force)?;
    let mut pipeline = Pipeline::new(&study, store, threads);
    work(&mut pipeline, &out)?;
    pipeline.finish()
}

fn with_selection(
    selection: &Selection,
    work: impl FnOnce(&mut Pipeline<'_>, &[ConfigurationId], &Path) -> Result<()>,
) -> Result<()> {
    let study = load(&selection.run.study)?;
    let mut only = Vec::new();
    for text in &selection.only {
        let id: ConfigurationId = text.parse().with_context(|| format!("--only {text}"))?;
        if !study.configurations.iter().any(|configuration| configuration.id == id) {
            let known: Vec<String> = study.configurations.iter().map(|c| c.id.to_string()).collect();
            anyhow::bail!("--only {text}: this study has {}", known.join(", "));
        }
        only.push(id);
    }
    with_pipeline(&selection.run, |pipeline, out| work(pipeline, &only, out))
}

fn analyse(arguments: &Analyse) -> Result<()> {
    let mut study = Study::load(&arguments.study)?;
    if arguments.responses.is_some() {
        // Published numbers are about the answers that were published.
        study.published = Published::default();
        study.responses.clone_from(&arguments.responses);
    }
    let no_answers = || format!("{} names no responses; give --responses", arguments.study.display());
    let responses = study.responses.as_ref().with_context(no_answers)?;
    let folder = || Path::new("results").join(format!("{}-answers", study.file.study.id));
    let out = arguments.out.clone().unwrap_or_else(folder);
    let answers = analysis::read_answers(responses, &study)?;
    let store = Store::open(&out, false)?;
    let tables = pipeline::write_answers_only(&study, &answers, &store)?;
    store.remove_retired()?;
    manifest::write(&study, &store)?;
    for table in tables.iter().filter(|table| table.name.starts_with("preference_")) {
        say(&table.to_markdown())?;
    }
    say(&out.display().to_string())
}

fn validate(path: &Path) -> Result<()> {
    let study = load(path)?;
    for configuration in &study.configurations {
        let object = study.object(configuration);
        let spacing = object.benchmark_spacing;
        let lattice = subject::lattice(object, configuration.id.method.arrangement, spacing)?;
        let [x, y, z] = lattice.cells();
        say(&format!(
            "{}  {}, {}, {x} x {y} x {z} cubes",
            configuration.id,
            object.name,
            configuration.id.method.label()
        ))?;
    }
    let respondents = match read_answers(&study)? {
        None => "no answers".to_owned(),
        Some(answers) => format!("{} respondents", answers.respondents()),
    };
    let (questions, groups) = (study.comparisons.len(), study.groups.len());
    say(&format!("{}: valid; {questions} questions in {groups} groups, {respondents}", path.display()))
}

/// Reads and checks a study and everything it names: lattices and memory, mesh files, answers.
fn load(path: &Path) -> Result<Study> {
    let study = Study::load(path)?;
    subject::check_lattices(&study, bench::read_machine().memory_bytes)?;
    subject::check_mesh_files(&study)?;
    read_answers(&study)?;
    Ok(study)
}

fn read_answers(study: &Study) -> Result<Option<Answers>> {
    let read = |path: &PathBuf| analysis::read_answers(path, study);
    Ok(study.responses.as_ref().map(read).transpose()?)
}

fn default_folder(study: &Study) -> PathBuf {
    Path::new("results").join(&study.file.study.id)
}

/// Prints a line on standard output. A reader that has gone away is no error.
fn say(line: &str) -> Result<()> {
    match writeln!(std::io::stdout(), "{line}") {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
