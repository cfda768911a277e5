//! What becomes of results when one participant is left out and p is corrected anew.

use crate::hypotheses::Hypothesis;
use isostudy_statistics::holm;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// One hypothesis with each participant in turn left out.
#[derive(Debug, Clone, PartialEq)]
pub struct WithoutOne {
    /// The largest p, corrected anew.
    pub largest: f64,
    /// Whose absence takes the corrected p above the level; ascending.
    pub undone_by: Vec<usize>,
}

impl WithoutOne {
    /// By place, each that was tested of a study or its groups; single questions are exploratory.
    pub fn of_tested(all: &[Hypothesis]) -> Vec<(usize, Self)> {
        let (places, tested): (Vec<usize>, Vec<&Hypothesis>) =
            all.iter().enumerate().filter(|(_, h)| !h.is_question() && h.is_tested()).unzip();
        places.into_iter().zip(Self::of(&tested)).collect()
    }

    /// One for each hypothesis, in their order. Families are corrected by Holm's rule.
    pub fn of(all: &[&Hypothesis]) -> Vec<Self> {
        // p by hypothesis and group of participants with the same score; last, of those without one.
        let p: Vec<Vec<f64>> = all
            .par_iter()
            .map(|h| {
                let mut p = h.test.leave_one_out();
                p.resize(h.test.groups.len(), 1.0);
                p.push(h.test.sign_flip.p());
                p.iter_mut().for_each(|p| *p = h.p_at_look(*p));
                p
            })
            .collect();
        let people = all.iter().flat_map(|h| h.test.with_score()).collect::<BTreeSet<usize>>();
        // Whoever has the same scores everywhere leaves the same behind.
        let mut alike: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
        for person in people {
            let groups = all.iter().map(|h| h.test.group_of(person).unwrap_or(h.test.groups.len())).collect();
            alike.entry(groups).or_default().push(person);
        }
        let families = families(all);
        let of_kind = |groups: &Vec<usize>| -> Vec<f64> {
            let mut adjusted = vec![1.0; all.len()];
            for family in &families {
                // A test of nobody but this person is not among the tests without this person.
                let left: Vec<usize> = family
                    .iter()
                    .copied()
                    .filter(|&i| all[i].test.participants() > 1 || groups[i] == all[i].test.groups.len())
                    .collect();
                let own: Vec<f64> = left.iter().map(|&i| p[i][groups[i]]).collect();
                left.into_iter().zip(holm(&own)).for_each(|(i, p)| adjusted[i] = p);
            }
            adjusted
        };
        let kinds: Vec<(&Vec<usize>, &Vec<usize>)> = alike.iter().collect();
        let adjusted: Vec<Vec<f64>> = kinds.par_iter().map(|(groups, _)| of_kind(groups)).collect();
        (0..all.len())
            .map(|i| {
                let undone = kinds.iter().zip(&adjusted).filter(|(_, p)| p[i] > all[i].rules.level);
                let mut undone_by: Vec<usize> =
                    undone.flat_map(|((_, people), _)| people.iter().copied()).collect();
                undone_by.sort_unstable();
                let largest = adjusted.iter().map(|p| p[i]).fold(all[i].adjusted, f64::max);
                Self { largest, undone_by }
            })
            .collect()
    }
}

/// Places of hypotheses that are corrected together.
fn families(all: &[&Hypothesis]) -> Vec<Vec<usize>> {
    let mut families: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    all.iter().enumerate().for_each(|(i, h)| families.entry(h.corrected_with.as_str()).or_default().push(i));
    families.into_values().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;
    use crate::hypotheses;

    #[test]
    fn as_the_same_tests_without_each_person_have_it() {
        let study = fixture::study();
        let answered = fixture::answered(&study);
        let all: Vec<&Hypothesis> = answered.hypotheses.iter().filter(|h| !h.is_question()).collect();
        let found = WithoutOne::of(&all);
        let mut largest = all.iter().map(|h| h.adjusted).collect::<Vec<_>>();
        let mut undone_by = vec![Vec::new(); all.len()];
        for person in 0..18 {
            let kept: Vec<_> =
                answered.declared.iter().filter(|b| b.participant() != person).copied().collect();
            for (i, of) in hypotheses::of_contrasts(&study, &kept, None).iter().enumerate() {
                assert!(of.is_about_the_same(all[i]));
                largest[i] = largest[i].max(of.adjusted);
                if of.adjusted > 0.05 {
                    undone_by[i].push(person);
                }
            }
        }
        for (i, of) in found.iter().enumerate() {
            assert!(
                (of.largest - largest[i]).abs() < 1e-12 && of.undone_by == undone_by[i],
                "{:?}",
                all[i].contrast
            );
        }
        // An independent count of Costen's answers: within U, body-centred against simple cubic falls to 0.053 without any
        // one of these six.
        let place = all.iter().position(|h| h.contrast == "B-S" && h.scope == "within U").unwrap();
        assert_eq!(found[place].undone_by, [2, 10, 11, 12, 14, 17]);
        assert!((found[place].largest - 0.053).abs() < 5e-4);
    }
}
