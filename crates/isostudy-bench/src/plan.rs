//! What is run, how often, and in which order.

use isostudy_design::machine::CpuProfile;
use isostudy_design::record::Workload;
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use serde::Serialize;
use std::fmt;
use std::ops::{Range, RangeInclusive};

/// Blocks into which measured rounds are cut where an A/A block goes between them, at least and at most. The more processes a
/// median is of, the less is left of what chance gave each; but every one has to start and warm up.
const BLOCKS: RangeInclusive<u32> = 3..=8;
/// Rounds that a block has at least where that leaves blocks enough.
const ROUNDS_OF_BLOCK: u32 = 10;
/// Invocations of the A/A block, after a third and after two thirds of the measured blocks.
const AA_INVOCATIONS: u32 = 2;
/// Rounds of the A/A block take their orders from here on, so that none is that of a measured round.
const AA_ORDERS: u32 = 1 << 31;

/// What a benchmark runs, apart from the configurations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plan {
    /// The study's id.
    pub study: String,
    /// What the configurations ask of the extractor.
    pub workloads: Vec<Workload>,
    /// Rounds run and thrown away at the start of every invocation.
    pub warmup: u32,
    /// Rounds measured in a batch; at least 1.
    pub iterations: u32,
    /// Batches at most, each with processes and an A/A block of its own; at least 1. A run may end after any of them.
    pub batches: u32,
    /// The growth of a total, as a share, that a run is to tell before it ends; recorded, and judged by who runs the plan.
    pub until: Option<f64>,
    /// Rounds of the A/A block; 0 leaves it out.
    pub aa_iterations: u32,
    /// Whether peak memory is measured, in a process of its own for every configuration.
    pub memory: bool,
    /// Whether allocations are counted with it.
    pub allocations: bool,
    /// Seed of the order within each round.
    pub seed: u64,
    /// Threads in the sampling stage; 0 takes every core.
    pub threads: u32,
    /// Whether the run asks to be kept on as many CPUs as it has threads.
    pub pin: bool,
    /// The CPU the numbers are meant for.
    pub target: CpuProfile,
}

/// Rounds measured in one process, after warm-up.
///
/// What a process is given by chance (where its memory lies, say) stays with it and shifts its times; only another
/// process shows by how much. So the A/A block has invocations of its own, and where there is one, the measured rounds are
/// cut into three to eight invocations round it: it then sees the beginning, the middle and the end of the run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Invocation {
    /// Counted from 0.
    pub number: u32,
    /// Whether it belongs to the A/A block.
    pub aa: bool,
    /// Its rounds, counted over all invocations of its kind.
    pub rounds: Range<u32>,
}

/// A round: every configuration once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Round {
    /// Run and not kept; counted from 0 in every invocation.
    WarmUp(u32),
    /// Run and kept; counted from 0, as in [`BenchSample`](isostudy_design::record::BenchSample).
    Measured(u32),
    /// Run and kept as a round of the A/A block, counted on its own.
    Again(u32),
}

impl fmt::Display for Round {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WarmUp(number) => write!(f, "warm-up round {number}"),
            Self::Measured(number) => write!(f, "iteration {number}"),
            Self::Again(number) => write!(f, "A/A iteration {number}"),
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
    /// The invocations of all batches in order. Nothing but the plan decides them, so a run that was broken off can be told what
    /// is left.
    pub fn invocations(&self) -> Vec<Invocation> {
        let batch = self.batch();
        let (length, rounds) = (batch.len() as u32, [self.iterations, self.aa_iterations]);
        let later = |(at, invocation): (u32, &Invocation)| {
            let shift = at * rounds[usize::from(invocation.aa)];
            let Range { start, end } = invocation.rounds;
            Invocation {
                number: at * length + invocation.number,
                rounds: start + shift..end + shift,
                ..*invocation
            }
        };
        (0..self.batches.max(1)).flat_map(|at| batch.iter().map(move |of| later((at, of)))).collect()
    }

    /// The invocations of the first batch.
    pub fn batch(&self) -> Vec<Invocation> {
        let blocks = match self.aa_iterations {
            0 => 1,
            _ => {
                (self.iterations / ROUNDS_OF_BLOCK).clamp(*BLOCKS.start(), *BLOCKS.end()).min(self.iterations)
            }
        };
        let again = self.aa_iterations.min(AA_INVOCATIONS);
        let cut = |rounds: u32, parts: u32, part: u32| {
            let at = |part: u32| (u64::from(rounds) * u64::from(part) / u64::from(parts)) as u32;
            at(part)..at(part + 1)
        };
        let mut invocations = Vec::new();
        for part in 0..blocks {
            invocations.push((false, cut(self.iterations, blocks, part)));
            let follows = |again_part: &u32| (blocks * (again_part + 1)).div_ceil(again + 1) == part + 1;
            let following = (0..again).filter(follows);
            invocations.extend(following.map(|part| (true, cut(self.aa_iterations, again, part))));
        }
        let number = |(number, (aa, rounds))| Invocation { number, aa, rounds };
        (0..).zip(invocations).map(number).collect()
    }

