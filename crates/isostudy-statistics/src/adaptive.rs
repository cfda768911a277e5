//! Which pairs to ask the next person about, so that the answers tell most about everybody's worths.
//!
//! What is known of the worths after the answers so far is taken as [normal](Known). Of a pair, u = l_left - l_right is then normal with
//! mean m and variance v, and an answer y is expected to tell
//!
//! I(y; u) = H(E p(u)) - E H(p(u)),
//!
//! the mutual information of answer and worths, in nats, H the entropy of the chances of left, tie and right (Lindley 1956, Ann. Math.
//! Statist. 27:986; so do Mikhailiuk and others 2020, arXiv:2004.05691, choose pairs). After each pair that is chosen, the covariance
//! is what it would be after an answer of the expected information, so that a person's pairs do not all ask the same.
//!
//! A person's pairs are chosen before their first answer, from the answers of those who were there before. So whom a person prefers
//! does not decide what this person is asked, and people stay what is independent.
//!
//! Half of the pairs are dealt from a pack of all pairs instead. Where all were chosen, those who had luck with their first answers
//! were then compared with one another, and little ever told that it was luck. `docs/adaptive.md` has what was measured.

mod known;

pub use known::{Known, Shrunken, shrunken};

use super::pairs::Pairs;
use super::simulation::{davidson, stream};
use rand::RngExt;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Gauss and Hermite's rule of 11 points for a standard normal variable: the weight of 0, then points above it with theirs.
const MIDDLE: f64 = 0.369_408_369_408_369_4;
const POINTS: [(f64, f64); 5] = [
    (0.928_868_997_381_064, 0.242_240_299_873_970_4),
    (1.876_035_020_154_846_2, 0.066_138_746_071_057_7),
    (2.865_123_160_643_645, 0.006_720_285_235_537_28),
    (3.936_166_607_129_977, 0.000_195_671_930_271_223_6),
    (5.188_001_224_374_871, 8.121_849_790_214_923e-7),
];

fn entropy(chances: [f64; 3]) -> f64 {
    let one = |p: f64| if p > 0.0 { -p * p.ln() } else { 0.0 };
    chances.into_iter().map(one).sum()
}

/// What an answer tells, in nats, where u is normal with this mean and variance: see the module. At most ln 3.
pub fn expected_information(mean: f64, variance: f64, nu: f64) -> f64 {
    let sd = variance.max(0.0).sqrt();
    let mut chances = davidson(mean, nu).map(|p| MIDDLE * p);
    let mut entropies = MIDDLE * entropy(davidson(mean, nu));
    for (x, weight) in POINTS {
        for at in [mean + sd * x, mean - sd * x] {
            let own = davidson(at, nu);
            (0..3).for_each(|o| chances[o] += weight * own[o]);
            entropies += weight * entropy(own);
        }
    }
    (entropy(chances) - entropies).max(0.0)
}

/// Fisher's information on u of one answer.
fn fisher(u: f64, nu: f64) -> f64 {
    let [left, _, right] = davidson(u, nu);
    0.25 * (left + right) - 0.25 * (left - right).powi(2)
}

impl Known {
    /// What an answer about a pair tells.
    fn tells(&self, left: usize, right: usize) -> f64 {
        let mean = self.log_worths[left] - self.log_worths[right];
        expected_information(mean, self.variance(left, right), self.nu)
    }

    fn variance(&self, left: usize, right: usize) -> f64 {
        self.covariance[left][left] + self.covariance[right][right] - 2.0 * self.covariance[left][right]
    }

    /// Makes the covariance what it would be after an answer of the information that is expected here.
    fn ask(&mut self, left: usize, right: usize) {
        let information = fisher(self.log_worths[left] - self.log_worths[right], self.nu);
        let moved: Vec<f64> = self.covariance.iter().map(|row| row[left] - row[right]).collect();
        let part = information / (1.0 + information * self.variance(left, right));
        for (row, x) in self.covariance.iter_mut().zip(&moved) {
            row.iter_mut().zip(&moved).for_each(|(cell, y)| *cell -= part * x * y);
        }
    }
}

/// A pair, and what it told when that was last looked at.
struct Candidate {
    tells: f64,
    /// The place in the order of pairs that is drawn for the person.
    order: usize,
    pair: (usize, usize),
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Candidate {}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        self.tells.total_cmp(&other.tells).then_with(|| other.order.cmp(&self.order))
    }
}

