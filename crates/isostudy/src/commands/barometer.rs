//! `isostudy barometer`: extractors held against workloads whose truth is known, and ranked with caution.

mod answering;
mod compare;
mod given;
mod measuring;
mod page;
mod run;
mod told;

use crate::outcome::Outcome;
use anyhow::Result;
use clap::{Args, Subcommand};

#[derive(Debug, Args)]
#[command(after_help = "\
A mesh is judged before it is timed: topology, orientation, place, volume. A wrong one gives no time to any rank.
docs/barometer.md says what is measured, what is not, and how to add an engine.

Examples:
  isostudy barometer run configs/barometer --quick --allow-programs -o results/barometer
  isostudy barometer rank results/barometer --group hard --engine vtk-flying-edges --engine mc33
  isostudy barometer compare results/published/barometer/2026-11-28-quick results/barometer")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Judge and time every engine on every workload; a run that was killed goes on
    Run(run::Arguments),
    /// Print ranks of a recording, of any engines and workloads
    Rank(told::Arguments),
    /// Say whether two recordings agree in the order of all engines that both distinguish; exit 1 if not, or if there are none
    Compare(compare::Arguments),
    /// Write the tables and the page of a recording again
    Report(page::Arguments),
    /// Answer requests by a method of isostudy, as a program of another's would: docs/programs.md
    Engine(answering::Arguments),
}

/// Does what is asked for.
///
/// # Errors
/// If a file cannot be read or written, or a program is not allowed.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    match &arguments.verb {
        Verb::Run(arguments) => run::run(arguments),
        Verb::Rank(arguments) => told::run(arguments),
        Verb::Compare(arguments) => compare::run(arguments),
        Verb::Report(arguments) => page::run(arguments),
        Verb::Engine(arguments) => answering::run(arguments),
    }
}
