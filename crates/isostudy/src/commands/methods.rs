//! `isostudy methods`: what the methods that have a name are called, what they promise, and where they come from.

use crate::outcome::Outcome;
use crate::terminal::say;
use anyhow::Result;
use clap::Args;
use isostudy_extract::{Method, Preset, Promises, presets};
use serde::Serialize;
use std::collections::BTreeMap;

/// The version of the JSON.
const SCHEMA: u32 = 1;
/// Columns of an id and the space after it.
const INDENT: usize = 16;

/// What a method may promise: in JSON, in a list, as a sentence.
struct Promise {
    key: &'static str,
    word: &'static str,
    meaning: &'static str,
    is_made: fn(&Promises) -> bool,
}

const PROMISES: [Promise; 6] = [
    Promise {
        key: "manifold",
        word: "manifold",
        meaning: "oriented manifold, with or without boundary; no triangle twice, no vertex unused",
        is_made: |of| of.manifold,
    },
    Promise {
        key: "closed_off_the_box",
        word: "closed",
        meaning: "no boundary where the surface stays clear of the box",
        is_made: |of| of.closed_off_the_box,
    },
    Promise {
        key: "no_intersections",
        word: "no intersections",
        meaning: "no triangle meets another one but at vertices and sides that both have",
        is_made: |of| of.no_intersections,
    },
    Promise {
        key: "same_triangles_for_all_placements",
        word: "same triangles",
        meaning: "the same triangles, number by number, wherever vertices are placed",
        is_made: |of| of.same_triangles_for_all_placements,
    },
    Promise {
        key: "chunks",
        word: "chunks",
        meaning: "boxes of cells, extracted one by one, weld to the mesh of the whole, to the byte",
        is_made: |of| of.chunks,
    },
    Promise {
        key: "samples_suffice",
        word: "samples suffice",
        meaning: "samples are enough; without this promise there must be a field to be called",
        is_made: |of| of.samples_suffice,
    },
];

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// List those that are there for comparison alone, too
    #[arg(long)]
    all: bool,
    /// Print JSON instead: every method, and whether it is there for comparison alone
    #[arg(long)]
    json: bool,
}

/// Prints the presets.
///
/// # Errors
/// If standard output cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    say(&if arguments.json {
        serde_json::to_string_pretty(&List {
            schema: SCHEMA,
            methods: presets().iter().map(Entry::of).collect(),
        })?
    } else {
        text(arguments.all)
    })?;
    Ok(Outcome::Done)
}

#[derive(Serialize)]
struct List {
    schema: u32,
    methods: Vec<Entry>,
}

#[derive(Serialize)]
struct Entry {
    id: &'static str,
    label: &'static str,
    /// As in a study file, defaults written out.
    recipe: Method,
    promises: BTreeMap<&'static str, bool>,
    source: &'static str,
    /// There to be compared with, not to be chosen.
    for_comparison: bool,
}

impl Entry {
    fn of(preset: &Preset) -> Self {
        let made = preset.method.promises();
        Self {
            id: preset.id,
            label: preset.label,
            recipe: preset.method,
            promises: PROMISES.iter().map(|of| (of.key, (of.is_made)(&made))).collect(),
            source: preset.source,
            for_comparison: preset.method.is_for_comparison(),
        }
    }
}

fn text(all: bool) -> String {
    let mut lines = Vec::new();
    for preset in presets().iter().filter(|preset| all || !preset.method.is_for_comparison()) {
        let made = preset.method.promises();
        let words: Vec<&str> = PROMISES.iter().filter(|of| (of.is_made)(&made)).map(|of| of.word).collect();
        let words = if words.is_empty() { "nothing".to_owned() } else { words.join(", ") };
        lines.push(format!("{:<INDENT$}{}", preset.id, preset.label));
        lines.push(format!("{:<INDENT$}promises {words}", ""));
        lines.push(format!("{:<INDENT$}source   {}", "", preset.source));
    }
    let others: Vec<&str> =
        presets().iter().filter(|preset| preset.method.is_for_comparison()).map(|preset| preset.id).collect();
    if !all {
        lines.push("\n`isostudy methods --all` lists those that are there for comparison alone:".into());
        lines.extend(others.chunks(8).map(|ids| format!("  {}", ids.join(", "))));
    }
    lines.push(
        "\nPromises hold for every mesh, whatever the field. What is not promised may still hold for one."
            .into(),
    );
    lines.extend(PROMISES.iter().map(|of| format!("  {:<17}{}", of.word, of.meaning)));
    lines
        .push("\n`isostudy extract --method ID` takes a name, --recipe any other choice of settings.".into());
    lines.push("The keys of recipes are explained in docs/study-file.md.".into());
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_fit_a_hundred_columns() {
        for line in [text(false), text(true)].iter().flat_map(|text| text.lines()) {
            assert!(line.chars().count() <= 100, "{line}");
        }
        assert!(presets().iter().all(|preset| preset.id.len() < INDENT));
    }

    #[test]
    fn every_method_is_listed_once_or_named_for_comparison() {
        let (some, all) = (text(false), text(true));
        for preset in presets() {
            let entry = format!("{:<INDENT$}{}\n", preset.id, preset.label);
            assert_eq!(all.matches(&entry).count(), 1, "{}", preset.id);
            assert_eq!(some.contains(&entry), !preset.method.is_for_comparison(), "{}", preset.id);
        }
        // Those that README and the terrain study recommend.
        for id in ["mc", "mc33", "bi", "bi-relaxed", "si", "nets", "dc-in-cell"] {
            assert!(some.contains(&format!("\n{id} ")) || some.starts_with(&format!("{id} ")), "{id}");
        }
    }
}
