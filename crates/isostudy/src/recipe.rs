//! What a study's recipes ask for: an extractor of ours, a program, or meshes that are there.

use crate::families::{FAMILIES, Family, FamilyKind, keys_of};
use crate::finishing;
use crate::study_key::place;
use anyhow::{Context, Result, bail};
use isostudy_design::config::Quantity;
use isostudy_design::record::Purpose;
use isostudy_design::wording::{did_you_mean, plainly};
use isostudy_design::{MethodId, Study};
use isostudy_extract::{Method, Positions, kinds, presets};
use isostudy_finish::Step;
use isostudy_program::Program;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The kinds of recipes that are the study's own, and never the extractor's: a game's library must not be able to start processes.
#[derive(Debug, Clone, Copy)]
pub(crate) enum StudyKind {
    Program,
    Meshes,
    Family(FamilyKind),
}

impl StudyKind {
    fn all() -> impl Iterator<Item = Self> {
        [Self::Program, Self::Meshes].into_iter().chain(FAMILIES.into_iter().map(Self::Family))
    }

    /// What `kind = ...` calls it.
    fn name(self) -> &'static str {
        match self {
            Self::Program => "program",
            Self::Meshes => "meshes",
            Self::Family(of) => of.name,
        }
    }

    /// The kind of a name; `None` for the extractor's kinds, and for what is none.
    pub(crate) fn of(name: &str) -> Option<Self> {
        Self::all().find(|kind| kind.name() == name)
    }
}

/// How the meshes of a method come to be.
#[derive(Debug, Clone)]
pub(crate) enum Recipe {
    /// An extractor of ours.
    Extractor(Method),
    /// A program that is given samples and answers with a mesh.
    Program(Program),
    /// Meshes that are there: an object's id, and its file.
    Meshes(BTreeMap<String, PathBuf>),
    /// A family with a crate of its own.
    Family(Arc<dyn Family>),
}

/// Whether this process runs programs in a sandbox. It is asked for once, and every reading of a recipe must say the same.
static SANDBOX: AtomicBool = AtomicBool::new(false);

/// Runs programs in a sandbox from now on, if so asked.
pub(crate) fn use_sandbox(is_asked: bool) {
    SANDBOX.store(is_asked, Ordering::Relaxed);
}

/// Whether programs run in a sandbox.
pub(crate) fn uses_sandbox() -> bool {
    SANDBOX.load(Ordering::Relaxed)
}

/// The largest program or mesh.
const LARGEST_BYTES: u64 = 4 << 30;

/// The keys of a program.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ProgramKeys {
    command: Vec<String>,
    #[serde(default = "a_minute")]
    time_limit_s: f64,
    #[serde(default = "four")]
    memory_gib: f64,
}

/// The keys of meshes that are there.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MeshKeys {
    files: BTreeMap<String, String>,
}

fn a_minute() -> f64 {
    60.0
}

fn four() -> f64 {
    4.0
}

/// What a study's method asks for. Meshes made for [`Purpose::Indexed`] have indexed positions whatever the study says.
///
/// # Errors
/// If its recipe is none, naming file, key and what is allowed.
pub(crate) fn recipe(study: &Study, id: MethodId, purpose: Purpose) -> Result<Recipe> {
    read(study, id, purpose).with_context(|| key(study, id))
}

/// The finishing steps of a study's method, in their order; none where its recipe has none.
///
/// # Errors
/// The first that is none, naming file, key and what is allowed.
pub(crate) fn finish(study: &Study, id: MethodId) -> Result<Vec<Step>> {
    let Some(value) = study.method(id).recipe.settings.get(finishing::KEY) else { return Ok(Vec::new()) };
    finishing::steps(value.clone()).map_err(|(at, error)| {
        let key = match study.file.methods.iter().position(|section| section.id == id) {
            Some(i) => place(study, &format!("methods[{i}].recipe.{}[{at}]", finishing::KEY)),
            None => place(study, "extraction"),
        };
        anyhow::Error::msg(format!("{key}: {error}"))
    })
}

/// Where a method's recipe stands.
pub(crate) fn key(study: &Study, id: MethodId) -> String {
    match study.file.methods.iter().position(|section| section.id == id) {
        Some(i) => place(study, &format!("methods[{i}].recipe")),
        None => place(study, "extraction"),
    }
}

