//! The manifest of a results folder: every file with its digest, and what made them.

use crate::store::{Store, sha256, write_whole};
use crate::{fields, recipe, shown_files};
use anyhow::Result;
use isostudy_design::Study;
use isostudy_design::machine::Machine;
use serde::Serialize;
use std::collections::BTreeMap;

const FILE: &str = "manifest.json";

/// What `manifest.json` says.
#[derive(Serialize)]
struct Manifest<'a> {
    schema: u32,
    tool: &'static str,
    version: &'static str,
    study: &'a str,
    study_sha256: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    seed: Option<u64>,
    /// Files that objects, programs and meshes of methods are read from, as the study writes them, with their SHA-256: of a volume that of
    /// its samples, since a header may name another file.
    inputs: &'a BTreeMap<String, String>,
    machine: Machine,
    files: BTreeMap<&'a str, ManifestFile<'a>>,
}

#[derive(Serialize)]
struct ManifestFile<'a> {
    bytes: u64,
    sha256: &'a str,
}

/// What results are made from: a study file, or a file of answers.
pub(crate) struct Origin<'a> {
    pub(crate) name: &'a str,
    pub(crate) sha256: String,
    pub(crate) seed: Option<u64>,
    /// See [`Manifest::inputs`].
    pub(crate) inputs: BTreeMap<String, String>,
}

impl<'a> Origin<'a> {
    /// A study.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub(crate) fn of(study: &'a Study) -> Result<Self> {
        let section = &study.file.study;
        let mut inputs = BTreeMap::new();
        for object in 0..study.file.objects.len() {
            inputs.extend(fields::files(study, object)?);
        }
        inputs.extend(shown_files::digests(study)?);
        for method in &study.methods {
            inputs.extend(recipe::files(study, method.id)?);
        }
        let sha256 = sha256(&crate::input::bytes(&study.path)?);
        Ok(Self { name: &section.id, sha256, seed: Some(section.seed), inputs })
    }
}

/// Writes the manifest, unless it is there and says the same.
///
/// # Errors
/// If a stamp cannot be read, or the file cannot be written.
pub(crate) fn write(origin: &Origin<'_>, store: &Store) -> Result<()> {
    let stamps = store.stamps()?;
    let files = stamps.iter().flat_map(|stamp| &stamp.files);
    let files = files.map(|f| (f.path.as_str(), ManifestFile { bytes: f.bytes, sha256: &f.sha256 }));
    let manifest = Manifest {
        schema: 1,
        tool: "isostudy",
        version: env!("CARGO_PKG_VERSION"),
        study: origin.name,
        study_sha256: origin.sha256.clone(),
        seed: origin.seed,
        inputs: &origin.inputs,
        // How busy the machine is now says nothing about results made earlier.
        machine: isostudy_bench::read_machine().lasting(),
        files: files.collect(),
    };
    let mut json = serde_json::to_vec_pretty(&manifest)?;
    json.push(b'\n');
    let path = store.root().join(FILE);
    if std::fs::read(&path).is_ok_and(|before| before == json) {
        return Ok(());
    }
    write_whole(&path, &json)
}
