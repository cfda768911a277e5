//! The faults of a questionnaire and of the animations that it shows. What is a fault is decided in `isostudy_design::lint`.

use crate::input;
use crate::pipeline::{MOST_BYTES, MadeWith, models_folder};
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
    // Films of a study's own are shown as they are, and were held to be alike when they were read.
    if study.shows_films() {
        return said_by_files(study, &results.join("stimuli/pairs")).map(Some);
    }
    let (codes, _) = study.code_names();
    let path = |code: &String| results.join("stimuli/turntables").join(format!("{code}.gif"));
    let files: Vec<_> = codes.iter().map(path).collect();
    if !files.iter().all(|file| file.is_file()) {
        return Ok(None);
    }
    let read = |(file, configuration): (&PathBuf, &Configuration)| {
        let made = made_with(&results.join(MadeWith::file(&configuration.id)))?;
        let current = made.as_ref() == Some(&MadeWith::of(study, configuration));
        let named = || file.display().to_string();
        let bytes = input::bytes(file)?;
        let animation = Animation::read_gif(bytes.as_slice()).with_context(named)?;
        let texts = isostudy_raster::gif_texts(&bytes);
        let facts = fact(file_name(file), &animation, made.map(|made| made.camera), texts);
        Ok((facts, filled(&animation), current))
    };
    let read: Vec<(StimulusFacts, f64, bool)> =
        files.par_iter().zip(&study.configurations).map(read).collect::<Result<_>>()?;
    let outdated = read.iter().filter(|(_, _, current)| !current).count();
    if outdated > 0 {
        tell!(
            "{outdated} of {} in {} were made with other settings than the study file has now and are judged as \
             they are; `isostudy pairs` makes them anew",
            counted(files.len() as u64, "animation"),
            results.display()
        );
    }
    if let Some(told) = wasted(study, &read.iter().map(|(_, filled, _)| *filled).collect::<Vec<_>>()) {
        tell!("{told}");
    }
    let by_id: HashMap<_, _> =
        study.configurations.iter().map(|c| &c.id).zip(read.iter().map(|(facts, _, _)| facts)).collect();
    let mut pairs = Vec::new();
    for stimulus in study.stimuli() {
        // Whatever stands in one file is compared with what stands first.
        for other in stimulus.shown.iter().skip(1) {
            let (left, right) = (by_id[&stimulus.shown[0]], by_id[other]);
            pairs.push((stimulus.code.clone(), left.clone(), right.clone()));
        }
    }
    let mut faults = lint_stimuli(study, &pairs);
    faults.extend(said_by_files(study, &results.join("stimuli/pairs"))?);
    faults.extend(large_models(study, results)?);
    Ok(Some(faults))
}

/// Pairs whose models are larger than they may be, where they have been made.
fn large_models(study: &Study, results: &Path) -> Result<Vec<Fault>> {
    let mut faults = Vec::new();
    for of in study.stimuli() {
        let path = models_folder(results).join(format!("{}.glb", of.code));
        if !path.is_file() {
            continue;
        }
        let bytes = std::fs::metadata(&path).with_context(|| path.display().to_string())?.len();
        if bytes > MOST_BYTES {
            let shown: Vec<String> = of.shown.iter().map(ToString::to_string).collect();
            let evidence = format!("{} take {:.1} MB", shown.join(" and "), bytes as f64 / 1e6);
            faults.push(Fault { rule: Rule::ModelsTooLarge, place: of.code, evidence });
        }
    }
    Ok(faults)
}

