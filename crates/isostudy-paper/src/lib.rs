//! What Costen (2026) printed: its tables, its claims, and what becomes of them here.
//!
//! This crate alone knows the paper's text. [`Paper::add_tables`] and [`Paper::published`] lead out of it, and give nothing for a study
//! that has none of its objects, lattices and published numbers; [`Paper::unexplained_differences`] is for whoever checks.
//!
//! ```text
//! verdict ── comparison ── claims ── benchmark, recomputed
//! asteroid, lattices, positions: one table each
//! ```

mod asteroid;
mod benchmark;
mod claims;
mod comparison;
mod lattices;
mod positions;
mod recomputed;
mod verdict;

#[cfg(test)]
#[path = "../../isostudy-inference/src/fixture.rs"]
pub mod fixture;

#[cfg(test)]
use isostudy_inference::{Answered, Inputs};

pub use verdict::Verdict;

use claims::numbers::Numbers;
use comparison::Compared;
use isostudy_design::published::Claim;
use isostudy_inference::Results;
use isostudy_report::statement::{Block, Section};
use isostudy_table::Table;

/// The paper beside a study's results: its numbers and its claims, each compared once.
pub struct Paper<'a> {
    numbers: Numbers<'a>,
    compared: Vec<Compared>,
    claims: Vec<(&'a Claim, claims::Finding)>,
}

impl<'a> Paper<'a> {
    /// Compares everything.
    pub fn of(results: &Results<'a>) -> Self {
        let numbers = Numbers::of(&results.inputs);
        Self { compared: comparison::all(&results.inputs), claims: claims::all(&numbers), numbers }
    }

    /// Puts the tables of the paper and about the paper where it has them, among a study's other tables.
    pub fn add_tables(&self, tables: &mut Vec<Table>) {
        let inputs = &self.numbers.inputs;
        let source = &inputs.study.published.source;
        let lattices = inputs.answers.and_then(|answers| lattices::table(inputs.study, &answers.tally));
        insert(tables, "benchmark", asteroid::table(inputs));
        insert(tables, "preference_objects", lattices);
        tables.extend(positions::table(inputs));
        tables.extend(comparison::tables(source, &self.compared));
        tables.extend(claims::table(inputs.study, source, &self.claims));
    }

    /// The section of a report that holds the paper against our numbers, with those of `tables` that belong into it.
    pub fn published(&self, tables: &[Table]) -> Vec<Section> {
        let source = &self.numbers.inputs.study.published.source;
        let mut blocks = recomputed::findings(source, &self.compared, &self.claims);
        blocks.extend(recomputed::failing(&self.claims));
        blocks.extend(benchmark::findings(&self.numbers, &self.claims));
        let own = |name: &&str| tables.iter().find(|table| table.name == **name).cloned();
        blocks.extend(["claims", "benchmark_beside"].iter().filter_map(own).map(Block::Folded));
        vec![Section { id: "published", heading: "What was published, and what is here", blocks }]
    }

    /// Published numbers and claims of the text that ours differ from without a known reason: table, row and quantity of
    /// each, both numbers, and what is known. A study is sound if there are none.
    pub fn unexplained_differences(&self) -> Vec<String> {
        let name =
            |of: String, published: Option<f64>, ours: Option<f64>, decimals: usize, verdict: &Verdict| {
                let [published, ours] = [published, ours].map(|value| match value {
                    Some(value) => format!("{value:.decimals$}"),
                    None => "nothing".into(),
                });
                let reason = verdict.reason();
                verdict
                    .is_unexplained()
                    .then(|| format!("{of}: {published} published, {ours} here; {reason}"))
            };
        let numbers = self.compared.iter().filter_map(|c| {
            let of = format!("{}, {}, {}", c.source, c.row, c.quantity);
            name(of, Some(c.published), c.ours, c.decimals, &c.verdict)
        });
        let claims = self.claims.iter().filter_map(|(claim, found)| {
            let of = format!("claims, {}, {}", claim.id, claim.statement);
            name(of, claim.value, found.ours, found.decimals, &found.verdict)
        });
        numbers.chain(claims).collect()
    }
}

/// After the table of that name, or at the end.
fn insert(tables: &mut Vec<Table>, after: &str, table: Option<Table>) {
    let place = tables.iter().position(|table| table.name == after).map_or(tables.len(), |place| place + 1);
    tables.splice(place..place, table);
}

#[cfg(test)]
mod tests;
