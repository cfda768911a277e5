//! How much people differ in their tastes: Davidson's model with a random effect of each person on each item.
//!
//! A person's log worths are the population's plus independent normal deviations with standard deviation sd / sqrt(2), so that
//! the difference of two items has standard deviation sd between people: what [`simulation`](crate::simulation) plants and
//! power assumes. A person's likelihood is an integral over the deviations, taken by Laplace's approximation, as lme4's `glmer`
//! does by default (Tierney and Kadane 1986, J. Am. Statist. Ass. 81:82). It is exact at sd 0, and a little low where a person
//! gave few answers about each item.
//!
//! The population's worths grow with sd, since an average over people is closer to one half than any of them: here they all grow
//! by one factor, which is estimated together with sd and the tie parameter.

use super::fit::{FitError, WorthFit};
use super::newton::{Curvature, Matrix, inverse, ln_determinant, times};
use super::participants::{AnsweredPair, Participants};
use super::scale::fit_on_one_scale;
use super::simulation::davidson;
use crate::interval::{Interval, LEVEL};
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Patterns of answers that are looked at; of more, every n-th is.
const MOST_PATTERNS: usize = 400;
/// The largest sd that is tried, in log-odds: beyond it nearly every answer is certain.
const LARGEST: f64 = 8.0;
/// How closely sd is found.
const CLOSE: f64 = 0.01;
/// Gains of the log-likelihood below this are not looked for.
const SEEN: f64 = 1e-4;
/// Half a width of the numerical derivatives.
const WIDTH: f64 = 1e-4;

/// The spread between people.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heterogeneity {
    /// Standard deviation between people of the difference of two items' log worths, in log-odds; 0 if none is seen.
    pub sd: f64,
    /// By the likelihood ratio at [`LEVEL`]; the upper end is at most 8.
    pub interval: Interval,
    /// p of no spread, by the likelihood ratio: half a chi-square on one degree of freedom, sd being at its boundary.
    pub p: f64,
}

impl Heterogeneity {
    /// Whether the upper end is an end, and not the largest value that is looked at.
    pub fn is_bounded(&self) -> bool {
        self.interval.high < LARGEST
    }
}

/// The spread between the people of a group.
///
/// # Errors
/// As [`fit`](crate::fit); [`FitError::NoMaximum`] where the worths need a penalty, and for fewer than two people.
pub fn heterogeneity(participants: &Participants) -> Result<Heterogeneity, FitError> {
    let fit = fit_on_one_scale(&participants.sum(&participants.counts))?;
    if fit.penalised() || participants.number() < 2 {
        return Err(FitError::NoMaximum);
    }
    let mut likelihood = Likelihood::of(participants, &fit);
    let mut at = |sd: f64| likelihood.profile(sd);
    let none = at(0.0);
    // The likelihood has one top: the best of a coarse grid, then closer by golden sections.
    let grid = [0.25, 0.5, 1.0, 2.0, 4.0, LARGEST];
    let tops: Vec<f64> = grid.iter().map(|&sd| at(sd)).collect();
    let best = (0..grid.len()).fold(0, |best, i| if tops[i] > tops[best] { i } else { best });
    let low = if best == 0 { 0.0 } else { grid[best - 1] };
    let high = grid[(best + 1).min(grid.len() - 1)];
    let (sd, top) = highest(&mut at, low, high);
    let (sd, top) = if top > none { (sd, top) } else { (0.0, none) };
    let chi_square = ChiSquared::new(1.0).expect("one degree of freedom");
    let drop = 0.5 * chi_square.inverse_cdf(LEVEL);
    let mut is_near = |sd: f64| top - at(sd) <= drop;
    let low = if top - none <= drop { 0.0 } else { end(&mut is_near, sd, 0.0) };
    let high = if is_near(LARGEST) { LARGEST } else { end(&mut is_near, sd, LARGEST) };
    let p = if sd > 0.0 { 0.5 * chi_square.sf(2.0 * (top - none)) } else { 1.0 };
    Ok(Heterogeneity { sd, interval: Interval { low, high }, p })
}

