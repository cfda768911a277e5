//! The `isostudy` command: what is asked is parsed and given to the command that does it. What is computed is computed in
//! the other crates.

// A line that cannot be written ends nothing: `tell!`.
#![deny(clippy::print_stderr)]

#[macro_use]
mod terminal;

mod answer_files;
mod chunk_times;
mod commands;
mod consent;
mod digests;
mod error_colours;
mod families;
mod fields;
mod file_samples;
mod finishing;
mod grid_file;
mod help;
mod input;
mod kept_answers;
mod machine;
mod made;
mod manifest;
mod measured;
mod memory;
mod mesh_file;
mod origin;
mod outcome;
mod picture;
mod pipeline;
mod place;
mod prepare;
mod recipe;
mod records;
mod region;
mod run_file;
mod scattered_file;
mod seeds;
mod shown_files;
mod source;
mod source_digests;
mod store;
mod stored_times;
mod study_key;
mod trilinear_truth;
mod video;
mod work_time;

use anyhow::Result;
use cap::Cap;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use outcome::Outcome;
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::alloc::System;
use std::process::ExitCode;

/// The system's, with a count of what it is asked for, and a limit where there is one: `memory.rs`.
#[global_allocator]
static ALLOCATOR: Cap<&StatsAlloc<System>> = Cap::new(&INSTRUMENTED_SYSTEM, usize::MAX);

/// Wrong usage or input; clap uses the same.
const INPUT_ERROR: u8 = 2;

/// Isosurface extraction methods in front of a clock, a ruler and people.
#[derive(Debug, Parser)]
#[command(name = "isostudy", version, arg_required_else_help = true, max_term_width = 100)]
#[command(after_help = "\
Exit codes: 0 done, 1 a check failed, 2 wrong usage or input, 3 a benchmark
could not have told what it must.")]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Write a study file of one's own to begin with, each key explained
    New(commands::new::Arguments),
    /// Do everything: meshes, animations, short benchmark, tables, figures, index.html
    Study(commands::study::Arguments),
    /// Extract a surface from a formula, a volume, a mesh, points or soup; or, given a study, the study's meshes, and measure them
    Extract(Box<commands::extract::Arguments>),
    /// List the methods that have a name, what each promises, and its source
    Methods(commands::methods::Arguments),
    /// Render a study's turntable animations; or, given a mesh, its own, in any look
    Turntable(commands::turntable::Arguments),
    /// Compose the side-by-side pairs and write the key
    Pairs(commands::pairs::Arguments),
    /// Put together what participants get (forms and pairs, no key), and the researcher's contact sheet
    Bundle(commands::bundle::Arguments),
    /// Put the questionnaire on the web, and keep the answers
    Serve(commands::serve::Arguments),
    /// Join what participants downloaded from the page into one file of answers
    Collect(commands::collect::Arguments),
    /// Write a server's answers without anything that leads to a person, with a codebook
    Deidentify(commands::deidentify::Arguments),
    /// Time every configuration, with the study's full number of rounds
    Bench(commands::bench::Arguments),
    /// Read the answers; print and write the preference tables and figures; or prove the analysis with --self-test
    Analyse(commands::analyse::Arguments),
    /// Write answers in the long format or in another program's
    Convert(commands::convert::Arguments),
    /// Write tables, figures and index.html again from the results that are there
    Report(commands::report::Arguments),
    /// List the jobs of a study for a scheduler, with what each needs and is expected to take
    Plan(commands::plan::Arguments),
    /// Do jobs of a study, beside others on the same folder
    Job(commands::job::Arguments),
    /// Check a study file and everything it names, without doing any work
    Validate(commands::validate::Arguments),
    /// Extract one configuration and print what there is to know of it
    Inspect(commands::inspect::Arguments),
    /// Measure how far two surfaces are from each other: Hausdorff, mean and RMS, both ways
    Distance(commands::distance::Arguments),
    /// Check a table of triangles by signs, a method's or one in a file, and say how good its triangles can be
    Table(commands::table::Arguments),
    /// Check whether a mesh, made by any program, has the topology of the volume it was made of
    Verify(commands::verify::Arguments),
    /// Hold extractors against workloads whose truth is known, and rank those that are right
    Barometer(commands::barometer::Arguments),
    /// Judge a questionnaire before anyone answers, and deal its forms
    #[command(subcommand)]
    Design(commands::design::Verb),
}

