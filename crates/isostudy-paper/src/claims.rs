//! The claims of the published text, computed again.
//!
//! A claim is found by its id; ids that are not known here, and claims about configurations that the study lacks, are
//! left out. Each is computed three times where that makes sense: from the published tables (does the text follow
//! from its own numbers?), from ours as the text defines it, and from ours with the definition put right.

mod meshes;
pub(crate) mod numbers;
mod preferences;
mod setup;
mod shapes;
pub(crate) mod times;

use crate::verdict::{Verdict, prints_alike, relative_difference};
use isostudy_design::Study;
use isostudy_design::published::Claim;
use isostudy_table::{Cell, Columns, Table};
use numbers::Numbers;

/// What a claim comes to.
#[derive(Debug, Clone)]
pub(crate) struct Finding {
    /// From the published tables, by the published definition.
    pub(crate) from_published: Option<f64>,
    /// From our numbers, by the published definition.
    pub(crate) as_published: Option<f64>,
    /// From our numbers, by the right definition; the same unless the reason says otherwise.
    pub(crate) ours: Option<f64>,
    pub(crate) decimals: usize,
    /// What the verdict does not say; may be empty.
    pub(crate) remark: String,
    pub(crate) verdict: Verdict,
}

impl Finding {
    /// Of our number alone.
    fn of(ours: Option<f64>, decimals: usize, verdict: Verdict) -> Self {
        Self { from_published: None, as_published: None, ours, decimals, remark: String::new(), verdict }
    }
}

/// Why numbers differ where nothing is published of the study's objects.
const OTHER_OBJECTS: &str = "on other objects than the text's";

/// The claims that can be computed and what they come to, in the order they are listed.
pub(crate) fn all<'a>(numbers: &Numbers<'a>) -> Vec<(&'a Claim, Finding)> {
    let inputs = &numbers.inputs;
    let tally = inputs.answers.map(|answers| &answers.tally);
    let find = |claim| {
        let found = meshes::find(numbers, claim)
            .or_else(|| times::find(numbers, claim))
            .or_else(|| shapes::find(numbers, claim))
            .or_else(|| tally.and_then(|tally| preferences::find(inputs.study, tally, claim)))
            .or_else(|| setup::find(inputs.study, claim));
        let mut found = found?;
        // The text speaks of its own objects.
        if found.verdict.is_unexplained() && inputs.study.published.benchmark.is_empty() {
            found.verdict = Verdict::differs(OTHER_OBJECTS);
        }
        Some((claim, found))
    };
    inputs.study.published.claims.iter().filter_map(find).collect()
}

/// What is not empty, with semicolons between.
fn joined<const N: usize>(parts: [&str; N]) -> String {
    parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("; ")
}

/// The claims and what they come to, in the order they are listed.
pub(crate) fn table(study: &Study, source: &str, claims: &[(&Claim, Finding)]) -> Option<Table> {
    let mut table = Columns::over(claims)
        .column("id", "Id", |(claim, _)| Cell::text(&claim.id))
        .column("statement", "Claim", |(claim, _)| Cell::text(&claim.statement))
        .column("unit", "Unit", |(claim, _)| Cell::text(&claim.unit))
        .column("published", "Published", |(claim, found)| Cell::number(claim.value, found.decimals))
        .column("from_published_tables", "From its tables", |(_, found)| {
            Cell::number(found.from_published, found.decimals)
        })
        .column("ours_as_published", "Ours, as defined there", |(_, found)| {
            Cell::number(found.as_published, found.decimals)
        })
        .column("ours", "Ours", |(_, found)| Cell::number(found.ours, found.decimals))
        .column("verdict", "Verdict", |(_, found)| Cell::text(found.verdict.label()))
        .column("reason", "Reason", |(_, found)| Cell::text(joined([found.verdict.reason(), &found.remark])))
        .into_table("claims", format!("Claims of the text, {source}"));
    table.notes.push(
        "From its tables: computed from the published tables. Ours, as defined there: from our numbers by the \
         published definition. Ours: by the right definition, where the reason names another."
            .into(),
    );
    table.notes.extend(isostudy_report::region::sentence(study, "Our triangles and their shapes"));
    // Verdict first, the unit with the claim; ids and what follows from the published tables are in the CSV.
    let mut part = table.block("", &["verdict", "statement", "published", "ours", "reason"]);
    part.caption.clone_from(&table.caption);
    for (row, (claim, _)) in part.rows.iter_mut().zip(claims) {
        if !matches!(claim.unit.as_str(), "" | "ratio") {
            row[1] = Cell::text(format!("{} ({})", claim.statement, claim.unit));
        }
    }
    table.parts = vec![part];
    table.unless_empty()
}

/// Equal as printed, else within 3 % for `near`'s reason if there is one, else different for `far`'s.
fn judge(published: f64, ours: f64, decimals: usize, near: Option<&str>, far: &str) -> Verdict {
    match near {
        _ if prints_alike(published, ours, decimals) => Verdict::Equal,
        Some(near) if relative_difference(published, ours) <= 0.03 => Verdict::within("3 %", near),
        _ => Verdict::differs(far),
    }
}

#[cfg(test)]
mod tests;
