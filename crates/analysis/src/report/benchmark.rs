//! What the published benchmark was said to show, sentence by sentence, with its numbers and ours.

use super::Block;
use super::finding::{Finding, Standing};
use super::words::{change, interval, list, number, whole};
use crate::claims::numbers::{Measure, Numbers, Ours, Side, mean, mean_change};
use crate::claims::times::{GEOMETRY, VERTEX, by_round};
use crate::inputs::Inputs;
use crate::interval::{Interval, LEVEL};
use crate::mesh_set::{discard_fraction, known};
use crate::statistics::median;
use design::Clustering::{self, EdgeCollapse, Integrated, None as Unclustered};
use design::record::{BenchRun, Purpose};
use design::{Arrangement, Method};

const TOTAL: Measure =
    Measure { published: |p| p.total_without_normals_s, ours: Ours::Times(|t| t.total_without_normals_s()) };
const SAMPLING_SHARE: Measure = Measure {
    published: |p| p.sampling_s / p.total_without_normals_s,
    ours: Ours::Times(|t| t.sampling_s / t.total_without_normals_s()),
};
const TRIANGLES: Measure =
    Measure { published: |p| p.triangles as f64, ours: Ours::Mesh(|m| m.counts.triangles as f64) };
const DISCARD_AS_PUBLISHED: Measure = Measure {
    published: |p| 100.0 * p.discard_fraction,
    ours: Ours::Mesh(|m| 100.0 * discard_fraction(m.counts.discarded_as_published, m.counts.triangles)),
};
const DISCARD: Measure = Measure {
    ours: Ours::Mesh(|m| 100.0 * discard_fraction(m.counts.discarded_triangles, m.counts.triangles)),
    ..DISCARD_AS_PUBLISHED
};
const TWO_EDGES: Measure = Measure {
    published: |p| p.aspect_ratio_mean,
    ours: Ours::Shape(|m| known(&m.quality.published_aspect_ratio, |d| d.mean)),
};
/// Not published; the published side of this measure is that of two edges.
const THREE_EDGES: Measure =
    Measure { ours: Ours::Shape(|m| known(&m.quality.edge_ratio, |d| d.mean)), ..TWO_EDGES };
/// Not published either.
const RADIUS_RATIO: Measure =
    Measure { ours: Ours::Shape(|m| known(&m.quality.radius_ratio, |d| d.mean)), ..TWO_EDGES };
const ALL: [Clustering; 3] = [Unclustered, Integrated, EdgeCollapse];

/// Nothing if no benchmark was published.
pub(super) fn findings(inputs: &Inputs<'_>) -> Vec<Block> {
    if inputs.study.published.benchmark.is_empty() {
        return Vec::new();
    }
    let numbers = Numbers::of(inputs);
    let mut found = Vec::new();
    found.extend(sampling_share(inputs, &numbers));
    found.extend(clustering_cost(inputs, &numbers, Integrated, Unclustered));
    found.extend(clustering_cost(inputs, &numbers, EdgeCollapse, Unclustered));
    found.extend(clustering_cost(inputs, &numbers, EdgeCollapse, Integrated));
    found.extend(arrangement_cost(inputs, &numbers));
    found.extend(reduction(&numbers, Integrated));
    found.extend(reduction(&numbers, EdgeCollapse));
    found.extend(triangles_left(inputs, &numbers));
    found.extend(regularity(inputs, &numbers));
    let mut blocks = Vec::new();
    if let (Some(run), false) = (inputs.bench, found.is_empty()) {
        let model = run.machine.model.as_deref().unwrap_or("an unnamed CPU");
        blocks.push(Block::Text(format!(
            "Means over objects and lattices, or over objects and clusterings. Our times are from {} rounds on {model}; they \
             are compared as shares and ratios only, since the published ones are from {}. Medians over rounds, with their 95 % \
             order-statistic intervals.",
            run.iterations, run.target.name
        )));
    }
    blocks.extend(found.into_iter().map(Block::Finding));
    blocks
}

/// What a time of theirs and of ours comes to.
struct Estimate {
    published: Option<f64>,
    /// Median over rounds.
    ours: f64,
    /// Of the median; `None` of fewer rounds than it takes.
    interval: Option<Interval>,
}

/// What `summary` makes of the cases of each side; `None` if we have none.
fn estimate(
    run: &BenchRun,
    cases: impl Fn(Side) -> Vec<f64>,
    summary: fn(&[f64]) -> Option<f64>,
) -> Option<Estimate> {
    let published = summary(&cases(Side::Published));
    let found = median(by_round(run, cases, summary), LEVEL)?;
    Some(Estimate { published, ours: found.median, interval: found.interval_at(LEVEL) })
}

