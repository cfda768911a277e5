//! `isostudy bundle`, `serve`, `collect` and `deidentify`: what a study's people are asked, and what they answered.

use crate::args::{Bundle, Collect, Deidentify, Run, Serve};
use crate::pipeline::forms_digest;
use crate::questionnaire::{files_of, fit_to_show};
use crate::{Outcome, counted, input, load, no_forms, say, store, video, with_pipeline};
use anyhow::{Context, Result, bail, ensure};
use design::Study;
use design::forms::{FormFile, KeyEntry, Questionnaire};
use serve::export::{self, Given, HEADER};
use serve::journal::{self, Loss};
use serve::{Limits, Settings, download, share};
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};

/// A study's forms, their key, and their digest.
fn forms(study: &Study) -> Result<(FormFile, Vec<KeyEntry>, String)> {
    let questionnaire = Questionnaire::of(study).with_context(|| no_forms(&study.path))?;
    let file = questionnaire.file();
    let digest = forms_digest(&file)?;
    Ok((file, questionnaire.key(), digest))
}

/// Answers are never among the results, which can be made again.
fn answers_folder(study: &Study, given: Option<&PathBuf>) -> PathBuf {
    given.cloned().unwrap_or_else(|| Path::new("answers").join(&study.file.study.id))
}

/// Makes the bundle.
///
/// # Errors
/// If a file cannot be read or made.
pub(crate) fn bundle(arguments: &Bundle) -> Result<Outcome> {
    if arguments.mp4 {
        video::check()?;
    }
    let videos = if arguments.mp4 { Videos::Made } else { Videos::Removed };
    let made = make_bundle(&arguments.run, videos, arguments.with_faults)?;
    made.map_or(Ok(Outcome::CheckFailed), |out| {
        say(&out.join("bundle").display().to_string()).map(|()| Outcome::Sound)
    })
}

/// What becomes of a bundle's videos.
#[derive(Clone, Copy, PartialEq)]
enum Videos {
    Made,
    /// Those that show what the pairs do; others are removed.
    Kept,
    Removed,
}

/// Returns the folder of results; `None` where faults forbid a bundle.
fn make_bundle(run: &Run, videos: Videos, with_faults: bool) -> Result<Option<PathBuf>> {
    let study = load(&run.study)?;
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
        let kept = match videos {
            Videos::Made => pipeline.videos(&pairs)?,
            Videos::Kept => pipeline.finished_videos(&pairs)?,
            Videos::Removed => {
                pipeline.finished_videos(&pairs)?;
                Vec::new()
            }
        };
        // All or none: participants would see some pairs in another quality.
        let kept =
            if before == 0 && videos == Videos::Kept || kept.len() < pairs.len() { Vec::new() } else { kept };
        if kept.is_empty() && before > 0 {
            let why = if videos == Videos::Kept { "they show other pairs" } else { "not asked for" };
            tell!("{before} videos are removed from the bundle, {why}; `isostudy bundle --mp4` makes them");
        }
        pipeline.bundle(&forms, &pairs, &kept)?;
        made = Some(out.to_owned());
        Ok(())
    })?;
    Ok(made)
}

/// How many videos the bundle has.
fn mp4_files(out: &Path) -> Result<usize> {
    Ok(files_of(&out.join("bundle/stimuli"), "mp4")?.len())
}

