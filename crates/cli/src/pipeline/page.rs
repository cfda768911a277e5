//! The page that shows a study, and the manifest of everything that was written.

use super::tables::{FIGURE_CONTENTS, FigureEntry, TABLE_CONTENTS, TableEntry};
use super::{Meshes, Pipeline};
use crate::progress::Step;
use crate::rooms;
use crate::store::{Inputs, Stamp, sha256};
use anyhow::{Context, Result};
use design::machine::Machine;
use design::{Comparison, Configuration, Study};
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{Environment, context};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;

const TEMPLATE: &str = include_str!("../page/index.html");

/// What `manifest.json` says.
#[derive(Serialize)]
struct Manifest<'a> {
    schema: u32,
    tool: &'static str,
    version: &'static str,
    study: &'a str,
    study_sha256: String,
    seed: u64,
    machine: Machine,
    files: BTreeMap<&'a str, ManifestFile<'a>>,
}

#[derive(Serialize)]
struct ManifestFile<'a> {
    bytes: u64,
    sha256: &'a str,
}

/// A turntable or a pair on the page.
#[derive(Serialize)]
struct Card {
    object: String,
    title: String,
    file: String,
}

impl Pipeline<'_> {
    /// Writes `index.html` and `manifest.json`. `made` are the stamps of all stages but the meshes'.
    pub(super) fn page(&self, meshes: &Meshes, made: &[Stamp]) -> Result<()> {
        let step = Step::begin("page", 1, 1);
        let all: Vec<&Stamp> = meshes.stamps().chain(made).collect();
        let mut inputs = Inputs::of_rooms(rooms::PAGES).value("study", &self.study.file);
        for stamp in &all {
            inputs = inputs.stamp(stamp);
        }
        let stamp = self.store.stage("page", inputs, |writer| {
            writer.write("index.html", self.render_page()?.as_bytes())?;
            let page = writer.files().to_vec();
            let files = all.iter().flat_map(|stamp| &stamp.files).chain(&page);
            let files = files.map(|f| (f.path.as_str(), ManifestFile { bytes: f.bytes, sha256: &f.sha256 }));
            let manifest = Manifest {
                schema: 1,
                tool: "isostudy",
                version: env!("CARGO_PKG_VERSION"),
                study: &self.study.file.study.id,
                study_sha256: sha256(&std::fs::read(&self.study.path)?),
                seed: self.study.file.study.seed,
                // How busy the machine is now says nothing about results made earlier.
                machine: Machine { load: None, ..bench::read_machine() },
                files: files.collect(),
            };
            let json = serde_json::to_string_pretty(&manifest)?;
            writer.write("manifest.json", json.as_bytes())
        })?;
        step.count(stamp.redone);
        step.end();
        Ok(())
    }

    fn render_page(&self) -> Result<String> {
        let mut environment = Environment::new();
        environment.set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?);
        environment.add_template("index.html", TEMPLATE)?;
        let tables: Vec<TableEntry> = self.read_contents(TABLE_CONTENTS)?;
        let figures: Vec<FigureEntry> = self.read_contents(FIGURE_CONTENTS)?;
        let text = environment.get_template("index.html")?.render(context! {
            study => Serde(&self.study.file.study),
            stills => Serde(&self.study.file.stills),
            tables => Serde(&tables),
            figures => Serde(&figures),
            turntables => Serde(&turntable_cards(self.study)),
            pairs => Serde(&pair_cards(self.study)),
            objects => Serde(&self.study.file.objects),
            turntable => Serde(&self.study.file.turntable),
            version => env!("CARGO_PKG_VERSION"),
        })?;
        Ok(text)
    }

    fn read_contents<T: DeserializeOwned>(&self, path: &str) -> Result<T> {
        let text = std::fs::read(self.store.root().join(path)).with_context(|| path.to_owned())?;
        serde_json::from_slice(&text).with_context(|| path.to_owned())
    }
}

fn turntable_cards(study: &Study) -> Vec<Card> {
    let (codes, _) = study.code_names();
    let card = |(configuration, code): (&Configuration, String)| Card {
        object: study.object(configuration).id.clone(),
        title: format!("{}: {}", configuration.id, configuration.id.method.label()),
        file: format!("stimuli/turntables/{code}.gif"),
    };
    study.configurations.iter().zip(codes).map(card).collect()
}

fn pair_cards(study: &Study) -> Vec<Card> {
    let (_, codes) = study.code_names();
    let card = |(comparison, code): (&Comparison, String)| Card {
        object: study.file.objects[comparison.object].id.clone(),
        title: format!("{}: {} | {}", comparison.question, comparison.left, comparison.right),
        file: format!("stimuli/pairs/{code}.gif"),
    };
    study.comparisons.iter().zip(codes).map(card).collect()
}
