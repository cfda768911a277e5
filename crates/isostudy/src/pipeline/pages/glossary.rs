//! The glossary of the documentation, on the pages: one list of words for both.

use serde::Serialize;

/// The page of the documentation.
const TEXT: &str = include_str!("../../../../../docs/glossary.md");

/// Words under a heading.
#[derive(Serialize)]
pub(super) struct Part {
    heading: &'static str,
    entries: Vec<Entry>,
}

#[derive(Serialize)]
struct Entry {
    /// HTML, as is the meaning.
    word: String,
    meaning: String,
}

/// Every word, in the order of the page.
pub(super) fn parts() -> Vec<Part> {
    let mut parts: Vec<Part> = Vec::new();
    for line in TEXT.lines() {
        if let Some(heading) = line.strip_prefix("## ") {
            parts.push(Part { heading, entries: Vec::new() });
        }
        let cells = line.strip_prefix("| ").and_then(|rest| rest.strip_suffix(" |")?.split_once(" | "));
        let (Some((word, meaning)), Some(part)) = (cells, parts.last_mut()) else { continue };
        if word != "word" {
            part.entries.push(Entry { word: html(word), meaning: html(meaning) });
        }
    }
    parts
}

/// What stands between stars is an entry of its own, what stands between grave accents is code.
fn html(text: &str) -> String {
    let escaped = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let marked = between(&escaped, '`', "code");
    between(&marked, '*', "em")
}

fn between(text: &str, mark: char, tag: &str) -> String {
    let parts: Vec<&str> = text.split(mark).collect();
    if parts.len().is_multiple_of(2) {
        return text.to_owned();
    }
    let wrap = |(i, part): (usize, &&str)| match i % 2 {
        0 => (*part).to_owned(),
        _ => format!("<{tag}>{part}</{tag}>"),
    };
    parts.iter().enumerate().map(wrap).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_the_page_is_an_entry() {
        let parts = parts();
        let rows =
            TEXT.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| word |")).count();
        assert_eq!(parts.iter().map(|part| part.entries.len()).sum::<usize>(), rows);
        assert!(rows > 50 && parts.len() == 3);
        let isosurface = parts[0].entries.iter().find(|entry| entry.word == "isosurface").unwrap();
        assert_eq!(
            isosurface.meaning,
            "All points where the <em>scalar field</em> has the <em>isovalue</em>."
        );
    }
}
