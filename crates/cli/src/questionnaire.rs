//! What `isostudy design` says of a questionnaire. What is wrong is decided in `design::lint`, what can be found in
//! `analysis::power`.

use crate::args::{Check, Power};
use crate::pipeline::MadeWith;
use crate::progress::Step;
use crate::{Outcome, counted, default_folder, input, say, store};
use analysis::power::{Assumptions, power as simulated};
use anyhow::{Context, Result, ensure};
use design::lint::{Fault, Rule, StimulusFacts, lint, lint_stimuli};
use design::{Configuration, Study};
use raster::Animation;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// A fault as JSON.
#[derive(Serialize)]
struct FaultEntry<'a> {
    rule: &'static str,
    place: &'a str,
    evidence: &'a str,
}

/// Prints the faults of a study's forms, and of its animations where they have been made.
///
/// # Errors
/// If the study or an animation cannot be read.
pub(crate) fn check(arguments: &Check) -> Result<Outcome> {
    let study = input::study(&arguments.study)?;
    forms_of(&study)?;
    let mut faults = lint(&study);
    let results = arguments.results.clone().unwrap_or_else(|| default_folder(&study));
    match stimulus_faults(&study, &results)? {
        Some(found) => faults.extend(found),
        None => tell!(
            "no animations in {}: {} not judged; `isostudy pairs` makes them",
            results.display(),
            Rule::StimuliDiffer.id()
        ),
    }
    faults.extend(bundle_faults(&study, &results.join("bundle/stimuli"))?);
    faults.sort_by_key(|fault| fault.rule);
    if arguments.json {
        let entry = |fault: &Fault| {
            serde_json::to_value(FaultEntry {
                rule: fault.rule.id(),
                place: &fault.place,
                evidence: &fault.evidence,
            })
        };
        let entries = faults.iter().map(entry).collect::<Result<Vec<_>, _>>()?;
        say(&serde_json::to_string_pretty(&entries)?)?;
    } else {
        say(&faults_text(&study, &faults))?;
    }
    Ok(if faults.is_empty() { Outcome::Sound } else { Outcome::CheckFailed })
}

/// Whether a study's participants may be given what was asked for: faults of its forms, or of the animations in `results`
/// where that is given, are printed and forbid it unless they are `allowed`.
///
/// # Errors
/// If an animation cannot be read.
pub(crate) fn fit_to_show(study: &Study, results: Option<&Path>, allowed: bool) -> Result<bool> {
    let faults = match results {
        None => lint(study),
        Some(results) => stimulus_faults(study, results)?.unwrap_or_default(),
    };
    if faults.is_empty() {
        return Ok(true);
    }
    tell!("{}", faults_text(study, &faults));
    if !allowed {
        tell!("nothing is bundled: mend the faults, or go on with --with-faults");
    }
    Ok(allowed)
}

fn faults_text(study: &Study, faults: &[Fault]) -> String {
    let mut text = String::new();
    for of_rule in faults.chunk_by(|a, b| a.rule == b.rule) {
        let rule = of_rule[0].rule;
        text += &format!("{}: {}\n", rule.id(), rule.meaning());
        for alike in of_rule.chunk_by(|a, b| a.remedy() == b.remedy()) {
            for fault in alike {
                text += &format!("  {}: {}\n", fault.place, fault.evidence);
            }
            text += &format!("  remedy: {}\n", alike[0].remedy());
        }
        text += "\n";
    }
    let file = study.path.display();
    text + &match faults.len() {
        0 => format!("{file}: no faults"),
        count => format!("{file}: {}", counted(count as u64, "fault")),
    }
}

/// Prints the rules.
///
/// # Errors
/// If standard output cannot be written.
pub(crate) fn rules() -> Result<()> {
    Rule::ALL.into_iter().try_for_each(|rule| {
        say(&format!("{}\n  {}\n  remedy: {}", rule.id(), rule.meaning(), rule.remedy()))
    })
}

