//! What each answer counts towards a participant's score, known before anyone answers.

use isostudy_design::Study;
use isostudy_design::contrast::Contrast;
use std::collections::BTreeMap;

/// Scores are rounded to multiples of one over this where they have no unit as coarse.
const FINEST: i64 = 840;

/// What answers count towards a participant's score, by block; nothing where no score comes of them. As in
/// [`ScoreTest`](isostudy_statistics::ScoreTest), but known beforehand, since everybody answers what is asked: a mean of answers, or of a
/// difference the mean over strata in which both parts are asked, else the difference of two means.
pub(super) fn weights(study: &Study, contrast: &Contrast, blocks: &[Vec<usize>]) -> Vec<Vec<(usize, i64)>> {
    let fractions: Vec<Vec<(usize, i64, i64)>> =
        blocks.iter().map(|asked| shares(study, contrast, asked)).collect();
    let unit =
        |unit: i64, &(_, _, of): &(usize, i64, i64)| (unit / common_divisor(unit, of)).saturating_mul(of);
    let unit = fractions.iter().flatten().fold(1, unit).min(FINEST);
    let whole = |&(question, sign, of): &(usize, i64, i64)| (question, sign * ((2 * unit + of) / (2 * of)));
    fractions.iter().map(|own| own.iter().map(whole).collect()).collect()
}

/// Question, sign and denominator: what each answer that is asked counts.
fn shares(study: &Study, contrast: &Contrast, asked: &[usize]) -> Vec<(usize, i64, i64)> {
    if !contrast.counts(|question| asked.contains(&question)) {
        return Vec::new();
    }
    // Questions of each part by stratum.
    let mut strata: BTreeMap<usize, [Vec<(usize, i64)>; 2]> = BTreeMap::new();
    for (place, part) in contrast.parts.iter().enumerate() {
        for (&question, &sign) in part.iter().filter(|(question, _)| asked.contains(question)) {
            let stratum = if contrast.is_difference() { contrast.stratum(study, question) } else { 0 };
            strata.entry(stratum).or_default()[place].push((question, if place == 0 { sign } else { -sign }));
        }
    }
    let mut strata: Vec<[Vec<(usize, i64)>; 2]> = strata.into_values().collect();
    if strata.iter().any(|[first, second]| !first.is_empty() && !second.is_empty()) {
        strata.retain(|[first, second]| !first.is_empty() && !second.is_empty());
    } else {
        let all = |place: usize| strata.iter().flat_map(|parts| parts[place].iter().copied()).collect();
        strata = vec![[all(0), all(1)]];
    }
    let count = strata.len() as i64;
    let of_part = |part: Vec<(usize, i64)>| {
        let of = count * part.len() as i64;
        part.into_iter().map(move |(question, sign)| (question, sign, of))
    };
    strata.into_iter().flatten().flat_map(of_part).collect()
}

fn common_divisor(a: i64, b: i64) -> i64 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}