    /// What an invocation executes for `count` configurations before it measures.
    pub fn warm_up(&self, invocation: &Invocation, count: usize) -> Vec<Turn> {
        // From the far end: no order is repeated by a measured round, and none is taken from it.
        let stream = |number| u32::MAX - (invocation.number * self.warmup + number);
        (0..self.warmup).flat_map(|number| self.round(Round::WarmUp(number), stream(number), count)).collect()
    }

    /// What an invocation measures, in order, for `count` configurations.
    pub fn turns(&self, invocation: &Invocation, count: usize) -> Vec<Turn> {
        let round = |number| match invocation.aa {
            false => self.round(Round::Measured(number), number, count),
            true => self.round(Round::Again(number), AA_ORDERS + number, count),
        };
        invocation.rounds.clone().flat_map(round).collect()
    }

    fn round(&self, round: Round, stream: u32, count: usize) -> Vec<Turn> {
        let places = order(self.seed, stream, count).into_iter().zip(0..);
        places.map(|(subject, place)| Turn { round, place, subject }).collect()
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

    fn plan(warmup: u32, iterations: u32, aa_iterations: u32) -> Plan {
        Plan { warmup, iterations, aa_iterations, ..crate::run::tests::plan() }
    }

    #[test]
    fn invocations_surround_the_second_measurement() {
        let invocations = |iterations, aa| {
            let of = |s: Invocation| (s.number, s.aa, s.rounds);
            plan(1, iterations, aa).invocations().into_iter().map(of).collect::<Vec<_>>()
        };
        let (m, a) = (false, true);
        let want = [
            [(0, m, 0..12), (1, m, 12..25), (2, m, 25..37), (3, a, 0..4), (4, m, 37..50)],
            [(5, m, 50..62), (6, m, 62..75), (7, a, 4..8), (8, m, 75..87), (9, m, 87..100)],
        ];
        assert_eq!(invocations(100, 8), want.concat());
        let want = [(0, m, 0..10), (1, a, 0..1), (2, m, 10..20), (3, a, 1..2), (4, m, 20..30)];
        assert_eq!(invocations(30, 2), want);
        assert_eq!(invocations(10, 0), [(0, m, 0..10)], "nothing to surround: one process");
        assert_eq!(invocations(1, 1), [(0, m, 0..1), (1, a, 0..1)]);
        assert_eq!(invocations(1, 5), [(0, m, 0..1), (1, a, 0..2), (2, a, 2..5)]);
        assert_eq!(invocations(2, 2), [(0, m, 0..1), (1, a, 0..1), (2, m, 1..2), (3, a, 1..2)]);
    }

    #[test]
    fn a_batch_goes_on_where_the_one_before_ended() {
        let twice = Plan { batches: 2, ..plan(1, 30, 2) };
        let (all, first) = (twice.invocations(), twice.batch());
        assert_eq!(all[..5], first[..]);
        let of = |s: &Invocation| (s.number, s.aa, s.rounds.clone());
        let second: Vec<_> = all[5..].iter().map(of).collect();
        let (m, a) = (false, true);
        assert_eq!(second, [(5, m, 30..40), (6, a, 2..3), (7, m, 40..50), (8, a, 3..4), (9, m, 50..60)]);
    }

    #[test]
    fn turns_go_round_by_round_and_no_order_twice() {
        let plan = plan(2, 7, 3);
        let mut orders = HashSet::new();
        let mut rounds = 0;
        for invocation in plan.invocations() {
            let turns = [plan.warm_up(&invocation, 18), plan.turns(&invocation, 18)].concat();
            for round in turns.chunks(18) {
                assert!(round.iter().all(|turn| turn.round == round[0].round));
                assert_eq!(
                    round.iter().map(|turn| turn.place).collect::<Vec<_>>(),
                    (0..18).collect::<Vec<_>>()
                );
                assert!(orders.insert(round.iter().map(|turn| turn.subject).collect::<Vec<_>>()));
                rounds += 1;
            }
        }
        assert_eq!(rounds, 5 * 2 + 7 + 3);
    }

    #[test]
    fn warm_up_and_second_measurement_do_not_shift_the_order() {
        let measured = |plan: &Plan| -> Vec<usize> {
            let invocations = plan.invocations().into_iter().filter(|invocation| !invocation.aa);
            invocations.flat_map(|invocation| plan.turns(&invocation, 18)).map(|turn| turn.subject).collect()
        };
        assert_eq!(measured(&plan(0, 7, 0)), measured(&plan(3, 7, 5)));
    }
}
