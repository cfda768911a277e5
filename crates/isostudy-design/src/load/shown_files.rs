//! Studies whose stimuli are files of their own: what they may leave out, and what they must have.

use crate::check::{Checker, ConfigError, short};
use crate::config::{
    FieldSection, ObjectSection, STIMULI_SECONDS, STIMULUS_FILMS, STIMULUS_MESHES, ShownFileKind, StudyFile,
};
use crate::method::Recipe;
use crate::study::Configuration;
use crate::texts::english;
use crate::wording::did_you_mean;
use std::borrow::Cow;
use std::path::Path;

/// Sections about meshes that a study of files has no use for.
const OF_MESHES: [&str; 8] =
    ["arrangements", "benchmark", "clusterings", "extraction", "limits", "stills", "sweep", "viewer"];

/// A study file's text, to which a study of files has the sections added that it does without. Lines stay where they are.
///
/// # Errors
/// If a study of files has a section that it has no use for.
pub(super) fn completed<'a>(c: &Checker<'_>, text: &'a str) -> Result<Cow<'a, str>, ConfigError> {
    // What is no TOML is refused by those who read all of it.
    let Ok(table) = text.parse::<toml::Table>() else { return Ok(Cow::Borrowed(text)) };
    let stimuli = table.get("stimuli").and_then(toml::Value::as_table);
    let files = stimuli.and_then(|stimuli| stimuli.get("files")).and_then(toml::Value::as_array);
    let Some(files) = files.filter(|files| !files.is_empty()) else { return Ok(Cow::Borrowed(text)) };
    let word = |value: &toml::Value| value.get("file").and_then(toml::Value::as_str).unwrap_or("").to_owned();
    let is_mesh = |file: &toml::Value| {
        let ending = Path::new(&word(file)).extension().map(|of| of.to_string_lossy().to_lowercase());
        ending.is_some_and(|ending| STIMULUS_MESHES.contains(&&*ending))
    };
    let meshes = files.iter().any(is_mesh);
    let without: &[&str] = if meshes { &[] } else { &["turntable", "shading"] };
    if let Some(section) = OF_MESHES.iter().chain(without).find(|section| table.contains_key(**section)) {
        let limit = "must be left out: the study shows the files of [[stimuli.files]]";
        return c.refuse(*section, "[...]", limit);
    }
    let duration = stimuli
        .and_then(|stimuli| stimuli.get("duration_s"))
        .and_then(|of| of.as_float().or_else(|| of.as_integer().map(|whole| whole as f64)));
    // A film's length is that of its files; the turn of a mesh is long enough to be smooth.
    let (frames, duration) = if meshes { (72, 7.2) } else { (1, duration.unwrap_or(STIMULI_SECONDS)) };
    let sections = [
        ("limits", "memory_gib = 8.0\n".to_owned()),
        (
            "turntable",
            format!(
                "width = 400\nheight = 400\nframes = {frames}\nduration_s = {duration:?}\nelevation_rad = 0.35\n\
                 near = 0.01\nfar = 100.0\nsupersampling = 2\n"
            ),
        ),
        (
            "shading",
            "light = [-1.0, -1.0, -1.0]\nlight_follows = \"camera\"\nlit = [0.85, 0.85, 0.85]\n\
             shade = [0.2, 0.2, 0.2]\nhighlight = [0.9, 0.9, 0.9]\nbackground = [1.0, 1.0, 1.0]\n"
                .to_owned(),
        ),
        (
            "benchmark",
            "warmup = 0\niterations = 1\nshort_iterations = 1\nthreads = 1\ntarget = \"\"\n".to_owned(),
        ),
    ];
    let mut whole = text.to_owned();
    for (name, keys) in sections.iter().filter(|(name, _)| !table.contains_key(*name)) {
        whole += &format!("\n[{name}]\n{keys}");
    }
    Ok(Cow::Owned(whole))
}

