//! What extractions asked of the allocator, stage by stage.

use super::series::by_configuration;
use isostudy_design::record::{Allocations, BenchRun};
use isostudy_design::{ConfigurationId, Stage};
use isostudy_table::{Cell, Columns, Table};

pub(super) const MIB: f64 = (1_u64 << 20) as f64;

/// What one configuration asks for.
pub(super) fn allocations_of<'a>(run: &'a BenchRun, id: &ConfigurationId) -> Option<&'a Allocations> {
    run.allocations.iter().find(|of| of.id == *id)
}

/// Calls and bytes of every stage that asks for anything; no row where nobody counted.
pub(super) fn allocations_table(run: &BenchRun) -> Table {
    let allocations = by_configuration(run).into_iter().filter_map(|(id, _)| allocations_of(run, id));
    let asked = allocations.flat_map(|of| {
        let stages = Stage::ALL.into_iter().filter(|stage| stage.count(&of.calls) > 0);
        stages.map(move |stage| (of, stage))
    });
    let mut table = Columns::over(asked)
        .column("id", "Id", |(of, _)| Cell::text(&of.id))
        .column("stage", "Stage", |(_, stage)| Cell::text(stage.label()))
        .column("allocations", "Allocations", |(of, stage)| Cell::count(stage.count(&of.calls)))
        .quantity("allocated_mib", "Allocated, {}", "MiB", |(of, stage)| {
            Cell::Number(stage.count(&of.bytes) as f64 / MIB, 3)
        })
        .into_table("bench_allocations", "What was asked of the allocator");
    if !table.rows.is_empty() {
        table.notes.push(NOTE.into());
    }
    table
}

/// What the counts are.
pub(super) const NOTE: &str = "Allocations are counted on one thread with new buffers, in extractions that are not timed. They are requests \
     for memory and for pieces of it to become larger or smaller. Allocated memory is what was asked for, given back meanwhile or not.";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;
    use isostudy_design::record::StageCounts;

    #[test]
    fn stages_that_ask_for_something_have_a_row() {
        let study = fixture::study();
        let mut run = fixture::bench_of(&study, 12);
        assert!(allocations_table(&run).rows.is_empty());
        let calls = StageCounts { sampling: 3, normals: 1, total: 5, ..StageCounts::default() };
        let bytes =
            StageCounts { sampling: 3 << 20, normals: 1 << 19, total: 4 << 20, ..StageCounts::default() };
        let id = study.configurations[1].id.clone();
        run.allocations.push(Allocations { id: id.clone(), calls, bytes });
        let csv = allocations_table(&run).to_csv();
        let lines: Vec<&str> = csv.lines().filter(|line| !line.starts_with('#')).collect();
        let rows = [("sampling", 3, "3"), ("normals", 1, "0.5"), ("total", 5, "4")];
        let rows = rows.map(|(stage, calls, mib)| format!("{id},{stage},{calls},{mib}"));
        assert_eq!(lines, [&["id,stage,allocations,allocated_mib".to_owned()][..], &rows].concat());
    }
}
