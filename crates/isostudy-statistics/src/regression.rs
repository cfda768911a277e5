//! Davidson's model with covariates in place of items: what about two things makes people choose one of them?
//!
//! With x the difference of the covariates, first minus second, and u = beta'x, the outcomes have the weights
//! e^{u/2} : nu : e^{-u/2}: among decided answers a logistic model without intercept, ties between (Davidson 1970 with
//! l_left - l_right = beta'x; the adjacent-category logits of left, tie, right are u/2 -+ ln nu). Exchanging the sides
//! of a question changes nothing. Without a tie among the answers it is the logistic model alone.

use super::ballot::{Answer, ShownBallot};
use super::clustered::{Coefficient, sandwich};
use super::fit::FitError;
use super::model::add_log_linear;
use super::newton::{Curvature, Matrix, inverse, maximise};
use crate::interval::{Interval, LEVEL};
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::collections::BTreeMap;

/// Estimates of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct Regression {
    /// beta: log-odds of left over right for one unit of each covariate.
    pub coefficients: Vec<f64>,
    /// ln nu, or `None` without a tie.
    pub ln_nu: Option<f64>,
    /// Log-likelihood of the answers.
    pub log_likelihood: f64,
    /// Inverse of the information: right if all answers were independent.
    pub covariance: Matrix,
    /// Sandwich covariance with participants as clusters, m/(m-1) H^-1 (sum of s s') H^-1 (Liang and Zeger 1986); of
    /// fewer than two participants, `None`.
    pub clustered: Option<Matrix>,
    /// How many participants answered.
    pub participants: usize,
}

/// Fits the model by maximum likelihood. `covariates[question]` is x, or `None` for a question to leave out: the advantage
/// of the first item where answers are about items ([`DeclaredBallot`](super::DeclaredBallot)), of the left side where they
/// are about sides ([`ShownBallot`](super::ShownBallot)).
///
/// # Errors
/// [`FitError::Nothing`] without an answer or a covariate, [`FitError::OnlyTies`], [`FitError::Collinear`] if covariates are,
/// and [`FitError::NoMaximum`] if they separate the answers.
pub fn regression<A: Answer>(covariates: &[Option<Vec<f64>>], ballots: &[A]) -> Result<Regression, FitError> {
    fit_with(covariates, ballots, 0.0)
}

/// As [`regression`] of the left side's advantages, if everybody likes the left side by so many log-odds (the right, below
/// zero).
///
/// # Errors
/// As [`regression`].
pub fn regression_given_side(
    covariates: &[Option<Vec<f64>>],
    ballots: &[ShownBallot],
    left: f64,
) -> Result<Regression, FitError> {
    fit_with(covariates, ballots, left)
}

