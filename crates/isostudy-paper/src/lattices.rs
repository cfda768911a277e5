//! Body-centred against simple cubic, where nothing else differs: the paper's direct evidence on its two lattices.

use isostudy_design::{Arrangement, Comparison, Crossed, Study};
use isostudy_inference::tally::{QuestionCount, Tally};
use isostudy_table::digits::counted;
use isostudy_table::{Cell, Columns, Table};

/// One object's answers to the questions that differ in arrangement alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ArrangementContest {
    /// Index of the object; `None` is all objects together.
    pub(super) object: Option<usize>,
    /// Index of the group; `None` is all groups together.
    pub(super) group: Option<usize>,
    /// Answers for body-centred.
    pub(super) body_centred: u64,
    /// Answers without preference.
    pub(super) none: u64,
    /// Answers for simple cubic.
    pub(super) simple_cubic: u64,
}

/// The lattices that a question compares, everything else equal; `None` if it does not.
fn lattices(comparison: &Comparison) -> Option<[Arrangement; 2]> {
    let (left, right) = (Crossed::of(comparison.left.method)?, Crossed::of(comparison.right.method)?);
    let alone = left.clustering == right.clustering && left.arrangement != right.arrangement;
    alone.then_some([left.arrangement, right.arrangement])
}

/// Whether a question compares the body-centred with the simple cubic lattice, everything else equal.
fn is_direct(comparison: &Comparison) -> bool {
    let papers = |a| matches!(a, Arrangement::BodyCentred | Arrangement::SimpleCubic);
    lattices(comparison).is_some_and(|both| both.into_iter().all(papers))
}

/// How many questions compare lattices, everything else equal, and are not in [`arrangement_contests`], because one of the
/// two is another lattice.
pub(super) fn other_arrangement_questions(study: &Study) -> usize {
    study.comparisons.iter().filter(|c| lattices(c).is_some() && !is_direct(c)).count()
}

/// Body-centred against simple cubic where nothing else differs: by object and group, by object, then pooled. Counted are
/// questions, whatever else their groups compare.
///
/// This is the direct evidence on arrangements; sums over clustering groups carry none, because the members of such a
/// group share their arrangement. Empty if the study never compares the two.
pub(super) fn arrangement_contests(study: &Study, tally: &Tally) -> Vec<ArrangementContest> {
    let direct: Vec<(&Comparison, &QuestionCount)> = study
        .comparisons
        .iter()
        .zip(&tally.questions)
        .filter(|(comparison, _)| is_direct(comparison))
        .collect();
    let contest = |object: Option<usize>, group: Option<usize>| {
        let mut sum = ArrangementContest { object, group, body_centred: 0, none: 0, simple_cubic: 0 };
        let own = direct.iter().filter(|(comparison, _)| {
            object.is_none_or(|o| comparison.object == o) && group.is_none_or(|g| comparison.group == g)
        });
        for (comparison, count) in own {
            let straight = lattices(comparison).is_some_and(|[left, _]| left == Arrangement::BodyCentred);
            let (body, simple) = if straight { (count.left, count.right) } else { (count.right, count.left) };
            sum.body_centred += body;
            sum.none += count.none;
            sum.simple_cubic += simple;
        }
        sum
    };
    let mut contests = Vec::new();
    for object in (0..study.file.objects.len()).map(Some).chain([None]) {
        contests.extend((0..study.groups.len()).map(|g| contest(object, Some(g))));
        contests.push(contest(object, None));
    }
    contests.retain(|c| c.body_centred + c.none + c.simple_cubic > 0);
    contests
}

pub(super) fn table(study: &Study, tally: &Tally) -> Option<Table> {
    let of = |contest: &ArrangementContest| -> [&str; 2] {
        let object = contest.object.map_or("all", |o| &study.file.objects[o].name);
        [object, contest.group.map_or("all", |g| &study.groups[g].id)]
    };
    let mut table = Columns::over(arrangement_contests(study, tally))
        .column("object", "Object", |contest| Cell::text(of(contest)[0]))
        .column("group", "Group", |contest| Cell::text(of(contest)[1]))
        .column("body_centred", "Body-centred", |contest| Cell::count(contest.body_centred))
        .column("no_preference", "No preference", |contest| Cell::count(contest.none))
        .column("simple_cubic", "Simple cubic", |contest| Cell::count(contest.simple_cubic))
        .into_table(
            "preference_arrangements",
            "Body-centred against simple cubic, where nothing else differs",
        )
        .with_note("Counts of answers; the direct evidence on arrangements.");
    let others = other_arrangement_questions(study);
    if others > 0 {
        let noun = counted(others, "question");
        table.notes.push(format!("Left out: {noun} on other lattices. The table of tests has every pair."));
    }
    table.unless_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    #[test]
    fn direct_contests_of_arrangements() {
        let study = fixture::study();
        let contests = arrangement_contests(&study, &Tally::of(&fixture::answers(&study), &study));
        let find = |object, group| {
            let contest = contests.iter().find(|c| c.object == object && c.group == group).unwrap();
            (contest.body_centred, contest.none, contest.simple_cubic)
        };
        // Counted by hand.
        assert_eq!(find(None, None), (84, 22, 56));
        assert_eq!(find(Some(0), None), (44, 5, 5));
        let (asteroid, bunny) = (find(Some(1), None), find(Some(2), None));
        assert_eq!((asteroid.0 + bunny.0, asteroid.1 + bunny.1, asteroid.2 + bunny.2), (40, 17, 51));
        assert_eq!([2, 3, 4].map(|g| find(None, Some(g))), [(36, 8, 10), (20, 7, 27), (28, 7, 19)]);
    }
}
