//! The tests with everybody, and without those who broke a rule: nobody is left out silently.

use isostudy_design::Study;
use isostudy_inference::answered::Answered;
use isostudy_inference::ballots::{BallotGroup, declared};
use isostudy_inference::hypotheses::{self, Hypothesis};
use isostudy_inference::recorded::Recorded;
use isostudy_statistics::{DeclaredBallot, Flag, screening_with};
use isostudy_table::{Cell, Table};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// Every contrast of a study with everybody, those included whom the study leaves out; single questions are left out.
/// `recorded` is what is screened.
pub(super) fn of_study(study: &Study, answers: &Answered, recorded: &Recorded<'_>) -> Table {
    let everyone = match answers.excluded.is_empty() {
        true => Cow::Borrowed(&answers.declared),
        false => Cow::Owned(declared(study, &answers.everyone(study))),
    };
    let own = hypotheses::of_contrasts(study, &everyone);
    screened(recorded, &own.iter().collect::<Vec<_>>(), |keep| {
        let kept: Vec<DeclaredBallot> = everyone.iter().filter(|b| keep(b.participant())).copied().collect();
        hypotheses::of_contrasts(study, &kept)
    })
}

/// Every pair of items, group by group: [`pair_tests`](crate::pair_tests) with everybody and without. `recorded` is what is
/// screened.
pub fn screened_pair_tests(groups: &[BallotGroup], recorded: &Recorded<'_>) -> Table {
    let hypotheses = hypotheses::of_groups(groups);
    screened(recorded, &hypotheses.iter().collect::<Vec<_>>(), |keep| {
        let kept = |group: &BallotGroup| BallotGroup {
            ballots: group.ballots.iter().filter(|b| keep(b.participant())).copied().collect(),
            ..group.clone()
        };
        hypotheses::of_groups(&groups.iter().map(kept).collect::<Vec<_>>())
    })
}

fn screened(
    recorded: &Recorded<'_>,
    all: &[&Hypothesis],
    tested: impl Fn(&dyn Fn(usize) -> bool) -> Vec<Hypothesis>,
) -> Table {
    let mut table = Table::new(
        "screened",
        "Tests with everybody, and without those who broke a rule",
        &[
            ("rule", "Rule"),
            ("left_out", "Left out"),
            ("respondents", "Respondents"),
            ("family", "Family"),
            ("contrast", "Contrast"),
            ("scope", "Scope"),
            ("mean", "Mean score"),
            ("p_adjusted", "p adjusted"),
            ("conclusion", "Conclusion"),
            ("mean_without", "Mean score"),
            ("p_without", "p"),
            ("p_adjusted_without", "p adjusted"),
            ("conclusion_without", "Conclusion"),
        ],
    );
    let mut broken: BTreeMap<Option<Flag>, BTreeSet<usize>> = BTreeMap::new();
    let protocol = recorded.protocol();
    for seen in screening_with(recorded.ballots(), &protocol) {
        let flags = seen.flags(&protocol);
        let any = (!flags.is_empty()).then_some(None);
        for rule in flags.into_iter().map(Some).chain(any) {
            broken.entry(rule).or_default().insert(seen.participant);
        }
    }
    // One rule alone says what "any" would.
    if broken.len() == 2 {
        broken.remove(&None);
    }
    for (rule, people) in broken {
        let others = tested(&|participant| !people.contains(&participant));
        // What nobody answered at all does not come out otherwise without anybody.
        for &with in all.iter().filter(|with| with.is_tested()) {
            let without = others.iter().find(|other| with.is_about_the_same(other));
            let answered = without.filter(|other| other.is_tested());
            table.push(vec![
                Cell::text(rule.map_or("any", Flag::code)),
                Cell::count(people.len() as u64),
                Cell::text(numbers(&people)),
                Cell::text(&with.family),
                Cell::text(&with.contrast),
                Cell::text(&with.scope),
                Cell::of_sum(Some(with.test.mean), 3),
                Cell::P(with.adjusted, 4),
                Cell::text(with.conclusion().label()),
                Cell::of_sum(answered.map(|other| other.test.mean), 3),
                Cell::p(answered.map(|other| other.test.sign_flip.p()), 5),
                Cell::p(answered.map(|other| other.adjusted), 4),
                Cell::text(answered.map_or("nobody left", |other| other.conclusion().label())),
            ]);
        }
    }
    let blocks: [(&str, &[&str]); 2] = [
        (
            "With everybody",
            &[
                "rule",
                "left_out",
                "respondents",
                "family",
                "contrast",
                "scope",
                "mean",
                "p_adjusted",
                "conclusion",
            ],
        ),
        (
            "Without them",
            &[
                "rule",
                "family",
                "contrast",
                "scope",
                "mean_without",
                "p_without",
                "p_adjusted_without",
                "conclusion_without",
            ],
        ),
    ];
    table.print_in_blocks(&blocks);
    table.notes.push(
        "For each rule that somebody broke, the same tests without them; the rules are under the table of respondents. Both \
         halves are about all participants, also where other tables leave some out."
            .into(),
    );
    table
}

