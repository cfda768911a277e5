//! Finishing steps of a recipe or of the command line, and what they do to a mesh.

use anyhow::{Context, Result};
use isostudy_design::wording::{did_you_mean, plainly};
use isostudy_finish::{Extent, FinishError, Finished, Step};
use isostudy_mesh::TriangleMesh;
use serde::Deserialize;
use toml::de::ValueDeserializer;

/// The key of a recipe that has its steps.
pub(crate) const KEY: &str = "finish";

/// The steps of a recipe's `finish`, a list of tables.
///
/// # Errors
/// The first that is none, with its place in the list and what is allowed.
pub(crate) fn steps(value: toml::Value) -> Result<Vec<Step>, (usize, String)> {
    let toml::Value::Array(items) = value else {
        let example = "{ step = \"decimate\", ratio = 0.5 }";
        return Err((0, format!("must be a list of steps, such as [{example}]")));
    };
    let read = |(i, item)| match item {
        toml::Value::Table(table) => step(table).map_err(|error| (i, error)),
        other => Err((i, format!("{other}: must be a table, such as {{ step = \"coplanar\" }}"))),
    };
    items.into_iter().enumerate().map(read).collect()
}

/// A step of the command line, `STEP` or `STEP:KEY=VALUE,...`.
///
/// # Errors
/// What is wrong with it, with the words that are known.
pub(crate) fn step_of_text(text: &str) -> Result<Step, String> {
    let (name, settings) = text.split_once(':').unwrap_or((text, ""));
    let mut table = toml::Table::new();
    table.insert("step".into(), name.trim().into());
    for setting in settings.split(',').filter(|setting| !setting.trim().is_empty()) {
        let (key, value) = setting
            .split_once('=')
            .ok_or_else(|| format!("{}: must be KEY=VALUE, such as ratio=0.5", setting.trim()))?;
        let (key, value) = (key.trim().to_owned(), value.trim());
        // A word needs no quotes here.
        let value = ValueDeserializer::parse(value).and_then(toml::Value::deserialize);
        let value = value.unwrap_or_else(|_| setting.split_once('=').map_or("", |of| of.1.trim()).into());
        if key == "step" || table.insert(key.clone(), value).is_some() {
            return Err(format!("{key}: is there twice"));
        }
    }
    step(table)
}

fn step(table: toml::Table) -> Result<Step, String> {
    let known = || Step::NAMES.map(|name| format!("\"{name}\"")).join(", ");
    let name = match table.get("step") {
        Some(toml::Value::String(name)) => name.clone(),
        Some(other) => return Err(format!("step = {other}: allowed: {}", known())),
        None => return Err(format!("step is missing; allowed: {}", known())),
    };
    if !Step::NAMES.contains(&name.as_str()) {
        let meant = did_you_mean(&name, Step::NAMES);
        let meant = if meant.is_empty() { "." } else { &meant };
        return Err(format!("step = \"{name}\": is no finishing step{meant} Allowed: {}", known()));
    }
    let step: Step = toml::Value::Table(table)
        .try_into()
        .map_err(|error: toml::de::Error| format!("{name}: {}", plainly(error.to_string().trim_end())))?;
    step.check().map_err(|error| format!("{name}: {error}"))?;
    Ok(step)
}

/// Applies steps to a mesh.
///
/// # Errors
/// If one cannot be applied, or nothing is left.
pub(crate) fn finish(mesh: TriangleMesh, steps: &[Step], extent: Extent) -> Result<Finished> {
    let mut whole = Finished { mesh, stopped: Vec::new() };
    for step in steps {
        let Finished { mesh, stopped } = apply(step, &whole.mesh, extent)?;
        whole.mesh = mesh;
        whole.stopped.extend(stopped);
    }
    Ok(whole)
}

/// Applies one step.
///
/// # Errors
/// If it cannot be applied, or nothing is left.
pub(crate) fn apply(step: &Step, mesh: &TriangleMesh, extent: Extent) -> Result<Finished> {
    let finished = step.apply(mesh, extent).with_context(|| format!("finish: {}", step.name()))?;
    let is_lost = finished.mesh.triangles.is_empty() && !mesh.triangles.is_empty();
    if is_lost && extent == Extent::Whole {
        let (name, before) = (step.name(), mesh.triangles.len());
        anyhow::bail!("finish: {name}: no triangle is left of {before}; its tolerance must be smaller");
    }
    Ok(finished)
}

