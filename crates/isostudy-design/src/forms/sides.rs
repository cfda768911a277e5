//! Sides: which end of each comparison is on the left, so that nobody is on one side more often than on the other.
//!
//! Methods are given by their places in the study.

use rand::RngExt;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;
use std::collections::BTreeMap;

/// For each comparison of each block, `(left, right)` as listed, whether to swap it.
///
/// Within a block as by [`balanced`]; over blocks what leads two methods have of each other cancels out as well as a search
/// finds: block after block is drawn anew and kept if leads shrink. They cannot always vanish: a lead within a block may have
/// to follow from another.
pub(super) fn over_blocks(blocks: &[Vec<(usize, usize)>], random: &mut Pcg64) -> Vec<Vec<bool>> {
    let mut swapped: Vec<Vec<bool>> = blocks.iter().map(|block| balanced(block, random)).collect();
    let mut total = Leads::new();
    blocks.iter().zip(&swapped).for_each(|(block, swapped)| add(&mut total, &leads(block, swapped), 1));
    for _ in 0..SWEEPS {
        // Leads of the blocks so far: participants may end with any of them.
        let mut so_far = Leads::new();
        for (block, swapped) in blocks.iter().zip(&mut swapped) {
            let even = total.values().chain(so_far.values()).all(|lead| lead.abs() <= 1);
            let mut own = leads(block, swapped);
            if !even && blocks.len() > 1 {
                add(&mut total, &own, -1);
                let cost = |own: &Leads| [&total, &so_far].map(|others| squares(others, own));
                for _ in 0..DRAWS {
                    let drawn = balanced(block, random);
                    let leads = leads(block, &drawn);
                    if cost(&leads) < cost(&own) {
                        (*swapped, own) = (drawn, leads);
                    }
                }
                add(&mut total, &own, 1);
            }
            add(&mut so_far, &own, 1);
        }
    }
    swapped
}

/// Rounds through all blocks, and draws for each in a round.
const SWEEPS: usize = 8;
const DRAWS: usize = 16;

/// How much more often the lower of two methods is on the left.
type Leads = BTreeMap<(usize, usize), i64>;

fn leads(block: &[(usize, usize)], swapped: &[bool]) -> Leads {
    let mut leads = Leads::new();
    for (&(left, right), &swapped) in block.iter().zip(swapped) {
        let lead = if (left < right) == swapped { -1 } else { 1 };
        *leads.entry((left.min(right), left.max(right))).or_default() += lead;
    }
    leads
}

fn add(leads: &mut Leads, more: &Leads, times: i64) {
    more.iter().for_each(|(pair, lead)| *leads.entry(*pair).or_default() += times * lead);
}

/// By how much the sum of squares grows.
fn squares(others: &Leads, own: &Leads) -> i64 {
    own.iter().map(|(pair, own)| own * (own + 2 * others.get(pair).copied().unwrap_or(0))).sum()
}

/// For each comparison, `(left, right)` as listed, whether to swap it.
///
/// Afterwards every method is on the left as often as on the right, and two methods that meet several times are each on
/// the left of the other equally often, all to within one. Of several meetings pairs cancel out; what is left is a
/// simple graph, whose edges get the direction in which an Euler tour runs through them, after its vertices of odd degree have
/// been joined to one more vertex.
fn balanced(comparisons: &[(usize, usize)], random: &mut Pcg64) -> Vec<bool> {
    let mut swapped = vec![false; comparisons.len()];
    let mut meetings: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
    for (i, &(left, right)) in comparisons.iter().enumerate() {
        meetings.entry((left.min(right), left.max(right))).or_default().push(i);
    }
    // The left method of comparison `i` is to be `first`.
    let mut set = |i: usize, first: usize| swapped[i] = comparisons[i].0 != first;
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
    let mut degree: BTreeMap<usize, usize> = BTreeMap::new();
    edges.iter().flat_map(|&(a, b, _)| [a, b]).flatten().for_each(|m| *degree.entry(m).or_default() += 1);
    let odd = degree.iter().filter(|(_, degree)| *degree % 2 == 1);
    edges.extend(odd.map(|(&method, _)| (Some(method), None, None)));
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
        // Run through backwards, an edge points to where the walk came from.
        let ends = walk.iter().skip(1).chain(&walk[..1]).map(|&(end, _)| end);
        let backwards: bool = random.random();
        for (&(from, label), to) in walk.iter().zip(ends) {
            if let (Some(from), Some(to), Some(i)) = (from, to, label) {
                set(i, if backwards { to } else { from });
            }
        }
    }
    swapped
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::SeedableRng;

    proptest! {
        #[test]
        fn nobody_is_on_one_side_more_than_once_too_often(
            pairs in prop::collection::vec((0usize..8, 0usize..8), 0..80), seed in any::<u64>()
        ) {
            let pairs: Vec<(usize, usize)> = pairs.into_iter().filter(|(a, b)| a != b).collect();
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
