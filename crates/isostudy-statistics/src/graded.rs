//! Answers in steps: how much better one of two things is, from "much better" through "no preference" to "much worse".
//!
//! A step y is above 0 for the left side, below for the right, and 0 for neither. With u = l_left - l_right + side, and a weight or
//! a cut for each size of step, the same for both sides (Agresti 1992, Appl. Statist. 41:287):
//!
//! - **Adjacent categories**: weights e^{y u / 2} w_|y|, w_1 = 1. With the steps -1, 0, 1 it is Davidson's model, w_0 = nu, and
//!   without 0 Bradley and Terry's: so a worth is on their scale.
//! - **Cumulative**: P(step of y or more) = F(u - theta_y), F logistic. With the steps -1, 0, 1 it is Rao and Kupper's model. Its
//!   worths are on another scale: compare orders, not sizes.
//!
//! Forced choice, where nobody may answer "no preference", is the steps -1 and 1.

use super::clustered::{Coefficient, Estimates, sandwich};
use super::fit::FitError;
use super::newton::{Curvature, Matrix, inverse, maximise};
use super::pairs::Pairs;
use super::separation::{Separation, separation};
use super::side::{SideDesign, side_design};
use std::collections::BTreeMap;

/// The largest step that is taken.
pub const MOST_STEPS: i8 = 9;

/// One answer of one participant about two items, in steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct GradedBallot {
    /// The participant, from 0.
    pub participant: usize,
    /// The item on the left, from 0.
    pub left: usize,
    /// The item on the right.
    pub right: usize,
    /// How far the left one is better, in steps; below 0 if the right one is.
    pub step: i8,
}

/// How the sizes of steps follow from worths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Link {
    /// Each step against the next one.
    Adjacent,
    /// Each step and all beyond against the others.
    Cumulative,
}

/// Estimates of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct GradedFit {
    /// Which model.
    pub link: Link,
    /// Log worths; the first item's is 0.
    pub log_worths: Vec<f64>,
    /// By size of step that anybody gave, ascending: ln w or theta. The smallest above 0 of the first has none, and of the second
    /// none where nobody answered 0.
    pub steps: Vec<(i8, f64)>,
    /// The left side's bonus in log-odds, where pairs were shown in both orders.
    pub side: Option<f64>,
    /// Log-likelihood of the answers, without multinomial constants.
    pub log_likelihood: f64,
    /// Inverse of the information: worths of items 1.., then `steps`, then side.
    pub covariance: Matrix,
    /// Sandwich covariance with participants as clusters; `None` with fewer than two of them.
    pub clustered: Option<Matrix>,
    /// How many participants answered.
    pub participants: u64,
}

/// Which parameters there are.
struct Layout {
    link: Link,
    items: usize,
    /// Sizes of steps above 0 that anybody gave, ascending.
    sizes: Vec<i8>,
    /// Whether anybody answered 0.
    middle: bool,
    side: bool,
}

impl Layout {
    /// The sizes that have a parameter.
    fn free(&self) -> Vec<i8> {
        let middle = self.middle.then_some(0);
        match self.link {
            Link::Adjacent => middle.into_iter().chain(self.sizes[1..].iter().copied()).collect(),
            Link::Cumulative => self.sizes[usize::from(!self.middle)..].to_vec(),
        }
    }

    fn size(&self) -> usize {
        self.items - 1 + self.free().len() + usize::from(self.side)
    }

    fn start(&self) -> Vec<f64> {
        let mut start = vec![0.0; self.size()];
        if self.link == Link::Cumulative {
            // Cuts must ascend.
            (0..self.free().len()).for_each(|i| start[self.items - 1 + i] = 0.5 + i as f64);
        }
        start
    }

    /// The log-likelihood of one answer as a function of u and the step parameters, in this order.
    fn local(&self, step: i8, u: f64, steps: &[f64]) -> Curvature {
        match self.link {
            Link::Adjacent => self.adjacent(step, u, steps),
            Link::Cumulative => self.cumulative(step, u, steps),
        }
    }