/// Why the steps cannot be applied chunk by chunk; `None` if they can.
pub(crate) fn why_not_in_chunks(steps: &[Step]) -> Option<String> {
    let of = |step: &Step| match step.check_extent(Extent::Chunk) {
        Err(error @ FinishError::Chunk { .. }) => Some(error.to_string()),
        _ if matches!(step, Step::Decimate { triangles: Some(_), .. }) => {
            Some("triangles of decimate are those of the whole mesh; chunks need ratio or error".into())
        }
        _ => None,
    };
    steps.iter().find_map(of)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_finish::Density;

    #[test]
    fn a_step_of_the_command_line_is_one_of_a_file() {
        let decimate = Step::Decimate { triangles: None, ratio: Some(0.5), error: None, lock_borders: true };
        assert_eq!(step_of_text("decimate:ratio=0.5,lock_borders=true"), Ok(decimate));
        assert_eq!(step_of_text("coplanar"), Ok(Step::Coplanar { tolerance: 0.0 }));
        assert_eq!(
            step_of_text("merge-by-distance:tolerance=0"),
            Ok(Step::MergeByDistance { tolerance: 0.0 })
        );
        let tiled = Step::ReTile { points: 500, by: Density::Curvature, seed: 3 };
        assert_eq!(step_of_text("re-tile: points=500, by=curvature, seed=3"), Ok(tiled));
        let text =
            "finish = [{ step = \"decimate\", ratio = 0.5, lock_borders = true }, { step = \"coplanar\" }]";
        let mut table: toml::Table = toml::from_str(text).unwrap();
        assert_eq!(steps(table.remove(KEY).unwrap()), Ok(vec![decimate, Step::Coplanar { tolerance: 0.0 }]));
    }

    #[test]
    fn what_is_no_step_is_refused_with_what_was_meant() {
        for (text, parts) in [
            ("decimat:ratio=0.5", vec!["did you mean decimate?", "\"re-tile\""]),
            ("smooth", vec!["\"smooth\": is no finishing step.", "\"coplanar\""]),
            ("decimate:ratoi=0.5", vec!["ratoi", "did you mean ratio?"]),
            ("decimate:ratio", vec!["KEY=VALUE"]),
            ("decimate:ratio=half", vec!["decimate", "half", "number"]),
            ("decimate:ratio=0.5,ratio=0.4", vec!["ratio: is there twice"]),
            ("decimate:step=coplanar", vec!["step: is there twice"]),
            ("decimate", vec!["needs one of triangles, ratio and error"]),
            ("decimate:triangles=0", vec!["triangles = 0: must be at least 1"]),
            ("decimate:triangles=-5", vec!["-5"]),
            ("merge-by-distance", vec!["tolerance"]),
            ("merge-by-distance:tolerance=nan", vec!["tolerance = NaN: must be a length from 0"]),
            ("coplanar:tolerance=-1", vec!["tolerance = -1.0: must be a length from 0"]),
            ("re-tile:points=99999999999", vec!["points = 99999999999: must be from 1 to 20000000"]),
            ("re-tile:points=9,by=volume", vec!["volume", "area", "curvature"]),
            ("", vec!["\"\": is no finishing step"]),
        ] {
            let error = step_of_text(text).unwrap_err();
            assert!(parts.iter().all(|part| error.contains(part)), "{text}: {error}");
        }
    }

    #[test]
    fn the_place_in_a_list_is_told() {
        let list = |text: &str| toml::from_str::<toml::Table>(text).unwrap().remove(KEY).unwrap();
        let (place, error) =
            steps(list("finish = [{ step = 'coplanar' }, { step = 'planar' }]")).unwrap_err();
        assert_eq!(place, 1);
        assert!(error.contains("did you mean coplanar?"), "{error}");
        let (_, error) = steps(list("finish = { step = 'coplanar' }")).unwrap_err();
        assert!(error.contains("must be a list of steps"), "{error}");
        let (_, error) = steps(list("finish = ['coplanar']")).unwrap_err();
        assert!(error.contains("must be a table"), "{error}");
        let (_, error) = steps(list("finish = [{ tolerance = 1 }]")).unwrap_err();
        assert!(error.contains("step is missing"), "{error}");
    }

    #[test]
    fn chunks_take_decimation_by_share_or_error_alone() {
        let why = |text| why_not_in_chunks(&[step_of_text(text).unwrap()]);
        assert_eq!(why("decimate:ratio=0.5"), None);
        assert_eq!(why("decimate:error=0.1"), None);
        assert!(why("decimate:triangles=9").unwrap().contains("ratio or error"));
        assert!(why("coplanar").unwrap().contains("coplanar needs the whole mesh"));
    }
}
