//! The page that shows a study.

use super::report::{Abstract, PictureData};
use super::templates::{Picture, environment};
use super::{codes, glossary};
use crate::pipeline::pictures::{self, ShownFirst};
use crate::pipeline::tables::{
    ABSTRACT, FIGURE_CONTENTS, FigureEntry, TABLE_CONTENTS, TableEntry, VOTES, Votes,
};
use crate::pipeline::viewer::Viewer;
use crate::pipeline::{Meshes, Pipeline};
use crate::source_digests;
use crate::store::{Inputs, Stamp};
use crate::terminal::progress::Step;
use anyhow::{Context, Result};
use isostudy_design::config::{SideRule, StillSection};
use isostudy_design::{Comparison, Configuration, ConfigurationId, MethodId};
use isostudy_report::OVERVIEW;
use minijinja::context;
use minijinja::value::Serde;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;

/// A turntable or a pair on the page.
#[derive(Serialize)]
struct Card {
    object: String,
    /// In words.
    title: String,
    /// What tables call it.
    ids: String,
    file: String,
}

/// A still picture on the page.
#[derive(Serialize)]
struct StillCard<'a> {
    #[serde(flatten)]
    still: &'a StillSection,
    width: u32,
    height: u32,
}

impl Pipeline<'_> {
    /// Writes `index.html`. `made` are the stamps of all stages but the meshes' and the viewer's.
    pub(in crate::pipeline) fn page(
        &self,
        meshes: &Meshes,
        made: &[Stamp],
        viewer: Viewer,
        shown: Option<&ShownFirst>,
    ) -> Result<()> {
        let step = Step::begin("page", 1, 1);
        let mut inputs = Inputs::of_sources(source_digests::PAGES).value("study", &self.study.file);
        inputs = inputs.text("viewer", viewer.name());
        for stamp in meshes.stamps().chain(made) {
            inputs = inputs.stamp(stamp);
        }
        let stamp = self.store.stage("page", inputs, |writer| {
            writer.write("index.html", self.render_page(viewer, shown)?.as_bytes())
        })?;
        step.count(stamp.redone);
        step.end();
        Ok(())
    }

    fn render_page(&self, viewer: Viewer, shown: Option<&ShownFirst>) -> Result<String> {
        let said: Abstract = self.read_json(ABSTRACT)?;
        let pictures = shown.map_or(Ok(Vec::new()), |shown| self.page_pictures(shown))?;
        let stills = self.still_cards()?;
        let tables: Vec<TableEntry> = self.read_json(TABLE_CONTENTS)?;
        let figures: Vec<FigureEntry> = self.read_json(FIGURE_CONTENTS)?;
        let forms = self.study.file.forms.as_ref();
        let sides_differ = forms.is_some_and(|forms| forms.sides != SideRule::AsListed);
        let text = environment()?.get_template("index.html")?.render(context! {
            document_title => said.document_title(&self.study.file.study.title, &self.study.file.study.title),
            finding => said.finding(),
            busy => said.busy(),
            lines => Serde(&said.below()),
            overview => OVERVIEW,
            pictures => Serde(&pictures),
            caption => shown.and_then(|shown| self.pictures_caption(shown)),
            glossary => Serde(&glossary::parts()),
            study => Serde(&self.study.file.study),
            stills => Serde(&stills),
            tables => Serde(&tables),
            figures => Serde(&figures),
            turntables => Serde(&self.turntable_cards()),
            pairs => Serde(&self.pair_cards(&self.read_json(VOTES)?)),
            sides_differ => sides_differ,
            viewer => viewer.name(),
            objects => Serde(&self.study.file.objects),
            turntable => Serde(&self.study.file.turntable),
            shown => Serde(&self.shown_size()?),
            version => env!("CARGO_PKG_VERSION"),
        })?;
        let methods = self.study.method_ids();
        Ok(codes::set_whole(&text, &methods.iter().map(MethodId::as_str).collect::<Vec<_>>()))
    }

    fn page_pictures(&self, shown: &ShownFirst) -> Result<Vec<Picture>> {
        let made = self.read_pictures(shown)?;
        let picture = |(configuration, data): (&Configuration, PictureData)| Picture {
            source: pictures::path(configuration),
            alt: format!("{} on the {}", data.label, data.object),
            id: data.id,
            label: data.label,
            width: data.size[0],
            height: data.size[1],
        };
        Ok(self.pictured(shown).into_iter().zip(made).map(picture).collect())
    }

    /// The stills that were made, with their sizes.
    fn still_cards(&self) -> Result<Vec<StillCard<'_>>> {
        let size = |still| -> Result<Option<StillCard<'_>>> {
            let still: &StillSection = still;
            let path = self.store.root().join(format!("figures/{}.png", still.id));
            if !path.exists() {
                return Ok(None);
            }
            let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
            let pixmap =
                isostudy_raster::pixmap_from_png(&bytes).with_context(|| path.display().to_string())?;
            Ok(Some(StillCard { still, width: pixmap.width(), height: pixmap.height() }))
        };
        self.study.file.stills.iter().filter_map(|still| size(still).transpose()).collect()
    }

    fn read_json<T: DeserializeOwned>(&self, path: &str) -> Result<T> {
        let text = std::fs::read(self.store.root().join(path)).with_context(|| path.to_owned())?;
        serde_json::from_slice(&text).with_context(|| path.to_owned())
    }

    /// Those that were made.
    fn turntable_cards(&self) -> Vec<Card> {
        if self.study.shows_films() {
            return Vec::new();
        }
        let (codes, _) = self.study.code_names();
        let card = |(configuration, code): (&Configuration, String)| {
            (!self.has_failed(&configuration.id)).then(|| Card {
                object: self.study.object(configuration).id.clone(),
                title: self.study.method(configuration.id.method).label.clone(),
                ids: configuration.id.to_string(),
                file: format!("stimuli/turntables/{code}.gif"),
            })
        };
        self.study.configurations.iter().zip(codes).filter_map(card).collect()
    }

    /// What a pair shows, and how many liked which.
    fn pair_in_words(&self, comparison: &Comparison, votes: Option<&Votes>) -> String {
        let question = match comparison.question.strip_prefix('Q') {
            Some(number) if number.parse::<u32>().is_ok() => format!("Question {number}"),
            _ => comparison.question.clone(),
        };
        let label = |of: &ConfigurationId| &self.study.method(of.method).label;
        let object = &self.study.file.objects[comparison.object].name;
        let mut text = format!(
            "{question}, {object}: {} (left) beside {}",
            label(&comparison.left),
            label(&comparison.right)
        );
        if let Some(Votes { left, none, right }) = votes.filter(|of| of.left + of.none + of.right > 0) {
            text.push_str(&format!(": {left} left, {right} right, {none} no preference"));
        }
        text
    }

    /// Those that were made.
    fn pair_cards(&self, votes: &BTreeMap<String, Votes>) -> Vec<Card> {
        if self.study.file.forms.as_ref().is_some_and(|forms| !forms.way.is_of_pairs()) {
            return Vec::new();
        }
        let (_, codes) = self.study.code_names();
        let card = |(comparison, code): (&Comparison, String)| {
            let failed = self.has_failed(&comparison.left) || self.has_failed(&comparison.right);
            (!failed).then(|| Card {
                object: self.study.file.objects[comparison.object].id.clone(),
                title: self.pair_in_words(comparison, votes.get(&comparison.question)),
                ids: format!("{} | {}", comparison.left, comparison.right),
                file: format!("stimuli/pairs/{code}.{}", self.pair_ending()),
            })
        };
        self.study.comparisons.iter().zip(codes).filter_map(card).collect()
    }
}