/// What an estimate is worth beside the published one.
fn standing(of: &Estimate) -> Standing {
    match (of.published, of.interval) {
        (Some(published), Some(i)) if i.low > 0.0 || i.high < 0.0 => {
            if i.low.signum() == published.signum() {
                Standing::Holds
            } else {
                Standing::Fails
            }
        }
        (_, None) => Standing::Noted,
        _ => Standing::Open,
    }
}

/// `+12.07 % published, +9.31 % here (8.20 to 10.42 %)`.
fn both(of: &Estimate) -> String {
    let published = of.published.map_or("not published".into(), |p| format!("{} published", change(p)));
    let within =
        of.interval.map_or("too few rounds for an interval".into(), |i| format!("{} %", interval(i, 2)));
    format!("{published}, {} here ({within})", change(of.ours))
}

fn sampling_share(inputs: &Inputs<'_>, numbers: &Numbers<'_>) -> Option<Finding> {
    let shares = |side| -> Vec<f64> {
        let of = ALL.iter().flat_map(|&clustering| numbers.each(side, SAMPLING_SHARE, clustering));
        of.map(|share| 100.0 * share).collect()
    };
    let found = estimate(inputs.bench?, shares, mean)?;
    let range = |side| {
        let of = shares(side);
        let (low, high) = of.iter().fold((f64::MAX, f64::MIN), |(l, h), &s| (l.min(s), h.max(s)));
        format!("{} to {} %", number(low, 0), number(high, 0))
    };
    let within = found.interval.map_or(String::new(), |i| format!(", interval {}", interval(i, 1)));
    let published = found.published?;
    let most = |share: f64| share > 50.0;
    let text = format!(
        "Sampling the field takes {} % of the time in the published tables ({} from configuration to configuration) and {} % \
         here ({}{within}).{}",
        number(published, 1),
        range(Side::Published),
        number(found.ours, 1),
        range(Side::Ours),
        if most(published) == most(found.ours) { "" } else { " What costs most is not the same." }
    );
    Some(Finding::new(Standing::Noted, text))
}

/// What a clustering costs, pass by pass and in all.
fn clustering_cost(
    inputs: &Inputs<'_>,
    numbers: &Numbers<'_>,
    top: Clustering,
    bottom: Clustering,
) -> Option<Finding> {
    let of = |measure| {
        let cases = |side| numbers.over_clustering(side, measure, top, bottom);
        estimate(inputs.bench?, cases, mean_change)
    };
    let (vertex, geometry, total) = (of(VERTEX)?, of(GEOMETRY)?, of(TOTAL)?);
    let verb = if top == EdgeCollapse { "Edge collapse" } else { "Integrated clustering" };
    let against = if bottom == Unclustered { "no clustering" } else { "integrated clustering" };
    let text = format!(
        "{verb} against {against}: vertex pass {}; geometry pass {}; whole extraction {}.{}",
        both(&vertex),
        both(&geometry),
        both(&total),
        told_apart(&[("vertex", &vertex), ("geometry", &geometry), ("whole", &total)])
    );
    // The pass in which the clustering works is what its cost was said to be.
    Some(Finding::new(standing(if top == EdgeCollapse { &geometry } else { &vertex }), text))
}

fn arrangement_cost(inputs: &Inputs<'_>, numbers: &Numbers<'_>) -> Option<Finding> {
    let of = |measure| {
        let cases = |side| numbers.over_arrangement(side, measure, &ALL);
        estimate(inputs.bench?, cases, mean_change)
    };
    let (vertex, geometry, total) = (of(VERTEX)?, of(GEOMETRY)?, of(TOTAL)?);
    let text = format!(
        "The body-centred lattice against the simple cubic one: vertex pass {}; geometry pass {}; whole extraction {}.{}",
        both(&vertex),
        both(&geometry),
        both(&total),
        told_apart(&[("vertex", &vertex), ("geometry", &geometry), ("whole", &total)])
    );
    Some(Finding::new(standing(&vertex), text))
}

/// Names the passes whose direction is another than the published one.
fn told_apart(passes: &[(&str, &Estimate)]) -> String {
    let names = |wanted: Standing| -> Vec<&str> {
        passes.iter().filter(|(_, of)| standing(of) == wanted).map(|(name, _)| *name).collect()
    };
    let sentence = |names: Vec<&str>, what: &str| match names.is_empty() {
        true => String::new(),
        false => format!(" {what}: {}.", list(&names)),
    };
    sentence(names(Standing::Fails), "The other way round here")
        + &sentence(names(Standing::Open), "No change can be told from noise here")
}

/// Percentage points by which a count is out if it takes triangles twice.
const COUNTED_TWICE: f64 = 0.05;

