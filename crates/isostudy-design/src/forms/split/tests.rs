//! Blocks against the dealing of a sorted list, against every dealing there is, and on the design that it aliased.

use super::*;
use crate::contrast::Contrast;
use crate::forms::{Questionnaire, Role};
use crate::load::tests::{cross, load};
use crate::method::{Arrangement, Clustering, Crossed, Factor, MethodId};
use proptest::prelude::*;
use rand::SeedableRng;
use std::collections::BTreeSet;

/// Sorted by group and object, and dealt in turn.
fn sorted_and_dealt(study: &Study, count: usize) -> Vec<Vec<usize>> {
    let mut sorted: Vec<usize> = (0..study.comparisons.len()).collect();
    sorted.sort_by_key(|&i| (study.comparisons[i].group, study.comparisons[i].object));
    let mut blocks = vec![Vec::new(); count];
    sorted.into_iter().enumerate().for_each(|(place, comparison)| blocks[place % count].push(comparison));
    blocks
}

/// The first aims by their definitions: squares of pairs, interactions and pairs of objects that nobody can be tested on,
/// squares of levels.
fn first_aims(study: &Study, all: &[Contrast], blocks: &[Vec<usize>]) -> [usize; 4] {
    let squares = |of: &dyn Fn(usize) -> bool| -> usize {
        blocks.iter().map(|block| block.iter().filter(|&&i| of(i)).count().pow(2)).sum()
    };
    let pairs: BTreeSet<(usize, usize)> = study.comparisons.iter().map(|c| pair(study, c)).collect();
    let untested = |interaction: bool| {
        let of =
            all.iter().filter(|c| c.is_difference() && (c.family == Family::Interactions) == interaction);
        of.filter(|c| !blocks.iter().any(|block| c.counts(|q| block.contains(&q)))).count()
    };
    let plain = all.iter().filter(|c| !c.is_difference());
    [
        pairs.iter().map(|&own| squares(&|i| pair(study, &study.comparisons[i]) == own)).sum(),
        untested(true),
        untested(false),
        plain.map(|contrast| squares(&|i| contrast.weights.contains_key(&i))).sum(),
    ]
}

/// The balanced study with other factors, objects and groups: a group for the clusterings of each arrangement, and one for the
/// arrangements of each clustering; of its comparisons those that are kept.
fn design(arrangements: usize, clusterings: usize, objects: usize, kept: impl Fn(usize) -> bool) -> Study {
    let mut study = load("balanced.toml");
    let method = |a: usize, c: usize| -> MethodId {
        [["b", "s", "m", "f"][a], ["u", "p"][c]].concat().parse().unwrap()
    };
    let crossed = |a, c| Crossed::of(method(a, c)).expect("two letters");
    let lattices: Vec<Arrangement> = (0..arrangements).map(|a| crossed(a, 0).arrangement).collect();
    let mergings: Vec<Clustering> = (0..clusterings).map(|c| crossed(0, c).clustering).collect();
    cross(&mut study, &lattices, &mergings);
    let object = study.file.objects[0].clone();
    study.file.objects.clear();
    for o in 0..objects {
        let mut object = object.clone();
        (object.id, object.name) = (format!("o{o}"), format!("object {o}"));
        study.file.objects.push(object);
    }
    let within = |a: usize| (0..clusterings).map(|c| method(a, c)).collect::<Vec<_>>();
    let across = |c: usize| (0..arrangements).map(|a| method(a, c)).collect::<Vec<_>>();
    let members = (0..arrangements).map(within).chain((0..clusterings).map(across));
    let mut all = Vec::new();
    for (group, members) in members.filter(|members| members.len() > 1).enumerate() {
        for object in 0..objects {
            for (i, &left) in members.iter().enumerate() {
                for &right in &members[i + 1..] {
                    let [left, right] = [left, right]
                        .map(|method| crate::ConfigurationId { object: format!("o{object}"), method });
                    all.push(Comparison { question: format!("Q{}", all.len()), object, group, left, right });
                }
            }
        }
    }
    study.comparisons = all.into_iter().enumerate().filter(|(i, _)| kept(*i)).map(|(_, c)| c).collect();
    study
}

