//! The page that shows any two meshes of a study side by side: `viewer.html`.

mod catalogue;
mod levels;
mod library;

use super::pages::{Embedded, viewer_page};
use super::pictures::ShownFirst;
use super::{Meshes, Pipeline};
use crate::source_digests;
use crate::store::Inputs;
use crate::terminal::progress::Step;
use anyhow::{Context, Result};
use catalogue::Catalogue;
use flate2::Compression;
use flate2::write::GzEncoder;
use isostudy_design::Study;
use isostudy_design::config::ViewerSection;
use library::Library;
pub(super) use library::beside_a_page;
use rayon::prelude::*;
use std::io::Write;

const PAGE: &str = "viewer.html";

/// Whether a study has a viewer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Viewer {
    /// It asks for none.
    NotAskedFor,
    /// The folder that it names lacks the library, or a file of it.
    WithoutLibrary,
    /// It has one.
    Made,
}

impl Viewer {
    /// What a page is told.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::NotAskedFor => "not asked for",
            Self::WithoutLibrary => "without library",
            Self::Made => "made",
        }
    }
}

impl Pipeline<'_> {
    /// Makes the viewer and the meshes that only it shows, if the library is there.
    pub(super) fn viewer(&self, meshes: &Meshes, shown: &ShownFirst) -> Result<Viewer> {
        let Some(section) = &self.study.file.viewer else { return Ok(Viewer::NotAskedFor) };
        let Some(library) = Library::read(&self.study.resolve(&section.three))? else {
            tell!("viewer         left out: {} lacks three.js, which `make three` fetches", section.three);
            return Ok(Viewer::WithoutLibrary);
        };
        let levels = self.levels_of(meshes, &self.selected(&[]), &section.from_fine_to_coarse())?;
        let catalogue = Catalogue::of(self.study, &levels, &self.left_out(), shown);
        let mut inputs = Inputs::of_sources(source_digests::PAGES)
            .text("library", &library.digest())
            .value("catalogue", &catalogue);
        for level in &levels {
            inputs = inputs.stamp(&level.stamp);
        }
        let step = Step::begin("viewer", 1, 1);
        let page = self.store.stage("viewer", inputs, |writer| {
            let read = |path: &String| {
                let bytes = std::fs::read(self.store.root().join(path)).with_context(|| path.clone())?;
                compressed(&bytes)
            };
            let data = catalogue.files.par_iter().map(read).collect::<Result<Vec<_>>>()?;
            let modules = library
                .modules
                .iter()
                .map(|module| Ok(Embedded { name: module.name, bytes: compressed(module.text.as_bytes())? }))
                .collect::<Result<Vec<_>>>()?;
            let json = serde_json::to_string(&catalogue)?;
            let page = viewer_page(&self.study.file.study, &json, &modules, &data, &library.licence)?;
            writer.write(PAGE, page.as_bytes())
        })?;
        step.count(page.redone);
        step.end();
        Ok(Viewer::Made)
    }
}

/// Whether the library is there for a viewer that a study asks for.
///
/// # Errors
/// If a file of it cannot be read, or is of another version.
pub(super) fn has_library(study: &Study, section: &ViewerSection) -> Result<bool> {
    Ok(Library::read(&study.resolve(&section.three))?.is_some())
}

/// The same bytes for the same input.
fn compressed(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    Ok(encoder.finish()?)
}
