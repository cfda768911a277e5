//! Ratings on a scale, such as 1 to 7: a linear mixed model in which each person has a level of their own.
//!
//! A rating is mu of the item + a of the person + e, a and e normal with variances s_a^2 and s_e^2, estimated by restricted
//! likelihood (Patterson and Thompson 1971, Biometrika 58:545). It takes the steps of the scale as equally wide. Where they are not, and
//! where people spread their ratings unlike, take the sign-flip test of
//! [`ScoreTest::of_rating_difference`](crate::ScoreTest::of_rating_difference).

use super::clustered::{Coefficient, Estimates, sandwich};
use super::fit::FitError;
use super::newton::{Matrix, inverse, ln_determinant, times};
use std::collections::BTreeMap;

/// One rating by one participant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rating {
    /// The participant, from 0.
    pub participant: usize,
    /// The item, from 0.
    pub item: usize,
    /// The rating; finite.
    pub value: f64,
}

/// Estimates of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct RatingFit {
    /// Mean rating of each item, as of a person in the middle.
    pub means: Vec<f64>,
    /// Standard deviation between people's levels; 0 if none is seen.
    pub person_sd: f64,
    /// Standard deviation of one rating around the mean of its item and its person's level.
    pub rest_sd: f64,
    /// Restricted log-likelihood.
    pub log_likelihood: f64,
    /// Covariance of the means as the model has it.
    pub covariance: Matrix,
    /// Sandwich covariance with participants as clusters: right also where people differ in more than a level.
    pub clustered: Option<Matrix>,
    /// How many participants rated.
    pub participants: u64,
}

/// Square root of the largest ratio of the variances that is tried.
const LARGEST: f64 = 1e3;
/// How closely the square root of the ratio is found, beside 1 and itself.
const CLOSE: f64 = 1e-8;

/// The estimates at one ratio of the variances, s_a^2 / s_e^2.
struct At {
    means: Vec<f64>,
    /// Inverse of X' V^-1 X, in units of s_e^2.
    covariance: Matrix,
    variance: f64,
    value: f64,
}

/// Ratings of one person.
type Own = Vec<(usize, f64)>;

/// X' V^-1 y of one person, V^-1 = 1 - ratio / (1 + n ratio) 11'.
fn weighted(own: &[(usize, f64)], items: usize, ratio: f64, of: impl Fn(&(usize, f64)) -> f64) -> Vec<f64> {
    let pull = ratio / (1.0 + own.len() as f64 * ratio) * own.iter().map(&of).sum::<f64>();
    let mut sum = vec![0.0; items];
    own.iter().for_each(|rating| sum[rating.0] += of(rating) - pull);
    sum
}

fn at(people: &BTreeMap<usize, Own>, items: usize, ratio: f64) -> Option<At> {
    let mut information = vec![vec![0.0; items]; items];
    let mut right = vec![0.0; items];
    let (mut log, mut number) = (0.0, 0.0);
    for own in people.values() {
        let n = own.len() as f64;
        (number, log) = (number + n, log + (n * ratio).ln_1p());
        let mut counts = vec![0.0; items];
        own.iter().for_each(|(item, _)| counts[*item] += 1.0);
        let pull = ratio / (1.0 + n * ratio);
        for i in (0..items).filter(|&i| counts[i] > 0.0) {
            information[i][i] += counts[i];
            (0..items).for_each(|j| information[i][j] -= pull * counts[i] * counts[j]);
        }
        right.iter_mut().zip(weighted(own, items, ratio, |of| of.1)).for_each(|(sum, x)| *sum += x);
    }
    let covariance = inverse(&information)?;
    let means = times(&covariance, &right);
    let rest = |own: &Own| -> f64 {
        let off = |of: &(usize, f64)| of.1 - means[of.0];
        let sum: f64 = own.iter().map(off).sum();
        let squares: f64 = own.iter().map(|of| off(of).powi(2)).sum();
        squares - ratio / (1.0 + own.len() as f64 * ratio) * sum * sum
    };
    let degrees = number - items as f64;
    let variance = people.values().map(rest).sum::<f64>() / degrees;
    let constant = degrees * (1.0 + (std::f64::consts::TAU * variance).ln());
    let value = -0.5 * (constant + log + ln_determinant(&information)?);
    Some(At { means, covariance, variance, value })
}