    fn adjacent(&self, step: i8, u: f64, steps: &[f64]) -> Curvature {
        let free = self.free();
        let mut all: Vec<i8> = self.sizes.iter().flat_map(|&size| [size, -size]).collect();
        all.extend(self.middle.then_some(0));
        let weight = |of: i8| free.iter().position(|&size| size == of.abs());
        let log = |of: i8| 0.5 * f64::from(of) * u + weight(of).map_or(0.0, |i| steps[i]);
        let feature = |of: i8, place: usize| match place {
            0 => 0.5 * f64::from(of),
            _ => f64::from(u8::from(weight(of) == Some(place - 1))),
        };
        let highest = all.iter().map(|&of| log(of)).fold(f64::NEG_INFINITY, f64::max);
        let total: f64 = all.iter().map(|&of| (log(of) - highest).exp()).sum();
        let chances: Vec<f64> = all.iter().map(|&of| (log(of) - highest).exp() / total).collect();
        let size = 1 + free.len();
        let mean: Vec<f64> = (0..size)
            .map(|place| all.iter().zip(&chances).map(|(&of, p)| p * feature(of, place)).sum())
            .collect();
        let mut local = Curvature::zero(size);
        local.value = log(step) - highest - total.ln();
        for i in 0..size {
            local.gradient[i] = feature(step, i) - mean[i];
            for j in 0..size {
                let product =
                    |(&of, p): (&i8, &f64)| p * (feature(of, i) - mean[i]) * (feature(of, j) - mean[j]);
                local.information[i][j] = all.iter().zip(&chances).map(product).sum();
            }
        }
        local
    }

    fn cumulative(&self, step: i8, u: f64, steps: &[f64]) -> Curvature {
        let free = self.free();
        let size = 1 + free.len();
        let mut local = Curvature::zero(size);
        // The cut below a size, and its parameter; without a middle the first cut is at 0.
        let cut = |of: i8| match free.iter().position(|&size| size == of) {
            Some(i) => (steps[i], Some(1 + i)),
            None => (0.0, None),
        };
        if steps.windows(2).any(|two| two[0] >= two[1]) || (self.middle && steps[0] <= 0.0) {
            local.value = f64::NEG_INFINITY;
            return local;
        }
        // An answer is between two ends: F(upper) - F(lower), each with its derivatives by u and by its cut.
        let sign = f64::from(step.signum());
        let end = |cut: Option<(f64, Option<usize>)>, sign: f64| {
            cut.map(|(cut, place)| (sign * u - cut, sign, place))
        };
        let (upper, lower) = if step == 0 {
            // F(u + theta) - F(u - theta): the upper end's cut has the other sign.
            let (theta, place) = cut(self.sizes[0]);
            (
                Some((u + theta, 1.0, place.map(|place| (place, 1.0)))),
                Some((u - theta, 1.0, place.map(|p| (p, -1.0)))),
            )
        } else {
            let place =
                self.sizes.iter().position(|&size| size == step.abs()).expect("a size that was given");
            let next = self.sizes.get(place + 1).map(|&size| cut(size));
            let with_sign =
                |(z, s, place): (f64, f64, Option<usize>)| (z, s, place.map(|place| (place, -1.0)));
            (end(Some(cut(self.sizes[place])), sign).map(with_sign), end(next, sign).map(with_sign))
        };
        let logistic = |z: f64| 1.0 / (1.0 + (-z).exp());
        let (a, b) = (upper, lower);
        let at = |of: Option<End>| of.map_or(0.0, |(z, ..)| logistic(z));
        let chance = at(a) - at(b);
        local.value = chance.ln();
        let mut gradient = vec![0.0; size];
        let mut second = vec![vec![0.0; size]; size];
        for (of, side) in [(a, 1.0), (b, -1.0)] {
            let Some((z, by_u, place)) = of else { continue };
            let f = logistic(z);
            let (slope, curve) = (f * (1.0 - f), f * (1.0 - f) * (1.0 - 2.0 * f));
            let parts: Vec<(usize, f64)> = std::iter::once((0, by_u)).chain(place).collect();
            for &(i, x) in &parts {
                gradient[i] += side * slope * x;
                parts.iter().for_each(|&(j, y)| second[i][j] += side * curve * x * y);
            }
        }
        for i in 0..size {
            local.gradient[i] = gradient[i] / chance;
            for j in 0..size {
                local.information[i][j] =
                    gradient[i] * gradient[j] / (chance * chance) - second[i][j] / chance;
            }
        }
        local
    }

    /// Adds so many of the same answers.
    fn add(&self, sum: &mut Curvature, [left, right]: [usize; 2], step: i8, times: f64, at: &[f64]) {
        let worths = self.items - 1;
        let steps = worths + self.free().len();
        let mut parts: Vec<(usize, f64)> = [(left, 1.0), (right, -1.0)]
            .into_iter()
            .filter(|(item, _)| *item > 0)
            .map(|(item, sign)| (item - 1, sign))
            .collect();
        parts.extend(self.side.then_some((steps, 1.0)));
        let u = parts.iter().map(|&(place, x)| x * at[place]).sum();
        let local = self.local(step, u, &at[worths..steps]);
        sum.value += times * local.value;
        // Places among all parameters, with the factor of each local one.
        let own = (worths..steps).enumerate().map(|(i, place)| (place, 1 + i, 1.0));
        let all: Vec<(usize, usize, f64)> =
            parts.iter().map(|&(place, x)| (place, 0, x)).chain(own).collect();
        for &(i, from, x) in &all {
            sum.gradient[i] += times * x * local.gradient[from];
            for &(j, to, y) in &all {
                sum.information[i][j] += times * x * y * local.information[from][to];
            }
        }
    }
}

