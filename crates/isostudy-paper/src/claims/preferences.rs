//! Claims about preference. Counts only; tests are not here yet.

use super::Finding;
use crate::lattices::{ArrangementContest, arrangement_contests};
use crate::verdict::Verdict;
use isostudy_design::config::{FieldSection, ObjectSection};
use isostudy_design::published::{Claim, PreferenceKind};
use isostudy_design::{Arrangement, Clustering, Comparison, Crossed, Study};
use isostudy_inference::fraction::Fraction;
use isostudy_inference::preference::{self, GroupFactor};
use isostudy_inference::tally::Tally;

pub(super) fn find(study: &Study, tally: &Tally, claim: &Claim) -> Option<Finding> {
    let factors = preference::group_factors(study, tally, |_| true);
    match claim.id.as_str() {
        "body_centred_preference" => mean_preference(study, tally, &factors, claim, Arrangement::BodyCentred),
        "simple_cubic_preference" => mean_preference(study, tally, &factors, claim, Arrangement::SimpleCubic),
        "favourite" => favourite(study, tally, &factors, claim),
        "clustering_preference" => clustering(study, tally),
        "regular_objects" => arrangement_on(study, tally, Arrangement::BodyCentred, is_sphere),
        "irregular_objects" => arrangement_on(study, tally, Arrangement::SimpleCubic, |f| !is_sphere(f)),
        _ => None,
    }
}

fn is_sphere(field: &FieldSection) -> bool {
    matches!(field, FieldSection::Sphere { .. })
}

fn published(study: &Study, kind: PreferenceKind, of: &str) -> Option<f64> {
    study.published.preferences.iter().find(|cell| cell.kind == kind && cell.of == of).map(|cell| cell.factor)
}

fn numeric(value: f64, from_published: Option<f64>, exact: Fraction, verdict: Verdict) -> Finding {
    let equal = (value * 1000.0).round() as i128 == exact.rounded(3);
    let verdict = if equal { verdict } else { Verdict::differs(crate::verdict::UNEXPLAINED) };
    Finding {
        from_published,
        as_published: Some(exact.value()),
        ..Finding::of(Some(exact.value()), 3, verdict)
    }
}

/// The number holds, but most of it says nothing about arrangements: the remark names the direct evidence.
fn mean_preference(
    study: &Study,
    tally: &Tally,
    factors: &[GroupFactor],
    claim: &Claim,
    arrangement: Arrangement,
) -> Option<Finding> {
    let margins = preference::margins(study, &preference::overall(study, factors));
    let &(_, mean) = margins.iter().find(|(level, _)| study.level(*level).label == arrangement.label())?;
    let from = published(study, PreferenceKind::ArrangementMean, &arrangement.code().to_string());
    let all = arrangement_contests(study, tally);
    let evidence = all.iter().find(|c| c.object.is_none() && c.group.is_none()).map_or(String::new(), counts);
    let reason = format!("the sum counts ties of the clustering groups; directly: {evidence}");
    Some(Finding { remark: reason, ..numeric(claim.value?, from, mean, Verdict::Equal) })
}

fn counts(contest: &ArrangementContest) -> String {
    let ArrangementContest { body_centred, none, simple_cubic, .. } = contest;
    format!("{body_centred} body-centred, {none} none, {simple_cubic} simple cubic")
}

fn favourite(study: &Study, tally: &Tally, factors: &[GroupFactor], claim: &Claim) -> Option<Finding> {
    let method = Crossed { arrangement: Arrangement::SimpleCubic, clustering: Clustering::Integrated };
    let sums = preference::overall(study, factors);
    let &(_, sum) = sums.iter().find(|(m, _)| *m == method.id())?;
    let best = sums.iter().max_by(|a, b| a.1.value().total_cmp(&b.1.value()))?;
    let from = published(study, PreferenceKind::Overall, method.id().as_str());
    let verdict = match best.0 == method.id() {
        true => Verdict::Equal,
        false => Verdict::differs(format!("the largest sum is that of {}", best.0)),
    };
    let remark = format!("largest sum by object: {}", favourites(study, tally).join(", "));
    Some(Finding { remark, ..numeric(claim.value?, from, sum, verdict) })
}

