//! Two programs that were timed in turn: is the new one slower?
//!
//! For each configuration and pair of processes the median, over rounds, of the logarithm of new over old: what slows a moment, a round
//! or a process pair's hour down is in both. The means of these medians over pairs of processes have t intervals, since what chance
//! gives a process stays with it and is in all of its rounds alike. Half of the 5 % that intervals may miss is the mean's over all
//! configurations, the other half is shared by the configurations (Bonferroni).
//!
//! Where a build was linked several times, its code in another order each time, a pair of processes takes the next link of both. Pairs of
//! processes of one link are one value then, their mean: what the layout of code gives a link stays with it.
//!
//! Where the times of all together differ, stages say where: how much of OLD's total each one adds. They have verdicts only then and only
//! in that direction, so that they are wrong no more often than the total is.

use super::brief::{change, listed};
use super::series::{Verdict, middle};
use isostudy_design::ConfigurationId;
use isostudy_design::record::{AbPair, AbRun, BenchSample, Failure, Stage};
use isostudy_statistics::interval::Interval;
use isostudy_table::digits::counted;
use isostudy_table::{Cell, Columns, Table};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::collections::BTreeMap;

/// The version of [`AbComparison`] as JSON.
pub const AB_SCHEMA: u32 = 3;
/// The chance that any interval of a quantity misses.
const MISSES: f64 = 0.05;

/// What of an extraction is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// The total time.
    Time,
    /// CPU time over all threads.
    CpuTime,
    /// Instructions retired.
    Instructions,
}

impl Quantity {
    const ALL: [Self; 3] = [Self::Time, Self::CpuTime, Self::Instructions];

    /// The word for it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Time => "total time",
            Self::CpuTime => "CPU time",
            Self::Instructions => "instructions",
        }
    }

    fn of(self, sample: &BenchSample) -> Option<f64> {
        match self {
            Self::Time => Some(sample.total_s),
            Self::CpuTime => sample.counters.cpu_s,
            Self::Instructions => sample.counters.instructions.map(|count| count as f64),
        }
    }
}

/// What a run of two programs says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AbComparison {
    /// Version of this layout; [`AB_SCHEMA`].
    pub schema: u32,
    /// Whether both files are the same, byte for byte.
    pub same_program: bool,
    /// Links of OLD and of NEW.
    pub links: [u32; 2],
    /// Time first, and first of each quantity that of all configurations together.
    pub rows: Vec<AbRow>,
    /// What each stage adds to the time of all configurations together, in the order of the stages.
    pub stages: Vec<AbStage>,
    /// Configurations that were left out, and what was said of each.
    pub failed: Vec<Failure>,
}

/// What a stage adds to the time of all configurations together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AbStage {
    /// Which one.
    pub stage: Stage,
    /// NEW's time less OLD's, as a share of OLD's total: these add up to about the growth of the total.
    pub change: f64,
    /// Where it may lie, for all stages together.
    pub interval: Option<Interval>,
    /// What can be said of the stage; [`CannotSay`](Verdict::CannotSay) where the total has no verdict, or the other one.
    pub verdict: Verdict,
}

/// One quantity of one configuration, or of all together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AbRow {
    /// What is compared.
    pub quantity: Quantity,
    /// Of which configuration; `None` for the geometric mean over all.
    pub id: Option<ConfigurationId>,
    /// Rounds in which both measured it.
    pub pairs: usize,
    /// New over old.
    pub ratio: f64,
    /// Where it may lie, for all rows of the quantity together.
    pub interval: Option<Interval>,
    /// The smallest ratio above 1 that would have been told, with an interval as wide as this one.
    pub smallest_detectable: Option<f64>,
    /// What can be said of the new program.
    pub verdict: Verdict,
}

/// Compares the programs of a run.
pub fn ab(run: &AbRun) -> AbComparison {
    let rows: Vec<AbRow> = Quantity::ALL.into_iter().flat_map(|quantity| rows(run, quantity)).collect();
    let total = rows.iter().find(|row| row.quantity == Quantity::Time && row.id.is_none());
    AbComparison {
        schema: AB_SCHEMA,
        same_program: run.old.sha256 == run.new.sha256,
        links: [run.old.links, run.new.links],
        stages: total.map_or_else(Vec::new, |total| stages(run, total.verdict)),
        rows,
        failed: run.failed.clone(),
    }
}

