//! `isostudy pairs`: the side-by-side pairs of a study, and the key.

use super::study_run::{Run, with_pipeline};
use crate::outcome::Outcome;
use crate::terminal::say;
use crate::video;
use anyhow::Result;
use clap::Args;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    run: Run,
    /// Write each pair as H.264 video as well, twice the size, by the ffmpeg on the PATH
    #[arg(long)]
    mp4: bool,
}

/// Composes them, and makes meshes and turntables where they are not there.
///
/// # Errors
/// If the study is wrong, a file cannot be written, or there is no ffmpeg for videos.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    if arguments.mp4 {
        video::check()?;
    }
    with_pipeline(&arguments.run, |pipeline, out| {
        let stamps = pipeline.shown()?.pairs;
        if arguments.mp4 {
            pipeline.videos(&stamps)?;
        } else {
            pipeline.finished_videos(&stamps)?;
        }
        say(&out.join("stimuli/pairs").display().to_string())
    })
}
