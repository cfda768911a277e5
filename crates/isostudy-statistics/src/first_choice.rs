//! Which of several things people take: the model of Luce, Plackett and McFadden.
//!
//! Of the things shown, S, one is taken with chance e^{l_i} / sum over S of e^{l_j} (Luce 1959, *Individual Choice Behavior*; the first
//! choice of Plackett 1975, Appl. Statist. 24:193; the conditional logit of McFadden 1974). Of two things it is Bradley and Terry's
//! model, so a worth is on its scale.

use super::clustered::{Coefficient, Estimates, sandwich};
use super::fit::FitError;
use super::newton::{Curvature, Matrix, maximise};
use super::pairs::Pairs;
use super::separation::{Separation, separation};
use std::collections::BTreeMap;

/// One choice of one participant.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Choice {
    /// The participant, from 0.
    pub participant: usize,
    /// The different items that were shown, two or more.
    pub shown: Vec<usize>,
    /// The one that was taken, among those.
    pub taken: usize,
}

/// Estimates of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstChoice {
    /// Log worths; the first item's is 0.
    pub log_worths: Vec<f64>,
    /// Log-likelihood of the choices.
    pub log_likelihood: f64,
    /// Inverse of the information, of the worths of items 1...
    pub covariance: Matrix,
    /// Sandwich covariance with participants as clusters; `None` with fewer than two of them.
    pub clustered: Option<Matrix>,
    /// How many participants chose.
    pub participants: u64,
}

/// Adds so many of the same choices.
fn add(sum: &mut Curvature, shown: &[usize], taken: usize, times: f64, at: &[f64]) {
    let worth = |item: usize| if item == 0 { 0.0 } else { at[item - 1] };
    let highest = shown.iter().map(|&item| worth(item)).fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = shown.iter().map(|&item| (worth(item) - highest).exp()).sum();
    let chance = |item: usize| (worth(item) - highest).exp() / total;
    sum.value += times * (worth(taken) - highest - total.ln());
    for &item in shown.iter().filter(|&&item| item > 0) {
        let own = chance(item);
        sum.gradient[item - 1] += times * (f64::from(u8::from(item == taken)) - own);
        sum.information[item - 1][item - 1] += times * own;
        for &other in shown.iter().filter(|&&other| other > 0) {
            sum.information[item - 1][other - 1] -= times * own * chance(other);
        }
    }
}

/// Fits the model to the choices of everybody.
///
/// Maximum likelihood by Newton's method; estimates to about 1e-9, whatever the order of choices and of what was shown. Places on the
/// screen are not in the model: shuffle them.
///
/// # Errors
/// [`FitError::Nothing`] without a choice or with fewer than two items, [`FitError::Disconnected`] where items were never shown
/// together, not even through others, and [`FitError::NoMaximum`] where some were never taken before the others.
///
/// # Panics
/// If an item is not below `items` or shown twice at once, fewer than two are shown, or the one taken was not shown.
pub fn first_choice(items: usize, choices: &[Choice]) -> Result<FirstChoice, FitError> {
    if items < 2 || choices.is_empty() {
        return Err(FitError::Nothing);
    }
    let mut people: BTreeMap<usize, BTreeMap<(Vec<usize>, usize), f64>> = BTreeMap::new();
    let mut beats = Vec::new();
    for choice in choices {
        let mut shown = choice.shown.clone();
        shown.sort_unstable();
        assert!(shown.len() > 1 && shown.is_sorted_by(|a, b| a < b), "{choice:?}");
        assert!(shown.iter().all(|&item| item < items) && shown.contains(&choice.taken), "{choice:?}");
        let others = shown.iter().filter(|&&other| other != choice.taken);
        beats.extend(others.map(|&other| (choice.taken, other, [1.0, 0.0, 0.0])));
        *people.entry(choice.participant).or_default().entry((shown, choice.taken)).or_default() += 1.0;
    }
    // Ford's condition: whatever is taken beats all that stands beside it.
    match separation(&Pairs::new(items, beats)) {
        Separation::None => {}
        Separation::Disconnected => return Err(FitError::Disconnected),
        _ => return Err(FitError::NoMaximum),
    }
    let mut all: BTreeMap<(Vec<usize>, usize), f64> = BTreeMap::new();
    for (key, times) in people.values().flatten() {
        *all.entry(key.clone()).or_default() += times;
    }
    let likelihood = |of: &BTreeMap<(Vec<usize>, usize), f64>, at: &[f64]| {
        let mut sum = Curvature::zero(items - 1);
        of.iter().for_each(|((shown, taken), &times)| add(&mut sum, shown, *taken, times, at));
        sum
    };
    let maximum = maximise(vec![0.0; items - 1], |at| likelihood(&all, at)).ok_or(FitError::NoMaximum)?;
    let at = maximum.at;
    let scores = people.values().map(|own| likelihood(own, &at).gradient);
    Ok(FirstChoice {
        log_worths: std::iter::once(0.0).chain(at.iter().copied()).collect(),
        log_likelihood: likelihood(&all, &at).value,
        clustered: sandwich(&maximum.covariance, scores),
        covariance: maximum.covariance,
        participants: people.len() as u64,
    })
}

impl FirstChoice {
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
