//! What the probes found.

use crate::evidence_of_probes::evidence;
use isostudy_inference::audit::Report;
use isostudy_table::{Cell, Columns, Table};

/// One row a probe: its finding and the evidence.
pub(super) fn audit_table(reports: &[Report]) -> Table {
    let table = Columns::over(reports)
        .column("probe", "Probe", |of| Cell::text(of.probe.code()))
        .column("question", "Question", |of| Cell::text(of.probe.question()))
        .column("finding", "Finding", |of| Cell::text(of.finding.label()))
        .column("p", "p", |of| Cell::p(of.p, 4))
        .column("evidence", "Evidence", |of| Cell::text(evidence(&of.evidence)))
        .into_table("audit", "Probes for defects");
    table.with_note(
        "A probe speaks up at p below 0.01, adjusted for all that it looked at. On simulated studies each finds its own defect \
         and no other: isostudy analyse --self-test. Not answerable is not the same as not there.",
    )
}
