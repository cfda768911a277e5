//! Statements and comparisons as tables.

use super::allocated::allocations_table;
use super::compare::{Comparison, Row};
use super::counted::counted_table;
use super::differences::{commit, sources};
use super::quiet::warnings;
use super::series::{Verdict, by_configuration};
use super::statements::Statements;
use crate::stage_times::{circumstances, measured, target};
use isostudy_design::Stage;
use isostudy_design::record::{BenchRun, PeakMemory};
use isostudy_statistics::interval::Interval;
use isostudy_table::digits::MINUS;
use isostudy_table::{Cell, Table};

const MS: f64 = 1e3;

/// A run's statements: medians, ratios within the run, outliers, and what to know of machine and noise.
pub fn statement_tables(run: &BenchRun, statements: &Statements) -> Vec<Table> {
    let mut tables = tables(run, statements, |_| true);
    tables.push(allocations_table(run));
    tables.retain(|table| !table.rows.is_empty());
    tables
}

/// Those of them that a terminal has room for: ratios of totals alone, and allocations without their stages.
pub fn statement_tables_in_short(run: &BenchRun, statements: &Statements) -> Vec<Table> {
    tables(run, statements, |stage| stage == Stage::Total)
}

fn tables(run: &BenchRun, statements: &Statements, with_ratios_of: fn(Stage) -> bool) -> Vec<Table> {
    let mut tables = vec![
        medians(run, statements),
        counted_table(run),
        ratios(statements, with_ratios_of),
        outliers(statements),
    ];
    tables.retain(|table| !table.rows.is_empty());
    tables
}

fn medians(run: &BenchRun, statements: &Statements) -> Table {
    let mut columns = vec![
        ("id", "Id"),
        ("samples", "Samples"),
        ("total_ms", "Total, ms"),
        ("total_low_ms", "from"),
        ("total_high_ms", "to"),
    ];
    columns.extend([
        ("allocation_ms", "Allocation"),
        ("sampling_ms", "Sampling"),
        ("vertex_ms", "Vertex"),
        ("geometry_ms", "Geometry"),
        ("clustering_ms", "Clustering"),
        ("normals_ms", "Normals"),
        ("peak_mib", "Peak memory, MiB"),
        ("extraction_mib", "of it extraction"),
    ]);
    let mut table = Table::new("bench_medians", "Median times", &columns);
    for (id, _) in by_configuration(run) {
        let of = |stage: Stage| {
            let found = statements.medians.iter().find(|median| median.id == *id && median.stage == stage);
            found.expect("every stage of every configuration has a median")
        };
        let total = of(Stage::Total);
        let end = |end: fn(Interval) -> f64| Cell::number(total.seconds.interval.map(|i| MS * end(i)), 3);
        let mut row = vec![
            Cell::text(id),
            Cell::count(total.samples as u64),
            Cell::Number(MS * total.seconds.median, 3),
            end(|i| i.low),
            end(|i| i.high),
        ];
        row.extend(Stage::ALL[..6].iter().map(|stage| Cell::Number(MS * of(*stage).seconds.median, 3)));
        let memory = statements.memory.iter().find(|memory| memory.id == *id);
        let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
        row.push(Cell::number(memory.map(|m| mib(m.peak_bytes)), 1));
        // Below what making the field had taken before, extraction's own peak is not seen.
        row.push(Cell::number(memory.and_then(PeakMemory::of_extraction).map(mib), 1));
        table.push(row);
    }
    table.notes.push(format!(
        "Over {} Medians with their order-statistic intervals of {:.1} %; medians of stages need not add up to that of the \
         total. Clustering is the edge collapse; integrated clustering is part of the vertex stage.",
        circumstances(run),
        100.0 * statements.medians.iter().map(|median| median.seconds.level).fold(1.0, f64::min)
    ));
    if !statements.memory.is_empty() {
        table.notes.push(
            "Peak memory is the most that was resident in a process that extracts the configuration once, field \
             included; the last column leaves out what was resident before, and is empty where making the field had \
             taken more than extraction."
                .into(),
        );
    }
    table.notes.push(match statements.floor.range(Stage::Total) {
        Some((low, high)) => format!(
            "Noise floor of the totals, from how far the processes of the run lie apart, with {} rounds measured again in an \
             A/A block: {:.1} to {:.1} %.",
            run.aa_iterations,
            percent(low),
            percent(high)
        ),
        None => "No A/A block: the noise floor is not known, and no verdict is given.".into(),
    });
    table.notes.extend(warnings(run));
    table
}

