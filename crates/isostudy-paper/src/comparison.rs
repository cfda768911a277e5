//! Every published number beside ours, with a verdict.

pub(crate) mod benchmark;
mod beside;
mod preferences;

use crate::verdict::Verdict;
use isostudy_inference::inputs::Inputs;
use isostudy_table::{Cell, Columns, Table};

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
    let caption = format!("Published numbers, {source}, beside ours");
    let mut table = Columns::over(all)
        .column("table", "Table", |of| Cell::text(of.source))
        .column("row", "Row", |of| Cell::text(&of.row))
        .column("quantity", "Quantity", |of| Cell::text(&of.quantity))
        .column("published", "Published", |of| Cell::Number(of.published, of.decimals))
        .column("ours", "Ours", |of| Cell::number(of.ours, of.decimals))
        .column("verdict", "Verdict", |of| Cell::text(of.verdict.label()))
        .column("reason", "Reason", |of| Cell::text(of.verdict.reason()))
        .into_table("comparison", caption);
    table.notes.push(
        "Equal: alike in every printed digit. A tolerance in per cent is relative to the published number."
            .into(),
    );
    let mut tables = vec![summary(all), table];
    tables.extend(beside::table(source, all));
    tables
}

fn summary(all: &[Compared]) -> Table {
    let mut counts: Vec<((&str, &str), [u64; 4])> = Vec::new();
    for compared in all {
        let key = (compared.source, compared.quantity.as_str());
        let place = counts.iter().position(|(known, _)| *known == key).unwrap_or_else(|| {
            counts.push((key, [0; 4]));
            counts.len() - 1
        });
        counts[place].1[match compared.verdict {
            Verdict::Equal => 0,
            Verdict::WithinTolerance { .. } => 1,
            Verdict::Differs { .. } => 2,
            Verdict::NotComparable { .. } => 3,
        }] += 1;
    }
    Columns::over(counts)
        .column("table", "Table", |((source, _), _)| Cell::text(source))
        .column("quantity", "Quantity", |((_, quantity), _)| Cell::text(quantity))
        .column("numbers", "Numbers", |(_, counts)| Cell::count(counts.iter().sum()))
        .column("equal", "Equal", |(_, counts)| Cell::count(counts[0]))
        .column("within_tolerance", "Within tolerance", |(_, counts)| Cell::count(counts[1]))
        .column("differs", "Differs", |(_, counts)| Cell::count(counts[2]))
        .column("not_comparable", "Not comparable", |(_, counts)| Cell::count(counts[3]))
        .into_table("comparison_summary", "Published numbers beside ours: verdicts per quantity")
}

#[cfg(test)]
mod tests;
