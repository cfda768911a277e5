//! A benchmark run read back, and checked before anything is made of it.

use crate::input;
use anyhow::{Context, Result, bail};
use isostudy_design::record::BenchRun;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

/// What keys were called before, and still may be.
const RENAMED: [&str; 1] = ["sitting"];

#[derive(Deserialize)]
#[serde(expecting = "a run, as `isostudy bench` writes it")]
struct Versioned {
    schema: u32,
}

/// Reads a run, and says on standard error which keys of its file are not read. Errors name the file and the place in it.
pub(crate) fn read(path: &Path) -> Result<BenchRun> {
    of(&input::bytes(path)?, path)
}

/// The same of a file's bytes.
pub(crate) fn of(text: &[u8], path: &Path) -> Result<BenchRun> {
    let name = || path.display().to_string();
    let Versioned { schema } = serde_json::from_slice(text).with_context(name)?;
    let (oldest, newest) = BenchRun::READ.into_inner();
    if schema < oldest {
        bail!("{}: schema = {schema}: this version reads {oldest} to {newest}; measure it again", name());
    }
    if schema > newest {
        bail!(
            "{}: schema = {schema}: this version reads {oldest} to {newest}; a newer isostudy wrote it",
            name()
        );
    }
    let run: BenchRun = serde_json::from_slice(text).with_context(name)?;
    run.check().with_context(name)?;
    let unknown = unknown_keys(&serde_json::from_slice(text)?, &serde_json::to_value(&run)?);
    if !unknown.is_empty() {
        let keys: Vec<String> = unknown.into_iter().collect();
        tell!("{}: not read, since no run has such keys: {}", name(), keys.join(", "));
    }
    Ok(run)
}

/// The keys of a file that what was read of it has not got. Places in lists are not told apart.
fn unknown_keys(file: &Value, read: &Value) -> BTreeSet<String> {
    let mut unknown = BTreeSet::new();
    collect_unknown(file, read, "", &mut unknown);
    unknown
}

fn collect_unknown(file: &Value, read: &Value, place: &str, unknown: &mut BTreeSet<String>) {
    match (file, read) {
        (Value::Object(file), Value::Object(read)) => {
            let dot = if place.is_empty() { "" } else { "." };
            for (key, value) in file {
                let place = format!("{place}{dot}{key}");
                match read.get(key) {
                    Some(read) => collect_unknown(value, read, &place, unknown),
                    None if RENAMED.contains(&key.as_str()) => {}
                    // Nothing is lost; an empty list may be left out.
                    None if *value == Value::Array(Vec::new()) => {}
                    None => drop(unknown.insert(place)),
                }
            }
        }
        (Value::Array(file), Value::Array(read)) => {
            for (file, read) in file.iter().zip(read) {
                collect_unknown(file, read, &format!("{place}[]"), unknown);
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn keys_that_are_not_read_are_named_once() {
        let read = json!({"a": 1, "list": [{"b": 2}, {"b": 3}], "plain": {"c": null}});
        assert!(unknown_keys(&read, &read).is_empty());
        let file = json!({
            "a": 1, "z": 0, "sitting": 1, "failed": [],
            "list": [{"b": 2, "x": 1}, {"b": 3, "x": 2}],
            "plain": {"c": null, "y": {"deep": 1}},
        });
        let want = ["list[].x", "plain.y", "z"].map(String::from);
        assert_eq!(unknown_keys(&file, &read), BTreeSet::from(want));
    }
}
