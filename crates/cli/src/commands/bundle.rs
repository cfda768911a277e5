//! `isostudy bundle`: what participants get, and the researcher's contact sheet.

use super::checked_study;
use super::faults::fit_to_show;
use super::study_forms::{forms, no_forms};
use super::study_run::{Run, with_pipeline};
use crate::outcome::Outcome;
use crate::terminal::say;
use crate::{input, video};
use anyhow::{Context, Result, bail};
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    run: Run,
    /// Put each pair in as H.264 video as well, by the ffmpeg on the PATH
    #[arg(long)]
    mp4: bool,
    /// Go on where `design check` finds faults
    #[arg(long)]
    with_faults: bool,
}

/// Makes the bundle.
///
/// # Errors
/// If a file cannot be read or made.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    if arguments.mp4 {
        video::check()?;
    }
    let videos = if arguments.mp4 { Videos::Made } else { Videos::Removed };
    let made = make(&arguments.run, videos, arguments.with_faults)?;
    made.map_or(Ok(Outcome::CheckFailed), |out| {
        say(&out.join("bundle").display().to_string()).map(|()| Outcome::Done)
    })
}

/// What becomes of a bundle's videos.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Videos {
    Made,
    /// Those that show what the pairs do stay; others are removed.
    UpToDate,
    Removed,
}

/// Returns the folder of results; `None` where faults forbid a bundle.
pub(super) fn make(run: &Run, videos: Videos, with_faults: bool) -> Result<Option<PathBuf>> {
    let study = checked_study::load(&run.study)?;
    forms(&study)?;
    if !fit_to_show(&study, None, with_faults)? {
        return Ok(None);
    }
    let mut made = None;
    with_pipeline(run, |pipeline, out| {
        let forms = pipeline.forms()?.with_context(|| no_forms(&run.study))?;
        let meshes = pipeline.stimulus_meshes(&[])?;
        let failed: Vec<String> = pipeline.failed().iter().map(ToString::to_string).collect();
        if !failed.is_empty() {
            bail!("{} failed: people cannot be asked about what is not there", failed.join(", "));
        }
        let turntables = pipeline.turntables(&meshes, &[])?;
        let pairs = pipeline.pairs(&turntables)?;
        pipeline.contact_sheet(&meshes)?;
        if !fit_to_show(&study, Some(out), with_faults)? {
            return Ok(());
        }
        let before = mp4_files(out)?;
        let shown = match videos {
            Videos::Made => pipeline.videos(&pairs)?,
            Videos::UpToDate => pipeline.finished_videos(&pairs)?,
            Videos::Removed => {
                pipeline.finished_videos(&pairs)?;
                Vec::new()
            }
        };
        // All or none: participants would see some pairs in another quality.
        let shown = if before == 0 && videos == Videos::UpToDate || shown.len() < pairs.len() {
            Vec::new()
        } else {
            shown
        };
        if shown.is_empty() && before > 0 {
            let why = if videos == Videos::UpToDate { "they show other pairs" } else { "not asked for" };
            tell!("{before} videos are removed from the bundle, {why}; `isostudy bundle --mp4` makes them");
        }
        pipeline.bundle(&forms, &pairs, &shown)?;
        made = Some(out.to_owned());
        Ok(())
    })?;
    Ok(made)
}

/// How many videos the bundle has.
fn mp4_files(out: &Path) -> Result<usize> {
    Ok(input::files_of(&out.join("bundle/stimuli"), "mp4")?.len())
}
