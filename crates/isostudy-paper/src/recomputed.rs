//! Published numbers and claims beside ours, counted by verdict.

use crate::claims;
use crate::comparison::Compared;
use crate::verdict::Verdict;
use isostudy_design::published::Claim;
use isostudy_report::statement::{Block, Finding, Standing};
use isostudy_report::words::{counted, list, number};

pub(super) fn findings(
    source: &str,
    numbers: &[Compared],
    claims: &[(&Claim, claims::Finding)],
) -> Vec<Block> {
    let mut found = Vec::new();
    if !numbers.is_empty() {
        let tallied = tallied(numbers.iter().map(|c| &c.verdict));
        found.push(format!("Of {} of {source}, {tallied}.", counted(numbers.len(), "number")));
    }
    if !claims.is_empty() {
        let tallied = tallied(claims.iter().map(|(_, found)| &found.verdict));
        found.push(format!("Of {} of its text, {tallied}.", counted(claims.len(), "claim")));
    }
    found.into_iter().map(|text| Block::Finding(Finding::new(Standing::Noted, text))).collect()
}

/// Each claim of the text that differs here, and why.
pub(super) fn failing(claims: &[(&Claim, claims::Finding)]) -> Vec<Block> {
    let mut found = Vec::new();
    for (claim, finding) in claims {
        if let Verdict::Differs { reason } = &finding.verdict {
            let numbers = match (claim.value, finding.ours) {
                (Some(published), Some(ours)) => {
                    let d = finding.decimals;
                    format!(", published as {}, is {} here", number(published, d), number(ours, d))
                }
                _ => " does not hold".into(),
            };
            found.push(format!(
                "\u{201c}{}\u{201d}{numbers}: {reason}.",
                claim.statement.trim_end_matches('.')
            ));
        }
    }
    found.into_iter().map(|text| Block::Finding(Finding::new(Standing::Fails, text))).collect()
}

/// `12 are equal, 3 differ and 1 is not comparable`.
fn tallied<'a>(verdicts: impl Iterator<Item = &'a Verdict>) -> String {
    let (mut equal, mut within, mut differ, mut unexplained, mut apart) = (0, 0, 0, 0, 0);
    for verdict in verdicts {
        *match verdict {
            Verdict::Equal => &mut equal,
            Verdict::WithinTolerance { .. } => &mut within,
            verdict if verdict.is_unexplained() => &mut unexplained,
            Verdict::Differs { .. } => &mut differ,
            Verdict::NotComparable { .. } => &mut apart,
        } += 1;
    }
    let be = |n: usize| if n == 1 { "is" } else { "are" };
    let parts = [
        (equal, format!("{equal} {} equal to every printed digit", be(equal))),
        (within, format!("{within} {} within a stated tolerance", be(within))),
        (differ, format!("{differ} {} for a stated reason", if differ == 1 { "differs" } else { "differ" })),
        (
            unexplained,
            format!("{unexplained} {} without one", if unexplained == 1 { "differs" } else { "differ" }),
        ),
        (apart, format!("{apart} {} not comparable", be(apart))),
    ];
    let kept: Vec<String> = parts.into_iter().filter(|(n, _)| *n > 0).map(|(_, text)| text).collect();
    list(&kept)
}