fn reduction(numbers: &Numbers<'_>, clustering: Clustering) -> Option<Finding> {
    let of = |side, measure| mean(&numbers.each(side, measure, clustering));
    let (published, recounted, ours) = (
        of(Side::Published, DISCARD_AS_PUBLISHED)?,
        of(Side::Ours, DISCARD_AS_PUBLISHED)?,
        of(Side::Ours, DISCARD)?,
    );
    let name = if clustering == EdgeCollapse { "Edge collapse" } else { "Integrated clustering" };
    let start = format!("{name} takes away {} % of the triangles", number(ours, 2));
    let (standing, rest) = if (recounted - ours).abs() < COUNTED_TWICE {
        (Standing::Holds, format!("; {} % is published.", number(published, 2)))
    } else {
        let why = "the published count, which takes some triangles twice, comes to";
        (
            Standing::Fails,
            format!(", not the published {} %; {why} {} % here.", number(published, 2), number(recounted, 2)),
        )
    };
    Some(Finding::new(standing, start + &rest))
}

/// Integrated and edge collapse of one lattice and object.
struct Duel {
    name: String,
    integrated: f64,
    collapsed: f64,
}

fn duels(numbers: &Numbers<'_>, side: Side, measure: Measure, arrangement: Arrangement) -> Vec<Duel> {
    let of = |(object, own): (usize, Arrangement)| {
        let get = |clustering| numbers.get(side, measure, object, Method { arrangement, clustering });
        let name = numbers.object_name(object).to_owned();
        (own == arrangement).then_some(())?;
        Some(Duel { name, integrated: get(Integrated)?, collapsed: get(EdgeCollapse)? })
    };
    numbers.lattice_cases().into_iter().filter_map(of).collect()
}

fn triangles_left(inputs: &Inputs<'_>, numbers: &Numbers<'_>) -> Option<Finding> {
    let (mut parts, mut holds, mut of) = (Vec::new(), 0, 0);
    for &arrangement in &inputs.study.file.arrangements {
        let duels = duels(numbers, Side::Ours, TRIANGLES, arrangement);
        let fewer = duels.iter().filter(|d| d.collapsed < d.integrated).count();
        (holds, of) = (holds + duels.iter().filter(|d| d.collapsed > d.integrated).count(), of + duels.len());
        let each: Vec<String> = duels
            .iter()
            .map(|d| {
                format!("{} {} against {}", d.name, whole(d.collapsed as u64), whole(d.integrated as u64))
            })
            .collect();
        if !each.is_empty() {
            parts.push(format!(
                "on the {} lattice in {fewer} of {} cases ({})",
                arrangement.label(),
                each.len(),
                list(&each)
            ));
        }
    }
    let text = format!(
        "Edge collapse is said to leave more triangles than integrated clustering. It leaves fewer {}.",
        list(&parts)
    );
    (of > 0).then(|| Finding::new(if holds == of { Standing::Holds } else { Standing::Fails }, text))
}

/// Each lattice and object with its name.
fn all_duels(numbers: &Numbers<'_>, side: Side, measure: Measure) -> Vec<Duel> {
    let named = |arrangement: Arrangement| {
        let of = duels(numbers, side, measure, arrangement).into_iter();
        of.map(move |d| Duel { name: format!("{} {}", d.name, arrangement.label()), ..d })
    };
    [Arrangement::BodyCentred, Arrangement::SimpleCubic].into_iter().flat_map(named).collect()
}

/// In how many integrated clustering has the lower value, and where it has not.
fn lower(duels: &[Duel]) -> (usize, String) {
    let lost: Vec<&Duel> = duels.iter().filter(|d| d.integrated >= d.collapsed).collect();
    let won = duels.len() - lost.len();
    let but = if lost.is_empty() { String::new() } else { format!(", all but {}", told(lost)) };
    (won, format!("{won} of {}{but}", duels.len()))
}

fn told<'a>(duels: impl IntoIterator<Item = &'a Duel>) -> String {
    let one = |d: &Duel| format!("{} {} against {}", d.name, number(d.integrated, 3), number(d.collapsed, 3));
    list(&duels.into_iter().map(one).collect::<Vec<_>>())
}

