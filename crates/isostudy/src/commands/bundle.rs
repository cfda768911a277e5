//! `isostudy bundle`: what participants get, and the researcher's contact sheet.

use super::checked_study;
use super::faults::fit_to_show;
use super::study_forms::{forms, no_forms};
use super::study_run::{Run, with_pipeline};
use crate::outcome::Outcome;
use crate::pipeline::{Shown, Videos, library_of_models};
use crate::terminal::say;
use crate::{input, video};
use anyhow::{Context, Result, bail};
use clap::Args;
use isostudy_design::forms::FormFile;
use isostudy_serve::page::{LibraryFile, Media, MediaFormat};
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

/// The default of forms.web_mb: at 4 Mbit/s it takes as long as a dozen turns, while pairs are judged.
const MUCH_MB: f64 = 40.0;
/// Megabytes per second of a slow line, 4 Mbit/s.
const SLOW: f64 = 0.5;

/// Makes the bundle.
///
/// # Errors
/// If a file cannot be read or made.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    if arguments.mp4 {
        video::check()?;
    }
    let wanted = |_: &Path| Ok(if arguments.mp4 { Videos::Always } else { Videos::Needed });
    let made = make(&arguments.run, wanted, arguments.with_faults)?;
    made.map_or(Ok(Outcome::CheckFailed), |made| {
        say(&made.out.join("bundle").display().to_string()).map(|()| Outcome::Done)
    })
}

/// A bundle, and where the results are.
pub(super) struct Made {
    pub(super) out: PathBuf,
    pub(super) media: Media,
    /// What draws models, in a study that shows them.
    pub(super) library: Vec<LibraryFile>,
}

/// Makes the bundle, and says what a participant loads; `None` where faults forbid one. `wanted` is asked with the folder of results.
pub(super) fn make(
    run: &Run,
    wanted: impl Fn(&Path) -> Result<Videos>,
    with_faults: bool,
) -> Result<Option<Made>> {
    let study = checked_study::load(&run.study)?;
    let (file, ..) = forms(&study)?;
    if !fit_to_show(&study, None, with_faults)? {
        return Ok(None);
    }
    let library = library_of_models(&study)?;
    let mut made = None;
    with_pipeline(run, |pipeline, out| {
        let forms = pipeline.forms()?.with_context(|| no_forms(&run.study))?;
        let Shown { meshes, pairs, .. } = pipeline.shown()?;
        let failed: Vec<String> = pipeline.failed().iter().map(ToString::to_string).collect();
        if !failed.is_empty() {
            bail!("{} failed: people cannot be asked about what is not there", failed.join(", "));
        }
        let models = pipeline.models(&meshes)?;
        pipeline.contact_sheet(&meshes)?;
        if !fit_to_show(&study, Some(out), with_faults)? {
            return Ok(());
        }
        let before = videos(out, MediaFormat::Mp4)? + videos(out, MediaFormat::WebM)?;
        pipeline.finished_videos(&pairs)?;
        let media = pipeline.bundle(&forms, &pairs, (&models, &library), wanted(out)?)?;
        if before > 0
            && !media.kinds.iter().any(|&(kind, ..)| [MediaFormat::Mp4, MediaFormat::WebM].contains(&kind))
        {
            tell!("{before} videos are removed from the bundle; `isostudy bundle --mp4` makes them");
        }
        tell_load(&media, &file);
        made = Some(Made { out: out.to_owned(), media, library: library.clone() });
        Ok(())
    })?;
    Ok(made)
}

/// How many videos of a kind the bundle has.
pub(super) fn videos(out: &Path, kind: MediaFormat) -> Result<usize> {
    Ok(input::files_of(&stimuli(out), kind.ending())?.len())
}

/// Where the bundle's pairs are.
pub(super) fn stimuli(out: &Path) -> PathBuf {
    out.join("bundle/stimuli")
}

/// Says what a participant loads, and warns where it is much.
fn tell_load(media: &Media, file: &FormFile) {
    let megabytes = |bytes: u64| bytes as f64 / 1e6;
    let loaded = media.loaded(file);
    let each: Vec<String> = loaded
        .iter()
        .map(|&(kind, bytes)| format!("{:.1} MB as {}", megabytes(bytes), kind.ending()))
        .collect();
    tell!(
        "a participant loads, while judging, {}",
        each.join(", or, where the browser does not play that, ")
    );
    let most = loaded.iter().map(|&(_, bytes)| megabytes(bytes)).fold(0.0, f64::max);
    if most > MUCH_MB {
        tell!(
            "warning: on a line of 4 Mbit/s that takes {:.0} s in all, and participants wait. Set forms.web_mb to {MUCH_MB} or less, \
             so that pairs are made smaller",
            most / SLOW
        );
    }
}
