//! Statements and comparisons as tables.

use super::allocated::{MIB, allocations_table};
use super::compare::{Comparison, Row};
use super::counted::{InstructionRow, counted_table};
use super::differences::{commit, sources};
use super::quiet::warnings;
use super::ratios::Ratio;
use super::series::{Verdict, by_configuration};
use super::stage_columns::with_stages;
use super::statements::Statements;
use crate::stage_times::{circumstances, measured, target};
use isostudy_design::record::{BenchRun, PeakMemory};
use isostudy_design::{ConfigurationId, Stage};
use isostudy_statistics::interval::Interval;
use isostudy_table::digits::MINUS;
use isostudy_table::{Cell, Columns, Table};

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
    let of = |id: &ConfigurationId, stage: Stage| {
        let found = statements.medians.iter().find(|median| median.id == *id && median.stage == stage);
        found.expect("every stage of every configuration has a median")
    };
    let end = |id: &ConfigurationId, end: fn(Interval) -> f64| {
        Cell::number(of(id, Stage::Total).seconds.interval.map(|i| MS * end(i)), 3)
    };
    let memory = |id: &ConfigurationId, bytes: fn(&PeakMemory) -> Option<u64>| {
        let found = statements.memory.iter().find(|memory| memory.id == *id);
        Cell::number(found.and_then(bytes).map(|bytes| bytes as f64 / MIB), 1)
    };
    let columns = Columns::over(by_configuration(run).into_iter().map(|(id, _)| id))
        .column("id", "Id", |id| Cell::text(id))
        .column("samples", "Samples", |id| Cell::count(of(id, Stage::Total).samples as u64))
        .quantity("total_ms", "Total, {}", "ms", |id| {
            Cell::Number(MS * of(id, Stage::Total).seconds.median, 3)
        })
        .quantity("total_low_ms", "from", "ms", |id| end(id, |i| i.low))
        .quantity("total_high_ms", "to", "ms", |id| end(id, |i| i.high));
    let mut columns = with_stages(columns, |id, stage| of(id, Stage::ALL[stage]).seconds.median);
    let finishing = |id: &ConfigurationId| {
        statements.medians.iter().find(|median| median.id == *id && median.stage == Stage::Finishing)
    };
    if statements.medians.iter().any(|median| median.stage == Stage::Finishing) {
        columns = columns.quantity("finishing_ms", "Finishing", "ms", |id| {
            Cell::number(finishing(id).map(|median| MS * median.seconds.median), 3)
        });
    }
    let mut table = columns
        .quantity("peak_mib", "Peak memory, {}", "MiB", |id| memory(id, |memory| Some(memory.peak_bytes)))
        // Below what making the field had taken before, extraction's own peak is not seen.
        .quantity("extraction_mib", "of it extraction", "MiB", |id| memory(id, PeakMemory::of_extraction))
        .into_table("bench_medians", "Median times");
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
    let end = |ratio: &Ratio, end: fn(Interval) -> f64| Cell::number(ratio.interval.map(end), 3);
    let rows: Vec<&Ratio> = statements.ratios.iter().filter(|ratio| of(ratio.stage)).collect();
    let table = Columns::over(&rows)
        .column("stage", "Stage", |ratio| Cell::text(ratio.stage.label()))
        .column("first", "First", |ratio| Cell::text(&ratio.first))
        .column("second", "Second", |ratio| Cell::text(&ratio.second))
        .column("ratio", "second / first", |ratio| Cell::Number(ratio.ratio, 3))
        .column("low", "from", |ratio| end(ratio, |i| i.low))
        .column("high", "to", |ratio| end(ratio, |i| i.high))
        .column("floor", "Noise up to", |ratio| Cell::number(ratio.floor, 3))
        .column("verdict", "Second is", |ratio| Cell::text(ratio.judgement.verdict.label()))
        .column("reason", "Why not more", |ratio| Cell::text(ratio.judgement.reason))
        .into_table("bench_ratios", "Configurations against each other");
    table.with_note(
        "Medians over rounds of the ratio within a round; 95 % percentile intervals of 2,000 bootstrap resamples of \
         whole rounds; a verdict where the interval lies beyond the stage's noise floor and each third of the run has \
         the same direction.",
    )
}