/// Of all configurations together, what each stage adds to the total.
fn stages(run: &AbRun, of_total: Verdict) -> Vec<AbStage> {
    let mut stages = Stage::parts_of(run.pairs.iter().flat_map(|pair| [&pair.old, &pair.new]));
    stages.retain(|stage| *stage != Stage::Total);
    let chance = MISSES / stages.len() as f64;
    let of = |stage: Stage| {
        let share = |pair: &AbPair| (stage.of(&pair.new) - stage.of(&pair.old)) / pair.old.total_s;
        let (_, means) = by_processes(run, |pair| Some(share(pair)).filter(|share| share.is_finite()))?;
        let Estimate { mean, half } = Estimate::of(&independent(run, &means), chance);
        let verdict = match half {
            Some(half) if mean - half > 0.0 && of_total == Verdict::Slower => Verdict::Slower,
            Some(half) if mean + half < 0.0 && of_total == Verdict::Faster => Verdict::Faster,
            _ => Verdict::CannotSay,
        };
        let interval = half.map(|half| Interval { low: mean - half, high: mean + half });
        Some(AbStage { stage, change: mean, interval, verdict })
    };
    stages.into_iter().filter_map(of).collect()
}

/// Both builds have so many links, or one of them has.
fn links(run: &AbRun) -> u32 {
    run.old.links.max(run.new.links).max(1)
}

/// Values of pairs of processes as values that know nothing of each other: of each link the mean.
fn independent(run: &AbRun, of_processes: &BTreeMap<u32, f64>) -> Vec<f64> {
    let mut of_links = BTreeMap::<u32, Vec<f64>>::new();
    let links = links(run);
    for (&at, &value) in of_processes {
        // Where there is one link, each pair of processes is by itself.
        let link = if links > 1 { at % links } else { at };
        of_links.entry(link).or_default().push(value);
    }
    of_links.values().map(|values| values.iter().sum::<f64>() / values.len() as f64).collect()
}

/// By configuration and pair of processes, the median over rounds.
type Medians<'a> = Vec<(&'a ConfigurationId, BTreeMap<u32, f64>)>;

/// The median over rounds of what `of` says of each pair, by configuration and pair of processes; and the means of these over all
/// configurations, of each pair of processes that has every one. `None` where it says nothing of some pair.
fn by_processes(
    run: &AbRun,
    of: impl Fn(&AbPair) -> Option<f64>,
) -> Option<(Medians<'_>, BTreeMap<u32, f64>)> {
    let mut found = BTreeMap::<&ConfigurationId, BTreeMap<u32, Vec<f64>>>::new();
    for pair in &run.pairs {
        found.entry(&pair.old.id).or_default().entry(pair.old.invocation).or_default().push(of(pair)?);
    }
    let medians: Medians<'_> = found
        .iter()
        .map(|(id, processes)| (*id, processes.iter().map(|(&at, found)| (at, middle(found))).collect()))
        .collect();
    // A pair of processes counts where it has every configuration, as each has.
    let mut sums = BTreeMap::<u32, Vec<f64>>::new();
    for (&at, &median) in medians.iter().flat_map(|(_, medians)| medians) {
        sums.entry(at).or_default().push(median);
    }
    let means: BTreeMap<u32, f64> = sums
        .iter()
        .filter(|(_, found)| found.len() == medians.len())
        .map(|(&at, found)| (at, found.iter().sum::<f64>() / found.len() as f64))
        .collect();
    (!means.is_empty()).then_some((medians, means))
}

/// A mean, and half the width of its t interval; `None` of one value.
struct Estimate {
    mean: f64,
    half: Option<f64>,
}

impl Estimate {
    /// Of an interval that misses with a chance.
    fn of(values: &[f64], chance: f64) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let half = (values.len() > 1).then(|| {
            let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
            let quantile =
                StudentsT::new(0.0, 1.0, n - 1.0).expect("degrees > 0").inverse_cdf(1.0 - chance / 2.0);
            quantile * (variance / n).sqrt()
        });
        Self { mean, half }
    }
}