/// An end of the range of an answer: where F is taken, its derivative by u, and the parameter of its cut with its derivative.
type End = (f64, f64, Option<(usize, f64)>);

/// Fits a model of steps.
///
/// Joint maximum likelihood by Newton's method; estimates to about 1e-9, whatever the order of ballots. Controls, which show an item
/// beside itself, are left out. Sizes of steps that nobody gave are as if nobody could.
///
/// # Errors
/// [`FitError::Nothing`], [`FitError::Disconnected`] and [`FitError::OnlyTies`] as [`fit`](crate::fit());
/// [`FitError::NoMaximum`] where some items were never better than the others: no penalty is taken.
///
/// # Panics
/// If an item is not below `items`, or a step is beyond [`MOST_STEPS`].
pub fn graded(link: Link, items: usize, ballots: &[GradedBallot]) -> Result<GradedFit, FitError> {
    let used = || ballots.iter().filter(|b| b.left != b.right);
    let mut people: BTreeMap<usize, BTreeMap<([usize; 2], i8), f64>> = BTreeMap::new();
    for b in used() {
        assert!((-MOST_STEPS..=MOST_STEPS).contains(&b.step), "{b:?}");
        *people.entry(b.participant).or_default().entry(([b.left, b.right], b.step)).or_default() += 1.0;
    }
    let signs = used().map(|b| {
        let mut answers = [0.0; 3];
        answers[(1 - b.step.signum()) as usize] = 1.0;
        (b.left, b.right, answers)
    });
    let pairs = Pairs::new(items, signs);
    if items < 2 || pairs.answers() == 0.0 {
        return Err(FitError::Nothing);
    }
    if pairs.ties() == pairs.answers() {
        return Err(FitError::OnlyTies);
    }
    match separation(&pairs) {
        Separation::Disconnected => return Err(FitError::Disconnected),
        Separation::Separated => return Err(FitError::NoMaximum),
        _ => {}
    }
    let mut sizes: Vec<i8> = used().map(|b| b.step.abs()).collect();
    sizes.sort_unstable();
    sizes.dedup();
    let middle = sizes[0] == 0;
    sizes.retain(|&size| size > 0);
    let side = side_design(&pairs) == SideDesign::Counterbalanced;
    let layout = Layout { link, items, sizes, middle, side };
    let mut all: BTreeMap<([usize; 2], i8), f64> = BTreeMap::new();
    people.values().flatten().for_each(|(&key, n)| *all.entry(key).or_default() += n);
    let likelihood = |of: &BTreeMap<([usize; 2], i8), f64>, at: &[f64]| {
        let mut sum = Curvature::zero(layout.size());
        of.iter().for_each(|(&(sides, step), &n)| layout.add(&mut sum, sides, step, n, at));
        sum
    };
    let start = layout.start();
    inverse(&likelihood(&all, &start).information).ok_or(FitError::NoMaximum)?;
    let maximum = maximise(start, |at| likelihood(&all, at)).ok_or(FitError::NoMaximum)?;
    let at = maximum.at;
    let worths = items - 1;
    let free = layout.free();
    let scores = people.values().map(|own| likelihood(own, &at).gradient);
    Ok(GradedFit {
        link,
        log_worths: std::iter::once(0.0).chain(at[..worths].iter().copied()).collect(),
        side: layout.side.then(|| at[worths + free.len()]),
        log_likelihood: likelihood(&all, &at).value,
        clustered: sandwich(&maximum.covariance, scores),
        covariance: maximum.covariance,
        participants: people.len() as u64,
        steps: free.into_iter().zip(at[worths..].iter().copied()).collect(),
    })
}

impl GradedFit {
    /// How much more an item is worth than another: t interval and p with participants as clusters. `None` with fewer than two of
    /// them, and where they tell no spread.
    ///
    /// # Panics
    /// If there is no such item.
    pub fn difference(&self, item: usize, other: usize) -> Option<Coefficient> {
        let of = Estimates {
            independent: &self.covariance,
            clustered: self.clustered.as_ref(),
            participants: self.participants,
        };
        of.difference(&self.log_worths, 0, item, other)
    }
}

#[cfg(test)]
mod tests;
