//! The report as a page and as Markdown. What it says comes from `analysis`; here it is only set.

use crate::store::Writer;
use analysis::report::{Block, Finding};
use analysis::{Figure, Report};
use anyhow::Result;
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{Environment, context};
use serde::Serialize;
use table::Table;

const TEMPLATE: &str = include_str!("report.html");

/// A block as the template sees it.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Piece<'a> {
    Text { text: String },
    Finding { standing: &'static str, class: String, text: String },
    Table { name: &'a str, caption: &'a str, html: String, folded: bool },
    Figure { name: &'a str, caption: &'a str, svg: &'a str },
}

#[derive(Serialize)]
struct Part<'a> {
    id: &'static str,
    heading: &'static str,
    pieces: Vec<Piece<'a>>,
}

/// Writes `report.html`, one file that needs no other, and `report.md`, whose pictures are those in `figures/`.
/// `gallery` says whether there is an `index.html` to link to.
pub(in crate::pipeline) fn write(writer: &mut Writer<'_>, report: &Report, gallery: bool) -> Result<()> {
    let mut environment = Environment::new();
    environment.set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?);
    environment.add_template("report.html", TEMPLATE)?;
    let parts: Vec<Part<'_>> = report
        .sections
        .iter()
        .map(|s| Part { id: s.id, heading: s.heading, pieces: s.blocks.iter().map(piece).collect() })
        .collect();
    let page = environment.get_template("report.html")?.render(context! {
        title => &report.title,
        lead => &report.lead,
        parts => Serde(&parts),
        gallery,
        version => env!("CARGO_PKG_VERSION"),
    })?;
    writer.write("report.html", page.as_bytes())?;
    writer.write("report.md", report.to_markdown().as_bytes())
}

fn piece(block: &Block) -> Piece<'_> {
    match block {
        Block::Text(text) => Piece::Text { text: unbroken(text) },
        Block::Finding(Finding { standing, text }) => {
            let (standing, class) = (standing.label(), standing.label().replace(' ', "-"));
            Piece::Finding { standing, class, text: unbroken(text) }
        }
        Block::Table(table) | Block::Folded(table) => {
            let Table { name, caption, .. } = table;
            Piece::Table { name, caption, html: table.to_html(), folded: matches!(block, Block::Folded(_)) }
        }
        Block::Figure(Figure { name, caption, svg, .. }) => Piece::Figure { name, caption, svg },
    }
}

/// With spaces inside numbers at which no line may end.
fn unbroken(text: &str) -> String {
    let mut text = text.replace(" %", "\u{a0}%");
    for sign in [" = ", " < "] {
        text = text.replace(sign, &sign.replace(' ', "\u{a0}"));
    }
    text
}