/// The faults of what participants get: text in the files, and sizes that differ.
pub(super) fn bundle_faults(study: &Study, folder: &Path) -> Result<Vec<Fault>> {
    let mut faults = said_by_files(study, folder)?;
    for ending in ["gif", "png", "mp4", "webm", "glb"] {
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
        let bytes = input::bytes(&file)?;
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
    let text = input::bytes(path)?;
    Ok(serde_json::from_slice(&text).ok())
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// The index that shows no surface.
fn background(animation: &Animation) -> u8 {
    animation.frames.first().and_then(|frame| frame.first()).map_or(0, |&index| index)
}

/// The least share of a frame, over all frames, that the box round the surface takes.
fn filled(animation: &Animation) -> f64 {
    let (width, behind) = (animation.width as usize, background(animation));
    let of_frame = |frame: &Vec<u8>| {
        let rows: Vec<&[u8]> = frame.chunks(width).collect();
        let is_used = |row: &&[u8]| row.iter().any(|&index| index != behind);
        let high = rows
            .iter()
            .position(is_used)
            .map(|top| rows.len() - top - rows.iter().rev().position(is_used).unwrap_or(0));
        let is_column_used = |x: &usize| rows.iter().any(|row| row[*x] != behind);
        let left = (0..width).find(is_column_used).unwrap_or(0);
        let right = (0..width).rev().find(is_column_used).map_or(0, |x| x + 1);
        (high.unwrap_or(0) * (right - left)) as f64 / frame.len() as f64
    };
    animation.frames.iter().map(of_frame).fold(1.0, f64::min)
}

/// Objects that leave more than half of a frame empty, by configuration in the order of the study; no fault, since an object may be long.
fn wasted(study: &Study, filled: &[f64]) -> Option<String> {
    let of_object = |object: usize| {
        let own = study.configurations.iter().zip(filled).filter(|(c, _)| c.object == object);
        own.map(|(_, share)| *share).fold(1.0, f64::min)
    };
    let objects: Vec<String> = (0..study.file.objects.len())
        .map(|object| (&study.file.objects[object].id, of_object(object)))
        .filter(|(_, share)| *share < 0.5)
        .map(|(id, share)| format!("{id} {:.0} %", 100.0 * share))
        .collect();
    (!objects.is_empty()).then(|| {
        format!(
            "the box round the object takes less than half of a frame, at least: {}; a smaller camera.distance shows more of it",
            objects.join(", ")
        )
    })
}

fn fact(file: String, animation: &Animation, camera: Option<[f64; 3]>, text: Vec<String>) -> StimulusFacts {
    let colours = animation.palette.colours();
    let corner = background(animation);
    let mut counts = [0u64; 256];
    animation.frames.iter().flatten().for_each(|&index| counts[usize::from(index)] += 1);
    counts[usize::from(corner)] = 0;
    let total: u64 = counts.iter().sum();
    let luminance =
        |[r, g, b]: [u8; 3]| (0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)) / 255.0;
    let sum: f64 = colours.iter().zip(counts).map(|(&colour, count)| luminance(colour) * count as f64).sum();
    StimulusFacts {
        file,
        frames: animation.frames.len() as u32,
        duration_cs: animation.frames.len() as u32 * u32::from(animation.delay_cs),
        size: [animation.width, animation.height],
        background: colours[usize::from(corner)],
        camera,
        palette: colours.to_vec(),
        exposure: if total == 0 { 0.0 } else { sum / total as f64 },
        text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_raster::{Look, Shading, Turntable, turntable};

    /// A ball whose picture is as high as the frame less what the eye's distance takes: its box is known from the angle at the eye.
    #[test]
    fn a_ball_fills_what_its_angle_says() {
        let mut mesh = isostudy_mesh::TriangleMesh::default();
        let (rings, around) = (24u32, 48u32);
        for ring in 0..=rings {
            let (sin, cos) = (std::f32::consts::PI * ring as f32 / rings as f32).sin_cos();
            for i in 0..around {
                let (y, x) = (std::f32::consts::TAU * i as f32 / around as f32).sin_cos();
                mesh.positions.push(glam::Vec3::new(sin * x, sin * y, cos));
            }
        }
        let at = |ring: u32, i: u32| ring * around + i % around;
        for (ring, i) in (0..rings).flat_map(|ring| (0..around).map(move |i| (ring, i))) {
            mesh.triangles.push([at(ring, i), at(ring + 1, i), at(ring + 1, i + 1)]);
            mesh.triangles.push([at(ring, i), at(ring + 1, i + 1), at(ring, i + 1)]);
        }
        for distance in [1.2f32, 2.0, 4.0] {
            let settings = Turntable { width: 128, height: 128, frames: 4, distance, ..Turntable::default() };
            let turned = turntable(&mesh, &settings, &Shading::default(), Look::Flat, &|| ()).unwrap();
            let angle = (1.0 / settings.eye_distance()).asin();
            let side = f64::from(angle.tan() / (settings.vertical_fov_rad / 2.0).tan());
            let share = filled(&turned);
            assert!((share - side * side).abs() < 0.04, "{distance}: {share} is not {}", side * side);
        }
        let empty = isostudy_mesh::TriangleMesh::default();
        let none = turntable(&empty, &Turntable::default(), &Shading::default(), Look::Flat, &|| ()).unwrap();
        assert_eq!(filled(&none), 0.0);
    }
}
