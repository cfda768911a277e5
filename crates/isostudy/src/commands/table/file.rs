//! Tables in files.

use crate::input;
use anyhow::{Context, Result, bail};
use isostudy_cells::{Cell, Table};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A table as a file has it.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    /// The cube's if not given.
    corners: Option<Vec<[i32; 3]>>,
    /// By corners inside, one bit each: triangles of three edges of two corners.
    entries: Vec<Vec<[[u8; 2]; 3]>>,
}

/// The table in a file.
///
/// # Errors
/// If it cannot be read, or is none, naming the file and the entry.
pub(super) fn read(path: &Path) -> Result<Table> {
    let name = || path.display().to_string();
    let text = input::text(path)?;
    parse(&text).with_context(name)
}

fn parse(text: &str) -> Result<Table> {
    let written: Written = serde_json::from_str(text)?;
    let cell = match &written.corners {
        None => Cell::cube(),
        Some(corners) => Cell::try_new(corners).context("corners")?,
    };
    let edge = |ends: [u8; 2]| {
        let [a, b] = ends;
        let found = cell.edges().iter().position(|&e| e == [a.min(b), a.max(b)]);
        found.map(|e| e as u8).with_context(|| format!("no edge of the cell joins the corners {a} and {b}"))
    };
    let mut entries = Vec::with_capacity(written.entries.len());
    for (number, entry) in written.entries.iter().enumerate() {
        let triangles: Result<Vec<[u8; 3]>> =
            entry.iter().map(|&[a, b, c]| Ok([edge(a)?, edge(b)?, edge(c)?])).collect();
        entries.push(triangles.with_context(|| format!("entries[{number}]"))?);
    }
    Ok(Table::try_new(cell, entries)?)
}

/// A table as a file has it.
///
/// # Errors
/// If there are several.
pub(super) fn write(tables: &[Table]) -> Result<String> {
    let [table] = tables else {
        bail!("a lattice of tetrahedra has {} tables; a file has one", tables.len())
    };
    let edge = |e: u8| table.cell().edges()[usize::from(e)];
    let entries = table
        .entries()
        .iter()
        .map(|entry| entry.iter().map(|triangle| triangle.map(edge)).collect())
        .collect();
    Ok(serde_json::to_string(&Written { corners: Some(table.cell().corners().to_vec()), entries })?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_extract::presets;

    #[test]
    fn what_is_written_is_read_again() {
        for id in ["mc", "mc-edge-groups"] {
            let tables = presets().iter().find(|preset| preset.id == id).unwrap().method.tables();
            assert_eq!(parse(&write(&tables).unwrap()).unwrap(), tables[0]);
        }
    }

    #[test]
    fn what_is_no_table_is_refused_by_its_entry() {
        let tables = presets().iter().find(|preset| preset.id == "mc").unwrap().method.tables();
        let text = write(&tables).unwrap();
        let of = |bad: &str| format!("{:#}", parse(bad).unwrap_err());
        let other = text.replacen("[[[0,1],[0,2],[0,4]]]", "[[[0,1],[0,2],[0,7]]]", 1);
        let error = if other == text { text.replacen("[[[0,", "[[[7,", 1) } else { other };
        assert!(of(&error).contains("entries[1]"), "{}", of(&error));
        assert!(of("{\"entries\": []}").contains("0 entries; there must be 256"));
        assert!(of("{\"corners\": [[0,0,0]], \"entries\": []}").contains("corners"));
        assert!(of("{\"entry\": []}").contains("entries"));
    }
}
