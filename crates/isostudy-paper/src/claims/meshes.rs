//! Claims about counts: what is discarded, stored and left over.

use super::numbers::{Measure, Numbers, Ours, Side, mean, mean_change};
use super::{Finding, judge};
use crate::comparison::benchmark::double_count;
use isostudy_design::published::Claim;
use isostudy_design::{Arrangement, Clustering, Crossed};
use isostudy_inference::mesh_set::{self, discarded_as_published, of_tetrahedra};

use Clustering::{EdgeCollapse, Integrated};

const TRIANGLES: Measure =
    Measure { published: |p| p.triangles as f64, ours: Ours::Mesh(|m| m.judged().triangles as f64) };
const SAMPLES: Measure = Measure {
    published: |p| p.stored_samples as f64,
    ours: Ours::Mesh(|m| of_tetrahedra(m, |t| t.stored_samples)),
};
const DISCARD_AS_PUBLISHED: Measure =
    Measure { published: |p| p.discard_fraction, ours: Ours::Mesh(discarded_as_published) };
const DISCARD: Measure = Measure { published: |p| p.discard_fraction, ours: Ours::Mesh(mesh_set::discarded) };
const SAMPLES_STORED: Measure = Measure {
    published: |p| p.stored_samples as f64 / p.needed_samples as f64,
    ours: Ours::Mesh(|m| {
        of_tetrahedra(m, |t| t.stored_samples) / m.counts.samples.unwrap_or_default() as f64
    }),
};
const EDGES_STORED: Measure = Measure {
    published: |p| p.stored_edges as f64 / p.needed_edges as f64,
    ours: Ours::Mesh(|m| of_tetrahedra(m, |t| t.stored_edges) / of_tetrahedra(m, |t| t.needed_edges)),
};

pub(super) fn find(numbers: &Numbers<'_>, claim: &Claim) -> Option<Finding> {
    let value = claim.value?;
    match claim.id.as_str() {
        "discard_integrated" => discarded(numbers, value, Integrated),
        "discard_edge_collapse" => discarded(numbers, value, EdgeCollapse),
        "arrangement_triangles" => more_triangles(numbers, value),
        "arrangement_samples" => {
            let ratio = |side| mean(&numbers.over_arrangement(side, SAMPLES, &[Integrated]));
            let ours = ratio(Side::Ours)?;
            let near = "twice the points in the interior; the layer of centres outside the box comes on top";
            let verdict = match (ours - value).abs() <= 0.15 {
                true => crate::verdict::Verdict::within("0.15", near),
                false => crate::verdict::Verdict::differs(near),
            };
            Some(Finding {
                from_published: ratio(Side::Published),
                as_published: Some(ours),
                ..Finding::of(Some(ours), 2, verdict)
            })
        }
        "simple_samples_stored" => stored(numbers, value, SAMPLES_STORED),
        "simple_edges_stored" => stored(numbers, value, EDGES_STORED),
        _ => None,
    }
}

fn discarded(numbers: &Numbers<'_>, value: f64, clustering: Clustering) -> Option<Finding> {
    let percent = |side, measure| mean(&numbers.each(side, measure, clustering)).map(|f| 100.0 * f);
    let ours = percent(Side::Ours, DISCARD)?;
    let as_published = percent(Side::Ours, DISCARD_AS_PUBLISHED)?;
    let far = match as_published > ours {
        true => double_count(format!("{:.2} points", as_published - ours)),
        false => crate::verdict::UNEXPLAINED.into(),
    };
    let causes = numbers.causes(DISCARD_AS_PUBLISHED, &[clustering]);
    Some(Finding {
        from_published: percent(Side::Published, DISCARD_AS_PUBLISHED),
        as_published: Some(as_published),
        ..Finding::of(Some(ours), 2, judge(value, ours, 2, causes.as_deref(), &far))
    })
}

/// The text says "after merging"; its number is the mean over all clusterings, none included.
fn more_triangles(numbers: &Numbers<'_>, value: f64) -> Option<Finding> {
    const ALL: [Clustering; 3] = [Clustering::None, Integrated, EdgeCollapse];
    const MERGED: [Clustering; 2] = [Integrated, EdgeCollapse];
    let change = |side, of: &[Clustering]| mean_change(&numbers.over_arrangement(side, TRIANGLES, of));
    let ours = change(Side::Ours, &MERGED)?;
    let merged_there =
        change(Side::Published, &MERGED).map_or(String::new(), |m| format!(" ({m:.2} in its tables)"));
    let far = format!(
        "the published number is the mean over all clusterings, none included; after merging it is {ours:.2}{merged_there}"
    );
    Some(Finding {
        from_published: change(Side::Published, &ALL),
        as_published: change(Side::Ours, &ALL),
        ..Finding::of(Some(ours), 2, judge(value, ours, 2, numbers.causes(TRIANGLES, &ALL).as_deref(), &far))
    })
}

fn stored(numbers: &Numbers<'_>, value: f64, measure: Measure) -> Option<Finding> {
    let method = Crossed { arrangement: Arrangement::SimpleCubic, clustering: Integrated };
    let percent = |side| numbers.get(side, measure, 0, method).map(|ratio| 100.0 * ratio);
    let ours = percent(Side::Ours)?;
    let far = "the published formula for what is needed has a wrong sign";
    Some(Finding {
        from_published: percent(Side::Published),
        ..Finding::of(Some(ours), 2, judge(value, ours, 2, None, far))
    })
}
