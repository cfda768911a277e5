//! Every published number beside ours, with a verdict.

pub(crate) mod benchmark;
mod beside;
mod preferences;

use crate::verdict::Verdict;
use isostudy_inference::inputs::Inputs;
use isostudy_table::{Cell, Table, field};

/// One published number beside ours.
#[derive(Debug, Clone)]
pub(crate) struct Compared {
    /// Which published table.
    pub(crate) source: &'static str,
    /// Which row of it.
    pub(crate) row: String,
    /// Which quantity.
    pub(crate) quantity: String,
    pub(crate) published: f64,
    pub(crate) ours: Option<f64>,
    /// Decimals as printed.
    pub(crate) decimals: usize,
    pub(crate) verdict: Verdict,
}

/// Every comparison, the benchmark's first.
pub(crate) fn all(inputs: &Inputs<'_>) -> Vec<Compared> {
    let mut all = benchmark::compare(inputs);
    all.extend(inputs.answers.into_iter().flat_map(|of| preferences::compare(inputs.study, &of.tally)));
    all
}

/// The comparison number by number, and a summary by quantity; nothing if nothing was published.
pub(crate) fn tables(source: &str, all: &[Compared]) -> Vec<Table> {
    if all.is_empty() {
        return Vec::new();
    }
    let fields = [
        field("table", "Table", |of: &&Compared| Cell::text(of.source)),
        field("row", "Row", |of| Cell::text(&of.row)),
        field("quantity", "Quantity", |of| Cell::text(&of.quantity)),
        field("published", "Published", |of| Cell::Number(of.published, of.decimals)),
        field("ours", "Ours", |of| Cell::number(of.ours, of.decimals)),
        field("verdict", "Verdict", |of| Cell::text(of.verdict.label())),
        field("reason", "Reason", |of| Cell::text(of.verdict.reason())),
    ];
    let caption = format!("Published numbers, {source}, beside ours");
    let mut table = Table::of("comparison", caption, &fields, all);
    table.notes.push(
        "Equal: alike in every printed digit. A tolerance in per cent is relative to the published number."
            .into(),
    );
    let mut tables = vec![summary(all), table];
    tables.extend(beside::table(source, all));
    tables
}

fn summary(all: &[Compared]) -> Table {
    let mut table = Table::new(
        "comparison_summary",
        "Published numbers beside ours: verdicts per quantity",
        &[
            ("table", "Table"),
            ("quantity", "Quantity"),
            ("numbers", "Numbers"),
            ("equal", "Equal"),
            ("within_tolerance", "Within tolerance"),
            ("differs", "Differs"),
            ("not_comparable", "Not comparable"),
        ],
    );
    let mut seen: Vec<(&str, &str)> = Vec::new();
    for compared in all {
        let key = (compared.source, compared.quantity.as_str());
        if !seen.contains(&key) {
            seen.push(key);
        }
    }
    for (source, quantity) in seen {
        let mut counts = [0_u64; 4];
        for compared in all.iter().filter(|c| c.source == source && c.quantity == quantity) {
            counts[match compared.verdict {
                Verdict::Equal => 0,
                Verdict::WithinTolerance { .. } => 1,
                Verdict::Differs { .. } => 2,
                Verdict::NotComparable { .. } => 3,
            }] += 1;
        }
        let mut row = vec![Cell::text(source), Cell::text(quantity), Cell::count(counts.iter().sum())];
        row.extend(counts.map(Cell::count));
        table.push(row);
    }
    table
}

#[cfg(test)]
mod tests;
