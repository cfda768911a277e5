//! A sweep as a section of the report.

use crate::figure::Figure;
use crate::statement::{Block, Section};
use crate::words::counted;
use isostudy_inference::cases::SweepFound;
use isostudy_table::Table;

/// What a sweep found, with its own tables and figures.
pub fn sweep_section(found: &SweepFound, tables: &[Table], figures: &[Figure]) -> Section {
    let cases: u64 = found.pairs.iter().map(|pair| pair.cases).sum();
    let left_out: u64 = found.pairs.iter().map(|pair| pair.left_out).sum();
    let mut said = format!(
        "The sweep has {} of {}. Rows are in sweep/meshes, partitioned by object and method.",
        counted(cases as usize, "case"),
        counted(found.pairs.len(), "pair") + " of an object and a method",
    );
    if left_out > 0 {
        said.push_str(&format!(
            " {} no mesh.",
            if left_out == 1 { "1 has".into() } else { format!("{left_out} have") }
        ));
    }
    let mut blocks = vec![Block::Text(said)];
    blocks.extend(figures.iter().cloned().map(Block::Figure));
    for table in tables {
        let is_first = table.name == "sweep_exponents";
        blocks.push(if is_first { Block::Table(table.clone()) } else { Block::Folded(table.clone()) });
    }
    Section { id: "sweep", heading: "How measures change with resolution and settings", blocks }
}