fn main() -> ExitCode {
    // Before anything else: this process may be there to become a child of another.
    if let Some(code) = isostudy_foreign::wrapper() {
        return code;
    }
    let asked = help::grouped(Cli::command()).get_matches();
    match run(&Cli::from_arg_matches(&asked).unwrap_or_else(|error| error.exit()).command) {
        Ok(outcome) => outcome.exit_code(),
        Err(error) => {
            // The exit code tells where nothing can be written.
            tell!("isostudy: {}", with_causes(&error));
            ExitCode::from(INPUT_ERROR)
        }
    }
}

fn run(command: &Command) -> Result<Outcome> {
    match command {
        Command::New(arguments) => commands::new::run(arguments),
        Command::Study(arguments) => commands::study::run(arguments),
        Command::Plan(arguments) => commands::plan::run(arguments),
        Command::Job(arguments) => commands::job::run(arguments),
        Command::Extract(arguments) => commands::extract::run(arguments),
        Command::Methods(arguments) => commands::methods::run(arguments),
        Command::Table(arguments) => commands::table::run(arguments),
        Command::Turntable(arguments) => commands::turntable::run(arguments),
        Command::Pairs(arguments) => commands::pairs::run(arguments),
        Command::Bundle(arguments) => commands::bundle::run(arguments),
        Command::Serve(arguments) => commands::serve::run(arguments),
        Command::Collect(arguments) => commands::collect::run(arguments),
        Command::Deidentify(arguments) => commands::deidentify::run(arguments),
        Command::Bench(arguments) => commands::bench::run(arguments),
        Command::Analyse(arguments) => commands::analyse::run(arguments),
        Command::Convert(arguments) => commands::convert::run(arguments),
        Command::Report(arguments) => commands::report::run(arguments),
        Command::Validate(arguments) => commands::validate::run(arguments),
        Command::Inspect(arguments) => commands::inspect::run(arguments),
        Command::Distance(arguments) => commands::distance::run(arguments),
        Command::Verify(arguments) => commands::verify::run(arguments),
        Command::Barometer(arguments) => commands::barometer::run(arguments),
        Command::Design(verb) => commands::design::run(verb),
    }
}

/// An error and its causes; one that names its cause itself does not name it twice.
fn with_causes(error: &anyhow::Error) -> String {
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

#[cfg(test)]
mod paths;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn help_names_every_command_once_with_an_example_that_parses() {
        let command = Cli::command();
        let mut named: Vec<&str> = help::examples().map(|(name, _)| name).collect();
        let mut known: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        named.sort_unstable();
        known.sort_unstable();
        assert_eq!(named, known);
        for (name, example) in help::examples() {
            let words: Vec<&str> = example.split(' ').collect();
            assert_eq!(words[..2], ["isostudy", name], "{example}");
            let asked = help::grouped(Cli::command()).try_get_matches_from(words);
            if let Err(error) = asked.and_then(|asked| Cli::from_arg_matches(&asked)) {
                panic!("{example}: {error}");
            }
        }
    }

    #[test]
    fn help_fits_eighty_columns_and_every_command_shows_an_example() {
        let mut grouped = help::grouped(Cli::command());
        let help = grouped.render_help().to_string();
        assert!(help.lines().all(|line| line.chars().count() <= 80), "{help}");
        for own in grouped.get_subcommands_mut().filter(|own| own.get_name() != "help") {
            let help = own.render_long_help().to_string();
            assert!(help.contains("Example") && help.contains("  isostudy "), "{help}");
        }
    }
}
