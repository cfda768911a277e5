//! Tests of preference, by family.

use crate::ballots::BallotGroup;
use crate::hypotheses::{self, Hypothesis, Subject};
use crate::interval::Interval;
use crate::statistics::bootstrap::Resampling;
use crate::statistics::{Ballot, ChiSquareTest, friedman, sign_test};
use crate::table::{Cell, Table};
use design::{Arrangement, Clustering, Study};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Every contrast of a study, then every question.
pub(super) fn study_tests(study: &Study, ballots: &[Ballot]) -> Table {
    table(&hypotheses::of_study(study, ballots))
}

/// Every pair of items that was compared, group by group; the group is the family.
///
/// Nothing but ballots is needed, so that answers without a study file have the same table.
pub fn pair_tests(groups: &[BallotGroup]) -> Table {
    table(&hypotheses::of_groups(groups))
}

fn table(rows: &[Hypothesis]) -> Table {
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
            ("studentised_low", "studentised from"),
            ("studentised_high", "studentised to"),
            ("p_equivalence", "p of equivalence"),
            ("conclusion", "Conclusion"),
            ("p_without_one_low", "p without one: from"),
            ("p_without_one_high", "to"),
            ("p_binomial", "p binomial"),
            ("p_trinomial", "p trinomial"),
        ],
    );
    let cells: Vec<Vec<Cell>> = rows.par_iter().map(cells).collect();
    cells.into_iter().for_each(|cells| table.push(cells));
    let blocks: [(&str, &[&str]); 3] = [
        (
            "Answers, and tests of no preference",
            &[
                "family",
                "contrast",
                "scope",
                "first",
                "no_preference",
                "second",
                "net",
                "participants",
                "p_sign_flip",
                "p_adjusted",
                "adjustment",
                "conclusion",
            ],
        ),
        (
            "Mean scores, and tests of equivalence",
            &[
                "family",
                "contrast",
                "scope",
                "mean",
                "low",
                "high",
                "bca_low",
                "bca_high",
                "studentised_low",
                "studentised_high",
                "p_equivalence",
            ],
        ),
        (
            "With one participant left out, and as if answers were independent",
            &[
                "family",
                "contrast",
                "scope",
                "p_without_one_low",
                "p_without_one_high",
                "p_binomial",
                "p_trinomial",
            ],
        ),
    ];
    table.print_in_blocks(&blocks);
    table.notes.push(
        "p: exact sign-flip test over participants, two-sided; net is answers for the first minus answers for the second. \
         Adjusted within the family: Holm, for single questions Benjamini and Hochberg. Mean score: a participant's net over \
         the questions answered, \u{2212}1 to 1; from and to: t interval at 95 % over participants, or, where all have one \
         score, the means that make this at least 2.5 % probable; BCa and studentised: 2000 resamples of participants. All intervals are cut at \u{2212}1 and 1. Equivalence: two one-sided t tests of a mean score within 0.2 of zero, which is 60 \
         answers to 40, adjusted in the same way. Conclusion: at 5 % of both adjusted p; a large p alone is open, not equal. \
         p without one: range when each participant in turn is left out. Interactions are differences of two \
         mean scores, weighed to whole numbers. Binomial and trinomial treat all answers as independent and are there for \
         comparison; they hold for single questions only."
            .into(),
    );
    table
}