fn fit_with<A: Answer>(
    covariates: &[Option<Vec<f64>>],
    ballots: &[A],
    given_side: f64,
) -> Result<Regression, FitError> {
    let of = |ballot: &&A| covariates.get(ballot.question()).is_some_and(Option::is_some);
    let used: Vec<&A> = ballots.iter().filter(of).collect();
    let width = covariates.iter().flatten().map(Vec::len).next().unwrap_or(0);
    if used.is_empty() || width == 0 {
        return Err(FitError::Nothing);
    }
    let mut answers = vec![[0.0; 3]; covariates.len()];
    used.iter().for_each(|ballot| answers[ballot.question()][ballot.place()] += 1.0);
    let ties: f64 = answers.iter().map(|answers| answers[1]).sum();
    if ties == used.len() as f64 {
        return Err(FitError::OnlyTies);
    }
    let tie = (ties > 0.0).then_some(width);
    let size = width + usize::from(tie.is_some());
    // In units of their own size, so that neither metres nor millimetres look like steps to infinity. Powers of two cost
    // no digits.
    let units = units(covariates.iter().flatten(), width);
    let padded = |x: &Vec<f64>| {
        let scaled = x.iter().zip(&units).map(|(x, unit)| x / unit);
        scaled.chain(std::iter::repeat_n(0.0, size - width)).collect()
    };
    let rows: Vec<Option<Vec<f64>>> = covariates.iter().map(|x| x.as_ref().map(padded)).collect();
    let likelihood = |at: &[f64]| {
        let mut sum = Curvature::zero(size);
        for (x, answers) in rows.iter().zip(&answers) {
            if let Some(x) = x {
                add_log_linear(&mut sum, x, given_side, tie, *answers, at);
            }
        }
        sum
    };
    inverse(&likelihood(&vec![0.0; size]).information).ok_or(FitError::Collinear)?;
    let maximum = maximise(vec![0.0; size], likelihood).ok_or(FitError::NoMaximum)?;
    let at = maximum.at;
    // The gradient of one answer depends on question and outcome alone.
    let score = |question: usize, outcome: usize| {
        let mut one = Curvature::zero(size);
        let mut answer = [0.0; 3];
        answer[outcome] = 1.0;
        if let Some(x) = &rows[question] {
            add_log_linear(&mut one, x, given_side, tie, answer, &at);
        }
        one.gradient
    };
    let scores: Vec<[Vec<f64>; 3]> = (0..rows.len()).map(|q| [0, 1, 2].map(|o| score(q, o))).collect();
    let mut sums: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for ballot in &used {
        let sum = sums.entry(ballot.participant()).or_insert_with(|| vec![0.0; size]);
        let own = &scores[ballot.question()][ballot.place()];
        sum.iter_mut().zip(own).for_each(|(sum, score)| *sum += score);
    }
    let bread = inverse(&likelihood(&at).information).ok_or(FitError::NoMaximum)?;
    let unit = |i: usize| units.get(i).copied().unwrap_or(1.0);
    let in_own_units = |mut matrix: Matrix| {
        for (i, row) in matrix.iter_mut().enumerate() {
            row.iter_mut().enumerate().for_each(|(j, cell)| *cell /= unit(i) * unit(j));
        }
        matrix
    };
    Ok(Regression {
        coefficients: (0..width).map(|i| at[i] / unit(i)).collect(),
        ln_nu: tie.map(|tie| at[tie]),
        log_likelihood: likelihood(&at).value,
        covariance: in_own_units(maximum.covariance),
        participants: sums.len(),
        clustered: sandwich(&bread, sums.into_values()).map(in_own_units),
    })
}

/// The power of two next above each covariate's largest value; 1 of nothing but zeros.
fn units<'a>(covariates: impl Iterator<Item = &'a Vec<f64>>, width: usize) -> Vec<f64> {
    let mut largest = vec![0.0_f64; width];
    covariates.for_each(|x| largest.iter_mut().zip(x).for_each(|(most, x)| *most = most.max(x.abs())));
    largest.into_iter().map(|most| if most > 0.0 { most.log2().ceil().exp2() } else { 1.0 }).collect()
}

impl Regression {
    /// A coefficient with interval and p clustered on participants; `None` with fewer than two of them, or if their
    /// scores do not vary.
    ///
    /// # Panics
    /// If there is no such covariate.
    pub fn coefficient(&self, covariate: usize) -> Option<Coefficient> {
        let estimate = self.coefficients[covariate];
        let se = self.clustered.as_ref()?[covariate][covariate].sqrt();
        let t = StudentsT::new(0.0, 1.0, self.participants as f64 - 1.0).ok()?;
        let half = t.inverse_cdf(0.5 + LEVEL / 2.0) * se;
        let interval = Interval { low: estimate - half, high: estimate + half };
        (se > 0.0).then(|| Coefficient { estimate, se, interval, p: 2.0 * t.cdf(-(estimate / se).abs()) })
    }

    /// The log-odds of left over right.
    pub fn log_odds(&self, x: &[f64]) -> f64 {
        self.coefficients.iter().zip(x).map(|(b, x)| b * x).sum()
    }

    /// The chances of left, tie and right.
    pub fn chances(&self, x: &[f64]) -> [f64; 3] {
        let half = 0.5 * self.log_odds(x);
        let weights = [half.exp(), self.ln_nu.map_or(0.0, f64::exp), (-half).exp()];
        let sum: f64 = weights.iter().sum();
        weights.map(|weight| weight / sum)
    }
}

#[cfg(test)]
mod tests;
