//! Tests of preference, by family.

use crate::ballots::BallotGroup;
use crate::hypotheses::{self, Hypothesis, Subject};
use crate::table::{Cell, Table};
use design::{Arrangement, Clustering, Study};
use rayon::prelude::*;
use statistics::bootstrap::Resampling;
use statistics::interval::Interval;
use statistics::{ChiSquareTest, ShownBallot, friedman, sign_test};

/// Every contrast of a study, then every question.
pub(super) fn study_tests(hypotheses: &[Hypothesis]) -> Table {
    table(hypotheses)
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
         the questions answered, \u{2212}1 to 1; interactions are differences of two mean scores, \u{2212}2 to 2, of those who \
         answered all of their questions. From and to: t interval at 95 % over participants, or, where all have one score, the \
         means that make this at least 2.5 % probable; BCa and studentised: 2000 resamples of participants; all are cut at what \
         scores can be. Equivalence: two one-sided t tests of a mean score within 0.2 of zero, which is 60 answers to 40, \
         adjusted in the same way. Conclusion: at 5 % of both adjusted p; a large p alone is open, not equal. p without one: \
         range when each participant in turn is left out. Binomial and trinomial treat all answers as independent and are \
         there for comparison; they hold for single questions only."
            .into(),
    );
    table
}

fn cells(row: &Hypothesis) -> Vec<Cell> {
    let (test, question) = (&row.test, matches!(row.subject, Subject::Question(_)));
    let cut = |i: Interval| i.cut(-test.reach, test.reach);
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
pub(super) fn omnibus(study: &Study, ballots: &[ShownBallot]) -> Table {
    let mut table = Table::new(
        "omnibus",
        "Does anything differ? Friedman's tests over participants",
        &[
            ("question", "Question"),
            ("scores", "Scores"),
            ("chi_square", "Chi-square"),
            ("degrees", "Degrees"),
            ("p", "p"),
            ("participants", "Participants"),
        ],
    );
    let StudyScores { clusterings, by_clustering, by_object } = study_scores(study, ballots);
    let cases = [
        ("clustering", "wins minus losses of each clustering", &clusterings),
        ("arrangement x clustering", "body-centred minus simple cubic, by clustering", &by_clustering),
        ("object x arrangement", "body-centred minus simple cubic, by object", &by_object),
    ];
    for (question, scores, rows) in cases {
        if let Some(ChiSquareTest { statistic, degrees, p }) = friedman(rows) {
            let people = Cell::count(rows.len() as u64);
            let numbers = [Cell::Number(statistic, 3), Cell::Number(degrees, 0), Cell::P(p, 5), people];
            table.push([Cell::text(question), Cell::text(scores)].into_iter().chain(numbers).collect());
        }
    }
    table
        .notes
        .push("Chi-square approximation with correction for ties; the blocks are the participants who answered all of its questions.".into());
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
pub(crate) fn study_scores(study: &Study, ballots: &[ShownBallot]) -> StudyScores {
    let methods = study.methods();
    let at = |clustering: Clustering| study.file.clusterings.iter().position(|&c| c == clustering);
    let sign = |b: &ShownBallot| b.outcome().sign() as f64;
    let clusterings = scores(ballots, study.file.clusterings.len(), |b| {
        let (left, right) = (methods[b.left()], methods[b.right()]);
        let same = left.arrangement == right.arrangement;
        let place = |clustering| if same { at(clustering) } else { None };
        [place(left.clustering).map(|c| (c, sign(b))), place(right.clustering).map(|c| (c, -sign(b)))]
    });
    let arrangement = |b: &ShownBallot| {
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

/// One row of sums for each participant who answered every question that has a part in them: what was not answered is not
/// zero, and people who stop before the last object would look as if they liked it less.
fn scores(
    ballots: &[ShownBallot],
    columns: usize,
    parts: impl Fn(&ShownBallot) -> [Option<(usize, f64)>; 2],
) -> Vec<Vec<f64>> {
    let people = ballots.iter().map(|ballot| ballot.participant() + 1).max().unwrap_or_default();
    let (mut sums, mut answered) = (vec![0.0; people * columns], vec![0; people]);
    let mut asked = vec![false; ballots.iter().map(|ballot| ballot.question() + 1).max().unwrap_or_default()];
    for ballot in ballots {
        let parts = parts(ballot);
        if parts.iter().any(Option::is_some) {
            asked[ballot.question()] = true;
            answered[ballot.participant()] += 1;
        }
        let row = ballot.participant() * columns;
        parts.into_iter().flatten().for_each(|(column, score)| sums[row + column] += score);
    }
    let all = asked.into_iter().filter(|asked| *asked).count();
    let complete = sums.chunks_exact(columns.max(1)).zip(answered).filter(|&(_, answered)| answered == all);
    if all == 0 { Vec::new() } else { complete.map(|(row, _)| row.to_vec()).collect() }
}

#[cfg(test)]
mod tests;
