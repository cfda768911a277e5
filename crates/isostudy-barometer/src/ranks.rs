//! Engines in order.
//!
//! A score is the geometric mean, over workloads, of an engine's number over the least of all compared engines there: 1 is first
//! everywhere. Only workloads count that all compared engines passed. Intervals resample surfaces, since these are what a reader's own
//! work differs in; workloads of one surface stay together. Two engines are distinguished where the interval of the ratio of their scores
//! leaves 1 out, and what one engine differs from itself by. All that lies between two engines that are not distinguished shares their rank.

use std::collections::{BTreeMap, BTreeSet};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::Serialize;

use crate::recording::{Row, State};

/// How often workloads are drawn again.
const DRAWS: usize = 4000;
/// Fewer surfaces than this are no basis for an interval.
const LEAST_SURFACES: usize = 6;
/// Errors below this, in cells, are rounding.
const LEAST_ERROR: f64 = 1e-3;

/// What engines are ranked by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Seconds.
    Time,
    /// Bytes.
    Memory,
    /// Triangles: fewer is better.
    Triangles,
    /// The mean radius ratio of triangles: more is better.
    RadiusRatio,
    /// The mean distance to the interpolated surface for as many triangles: it falls as their number grows.
    ErrorAtEqualTriangles,
}

impl Quantity {
    /// All, in the order of tables.
    pub const ALL: [Self; 5] =
        [Self::Time, Self::Memory, Self::Triangles, Self::RadiusRatio, Self::ErrorAtEqualTriangles];

    /// As tables name it.
    pub fn words(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Memory => "memory",
            Self::Triangles => "triangles",
            Self::RadiusRatio => "radius ratio",
            Self::ErrorAtEqualTriangles => "error at equal triangles",
        }
    }

    /// A number of which less is better.
    fn of(self, row: &Row) -> Option<f64> {
        let value = match self {
            Self::Time => row.time_s,
            Self::Memory => row.memory_bytes.map(|bytes| bytes as f64),
            Self::Triangles => row.triangles.map(|count| count as f64),
            Self::RadiusRatio => row.radius_ratio.map(f64::recip),
            // A surface of the second order halves its error with twice the triangles.
            Self::ErrorAtEqualTriangles => Some(row.off_cells?.max(LEAST_ERROR) * row.triangles? as f64),
        };
        value.filter(|value| *value > 0.0 && value.is_finite())
    }
}

/// Where an engine stands.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Standing {
    /// Which.
    pub engine: String,
    /// From 1 on; the same for all that are not distinguished.
    pub rank: u32,
    /// The geometric mean of its ratios to the least.
    pub score: f64,
    /// The lower end of its interval, 95 % over surfaces.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

/// Engines in order of one quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ranking {
    /// Of what.
    pub quantity: Quantity,
    /// The workloads that all of them passed.
    pub workloads: Vec<String>,
    /// The first first.
    pub standings: Vec<Standing>,
    /// Those that passed too few workloads to be compared, and how many they passed.
    pub left_out: Vec<(String, usize)>,
    /// Pairs that are distinguished, the better one first.
    pub told: BTreeSet<(String, String)>,
}

