//! Maximum likelihood estimates of a model of paired comparison, with their covariance.

use super::model::{Layout, Model};
use super::newton::{Matrix, maximise};
use super::pairs::Pairs;
use super::separation::{Separation, separation};
use super::side::side_design;
use super::side_separation::side_separation;
use super::simulation::davidson;
use crate::interval::{Interval, LEVEL};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Why there is no estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// Nothing was answered or there are fewer than two items.
    #[error("not answerable here, because fewer than two items were compared")]
    Nothing,
    /// Not one scale.
    #[error("not answerable here, because some items were never compared, not even through others")]
    Disconnected,
    /// Nobody ever decided.
    #[error("not answerable here, because every answer was no preference")]
    OnlyTies,
    /// The design cannot tell sides from worths.
    #[error("{0}")]
    Side(&'static str),
    /// Covariates of which some are sums of others.
    #[error("not answerable here, because the covariates cannot be told apart")]
    Collinear,
    /// The likelihood keeps rising: covariates foretell the answers without exception.
    #[error("not answerable here, because the likelihood has no maximum")]
    NoMaximum,
    /// There is a maximum, and double precision does not suffice to find it: the pairs' numbers of answers are a factor of
    /// 10^10 or more apart.
    #[error("not computed, because the numbers of answers are too far apart for double precision")]
    Unsettled,
}

/// Why half a win each way was added to every compared pair: the answers allow no finite estimate without.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Penalty {
    /// Nothing was added.
    None,
    /// Some items never won against the others ([`Separation::Separated`](crate::Separation)).
    ItemsSeparated,
    /// The items have estimates, and a liking for a side has none, as where everybody takes the left
    /// ([`side_separation`](crate::side_separation)): see [`side_bound`](crate::side_bound), and the model without a side.
    SideSeparated,
}

/// Estimates of one model.
#[derive(Debug, Clone, PartialEq)]
pub struct WorthFit {
    /// Which model.
    pub model: Model,
    /// Natural logarithms of the worths; the first item's is 0.
    pub log_worths: Vec<f64>,
    /// ln nu of Davidson's models (symmetric form), minus infinity without a tie; `None` for the others.
    pub ln_nu: Option<f64>,
    /// ln theta of Rao and Kupper's, 0 without a tie; `None` for the others.
    pub ln_theta: Option<f64>,
    /// The left side's bonus in log-odds, if the model has one.
    pub side: Option<f64>,
    /// A bonus of the left side that was taken as known, in log-odds: 0 but for [`fit_given_side`].
    pub given_side: f64,
    /// Log-likelihood of the answers at the estimates, without multinomial constants. For Bradley-Terry a tie is half a
    /// win and half a loss, so that its value is comparable with that of no model that keeps ties.
    pub log_likelihood: f64,
    /// Whether half a win each way was added to every compared pair, and why.
    pub penalty: Penalty,
    /// Parameters in the order of `covariance`: worths of items 1.., then ln nu or ln theta if there was a tie, then side.
    pub parameters: Vec<f64>,
    /// Inverse of the exact information at the estimates: right if all answers are independent, which the answers of one
    /// participant are not. See [`clustered_covariance`](crate::clustered_covariance).
    pub covariance: Matrix,
}

/// Fits a model; separated answers, and only these, are fitted with [half a win each way](Pairs::with_half_wins), and say so.
///
/// Joint maximum likelihood by Newton's method with the exact second derivatives; estimates to about 1e-12.
///
/// # Errors
/// See [`FitError`].
pub fn fit(model: Model, pairs: &Pairs) -> Result<WorthFit, FitError> {
    fit_with(model, pairs, 0.0)
}

/// Fits Davidson's model, as [`fit`], if everybody likes the left side by so many log-odds (the right, below zero). What that
/// leaves of the worths does not depend on whether the design can tell sides from items.
///
/// # Errors
/// See [`FitError`].
pub fn fit_given_side(pairs: &Pairs, left: f64) -> Result<WorthFit, FitError> {
    fit_with(Model::Davidson, pairs, left)
}

fn fit_with(model: Model, pairs: &Pairs, given_side: f64) -> Result<WorthFit, FitError> {
    if pairs.items < 2 || pairs.answers() == 0.0 {
        return Err(FitError::Nothing);
    }
    let judged = separation(pairs);
    if judged == Separation::Disconnected {
        return Err(FitError::Disconnected);
    }
    if pairs.ties() == pairs.answers() {
        return Err(FitError::OnlyTies);
    }
    if let (Model::DavidsonSide, Some(objection)) = (model, side_design(pairs).objection()) {
        return Err(FitError::Side(objection));
    }
    let items_separated = match model {
        // Half a win each way on every tied pair is a win in both directions.
        Model::BradleyTerry => separation(&pairs.with_ties_split()) != Separation::None,
        _ => judged == Separation::Separated,
    };
    let penalty = match model {
        _ if items_separated => Penalty::ItemsSeparated,
        Model::DavidsonSide if side_separation(pairs).is_some() => Penalty::SideSeparated,
        _ => Penalty::None,
    };
    let fitted = match penalty {
        Penalty::None => estimate(Layout::of(model, pairs, given_side), pairs, pairs, penalty),
        _ => {
            let more = pairs.with_half_wins();
            estimate(Layout::of(model, &more, given_side), &more, pairs, penalty)
        }
    };
    fitted.ok_or(FitError::Unsettled)
}

