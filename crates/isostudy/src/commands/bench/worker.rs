//! `isostudy bench worker`: the measuring process, which `isostudy bench` starts.

use crate::outcome::Outcome;
use crate::pipeline::{Invocation, measure};
use anyhow::Result;
use clap::Args;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    invocation: Invocation,
}

/// Measures what is asked on standard input.
///
/// # Errors
/// If the study is not the one that was meant, or a request cannot be read.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    measure(&arguments.invocation)?;
    Ok(Outcome::Done)
}