/// The highest point between two ends, by golden sections.
fn highest(mut of: impl FnMut(f64) -> f64, mut low: f64, mut high: f64) -> (f64, f64) {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_a, mut at_b) = (of(a), of(b));
    while high - low > CLOSE {
        if at_a >= at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - golden * (high - low);
            at_a = of(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + golden * (high - low);
            at_b = of(b);
        }
    }
    if at_a >= at_b { (a, at_a) } else { (b, at_b) }
}

/// Where what holds at `inside` ends on the way to `outside`, by halving.
fn end(mut holds: impl FnMut(f64) -> bool, mut inside: f64, mut outside: f64) -> f64 {
    while (outside - inside).abs() > CLOSE {
        let middle = 0.5 * (inside + outside);
        if holds(middle) { inside = middle } else { outside = middle }
    }
    inside
}

/// One pattern of answers.
struct Person {
    /// Of each pair that was shown: its items, how far the left one is ahead for people on average, answers `[left, tie, right]`.
    pairs: Vec<(usize, usize, f64, [f64; 3])>,
    people: f64,
    /// The likeliest deviations that were found last: where the next search begins.
    mode: Vec<f64>,
}

/// The likelihood of all answers.
struct Likelihood {
    persons: Vec<Person>,
    /// ln nu on average over people; `None` without a tie.
    ln_nu: Option<f64>,
}

impl Likelihood {
    fn of(participants: &Participants, fit: &WorthFit) -> Self {
        let side = fit.side.unwrap_or(0.0);
        let step = participants.kinds().div_ceil(MOST_PATTERNS).max(1);
        let person = |(pattern, people): (&[AnsweredPair], u64)| {
            let pair = |of: &AnsweredPair| {
                let (left, right) = participants.shown()[of.place()];
                let ahead = fit.log_worths[left] - fit.log_worths[right] + side;
                (left, right, ahead, of.answers.map(f64::from))
            };
            let mode = vec![0.0; participants.items()];
            Person { pairs: pattern.iter().map(pair).collect(), people: people as f64, mode }
        };
        let persons = participants.of_kinds().step_by(step).map(person).collect();
        Self { persons, ln_nu: fit.ln_nu.filter(|nu| nu.is_finite()) }
    }

    /// The largest log-likelihood at this sd, over the factor of all worths and the tie parameter.
    fn profile(&mut self, sd: f64) -> f64 {
        // What an average over people takes off a worth (Zeger, Liang and Albert 1988).
        let mut at = [(1.0 + 0.35 * sd * sd).sqrt(), self.ln_nu.unwrap_or(0.0)];
        let free = if self.ln_nu.is_some() { 2 } else { 1 };
        let mut here = self.sum(sd, at);
        for _ in 0..30 {
            let (gradient, information) = self.slopes(sd, at, free);
            let Some(covariance) = inverse(&information) else { return here };
            let step = times(&covariance, &gradient);
            if step.iter().zip(&gradient).map(|(s, g)| s * g).sum::<f64>() < SEEN {
                return here;
            }
            let mut part = 1.0;
            let (there, value) = loop {
                let mut there = at;
                (0..free).for_each(|i| there[i] += part * step[i].clamp(-1.0, 1.0));
                let value = self.sum(sd, there);
                if value > here {
                    break (there, value);
                }
                part *= 0.5;
                if part < 0.01 {
                    return here;
                }
            };
            (at, here) = (there, value);
        }
        here
    }

    fn sum(&mut self, sd: f64, at: [f64; 2]) -> f64 {
        let nu = self.nu(at);
        let of_person = |person: &mut Person| person.people * person.likelihood(sd, at[0], nu);
        let each: Vec<f64> = self.persons.par_iter_mut().map(of_person).collect();
        each.iter().sum()
    }

    fn nu(&self, at: [f64; 2]) -> f64 {
        if self.ln_nu.is_some() { at[1].exp() } else { 0.0 }
    }