/// None where some sample has not got the quantity, or it is 0.
fn rows(run: &AbRun, quantity: Quantity) -> Vec<AbRow> {
    let log = |pair: &AbPair| {
        let (old, new) = (quantity.of(&pair.old)?, quantity.of(&pair.new)?);
        (old > 0.0 && new > 0.0).then(|| (new / old).ln())
    };
    let Some((medians, means)) = by_processes(run, log) else { return Vec::new() };
    let chance = MISSES / 2.0 / medians.len() as f64;
    let pairs = |id: &ConfigurationId| run.pairs.iter().filter(|pair| pair.old.id == *id).count();
    let each = medians.iter().map(|(id, medians)| {
        row(quantity, Some((*id).clone()), pairs(id), &independent(run, medians), chance)
    });
    let all = row(quantity, None, run.pairs.len(), &independent(run, &means), MISSES / 2.0);
    [all].into_iter().chain(each).collect()
}

fn row(quantity: Quantity, id: Option<ConfigurationId>, pairs: usize, logs: &[f64], chance: f64) -> AbRow {
    let Estimate { mean, half } = Estimate::of(logs, chance);
    let verdict = match half {
        Some(half) if mean - half > 0.0 => Verdict::Slower,
        Some(half) if mean + half < 0.0 => Verdict::Faster,
        _ => Verdict::CannotSay,
    };
    AbRow {
        quantity,
        id,
        pairs,
        ratio: mean.exp(),
        interval: half.map(|half| Interval { low: (mean - half).exp(), high: (mean + half).exp() }),
        smallest_detectable: half.map(f64::exp),
        verdict,
    }
}

impl AbComparison {
    /// Of one quantity, all together first.
    pub fn of(&self, quantity: Quantity) -> impl Iterator<Item = &AbRow> {
        self.rows.iter().filter(move |row| row.quantity == quantity)
    }

    /// What is more by more than a share: all together, and of each configuration.
    pub fn regressions(&self, quantity: Quantity, relative: f64) -> Vec<&AbRow> {
        let beyond = |row: &&AbRow| row.verdict == Verdict::Slower && row.ratio > 1.0 + relative;
        self.of(quantity).filter(beyond).collect()
    }

    /// Whether growth of all configurations together by a share would have been told.
    pub fn would_tell(&self, quantity: Quantity, share: f64) -> bool {
        let all = self.of(quantity).next().and_then(|row| row.smallest_detectable);
        all.is_some_and(|ratio| ratio <= 1.0 + share)
    }

    /// What was told, and what could have been: ten lines at most.
    pub fn brief(&self, run: &AbRun) -> Vec<String> {
        let count = self.of(Quantity::Time).count().saturating_sub(1);
        let mut lines = vec![format!(
            "NEW against OLD: {} in {} pairs of processes, {} pairs of samples. {}",
            counted(count, "configuration"),
            run.processes,
            run.pairs.len(),
            match self.links {
                [1, 1] =>
                    "Each build is one file: intervals leave out what the layout of code does.".to_owned(),
                [1, new] =>
                    format!("OLD is one file, NEW has {new} links: intervals leave out OLD's layout of code."),
                [old, 1] =>
                    format!("OLD has {old} links, NEW is one file: intervals leave out NEW's layout of code."),
                [links, _] =>
                    format!("Each build has {links} links: the layout of code is in the intervals."),
            }
        )];
        if self.same_program {
            lines.push("NEW and OLD are the same program.".into());
        }
        for quantity in Quantity::ALL {
            let Some(all) = self.of(quantity).next() else { continue };
            lines.push(format!("All together, {}: {}.", quantity.label(), told(all)));
            for (verdict, word) in [(Verdict::Slower, "Slower"), (Verdict::Faster, "Faster")] {
                let found: Vec<String> = self
                    .of(quantity)
                    .filter(|row| row.verdict == verdict)
                    .filter_map(|row| Some(format!("{} {}", row.id.as_ref()?, change(row.ratio))))
                    .collect();
                if quantity == Quantity::Time && !found.is_empty() {
                    lines.push(format!("{word}: {}.", listed(found)));
                }
            }
        }
        let of_stages: Vec<String> = self
            .stages
            .iter()
            .filter(|of| of.verdict != Verdict::CannotSay)
            .map(|of| format!("{} {}", of.stage.label(), change(1.0 + of.change)))
            .collect();
        if !of_stages.is_empty() {
            lines.push(format!("Of that, in shares of OLD's total: {}.", listed(of_stages)));
        }
        let tellable = self.of(Quantity::Time).filter(|row| row.id.is_some());
        let mut each: Vec<f64> = tellable.filter_map(|row| row.smallest_detectable).collect();
        each.sort_unstable_by(f64::total_cmp);
        if let (Some(least), Some(most)) = (each.first(), each.last()) {
            let [least, most] = [least, most].map(|ratio| 100.0 * (ratio - 1.0));
            lines.push(format!(
                "Of one configuration, from {least:.1} to {most:.1} % on would have been told."
            ));
        }
        if !self.failed.is_empty() {
            let ids = listed(self.failed.iter().map(|failure| failure.id.to_string()));
            lines.push(format!("Failed and left out: {ids}."));
        }
        lines
    }

