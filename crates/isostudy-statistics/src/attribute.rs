//! Do worths go with an attribute of people, such as their experience or their age? A permutation test over people.
//!
//! Davidson's model, with a bonus for a side where pairs were shown in both orders, is fitted to everybody's answers together.
//! What a person's answers say of the worths beyond that is the gradient s of their own log-likelihood, less what the tie
//! parameter and the side explain of it (the efficient score; Boos 1992, Amer. Statist. 46:327). With I the information of
//! the worths, S_g the sum of s over the n_g people of a group, and n people in all, the statistic is
//!
//! T = n sum_g S_g' I^-1 S_g / n_g,
//!
//! which is the likelihood ratio of own worths for every group against common ones, as far as the likelihood is quadratic. Of an
//! attribute that is a number x, less its mean: T = n S' I^-1 S / sum x^2, S = sum x s.
//!
//! Under the null hypothesis anybody could have had anybody's attribute. So the p is the share of orders of the people, among
//! [`ORDERS`] drawn ones and the observed one, whose T is as large (Pesarin and Salmaso 2010, section 1.9). It is right at any number
//! of people, and however much one person's answers hang together. Where T were compared with a chi-square it would not be.

use super::ballot::ShownBallot;
use super::fit::{FitError, WorthFit};
use super::model::{Layout, Touched};
use super::newton::{Matrix, factor, inverse, times};
use super::pairs::Pairs;
use super::scale::fit_on_one_scale;
use super::simulation::stream;
use rand::RngExt;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Orders of people that are drawn, at most.
pub const ORDERS: u64 = 9_999;
/// Orders times people, at most: of very many people fewer orders are drawn.
const MOST_MOVES: u64 = 200_000_000;
/// Fewest orders that are drawn.
const FEWEST_ORDERS: u64 = 999;
/// Seed of the orders.
const SEED: u64 = 20_261_127;
/// Sums in another order differ by less than this part.
const ROUNDING: f64 = 1e-9;

/// Something about people, by participant. People of whom it is not known are `None`, and left out.
#[derive(Debug, Clone, PartialEq)]
pub enum Attribute {
    /// Which group each belongs to, from 0.
    Group(Vec<Option<usize>>),
    /// A number for each.
    Number(Vec<Option<f64>>),
}

impl Attribute {
    /// The value of a participant: of a group its number.
    fn of(&self, participant: usize) -> Option<f64> {
        match self {
            Self::Group(of) => of.get(participant).copied().flatten().map(|group| group as f64),
            Self::Number(of) => of.get(participant).copied().flatten(),
        }
    }
}

/// Whether worths go with an attribute.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttributeTest {
    /// T; near a chi-square on `degrees` if all answers were independent.
    pub statistic: f64,
    /// Free worths times groups less one, or times 1 of a number.
    pub degrees: usize,
    /// People of whom the attribute is known, and who compared two items.
    pub people: usize,
    /// Orders that were drawn.
    pub orders: u64,
    /// Share of the orders, the observed one among them, with a T as large.
    pub p: f64,
}

/// Tests whether the worths of a group of items go with an attribute of people.
///
/// The order of participants, of groups and of ballots changes nothing. Where people were asked about different pairs, that must not
/// go with the attribute either: the test speaks of both together.
///
/// # Errors
/// As [`fit`](crate::fit()) on everybody's answers; [`FitError::NoMaximum`] where the worths need a penalty, and
/// [`FitError::Nothing`] where fewer than two people differ in the attribute.
pub fn attribute_test(
    items: usize,
    ballots: &[ShownBallot],
    attribute: &Attribute,
) -> Result<AttributeTest, FitError> {
    let is_used = |b: &&ShownBallot| b.left() != b.right() && attribute.of(b.participant()).is_some();
    let used: Vec<&ShownBallot> = ballots.iter().filter(is_used).collect();
    let pairs = Pairs::of(items, used.iter().copied());
    let fit = fit_on_one_scale(&pairs)?;
    if fit.penalised() {
        return Err(FitError::NoMaximum);
    }
    let mut people = people(items, &used, &pairs, &fit, attribute)?;
    people.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| compare(&a.1, &b.1)));
    let (values, beyond): (Vec<f64>, Vec<Vec<f64>>) = people.into_iter().unzip();
    if values.first() == values.last() {
        return Err(FitError::Nothing);
    }
    let contrasts = Contrasts::of(&values, matches!(attribute, Attribute::Group(_)));
    let in_order: Vec<usize> = (0..values.len()).collect();
    let statistic = contrasts.statistic(&beyond, &in_order);
    let orders = (MOST_MOVES / values.len() as u64).clamp(FEWEST_ORDERS, ORDERS);
    let is_as_large = |order: u64| {
        let mut random = stream(SEED, order);
        let mut people = in_order.clone();
        (1..people.len()).rev().for_each(|last| people.swap(last, random.random_range(0..=last)));
        contrasts.statistic(&beyond, &people) >= statistic * (1.0 - ROUNDING)
    };
    let large = (0..orders).into_par_iter().filter(|&order| is_as_large(order)).count() as u64;
    Ok(AttributeTest {
        statistic,
        degrees: (items - 1) * contrasts.columns(),
        people: values.len(),
        orders,
        p: (large + 1) as f64 / (orders + 1) as f64,
    })
}

