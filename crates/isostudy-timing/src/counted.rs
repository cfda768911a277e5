//! What was counted beside time: medians within a run, and instructions as a verdict of their own between two.

use super::allocated::{self, MIB, allocations_of};
use super::series::{Verdict, by_configuration, middle, of};
use isostudy_design::ConfigurationId;
use isostudy_design::record::{Allocations, BenchRun, BenchSample, Counters};
use isostudy_statistics::interval::Interval;
use isostudy_statistics::median;
use isostudy_table::{Cell, Columns, Table};
use serde::Serialize;
use std::collections::BTreeMap;

/// The chance that any one interval misses, over all configurations together (Bonferroni).
const MISSES: f64 = 0.05;

/// Name, heading, unit, its factor, decimals, and where it stands.
type Column = (&'static str, &'static str, &'static str, f64, usize, fn(&Counters) -> Option<f64>);

/// Told of programs alone.
const OUTSIDE: &str = "outside_ms";

const COLUMNS: [Column; 8] = [
    ("cpu_ms", "CPU time, {}", "ms", 1e3, 3, |c| c.cpu_s),
    ("page_faults", "Page faults", "", 1.0, 1, |c| c.page_faults.map(|n| n as f64)),
    ("context_switches", "Context switches", "", 1.0, 1, |c| c.context_switches.map(|n| n as f64)),
    ("instructions_m", "Instructions, {}", "millions", 1e-6, 3, |c| c.instructions.map(|n| n as f64)),
    ("cache_misses_k", "Cache misses, {}", "thousands", 1e-3, 3, |c| c.cache_misses.map(|n| n as f64)),
    ("branch_misses_k", "Wrong predictions, {}", "thousands", 1e-3, 3, |c| c.branch_misses.map(|n| n as f64)),
    ("energy_mj", "Energy, {}", "mJ", 1e3, 3, |c| c.energy_j),
    (OUTSIDE, "From outside, {}", "ms", 1e3, 3, |c| c.outside_s),
];

/// Medians of what was counted, by configuration; no row where nothing was.
pub(super) fn counted_table(run: &BenchRun) -> Table {
    let median = |samples: &[&BenchSample], of: fn(&Counters) -> Option<f64>| -> Option<f64> {
        let counted: Option<Vec<f64>> = samples.iter().map(|sample| of(&sample.counters)).collect();
        counted.map(|counted| middle(&counted))
    };
    let series = by_configuration(run);
    let told = |column: &&Column| series.iter().any(|(_, samples)| median(samples, column.5).is_some());
    let (there, missing): (Vec<&Column>, Vec<&Column>) = COLUMNS.iter().partition(told);
    let has_programs = there.iter().any(|column| column.0 == OUTSIDE);
    let missing: Vec<&Column> = missing.into_iter().filter(|column| column.0 != OUTSIDE).collect();
    let has_allocations = !run.allocations.is_empty();
    let asked = |id: &ConfigurationId, of: fn(&Allocations) -> f64| allocations_of(run, id).map(of);
    let mut table = Columns::over(&series)
        .column("id", "Id", |(id, _)| Cell::text(id))
        .columns_of(&there, |all, (name, heading, unit, factor, decimals, of)| {
            all.quantity(*name, heading, unit, |(_, samples)| {
                Cell::number(median(samples, *of).map(|median| factor * median), *decimals)
            })
        })
        .columns_if(has_allocations, |all| {
            all.column("allocations", "Allocations", |(id, _)| {
                Cell::number(asked(id, |of| of.calls.total as f64), 0)
            })
            .quantity("allocated_mib", "Allocated, {}", "MiB", |(id, _)| {
                Cell::number(asked(id, |of| of.bytes.total as f64 / MIB), 3)
            })
            .quantity("peak_mib", "Peak of extraction, {}", "MiB", |(id, _)| {
                Cell::number(peak_of_extraction(run, id).map(|bytes| bytes as f64 / MIB), 1)
            })
        })
        .into_table("bench_counters", "What was counted beside time");
    if there.is_empty() && !has_allocations {
        table.rows.clear();
        return table;
    }
    if !there.is_empty() {
        table.notes.push(
            "Medians over the samples. CPU time, page faults and the CPU's counters are of all threads of the measuring process; context \
             switches of the one that extracts; energy of the whole package."
                .into(),
        );
    }
    if has_programs {
        table.notes.push(
            "From outside: of a program, from the request to its answer by our clock. The program reads its samples in that time. Its \
             own time stands in the benchmark."
                .into(),
        );
    }
    if has_allocations {
        table.notes.push(allocated::NOTE.into());
    }
    if !missing.is_empty() {
        let names: Vec<&str> =
            missing.iter().map(|column| column.1.split(',').next().unwrap_or_default()).collect();
        table.notes.push(format!("Not told by this system: {}.", names.join(", ").to_lowercase()));
    }
    table
}

/// The most that was resident in a process that extracts a configuration once, without what was resident before; `None` where making
/// the field had taken more than that.
fn peak_of_extraction(run: &BenchRun, id: &ConfigurationId) -> Option<u64> {
    run.memory.iter().find(|memory| memory.id == *id)?.of_extraction()
}

/// Instructions of one configuration in both runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InstructionRow {
    /// Which configuration.
    pub id: ConfigurationId,
    /// Median in A and in B.
    pub counts: [f64; 2],
    /// B over A.
    pub ratio: f64,
    /// Where the ratio may lie, at 95 % for all configurations together.
    pub interval: Option<Interval>,
    /// Ratios up to this are no more than noise: by how much the median of any process lies from its run's, in both runs
    /// together.
    pub floor: f64,
    /// [`Verdict::Slower`] is more of them.
    pub verdict: Verdict,
}

