//! A comparison in at most ten lines.

use super::compare::{Comparison, Row};
use super::differences::commit;
use super::gate::{Gate, GateResult};
use super::quiet::busy_share;
use super::series::Verdict;
use isostudy_design::Stage;
use isostudy_design::record::BenchRun;
use isostudy_table::digits::counted;
use std::collections::BTreeSet;

/// How many verdicts of a kind are written out.
const LISTED: usize = 4;

/// What was told and what could have been: at most ten lines, the numbers of the totals first.
pub fn brief(
    [a, b]: [&BenchRun; 2],
    comparison: &Comparison,
    gate: &Gate,
    found: &GateResult<'_>,
) -> Vec<String> {
    let totals: Vec<&Row> = comparison.of_stage(Stage::Total).collect();
    let mut lines = vec![heading([a, b], totals.len(), comparison)];
    if comparison.itself {
        lines.push("A and B are the same run: this says nothing of any program.".into());
    }
    for (verdict, word) in [(Verdict::Slower, "Slower"), (Verdict::Faster, "Faster")] {
        lines.extend(verdicts(comparison, verdict).map(|list| format!("{word}: {list}.")));
    }
    let beyond: BTreeSet<_> = found.regressions.iter().map(|row| &row.id).collect();
    if !beyond.is_empty() {
        let limits = format!("{} and {:.3} ms", percent(gate.limits.relative), 1e3 * gate.limits.absolute_s);
        lines.push(format!("Regression on {}: slower by more than {limits}.", configurations(beyond.len())));
    }
    if !found.missing.is_empty() {
        let ids: Vec<String> = found.missing.iter().map(ToString::to_string).collect();
        lines.push(format!("Missing: {} in A and not in B.", ids.join(", ")));
    }
    lines.extend(undecided(&totals));
    let more = comparison.instructions.iter().filter(|row| row.verdict == Verdict::Slower).count();
    let fewer = comparison.instructions.iter().filter(|row| row.verdict == Verdict::Faster).count();
    if more + fewer > 0 {
        lines.push(format!("Instructions: more on {more}, fewer on {fewer}."));
    }
    if let Some(share) = gate.must_tell.filter(|_| !found.blind.is_empty()) {
        let ids = listed(found.blind.iter().map(|row| row.id.to_string()));
        lines.push(format!("Blind: a change of {} would not have been told on {ids}.", percent(share)));
    }
    let load = [a, b].map(|run| percent(busy_share(&run.load)));
    let speed = comparison.reference_ratio.map(|ratio| format!("; reference work {}", change(ratio)));
    lines.push(format!("Load of others: {} in A, {} in B{}.", load[0], load[1], speed.unwrap_or_default()));
    lines
}

fn heading([a, b]: [&BenchRun; 2], totals: usize, comparison: &Comparison) -> String {
    let name = |run: &BenchRun| match &run.imported_from {
        Some(source) => source.clone(),
        None => {
            let commit = commit(&run.machine.build).unwrap_or_else(|| "unknown commit".into());
            format!("{}, {}", short(&commit), counted(run.iterations as usize, "round"))
        }
    };
    let alike = if comparison.across.is_empty() { "" } else { " (NOT MEASURED ALIKE)" };
    format!("B ({}) against A ({}), {}{alike}.", name(b), name(a), configurations(totals))
}

/// Commits by their first digits.
fn short(commit: &str) -> String {
    let (hash, rest) = commit.split_once(' ').map_or((commit, ""), |(hash, rest)| (hash, rest));
    let hash = hash.get(..12).unwrap_or(hash);
    if rest.is_empty() { hash.into() } else { format!("{hash} {rest}") }
}

/// Totals first, then stages of configurations whose total has no such verdict.
fn verdicts(comparison: &Comparison, verdict: Verdict) -> Option<String> {
    let told: Vec<&Row> = comparison.rows.iter().filter(|row| row.judgement.verdict == verdict).collect();
    let total = |row: &&&Row| row.stage == Stage::Total;
    let of_totals: BTreeSet<_> = told.iter().filter(total).map(|row| &row.id).collect();
    let worth = told.iter().filter(|row| row.stage == Stage::Total || !of_totals.contains(&row.id));
    let words = worth.map(|row| {
        let by = row.ratio.map_or_else(String::new, |ratio| format!(" {}", change(ratio)));
        match row.stage {
            Stage::Total => {
                let cpu = row.cpu_s.filter(|[a, _]| *a > 0.0);
                let cpu = cpu.map_or_else(String::new, |[a, b]| format!(" (CPU time {})", change(b / a)));
                format!("{}{by}{cpu}", row.id)
            }
            stage => format!("{}'s {}{by}", row.id, stage.label()),
        }
    });
    (!told.is_empty()).then(|| listed(words))
}

/// How many totals have no verdict, and what would have had one.
fn undecided(totals: &[&Row]) -> Option<String> {
    let silent: Vec<&&Row> =
        totals.iter().filter(|row| row.judgement.verdict == Verdict::CannotSay).collect();
    let first = silent.first()?;
    let mut known: Vec<(f64, &Row)> =
        silent.iter().filter_map(|row| Some((row.smallest_detectable?, **row))).collect();
    known.sort_by(|x, y| x.0.total_cmp(&y.0));
    let count = counted(silent.len(), "total");
    let (Some((least, quietest)), Some((most, loudest))) = (known.first(), known.last()) else {
        return Some(format!("No verdict on {count}: {}.", first.judgement.reason));
    };
    let least = format!("{} on {}", percent(least - 1.0), quietest.id);
    let rest = if known.len() < silent.len() { ", and none on the others" } else { "" };
    Some(match known.len() {
        1 => format!("No verdict on {count}; slower by {least} would have been told{rest}."),
        _ => format!(
            "No verdict on {count}; slower by {least} to {} on {} would have been told{rest}.",
            percent(most - 1.0),
            loudest.id
        ),
    })
}

/// The first of them, and how many more there are.
pub(super) fn listed(words: impl IntoIterator<Item = String>) -> String {
    let mut words: Vec<String> = words.into_iter().collect();
    let more = words.len().saturating_sub(LISTED);
    words.truncate(LISTED);
    let list = words.join(", ");
    if more > 0 { format!("{list} and {more} more") } else { list }
}

fn configurations(count: usize) -> String {
    counted(count, "configuration")
}

/// Two digits of it, or as many as are whole.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    let decimals = usize::from(percent < 9.95 && percent.fract() > 1e-9);
    format!("{percent:.decimals$} %")
}

/// By how much a ratio is off 1.
pub(super) fn change(ratio: f64) -> String {
    format!("{:+.1} %", 100.0 * (ratio - 1.0))
}
