//! The report as a page and as Markdown. What it says comes from `isostudy-report`; here it is only set.

use super::glossary;
use super::templates::{Picture, caption, environment, fits};
use crate::store::Writer;
use anyhow::Result;
use base64::Engine;
use isostudy_report::report::{Block, Finding};
use isostudy_report::{Figure, Report};
use isostudy_table::Table;
use minijinja::context;
use minijinja::value::Serde;
use serde::{Deserialize, Serialize};

/// What the report says first, for the other page.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::pipeline) struct Abstract {
    /// The lines of the abstract: what each is about, and its text.
    pub(in crate::pipeline) lines: Vec<Line>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::pipeline) struct Line {
    label: String,
    text: String,
}

impl Abstract {
    pub(in crate::pipeline) fn of(report: &Report) -> Self {
        let line = |of: &isostudy_report::report::SummaryLine| Line {
            label: of.label.into(),
            text: unbroken(&of.text),
        };
        Self { lines: report.summary.iter().map(line).collect() }
    }
}

/// A picture of a method on an object.
pub(in crate::pipeline) struct PictureData {
    pub(in crate::pipeline) object: String,
    pub(in crate::pipeline) label: String,
    pub(in crate::pipeline) png: Vec<u8>,
    pub(in crate::pipeline) size: [u32; 2],
}

/// A block as the template sees it.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Piece<'a> {
    Text { text: String },
    Finding { standing: &'static str, class: String, text: String },
    Table(Set<'a>),
    Figure { name: &'a str, caption: &'a str, svg: &'a str },
}

/// A table as the template sees it.
#[derive(Serialize)]
struct Set<'a> {
    name: &'a str,
    caption: &'a str,
    html: String,
    folded: bool,
    fits: bool,
}

#[derive(Serialize)]
struct Part<'a> {
    id: &'static str,
    heading: &'static str,
    /// What stands over its sentences where they are closed at first.
    folded: Option<String>,
    pieces: Vec<Piece<'a>>,
}

/// Sections whose sentences say one by one what the figure and the table of all contrasts show together.
const ONE_BY_ONE: [&str; 3] = ["holds", "depends", "open"];

/// Writes `report.html`, one file that needs no other, and `report.md`, whose pictures are those in `figures/`.
/// `gallery` says whether there is an `index.html` to link to; `pictures` are of one object.
pub(in crate::pipeline) fn write(
    writer: &mut Writer<'_>,
    report: &Report,
    pictures: &[PictureData],
    gallery: bool,
) -> Result<()> {
    let glance = report.sections.iter().any(|section| section.id == "contrasts");
    let parts: Vec<Part<'_>> = report.sections.iter().map(|section| part(section, glance)).collect();
    let picture = |of: &PictureData| Picture {
        source: format!(
            "data:image/png;base64,{}",
            base64::engine::general_purpose::STANDARD.encode(&of.png)
        ),
        label: of.label.clone(),
        alt: format!("{} on the {}", of.label, of.object),
        width: of.size[0],
        height: of.size[1],
    };
    let pictures_set: Vec<Picture> = pictures.iter().map(picture).collect();
    let limits: Vec<String> = report.limits.iter().map(|limit| unbroken(limit)).collect();
    let lead: Vec<String> = report.lead.iter().map(|text| unbroken(text)).collect();
    let page = environment()?.get_template("report.html")?.render(context! {
        title => &report.title,
        lines => Serde(&Abstract::of(report).lines),
        pictures => Serde(&pictures_set),
        caption => pictures.first().map(|of| caption(&of.object)),
        methods_table => Serde(&report.methods.as_ref().map(|table| set(table, false))),
        lead => lead,
        limits => limits,
        parts => Serde(&parts),
        glossary => Serde(&glossary::parts()),
        gallery,
        version => env!("CARGO_PKG_VERSION"),
    })?;
    writer.write("report.html", page.as_bytes())?;
    writer.write("report.md", report.to_markdown().as_bytes())
}

fn part(section: &isostudy_report::report::Section, glance: bool) -> Part<'_> {
    let findings = section.blocks.iter().filter(|block| matches!(block, Block::Finding(_))).count();
    let folded = (glance && ONE_BY_ONE.contains(&section.id) && findings > 0).then(|| match findings {
        1 => "The result in a sentence".to_owned(),
        n => format!("The {n} results in sentences"),
    });
    Part {
        id: section.id,
        heading: section.heading,
        folded,
        pieces: section.blocks.iter().map(piece).collect(),
    }
}

fn piece(block: &Block) -> Piece<'_> {
    match block {
        Block::Text(text) => Piece::Text { text: unbroken(text) },
        Block::Finding(Finding { standing, text }) => {
            let (standing, class) = (standing.label(), standing.label().replace(' ', "-"));
            Piece::Finding { standing, class, text: unbroken(text) }
        }
        Block::Table(table) => Piece::Table(set(table, false)),
        Block::Folded(table) => Piece::Table(set(table, true)),
        Block::Figure(Figure { name, caption, svg, .. }) => Piece::Figure { name, caption, svg },
    }
}

fn set(table: &Table, folded: bool) -> Set<'_> {
    let fits = fits(&table.name);
    let html = if fits { table.to_html_cards() } else { table.to_html() };
    Set { name: &table.name, caption: &table.caption, html, folded, fits }
}

/// With spaces inside numbers at which no line may end.
fn unbroken(text: &str) -> String {
    let mut text = text.replace(" %", "\u{a0}%");
    for sign in [" = ", " < "] {
        text = text.replace(sign, &sign.replace(' ', "\u{a0}"));
    }
    text
}
