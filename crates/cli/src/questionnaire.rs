//! What `isostudy design` says of a questionnaire. What is wrong is decided in `design::lint`, what can be found in
//! `analysis::power`.

use crate::args::{Check, Power};
use crate::progress::Step;
use crate::{Outcome, default_folder, say, store};
use analysis::power::{Assumptions, power as simulated};
use anyhow::{Context, Result, ensure};
use design::Study;
use design::lint::{Fault, Rule, StimulusFacts, lint, lint_stimuli};
use raster::Animation;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::HashMap;
use std::path::Path;

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
    let study = Study::load(&arguments.study)?;
    forms_of(&study)?;
    let mut faults = lint(&study);
    let results = arguments.results.clone().unwrap_or_else(|| default_folder(&study));
    match facts(&study, &results.join("stimuli/turntables"))? {
        Some(pairs) => faults.extend(lint_stimuli(&study, &pairs)),
        None => eprintln!(
            "no animations in {}: {} not judged; `isostudy pairs` makes them",
            results.display(),
            Rule::StimuliDiffer.id()
        ),
    }
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
        say_faults(&study, &faults)?;
    }
    Ok(if faults.is_empty() { Outcome::Sound } else { Outcome::CheckFailed })
}

fn say_faults(study: &Study, faults: &[Fault]) -> Result<()> {
    let file = study.path.display();
    for of_rule in faults.chunk_by(|a, b| a.rule == b.rule) {
        let rule = of_rule[0].rule;
        say(&format!("{}: {}", rule.id(), rule.meaning()))?;
        for fault in of_rule {
            say(&format!("  {}: {}", fault.place, fault.evidence))?;
        }
        say(&format!("  remedy: {}\n", rule.remedy()))?;
    }
    match faults.len() {
        0 => say(&format!("{file}: no faults")),
        count => say(&format!("{file}: {count} faults")),
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
    let study = Study::load(&arguments.study)?;
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
    ensure!(!found.is_empty(), "{}: no comparison differs in one property alone", study.path.display());

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

/// Both sides of every pair; `None` unless every turntable is there.
fn facts(study: &Study, folder: &Path) -> Result<Option<Vec<(String, StimulusFacts, StimulusFacts)>>> {
    let (codes, _) = study.code_names();
    let files: Vec<_> = codes.iter().map(|code| folder.join(format!("{code}.gif"))).collect();
    if !files.iter().all(|file| file.is_file()) {
        return Ok(None);
    }
    let read = |path: &std::path::PathBuf| fact(path).with_context(|| path.display().to_string());
    let facts: Vec<StimulusFacts> = files.par_iter().map(read).collect::<Result<_>>()?;
    let by_id: HashMap<_, _> = study.configurations.iter().map(|c| &c.id).zip(&facts).collect();
    let pair =
        |s: &design::forms::Stimulus| (s.code.clone(), by_id[&s.left].clone(), by_id[&s.right].clone());
    Ok(Some(study.stimuli().iter().map(pair).collect()))
}

fn fact(path: &Path) -> Result<StimulusFacts> {
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
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    Ok(StimulusFacts {
        file: name,
        frames: animation.frames.len() as u32,
        duration_cs: animation.frames.len() as u32 * u32::from(animation.delay_cs),
        size: [animation.width, animation.height],
        background: colours[usize::from(corner)],
        camera: None,
        exposure: if total == 0 { 0.0 } else { sum / total as f64 },
        bytes: bytes.len() as u64,
        text: raster::gif_texts(&bytes),
    })
}
