//! Simulated answers of people whose preferences are known: for proving tests, and for planning how many people to ask.
//!
//! Each participant has an own deviation from the population's worths; the answers follow Davidson's model with a bonus
//! for the left side ([`Model::DavidsonSide`](crate::Model)), given that deviation.

use crate::{Outcome, ShownBallot};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::collections::BTreeMap;

/// One question of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shown {
    /// The item on the left, unless sides are swapped.
    pub left: usize,
    /// The item on the right.
    pub right: usize,
    /// What the items are shown on, such as an object.
    pub scene: usize,
}

/// What everybody is asked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    /// How many items.
    pub items: usize,
    /// The questions.
    pub questions: Vec<Shown>,
    /// Sides are swapped in every other question, for every other participant in the other half of the questions.
    pub counterbalanced: bool,
}

impl Plan {
    /// Every pair of items in every scene once, sides counterbalanced.
    pub fn round_robin(items: usize, scenes: usize) -> Self {
        let pairs = (0..items).flat_map(|left| (left + 1..items).map(move |right| (left, right)));
        let questions = (0..scenes)
            .flat_map(|scene| pairs.clone().map(move |(left, right)| Shown { left, right, scene }))
            .collect();
        Self { items, questions, counterbalanced: true }
    }

    /// The scene of each question.
    pub fn scenes(&self) -> Vec<usize> {
        self.questions.iter().map(|shown| shown.scene).collect()
    }

    /// Which items a participant sees left and right.
    pub fn sides(&self, participant: usize, question: usize) -> (usize, usize) {
        let Shown { left, right, .. } = self.questions[question];
        let swapped = self.counterbalanced && (participant + question) % 2 == 1;
        if swapped { (right, left) } else { (left, right) }
    }
}

/// What people prefer.
#[derive(Debug, Clone, PartialEq)]
pub struct Population {
    /// Log-worth of each item.
    pub worths: Vec<f64>,
    /// Scenes in which other log-worths hold.
    pub exceptions: BTreeMap<usize, Vec<f64>>,
    /// Davidson's tie parameter nu: two equal items tie with chance nu / (2 + nu).
    pub nu: f64,
    /// Bonus of the left side in logits.
    pub side: f64,
    /// Standard deviation between participants of the difference of two items' log-worths, in logits.
    pub sd: f64,
}

impl Population {
    /// No preference for any item or side: tie parameter 0.3 and this much difference between people.
    pub fn indifferent(items: usize, sd: f64) -> Self {
        Self { worths: vec![0.0; items], exceptions: BTreeMap::new(), nu: 0.3, side: 0.0, sd }
    }

    /// Difference of log-worths that a question's left side starts with, side bonus included.
    fn advantage(&self, (left, right): (usize, usize), scene: usize) -> f64 {
        let worths = self.exceptions.get(&scene).unwrap_or(&self.worths);
        worths[left] - worths[right] + self.side
    }

    /// Chances `[left, tie, right]` over all people, for items on these sides of a scene: Davidson's, averaged over the
    /// normal differences between people by Simpson's rule.
    pub fn chances(&self, sides: (usize, usize), scene: usize) -> [f64; 3] {
        let (reach, steps) = (8.0, 400);
        let mut sums = [0.0; 4];
        for i in 0..=steps {
            let z = -reach + 2.0 * reach * f64::from(i) / f64::from(steps);
            let simpson = if i == 0 || i == steps { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
            let weight = simpson * (-0.5 * z * z).exp();
            let chances = davidson(self.advantage(sides, scene) + self.sd * z, self.nu);
            (0..3).for_each(|o| sums[o] += weight * chances[o]);
            sums[3] += weight;
        }
        [sums[0] / sums[3], sums[1] / sums[3], sums[2] / sums[3]]
    }
}

/// Davidson's chances `[left, tie, right]` where left is ahead by this many logits.
pub fn davidson(ahead: f64, nu: f64) -> [f64; 3] {
    // Relative to the larger side, so that nothing overflows.
    let behind = (-ahead.abs()).exp();
    let (left, right) = if ahead >= 0.0 { (1.0, behind) } else { (behind, 1.0) };
    let tie = nu * behind.sqrt();
    let sum = left + tie + right;
    [left / sum, tie / sum, right / sum]
}

/// The stream of random numbers of one study of a series.
pub fn stream(seed: u64, study: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed ^ study.wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

/// Everybody's answers, participant by participant, in the order of questions. The same stream, the same answers.
///
/// # Panics
/// If the population has fewer items than the plan.
pub fn simulate(
    plan: &Plan,
    population: &Population,
    participants: usize,
    stream: &mut impl Rng,
) -> Vec<ShownBallot> {
    let mut ballots = Vec::with_capacity(participants * plan.questions.len());
    for participant in 0..participants {
        // Two independent deviations of sd / sqrt(2) differ by sd.
        let scale = population.sd / std::f64::consts::SQRT_2;
        let deviations: Vec<f64> = (0..plan.items).map(|_| scale * normal(stream)).collect();
        for (question, shown) in plan.questions.iter().enumerate() {
            let (left, right) = plan.sides(participant, question);
            let ahead =
                population.advantage((left, right), shown.scene) + deviations[left] - deviations[right];
            let outcome = draw(davidson(ahead, population.nu), stream);
            ballots.push(ShownBallot::new(participant, question, [left, right], outcome));
        }
    }
    ballots
}

/// An outcome with these chances of left, tie and right.
pub fn draw([left, tie, _]: [f64; 3], stream: &mut impl Rng) -> Outcome {
    let u: f64 = stream.random();
    match u {
        u if u < left => Outcome::Left,
        u if u < left + tie => Outcome::Tie,
        _ => Outcome::Right,
    }
}

/// A standard normal number (Box and Muller 1958).
pub fn normal(stream: &mut impl Rng) -> f64 {
    let (u, v): (f64, f64) = (stream.random(), stream.random());
    (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

#[cfg(test)]
mod coverage;
#[cfg(test)]
mod tests;
