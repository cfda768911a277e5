//! The library that draws: files of three.js, as modules that find each other inside one page.

use crate::input;
use crate::store::{Inputs, sha256};
use anyhow::{Result, bail};
use isostudy_serve::page::LibraryFile;
use std::io::ErrorKind;
use std::path::Path;

/// A file, the name by which others import it, and the names that it imports by a path, with those that they have here.
type Source = (&'static str, &'static str, &'static [(&'static str, &'static str)]);

const CORE: &str = "three/core";
const BUFFERS: &str = "three/addons/utils/BufferGeometryUtils.js";
const SKELETONS: &str = "three/addons/utils/SkeletonUtils.js";

/// A page has no folders, so paths become names.
const SOURCES: [Source; 6] = [
    ("three.core.min.js", CORE, &[]),
    ("three.module.min.js", "three", &[("\"./three.core.min.js\"", "\"three/core\"")]),
    ("OrbitControls.js", "three/addons/controls/OrbitControls.js", &[]),
    (
        "GLTFLoader.js",
        "three/addons/loaders/GLTFLoader.js",
        &[
            ("'../utils/BufferGeometryUtils.js'", "'three/addons/utils/BufferGeometryUtils.js'"),
            ("'../utils/SkeletonUtils.js'", "'three/addons/utils/SkeletonUtils.js'"),
        ],
    ),
    ("BufferGeometryUtils.js", BUFFERS, &[]),
    ("SkeletonUtils.js", SKELETONS, &[]),
];

const LICENCE: &str = "LICENSE";

/// One module.
pub(super) struct Module {
    /// What others import it by.
    pub(super) name: &'static str,
    /// Its text, with names in place of paths.
    pub(super) text: String,
}

/// All of it.
pub(super) struct Library {
    /// Those that others import come first.
    pub(super) modules: Vec<Module>,
    /// Its licence.
    pub(super) licence: String,
}

impl Library {
    /// Reads it; `None` if a file is missing.
    ///
    /// # Errors
    /// If a file cannot be read, or does not import what it should: it is then of another version.
    pub(super) fn read(folder: &Path) -> Result<Option<Self>> {
        let mut modules = Vec::new();
        for (file, name, imports) in SOURCES {
            let Some(mut text) = read(&folder.join(file))? else { return Ok(None) };
            for (path, by_name) in imports {
                if !text.contains(path) {
                    bail!("{}", other_version(&folder.join(file), path));
                }
                text = text.replace(path, by_name);
            }
            modules.push(Module { name, text });
        }
        let Some(licence) = read(&folder.join(LICENCE))? else { return Ok(None) };
        Ok(Some(Self { modules, licence }))
    }

    /// Digest of all files.
    pub(super) fn digest(&self) -> String {
        let inputs = Inputs::default().text(LICENCE, &self.licence);
        self.modules
            .iter()
            .fold(inputs, |inputs, module| inputs.text(module.name, &sha256(module.text.as_bytes())))
            .finish()
    }
}

/// The files with which a page that a server gives draws: modules that find each other by their paths, and the licence. `None` if a
/// file is missing.
///
/// # Errors
/// If a file cannot be read, or is of another version.
pub(in crate::pipeline) fn beside_a_page(folder: &Path) -> Result<Option<Vec<LibraryFile>>> {
    const SCRIPT: &str = "text/javascript; charset=utf-8";
    let [(core, ..), (module, _, imports), ..] = SOURCES;
    let mut files = Vec::new();
    for (file, name, mime) in [
        (core, core, SCRIPT),
        (module, module, SCRIPT),
        (LICENCE, "three-licence.txt", "text/plain; charset=utf-8"),
    ] {
        let Some(content) = read(&folder.join(file))? else { return Ok(None) };
        if let Some((path, _)) = imports.iter().find(|(path, _)| file == module && !content.contains(path)) {
            bail!("{}", other_version(&folder.join(file), path));
        }
        files.push(LibraryFile { name, mime, content });
    }
    Ok(Some(files))
}

fn other_version(file: &Path, path: &str) -> String {
    format!(
        "{} does not import {path}: it is no file of the version that `make three` fetches",
        file.display()
    )
}

/// A text; `None` if there is no such file.
fn read(path: &Path) -> Result<Option<String>> {
    match input::text(path) {
        Ok(text) => Ok(Some(text)),
        Err(_) if path.symlink_metadata().is_err_and(|error| error.kind() == ErrorKind::NotFound) => Ok(None),
        Err(error) => Err(error),
    }
}