fn ratios(statements: &Statements, of: fn(Stage) -> bool) -> Table {
    let columns = [
        ("stage", "Stage"),
        ("first", "First"),
        ("second", "Second"),
        ("ratio", "second / first"),
        ("low", "from"),
        ("high", "to"),
        ("floor", "Noise up to"),
        ("verdict", "Second is"),
        ("reason", "Why not more"),
    ];
    let mut table = Table::new("bench_ratios", "Configurations against each other", &columns);
    for ratio in statements.ratios.iter().filter(|ratio| of(ratio.stage)) {
        let end = |end: fn(Interval) -> f64| Cell::number(ratio.interval.map(end), 3);
        table.push(vec![
            Cell::text(ratio.stage.label()),
            Cell::text(&ratio.first),
            Cell::text(&ratio.second),
            Cell::Number(ratio.ratio, 3),
            end(|i| i.low),
            end(|i| i.high),
            Cell::number(ratio.floor, 3),
            Cell::text(ratio.judgement.verdict.label()),
            Cell::text(ratio.judgement.reason),
        ]);
    }
    table.notes.push(
        "Medians over rounds of the ratio within a round; 95 % percentile intervals of 2,000 bootstrap resamples of \
         whole rounds; a verdict where the interval lies beyond the stage's noise floor and each third of the run has \
         the same direction."
            .into(),
    );
    table
}

fn outliers(statements: &Statements) -> Table {
    let columns = [
        ("id", "Id"),
        ("outliers", "Outliers"),
        ("median_ms", "Median, ms"),
        ("median_without_ms", "without them"),
        ("change_percent", "change, %"),
    ];
    let mut table = Table::new("bench_outliers", "What outliers do to medians", &columns);
    for effect in &statements.outlier_effects {
        table.push(vec![
            Cell::text(&effect.id),
            Cell::count(effect.outliers as u64),
            Cell::Number(MS * effect.median_s, 3),
            Cell::Number(MS * effect.median_without_s, 3),
            Cell::Number(100.0 * (effect.median_without_s / effect.median_s - 1.0), 2),
        ]);
    }
    table.notes.push(format!(
        "Totals further than {} scaled median absolute deviations from the median. They stay in every statement.",
        super::MAD_LIMIT
    ));
    table
}

/// A comparison: totals with their verdicts, then every stage.
pub fn comparison_tables(a: &BenchRun, b: &BenchRun, comparison: &Comparison) -> Vec<Table> {
    let across = match comparison.across.is_empty() {
        true => String::new(),
        false => " (NOT MEASURED ALIKE)".to_owned(),
    };
    let mut with_cpu = columns(&[]);
    with_cpu.insert(4, ("cpu_ratio", "CPU time, B / A"));
    let mut totals = Table::new("bench_comparison", format!("B against A{across}"), &with_cpu);
    for row in comparison.of_stage(Stage::Total) {
        let mut cells = cells(row, false, &across);
        let cpu_ratio = row.cpu_s.filter(|[a, _]| *a > 0.0).map(|[a, b]| b / a);
        cells.insert(4, Cell::number(cpu_ratio, 3));
        totals.push(cells);
    }
    totals.notes.extend(how(a, b));
    totals.notes.push(builds(a, comparison));
    if !comparison.across.is_empty() {
        totals.notes.push(format!(
            "A and B were not measured alike ({}). A ratio speaks of machines and their settings as much as of programs.",
            comparison.across.join("; ")
        ));
    }
    if a.workloads.is_empty() || b.workloads.is_empty() {
        totals.notes.push(
            "One of them does not tell what was asked of the extractor: see to it that resolutions are the same.".into(),
        );
    }
    if let Some(ratio) = comparison.reference_ratio {
        totals.notes.push(format!(
            "The reference work's time changed by {} from A to B; a change of the machine is no change of the program, and \
             is part of the noise.",
            change(ratio)
        ));
    }
    if !comparison.unmatched.is_empty() {
        let ids: Vec<String> = comparison.unmatched.iter().map(ToString::to_string).collect();
        totals.notes.push(format!("In one of the runs only: {}.", ids.join(", ")));
    }
    if !comparison.changed.is_empty() {
        let ids: Vec<String> = comparison.changed.iter().map(ToString::to_string).collect();
        totals.notes.push(format!(
            "Asked for different extractions (another field, spacing, isovalue or recipe), and left out: {}.",
            ids.join(", ")
        ));
    }
    for (name, run) in [("A", a), ("B", b)] {
        totals.notes.extend(warnings(run).into_iter().map(|warning| format!("{name}: {warning}")));
    }
    totals.notes.push(
        "Ratios of medians, or of means where no more was published; intervals hold for all configurations together at 95 %, \
         and there is none where the rounds are too few for that. A verdict needs an interval beyond the noise (A/A block, \
         load of others, reference work) and the same direction in each third of the runs. \"Smallest detectable\": the smallest slowdown \
         that would have got one; what is smaller cannot be seen in these runs."
            .into(),
    );
    let mut stages = Table::new(
        "bench_comparison_stages",
        format!("B against A, stage by stage{across}"),
        &columns(&[("stage", "Stage")]),
    );
    for row in comparison.rows.iter().filter(|row| row.stage != Stage::Total) {
        stages.push(cells(row, true, &across));
    }
    let mut tables = vec![totals, stages];
    if !comparison.instructions.is_empty() {
        tables.push(instructions(comparison, &across));
    }
    tables
}