/// Prints and writes how likely the study is to find a preference.
///
/// # Errors
/// If the study cannot be read or has no forms, or a file cannot be written.
pub(crate) fn power(arguments: &Power) -> Result<()> {
    let study = input::study(&arguments.study)?;
    let planned = forms_of(&study)?.participants as usize;
    let mut participants: Vec<usize> = arguments.participants.iter().map(|&n| n as usize).collect();
    if participants.is_empty() {
        // In twelfths of the plan: from a sixth to twice.
        participants = [2, 4, 6, 8, 12, 16, 24].map(|twelfths| (planned * twelfths).div_ceil(12)).into();
    }
    participants.sort_unstable();
    participants.dedup();
    let assumptions = Assumptions {
        participants,
        shares: arguments.shares.clone(),
        person_sd: arguments.person_sd,
        object_sd: arguments.object_sd,
        ties: arguments.ties,
        studies: arguments.studies,
        seed: arguments.seed,
    };
    let studies = assumptions.shares.len() * assumptions.studies as usize;
    let step = Step::begin("studies", studies, studies);
    let found = simulated(&study, &assumptions, &|| step.tick(1)).unwrap_or_default();
    step.count_all(true);
    step.end();
    ensure!(!found.is_empty(), "{}: there is no comparison to simulate", study.path.display());

    let tables = analysis::power_tables(&assumptions, &found);
    let figure = analysis::power_figure(&assumptions, &found)?;
    let folder = || Path::new("results").join(format!("{}-power", study.file.study.id));
    let out = arguments.out.clone().unwrap_or_else(folder);
    std::fs::create_dir_all(&out).with_context(|| out.display().to_string())?;
    let mut files =
        vec![("power.svg".to_owned(), figure.svg.into_bytes()), ("power.png".to_owned(), figure.png)];
    for table in &tables {
        files.push((format!("{}.csv", table.name), table.to_csv().into_bytes()));
        files.push((format!("{}.md", table.name), table.to_markdown().into_bytes()));
    }
    for (name, bytes) in &files {
        store::write_whole(&out.join(name), bytes)?;
    }
    say(&tables[1].to_markdown())?;
    say(&out.display().to_string())
}

fn forms_of(study: &Study) -> Result<&design::config::FormsSection> {
    study.file.forms.as_ref().with_context(|| {
        format!("{}: no [forms] section; configs/balanced.toml has one to copy", study.path.display())
    })
}

/// The faults of the animations in a folder of results: of both sides of every pair, and of the pairs where they have
/// been made. `None` unless every turntable is there.
///
/// # Errors
/// If a file cannot be read.
fn stimulus_faults(study: &Study, results: &Path) -> Result<Option<Vec<Fault>>> {
    let (codes, _) = study.code_names();
    let path = |code: &String| results.join("stimuli/turntables").join(format!("{code}.gif"));
    let files: Vec<_> = codes.iter().map(path).collect();
    if !files.iter().all(|file| file.is_file()) {
        return Ok(None);
    }
    let read = |(file, configuration): (&PathBuf, &Configuration)| {
        let made = made_with(&results.join(MadeWith::file(&configuration.id)))?;
        let current = made.as_ref() == Some(&MadeWith::of(study, configuration));
        let facts = fact(file, made.map(|made| made.camera)).with_context(|| file.display().to_string())?;
        Ok((facts, current))
    };
    let (facts, current): (Vec<StimulusFacts>, Vec<bool>) = files
        .par_iter()
        .zip(&study.configurations)
        .map(read)
        .collect::<Result<Vec<_>>>()?
        .into_iter()
        .unzip();
    let outdated = current.iter().filter(|&&current| !current).count();
    if outdated > 0 {
        tell!(
            "{outdated} of {} in {} were made with other settings than the study file has now and are judged as \
             they are; `isostudy pairs` makes them anew",
            counted(files.len() as u64, "animation"),
            results.display()
        );
    }
    let by_id: HashMap<_, _> = study.configurations.iter().map(|c| &c.id).zip(&facts).collect();
    let mut pairs = Vec::new();
    for stimulus in study.stimuli() {
        let (left, right) = (by_id[&stimulus.left], by_id[&stimulus.right]);
        pairs.push((stimulus.code.clone(), left.clone(), right.clone()));
    }
    let mut faults = lint_stimuli(study, &pairs);
    faults.extend(said_by_files(study, &results.join("stimuli/pairs"))?);
    Ok(Some(faults))
}