fn regularity(inputs: &Inputs<'_>, numbers: &Numbers<'_>) -> Option<Finding> {
    let three = all_duels(numbers, Side::Ours, THREE_EDGES);
    let radius = all_duels(numbers, Side::Ours, RADIUS_RATIO);
    let rounder = radius.iter().filter(|d| d.integrated > d.collapsed).count();
    let (won, of_three) = lower(&three);
    let (_, of_two) = lower(&all_duels(numbers, Side::Ours, TWO_EDGES));
    let (_, of_published) = lower(&all_duels(numbers, Side::Published, TWO_EDGES));
    let mut text = format!(
        "Edge collapse is said to give the more uniform triangles. By the mean radius ratio integrated clustering is the more regular \
         in {rounder} of {} ({}). By the mean ratio of longest to shortest of all three edges it is in {of_three}; by the published \
         ratio of two edges in {of_two}; in the published tables themselves in {of_published}.",
        radius.len(),
        told(&radius)
    );
    // A few slivers where rounding decides whether a surface meets its volume outweigh every other triangle of a mean.
    let indexed = Numbers::of_purpose(inputs, Purpose::Indexed);
    let three_indexed = all_duels(&indexed, Side::Ours, THREE_EDGES);
    if won < three.len() && !three_indexed.is_empty() {
        let (_, of_indexed) = lower(&three_indexed);
        text.push_str(&format!(
            " With lattice positions computed from indices, which leave no slivers where a surface touches its volume, it is by all \
             three edges in {of_indexed}."
        ));
    }
    let standing = if rounder == 0 { Standing::Holds } else { Standing::Fails };
    (!radius.is_empty()).then(|| Finding::new(standing, text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{self, Everything};

    #[test]
    fn the_published_conclusions_are_held_against_numbers() {
        let mut everything = Everything::of(fixture::study());
        for mesh in &mut everything.meshes {
            let integrated = mesh.id.method.clustering == Integrated;
            mesh.quality.radius_ratio.mean = if integrated { 0.92 } else { 0.89 };
        }
        let blocks = findings(&everything.inputs());
        let found: Vec<(Standing, String)> = blocks
            .into_iter()
            .filter_map(|b| if let Block::Finding(f) = b { Some((f.standing, f.text)) } else { None })
            .collect();
        let of = |start: &str| {
            found
                .iter()
                .find(|(_, text)| text.starts_with(start))
                .unwrap_or_else(|| panic!("{start}: {found:#?}"))
        };
        let has = |start: &str, parts: &[&str]| {
            let (_, text) = of(start);
            parts.iter().for_each(|part| assert!(text.contains(part), "{part}: {text}"));
        };
        // Percentages: claims of the text; counts: the published table.
        has(
            "Integrated clustering against no clustering",
            &["vertex pass +12.07 % published", "geometry pass \u{2212}1.96 % published"],
        );
        has(
            "Edge collapse against no clustering",
            &["vertex pass \u{2212}1.36 % published", "geometry pass +1135.96 % published"],
        );
        has(
            "The body-centred lattice against",
            &["vertex pass +124.82 % published", "geometry pass +48.67 % published"],
        );
        has("Edge collapse against integrated clustering", &["geometry pass +11"]);
        has("Sampling the field takes", &["% of the time in the published tables"]);
        let taken = "Integrated clustering takes away 73.40 % of the triangles, not the published 79.53 %; the published count, which \
                     takes some triangles twice, comes to 79.53 % here.";
        assert_eq!(*of("Integrated clustering takes"), (Standing::Fails, taken.into()));
        let taken = "Edge collapse takes away 72.20 % of the triangles; 72.20 % is published.";
        assert_eq!(*of("Edge collapse takes"), (Standing::Holds, taken.into()));
        has(
            "Edge collapse is said to leave more",
            &[
                "on the body-centred lattice in 3 of 3 cases (sphere 26,144 against 27,200, asteroid 11,326 against 12,020",
                "on the simple cubic lattice in 0 of 3 cases (sphere 21,366 against 18,588",
            ],
        );
        assert_eq!(of("Edge collapse is said to leave more").0, Standing::Fails);
        has(
            "Edge collapse is said to give",
            &[
                "of all three edges it is in 6 of 6; ",
                "themselves in 5 of 6, all but sphere body-centred 2.162 against 1.232.",
            ],
        );
        assert_eq!(of("Edge collapse is said to give").0, Standing::Fails);
    }

    #[test]
    fn a_direction_needs_an_interval_without_zero() {
        let worth = |low, high| {
            standing(&Estimate { published: Some(12.0), ours: 0.0, interval: Some(Interval { low, high }) })
        };
        assert_eq!(
            [worth(1.0, 5.0), worth(-5.0, -1.0), worth(-1.0, 5.0)],
            [Standing::Holds, Standing::Fails, Standing::Open]
        );
        assert_eq!(standing(&Estimate { published: Some(12.0), ours: 9.0, interval: None }), Standing::Noted);
    }

    #[test]
    fn without_a_published_benchmark_nothing_is_checked() {
        let mut everything = Everything::of(fixture::study());
        everything.study.published.benchmark.clear();
        assert!(findings(&everything.inputs()).is_empty());
    }
}