/// Of every configuration whose samples all have a count in both runs.
pub(super) fn instruction_rows(a: &BenchRun, b: &BenchRun, ids: &[&ConfigurationId]) -> Vec<InstructionRow> {
    let level = 1.0 - MISSES / ids.len().max(1) as f64;
    let series = [a, b].map(by_configuration);
    let runs = [a, b];
    let row = |id: &&ConfigurationId| {
        let values = |which: usize| counts(of(&series[which], id)?);
        let (of_a, of_b) = (values(0)?, values(1)?);
        let floor: f64 = (0..2).map(|which| apart(runs[which], id)).sum();
        let [low, high] = [&of_a, &of_b].map(|values| median(values.clone(), level));
        let (of_a, of_b) = (low?, high?);
        let ratio = of_b.median / of_a.median;
        let interval = of_a.interval_at(level).zip(of_b.interval_at(level)).map(|(x, y)| {
            let below = (of_b.median / y.low).ln().hypot((x.high / of_a.median).ln());
            let above = (y.high / of_b.median).ln().hypot((of_a.median / x.low).ln());
            Interval { low: (ratio.ln() - below).exp(), high: (ratio.ln() + above).exp() }
        });
        let verdict = match interval {
            Some(interval) if interval.low.ln() > floor => Verdict::Slower,
            Some(interval) if interval.high.ln() < -floor => Verdict::Faster,
            _ => Verdict::CannotSay,
        };
        let counts = [of_a.median, of_b.median];
        Some(InstructionRow { id: (*id).clone(), counts, ratio, interval, floor: floor.exp(), verdict })
    };
    ids.iter().filter_map(row).collect()
}

fn counts(samples: &[&BenchSample]) -> Option<Vec<f64>> {
    let count = |sample: &&BenchSample| sample.counters.instructions.filter(|count| *count > 0);
    samples.iter().map(|sample| Some(count(sample)? as f64)).collect()
}

/// How far, as a logarithm, the median of any process of a run lies from that of all, the A/A block's too.
fn apart(run: &BenchRun, id: &ConfigurationId) -> f64 {
    let mut processes = BTreeMap::<u32, Vec<f64>>::new();
    for sample in run.samples.iter().chain(&run.aa_samples).filter(|sample| sample.id == *id) {
        let count = sample.counters.instructions.filter(|count| *count > 0);
        processes.entry(sample.invocation).or_default().extend(count.map(|count| count as f64));
    }
    processes.retain(|_, counts| !counts.is_empty());
    let medians: Vec<f64> = processes.values().map(|counts| middle(counts).ln()).collect();
    let centre = middle(&medians);
    medians.iter().map(|median| (median - centre).abs()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    /// Runs with so many instructions by round, and the same in an A/A block.
    fn run(count: impl Fn(u32) -> u64) -> BenchRun {
        let study = fixture::study();
        let mut run = fixture::bench_of(&study, 12);
        run.samples.iter_mut().for_each(|sample| {
            sample.counters.instructions = Some(count(sample.iteration));
            sample.invocation = sample.iteration / 4;
        });
        run
    }

    fn verdicts(a: &BenchRun, b: &BenchRun) -> Vec<Verdict> {
        let ids: Vec<&ConfigurationId> = by_configuration(a).into_iter().map(|(id, _)| id).collect();
        instruction_rows(a, b, &ids).iter().map(|row| row.verdict).collect()
    }

    #[test]
    fn one_percent_more_instructions_are_told_where_processes_agree() {
        let a = run(|round| 1_000_000 + u64::from(round % 3));
        let b = run(|round| 1_010_000 + u64::from(round % 3));
        assert_eq!(verdicts(&a, &b), [Verdict::Slower; 18]);
        assert_eq!(verdicts(&b, &a), [Verdict::Faster; 18]);
        assert_eq!(verdicts(&a, &a), [Verdict::CannotSay; 18]);
        // A process that counts 2 % more of the same program is noise of that size.
        let restless = run(|round| if round < 4 { 1_030_000 } else { 1_010_000 });
        assert_eq!(verdicts(&a, &restless), [Verdict::CannotSay; 18]);
        let mut gap = b.clone();
        gap.samples.iter_mut().for_each(|sample| sample.counters.instructions = None);
        assert_eq!(verdicts(&a, &gap), [], "not counted, not told");
    }

    #[test]
    fn what_is_not_told_has_no_column_and_is_named() {
        let mut some = run(|_| 2_000_000);
        let table = counted_table(&some);
        assert_eq!(table.to_csv().lines().next(), Some("id,instructions_m"));
        assert!(table.to_csv().contains(",2\n"), "{}", table.to_csv());
        let note = "Not told by this system: cpu time, page faults, context switches, cache misses, wrong predictions, energy.";
        assert_eq!(table.notes[1], note);
        some.samples.iter_mut().for_each(|sample| sample.counters = Counters::default());
        assert!(counted_table(&some).rows.is_empty());
        // A program's time from outside is told of programs, and not missed elsewhere.
        some.samples.iter_mut().for_each(|sample| sample.counters.outside_s = Some(0.0035));
        let table = counted_table(&some);
        assert_eq!(table.to_csv().lines().next(), Some("id,outside_ms"));
        assert!(table.to_csv().contains(",3.5\n"), "{}", table.to_csv());
        assert!(table.notes.iter().any(|note| note.starts_with("From outside")), "{:?}", table.notes);
    }
}
