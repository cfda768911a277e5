//! What a program says: that it is ready, an answer, or that it failed.

use std::time::Duration;

use isostudy_foreign::{Memory, shown_in_a_line};
use isostudy_mesh::TriangleMesh;
use serde::Deserialize;
use serde_json::Value;

use crate::error::{Phase, Problem, shortened};

/// What a program says of itself when it is ready.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ready {
    /// The extractor's name, as tables show it.
    pub name: String,
    /// Its version.
    pub version: String,
    /// What a reader of its times should know, such as that normals are in them.
    #[serde(default)]
    pub note: Option<String>,
}

/// What came of a request.
#[derive(Debug, Clone)]
pub struct Answer {
    /// Seconds of the extraction alone, from samples in memory to triangles in memory, by the program's own clock.
    pub extraction_s: Option<f64>,
    /// Seconds that were spent meanwhile in converting arrays or in callbacks; not part of `extraction_s`.
    pub callback_s: Option<f64>,
    /// The most memory of the extraction, as the program told it.
    pub peak_bytes: Option<u64>,
    /// From the request's last byte to the answer's, by our clock: reading samples and writing the mesh are in it.
    pub wall: Duration,
    /// CPU time of the program and all that it started, over the same time: all threads. `None` where it is not told.
    pub cpu: Option<Duration>,
    /// As told; if there is a mesh, as many as it has.
    pub vertices: u64,
    /// As told; if there is a mesh, as many as it has.
    pub triangles: u64,
    /// The mesh, if one was asked for.
    pub mesh: Option<TriangleMesh>,
    /// The memory of the program and all that it started, seen from outside when it had answered; `None` where it cannot be seen.
    pub memory: Option<Memory>,
}

/// An answer's line.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Done {
    pub(crate) id: u64,
    #[serde(default)]
    pub(crate) extraction_s: Option<f64>,
    #[serde(default)]
    pub(crate) callback_s: Option<f64>,
    #[serde(default)]
    pub(crate) peak_bytes: Option<u64>,
    pub(crate) vertices: u64,
    pub(crate) triangles: u64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ReadyLine {
    ready: Ready,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Failed {
    #[serde(default)]
    id: Option<u64>,
    failed: String,
}

/// Reads the first line.
pub(crate) fn ready(line: &[u8]) -> Result<Ready, Problem> {
    let phase = Phase::Start;
    let wrong = |reason: String| Problem::Line { phase, line: shortened(line), reason };
    let value = parsed(line, phase)?;
    if value.get("failed").is_some() {
        let Failed { failed, .. } =
            serde_json::from_value(value).map_err(|error| wrong(error.to_string()))?;
        return Err(Problem::Failed { phase, words: shortened_words(failed) });
    }
    let ReadyLine { ready } = serde_json::from_value(value).map_err(|error| {
        wrong(format!("{error}; the first line must be {{\"ready\": {{\"name\": ..., \"version\": ...}}}}"))
    })?;
    if ready.name.trim().is_empty() || ready.version.trim().is_empty() {
        return Err(wrong("name and version must not be empty".to_owned()));
    }
    Ok(ready)
}

/// Reads the answer to request `id`, which took `wall` from outside.
pub(crate) fn done(line: &[u8], id: u64, wall: Duration) -> Result<Done, Problem> {
    let phase = Phase::Request(id);
    let wrong =
        |error: serde_json::Error| Problem::Line { phase, line: shortened(line), reason: error.to_string() };
    let value = parsed(line, phase)?;
    if value.get("failed").is_some() {
        let Failed { id: got, failed } = serde_json::from_value(value).map_err(wrong)?;
        return Err(match got {
            Some(got) if got != id => Problem::WrongId { phase, got },
            _ => Problem::Failed { phase, words: shortened_words(failed) },
        });
    }
    let done: Done = serde_json::from_value(value).map_err(wrong)?;
    if done.id != id {
        return Err(Problem::WrongId { phase, got: done.id });
    }
    check_seconds(&done, phase, wall)?;
    Ok(done)
}

fn parsed(line: &[u8], phase: Phase) -> Result<Value, Problem> {
    let wrong = |reason: String| Problem::Line { phase, line: shortened(line), reason };
    let value: Value = serde_json::from_slice(line).map_err(|error| wrong(format!("not JSON: {error}")))?;
    if value.is_object() { Ok(value) } else { Err(wrong("not an object".to_owned())) }
}

/// What is told must fit into what was measured, which finds milliseconds and the CPU time of several threads.
fn check_seconds(done: &Done, phase: Phase, wall: Duration) -> Result<(), Problem> {
    let wall_s = wall.as_secs_f64();
    // Two clocks may run at slightly different rates.
    let most = 1.01 * wall_s + 1e-3;
    let mut sum = 0.0;
    for (key, seconds) in [("extraction_s", done.extraction_s), ("callback_s", done.callback_s)] {
        let Some(value) = seconds else { continue };
        sum += value;
        // No clock tells nothing for an extraction; a callback may not have been called.
        let is_told = if key == "extraction_s" { value > 0.0 } else { value >= 0.0 };
        if !(is_told && sum <= most) {
            return Err(Problem::Seconds { phase, key, value, wall_s });
        }
    }
    Ok(())
}

/// A program may say why at length; a traceback belongs on standard error.
fn shortened_words(words: String) -> String {
    const LONGEST: usize = 2000;
    let shown = shown_in_a_line(&words);
    match shown.char_indices().nth(LONGEST) {
        None => shown.into_owned(),
        Some((end, _)) => format!("{}...", &shown[..end]),
    }
}
