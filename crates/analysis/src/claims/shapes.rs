//! Claims about the shape of triangles.

use super::numbers::{Measure, Numbers, Ours, Side};
use super::{Finding, judge};
use crate::comparison::benchmark::zero_ratios;
use crate::inputs::Inputs;
use crate::published_ratio;
use crate::verdict::Verdict;
use design::Clustering::{self, EdgeCollapse, Integrated};
use design::published::Claim;

const RATIO_MEAN: Measure =
    Measure { published: |p| p.aspect_ratio_mean, ours: Ours::Mesh(|m| published_ratio::mean(&m.quality)) };
const RATIO_SD: Measure =
    Measure { published: |p| p.aspect_ratio_sd, ours: Ours::Mesh(|m| published_ratio::sd(&m.quality)) };
/// The same, with degenerate triangles left out.
const RATIO_MEAN_WITHOUT: Measure =
    Measure { ours: Ours::Mesh(|m| m.quality.published_aspect_ratio.mean), ..RATIO_MEAN };
const RATIO_SD_WITHOUT: Measure =
    Measure { ours: Ours::Mesh(|m| m.quality.published_aspect_ratio.sd), ..RATIO_SD };
/// The published side has no order-free ratio; its own stands in and is not shown as ours.
const EDGE_RATIO_MEAN: Measure =
    Measure { published: |p| p.aspect_ratio_mean, ours: Ours::Mesh(|m| m.quality.edge_ratio.mean) };
/// Not published.
const DEGENERATE: Measure = Measure { published: |_| 0.0, ours: Ours::Mesh(|m| m.quality.degenerate as f64) };
const TRIANGLES: Measure =
    Measure { published: |p| p.triangles as f64, ours: Ours::Mesh(|m| m.counts.triangles as f64) };

pub(super) fn find(inputs: &Inputs<'_>, claim: &Claim) -> Option<Finding> {
    let numbers = Numbers::of(inputs);
    match claim.id.as_str() {
        "less_uniform" => less_uniform(&numbers),
        "fewer_triangles" => fewer_triangles(&numbers),
        id => {
            let rest = id.strip_prefix("ratio_")?;
            let (measures, rest) = match rest.split_once('_')? {
                ("mean", rest) => ([RATIO_MEAN, RATIO_MEAN_WITHOUT], rest),
                ("sd", rest) => ([RATIO_SD, RATIO_SD_WITHOUT], rest),
                _ => return None,
            };
            let (clustering, extreme) = rest.rsplit_once('_')?;
            let clustering = match clustering {
                "none" => Clustering::None,
                "integrated" => Integrated,
                "edge_collapse" => EdgeCollapse,
                _ => return None,
            };
            extreme_of(&numbers, claim.value?, measures, clustering, extreme == "max")
        }
    }
}

/// The smallest or largest over all cases; `measures` are as published and without degenerate triangles.
fn extreme_of(
    numbers: &Numbers<'_>,
    value: f64,
    measures: [Measure; 2],
    clustering: Clustering,
    largest: bool,
) -> Option<Finding> {
    let extreme = |side, measure| {
        let pick: fn(f64, f64) -> f64 = if largest { f64::max } else { f64::min };
        numbers.each(side, measure, clustering).into_iter().reduce(pick)
    };
    let [as_published, ours] = measures.map(|measure| extreme(Side::Ours, measure));
    let ours = ours?;
    let degenerate = numbers.each(Side::Ours, DEGENERATE, clustering).into_iter().reduce(f64::max)?;
    let far = match clustering {
        Clustering::None => "led by the thinnest slivers; another bunny mesh",
        _ => "led by a few slivers where the surface touches its volume; another bunny mesh",
    };
    let near = "another bunny mesh, another mathematics library";
    let verdict = match as_published == Some(ours) {
        true => judge(value, ours, 2, near, far),
        false => Verdict::differs(zero_ratios(degenerate as u64)),
    };
    Some(Finding {
        from_published: extreme(Side::Published, measures[0]),
        as_published,
        ours: Some(ours),
        decimals: 2,
        remark: String::new(),
        verdict,
    })
}

/// In how many lattice cases the integrated value is above (or below) the edge collapse's.
fn cases(numbers: &Numbers<'_>, side: Side, measure: Measure, above: bool) -> (usize, usize) {
    let ratios = numbers.over_clustering(side, measure, Integrated, EdgeCollapse);
    (ratios.iter().filter(|&&ratio| if above { ratio > 1.0 } else { ratio < 1.0 }).count(), ratios.len())
}

fn less_uniform(numbers: &Numbers<'_>) -> Option<Finding> {
    let (there, of_there) = cases(numbers, Side::Published, RATIO_MEAN, true);
    let (as_published, of) = cases(numbers, Side::Ours, RATIO_MEAN, true);
    let (ours, _) = cases(numbers, Side::Ours, EDGE_RATIO_MEAN, true);
    let reason = format!(
        "holds in {ours} of {of} cases by the mean edge ratio, {as_published} of {of} by the published ratio \
         ({there} of {of_there} in its tables)"
    );
    counted(of, of_there, [there, as_published, ours], reason)
}

fn fewer_triangles(numbers: &Numbers<'_>) -> Option<Finding> {
    let (there, of_there) = cases(numbers, Side::Published, TRIANGLES, false);
    let (ours, of) = cases(numbers, Side::Ours, TRIANGLES, false);
    let reason = format!("holds in {ours} of {of} cases ({there} of {of_there} in its tables)");
    counted(of, of_there, [there, ours, ours], reason)
}

fn counted(of: usize, of_there: usize, counts: [usize; 3], reason: String) -> Option<Finding> {
    let [there, as_published, ours] = counts.map(|count| count as f64);
    (of > 0).then(|| Finding {
        from_published: (of_there > 0).then_some(there),
        as_published: Some(as_published),
        ours: Some(ours),
        decimals: 0,
        remark: String::new(),
        verdict: if ours as usize == of { Verdict::Equal } else { Verdict::differs(reason) },
    })
}
