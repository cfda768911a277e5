//! The report as a page and as Markdown. What it says comes from `isostudy-report`; here it is only set.

use super::templates::{Picture, environment, fits};
use super::{codes, glossary};
use crate::store::Writer;
use anyhow::Result;
use base64::Engine;
use isostudy_report::report::{Block, Finding};
use isostudy_report::{Figure, Report};
use isostudy_table::{Cell, Table};
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

/// A finding that is longer than this is no heading: what stands behind a semicolon is left to the abstract.
const LONGEST_HEADING: usize = 140;
/// A document's title that is longer than this is cut by every browser.
const LONGEST_TITLE: usize = 100;

impl Abstract {
    fn line(&self, label: &str) -> Option<&str> {
        self.lines.iter().find(|line| line.label == label).map(|line| line.text.as_str())
    }

    /// What the study found, in its first sentence.
    pub(in crate::pipeline) fn finding(&self) -> Option<String> {
        let text = self.line("Found").or_else(|| self.line("Take"))?;
        let sentence = text.split_inclusive(". ").next().unwrap_or(text).trim();
        let mut clauses = sentence.trim_end_matches('.').split("; ");
        let mut finding = clauses.next()?.to_owned();
        for clause in clauses {
            if finding.chars().count() + clause.chars().count() + 2 > LONGEST_HEADING {
                break;
            }
            finding = format!("{finding}; {clause}");
        }
        Some(format!("{finding}."))
    }

    /// Whether its times can be relied on, where that is not so.
    pub(in crate::pipeline) fn busy(&self) -> Option<&str> {
        self.line("Times")
    }

    /// The lines that a page has below the finding: what is said above it is not said again.
    pub(in crate::pipeline) fn below(&self) -> Vec<&Line> {
        self.lines.iter().filter(|line| line.label != "Times").collect()
    }

    /// What the document is called: the finding and the study, if that is short enough, else `study`.
    pub(in crate::pipeline) fn document_title(&self, title: &str, study: &str) -> String {
        let both = self.finding().map(|finding| format!("{finding} {title}"));
        both.filter(|both| both.chars().count() <= LONGEST_TITLE).unwrap_or_else(|| study.to_owned())
    }

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
    /// What tables call the method.
    pub(in crate::pipeline) id: String,
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
    Figure(Drawing<'a>),
}

/// A figure as the template sees it.
#[derive(Serialize)]
struct Drawing<'a> {
    name: &'a str,
    caption: &'a str,
    svg: &'a str,
    narrow: Option<&'a str>,
}

impl<'a> Drawing<'a> {
    fn of(Figure { name, caption, svg, narrow, .. }: &'a Figure) -> Self {
        Self { name, caption, svg, narrow: narrow.as_deref() }
    }
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
    pieces: Vec<Piece<'a>>,
}

/// Writes `report.html`, one file that needs no other, and `report.md`, whose pictures are those in `figures/`.
/// `overview` is shown before all else; `gallery` says whether there is an `index.html` to link to; `pictures` are of one object, with
/// what stands under them.
pub(in crate::pipeline) fn write(
    writer: &mut Writer<'_>,
    report: &Report,
    overview: Option<&Figure>,
    (pictures, pictures_caption): (&[PictureData], Option<&str>),
    gallery: bool,
) -> Result<()> {
    let parts: Vec<Part<'_>> = report.sections.iter().map(part).collect();
    let picture = |of: &PictureData| Picture {
        source: format!(
            "data:image/png;base64,{}",
            base64::engine::general_purpose::STANDARD.encode(&of.png)
        ),
        id: of.id.clone(),
        label: of.label.clone(),
        alt: format!("{} on the {}", of.label, of.object),
        width: of.size[0],
        height: of.size[1],
    };
    let pictures_set: Vec<Picture> = pictures.iter().map(picture).collect();
    let limits: Vec<String> = report.limits.iter().map(|limit| unbroken(limit)).collect();
    let lead: Vec<String> = report.lead.iter().map(|text| unbroken(text)).collect();
    let said = Abstract::of(report);
    let page = environment()?.get_template("report.html")?.render(context! {
        title => &report.title,
        document_title => said.document_title(&report.title, &format!("{}: report", report.title)),
        finding => said.finding(),
        busy => said.busy(),
        lines => Serde(&said.below()),
        overview => Serde(&overview.map(Drawing::of)),
        pictures => Serde(&pictures_set),
        caption => pictures_caption,
        methods_table => Serde(&report.methods.as_ref().map(|table| set(table, false))),
        lead => lead,
        limits => limits,
        parts => Serde(&parts),
        glossary => Serde(&glossary::parts()),
        gallery,
        version => env!("CARGO_PKG_VERSION"),
    })?;
    let methods = report.methods.iter().flat_map(|table| &table.rows).filter_map(|row| row.first());
    let named: Vec<String> = methods.map(Cell::in_full).collect();
    let page = codes::set_whole(&page, &named.iter().map(String::as_str).collect::<Vec<_>>());
    writer.write("report.html", page.as_bytes())?;
    writer.write("report.md", report.to_markdown().as_bytes())
}

fn part(section: &isostudy_report::report::Section) -> Part<'_> {
    Part { id: section.id, heading: section.heading, pieces: section.blocks.iter().map(piece).collect() }
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
        Block::Figure(figure) => Piece::Figure(Drawing::of(figure)),
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

#[cfg(test)]
mod tests {
    use super::*;

    fn said(label: &str, text: &str) -> Abstract {
        Abstract { lines: vec![Line { label: label.into(), text: text.into() }] }
    }

    #[test]
    fn the_finding_is_the_first_sentence_of_what_was_found() {
        let found =
            said("Found", "People preferred a over b (86\u{a0}%, 0.7 to 0.9). They preferred c over d.");
        assert_eq!(found.finding().unwrap(), "People preferred a over b (86\u{a0}%, 0.7 to 0.9).");
        assert_eq!(said("Found", "One sentence.").finding().unwrap(), "One sentence.");
        assert_eq!(said("Take", "Take a.").finding().unwrap(), "Take a.");
        assert_eq!(said("Next", "Ask people.").finding(), None);
    }

    #[test]
    fn a_long_list_is_cut_between_its_parts() {
        let part = |name: &str| {
            format!("{name} on an object with quite a long name of its own, not shown to differ")
        };
        let text = format!("Shortest time: {}; {}; {}. Next.", part("a"), part("b"), part("c"));
        assert_eq!(said("Found", &text).finding().unwrap(), format!("Shortest time: {}.", part("a")));
        assert_eq!(said("Found", "A: b on c; d on e. Next.").finding().unwrap(), "A: b on c; d on e.");
    }

    #[test]
    fn a_document_is_called_by_what_was_found_where_that_is_short() {
        let found = said("Found", "People preferred a over b.");
        assert_eq!(found.document_title("A study", "A study: report"), "People preferred a over b. A study");
        let long = "x".repeat(80);
        assert_eq!(found.document_title(&long, "as it is"), "as it is");
    }

    #[test]
    fn what_stands_at_the_top_is_not_said_again() {
        let busy = said("Times", "The machine was busy.");
        assert_eq!((busy.busy(), busy.below().len()), (Some("The machine was busy."), 0));
    }
}
