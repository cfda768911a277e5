//! The faults of a questionnaire and of the animations that it shows. What is a fault is decided in `isostudy_design::lint`.

use crate::input;
use crate::pipeline::MadeWith;
use crate::terminal::counted;
use anyhow::{Context, Result};
use isostudy_design::lint::{Fault, Rule, StimulusFacts, lint, lint_stimuli};
use isostudy_design::{Configuration, Study};
use isostudy_raster::Animation;
use rayon::prelude::*;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Whether a study's participants may be given what was asked for: faults of its forms, or of the animations in `results`
/// where that is given, are printed and forbid it unless they are `allowed`.
///
/// # Errors
/// If an animation cannot be read.
pub(super) fn fit_to_show(study: &Study, results: Option<&Path>, allowed: bool) -> Result<bool> {
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

/// The faults by rule, as text.
pub(super) fn faults_text(study: &Study, faults: &[Fault]) -> String {
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

/// The faults of the animations in a folder of results: of both sides of every pair, and of the pairs where they have
/// been made. `None` unless every turntable is there.
///
/// # Errors
/// If a file cannot be read.
pub(super) fn stimulus_faults(study: &Study, results: &Path) -> Result<Option<Vec<Fault>>> {
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
pub(super) fn bundle_faults(study: &Study, folder: &Path) -> Result<Vec<Fault>> {
    let mut faults = said_by_files(study, folder)?;
    for ending in ["gif", "mp4", "webm"] {
        let mut sizes = Vec::new();
        for file in input::files_of(folder, ending)? {
            let found = std::fs::metadata(&file).with_context(|| file.display().to_string())?;
            sizes.push((found.len(), file));
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
    for file in input::files_of(folder, "gif")? {
        let bytes = std::fs::read(&file).with_context(|| file.display().to_string())?;
        for text in isostudy_raster::gif_texts(&bytes) {
            let named = study.configurations.iter().find(|c| text.contains(&c.id.to_string()));
            let evidence = named.map(|c| format!("\"{text}\" names {}", c.id));
            let place = file.display().to_string();
            faults.extend(evidence.map(|evidence| Fault { rule: Rule::NamesReveal, place, evidence }));
        }
    }
    Ok(faults)
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
    let bytes = input::bytes(path)?;
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
        text: isostudy_raster::gif_texts(&bytes),
    })
}
