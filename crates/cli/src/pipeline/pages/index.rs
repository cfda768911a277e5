//! The page that shows a study.

use crate::pipeline::tables::{FIGURE_CONTENTS, FigureEntry, TABLE_CONTENTS, TableEntry};
use crate::pipeline::{Meshes, Pipeline};
use crate::source_digests;
use crate::store::{Inputs, Stamp};
use crate::terminal::progress::Step;
use anyhow::{Context, Result};
use design::config::SideRule;
use design::{Comparison, Configuration, Study};
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{Environment, context};
use serde::Serialize;
use serde::de::DeserializeOwned;

const TEMPLATE: &str = include_str!("index.html");

/// A turntable or a pair on the page.
#[derive(Serialize)]
struct Card {
    object: String,
    title: String,
    file: String,
}

impl Pipeline<'_> {
    /// Writes `index.html`. `made` are the stamps of all stages but the meshes'.
    pub(in crate::pipeline) fn page(&self, meshes: &Meshes, made: &[Stamp]) -> Result<()> {
        let step = Step::begin("page", 1, 1);
        let mut inputs = Inputs::of_sources(source_digests::PAGES).value("study", &self.study.file);
        for stamp in meshes.stamps().chain(made) {
            inputs = inputs.stamp(stamp);
        }
        let stamp = self
            .store
            .stage("page", inputs, |writer| writer.write("index.html", self.render_page()?.as_bytes()))?;
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
        let forms = self.study.file.forms.as_ref();
        let sides_differ = forms.is_some_and(|forms| forms.sides != SideRule::AsListed);
        let text = environment.get_template("index.html")?.render(context! {
            study => Serde(&self.study.file.study),
            stills => Serde(&self.study.file.stills),
            tables => Serde(&tables),
            figures => Serde(&figures),
            turntables => Serde(&turntable_cards(self.study)),
            pairs => Serde(&pair_cards(self.study)),
            sides_differ => sides_differ,
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
        title: format!("{}: {}", configuration.id, study.method(configuration.id.method).label),
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