/// Numbers from 1, the first ten of them.
fn numbers(people: &BTreeSet<usize>) -> String {
    const MOST: usize = 10;
    let first: Vec<String> = people.iter().take(MOST).map(|p| (p + 1).to_string()).collect();
    let more = people.len().saturating_sub(MOST);
    if more > 0 { format!("{} and {more} more", first.join(" ")) } else { first.join(" ") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;
    use isostudy_inference::ballots::ballot_groups;

    fn cell(table: &Table, keys: &[&str], column: &str) -> Cell {
        let place = |name: &str| table.columns.iter().position(|c| c.name == name).unwrap();
        let holds = |row: &&Vec<Cell>| {
            ["rule", "contrast", "scope"]
                .iter()
                .zip(keys)
                .all(|(name, key)| row[place(name)].in_full() == *key)
        };
        let found: Vec<&Vec<Cell>> = table.rows.iter().filter(holds).collect();
        assert_eq!(found.len(), 1, "{keys:?}");
        found[0][place(column)].clone()
    }

    #[test]
    fn the_papers_tests_without_respondent_sixteen() {
        let study = fixture::study();
        let answered = fixture::answered(&study);
        let ballots = &answered.shown;
        let recorded = Recorded::of_study(&study, &answered.responses, ballots);
        let table = of_study(&study, &answered, &recorded);
        assert_eq!(table.rows.len(), 4 + 9 + 3 + 9 + 6 + 3 + 9);
        let of = |column| cell(&table, &["outlying", "B-S", "all"], column).shown();
        assert_eq!(
            (of("left_out"), of("respondents"), of("mean")),
            ("1".into(), "16".into(), "0.173".into())
        );
        // p without 16 is one end of the leave-one-out range or inside it: docs/statistics.md, 0.0063 to 0.0188.
        let Cell::P(p, _) = cell(&table, &["outlying", "B-S", "all"], "p_without") else { panic!("no p") };
        assert!((0.0062..0.0189).contains(&p), "{p}");
        let kept: Vec<DeclaredBallot> =
            answered.declared.iter().filter(|b| b.participant() != 15).copied().collect();
        let alone = hypotheses::of_study(&study, &kept);
        let same = alone.iter().find(|h| h.contrast == "B-S" && h.scope == "all").unwrap();
        assert_eq!(p, same.test.sign_flip.p());
        let pairs = screened_pair_tests(&ballot_groups(&study, ballots), &recorded);
        assert!(pairs.rows.iter().any(|row| row[4].in_full() == "bu-bi"));
    }

    #[test]
    fn nobody_broke_a_rule() {
        let study = fixture::study();
        let mut answers = fixture::answers(&study);
        answers.answers.retain(|answer| answer.participant != 15);
        let answered = Answered::of(&study, answers).unwrap();
        let recorded = Recorded::of_study(&study, &answered.responses, &answered.shown);
        assert!(of_study(&study, &answered, &recorded).rows.is_empty());
    }
}