/// The faults of what participants get: text in the files, and sizes that differ.
fn bundle_faults(study: &Study, folder: &Path) -> Result<Vec<Fault>> {
    let mut faults = said_by_files(study, folder)?;
    for ending in ["gif", "mp4"] {
        let mut sizes = Vec::new();
        for file in files_of(folder, ending)? {
            sizes.push((std::fs::metadata(&file)?.len(), file));
        }
        sizes.sort();
        if let (Some((least, small)), Some((most, large))) = (sizes.first(), sizes.last())
            && least != most
        {
            let evidence =
                format!("{} has {least} bytes, {} has {most} bytes", file_name(small), file_name(large));
            let place = format!("bundle/stimuli/*.{ending}");
            faults.push(Fault { rule: Rule::NamesReveal, place, evidence });
        }
    }
    Ok(faults)
}

/// Configurations that GIFs name in the text they hold.
fn said_by_files(study: &Study, folder: &Path) -> Result<Vec<Fault>> {
    let mut faults = Vec::new();
    for file in files_of(folder, "gif")? {
        let bytes = std::fs::read(&file).with_context(|| file.display().to_string())?;
        for text in raster::gif_texts(&bytes) {
            let told = study.configurations.iter().find(|c| text.contains(&c.id.to_string()));
            let evidence = told.map(|c| format!("\"{text}\" names {}", c.id));
            let place = file.display().to_string();
            faults.extend(evidence.map(|evidence| Fault { rule: Rule::NamesReveal, place, evidence }));
        }
    }
    Ok(faults)
}

/// The files of a folder with an extension, in the order of names; none where there is no folder.
pub(crate) fn files_of(folder: &Path, extension: &str) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    if folder.is_dir() {
        for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
            let path = entry?.path();
            files.extend(path.extension().is_some_and(|e| e == extension).then_some(path));
        }
    }
    files.sort();
    Ok(files)
}

/// What a turntable was made with; `None` where that was not written down, or by another version.
fn made_with(path: &Path) -> Result<Option<MadeWith>> {
    if !path.is_file() {
        return Ok(None);
    }
    let text = std::fs::read(path).with_context(|| path.display().to_string())?;
    Ok(serde_json::from_slice(&text).ok())
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

fn fact(path: &Path, camera: Option<[f64; 3]>) -> Result<StimulusFacts> {
    let bytes = std::fs::read(path)?;
    let animation = Animation::read_gif(bytes.as_slice())?;
    let colours = animation.palette.colours();
    let corner = animation.frames.first().and_then(|frame| frame.first()).map_or(0, |&index| index);
    let mut counts = [0u64; 256];
    animation.frames.iter().flatten().for_each(|&index| counts[usize::from(index)] += 1);
    counts[usize::from(corner)] = 0;
    let total: u64 = counts.iter().sum();
    let luminance =
        |[r, g, b]: [u8; 3]| (0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)) / 255.0;
    let sum: f64 = colours.iter().zip(counts).map(|(&colour, count)| luminance(colour) * count as f64).sum();
    Ok(StimulusFacts {
        file: file_name(path),
        frames: animation.frames.len() as u32,
        duration_cs: animation.frames.len() as u32 * u32::from(animation.delay_cs),
        size: [animation.width, animation.height],
        background: colours[usize::from(corner)],
        camera,
        palette: colours.to_vec(),
        exposure: if total == 0 { 0.0 } else { sum / total as f64 },
        text: raster::gif_texts(&bytes),
    })
}