fn cells(row: &Hypothesis) -> Vec<Cell> {
    let cut = |i: Interval| i.cut(-1.0, 1.0);
    let (test, question) = (&row.test, matches!(row.subject, Subject::Question(_)));
    let resampling = Resampling::default();
    let of_bca = if question { None } else { test.bca(resampling) };
    let of_studentised = if question { None } else { test.studentised(resampling) };
    let interval = test.interval.map(cut);
    let [bca, studentised] = [of_bca, of_studentised].map(|of| of.map(|of| cut(of.interval)));
    let without = test.leave_one_out();
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
        Cell::P(test.sign_flip.p(), 5),
        Cell::P(row.adjusted, 4),
        Cell::text(row.adjustment.label()),
        Cell::of_sum(Some(test.mean), 3),
        Cell::of_sum(interval.map(|i| i.low), 3),
        Cell::of_sum(interval.map(|i| i.high), 3),
        Cell::of_sum(bca.map(|i| i.low), 3),
        Cell::of_sum(bca.map(|i| i.high), 3),
        Cell::of_sum(studentised.map(|i| i.low), 3),
        Cell::of_sum(studentised.map(|i| i.high), 3),
        Cell::p(row.equivalence, 4),
        Cell::text(row.conclusion().label()),
        Cell::p(without.map(|(low, _)| low), 4),
        Cell::p(without.map(|(_, high)| high), 4),
        Cell::p(binomial, 4),
        Cell::p(trinomial, 4),
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
    let StudyScores { clusterings, by_clustering, by_object } = study_scores(study, ballots);
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
            let numbers = [Cell::Number(statistic, 3), Cell::Number(degrees, 0), Cell::P(p, 5)];
            table.push([Cell::text(question), Cell::text(scores)].into_iter().chain(numbers).collect());
        }
    }
    table
        .notes
        .push("Chi-square approximation with correction for ties; participants are the blocks.".into());
    table
}

/// One row of sums a participant, for [`friedman`].
pub(crate) struct StudyScores {
    /// Wins less losses of each clustering.
    pub(crate) clusterings: Vec<Vec<f64>>,
    /// Body-centred less simple cubic, by clustering.
    pub(crate) by_clustering: Vec<Vec<f64>>,
    /// Body-centred less simple cubic, by object.
    pub(crate) by_object: Vec<Vec<f64>>,
}

/// Sums over the questions that differ in one property alone.
pub(crate) fn study_scores(study: &Study, ballots: &[Ballot]) -> StudyScores {
    let methods = study.methods();
    let at = |clustering: Clustering| study.file.clusterings.iter().position(|&c| c == clustering);
    let sign = |b: &Ballot| b.outcome().sign() as f64;
    let clusterings = scores(ballots, study.file.clusterings.len(), |b| {
        let (left, right) = (methods[b.left()], methods[b.right()]);
        let same = left.arrangement == right.arrangement;
        let place = |clustering| if same { at(clustering) } else { None };
        [place(left.clustering).map(|c| (c, sign(b))), place(right.clustering).map(|c| (c, -sign(b)))]
    });
    let arrangement = |b: &Ballot| {
        let (left, right) = (methods[b.left()], methods[b.right()]);
        let direct = left.clustering == right.clustering && left.arrangement != right.arrangement;
        let towards = if left.arrangement == Arrangement::BodyCentred { 1.0 } else { -1.0 };
        direct.then(|| towards * sign(b))
    };
    let by_clustering = scores(ballots, study.file.clusterings.len(), |b| {
        [arrangement(b).and_then(|score| Some((at(methods[b.left()].clustering)?, score))), None]
    });
    let by_object = scores(ballots, study.file.objects.len(), |b| {
        [arrangement(b).map(|score| (study.comparisons[b.question()].object, score)), None]
    });
    StudyScores { clusterings, by_clustering, by_object }
}

/// One row of sums a participant; participants and columns without any answer stay at zero.
fn scores(
    ballots: &[Ballot],
    columns: usize,
    parts: impl Fn(&Ballot) -> [Option<(usize, f64)>; 2],
) -> Vec<Vec<f64>> {
    let mut rows: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for ballot in ballots {
        let row = rows.entry(ballot.participant()).or_insert_with(|| vec![0.0; columns]);
        parts(ballot).into_iter().flatten().for_each(|(column, score)| row[column] += score);
    }
    rows.into_values().collect()
}

#[cfg(test)]
mod tests;