    /// Every row.
    pub fn table(&self) -> Table {
        let end = |row: &AbRow, end: fn(Interval) -> f64| Cell::number(row.interval.map(end), 3);
        let mut table = Columns::over(&self.rows)
            .column("quantity", "Quantity", |row| Cell::text(row.quantity.label()))
            .column("id", "Id", |row| row.id.as_ref().map_or_else(|| Cell::text("all"), Cell::text))
            .column("pairs", "Pairs", |row| Cell::count(row.pairs as u64))
            .column("ratio", "New / old", |row| Cell::Number(row.ratio, 3))
            .column("low", "from", |row| end(row, |i| i.low))
            .column("high", "to", |row| end(row, |i| i.high))
            .column("smallest_detectable", "Smallest detectable", |row| {
                Cell::number(row.smallest_detectable, 3)
            })
            .column("verdict", "New is", |row| Cell::text(row.verdict.label()))
            .into_table("bench_ab", "New against old");
        let said = |failure: &Failure| format!("{} failed and is left out: {}", failure.id, failure.reason);
        table.notes.extend(self.stages.iter().map(AbStage::in_words));
        table.notes.extend(self.failed.iter().map(said));
        table
    }
}

impl AbStage {
    fn in_words(&self) -> String {
        let percent = |share: f64| format!("{:+.1} %", 100.0 * share);
        let interval = self.interval.map_or_else(String::new, |interval| {
            format!(" ({} to {})", percent(interval.low), percent(interval.high))
        });
        let verdict = match self.verdict {
            Verdict::CannotSay => String::new(),
            verdict => format!(": {}", verdict.label()),
        };
        format!("{} adds {}{interval} of OLD's total{verdict}", self.stage.label(), percent(self.change))
    }
}