/// Whether every configuration has one file and all are of one kind; whether a study without files has a field for each object and a
/// recipe for each method.
pub(super) fn check_shown_files(
    c: &Checker<'_>,
    file: &StudyFile,
    configurations: &[Configuration],
) -> Result<(), ConfigError> {
    let section = &file.stimuli;
    c.number("stimuli.duration_s", section.duration_s, 0.05, 600.0)?;
    let without_field = |object: &ObjectSection| matches!(object.field, FieldSection::Files {});
    let none = Recipe::of_files();
    if section.files.is_empty() {
        if section.duration_s != STIMULI_SECONDS {
            let limit = "goes with [[stimuli.files]]; turntable.duration_s is that of a turn";
            return c.refuse("stimuli.duration_s", short(section.duration_s), limit);
        }
        let limit = "must be given, unless [[stimuli.files]] have what is shown";
        if let Some(i) = file.objects.iter().position(without_field) {
            return c.refuse(format!("objects[{i}].field"), "nothing", limit);
        }
        return match file.methods.iter().position(|method| method.recipe == none) {
            Some(i) => c.refuse(format!("methods[{i}].recipe"), "nothing", limit),
            None => Ok(()),
        };
    }
    let limit = "must be left out: the study shows the files of [[stimuli.files]]";
    if let Some(i) = file.objects.iter().position(|object| !without_field(object)) {
        return c.refuse(format!("objects[{i}].field"), "{...}", limit);
    }
    if let Some(i) = file.methods.iter().position(|method| method.recipe != none) {
        return c.refuse(format!("methods[{i}].recipe"), "{...}", limit);
    }
    if let Some(i) = file.methods.iter().position(|method| method.budget.is_some()) {
        return c.refuse(format!("methods[{i}].match"), "{...}", limit);
    }
    let known: Vec<String> = configurations.iter().map(|of| of.id.to_string()).collect();
    let ids: Vec<String> = section.files.iter().map(|shown| shown.configuration.to_string()).collect();
    c.distinct(|i| format!("stimuli.files[{i}].configuration"), &ids)?;
    let first = section.shown_files();
    for (i, shown) in section.files.iter().enumerate() {
        let key = |name: &str| format!("stimuli.files[{i}].{name}");
        if !known.contains(&ids[i]) {
            let meant = did_you_mean(&ids[i], known.iter().map(String::as_str));
            let limit = format!("is not an object with a method of this study: {}{meant}", known.join(", "));
            return c.refuse(key("configuration"), &ids[i], limit);
        }
        let Some(kind) = shown.kind() else {
            let endings = [STIMULUS_FILMS, STIMULUS_MESHES].concat().join(", .");
            return c.refuse(key("file"), &shown.file, format!("must end with one of .{endings}"));
        };
        if Some(kind) != first {
            let limit =
                "must be of the kind of the first file: all are pictures and films, or all are meshes";
            return c.refuse(key("file"), &shown.file, limit);
        }
    }
    if let Some(missing) = known.iter().find(|id| !ids.contains(id)) {
        return c.refuse(
            "stimuli.files",
            "[...]",
            format!("has no file of {missing}: each object needs one with each method"),
        );
    }
    let shows_models = file.forms.as_ref().is_some_and(|forms| forms.stimulus != Default::default());
    if first == Some(ShownFileKind::Film) && shows_models {
        return c.refuse(
            "forms.stimulus",
            "model",
            "needs meshes, and the files of [[stimuli.files]] are pictures",
        );
    }
    // The usual texts speak of surfaces.
    let usual = |key: &str, text: &str| *english()[key] == *text;
    let Some(forms) = &file.forms else { return Ok(()) };
    for (key, text) in [("consent", &forms.consent), ("instructions", &forms.instructions)] {
        if first == Some(ShownFileKind::Film) && usual(key, text) {
            let limit = "must be written for [[stimuli.files]]: the usual text speaks of turning surfaces";
            return c.refuse(format!("forms.{key}"), "nothing", limit);
        }
    }
    Ok(())
}