fn compare(a: &[f64], b: &[f64]) -> std::cmp::Ordering {
    let differing = a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne());
    differing.unwrap_or(std::cmp::Ordering::Equal)
}

/// The parameters that a pair touches, and the gradient by them of each of its outcomes.
type Gradients = (Touched, [[f64; 4]; 3]);

/// Of each person the attribute, and L^-1 s with I = L L': what their answers say beyond the common worths, in a unit in which the
/// quadratic form of I^-1 is a sum of squares.
fn people(
    items: usize,
    used: &[&ShownBallot],
    pairs: &Pairs,
    fit: &WorthFit,
    attribute: &Attribute,
) -> Result<Vec<(f64, Vec<f64>)>, FitError> {
    let layout = Layout::of(fit.model, pairs, fit.given_side);
    let scores: BTreeMap<(usize, usize), Gradients> = pairs
        .pairs
        .iter()
        .map(|pair| ((pair.left, pair.right), layout.scores((pair.left, pair.right), &fit.parameters)))
        .collect();
    let mut given: BTreeMap<usize, BTreeMap<(usize, usize), [u32; 3]>> = BTreeMap::new();
    for ballot in used {
        let of_person = given.entry(ballot.participant()).or_default();
        of_person.entry((ballot.left(), ballot.right())).or_default()[ballot.outcome().index()] += 1;
    }
    // The worths' part of the inverse information is the inverse of the efficient information.
    let worths = items - 1;
    let of_worths: Matrix = fit.covariance[..worths].iter().map(|row| row[..worths].to_vec()).collect();
    let efficient = inverse(&of_worths).and_then(|information| factor(&information));
    let lower = efficient.ok_or(FitError::Unsettled)?;
    let beyond = |answers: &BTreeMap<(usize, usize), [u32; 3]>| -> Vec<f64> {
        let mut score = vec![0.0; fit.parameters.len()];
        for (pair, counts) in answers {
            let (touched, of_outcomes) = &scores[pair];
            for (i, &place) in touched.places().iter().enumerate() {
                score[place] += (0..3).map(|o| f64::from(counts[o]) * of_outcomes[o][i]).sum::<f64>();
            }
        }
        // I^-1 s of the worths; then L' of it is L^-1 of the efficient score.
        let moved = times(&fit.covariance, &score);
        (0..worths).map(|j| (j..worths).map(|i| lower[i][j] * moved[i]).sum()).collect()
    };
    let of = |(&participant, answers): (&usize, &BTreeMap<_, _>)| {
        (attribute.of(participant).expect("only known ones are used"), beyond(answers))
    };
    Ok(given.iter().map(of).collect())
}

/// What is compared between people, who stand in the order of their attribute.
enum Contrasts {
    /// Where each group ends.
    Groups(Vec<usize>),
    /// Each number less the mean, and the sum of their squares.
    Number(Vec<f64>, f64),
}

impl Contrasts {
    fn of(values: &[f64], are_groups: bool) -> Self {
        if are_groups {
            let lengths = values.chunk_by(|a, b| a == b).map(<[f64]>::len);
            return Self::Groups(
                lengths
                    .scan(0, |end, length| {
                        *end += length;
                        Some(*end)
                    })
                    .collect(),
            );
        }
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let centred: Vec<f64> = values.iter().map(|x| x - mean).collect();
        let squares = centred.iter().map(|x| x * x).sum();
        Self::Number(centred, squares)
    }

    fn columns(&self) -> usize {
        match self {
            Self::Groups(ends) => ends.len() - 1,
            Self::Number(..) => 1,
        }
    }

    /// T with the people in this order.
    fn statistic(&self, beyond: &[Vec<f64>], order: &[usize]) -> f64 {
        let people = order.len() as f64;
        let sum_of_squares = |own: &[usize], weight: &dyn Fn(usize) -> f64| -> f64 {
            let mut sums = vec![0.0; beyond[0].len()];
            for (place, &person) in own.iter().enumerate() {
                let weight = weight(place);
                sums.iter_mut().zip(&beyond[person]).for_each(|(sum, x)| *sum += weight * x);
            }
            sums.iter().map(|sum| sum * sum).sum()
        };
        match self {
            Self::Groups(ends) => {
                let starts = std::iter::once(0).chain(ends.iter().copied());
                let groups = starts
                    .zip(ends)
                    .map(|(start, &end)| sum_of_squares(&order[start..end], &|_| 1.0) / (end - start) as f64);
                people * groups.sum::<f64>()
            }
            Self::Number(centred, squares) => {
                people * sum_of_squares(order, &|place| centred[place]) / squares
            }
        }
    }
}

#[cfg(test)]
mod tests;
