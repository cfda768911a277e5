//! Claims about times. Means of ratios are compared, not times; still, the machine decides them.

use super::Finding;
use super::numbers::{Measure, Numbers, Ours, Side, mean_change};
use crate::inputs::Inputs;
use crate::interval::{Interval, LEVEL};
use crate::statistics::median;
use crate::verdict::Verdict;
use design::Clustering::{self, EdgeCollapse, Integrated};
use design::published::Claim;
use design::record::BenchRun;

pub(crate) const VERTEX: Measure = Measure { published: |p| p.vertex_s, ours: Ours::Times(|t| t.vertex_s) };
pub(crate) const GEOMETRY: Measure =
    Measure { published: |p| p.geometry_s, ours: Ours::Times(|t| t.geometry_s) };
const ALL: [Clustering; 3] = [Clustering::None, Integrated, EdgeCollapse];

pub(super) fn find(inputs: &Inputs<'_>, claim: &Claim) -> Option<Finding> {
    let numbers = Numbers::of(inputs);
    let against_none =
        |side, measure, clustering| numbers.over_clustering(side, measure, clustering, Clustering::None);
    let against_simple = |side, measure| numbers.over_arrangement(side, measure, &ALL);
    let ratios = |side| match claim.id.as_str() {
        "vertex_integrated" => against_none(side, VERTEX, Integrated),
        "geometry_integrated" => against_none(side, GEOMETRY, Integrated),
        "vertex_edge_collapse" => against_none(side, VERTEX, EdgeCollapse),
        "geometry_edge_collapse" => against_none(side, GEOMETRY, EdgeCollapse),
        "arrangement_vertex" => against_simple(side, VERTEX),
        "arrangement_geometry" => against_simple(side, GEOMETRY),
        _ => Vec::new(),
    };
    let (value, run) = (claim.value?, inputs.bench?);
    let found = median(by_round(run, ratios, mean_change), LEVEL)?;
    let (ours, interval) = (found.median, found.interval_at(LEVEL));
    let direction = direction(value, interval);
    let verdict = if !run.differences.is_empty() {
        let model = run.machine.model.as_deref().unwrap_or("an unnamed CPU");
        Verdict::not_comparable(format!("{direction}; measured on {model}, not on {}", run.target.name))
    } else if interval.is_some_and(|i| (i.low..=i.high).contains(&value)) {
        Verdict::within("the interval", format!("{direction}; measured on a matching machine"))
    } else {
        Verdict::differs(format!("{direction}; measured on a matching machine"))
    };
    Some(Finding {
        from_published: mean_change(&ratios(Side::Published)),
        as_published: Some(ours),
        ours: Some(ours),
        decimals: 2,
        remark: String::new(),
        verdict,
    })
}

/// What `summary` makes of our cases, round by round.
///
/// Cases are paired within a round, so that what slows a whole round down cancels. A round that lacks a case would be a
/// mean over others and is left out.
pub(crate) fn by_round(
    run: &BenchRun,
    cases: impl Fn(Side) -> Vec<f64>,
    summary: fn(&[f64]) -> Option<f64>,
) -> Vec<f64> {
    let all = cases(Side::Ours).len();
    let rounds = (0..run.iterations).map(|round| cases(Side::Round(round))).filter(|of| of.len() == all);
    rounds.filter_map(|of| summary(&of)).collect()
}

/// Whether we see the published direction at all; noise has a sign too.
fn direction(published: f64, interval: Option<Interval>) -> String {
    let Some(Interval { low, high }) = interval else {
        return "too few rounds to tell a change from noise".into();
    };
    let what = match () {
        () if low <= 0.0 && 0.0 <= high => "no change measurable here",
        () if low.signum() == published.signum() => "same direction",
        () => "opposite direction",
    };
    format!("{what} (95 % interval over rounds {low:.2} to {high:.2} %)")
}