/// Each object's name and the method with the largest sum on it.
fn favourites(study: &Study, tally: &Tally) -> Vec<String> {
    let favourite = |(o, object): (usize, &ObjectSection)| {
        let sums = preference::overall(study, &preference::group_factors(study, tally, |other| other == o));
        let (method, _) = sums.into_iter().max_by(|a, b| a.1.value().total_cmp(&b.1.value()))?;
        Some(format!("{} {method}", object.name))
    };
    study.file.objects.iter().enumerate().filter_map(favourite).collect()
}

/// Answers for integrated in the questions that differ in clustering alone and show it.
fn clustering(study: &Study, tally: &Tally) -> Option<Finding> {
    let (mut wins, mut none, mut losses) = (0, 0, 0);
    for (comparison, count) in study.comparisons.iter().zip(&tally.questions) {
        let crossed = [comparison.left.method, comparison.right.method].map(Crossed::of);
        let [Some(left), Some(right)] = crossed else { continue };
        if left.arrangement != right.arrangement {
            continue;
        }
        match (left.clustering, right.clustering) {
            (Clustering::Integrated, _) => (wins, losses) = (wins + count.left, losses + count.right),
            (_, Clustering::Integrated) => (wins, losses) = (wins + count.right, losses + count.left),
            _ => continue,
        }
        none += count.none;
    }
    let all = wins + none + losses;
    let left_of_one_lattice = |c: &Comparison| {
        let (left, right) = (Crossed::of(c.left.method)?, Crossed::of(c.right.method)?);
        (left.arrangement == right.arrangement).then_some(left.clustering)
    };
    let lefts = study.comparisons.iter().filter_map(left_of_one_lattice);
    let side = match lefts.into_iter().any(|left| left == Clustering::Integrated) {
        true => "",
        false => {
            "integrated is never on the left, so a preference for the right side cannot be distinguished"
        }
    };
    let reason = format!(
        "no test published; {wins} answers for integrated, {none} none, {losses} for the other; {side}"
    );
    let verdict = Verdict::not_comparable(reason.trim_end_matches("; "));
    (all > 0).then(|| Finding::of(Some(wins as f64 / all as f64), 3, verdict))
}

/// The share of direct answers for an arrangement, on the objects whose field `holds`.
fn arrangement_on(
    study: &Study,
    tally: &Tally,
    arrangement: Arrangement,
    holds: fn(&FieldSection) -> bool,
) -> Option<Finding> {
    let mut sum = ArrangementContest { object: None, group: None, body_centred: 0, none: 0, simple_cubic: 0 };
    for contest in arrangement_contests(study, tally) {
        let (Some(object), None) = (contest.object, contest.group) else { continue };
        if holds(&study.file.objects[object].field) {
            sum.body_centred += contest.body_centred;
            sum.none += contest.none;
            sum.simple_cubic += contest.simple_cubic;
        }
    }
    let (own, other) = match arrangement {
        Arrangement::BodyCentred => (sum.body_centred, sum.simple_cubic),
        Arrangement::SimpleCubic => (sum.simple_cubic, sum.body_centred),
        // The paper claims nothing about others.
        Arrangement::FiveTetrahedra | Arrangement::FaceCentred => return None,
    };
    let all = sum.body_centred + sum.none + sum.simple_cubic;
    let direction = if own > other { "in this direction" } else { "not in this direction" };
    let verdict = Verdict::not_comparable(format!("no number published; {direction}: {}", counts(&sum)));
    (all > 0).then(|| Finding::of(Some(own as f64 / all as f64), 3, verdict))
}