fn instructions(comparison: &Comparison, across: &str) -> Table {
    let columns = [
        ("id", "Id"),
        ("a_m", "A, millions"),
        ("b_m", "B, millions"),
        ("ratio", "B / A"),
        ("low", "from"),
        ("high", "to"),
        ("floor", "Noise up to"),
        ("verdict", "B has"),
    ];
    let mut table =
        Table::new("bench_instructions", format!("Instructions of B against A{across}"), &columns);
    for row in &comparison.instructions {
        let end = |end: fn(Interval) -> f64| Cell::number(row.interval.map(end), 5);
        let verdict = match row.verdict {
            Verdict::Slower => "more",
            Verdict::Faster => "fewer",
            Verdict::CannotSay => "cannot say",
        };
        table.push(vec![
            Cell::text(&row.id),
            Cell::Number(1e-6 * row.counts[0], 3),
            Cell::Number(1e-6 * row.counts[1], 3),
            Cell::Number(row.ratio, 5),
            end(|i| i.low),
            end(|i| i.high),
            Cell::Number(row.floor, 5),
            Cell::text(verdict),
        ]);
    }
    table.notes.push("A verdict of its own; how the command ends is decided by times alone.".into());
    table
}

/// How A and B were measured, once where it is the same.
fn how(a: &BenchRun, b: &BenchRun) -> Vec<String> {
    // The machine of a published table is what its profile says.
    let sentence = |run: &BenchRun| match run.imported_from {
        Some(_) => format!("{}.", measured(run)),
        None => circumstances(run),
    };
    let (of_a, of_b) = (sentence(a), sentence(b));
    if of_a == of_b {
        return vec![format!("A and B: {of_a}")];
    }
    if target(a) == target(b) && a.imported_from.is_none() && b.imported_from.is_none() {
        return vec![
            format!("A: {}. B: {}.", measured(a), measured(b)),
            format!("Both on a machine {}.", target(a)),
        ];
    }
    vec![format!("A: {of_a}"), format!("B: {of_b}")]
}

/// What was built, once where it is the same.
fn builds(a: &BenchRun, comparison: &Comparison) -> String {
    if !comparison.builds.is_empty() {
        return format!("Builds and plans differ: {}.", comparison.builds.join("; "));
    }
    let build = &a.machine.build;
    let commit = commit(build).map_or("an unknown commit".into(), |commit| format!("commit {commit}"));
    match sources(build) {
        Some(sources) => {
            format!("Builds and plans are the same: {commit}, sources {sources}, {}.", build.compiler)
        }
        None if build.dirty == Some(false) && build.commit.is_some() => {
            format!("Builds and plans are the same: {commit}, {}.", build.compiler)
        }
        None => format!("Builds and plans are not known to differ: both of {commit}, {}.", build.compiler),
    }
}

fn columns(before: &[(&'static str, &'static str)]) -> Vec<(&'static str, &'static str)> {
    let rest = [
        ("id", "Id"),
        ("a_ms", "A, ms"),
        ("b_ms", "B, ms"),
        ("ratio", "B / A"),
        ("low", "from"),
        ("high", "to"),
        ("floor", "Noise up to"),
        ("smallest_detectable", "Smallest detectable"),
        ("verdict", "B is"),
        ("reason", "Why not more"),
    ];
    [before, &rest].concat()
}

fn cells(row: &Row, with_stage: bool, across: &str) -> Vec<Cell> {
    let end = |end: fn(Interval) -> f64| Cell::number(row.interval.map(end), 3);
    let mut cells = vec![
        Cell::text(&row.id),
        Cell::Number(MS * row.a_s, 3),
        Cell::Number(MS * row.b_s, 3),
        Cell::number(row.ratio, 3),
        end(|i| i.low),
        end(|i| i.high),
        Cell::number(row.floor, 3),
        Cell::number(row.smallest_detectable, 3),
        Cell::text(format!("{}{}", row.judgement.verdict.label(), across.to_lowercase())),
        Cell::text(row.judgement.reason),
    ];
    if with_stage {
        cells.insert(0, Cell::text(row.stage.label()));
    }
    cells
}

fn percent(log_ratio: f64) -> f64 {
    100.0 * (log_ratio.exp() - 1.0)
}

/// `+3.1 %`.
fn change(ratio: f64) -> String {
    let digits = format!("{:+.1} %", 100.0 * (ratio - 1.0));
    digits.replace('-', &MINUS.to_string())
}