/// All pairs of so many items, in an order that is drawn.
fn shuffled(items: usize, random: &mut impl rand::Rng) -> Vec<(usize, usize)> {
    let mut pairs: Vec<(usize, usize)> =
        (0..items).flat_map(|left| (left + 1..items).map(move |right| (left, right))).collect();
    (1..pairs.len()).rev().for_each(|last| pairs.swap(last, random.random_range(0..=last)));
    pairs
}

/// The pairs that a person is dealt, each of all pairs coming equally often over people, whatever anybody answers. No pair comes twice,
/// so that a person may be dealt fewer where one pack ends and the next begins.
///
/// # Panics
/// With fewer than two items.
pub fn dealt_pairs(items: usize, person: usize, number: usize, seed: u64) -> Vec<[usize; 2]> {
    assert!(items > 1, "{items} items");
    let all = items * (items - 1) / 2;
    let mut dealt: Vec<[usize; 2]> = Vec::with_capacity(number);
    let mut sides = stream(seed ^ SIDES, person as u64);
    let (mut pack, mut number_of_pack) = (Vec::new(), None);
    for place in person * number..(person + 1) * number {
        if number_of_pack != Some(place / all) {
            number_of_pack = Some(place / all);
            pack = shuffled(items, &mut stream(seed ^ PACKS, (place / all) as u64));
        }
        let (a, b) = pack[place % all];
        let pair = if sides.random() { [b, a] } else { [a, b] };
        if !dealt.contains(&[a, b]) && !dealt.contains(&[b, a]) {
            dealt.push(pair);
        }
    }
    dealt
}

/// Streams of random numbers of their own.
const SIDES: u64 = 0x51de_51de;
const PACKS: u64 = 0xdea1_dea1;
const CHOICES: u64 = 0xc401_ce00;

/// The pairs to ask the next person about, `[left, right]`: `number` of them, or all there are. The first half is
/// [dealt](dealt_pairs()), the others are those that tell most.
///
/// `answered` are the answers of everybody before, and `person` is how many these are. No pair comes twice. Of equal pairs the seed draws,
/// and it draws sides. The same inputs, the same pairs. Show them in an order of the person's own.
///
/// # Panics
/// With fewer than two items.
pub fn next_pairs(answered: &Pairs, person: usize, number: usize, seed: u64) -> Vec<[usize; 2]> {
    let items = answered.items;
    let mut pairs = dealt_pairs(items, person, number.min(items * (items - 1) / 2) / 2, seed);
    let number = number.saturating_sub(pairs.len());
    pairs.extend(chosen_pairs(answered, &|_, _| true, &pairs, person, number, seed));
    pairs
}

/// The pairs that tell most beside those that a person is `dealt` in any case: `number` of them, or all that are left of those that
/// `may_be_asked`, which is told the lower item first.
///
/// Otherwise as [`next_pairs`].
///
/// # Panics
/// With fewer than two items.
pub fn chosen_pairs(
    answered: &Pairs,
    may_be_asked: &dyn Fn(usize, usize) -> bool,
    dealt: &[[usize; 2]],
    person: usize,
    number: usize,
    seed: u64,
) -> Vec<[usize; 2]> {
    let items = answered.items;
    let mut pairs = dealt.to_vec();
    let number = dealt.len() + number;
    let mut known = Known::of(answered);
    pairs.iter().for_each(|&[left, right]| known.ask(left, right));
    let mut random = stream(seed ^ CHOICES, person as u64);
    let is_open =
        |&(a, b): &(usize, usize)| may_be_asked(a, b) && !pairs.contains(&[a, b]) && !pairs.contains(&[b, a]);
    let candidate = |(order, pair): (usize, (usize, usize))| Candidate {
        tells: known.tells(pair.0, pair.1),
        order,
        pair,
    };
    let others = shuffled(items, &mut random).into_iter().filter(is_open);
    let mut open: BinaryHeap<Candidate> = others.enumerate().map(candidate).collect();
    // What a pair tells only falls while others are asked: whoever is first after a new look is the first of all.
    while pairs.len() < number {
        let Some(best) = open.pop() else { break };
        let (a, b) = best.pair;
        let tells = known.tells(a, b);
        if open.peek().is_some_and(|next| tells < next.tells) {
            open.push(Candidate { tells, ..best });
            continue;
        }
        known.ask(a, b);
        pairs.push(if random.random() { [b, a] } else { [a, b] });
    }
    pairs.split_off(dealt.len())
}

#[cfg(test)]
mod tests;
