//! A choice that favours nothing: which comparisons are repeated, which configurations are controls.

use rand::RngExt;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

/// What an item counts towards, level by level, the most important first: numbers of its labels at each.
pub(super) type Labels = Vec<Vec<usize>>;

/// How often each label was chosen, level by level, and the sum of squares of each level: small is even.
struct Counts {
    of: Vec<Vec<u64>>,
    squares: Vec<u64>,
}

impl Counts {
    fn of(sizes: &[usize]) -> Self {
        Self { of: sizes.iter().map(|&size| vec![0; size]).collect(), squares: vec![0; sizes.len()] }
    }

    fn add(&mut self, item: &Labels) {
        for ((labels, counts), squares) in item.iter().zip(&mut self.of).zip(&mut self.squares) {
            for &label in labels {
                *squares += 2 * counts[label] + 1;
                counts[label] += 1;
            }
        }
    }

    /// What was added before.
    fn remove(&mut self, item: &Labels) {
        for ((labels, counts), squares) in item.iter().zip(&mut self.of).zip(&mut self.squares) {
            for &label in labels {
                counts[label] -= 1;
                *squares -= 2 * counts[label] + 1;
            }
        }
    }
}

/// Orders in which items are tried: enough that a handful of choices is as even as can be.
const TRIES: usize = 64;
/// Exchanges that are tried where there are several pools, and how many choices one may replace at once.
const EXCHANGES: usize = 30_000;
const AT_ONCE: usize = 4;

/// Chooses `count` different items of each pool such that over all pools labels are chosen as evenly as can be, those of the
/// first level first. `sizes` says how many labels each level has. Greedy, from many orders drawn at random, of which the
/// best is kept: even is a small sum of squares. What is greedy in one pool need not be even over several: there choices are
/// exchanged at random, as long as that is not worse.
pub(super) fn spread(
    count: usize,
    pools: &[Vec<Labels>],
    sizes: &[usize],
    random: &mut Pcg64,
) -> Vec<Vec<usize>> {
    let mut best: Option<(Vec<u64>, Vec<Vec<usize>>)> = None;
    for _ in 0..TRIES {
        let mut counts = Counts::of(sizes);
        let chosen = pools.iter().map(|items| greedy(count, items, &mut counts, random)).collect();
        if best.as_ref().is_none_or(|(least, _)| counts.squares < *least) {
            best = Some((counts.squares, chosen));
        }
    }
    let mut chosen = best.map_or_else(Vec::new, |(_, chosen)| chosen);
    if pools.len() > 1 {
        exchange(&mut chosen, pools, sizes, random);
    }
    chosen
}

/// Replaces a few choices at a time by others of their pools, and keeps what is as even or more so.
fn exchange(chosen: &mut [Vec<usize>], pools: &[Vec<Labels>], sizes: &[usize], random: &mut Pcg64) {
    let open: Vec<usize> =
        (0..pools.len()).filter(|&p| (1..pools[p].len()).contains(&chosen[p].len())).collect();
    if open.is_empty() {
        return;
    }
    let mut counts = Counts::of(sizes);
    for (own, items) in chosen.iter().zip(pools) {
        own.iter().for_each(|&item| counts.add(&items[item]));
    }
    for _ in 0..EXCHANGES {
        let before = counts.squares.clone();
        let mut replaced = Vec::new();
        for _ in 0..random.random_range(1..=AT_ONCE) {
            let pool = open[random.random_range(..open.len())];
            let place = random.random_range(..chosen[pool].len());
            let item = random.random_range(..pools[pool].len());
            if !chosen[pool].contains(&item) {
                let old = std::mem::replace(&mut chosen[pool][place], item);
                counts.remove(&pools[pool][old]);
                counts.add(&pools[pool][item]);
                replaced.push((pool, place, old));
            }
        }
        if counts.squares > before {
            for (pool, place, old) in replaced.into_iter().rev() {
                let item = std::mem::replace(&mut chosen[pool][place], old);
                counts.remove(&pools[pool][item]);
                counts.add(&pools[pool][old]);
            }
        }
    }
}

fn greedy(count: usize, items: &[Labels], counts: &mut Counts, random: &mut Pcg64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..items.len()).collect();
    order.shuffle(random);
    let mut chosen = Vec::new();
    while chosen.len() < count.min(items.len()) {
        let cost = |&(_, &item): &(usize, &usize)| growth(&items[item], &counts.of);
        let Some((place, _)) = order.iter().enumerate().min_by_key(cost) else { break };
        let item = order.remove(place);
        counts.add(&items[item]);
        chosen.push(item);
    }
    chosen
}

/// By how much an item adds to the sum of squares of each level, up to factor and constant.
fn growth(labels: &Labels, counts: &[Vec<u64>]) -> Vec<u64> {
    labels
        .iter()
        .zip(counts)
        .map(|(labels, counts)| labels.iter().map(|&label| counts[label]).sum())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::SeedableRng;

    fn uneven(chosen: &[usize], edges: &[(usize, usize)]) -> u64 {
        let mut degree = [0u64; 9];
        chosen.iter().for_each(|&i| [edges[i].0, edges[i].1].iter().for_each(|&v| degree[v] += 1));
        degree.iter().map(|n| n * n).sum()
    }

    proptest! {
        /// Against every choice of three there is.
        #[test]
        fn ends_are_chosen_as_evenly_as_can_be(
            edges in prop::collection::vec((0usize..9, 0usize..9), 3..14), seed in any::<u64>()
        ) {
            let edges: Vec<(usize, usize)> = edges.into_iter().map(|(a, b)| (a, if a == b { (b + 1) % 9 } else { b })).collect();
            let items: Vec<Labels> = edges.iter().map(|&(a, b)| vec![vec![a, b]]).collect();
            let chosen = spread(3, &[items], &[9], &mut Pcg64::seed_from_u64(seed)).remove(0);
            let mut least = u64::MAX;
            for a in 0..edges.len() {
                for b in 0..a {
                    (0..b).for_each(|c| least = least.min(uneven(&[a, b, c], &edges)));
                }
            }
            prop_assert_eq!(uneven(&chosen, &edges), least);
            let mut different = chosen;
            different.sort_unstable();
            different.dedup();
            prop_assert_eq!(different.len(), 3);
        }
    }

    #[test]
    fn what_other_pools_chose_counts() {
        let pool: Vec<Labels> = (0..6).map(|i| vec![vec![i % 3]]).collect();
        let chosen = spread(1, &[pool.clone(), pool.clone(), pool], &[3], &mut Pcg64::seed_from_u64(1));
        let mut labels: Vec<usize> = chosen.iter().map(|of| of[0] % 3).collect();
        labels.sort_unstable();
        assert_eq!(labels, [0, 1, 2]);
    }
}