fn outliers(statements: &Statements) -> Table {
    let table = Columns::over(&statements.outlier_effects)
        .column("id", "Id", |effect| Cell::text(&effect.id))
        .column("outliers", "Outliers", |effect| Cell::count(effect.outliers as u64))
        .quantity("median_ms", "Median, {}", "ms", |effect| Cell::Number(MS * effect.median_s, 3))
        .quantity("median_without_ms", "without them", "ms", |effect| {
            Cell::Number(MS * effect.median_without_s, 3)
        })
        .quantity("change_percent", "change, {}", "%", |effect| {
            Cell::Number(100.0 * (effect.median_without_s / effect.median_s - 1.0), 2)
        })
        .into_table("bench_outliers", "What outliers do to medians");
    table.with_note(format!(
        "Totals further than {} scaled median absolute deviations from the median. They stay in every statement.",
        super::MAD_LIMIT
    ))
}

/// A comparison: totals with their verdicts, then every stage.
pub fn comparison_tables(a: &BenchRun, b: &BenchRun, comparison: &Comparison) -> Vec<Table> {
    let across = match comparison.across.is_empty() {
        true => String::new(),
        false => " (NOT MEASURED ALIKE)".to_owned(),
    };
    let times = of_times(
        Columns::over(comparison.of_stage(Stage::Total)).column("id", "Id", |row| Cell::text(&row.id)),
    )
    .column("ratio", "B / A", |row| Cell::number(row.ratio, 3))
    .column("cpu_ratio", "CPU time, B / A", |row| {
        Cell::number(row.cpu_s.filter(|[a, _]| *a > 0.0).map(|[a, b]| b / a), 3)
    });
    let mut totals = judged(times, &across).into_table("bench_comparison", format!("B against A{across}"));
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
    let rows = comparison.rows.iter().filter(|row| row.stage != Stage::Total);
    let columns = Columns::over(rows).column("stage", "Stage", |row| Cell::text(row.stage.label())).column(
        "id",
        "Id",
        |row| Cell::text(&row.id),
    );
    let times = of_times(columns).column("ratio", "B / A", |row| Cell::number(row.ratio, 3));
    let stages = judged(times, &across)
        .into_table("bench_comparison_stages", format!("B against A, stage by stage{across}"));
    let mut tables = vec![totals, stages];
    if !comparison.instructions.is_empty() {
        tables.push(instructions(comparison, &across));
    }
    tables
}

fn instructions(comparison: &Comparison, across: &str) -> Table {
    let end = |row: &InstructionRow, end: fn(Interval) -> f64| Cell::number(row.interval.map(end), 5);
    let verdict = |verdict: Verdict| match verdict {
        Verdict::Slower => "more",
        Verdict::Faster => "fewer",
        Verdict::CannotSay => "cannot say",
    };
    let mut table = Columns::over(&comparison.instructions)
        .column("id", "Id", |row| Cell::text(&row.id))
        .column("a_m", "A, millions", |row| Cell::Number(1e-6 * row.counts[0], 3))
        .column("b_m", "B, millions", |row| Cell::Number(1e-6 * row.counts[1], 3))
        .column("ratio", "B / A", |row| Cell::Number(row.ratio, 5))
        .column("low", "from", |row| end(row, |i| i.low))
        .column("high", "to", |row| end(row, |i| i.high))
        .column("floor", "Noise up to", |row| Cell::Number(row.floor, 5))
        .column("verdict", "B has", |row| Cell::text(verdict(row.verdict)))
        .into_table("bench_instructions", format!("Instructions of B against A{across}"));
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

/// Both times of a row.
fn of_times(columns: Columns<&Row>) -> Columns<&Row> {
    columns.quantity("a_ms", "A, {}", "ms", |row| Cell::Number(MS * row.a_s, 3)).quantity(
        "b_ms",
        "B, {}",
        "ms",
        |row| Cell::Number(MS * row.b_s, 3),
    )
}

/// What can be said of a ratio. Where runs were not measured alike, the verdict says so too.
fn judged<'a>(columns: Columns<&'a Row>, across: &str) -> Columns<&'a Row> {
    let end = |row: &Row, end: fn(Interval) -> f64| Cell::number(row.interval.map(end), 3);
    let across = across.to_lowercase();
    columns
        .column("low", "from", |row| end(row, |i| i.low))
        .column("high", "to", |row| end(row, |i| i.high))
        .column("floor", "Noise up to", |row| Cell::number(row.floor, 3))
        .column("smallest_detectable", "Smallest detectable", |row| Cell::number(row.smallest_detectable, 3))
        .column("verdict", "B is", |row| Cell::text(format!("{}{across}", row.judgement.verdict.label())))
        .column("reason", "Why not more", |row| Cell::text(row.judgement.reason))
}

fn percent(log_ratio: f64) -> f64 {
    100.0 * (log_ratio.exp() - 1.0)
}

/// `+3.1 %`.
fn change(ratio: f64) -> String {
    let digits = format!("{:+.1} %", 100.0 * (ratio - 1.0));
    digits.replace('-', &MINUS.to_string())
}
