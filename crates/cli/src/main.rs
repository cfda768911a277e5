//! The `isostudy` command: arguments, files, progress and exit codes. What is computed is computed in the rooms.

// A line that cannot be written ends nothing: `tell!`.
#![deny(clippy::print_stderr)]

#[macro_use]
mod tell;

mod answers;
mod args;
mod asking;
mod chosen_method;
mod comparing;
mod distance;
mod error_colours;
mod fields;
mod input;
mod inspect;
mod machine;
mod made;
mod manifest;
mod measured;
mod memory;
mod mesh_file;
mod methods;
mod new;
mod picture;
mod pipeline;
mod prepare;
mod progress;
mod questionnaire;
mod recipe;
mod records;
mod rooms;
mod run_file;
mod source;
mod store;
mod surface;
mod turning;
mod video;

use anyhow::{Context, Result};
use args::{Analyse, Bench, BenchVerb, Cli, Command, Design, Run, Selection};
use clap::Parser;
use design::record::Purpose;
use design::{ConfigurationId, Published, Study};
use extract::Arrangement;
use pipeline::{Pipeline, PlanLength};
use recipe::Recipe;
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
            // The exit code tells where nothing can be written.
            tell!("isostudy: {}", told(&error));
            ExitCode::from(INPUT_ERROR)
        }
    }
}

/// An error and its causes; one that has told its cause itself does not tell it twice.
fn told(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if text.is_empty() {
            text = cause;
        } else if !text.ends_with(&cause) {
            text.push_str(&format!(": {cause}"));
        }
    }
    text
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
        Command::Extract(arguments) => match arguments.of_study() {
            Some(selection) => {
                return with_selection(&selection, |pipeline, only, out| {
                    pipeline.all_meshes(only)?;
                    say(&out.join("meshes").display().to_string())
                });
            }
            None => return surface::extract(&arguments),
        },
        Command::New(arguments) => new::new(&arguments),
        Command::Methods(arguments) => methods::methods(&arguments),
        Command::Turntable(arguments) => match arguments.of_study()? {
            Some(selection) => {
                return with_selection(&selection, |pipeline, only, out| {
                    let meshes = pipeline.stimulus_meshes(only)?;
                    pipeline.turntables(&meshes, only)?;
                    say(&out.join("stimuli/turntables").display().to_string())
                });
            }
            None => turning::turn(&arguments),
        },
        Command::Pairs(pairs) => {
            if pairs.mp4 {
                video::check()?;
            }
            return with_pipeline(&pairs.run, |pipeline, out| {
                let meshes = pipeline.stimulus_meshes(&[])?;
                let turntables = pipeline.turntables(&meshes, &[])?;
                let stamps = pipeline.pairs(&turntables)?;
                if pairs.mp4 {
                    pipeline.videos(&stamps)?;
                } else {
                    pipeline.finished_videos(&stamps)?;
                }
                say(&out.join("stimuli/pairs").display().to_string())
            });
        }
        Command::Bundle(arguments) => return asking::bundle(&arguments),
        Command::Serve(arguments) => return asking::serve(&arguments),
        Command::Collect(arguments) => asking::collect(&arguments),
        Command::Deidentify(arguments) => asking::deidentify(&arguments),
        Command::Bench(bench) => return time(&bench),
        Command::Analyse(arguments) if arguments.self_test.self_test => return self_test(&arguments),
        Command::Analyse(arguments) => analyse(&arguments),
        Command::Convert(arguments) => answers::convert(&arguments),
        Command::Inspect(arguments) => inspect::inspect(&arguments),
        Command::Distance(arguments) => distance::distance(&arguments),
        Command::Validate(arguments) => validate(&arguments.study),
        Command::Design(Design::Check(arguments)) => return questionnaire::check(&arguments),
        Command::Design(Design::Rules) => questionnaire::rules(),
        Command::Design(Design::Power(arguments)) => questionnaire::power(&arguments),
        Command::Design(Design::Forms(run)) => {
            return with_pipeline(&run, |pipeline, out| {
                pipeline.forms()?.with_context(|| no_forms(&run.study))?;
                say(&out.join("forms").display().to_string())
            });
        }
    }?;
    Ok(Outcome::Sound)
}

