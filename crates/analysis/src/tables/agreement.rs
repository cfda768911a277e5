//! Agreement of participants with each other and with themselves.

use crate::ballots::as_declared;
use crate::statistics::{
    Ballot, Metric, Triads, agreement as kendall, alpha, outcome_counts, screening, triads,
};
use crate::table::{Cell, Table};
use design::Study;

/// All questions, then each comparison group: agreement between participants, and circular triads within.
pub(super) fn agreement(study: &Study, ballots: &[Ballot]) -> Table {
    let mut table = Table::new(
        "agreement",
        "Agreement between participants, and consistency of each",
        &[
            ("scope", "Questions"),
            ("questions", "Number"),
            ("alpha_nominal", "Alpha, nominal"),
            ("alpha_ordinal", "Alpha, ordinal"),
            ("kendall_u", "Kendall's u"),
            ("chi_square", "Chi-square"),
            ("degrees", "Degrees"),
            ("p", "p"),
            ("triads", "Triads"),
            ("decided_triads", "all three decided"),
            ("strict_cycles", "strict cycles"),
            ("weak_cycles", "weak cycles"),
        ],
    );
    let ballots = as_declared(study, ballots);
    for group in std::iter::once(None).chain((0..study.groups.len()).map(Some)) {
        let inside = |b: &&Ballot| group.is_none_or(|g| study.comparisons[b.question].group == g);
        let own: Vec<Ballot> = ballots.iter().filter(inside).copied().collect();
        let counts: Vec<[u64; 3]> =
            outcome_counts(&own).into_iter().filter(|counts| counts.iter().sum::<u64>() > 0).collect();
        if counts.is_empty() {
            continue;
        }
        let found = kendall(&counts);
        let test = found.and_then(|found| found.test);
        let circles = triads_by_object_and_group(study, &own);
        let circle = |count: u64| if circles.all > 0 { Cell::count(count) } else { Cell::Missing };
        table.push(vec![
            Cell::text(group.map_or("all", |g| &study.groups[g].id)),
            Cell::count(counts.len() as u64),
            Cell::number(alpha(&counts, Metric::Nominal), 4),
            Cell::number(alpha(&counts, Metric::Ordinal), 4),
            Cell::number(found.map(|found| found.u), 4),
            Cell::number(test.map(|test| test.statistic), 2),
            Cell::number(test.map(|test| test.degrees), 2),
            Cell::number(test.map(|test| test.p), 5),
            circle(circles.all),
            circle(circles.decided),
            circle(circles.strict_cycles),
            circle(circles.weak_cycles),
        ]);
    }
    table.notes.push(
        "Alpha: Krippendorff's, over the sides left, none, right; 1 is full agreement, 0 chance. Kendall's u: a tie is half \
         an answer for each side; its test is without continuity correction. Triads: three items that one person compared \
         pairwise on one object; a quarter of decided triads is circular by chance. A weak cycle is two wins closed by a tie, \
         which need not be an error."
            .into(),
    );
    table
}

fn triads_by_object_and_group(study: &Study, ballots: &[Ballot]) -> Triads {
    let mut sum = Triads::default();
    for object in 0..study.file.objects.len() {
        for group in 0..study.groups.len() {
            let inside = |b: &&Ballot| {
                let comparison = &study.comparisons[b.question];
                comparison.object == object && comparison.group == group
            };
            let own: Vec<Ballot> = ballots.iter().filter(inside).copied().collect();
            sum = sum.and(triads(&own));
        }
    }
    sum
}

/// One row a participant: what careless answering would show in.
pub(crate) fn respondents(ballots: &[Ballot]) -> Table {
    let mut table = Table::new(
        "respondents",
        "Screening of participants; nobody is left out",
        &[
            ("respondent", "Respondent"),
            ("left", "Left"),
            ("no_preference", "None"),
            ("right", "Right"),
            ("one_sidedness", "(L - R) / (L + R)"),
            ("longest_run", "Longest run"),
            ("comparable", "Comparable"),
            ("agreeing", "Agreeing"),
            ("agreement", "Agreement"),
        ],
    );
    for seen in screening(ballots) {
        let [left, none, right] = seen.answers;
        table.push(vec![
            Cell::count(seen.participant as u64 + 1),
            Cell::count(left),
            Cell::count(none),
            Cell::count(right),
            Cell::number(seen.one_sidedness(), 3),
            Cell::count(seen.longest_run),
            Cell::count(seen.comparable),
            Cell::count(seen.agreeing),
            Cell::number(seen.agreement(), 3),
        ]);
    }
    table.notes.push(
        "Agreement: share of the decided answers that side with the majority of the others' decided answers, where they have \
         one. Longest run: of one side, in the order of questions of the study. Seen after the outcome: a reason to look, not \
         to exclude. What results would be without any one participant is in the tests' leave-one-out range."
            .into(),
    );
    table
}

#[cfg(test)]
mod tests;