fn read(study: &Study, id: MethodId, purpose: Purpose) -> Result<Recipe> {
    if study.shown_files().is_some() {
        bail!("there is none: the study shows the files of [[stimuli.files]] and makes no meshes");
    }
    let recipe = &study.method(id).recipe;
    let mut keys = recipe.settings.clone();
    // Steps go with every kind.
    keys.remove(finishing::KEY);
    match StudyKind::of(&recipe.kind) {
        Some(StudyKind::Program) => {
            let keys: ProgramKeys = keys_of(keys)?;
            for (name, value, most) in
                [("time_limit_s", keys.time_limit_s, 86_400.0), ("memory_gib", keys.memory_gib, 1024.0)]
            {
                if !(value > 0.0 && value <= most) {
                    bail!("{name} = {value:?}: must be above 0 and at most {most}");
                }
            }
            Ok(Recipe::Program(Program {
                command: keys.command,
                base: study.resolve("."),
                time_limit: Duration::from_secs_f64(keys.time_limit_s),
                memory_limit_bytes: Some((keys.memory_gib * (1u64 << 30) as f64) as u64),
                sandbox: SANDBOX.load(Ordering::Relaxed),
            }))
        }
        Some(StudyKind::Meshes) => {
            let keys: MeshKeys = keys_of(keys)?;
            let objects: Vec<&str> = study.file.objects.iter().map(|object| object.id.as_str()).collect();
            if let Some(other) = keys.files.keys().find(|id| !objects.contains(&id.as_str())) {
                bail!("files.{other}: is not an object of this study, which has {}", objects.join(", "));
            }
            if let Some(missing) = objects.iter().find(|id| !keys.files.contains_key(**id)) {
                bail!("files.{missing}: must name a mesh of this object");
            }
            Ok(Recipe::Meshes(keys.files.into_iter().map(|(id, file)| (id, study.resolve(&file))).collect()))
        }
        Some(StudyKind::Family(of)) => Ok(Recipe::Family((of.read)(keys, study)?)),
        None => {
            let (kind, mut keys) = (recipe.kind.as_str(), keys);
            keys.insert("kind".into(), kind.into());
            let method = toml::Value::Table(keys).try_into().map_err(|error: toml::de::Error| {
                // Values of other keys have variants as well.
                let is_kind = kinds().iter().all(|known| known.name != kind);
                anyhow::Error::msg(if is_kind {
                    no_kind(kind, true)
                } else {
                    plainly(error.to_string().trim_end())
                })
            })?;
            Ok(Recipe::Extractor(match (method, purpose) {
                (Method::Tetrahedra(of), Purpose::Indexed) => {
                    Method::Tetrahedra(of.with_positions(Positions::Indexed))
                }
                (method, _) => method,
            }))
        }
    }
}

/// A recipe without the keys that have their defaults.
fn shortest(method: Method) -> String {
    let Ok(toml::Value::Table(mut keys)) = toml::Value::try_from(method) else { return String::new() };
    for key in keys.keys().cloned().collect::<Vec<_>>() {
        let mut without = keys.clone();
        without.remove(&key);
        if toml::Value::Table(without.clone()).try_into() == Ok(method) {
            keys = without;
        }
    }
    let kind = keys.remove("kind").into_iter().map(|kind| format!("kind = {kind}"));
    let others = keys.iter().map(|(key, value)| format!("{key} = {value}"));
    format!("{{ {} }}", kind.chain(others).collect::<Vec<_>>().join(", "))
}

/// What is wrong with a kind that no recipe has: the kinds that there are, with those of a study, and the one that was meant. The
/// name of a method is no kind, and has a recipe.
pub(crate) fn no_kind(kind: &str, in_study: bool) -> String {
    let own = StudyKind::all().filter(|_| in_study).map(StudyKind::name);
    let known: Vec<&str> = kinds().iter().map(|kind| kind.name).chain(own).collect();
    let allowed = known.iter().map(|kind| format!("\"{kind}\"")).collect::<Vec<_>>().join(", ");
    let named = presets().iter().find(|preset| preset.id == kind.to_lowercase());
    let meant = match named {
        Some(preset) => format!(". The method {} has the recipe {}.", preset.id, shortest(preset.method)),
        None => did_you_mean(kind, known),
    };
    let meant = if meant.is_empty() { ".".to_owned() } else { meant };
    format!("kind = \"{kind}\": is no kind{meant} Allowed: {allowed}")
}