/// Every dealing into blocks of these sizes, each once: what is not yet dealt goes into one of those with room.
fn every_dealing(
    sizes: &mut [usize],
    blocks: &mut [Vec<usize>],
    next: usize,
    visit: &mut dyn FnMut(&[Vec<usize>]),
) {
    if sizes.iter().all(|&room| room == 0) {
        return visit(blocks);
    }
    for block in 0..sizes.len() {
        if sizes[block] > 0 {
            sizes[block] -= 1;
            blocks[block].push(next);
            every_dealing(sizes, blocks, next + 1, visit);
            blocks[block].pop();
            sizes[block] += 1;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn blocks_are_as_even_as_promised_and_no_worse_than_a_dealt_list(
        arrangements in 1usize..5,
        clusterings in 1usize..3,
        objects in 1usize..5,
        left_out in prop::collection::btree_set(0usize..80, 0..12),
        count in 2usize..7,
        seed in any::<u64>(),
    ) {
        let study = design(arrangements, clusterings, objects, |i| !left_out.contains(&i));
        let questions = study.comparisons.len();
        prop_assume!(questions >= count);
        let blocks = split(&study, count, &mut Pcg64::seed_from_u64(seed));
        let sizes: Vec<usize> = blocks.iter().map(Vec::len).collect();
        prop_assert!(sizes.iter().all(|&size| size == questions / count || size == questions.div_ceil(count)));
        prop_assert!(blocks.iter().all(|block| block.is_sorted()));
        prop_assert_eq!(blocks.iter().flatten().collect::<BTreeSet<_>>().len(), questions);
        let pairs: BTreeSet<(usize, usize)> = study.comparisons.iter().map(|c| pair(&study, c)).collect();
        for own in pairs {
            let counts = blocks.iter().map(|block| block.iter().filter(|&&i| pair(&study, &study.comparisons[i]) == own).count());
            let counts: Vec<usize> = counts.collect();
            prop_assert!(counts.iter().max().unwrap() - counts.iter().min().unwrap() <= 1, "{:?} {:?}", own, counts);
        }
        let all = contrasts(&study);
        let (new, old) = (first_aims(&study, &all, &blocks), first_aims(&study, &all, &sorted_and_dealt(&study, count)));
        prop_assert!(new <= old, "{:?} {:?}", new, old);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Against every dealing there is.
    #[test]
    fn small_designs_are_dealt_as_well_as_can_be(
        arrangements in 1usize..4,
        clusterings in 1usize..3,
        objects in 1usize..4,
        kept in prop::collection::btree_set(0usize..30, 2..9),
        count in 2usize..4,
        seed in any::<u64>(),
    ) {
        let study = design(arrangements, clusterings, objects, |i| kept.contains(&i));
        let questions = study.comparisons.len();
        prop_assume!(questions >= count);
        let all = contrasts(&study);
        let mut best = [usize::MAX; 4];
        let mut sizes: Vec<usize> = (0..count).map(|block| (questions - block).div_ceil(count)).collect();
        every_dealing(&mut sizes, &mut vec![Vec::new(); count], 0, &mut |blocks| {
            best = best.min(first_aims(&study, &all, blocks));
        });
        let blocks = split(&study, count, &mut Pcg64::seed_from_u64(seed));
        prop_assert_eq!(first_aims(&study, &all, &blocks), best);
    }
}

/// Dealt as a sorted list, each of three blocks had one pair of clusterings on all objects, and one object of all pairs of
/// arrangements.
#[test]
fn three_blocks_of_the_balanced_study_hold_every_hypothesis() {
    let mut study = load("balanced.toml");
    for seed in 0..20 {
        study.file.study.seed = seed;
        study.file.forms.as_mut().unwrap().max_questions = 14;
        let questionnaire = Questionnaire::of(&study).unwrap();
        assert_eq!((questionnaire.blocks(), questionnaire.questions(0)), (3, 14));
        let all = contrasts(&study);
        let mut people = vec![0; all.len()];
        for form in questionnaire.planned() {
            let asked: BTreeSet<usize> = form
                .trials
                .iter()
                .filter(|t| t.role == Role::Comparison)
                .filter_map(|t| t.comparison)
                .collect();
            for (contrast, people) in all.iter().zip(&mut people) {
                *people += usize::from(contrast.counts(|q| asked.contains(&q)));
            }
            // One of each pair of methods, arrangements on each object, and all clusterings on some object.
            let pairs: BTreeSet<_> = asked.iter().map(|&i| pair(&study, &study.comparisons[i])).collect();
            assert_eq!(pairs.len(), 9, "{seed}");
            let tournaments = by(&study, |c| (c.group, c.object)).into_iter();
            let whole =
                tournaments.filter(|own| own.len() == 3 && own.iter().all(|i| asked.contains(i))).count();
            assert_eq!(whole, 2, "{seed}");
        }
        for (contrast, people) in all.iter().zip(people) {
            // What is asked of two objects of three, or of one of two arrangements, is asked of a part of the people.
            let expected = match contrast.family {
                Family::Objects(Factor(1)) => 24,
                Family::ObjectPairs(Factor(1)) => 12,
                _ => 36,
            };
            assert_eq!(people, expected, "{seed} {contrast}");
        }
    }
}

#[test]
fn many_questions_are_dealt_too() {
    let study = design(4, 2, 100, |_| true);
    assert_eq!(study.comparisons.len(), 1600);
    let blocks = split(&study, 50, &mut Pcg64::seed_from_u64(1));
    assert!(blocks.iter().all(|block| block.len() == 32));
}