/// Ranks the engines of some rows. With `least_share`, an engine that passed fewer workloads than this share of those that anybody passed is
/// left out, so that the others are compared on more. Scores whose ratio is below `noise` are not distinguished; 1 if there is none.
pub fn rank(rows: &[Row], quantity: Quantity, least_share: f64, noise: f64, seed: u64) -> Ranking {
    let mut numbers: BTreeMap<&str, BTreeMap<&str, f64>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.state == State::Right) {
        if let Some(value) = quantity.of(row) {
            numbers.entry(&row.engine).or_default().insert(&row.workload, value);
        }
    }
    let any: BTreeSet<&str> = numbers.values().flat_map(|of| of.keys().copied()).collect();
    let least = least_share * any.len() as f64;
    let engines: BTreeSet<&str> = rows.iter().map(|row| row.engine.as_str()).collect();
    let passed = |engine: &&str| numbers.get(engine).map_or(0, BTreeMap::len);
    let (kept, left): (Vec<&str>, Vec<&str>) =
        engines.into_iter().partition(|engine| passed(engine) > 0 && passed(engine) as f64 >= least);
    let left_out = left.iter().map(|&engine| (engine.to_owned(), passed(&engine))).collect();
    let common: Vec<&str> = any
        .into_iter()
        .filter(|workload| kept.iter().all(|engine| numbers[engine].contains_key(workload)))
        .collect();
    // By workload, the logarithm of each engine's ratio to the least.
    let logs: Vec<Vec<f64>> = common
        .iter()
        .map(|workload| {
            let values: Vec<f64> = kept.iter().map(|engine| numbers[engine][workload]).collect();
            let least = values.iter().copied().fold(f64::INFINITY, f64::min);
            values.iter().map(|value| (value / least).ln()).collect()
        })
        .collect();
    // Workloads of one surface, by number.
    let mut surfaces: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (i, workload) in common.iter().enumerate() {
        let surface = rows.iter().find(|row| row.workload == *workload).map_or(*workload, |row| &row.surface);
        surfaces.entry(surface).or_default().push(i);
    }
    let surfaces: Vec<Vec<usize>> = surfaces.into_values().collect();
    let workloads = common.iter().map(|&workload| workload.to_owned()).collect();
    let (standings, told) = stand(&kept, &logs, &surfaces, noise.ln(), seed);
    Ranking { quantity, workloads, standings, left_out, told }
}

