//! What is run, how often, and in which order.

use design::machine::CpuProfile;
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::fmt;

/// What a benchmark runs, apart from the configurations.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The study's id.
    pub study: String,
    /// Rounds run and thrown away before measuring.
    pub warmup: u32,
    /// Rounds measured; at least 1.
    pub iterations: u32,
    /// Seed of the order within each round.
    pub seed: u64,
    /// Threads in the sampling stage; 0 takes every core.
    pub threads: u32,
    /// The CPU the numbers are meant for.
    pub target: CpuProfile,
}

/// A round: every configuration once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Round {
    /// Run and not kept; counted from 0.
    WarmUp(u32),
    /// Run and kept; counted from 0, as in [`BenchSample`](design::record::BenchSample).
    Measured(u32),
}

impl fmt::Display for Round {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WarmUp(number) => write!(f, "warm-up round {number}"),
            Self::Measured(number) => write!(f, "iteration {number}"),
        }
    }
}

/// One execution of one configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Turn {
    /// The round it belongs to.
    pub round: Round,
    /// Place within the round, from 0.
    pub place: u32,
    /// Index of the configuration.
    pub subject: usize,
}

impl Plan {
    /// Everything that is executed, in order, for `count` configurations: warm-up rounds, then measured rounds.
    ///
    /// Nothing but the plan and `count` decides it, so a run that was broken off can be told what is left.
    pub fn turns(&self, count: usize) -> impl Iterator<Item = Turn> {
        // Warm-up takes its orders from the far end: none is repeated by a measured round, and none is taken from it.
        let warmup = (0..self.warmup).map(|number| (Round::WarmUp(number), u32::MAX - number));
        let measured = (0..self.iterations).map(|number| (Round::Measured(number), number));
        let seed = self.seed;
        warmup.chain(measured).flat_map(move |(round, number)| {
            let places = order(seed, number, count).into_iter().zip(0..);
            places.map(move |(subject, place)| Turn { round, place, subject })
        })
    }
}

/// The order in which the `count` configurations take their turns in a round: a permutation of `0..count`.
///
/// Each round has an order of its own, uniform over all permutations as far as the generator (PCG 64, O'Neill 2014)
/// goes. The same seed, round and count give the same order on every machine.
pub fn order(seed: u64, iteration: u32, count: usize) -> Vec<usize> {
    let mut seeds = Pcg64::seed_from_u64(seed);
    seeds.advance(u128::from(iteration));
    let mut places: Vec<usize> = (0..count).collect();
    places.shuffle(&mut Pcg64::seed_from_u64(seeds.next_u64()));
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashSet;

    proptest! {
        #[test]
        fn an_order_is_a_permutation(seed: u64, iteration: u32, count in 0usize..200) {
            let mut places = order(seed, iteration, count);
            prop_assert_eq!(&places, &order(seed, iteration, count));
            places.sort_unstable();
            prop_assert_eq!(places, (0..count).collect::<Vec<_>>());
        }
    }

    #[test]
    fn rounds_and_seeds_differ() {
        // 18! orders: a repetition among a hundred would be a broken generator, not bad luck.
        let orders: HashSet<Vec<usize>> = (0..100).map(|iteration| order(2026, iteration, 18)).collect();
        assert_eq!(orders.len(), 100);
        assert_ne!(order(2026, 0, 18), order(2027, 0, 18));
    }

    /// Archived runs name a seed, so an update of `rand` must not reorder them unnoticed.
    #[test]
    fn an_order_stays_what_it_was() {
        assert_eq!(order(2026, 0, 6), [2, 5, 0, 3, 1, 4]);
        assert_eq!(order(2026, 1, 6), [3, 0, 5, 2, 4, 1]);
    }

    #[test]
    fn every_place_falls_to_every_configuration() {
        // 6000 rounds of 6: each configuration should open 1000 of them; 5 standard deviations are 144.
        let mut first = [0i32; 6];
        for iteration in 0..6000 {
            first[order(1, iteration, 6)[0]] += 1;
        }
        assert!(first.iter().all(|count| (count - 1000).abs() < 144), "{first:?}");
    }

    #[test]
    fn turns_go_round_by_round() {
        let plan = Plan {
            study: "mock".into(),
            warmup: 2,
            iterations: 3,
            seed: 5,
            threads: 1,
            target: toml::from_str("name = \"any\"\nmodel = \"\"").unwrap(),
        };
        let turns: Vec<Turn> = plan.turns(4).collect();
        assert_eq!(turns.len(), 5 * 4);
        let rounds: Vec<Round> = turns.chunks(4).map(|round| round[0].round).collect();
        let (w, m) = (Round::WarmUp, Round::Measured);
        assert_eq!(rounds, [w(0), w(1), m(0), m(1), m(2)]);
        for round in turns.chunks(4) {
            assert!(round.iter().all(|turn| turn.round == round[0].round));
            assert_eq!(round.iter().map(|turn| turn.place).collect::<Vec<_>>(), [0, 1, 2, 3]);
            assert_eq!(round.iter().map(|turn| turn.subject).collect::<HashSet<_>>().len(), 4);
        }
        let unwarmed: Vec<Turn> = Plan { warmup: 0, ..plan.clone() }.turns(4).collect();
        assert_eq!(unwarmed, turns[8..], "warm-up does not shift the order");
        let subjects = |round: usize| {
            let turns = plan.turns(18).skip(18 * round).take(18);
            turns.map(|turn| turn.subject).collect::<Vec<_>>()
        };
        assert_ne!(subjects(0), subjects(2), "the first warm-up round is not the first measured one");
    }
}
