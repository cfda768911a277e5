//! Claims about times. Means of ratios are compared, not times; still, the machine decides them.

use super::Finding;
use super::numbers::{Measure, Numbers, Ours, Side, mean_change};
use crate::inputs::Inputs;
use crate::verdict::{Verdict, prints_alike};
use design::Clustering::{self, EdgeCollapse, Integrated};
use design::published::Claim;

const VERTEX: Measure = Measure { published: |p| p.vertex_s, ours: Ours::Times(|t| t.vertex_s) };
const GEOMETRY: Measure = Measure { published: |p| p.geometry_s, ours: Ours::Times(|t| t.geometry_s) };
const ALL: [Clustering; 3] = [Clustering::None, Integrated, EdgeCollapse];

pub(super) fn find(inputs: &Inputs<'_>, claim: &Claim) -> Option<Finding> {
    let numbers = Numbers::of(inputs);
    let against_none = |side, measure, clustering| {
        mean_change(&numbers.over_clustering(side, measure, clustering, Clustering::None))
    };
    let against_simple = |side, measure| mean_change(&numbers.over_arrangement(side, measure, &ALL));
    let change = |side| match claim.id.as_str() {
        "vertex_integrated" => against_none(side, VERTEX, Integrated),
        "geometry_integrated" => against_none(side, GEOMETRY, Integrated),
        "vertex_edge_collapse" => against_none(side, VERTEX, EdgeCollapse),
        "geometry_edge_collapse" => against_none(side, GEOMETRY, EdgeCollapse),
        "arrangement_vertex" => against_simple(side, VERTEX),
        "arrangement_geometry" => against_simple(side, GEOMETRY),
        _ => None,
    };
    let (value, run) = (claim.value?, inputs.bench?);
    let ours = change(Side::Ours)?;
    let verdict = if prints_alike(value, ours, 2) {
        Verdict::Equal
    } else if run.differences.is_empty() {
        Verdict::differs("measured on a matching machine")
    } else {
        let model = run.machine.model.as_deref().unwrap_or("an unnamed CPU");
        let same = if ours.signum() == value.signum() { "same direction" } else { "opposite direction" };
        Verdict::not_comparable(format!("{same}; measured on {model}, not on {}", run.target.name))
    };
    Some(Finding {
        from_published: change(Side::Published),
        as_published: Some(ours),
        ours: Some(ours),
        decimals: 2,
        remark: String::new(),
        verdict,
    })
}
