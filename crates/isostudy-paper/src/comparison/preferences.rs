//! The two preference tables, cell by cell, in exact fractions.

use super::Compared;
use crate::verdict::{UNEXPLAINED, Verdict};
use isostudy_design::Study;
use isostudy_design::published::{PreferenceCell, PreferenceKind};
use isostudy_inference::fraction::Fraction;
use isostudy_inference::preference::{self, GroupFactor};
use isostudy_inference::tally::Tally;

/// Decimals that the paper prints.
const DECIMALS: u32 = 3;
/// One unit of the last printed digit: the printed numbers are rounded or truncated by no single rule.
const TOLERANCE: f64 = 0.001;

pub(super) fn compare(study: &Study, tally: &Tally) -> Vec<Compared> {
    let factors = preference::group_factors(study, tally, |_| true);
    let compare = |cell: &PreferenceCell| {
        let (exact, counts) = ours(study, &factors, cell)?;
        let quantity = match cell.kind {
            PreferenceKind::Group => "group factor",
            PreferenceKind::Overall => "sum of factors",
            PreferenceKind::ArrangementMean => "arrangement mean",
            PreferenceKind::ClusteringMean => "clustering mean",
        };
        Some(Compared {
            source: "preferences",
            row: [cell.group.as_str(), cell.of.as_str()].join(" ").trim().to_owned(),
            quantity: quantity.into(),
            published: cell.factor,
            ours: Some(exact.value()),
            decimals: DECIMALS as usize,
            verdict: verdict(cell.factor, exact, &counts),
        })
    };
    study.published.preferences.iter().filter_map(compare).collect()
}

/// Our exact number for a published cell, and the counts it comes from; `None` if the study lacks its parts.
fn ours(study: &Study, factors: &[GroupFactor], cell: &PreferenceCell) -> Option<(Fraction, String)> {
    let counts = |f: &GroupFactor| format!("{}/{}", f.share.wins, f.share.answers);
    match cell.kind {
        PreferenceKind::Group => {
            let method = cell.method()?;
            let factor =
                factors.iter().find(|f| study.groups[f.group].id == cell.group && f.method == method)?;
            Some((factor.share.factor(), counts(factor)))
        }
        PreferenceKind::Overall => {
            let method = cell.method()?;
            let sums = preference::overall(study, factors);
            let &(_, sum) = sums.iter().find(|(m, _)| *m == method)?;
            let parts: Vec<String> = factors.iter().filter(|f| f.method == method).map(counts).collect();
            Some((sum, parts.join(" + ")))
        }
        PreferenceKind::ArrangementMean | PreferenceKind::ClusteringMean => {
            let margins = preference::margins(study, &preference::overall(study, factors));
            let named = |level| study.level(level).code.to_lowercase() == cell.of;
            let &(_, mean) = margins.iter().find(|(level, _)| named(*level))?;
            Some((mean, mean.to_string()))
        }
    }
}

fn verdict(published: f64, exact: Fraction, counts: &str) -> Verdict {
    let printed = (published * 10_f64.powi(DECIMALS as i32)).round() as i128;
    if printed == exact.rounded(DECIMALS) {
        return Verdict::Equal;
    }
    let rounded = exact.rounded(DECIMALS) as f64 / 10_f64.powi(DECIMALS as i32);
    let reason = format!("printed {published:.3}; {counts} = {:.5} rounds to {rounded:.3}", exact.value());
    match (exact.value() - published).abs() <= TOLERANCE {
        true => Verdict::within(TOLERANCE.to_string(), reason),
        false => Verdict::differs(format!("{UNEXPLAINED}: {reason}")),
    }
}
