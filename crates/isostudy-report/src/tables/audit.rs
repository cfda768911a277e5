//! What the probes found.

use crate::evidence_of_probes::evidence;
use isostudy_inference::audit::Report;
use isostudy_table::{Cell, Table, field};

/// One row a probe: its finding and the evidence.
pub(super) fn audit_table(reports: &[Report]) -> Table {
    let fields = [
        field("probe", "Probe", |of: &&Report| Cell::text(of.probe.code())),
        field("question", "Question", |of| Cell::text(of.probe.question())),
        field("finding", "Finding", |of| Cell::text(of.finding.label())),
        field("p", "p", |of| Cell::p(of.p, 4)),
        field("evidence", "Evidence", |of| Cell::text(evidence(&of.evidence))),
    ];
    let mut table = Table::of("audit", "Probes for defects", &fields, reports);
    table.notes.push(
        "A probe speaks up at p below 0.01, adjusted for all that it looked at. On simulated studies each finds its own defect \
         and no other: isostudy analyse --self-test. Not answerable is not the same as not there."
            .into(),
    );
    table
}
