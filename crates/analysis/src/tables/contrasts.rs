//! Tests of preference, by family.

use super::models::BOOTSTRAP_LIMIT;
use crate::ballots::{BallotGroup, as_declared};
use crate::statistics::bootstrap::Resampling;
use crate::statistics::contrast::{Contrast, ContrastTest, contrasts};
use crate::statistics::{Ballot, ChiSquareTest, benjamini_hochberg, friedman, holm, sign_test};
use crate::table::{Cell, Table};
use design::{Arrangement, Clustering, Study};
use std::collections::BTreeMap;

/// One row before its p is adjusted.
struct Row {
    family: String,
    contrast: String,
    scope: String,
    test: ContrastTest,
}

/// Family of the single questions: exploratory, adjusted by Benjamini and Hochberg instead of Holm.
const QUESTIONS: &str = "questions";

/// Every contrast of a study, then every question.
pub(super) fn study_tests(study: &Study, ballots: &[Ballot]) -> Table {
    let row = |contrast: Contrast| Row {
        family: contrast.family.code().into(),
        test: contrast.test(ballots),
        contrast: contrast.name,
        scope: contrast.scope,
    };
    let mut rows: Vec<Row> = contrasts(study).into_iter().map(row).collect();
    let declared = as_declared(study, ballots);
    for (question, comparison) in study.comparisons.iter().enumerate() {
        let own = declared.iter().filter(|b| b.question == question);
        rows.push(Row {
            family: QUESTIONS.into(),
            contrast: format!("{}-{}", comparison.left.method, comparison.right.method),
            scope: comparison.question.clone(),
            test: ContrastTest::of(own.map(|b| (b.participant, 1, b.outcome))),
        });
    }
    table(rows)
}

/// Every pair of items that was compared, group by group; the group is the family.
///
/// Nothing but ballots is needed, so that answers without a study file have the same table.
pub fn pair_tests(groups: &[BallotGroup]) -> Table {
    let mut rows = Vec::new();
    for group in groups {
        for (i, first) in group.items.iter().enumerate() {
            for (j, second) in group.items.iter().enumerate().skip(i + 1) {
                let weight = |b: &Ballot| match (b.left, b.right) {
                    (l, r) if (l, r) == (i, j) => Some((b.participant, 1, b.outcome)),
                    (l, r) if (l, r) == (j, i) => Some((b.participant, -1, b.outcome)),
                    _ => None,
                };
                let test = ContrastTest::of(group.ballots.iter().filter_map(weight));
                let (family, contrast) = (group.name.clone(), format!("{first}-{second}"));
                if !test.differences.is_empty() {
                    rows.push(Row { family, contrast, scope: "all".into(), test });
                }
            }
        }
    }
    table(rows)
}

fn table(rows: Vec<Row>) -> Table {
    let mut table = Table::new(
        "tests",
        "Tests of preference",
        &[
            ("family", "Family"),
            ("contrast", "Contrast"),
            ("scope", "Scope"),
            ("first", "First"),
            ("no_preference", "None"),
            ("second", "Second"),
            ("net", "Net"),
            ("participants", "Participants"),
            ("p_sign_flip", "p"),
            ("p_adjusted", "p adjusted"),
            ("adjustment", "Adjustment"),
            ("mean", "Mean score"),
            ("low", "from"),
            ("high", "to"),
            ("bca_low", "BCa from"),
            ("bca_high", "BCa to"),
            ("p_without_one_low", "p without one: from"),
            ("p_without_one_high", "to"),
            ("p_binomial", "p binomial"),
            ("p_trinomial", "p trinomial"),
        ],
    );
    let mut families: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    rows.iter().enumerate().for_each(|(i, row)| families.entry(&row.family).or_default().push(i));
    let mut adjusted = vec![0.0; rows.len()];
    for (family, members) in families {
        let p: Vec<f64> = members.iter().map(|&i| rows[i].test.sign_flip.p()).collect();
        let p = if family == QUESTIONS { benjamini_hochberg(&p) } else { holm(&p) };
        members.iter().zip(p).for_each(|(&i, p)| adjusted[i] = p);
    }
    for (row, adjusted) in rows.iter().zip(adjusted) {
        table.push(cells(row, adjusted));
    }
    table.notes.push(
        "p: exact sign-flip test over participants, two-sided; net is answers for the first minus answers for the second. \
         Adjusted within the family: Holm, for single questions Benjamini and Hochberg. Mean score: a participant's net over \
         the questions answered, -1 to 1; from and to: t interval at 95 % over participants; BCa: 2000 resamples of \
         participants. p without one: range when each participant in turn is left out. Interactions are differences of two \
         mean scores, weighed to whole numbers. Binomial and trinomial treat all answers as independent and are there for \
         comparison; they hold for single questions only. A large p is no evidence of equality: read the interval."
            .into(),
    );
    table
}

