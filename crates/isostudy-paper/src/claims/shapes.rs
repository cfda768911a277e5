//! Claims about the shape of triangles.

use super::numbers::{Measure, Numbers, Ours, Side};
use super::{Finding, judge};
use crate::comparison::benchmark::zero_ratios;
use crate::verdict::{UNEXPLAINED, Verdict, prints_alike};
use isostudy_design::Clustering::{self, EdgeCollapse, Integrated};
use isostudy_design::published::Claim;
use isostudy_inference::mesh_set::known;
use isostudy_inference::published_ratio;

const RATIO_MEAN: Measure = Measure {
    published: |p| p.aspect_ratio_mean,
    ours: Ours::Shape(|m| published_ratio::mean(m.judged().quality)),
};
const RATIO_SD: Measure = Measure {
    published: |p| p.aspect_ratio_sd,
    ours: Ours::Shape(|m| published_ratio::sd(m.judged().quality)),
};
/// The same, with degenerate triangles left out.
const RATIO_MEAN_WITHOUT: Measure = Measure {
    ours: Ours::Shape(|m| known(&m.judged().quality.published_aspect_ratio, |d| d.mean)),
    ..RATIO_MEAN
};
const RATIO_SD_WITHOUT: Measure = Measure {
    ours: Ours::Shape(|m| known(&m.judged().quality.published_aspect_ratio, |d| d.sd)),
    ..RATIO_SD
};
/// The published side has no order-free ratio; its own stands in and is not shown as ours.
const EDGE_RATIO_MEAN: Measure = Measure {
    published: |p| p.aspect_ratio_mean,
    ours: Ours::Shape(|m| known(&m.judged().quality.edge_ratio, |d| d.mean)),
};
/// Not published.
const DEGENERATE: Measure =
    Measure { published: |_| 0.0, ours: Ours::Mesh(|m| m.judged().quality.degenerate as f64) };
const TRIANGLES: Measure =
    Measure { published: |p| p.triangles as f64, ours: Ours::Mesh(|m| m.judged().triangles as f64) };

pub(super) fn find(numbers: &Numbers<'_>, claim: &Claim) -> Option<Finding> {
    match claim.id.as_str() {
        "less_uniform" => less_uniform(numbers),
        "fewer_triangles" => fewer_triangles(numbers),
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
            extreme_of(numbers, claim.value?, measures, clustering, extreme == "max")
        }
    }
}

/// The smallest or largest over all cases; `measures` are as published and without degenerate triangles.
///
/// What explains a difference is what holds our extreme: its object's cause, or its degenerate triangles.
fn extreme_of(
    numbers: &Numbers<'_>,
    value: f64,
    [with, without]: [Measure; 2],
    clustering: Clustering,
    largest: bool,
) -> Option<Finding> {
    let extreme = |side, measure| {
        let cases = numbers.each_case(side, measure, clustering).into_iter();
        cases.reduce(|a, b| if (b.2 > a.2) == largest && a.2 != b.2 { b } else { a })
    };
    let (there, as_published) = (extreme(Side::Published, with), extreme(Side::Ours, with));
    let (object, method, ours) = extreme(Side::Ours, without)?;
    let degenerate = numbers.get(Side::Ours, DEGENERATE, object, method).unwrap_or_default();
    let cause = numbers.cause(object);
    let verdict = match cause {
        _ if prints_alike(value, ours, 2) => Verdict::Equal,
        _ if degenerate > 0.0 => Verdict::differs(zero_ratios(degenerate as u64)),
        Some(cause) => {
            let far = match cause.beyond {
                true => format!("{}; led by a few slivers", cause.short),
                false => UNEXPLAINED.into(),
            };
            judge(value, ours, 2, Some(cause.short), &far)
        }
        None => Verdict::differs(UNEXPLAINED),
    };
    let remark = match there {
        Some((o, m, _)) if (o, m) != (object, method) => {
            format!("held by {}, in the published tables by {}", numbers.id(object, method), numbers.id(o, m))
        }
        _ => String::new(),
    };
    Some(Finding {
        from_published: there.map(|(.., value)| value),
        as_published: as_published.map(|(.., value)| value),
        remark,
        ..Finding::of(Some(ours), 2, verdict)
    })
}

/// The lattice cases, and those in which the integrated value is above (or below) the edge collapse's.
struct Cases {
    of: usize,
    holding: Vec<String>,
}

impl Cases {
    fn new(numbers: &Numbers<'_>, side: Side, measure: Measure, above: bool) -> Self {
        let pairs = numbers.clustering_pairs(Integrated, EdgeCollapse);
        let mut found = Self { of: 0, holding: Vec::new() };
        for pair in pairs {
            let Some(&ratio) = numbers.ratios(side, measure, &[pair]).first() else { continue };
            found.of += 1;
            if if above { ratio > 1.0 } else { ratio < 1.0 } {
                let (object, method) = pair[0];
                found.holding.push(format!("{} {}", numbers.object_name(object), method.arrangement.label()));
            }
        }
        found
    }

    /// `4 of 8 cases (hills simple cubic, ...)`; without names where it is all or none.
    fn counted(&self) -> String {
        let (holding, of) = (self.holding.len(), self.of);
        match holding {
            0 => format!("{holding} of {of} cases"),
            n if n == of => format!("{holding} of {of} cases"),
            _ => format!("{holding} of {of} cases ({})", self.holding.join(", ")),
        }
    }
}

/// What the published tables say, where there are any.
fn in_its_tables(cases: &Cases) -> String {
    match cases.of {
        0 => String::new(),
        of => format!(" ({} of {of} in its tables)", cases.holding.len()),
    }
}

fn less_uniform(numbers: &Numbers<'_>) -> Option<Finding> {
    let there = Cases::new(numbers, Side::Published, RATIO_MEAN, true);
    let as_published = Cases::new(numbers, Side::Ours, RATIO_MEAN, true);
    let ours = Cases::new(numbers, Side::Ours, EDGE_RATIO_MEAN, true);
    let reason = format!(
        "holds in {} by the mean edge ratio, {} of {} by the published ratio{}",
        ours.counted(),
        as_published.holding.len(),
        ours.of,
        in_its_tables(&there)
    );
    let counts = [&there, &as_published, &ours].map(|cases| cases.holding.len());
    counted(ours.of, there.of, counts, reason)
}

fn fewer_triangles(numbers: &Numbers<'_>) -> Option<Finding> {
    let there = Cases::new(numbers, Side::Published, TRIANGLES, false);
    let ours = Cases::new(numbers, Side::Ours, TRIANGLES, false);
    let reason = format!("holds in {}{}", ours.counted(), in_its_tables(&there));
    let counts = [&there, &ours, &ours].map(|cases| cases.holding.len());
    counted(ours.of, there.of, counts, reason)
}

fn counted(of: usize, of_there: usize, counts: [usize; 3], reason: String) -> Option<Finding> {
    let [there, as_published, ours] = counts.map(|count| count as f64);
    let verdict = if ours as usize == of { Verdict::Equal } else { Verdict::differs(reason) };
    (of > 0).then(|| Finding {
        from_published: (of_there > 0).then_some(there),
        as_published: Some(as_published),
        ..Finding::of(Some(ours), 0, verdict)
    })
}