fn time(arguments: &Bench) -> Result<Outcome> {
    match &arguments.verb {
        Some(BenchVerb::Compare(arguments)) => return comparing::compare(arguments),
        Some(BenchVerb::Sweep(run)) => {
            return with_pipeline(run, |pipeline, out| {
                for table in pipeline.sweep()? {
                    say(&table)?;
                }
                say(&out.join("bench/sweep").display().to_string())
            });
        }
        Some(BenchVerb::Import(arguments)) => comparing::import(arguments),
        Some(BenchVerb::Worker(arguments)) => pipeline::measure(arguments),
        None => {
            let run = arguments.run.as_ref().context("a study file is needed")?;
            let length = if arguments.short { PlanLength::Short } else { PlanLength::Full };
            return with_pipeline(run, |pipeline, _| {
                let timings = pipeline.timings(length)?;
                for table in pipeline.timing_statements(&timings)? {
                    say(&table)?;
                }
                Ok(())
            });
        }
    }?;
    Ok(Outcome::Sound)
}

/// Work that ends with the page. A published number that differs from ours without a known reason fails it.
fn with_page(run: &Run, work: impl FnOnce(&mut Pipeline<'_>) -> Result<Vec<String>>) -> Result<Outcome> {
    let mut as_published = true;
    let outcome = with_pipeline(run, |pipeline, out| {
        for difference in work(pipeline)? {
            tell!("differs from what was published: {difference}");
            as_published = false;
        }
        say(&out.join("index.html").display().to_string())
    })?;
    Ok(if as_published { outcome } else { Outcome::CheckFailed })
}

/// A configuration whose program failed fails the check, after all else was done.
fn with_pipeline(run: &Run, work: impl FnOnce(&mut Pipeline<'_>, &Path) -> Result<()>) -> Result<Outcome> {
    let study = load(&run.study)?;
    let commands = recipe::commands(&study)?;
    if !commands.is_empty() && !run.allow_programs {
        anyhow::bail!(
            "{} runs programs, which may do whatever you may do; --allow-programs runs them:\n  {}",
            study.path.display(),
            commands.join("\n  ")
        );
    }
    let threads = run.threads as usize;
    if threads > 0 {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    }
    let out = run.out.clone().unwrap_or_else(|| default_folder(&study));
    let store = Store::open(&out, run.force)?;
    let mut pipeline = Pipeline::new(&study, store, threads);
    work(&mut pipeline, &out)?;
    pipeline.finish()?;
    let failed: Vec<String> = pipeline.failed().iter().map(ToString::to_string).collect();
    if failed.is_empty() {
        return Ok(Outcome::Sound);
    }
    tell!("failed and left out: {}", failed.join(", "));
    Ok(Outcome::CheckFailed)
}

fn with_selection(
    selection: &Selection,
    work: impl FnOnce(&mut Pipeline<'_>, &[ConfigurationId], &Path) -> Result<()>,
) -> Result<Outcome> {
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

/// Simulates studies and prints how probes, tests and intervals did; one that did not as it should fails it.
fn self_test(arguments: &Analyse) -> Result<Outcome> {
    let settings = &arguments.self_test;
    if settings.threads > 0 {
        rayon::ThreadPoolBuilder::new().num_threads(settings.threads as usize).build_global()?;
    }
    let (tables, sound) = analysis::self_test::self_test(settings.studies, settings.seed);
    for table in &tables {
        say(&table.to_markdown())?;
        if let Some(out) = &arguments.out {
            std::fs::create_dir_all(out).with_context(|| out.display().to_string())?;
            for (ending, text) in [("csv", table.to_csv()), ("md", table.to_markdown())] {
                let path = out.join(format!("{}.{ending}", table.name));
                store::write_whole(&path, text.as_bytes())?;
                say(&path.display().to_string())?;
            }
        }
    }
    if !sound {
        tell!("self-test failed: see the rows that say NO");
    }
    Ok(if sound { Outcome::Sound } else { Outcome::CheckFailed })
}

/// A study file ends in `.toml`; anything else is a file of answers.
fn analyse(arguments: &Analyse) -> Result<()> {
    let input = arguments.input.as_deref().context("no study file")?;
    let is_study = input.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    if !is_study {
        return analyse_without_study(arguments, input);
    }
    let mut study = input::study(input)?;
    if arguments.responses.is_some() {
        // Published numbers are about the answers that were published.
        study.published = Published::default();
        study.responses.clone_from(&arguments.responses);
    }
    study.file.responses = Some(answers::section(&arguments.reading, Some(&study))?);
    let no_answers = || format!("{} names no responses; give --responses", input.display());
    let reading = answers::of_study(&study)?.with_context(no_answers)?;
    answers::announce(&reading.report);
    let folder = || Path::new("results").join(format!("{}-answers", study.file.study.id));
    let out = arguments.out.clone().unwrap_or_else(folder);
    let store = Store::open(&out, false)?;
    let tables = pipeline::write_answers_only(&study, reading, &store)?;
    store.remove_retired()?;
    manifest::write(&manifest::Subject::of(&study)?, &store)?;
    for table in tables.iter().filter(|table| table.name.starts_with("preference_")) {
        say(&table.to_markdown())?;
    }
    say(&out.display().to_string())
}

fn analyse_without_study(arguments: &Analyse, path: &Path) -> Result<()> {
    if arguments.responses.is_some() {
        anyhow::bail!(
            "--responses belongs to a study, and {} is none: its name does not end in .toml",
            path.display()
        );
    }
    let section = answers::section(&arguments.reading, None)?;
    let (reading, _) = answers::without_study(path, &section)?;
    answers::announce(&reading.report);
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let folder = || Path::new("results").join(format!("{name}-answers"));
    let out = arguments.out.clone().unwrap_or_else(folder);
    let store = Store::open(&out, false)?;
    let tables = pipeline::write_without_study(path, &section, &reading, &store)?;
    store.remove_retired()?;
    let digest = store::sha256(&input::bytes(path)?);
    manifest::write(&manifest::Subject { name: &name, sha256: digest, seed: None }, &store)?;
    for table in tables.iter().filter(|table| ["tests", "worths"].contains(&table.name.as_str())) {
        say(&table.to_markdown())?;
    }
    say(&out.display().to_string())
}

fn validate(path: &Path) -> Result<()> {
    let study = load(path)?;
    for configuration in &study.configurations {
        let object = study.object(configuration);
        let grid = prepare::grid(object, object.benchmark_spacing);
        let [x, y, z] = match recipe::recipe(&study, configuration.id.method, Purpose::Benchmark)? {
            Recipe::Extractor(method) => method.cells(&grid)?,
            Recipe::Program(_) | Recipe::Meshes(_) => grid.lattice(Arrangement::SimpleCubic)?.cells(),
        };
        say(&format!(
            "{}  {}, {}, {x} x {y} x {z} cubes",
            configuration.id,
            object.name,
            study.method(configuration.id.method).label
        ))?;
    }
    let respondents = match answers::of_study(&study)? {
        None => "no answers".to_owned(),
        Some(reading) => format!("{} respondents", reading.responses.participants.len()),
    };
    let (questions, groups) = (study.comparisons.len(), study.groups.len());
    say(&format!("{}: valid; {questions} questions in {groups} groups, {respondents}", path.display()))
}

/// Reads and checks a study and everything it names: lattices and memory, mesh files, answers.
fn load(path: &Path) -> Result<Study> {
    let study = input::study(path)?;
    recipe::check(&study)?;
    prepare::check(&study, bench::read_machine().memory_bytes)?;
    fields::check(&study)?;
    if let Some(reading) = answers::of_study(&study)?.filter(|reading| !reading.report.remarks.is_empty()) {
        answers::announce(&reading.report);
    }
    Ok(study)
}

fn no_forms(study: &Path) -> String {
    format!("{}: no [forms] section, or no comparisons; configs/balanced.toml has both", study.display())
}

/// `1 answer`, `2 answers`.
fn counted(number: u64, word: &str) -> String {
    format!("{number} {word}{}", if number == 1 { "" } else { "s" })
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

/// A number with seven significant digits.
fn significant(value: f64) -> String {
    let size = value.abs();
    if value != 0.0 && !(1e-4..1e7).contains(&size) {
        return format!("{value:.6e}");
    }
    let decimals = if value == 0.0 { 0 } else { (6.0 - size.log10().floor()) as usize };
    format!("{value:.decimals$}")
}
