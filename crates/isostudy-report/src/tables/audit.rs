//! What the probes found.

use isostudy_inference::audit::Report;
use isostudy_table::{Cell, Table};

/// One row a probe: its finding and the evidence.
pub(super) fn audit_table(reports: &[Report]) -> Table {
    let mut table = Table::new(
        "audit",
        "Probes for defects",
        &[
            ("probe", "Probe"),
            ("question", "Question"),
            ("finding", "Finding"),
            ("p", "p"),
            ("evidence", "Evidence"),
        ],
    );
    for report in reports {
        table.push(vec![
            Cell::text(report.probe.code()),
            Cell::text(report.probe.question()),
            Cell::text(report.finding.label()),
            Cell::p(report.p, 4),
            Cell::text(&report.evidence),
        ]);
    }
    table.notes.push(
        "A probe speaks up at p below 0.01, adjusted for all that it looked at. On simulated studies each finds its own defect \
         and no other: isostudy analyse --self-test. Not answerable is not the same as not there."
            .into(),
    );
    table
}
