//! Whether worths go with what is known of people, in words.

use crate::statement::{Finding, Standing};
use crate::words::{counted, list, p as p_value};
use isostudy_inference::attributes::{Attributed, MOST_GROUPS, NoTest, Worths};

/// What a column is tested for: the groups of people in it, or its numbers.
fn kind(of: &Attributed<'_>) -> &'static str {
    match of.worths {
        Worths::Groups(_) => "between people by",
        Worths::Number(_) => "with",
    }
}

/// `level` is that of tests, after correction.
pub(super) fn findings(attributed: &[Attributed<'_>], level: f64) -> Vec<Finding> {
    if attributed.is_empty() {
        return Vec::new();
    }
    let (tested, others): (Vec<&Attributed<'_>>, Vec<&Attributed<'_>>) =
        attributed.iter().partition(|of| of.adjusted.is_some());
    let adjusted = |of: &Attributed<'_>| of.adjusted.unwrap_or(1.0);
    let mut found = Vec::new();
    if let Some(least) = tested.iter().map(|of| adjusted(of)).min_by(f64::total_cmp) {
        let one = |of: &&Attributed<'_>| {
            let people = of.test.as_ref().map_or(0, |test| test.people);
            let people = counted(people, "participant");
            format!(
                "{} {} (group {}, {people}, {})",
                kind(of),
                of.column,
                of.group.name,
                p_value(adjusted(of))
            )
        };
        let differ: Vec<String> = tested.iter().filter(|of| adjusted(of) <= level).map(one).collect();
        let tests = counted(tested.len(), "test");
        found.push(match differ.is_empty() {
            true => Finding::new(
                Standing::Open,
                format!(
                    "Worths were not shown to go with what is known of people: none of {tests} holds after correction (smallest \
                     corrected {}). That is no proof that they do not.",
                    p_value(least)
                ),
            ),
            false => Finding::new(
                Standing::Holds,
                format!(
                    "Worths go with what is known of people, in {} of {tests} after correction: they differ {}. Nobody was assigned \
                     to these groups: people in them may differ in other things.",
                    differ.len(),
                    list(&differ)
                ),
            ),
        });
    }
    // A column says the same of itself for every group of items, mostly.
    let mut reasons: Vec<String> = Vec::new();
    for of in others {
        let said = format!("{} ({})", of.column, why(of));
        if !reasons.contains(&said) {
            reasons.push(said);
        }
    }
    if !reasons.is_empty() {
        found.push(Finding::new(
            Standing::NotAnswerable,
            format!("For some groups of items, worths were not tested by {}.", list(&reasons)),
        ));
    }
    found
}

fn why(of: &Attributed<'_>) -> String {
    match &of.test {
        Ok(_) => String::new(),
        Err(NoTest::Fit(reason)) => reason.to_string(),
        Err(NoTest::NoNumber) => "a value is no number".into(),
        Err(NoTest::OneGroup) => "everybody of whom it is known has the same value".into(),
        Err(NoTest::ManyGroups(values)) => {
            format!("{values} different values; at most {MOST_GROUPS} are groups")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_inference::{Answered, Preferences};
    use isostudy_responses::PersonColumn;

    /// What is said of the paper's answers if people are of these sites.
    fn said(site: impl Fn(usize) -> String, turned: bool) -> Vec<Finding> {
        let mut study = crate::fixture::study();
        study.file.analysis.subgroups = vec!["site".into()];
        let mut responses = crate::fixture::answers(&study);
        if turned {
            let late = responses.answers.iter_mut().filter(|answer| answer.participant >= 9);
            late.for_each(|answer| answer.choice = answer.choice.swapped());
        }
        let values = (0..18).map(|person| Some(site(person))).collect();
        responses.people = vec![PersonColumn { name: "site".into(), values }];
        let answered = Answered::of(&study, responses).unwrap();
        findings(&Preferences::of_study(&study, &answered).attributed, 0.05)
    }

    #[test]
    fn what_goes_with_people_is_named_and_the_rest_is_no_proof() {
        let halves = |person: usize| if person < 9 { "Bonn".into() } else { "Kiel".into() };
        let differ = said(halves, true);
        assert_eq!(differ[0].standing, Standing::Holds);
        assert!(
            differ[0].text.contains("between people by site (group all, 18 participants, p"),
            "{differ:?}"
        );
        assert!(differ[0].text.contains("may differ in other things"));
        let alike = said(halves, false);
        assert_eq!(alike[0].standing, Standing::Open);
        assert!(alike[0].text.contains("no proof"), "{alike:?}");
        let same = said(|_| "Bonn".into(), false);
        assert_eq!((same.len(), same[0].standing), (1, Standing::NotAnswerable));
        assert!(same[0].text.contains("site (everybody of whom it is known has the same value)"), "{same:?}");
    }
}