fn stand(
    engines: &[&str],
    logs: &[Vec<f64>],
    surfaces: &[Vec<usize>],
    noise: f64,
    seed: u64,
) -> (Vec<Standing>, BTreeSet<(String, String)>) {
    let count = logs.len();
    if count == 0 {
        return Default::default();
    }
    let mean = |of: &[usize]| -> Vec<f64> {
        let sum = |e: usize| of.iter().map(|&i| logs[i][e]).sum::<f64>();
        (0..engines.len()).map(|e| sum(e) / of.len() as f64).collect()
    };
    let scores = mean(&(0..count).collect::<Vec<_>>());
    let mut order: Vec<usize> = (0..engines.len()).collect();
    order.sort_by(|&a, &b| scores[a].total_cmp(&scores[b]).then(engines[a].cmp(engines[b])));
    let mut random = Pcg64::seed_from_u64(seed);
    let draws: Vec<Vec<f64>> = (0..DRAWS)
        .map(|_| {
            let drawn = (0..surfaces.len()).flat_map(|_| &surfaces[random.random_range(0..surfaces.len())]);
            mean(&drawn.copied().collect::<Vec<_>>())
        })
        .collect();
    let interval = |of: &dyn Fn(&[f64]) -> f64| {
        let mut values: Vec<f64> = draws.iter().map(|draw| of(draw)).collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values[((share * DRAWS as f64) as usize).min(DRAWS - 1)];
        [at(0.025), at(0.975)]
    };
    // Few surfaces tell nothing, however much alike they are.
    let is_told = |a: usize, b: usize| {
        surfaces.len() >= LEAST_SURFACES && interval(&|draw| draw[b] - draw[a])[0] > noise.max(0.0)
    };
    let mut told = BTreeSet::new();
    // The last place whose rank is that of each place.
    let mut ends: Vec<usize> = (0..order.len()).collect();
    for i in 0..order.len() {
        for j in i + 1..order.len() {
            if is_told(order[i], order[j]) {
                told.insert((engines[order[i]].to_owned(), engines[order[j]].to_owned()));
            } else {
                ends[i] = j;
            }
        }
    }
    let mut standings: Vec<Standing> = Vec::new();
    let (mut rank, mut end) = (0, 0);
    for (place, &e) in order.iter().enumerate() {
        if place == 0 || place > end {
            rank = place as u32 + 1;
        }
        end = end.max(ends[place]);
        let [low, high] = interval(&|draw| draw[e]).map(f64::exp);
        standings.push(Standing { engine: engines[e].to_owned(), rank, score: scores[e].exp(), low, high });
    }
    (standings, told)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workload::Group;

    fn row(engine: &str, workload: usize, time: Option<f64>) -> Row {
        Row {
            workload: format!("w{workload}"),
            group: Group::Curated,
            surface: format!("w{workload}"),
            engine: engine.into(),
            state: if time.is_some() { State::Right } else { State::Wrong },
            faults: String::new(),
            triangles: Some(100),
            time_s: time,
            low_s: time,
            high_s: time,
            rounds: 3,
            judged_s: None,
            memory_bytes: None,
            radius_ratio: Some(0.5),
            off_cells: Some(0.1),
        }
    }

    /// Times are 1, 2 and 2 give or take a tenth; the first is told from the others, and these are not from each other.
    #[test]
    fn what_is_not_distinguished_shares_a_rank() {
        let mut rows = Vec::new();
        for w in 0..20 {
            let wobble = 1.0 + 0.1 * ((w * 7 % 11) as f64 / 5.0 - 1.0);
            rows.push(row("a", w, Some(1.0)));
            rows.push(row("b", w, Some(2.0 * wobble)));
            rows.push(row("c", w, Some(2.0 / wobble)));
        }
        let ranking = rank(&rows, Quantity::Time, 0.5, 1.0, 1);
        let ranks: Vec<u32> = ranking.standings.iter().map(|of| of.rank).collect();
        assert_eq!(ranks, [1, 2, 2], "{ranking:?}");
        assert_eq!(ranking.standings[0].score, 1.0);
        assert!((ranking.standings[1].score - 2.0).abs() < 0.1);
        assert_eq!(ranking.told.len(), 2);
        assert_eq!(rank(&rows, Quantity::Time, 0.5, 1.0, 1), ranking, "the same seed");
        // All have as many triangles.
        let ranking = rank(&rows, Quantity::Triangles, 0.5, 1.0, 1);
        assert!(ranking.standings.iter().all(|of| of.rank == 1) && ranking.told.is_empty());
    }

    /// Twenty workloads of three surfaces are three; and what an engine differs from itself by distinguishes nothing.
    #[test]
    fn one_surface_many_times_is_one() {
        let rows: Vec<Row> = (0..20)
            .flat_map(|w| [row("a", w, Some(1.0)), row("b", w, Some(1.02 + (w % 3) as f64 / 100.0))])
            .collect();
        assert_eq!(rank(&rows, Quantity::Time, 0.5, 1.0, 1).told.len(), 1);
        assert!(rank(&rows, Quantity::Time, 0.5, 1.05, 1).told.is_empty(), "within the noise");
        let of_three = |row: Row| Row {
            surface: format!("s{}", row.workload.len() + row.workload.ends_with('1') as usize),
            ..row
        };
        let rows: Vec<Row> = rows.into_iter().map(of_three).collect();
        assert!(rank(&rows, Quantity::Time, 0.5, 1.0, 1).told.is_empty());
    }

    /// A wrong mesh gives no time, and takes its workload from all.
    #[test]
    fn only_what_all_passed_counts() {
        let mut rows = Vec::new();
        for w in 0..10 {
            rows.push(row("a", w, Some(1.0)));
            rows.push(row("b", w, (w != 3).then_some(0.1)));
            rows.push(row("c", w, (w == 0).then_some(0.01)));
        }
        let ranking = rank(&rows, Quantity::Time, 0.5, 1.0, 1);
        assert_eq!(ranking.left_out, [("c".to_owned(), 1)]);
        assert_eq!(ranking.workloads.len(), 9);
        assert_eq!(ranking.standings[0].engine, "b");
        let few: Vec<Row> = rows.into_iter().filter(|row| row.workload == "w0").collect();
        let ranking = rank(&few, Quantity::Time, 0.5, 1.0, 1);
        assert!(ranking.standings.iter().all(|of| of.rank == 1), "one workload tells nothing: {ranking:?}");
    }

    #[test]
    fn recordings_agree_in_what_both_tell() {
        use crate::agreement::Agreement;
        let rows = |factor: f64| -> Vec<Row> {
            (0..10)
                .flat_map(|w| [row("a", w, Some(1.0)), row("b", w, Some(factor + w as f64 / 100.0))])
                .collect()
        };
        let ranking = |factor: f64| rank(&rows(factor), Quantity::Time, 0.5, 1.0, 1);
        let found = Agreement::of(&ranking(2.0), &ranking(3.0));
        assert_eq!((found.same, found.opposite.len(), found.one_alone), (1, 0, 0));
        let found = Agreement::of(&ranking(2.0), &ranking(0.5));
        assert_eq!((found.same, found.opposite.len(), found.one_alone), (0, 1, 0));
        let found = Agreement::of(&ranking(2.0), &ranking(0.955));
        assert_eq!((found.same, found.opposite.len(), found.one_alone), (0, 0, 1));
    }
}
