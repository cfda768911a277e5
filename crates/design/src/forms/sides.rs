//! Sides: which end of each comparison is on the left, so that nobody is on one side more often than on the other.

use crate::method::Method;
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;
use std::collections::BTreeMap;

/// For each comparison, `(left, right)` as listed, whether to swap it.
///
/// Afterwards every method is on the left as often as on the right, and two methods that meet several times are each on
/// the left of the other equally often, all to within one. Of several meetings pairs cancel out; what is left is a
/// simple graph, whose edges get the direction in which an Euler tour runs through them, after its vertices of odd degree have
/// been joined to one more vertex.
pub(super) fn balanced(comparisons: &[(Method, Method)], random: &mut Pcg64) -> Vec<bool> {
    let mut swapped = vec![false; comparisons.len()];
    let mut meetings: BTreeMap<(Method, Method), Vec<usize>> = BTreeMap::new();
    for (i, &(left, right)) in comparisons.iter().enumerate() {
        meetings.entry((left.min(right), left.max(right))).or_default().push(i);
    }
    // The left method of comparison `i` is to be `first`.
    let mut set = |i: usize, first: Method| swapped[i] = comparisons[i].0 != first;
    let mut edges = Vec::new();
    for (&(low, high), meetings) in &mut meetings {
        meetings.shuffle(random);
        let mut twos = meetings.chunks_exact(2);
        for two in &mut twos {
            set(two[0], low);
            set(two[1], high);
        }
        edges.extend(twos.remainder().iter().map(|&i| (Some(low), Some(high), Some(i))));
    }
    edges.shuffle(random);
    let mut degree: BTreeMap<Method, usize> = BTreeMap::new();
    edges.iter().flat_map(|&(a, b, _)| [a, b]).flatten().for_each(|m| *degree.entry(m).or_default() += 1);
    let odd = degree.iter().filter(|(_, degree)| *degree % 2 == 1);
    edges.extend(odd.map(|(&method, _)| (Some(method), None, None)));
    let backwards: bool = random.random();
    // Every vertex has even degree now: a walk ends where it began.
    while let Some((start, next, label)) = edges.pop() {
        let mut at = next;
        let mut walk = vec![(start, label)];
        while at != start {
            let out = edges.iter().position(|&(a, b, _)| a == at || b == at);
            let (a, b, label) =
                edges.swap_remove(out.expect("even degrees: a walk can go on until it closes"));
            walk.push((at, label));
            at = if a == at { b } else { a };
        }
        for (from, label) in walk {
            if let (Some(from), Some(i)) = (from, label) {
                set(i, from);
            }
        }
    }
    if backwards {
        swapped.iter_mut().for_each(|swap| *swap = !*swap);
    }
    swapped
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::SeedableRng;

    fn method(i: usize) -> Method {
        let code = [["b", "s"][i % 2], ["u", "i", "p", "c"][i / 2]].concat();
        code.parse().expect("one of the eight")
    }

    proptest! {
        #[test]
        fn nobody_is_on_one_side_more_than_once_too_often(
            pairs in prop::collection::vec((0usize..8, 0usize..8), 0..80), seed in any::<u64>()
        ) {
            let distinct = pairs.into_iter().filter(|(a, b)| a != b);
            let pairs: Vec<(Method, Method)> = distinct.map(|(a, b)| (method(a), method(b))).collect();
            let swapped = balanced(&pairs, &mut Pcg64::seed_from_u64(seed));
            let (mut lead, mut pair_lead) = (BTreeMap::new(), BTreeMap::new());
            for (&(left, right), swap) in pairs.iter().zip(swapped) {
                let (left, right) = if swap { (right, left) } else { (left, right) };
                *lead.entry(left).or_insert(0) += 1;
                *lead.entry(right).or_insert(0) -= 1;
                let sign = if left < right { 1 } else { -1 };
                *pair_lead.entry((left.min(right), left.max(right))).or_insert(0) += sign;
            }
            prop_assert!(lead.values().all(|lead: &i32| lead.abs() <= 1), "{lead:?}");
            prop_assert!(pair_lead.values().all(|lead: &i32| lead.abs() <= 1), "{pair_lead:?}");
        }
    }
}