    /// The gradient, and the sum of its parts' squares in place of the information (Berndt and others 1974).
    fn slopes(&mut self, sd: f64, at: [f64; 2], free: usize) -> (Vec<f64>, Matrix) {
        let moved = |i: usize, by: f64| {
            let mut there = at;
            there[i] += by;
            (there[0], self.nu(there))
        };
        let ends: Vec<[(f64, f64); 2]> = (0..free).map(|i| [moved(i, WIDTH), moved(i, -WIDTH)]).collect();
        let slope = |person: &mut Person| -> Vec<f64> {
            let mut at = |(factor, nu)| person.likelihood(sd, factor, nu);
            ends.iter().map(|&[more, less]| (at(more) - at(less)) / (2.0 * WIDTH)).collect()
        };
        let slopes: Vec<Vec<f64>> = self.persons.par_iter_mut().map(slope).collect();
        let mut gradient = vec![0.0; free];
        let mut information: Matrix = vec![vec![0.0; free]; free];
        for (slope, person) in slopes.iter().zip(&self.persons) {
            for i in 0..free {
                gradient[i] += person.people * slope[i];
                (0..free).for_each(|j| information[i][j] += person.people * slope[i] * slope[j]);
            }
        }
        (gradient, information)
    }
}

impl Person {
    /// ln of the likelihood, integrated over deviations of sd / sqrt(2) each.
    fn likelihood(&mut self, sd: f64, factor: f64, nu: f64) -> f64 {
        let scale = sd / std::f64::consts::SQRT_2;
        let mut here = self.at(&self.mode, scale, factor, nu);
        // Concave, and close to quadratic: the prior alone has curvature 1.
        for _ in 0..50 {
            let Some(covariance) = inverse(&here.information) else { break };
            let step = times(&covariance, &here.gradient);
            let gain: f64 = step.iter().zip(&here.gradient).map(|(s, g)| s * g).sum();
            if gain < 1e-9 {
                break;
            }
            let forward =
                |part: f64| -> Vec<f64> { self.mode.iter().zip(&step).map(|(b, s)| b + part * s).collect() };
            let parts = [1.0, 0.5, 0.25, 0.125].into_iter().map(forward);
            let next = parts
                .map(|there| (self.at(&there, scale, factor, nu), there))
                .find(|(of, _)| of.value >= here.value);
            let Some((of, there)) = next else { break };
            (here, self.mode) = (of, there);
        }
        // The prior alone makes it positive definite.
        here.value - 0.5 * ln_determinant(&here.information).unwrap_or(0.0)
    }

    /// ln(p(answers | deviations) p(deviations)) but for its constant, deviations in units of `scale`.
    fn at(&self, deviations: &[f64], scale: f64, factor: f64, nu: f64) -> Curvature {
        let b = deviations;
        let mut sum = Curvature::zero(b.len());
        for (i, b) in b.iter().enumerate() {
            sum.value -= 0.5 * b * b;
            sum.gradient[i] = -b;
            sum.information[i][i] = 1.0;
        }
        for &(left, right, ahead, answers) in &self.pairs {
            let chances = davidson(factor * ahead + scale * (b[left] - b[right]), nu);
            let counted = answers.iter().zip(chances).filter(|(count, _)| **count > 0.0);
            sum.value += counted.map(|(count, chance)| count * chance.ln()).sum::<f64>();
            let mean = 0.5 * (chances[0] - chances[2]);
            let n: f64 = answers.iter().sum();
            let slope = scale * (0.5 * (answers[0] - answers[2]) - n * mean);
            let curve = scale * scale * n * (0.25 * (chances[0] + chances[2]) - mean * mean);
            sum.gradient[left] += slope;
            sum.gradient[right] -= slope;
            for (i, j, sign) in
                [(left, left, 1.0), (right, right, 1.0), (left, right, -1.0), (right, left, -1.0)]
            {
                sum.information[i][j] += sign * curve;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests;