fn cells(row: &Row, adjusted: f64) -> Vec<Cell> {
    let (test, question) = (&row.test, row.family == QUESTIONS);
    let small = test.differences.len() <= BOOTSTRAP_LIMIT;
    let resampled = if small && !question { test.bca(Resampling::default()) } else { None };
    let without = if small { test.leave_one_out() } else { None };
    let count = |o: usize| test.counts.map_or(Cell::Missing, |counts| Cell::count(counts[o]));
    let binomial = test.counts.map(|[first, _, second]| sign_test::binomial(first, second));
    let trinomial = test.counts.filter(|_| question).map(|[a, t, b]| sign_test::trinomial(a, t, b));
    vec![
        Cell::text(&row.family),
        Cell::text(&row.contrast),
        Cell::text(&row.scope),
        count(0),
        count(1),
        count(2),
        Cell::Count(test.sign_flip.net),
        Cell::count(test.sign_flip.participants as u64),
        Cell::Number(test.sign_flip.p(), 5),
        Cell::Number(adjusted, 4),
        Cell::text(if question { "Benjamini-Hochberg" } else { "Holm" }),
        Cell::Number(test.mean, 3),
        Cell::number(test.interval.map(|i| i.low), 3),
        Cell::number(test.interval.map(|i| i.high), 3),
        Cell::number(resampled.map(|r| r.interval.low), 3),
        Cell::number(resampled.map(|r| r.interval.high), 3),
        Cell::number(without.map(|(low, _)| low), 4),
        Cell::number(without.map(|(_, high)| high), 4),
        Cell::number(binomial, 4),
        Cell::number(trinomial, 4),
    ]
}

/// Friedman's tests: does anything differ at all?
pub(super) fn omnibus(study: &Study, ballots: &[Ballot]) -> Table {
    let mut table = Table::new(
        "omnibus",
        "Does anything differ? Friedman's tests over participants",
        &[
            ("question", "Question"),
            ("scores", "Scores"),
            ("chi_square", "Chi-square"),
            ("degrees", "Degrees"),
            ("p", "p"),
        ],
    );
    let methods = study.methods();
    let at = |clustering: Clustering| study.file.clusterings.iter().position(|&c| c == clustering);
    let sign = |b: &Ballot| b.outcome.sign() as f64;
    let clusterings = scores(ballots, study.file.clusterings.len(), |b| {
        let (left, right) = (methods[b.left], methods[b.right]);
        let same = left.arrangement == right.arrangement;
        let place = |clustering| if same { at(clustering) } else { None };
        [place(left.clustering).map(|c| (c, sign(b))), place(right.clustering).map(|c| (c, -sign(b)))]
    });
    let arrangement = |b: &Ballot| {
        let (left, right) = (methods[b.left], methods[b.right]);
        let direct = left.clustering == right.clustering && left.arrangement != right.arrangement;
        let towards = if left.arrangement == Arrangement::BodyCentred { 1.0 } else { -1.0 };
        direct.then(|| towards * sign(b))
    };
    let by_clustering = scores(ballots, study.file.clusterings.len(), |b| {
        [arrangement(b).and_then(|score| Some((at(methods[b.left].clustering)?, score))), None]
    });
    let by_object = scores(ballots, study.file.objects.len(), |b| {
        [arrangement(b).map(|score| (study.comparisons[b.question].object, score)), None]
    });
    let cases = [
        ("clustering", "wins minus losses of each clustering", friedman(&clusterings)),
        (
            "arrangement x clustering",
            "body-centred minus simple cubic, by clustering",
            friedman(&by_clustering),
        ),
        ("object x arrangement", "body-centred minus simple cubic, by object", friedman(&by_object)),
    ];
    for (question, scores, test) in cases {
        if let Some(ChiSquareTest { statistic, degrees, p }) = test {
            let numbers = [Cell::Number(statistic, 3), Cell::Number(degrees, 0), Cell::Number(p, 5)];
            table.push([Cell::text(question), Cell::text(scores)].into_iter().chain(numbers).collect());
        }
    }
    table
        .notes
        .push("Chi-square approximation with correction for ties; participants are the blocks.".into());
    table
}

/// One row of sums a participant; participants and columns without any answer stay at zero.
fn scores(
    ballots: &[Ballot],
    columns: usize,
    parts: impl Fn(&Ballot) -> [Option<(usize, f64)>; 2],
) -> Vec<Vec<f64>> {
    let mut rows: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for ballot in ballots {
        let row = rows.entry(ballot.participant).or_insert_with(|| vec![0.0; columns]);
        parts(ballot).into_iter().flatten().for_each(|(column, score)| row[column] += score);
    }
    rows.into_values().collect()
}

#[cfg(test)]
mod tests;