/// Fits the model.
///
/// Whatever the order of ratings. Standard deviations are right to six digits.
///
/// # Errors
/// [`FitError::Nothing`] with fewer than two items or people or as few ratings as items, [`FitError::Disconnected`] where nobody
/// rated some item, and [`FitError::NoMaximum`] where nothing varies beside items and people.
///
/// # Panics
/// If an item is not below `items`, or a rating is not finite.
pub fn ratings(items: usize, ratings: &[Rating]) -> Result<RatingFit, FitError> {
    let mut people: BTreeMap<usize, Own> = BTreeMap::new();
    let mut rated = vec![false; items];
    for &Rating { participant, item, value } in ratings {
        assert!(item < items && value.is_finite(), "item {item} of {items}: {value}");
        people.entry(participant).or_default().push((item, value));
        rated[item] = true;
    }
    if items < 2 || people.len() < 2 || ratings.len() <= items {
        return Err(FitError::Nothing);
    }
    if rated.contains(&false) {
        return Err(FitError::Disconnected);
    }
    people.values_mut().for_each(|own| own.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))));
    // By the square root of the ratio, in which the likelihood is close to quadratic also near 0.
    let value = |root: f64| {
        let of = at(&people, items, root * root).filter(|of| of.variance > 0.0);
        of.map_or(f64::NEG_INFINITY, |of| of.value)
    };
    let grid: Vec<f64> =
        std::iter::once(0.0).chain((0..=60).map(|i| 1e-3 * LARGEST.powf(f64::from(i) / 30.0))).collect();
    let tops: Vec<f64> = grid.iter().map(|&root| value(root)).collect();
    let best = (0..grid.len()).fold(0, |best, i| if tops[i] > tops[best] { i } else { best });
    if best + 1 == grid.len() || tops[best] == f64::NEG_INFINITY {
        return Err(FitError::NoMaximum);
    }
    let root = top(value, grid[best.saturating_sub(1)], grid[best + 1]);
    let root = if value(root) > tops[0] { root } else { 0.0 };
    let ratio = root * root;
    let found = at(&people, items, ratio).filter(|of| of.variance > 0.0).ok_or(FitError::NoMaximum)?;
    let scores = people.values().map(|own| weighted(own, items, ratio, |of| of.1 - found.means[of.0]));
    let clustered = sandwich(&found.covariance, scores);
    let scaled = |row: &Vec<f64>| row.iter().map(|x| x * found.variance).collect();
    Ok(RatingFit {
        covariance: found.covariance.iter().map(scaled).collect(),
        clustered,
        person_sd: root * found.variance.sqrt(),
        rest_sd: found.variance.sqrt(),
        log_likelihood: found.value,
        participants: people.len() as u64,
        means: found.means,
    })
}

/// Where a function with one top between two ends is highest, by golden sections.
fn top(of: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_a, mut at_b) = (of(a), of(b));
    while high - low > CLOSE * (1.0 + high) {
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
    0.5 * (low + high)
}

impl RatingFit {
    /// How much higher an item is rated than another, in steps of the scale: t interval and p with participants as clusters. `None`
    /// where they tell no spread.
    ///
    /// # Panics
    /// If there is no such item.
    pub fn difference(&self, item: usize, other: usize) -> Option<Coefficient> {
        let of = Estimates {
            independent: &self.covariance,
            clustered: self.clustered.as_ref(),
            participants: self.participants,
        };
        of.combined(self.means[item] - self.means[other], &[(item, 1.0), (other, -1.0)])
    }
}

#[cfg(test)]
mod tests;