fn estimate(layout: Layout, fitted: &Pairs, answered: &Pairs, penalty: Penalty) -> Option<WorthFit> {
    let model = layout.model;
    let maximum = maximise(layout.start(), |at| layout.likelihood(fitted, at))?;
    let at = maximum.at;
    let tie = layout.tie().map(|tie| at[tie]);
    let davidson = matches!(model, Model::Davidson | Model::DavidsonSide);
    Some(WorthFit {
        model,
        log_worths: std::iter::once(0.0).chain(at[..layout.items - 1].iter().copied()).collect(),
        ln_nu: davidson.then(|| tie.unwrap_or(f64::NEG_INFINITY)),
        ln_theta: (model == Model::RaoKupper).then(|| tie.unwrap_or(0.0)),
        side: layout.side().map(|side| at[side]),
        given_side: layout.given_side,
        log_likelihood: layout.likelihood(answered, &at).value,
        penalty,
        covariance: maximum.covariance,
        parameters: at,
    })
}

impl WorthFit {
    /// Whether half a win each way was added.
    pub fn penalised(&self) -> bool {
        self.penalty != Penalty::None
    }

    /// The chances of left, tie and right for items shown so; Bradley and Terry's model knows no ties.
    ///
    /// # Panics
    /// If there is no such item.
    pub fn chances(&self, left: usize, right: usize) -> [f64; 3] {
        let side = self.side.unwrap_or(0.0) + self.given_side;
        let ahead = self.log_worths[left] - self.log_worths[right] + side;
        match self.ln_theta {
            None => davidson(ahead, self.ln_nu.map_or(0.0, f64::exp)),
            Some(eta) => {
                let [wins, losses] = [ahead - eta, -ahead - eta].map(|z| 1.0 / (1.0 + (-z).exp()));
                // (e^{2 eta} - 1) F(u - eta) F(-u - eta), where 1 less both would cancel.
                [wins, (2.0 * eta).exp_m1() * wins * losses, losses]
            }
        }
    }

    /// Standard error of l_item - l_other under a covariance of the parameters.
    ///
    /// # Panics
    /// If there is no such item.
    pub fn standard_error(&self, covariance: &Matrix, item: usize, other: usize) -> f64 {
        assert!(item.max(other) < self.log_worths.len(), "no item {}", item.max(other));
        // Of the parameters, two at most have a part in it: the first item's worth is no parameter.
        let mut parts = [(item, 1.0), (other, -1.0)];
        parts.sort_by_key(|(item, _)| *item);
        let parts = || parts.iter().filter(|(item, _)| *item > 0).map(|&(item, sign)| (item - 1, sign));
        let of_row = |row: usize| parts().map(|(column, sign)| covariance[row][column] * sign).sum::<f64>();
        if item == other {
            return 0.0;
        }
        parts().map(|(row, sign)| sign * of_row(row)).sum::<f64>().max(0.0).sqrt()
    }

    /// t interval at [`LEVEL`] for l_item - l_other with the sandwich of so many participants, on m - 1 degrees of freedom.
    ///
    /// # Panics
    /// If there is no such item, or with fewer than two participants.
    pub fn clustered_interval(
        &self,
        sandwich: &Matrix,
        participants: u64,
        item: usize,
        other: usize,
    ) -> Interval {
        let middle = self.log_worths[item] - self.log_worths[other];
        let t = StudentsT::new(0.0, 1.0, participants as f64 - 1.0).expect("two participants or more");
        let half = t.inverse_cdf(0.5 + LEVEL / 2.0) * self.standard_error(sandwich, item, other);
        Interval { low: middle - half, high: middle + half }
    }

    /// Clustered standard error of an item's log worth (the first's is 0 by definition), and its t interval. `None` where
    /// every participant's gradient is zero, as for a worth that one tie decides: that is no spread to judge an error by.
    ///
    /// # Panics
    /// If there is no such item, or with fewer than two participants.
    pub fn clustered_error(
        &self,
        sandwich: &Matrix,
        participants: u64,
        item: usize,
    ) -> Option<(f64, Interval)> {
        let [clustered, independent] =
            [sandwich, &self.covariance].map(|of| self.standard_error(of, item, 0));
        let known = has_spread(clustered, independent);
        known.then(|| (clustered, self.clustered_interval(sandwich, participants, item, 0)))
    }
}

/// Whether a clustered standard error is more than the rounding of zero, beside the one that takes answers as independent.
pub fn has_spread(clustered: f64, independent: f64) -> bool {
    clustered > 1e-6 * independent
}

#[cfg(test)]
pub(crate) mod large;
#[cfg(test)]
mod tests;