fn told(row: &AbRow) -> String {
    let detectable = row.smallest_detectable.map_or_else(
        || "one pair of processes tells nothing".to_owned(),
        |ratio| format!("{:.1} % would have been told", 100.0 * (ratio - 1.0)),
    );
    match row.verdict {
        Verdict::CannotSay => format!("cannot say; {detectable}"),
        verdict => format!("{} by {}; {detectable}", verdict.label(), change(row.ratio)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::simulation::sample;
    use super::*;
    use crate::fixture;
    use isostudy_design::record::AbProgram;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;
    use std::f64::consts::TAU;

    /// A run with pairs that `log` makes of configuration, pair of processes and round.
    fn run(ids: &[&str], processes: u32, rounds: u32, mut log: impl FnMut(usize, u32, u32) -> f64) -> AbRun {
        let template = fixture::bench(&fixture::study());
        let mut pairs = Vec::new();
        for invocation in 0..processes {
            for round in 0..rounds {
                for (place, id) in ids.iter().enumerate() {
                    let id = id.parse().unwrap();
                    let of = |total| sample(&id, invocation, round, place as u32, total, 0.001);
                    let new = of(0.01 * log(place, invocation, round).exp());
                    pairs.push(AbPair { new_first: false, old: of(0.01), new });
                }
            }
        }
        let program = |sha256: &str| AbProgram { path: "isostudy".into(), sha256: sha256.into(), links: 1 };
        AbRun {
            schema: AbRun::SCHEMA,
            study: "made up".into(),
            workloads: Vec::new(),
            old: program("a"),
            new: program("b"),
            warmup: 1,
            processes,
            seed: 1,
            threads: 1,
            pinned: None,
            machine: template.machine,
            pairs,
            load: Vec::new(),
            failed: Vec::new(),
        }
    }

    #[test]
    fn what_was_left_out_is_named_within_ten_lines() {
        let ids = ["ss_bi", "ss_su"];
        let mut made = run(&ids, 4, 3, |place, _, _| if place == 0 { 0.1 } else { -0.1 });
        for (id, why) in
            [("as_bi", "asked by OLD: no"), ("as_su", "x"), ("bs_bi", "x"), ("bs_su", "x"), ("bs_bu", "x")]
        {
            made.failed.push(Failure { id: id.parse().unwrap(), reason: why.into() });
        }
        for pair in &mut made.pairs {
            for sample in [&mut pair.old, &mut pair.new] {
                (sample.counters.cpu_s, sample.counters.instructions) = (Some(0.01), Some(1_000_000));
            }
        }
        made.new.sha256 = made.old.sha256.clone();
        let found = ab(&made);
        let lines = found.brief(&made);
        assert!(lines.len() <= 10, "{lines:?}");
        assert_eq!(lines.last().unwrap(), "Failed and left out: as_bi, as_su, bs_bi, bs_su and 1 more.");
        let notes = found.table().notes;
        assert_eq!(notes[notes.len() - 5], "as_bi failed and is left out: asked by OLD: no");
    }

    /// By hand: medians of three processes are .01, .02 and .06, their mean .03, their standard deviation sqrt(.0007), and R's
    /// `qt(0.9875, 2)` is 6.205347: the half width is 6.205347 * sqrt(.0007 / 3).
    #[test]
    fn the_interval_is_that_of_the_processes_medians() {
        let medians = [0.01, 0.02, 0.06];
        let made =
            run(&["ss_bi"], 3, 3, |_, at, round| medians[at as usize] + [0.0, -0.5, 0.5][round as usize]);
        let found = ab(&made);
        assert_eq!(found.rows.len(), 2, "neither CPU time nor instructions were counted");
        for row in &found.rows {
            let interval = row.interval.unwrap();
            let half = 6.205_346_816_570_732 * (0.0007_f64 / 3.0).sqrt();
            assert!((row.ratio.ln() - 0.03).abs() < 1e-12, "{row:?}");
            assert!(
                (interval.high.ln() - 0.03 - half).abs() < 1e-9
                    && (interval.low.ln() - 0.03 + half).abs() < 1e-9
            );
            assert_eq!(row.verdict, Verdict::CannotSay);
            assert!((row.smallest_detectable.unwrap().ln() - half).abs() < 1e-9);
        }
        assert!(!found.would_tell(Quantity::Time, 0.05) && found.would_tell(Quantity::Time, 0.2));
    }

    /// Half of the normals' time more, which is a tenth of the total; and with it the geometry's a little less.
    #[test]
    fn the_stage_that_grew_is_named_and_no_other() {
        let grown = |share: f64| {
            let mut made =
                run(&["ss_bi", "ss_su"], 6, 3, |_, at, round| 0.0005 * f64::from((at + round) % 3));
            for pair in &mut made.pairs {
                for (sample, more) in [(&mut pair.old, 0.0), (&mut pair.new, share)] {
                    let total = sample.total_s;
                    (sample.normals_s, sample.geometry_s) = (0.2 * total, 0.1 * total);
                    sample.vertex_s = total - sample.normals_s - sample.geometry_s;
                    sample.normals_s += more * total;
                    sample.total_s += more * total;
                }
            }
            ab(&made)
        };
        let found = grown(0.1);
        assert_eq!(found.of(Quantity::Time).next().unwrap().verdict, Verdict::Slower);
        let of = |stage| found.stages.iter().find(|of| of.stage == stage).unwrap();
        assert!((of(Stage::Normals).change - 0.1).abs() < 0.002, "{:?}", found.stages);
        assert_eq!(of(Stage::Normals).verdict, Verdict::Slower);
        assert_eq!(of(Stage::Allocation).verdict, Verdict::CannotSay);
        let sum: f64 = found.stages.iter().map(|of| of.change).sum();
        assert!((sum - 0.1).abs() < 0.002, "{sum}");
        let none = grown(0.0);
        assert!(none.stages.iter().all(|of| of.verdict == Verdict::CannotSay || of.change.abs() < 0.002));
    }

    #[test]
    fn what_is_slower_by_both_is_a_regression() {
        let tremble = |at: u32| 0.001 * f64::from(at % 3);
        let made =
            run(&["ss_bi", "ss_su"], 6, 3, |place, at, _| tremble(at) + if place == 0 { 0.05 } else { 0.0 });
        let found = ab(&made);
        let slower: Vec<_> =
            found.regressions(Quantity::Time, 0.02).iter().map(|row| row.id.clone()).collect();
        assert_eq!(slower, [None, Some("ss_bi".parse().unwrap())]);
        assert_eq!(found.regressions(Quantity::Time, 0.04).len(), 1, "half of it is all together's");
        let lines = found.brief(&made);
        assert!(
            lines.len() <= 10 && lines[1].starts_with("All together, total time: slower by +2.6 %"),
            "{lines:?}"
        );
        let better = ab(&run(&["ss_bi"], 6, 3, |_, at, _| tremble(at) - 0.05));
        assert!(
            better.regressions(Quantity::Time, 0.0).is_empty() && better.rows[0].verdict == Verdict::Faster
        );
    }

    /// Two links, each in two pairs of processes: their means are .02 and .04, and `qt(0.9875, 1)` is 25.4517.
    #[test]
    fn processes_of_one_link_are_one_value() {
        let medians = [0.01, 0.03, 0.03, 0.05];
        let mut made = run(&["ss_bi"], 4, 3, |_, at, _| medians[at as usize]);
        (made.old.links, made.new.links) = (2, 2);
        let found = ab(&made);
        let half = 25.451_699_579_357_04 * (0.0002_f64 / 2.0).sqrt();
        for row in &found.rows {
            assert!((row.ratio.ln() - 0.03).abs() < 1e-12, "{row:?}");
            assert!((row.smallest_detectable.unwrap().ln() - half).abs() < 1e-9, "{row:?}");
        }
        assert!(
            found.brief(&made)[0]
                .ends_with("Each build has 2 links: the layout of code is in the intervals.")
        );
        // One link of the old build, four of the new one: each pair of processes has a layout of its own.
        (made.old.links, made.new.links) = (1, 4);
        assert!(ab(&made).brief(&made)[0].ends_with("intervals leave out OLD's layout of code."));
        assert_eq!(ab(&made).rows, {
            (made.old.links, made.new.links) = (1, 1);
            ab(&made).rows
        });
    }

    #[test]
    fn a_quantity_of_its_own_is_there_where_all_samples_have_it() {
        let mut made = run(&["ss_bi"], 4, 3, |_, _, _| 0.0);
        for (pair, step) in made.pairs.iter_mut().zip(0_u64..) {
            pair.old.counters.instructions = Some(1_000_000);
            pair.new.counters.instructions = Some(1_010_000 + step % 2);
        }
        let found = ab(&made);
        let all = found.of(Quantity::Instructions).next().unwrap();
        assert_eq!(all.verdict, Verdict::Slower, "1 % more instructions, where time says nothing");
        assert_eq!(found.of(Quantity::Time).next().unwrap().verdict, Verdict::CannotSay);
        assert!(
            found.regressions(Quantity::Time, 0.0).is_empty()
                && !found.regressions(Quantity::Instructions, 0.005).is_empty()
        );
        made.pairs[3].new.counters.instructions = None;
        assert_eq!(ab(&made).of(Quantity::Instructions).count(), 0);
    }

    /// Samples that scatter by 10 %, processes by 1 %: of 200 runs of one build at most one in twenty has a verdict.
    #[test]
    fn one_build_is_not_told_from_itself() {
        let mut stream = Pcg64::seed_from_u64(5);
        let mut normal = move || {
            let [a, b]: [f64; 2] = [stream.random_range(f64::EPSILON..1.0), stream.random_range(0.0..1.0)];
            (-2.0 * a.ln()).sqrt() * (TAU * b).cos()
        };
        let mut told = [0; 2];
        for slowdown in [0.0, 0.05] {
            for _ in 0..200 {
                let process: Vec<f64> = (0..32).map(|_| 0.01 * normal()).collect();
                let made = run(&["ss_bi", "ss_su"], 16, 15, |place, at, _| {
                    slowdown + process[2 * at as usize + place] + 0.1 * normal()
                });
                told[usize::from(slowdown > 0.0)] +=
                    usize::from(!ab(&made).regressions(Quantity::Time, 0.0).is_empty());
            }
        }
        assert!(told[0] <= 10, "{told:?}");
        assert!(told[1] >= 190, "5 % is found: {told:?}");
    }
}