/// Checks that every recipe is one, and that programs and meshes are there.
///
/// # Errors
/// The first that is not, naming file, key and what is allowed.
pub(crate) fn check(study: &Study) -> Result<()> {
    if study.shown_files().is_some() {
        return Ok(());
    }
    for method in &study.methods {
        finish(study, method.id)?;
        match recipe(study, method.id, Purpose::Benchmark)? {
            Recipe::Extractor(_) | Recipe::Family(_) => {}
            Recipe::Program(program) => program.check().with_context(|| key(study, method.id))?,
            Recipe::Meshes(files) => {
                for (object, path) in &files {
                    if !path.is_file() {
                        bail!(
                            "{}.files.{object} names {}: no such file",
                            key(study, method.id),
                            path.display()
                        );
                    }
                    if std::fs::metadata(path).is_ok_and(|found| found.len() > LARGEST_BYTES) {
                        bail!(
                            "{}.files.{object} names {}: larger than {LARGEST_BYTES} bytes, the limit for a mesh",
                            key(study, method.id),
                            path.display()
                        );
                    }
                }
            }
        }
        check_budget(study, method)?;
    }
    Ok(())
}

/// Checks that a method with a budget has a spacing to choose, and that the method to be matched has what is to be matched.
fn check_budget(study: &Study, method: &isostudy_design::Method) -> Result<()> {
    let Some(budget) = method.budget else { return Ok(()) };
    let is_there =
        |id| Ok::<bool, anyhow::Error>(matches!(recipe(study, id, Purpose::Benchmark)?, Recipe::Meshes(_)));
    let i = study.place(method.id);
    let [name, what] = budget.quantity.names();
    let key = format!("{} = {}", place(study, &format!("methods[{i}].match.{name}")), budget.of);
    if let Recipe::Family(of) = recipe(study, method.id, Purpose::Benchmark)?
        && let Some(what) = of.has_one_resolution()
    {
        bail!("{key}: {what} have no spacing to choose");
    }
    if is_there(method.id)? {
        bail!("{key}: meshes that are there have no spacing to choose");
    }
    if budget.quantity != Quantity::Triangles && is_there(budget.of)? {
        bail!("{key}: meshes that are there have no {what} to match; triangles_of can match them");
    }
    Ok(())
}

/// Whether some method sums its positions up, so that meshes with indexed ones are measured beside.
///
/// # Errors
/// As [`recipe`].
pub(crate) fn sums_positions(study: &Study) -> Result<bool> {
    for method in &study.methods {
        if let Recipe::Extractor(Method::Tetrahedra(of)) = recipe(study, method.id, Purpose::Benchmark)?
            && of.positions != Positions::Indexed
        {
            return Ok(true);
        }
    }
    Ok(false)
}

/// What a recipe depends on beside its keys: the digests of [`files`].
///
/// # Errors
/// If one cannot be read.
pub(crate) fn inputs(study: &Study, id: MethodId) -> Result<Vec<String>> {
    Ok(files(study, id)?.into_iter().map(|(_, digest)| digest).collect())
}

/// The programs and meshes that a recipe names, from the study's folder where they lie in or beside it, with their SHA-256.
///
/// # Errors
/// If one cannot be read.
pub(crate) fn files(study: &Study, id: MethodId) -> Result<Vec<(String, String)>> {
    if study.shown_files().is_some() {
        return Ok(Vec::new());
    }
    let files = match recipe(study, id, Purpose::Benchmark)? {
        Recipe::Extractor(_) | Recipe::Family(_) => Vec::new(),
        Recipe::Program(program) => program.files().with_context(|| key(study, id))?,
        Recipe::Meshes(files) => files.into_values().collect(),
    };
    let folder = study.path.parent().unwrap_or(Path::new(""));
    let absolute = std::env::current_dir().context("this folder is not there")?.join(folder);
    let digest = |path: &PathBuf| {
        let bytes = isostudy_foreign::bytes(path, LARGEST_BYTES)?;
        let short = path.strip_prefix(&absolute).or(path.strip_prefix(folder)).unwrap_or(path);
        Ok((short.display().to_string(), crate::store::sha256(&bytes)))
    };
    files.iter().map(digest).collect()
}
