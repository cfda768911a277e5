//! Which method is the most regular for what it costs.
//!
//! Regularity hardly depends on the resolution, cost does: so methods are compared at the same number of triangles, and in
//! the same time, each at the resolution that this buys it.

use super::{Point, series};
use isostudy_design::{ConfigurationId, MethodId};
use serde::Serialize;

/// What is spent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cost {
    /// So many triangles.
    Triangles(f64),
    /// So many seconds, on the fewest threads measured.
    Seconds(f64),
}

/// The methods on one object, at one cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Budget {
    /// The object's id.
    pub object: String,
    /// What each of them may cost.
    pub cost: Cost,
    /// Each method's mean radius ratio and what else it gives for that, the most regular first.
    pub methods: Vec<Best>,
}

/// What a method gives for a cost; interpolated between resolutions on logarithms.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Best {
    /// The method.
    pub method: MethodId,
    /// Mean radius ratio.
    pub radius_ratio: f64,
    /// Cells along the longest axis.
    pub cells: f64,
    /// Triangles.
    pub triangles: f64,
}

/// Costs that every method of an object reaches: the middle, on logarithms, of the range that they share.
pub(super) fn budgets(points: &[Point]) -> Vec<Budget> {
    let fewest = points.iter().map(|point| point.threads).min().unwrap_or_default();
    let all: Vec<(ConfigurationId, u32)> =
        series(points).into_iter().filter(|(_, threads)| *threads == fewest).collect();
    let mut objects: Vec<&str> = all.iter().map(|(id, _)| id.object.as_str()).collect();
    objects.dedup();
    let mut found = Vec::new();
    for object in objects {
        let lines: Vec<(MethodId, Vec<&Point>)> = all
            .iter()
            .filter(|(id, _)| id.object == object)
            .map(|(id, _)| {
                let own = |p: &&Point| p.id == *id && p.threads == fewest && p.radius_ratio.is_some();
                (id.method, points.iter().filter(own).collect())
            })
            .collect();
        let triangles: fn(&Point) -> f64 = |point| point.triangles as f64;
        let seconds: fn(&Point) -> f64 = |point| point.total_s.median;
        found.extend(budget(object, &lines, triangles, Cost::Triangles));
        found.extend(budget(object, &lines, seconds, Cost::Seconds));
    }
    found
}

fn budget(
    object: &str,
    lines: &[(MethodId, Vec<&Point>)],
    of: fn(&Point) -> f64,
    cost: fn(f64) -> Cost,
) -> Option<Budget> {
    let end = |fold: fn(f64, f64) -> f64, start: f64, line: &[&Point]| {
        line.iter().map(|point| of(point)).fold(start, fold)
    };
    let low = lines.iter().map(|(_, line)| end(f64::min, f64::MAX, line)).fold(0.0, f64::max);
    let high = lines.iter().map(|(_, line)| end(f64::max, 0.0, line)).fold(f64::MAX, f64::min);
    if low >= high {
        return None;
    }
    let budget = (low * high).sqrt();
    let best = |(method, line): &(MethodId, Vec<&Point>)| {
        let at = |value: fn(&Point) -> f64| interpolate(line, of, value, budget);
        Some(Best {
            method: *method,
            radius_ratio: at(|p| p.radius_ratio.unwrap_or_default())?,
            cells: at(|p| f64::from(p.cells))?,
            triangles: at(|p| p.triangles as f64)?,
        })
    };
    let mut methods: Vec<Best> = lines.iter().filter_map(best).collect();
    methods.sort_by(|a, b| b.radius_ratio.total_cmp(&a.radius_ratio));
    Some(Budget { object: object.into(), cost: cost(budget), methods })
}

/// `value` where `of` is `at`, straight on logarithms between the two points round it.
fn interpolate(line: &[&Point], of: fn(&Point) -> f64, value: fn(&Point) -> f64, at: f64) -> Option<f64> {
    let pair = line.windows(2).find(|pair| of(pair[0]) <= at && at <= of(pair[1]))?;
    let (low, high) = (of(pair[0]).ln(), of(pair[1]).ln());
    let share = if high > low { (at.ln() - low) / (high - low) } else { 0.0 };
    let (a, b) = (value(pair[0]).ln(), value(pair[1]).ln());
    Some((a + share * (b - a)).exp())
}