/// Makes the bundle and serves it until told to stop.
///
/// # Errors
/// If the bundle cannot be made, or the server cannot run.
pub(crate) fn serve(arguments: &Serve) -> Result<Outcome> {
    let study = load(&arguments.run.study)?;
    let (file, key, digest) = forms(&study)?;
    let Some(out) = make_bundle(&arguments.run, Videos::Kept, arguments.with_faults)? else {
        return Ok(Outcome::CheckFailed);
    };
    let admin_token = match &arguments.admin_token {
        Some(token) if token.len() < 12 => bail!("--admin-token: at least 12 characters"),
        Some(token) => token.clone(),
        None => serve::random_hex(16),
    };
    let settings = Settings {
        completion: study.file.forms.as_ref().and_then(|forms| forms.completion.clone()),
        stimuli: out.join("bundle/stimuli"),
        answers: answers_folder(&study, arguments.answers.as_ref()),
        address: SocketAddr::new(arguments.address, arguments.port),
        admin_token: admin_token.clone(),
        file,
        key,
        digest,
        public_url: arguments.public_url.clone(),
        limits: Limits { sessions_per_address: arguments.sessions_per_address, ..Limits::default() },
        loss: if arguments.accept_loss { Loss::Accept } else { Loss::Refuse },
    };
    let answers = settings.answers.clone();
    serve::serve(settings, |address, held| {
        let reached = arguments.public_url.as_ref().map_or(format!("http://{address}"), ToString::to_string);
        tell!("questionnaire   {reached}/");
        tell!("researcher      {reached}/researcher");
        if arguments.public_url.is_some() {
            tell!("listens on      http://{address}/");
        }
        if arguments.admin_token.is_none() {
            tell!("token           {admin_token}");
        }
        tell!("answers         {}", answers.display());
        tell!("holds           {held}");
        tell!("Ctrl-C stops it; what was acknowledged is on disk.");
    })?;
    Ok(Outcome::Sound)
}

/// Joins the page's downloads with the key into one file that `analyse` reads.
///
/// # Errors
/// If a file cannot be read or contradicts another, or the study is not the one that was answered.
pub(crate) fn collect(arguments: &Collect) -> Result<()> {
    let study = input::study(&arguments.study)?;
    let (file, key, _) = forms(&study)?;
    let mut all: BTreeMap<(String, u32), Given> = BTreeMap::new();
    let mut again = 0;
    for path in &arguments.downloads {
        let place = || path.display().to_string();
        input::regular(path)?;
        ensure!(
            !input::is_same(path, &arguments.out),
            "{}: is a download; it would be written over",
            place()
        );
        let text = std::fs::read_to_string(path).with_context(place)?;
        let given = download::read(&text, &file.study).with_context(place)?;
        ensure!(!given.is_empty(), "{}: no answers in it", place());
        export::lines(&given, &key).with_context(place)?;
        again += download::add(&mut all, given).with_context(place)?;
    }
    let given: Vec<Given> = all.into_values().collect();
    store::write_whole(&arguments.out, lines(&given, &key)?.as_bytes())?;
    let repeated = if again > 0 { format!("; {again} came twice") } else { String::new() };
    let people = counted(participants(&given) as u64, "participant");
    tell!("{} of {people}{repeated}", counted(given.len() as u64, "answer"));
    say(&arguments.out.display().to_string())
}

/// Writes the answers of a server without anything that leads to a person, and a codebook.
///
/// # Errors
/// If the answers cannot be read, or the files not be written.
pub(crate) fn deidentify(arguments: &Deidentify) -> Result<()> {
    let study = input::study(&arguments.study)?;
    let (file, key, digest) = forms(&study)?;
    let folder = answers_folder(&study, arguments.answers.as_ref());
    if !folder.join("answers.sqlite").is_file() {
        bail!("{}: no answers.sqlite there", folder.display());
    }
    let kept = journal::kept(&folder, &file.study)?;
    if kept.digest != digest {
        tell!("the study file was changed since the first answer; the codebook says what it says now");
    }
    let given = share::deidentified(&kept.given);
    std::fs::create_dir_all(&arguments.out).with_context(|| arguments.out.display().to_string())?;
    let codebook = share::codebook(&file, (&kept.digest, &digest), participants(&given), given.len());
    for (name, text) in [("answers.csv", lines(&given, &key)?), ("codebook.md", codebook)] {
        let path = arguments.out.join(name);
        store::write_whole(&path, text.as_bytes())?;
        say(&path.display().to_string())?;
    }
    Ok(())
}

fn lines(given: &[Given], key: &[KeyEntry]) -> Result<String> {
    Ok(export::csv(&export::lines(given, key)?, &HEADER))
}

fn participants(given: &[Given]) -> usize {
    let mut names: Vec<&str> = given.iter().map(|given| given.participant.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    names.len()
}
