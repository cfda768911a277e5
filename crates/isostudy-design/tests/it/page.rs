//! `docs/study-file.md`, read: its tables of keys and its examples.

use std::path::Path;

/// What stands under a heading that names a table of the study file.
#[derive(Debug, Default)]
pub(crate) struct Section {
    /// Such as `objects.field`; empty for the top level, `cpu` for the profile.
    pub(crate) table: String,
    /// What `kind` must be for these keys.
    pub(crate) kind: Option<String>,
    pub(crate) rows: Vec<Row>,
    pub(crate) examples: Vec<String>,
}

/// A line of a table of keys.
#[derive(Debug)]
pub(crate) struct Row {
    pub(crate) key: String,
    pub(crate) holds: String,
    pub(crate) range: String,
    pub(crate) default: String,
}

impl Row {
    pub(crate) fn is_needed(&self) -> bool {
        self.default == "**needed**"
    }

    /// The fixed names of a range, quoted in it; empty if the key holds something else.
    pub(crate) fn names(&self) -> Vec<String> {
        let quoted = self.range.split('`').filter_map(|part| part.strip_prefix('"')?.strip_suffix('"'));
        quoted.map(str::to_owned).collect()
    }
}

/// The sections of the page, in its order.
pub(crate) fn sections() -> Vec<Section> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/study-file.md");
    let page = std::fs::read_to_string(path).unwrap();
    let mut sections: Vec<Section> = Vec::new();
    let mut example: Option<String> = None;
    for line in page.lines() {
        if let Some(text) = &mut example {
            if line == "```" {
                sections.last_mut().expect("examples stand under a heading").examples.extend(example.take());
            } else {
                *text += &format!("{line}\n");
            }
        } else if line == "```toml" {
            example = Some(String::new());
        } else if line.starts_with('#') {
            sections.push(heading(line));
        } else if line.starts_with("| `") {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            let [key, holds, range, default, meaning] = cells[..] else { panic!("five cells: {line}") };
            assert!(!meaning.is_empty() && !holds.is_empty() && !default.is_empty(), "{line}");
            let row = Row {
                key: key.trim_matches('`').into(),
                holds: holds.into(),
                range: range.into(),
                default: default.into(),
            };
            sections.last_mut().expect("tables stand under a heading").rows.push(row);
        }
    }
    sections.retain(|section| !section.rows.is_empty() || !section.examples.is_empty());
    sections
}

fn heading(line: &str) -> Section {
    let mut quoted = line.split('`').skip(1).step_by(2);
    let table = match quoted.next() {
        Some(table) => table.trim_matches(['[', ']']).to_owned(),
        None if line.ends_with("The CPU profile") => "cpu".into(),
        None => String::new(),
    };
    let kind = quoted.next().map(|kind| kind.trim_start_matches("kind = ").trim_matches('"').to_owned());
    Section { table, kind, ..Section::default() }
}
