//! All items on one scale: worths, every difference of two with its interval and test, and one test of all.

use super::fit::{FitError, WorthFit, fit, has_spread};
use super::model::Model;
use super::multiplicity::holm;
use super::newton::{Matrix, inverse, quadratic};
use super::pairs::Pairs;
use super::participants::Participants;
use super::sandwich::clustered_covariance;
use super::side::{SideDesign, side_design};
use crate::interval::{Interval, t_half_width};
use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};

/// Items that were compared, directly or through others, on one scale: see [`fit_on_one_scale`].
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// The model.
    pub fit: WorthFit,
    /// How many participants answered.
    pub participants: u64,
    /// The item that is at zero.
    pub reference: usize,
    /// Every item less the reference, in the order of items; the reference itself is 0 without an interval.
    pub positions: Vec<Difference>,
    /// Every two items, the lower number first: (0, 1), (0, 2), ..
    pub differences: Vec<Difference>,
    /// Whether there is any difference at all.
    pub omnibus: Result<Omnibus, NoOmnibus>,
}

/// How much more an item is worth than another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// The item.
    pub first: usize,
    /// What it is compared with.
    pub second: usize,
    /// Difference of log worths: log-odds of the first over the second among decided answers.
    pub log_odds: f64,
    /// What is known of it. `None` for a penalised fit, fewer than two participants, and where no two participants tell
    /// anything different.
    pub spread: Option<Spread>,
}

/// How sure a difference is: participants as clusters, t on m - 1 degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Standard error of the log-odds.
    pub se: f64,
    /// t interval of the log-odds at [`LEVEL`](crate::interval::LEVEL), for this difference alone.
    pub interval: Interval,
    /// Two-sided p of no difference.
    pub p: f64,
    /// That p after Holm's adjustment over all differences of two items of the scale.
    pub adjusted: f64,
}

impl Difference {
    /// In just-objectionable differences; see [`jod`].
    pub fn jod(&self) -> f64 {
        jod(self.log_odds)
    }

    /// The chance that the first is preferred; see [`preferred`].
    pub fn preferred(&self) -> f64 {
        preferred(self.log_odds)
    }
}

/// Log-odds as just-objectionable differences: 1 where three in four decided answers prefer the better (Perez-Ortiz and
/// Mantiuk 2017, arXiv:1712.03686; pwcmp). They take a normal distribution of judgements, the models here a
/// logistic one, so that the two scales agree at 0 and at 1 and bend apart beyond. Ends of intervals go the same way.
pub fn jod(log_odds: f64) -> f64 {
    log_odds / 3.0_f64.ln()
}

/// Log-odds as the chance of being preferred in a decided answer. Ends of intervals go the same way.
pub fn preferred(log_odds: f64) -> f64 {
    1.0 / (1.0 + (-log_odds).exp())
}

/// The test that all items are worth the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Omnibus {
    /// F = W (m - k + 1) / ((k - 1)(m - 1)), W = l' V^-1 l of the k - 1 free log worths and their clustered covariance.
    pub f: f64,
    /// k - 1 and m - k + 1.
    pub degrees: [u64; 2],
    /// P(F >= f).
    pub p: f64,
}

/// Why there is no omnibus test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoOmnibus {
    /// As many items as participants, or more.
    #[error("not answerable here, because {participants} participants are fewer than the {items} items need")]
    Participants {
        /// How many answered.
        participants: u64,
        /// How many items they compared.
        items: usize,
    },
    /// Some items never won against the others.
    #[error("not answerable here, because some items never won against the others")]
    Separated,
    /// Participants' answers do not vary in every direction.
    #[error("not answerable here, because participants do not differ in all that is compared")]
    NoSpread,
}

/// Davidson's model, and where pairs were shown in both orders, the same with a bonus for a side (Davidson and Beaver
/// 1977): a liking for a side that is left out makes every worth too small (at 2.5 log-odds, a difference of 1 came
/// out as 0.3). Without the bonus, too, where the answers put no bound on it or need a penalty.
///
/// # Errors
/// As [`fit`].
pub fn fit_on_one_scale(pairs: &Pairs) -> Result<WorthFit, FitError> {
    let counterbalanced = side_design(pairs) == SideDesign::Counterbalanced;
    let with_side = counterbalanced.then(|| fit(Model::DavidsonSide, pairs).ok()).flatten();
    match with_side.filter(|fit| !fit.penalised()) {
        Some(with_side) => Ok(with_side),
        None => fit(Model::Davidson, pairs),
    }
}

/// Puts all items of `participants` on one scale, `reference` at zero.
///
/// [`fit_on_one_scale`]; covariance by [`clustered_covariance`], so that each participant's answers may hang together.
/// Intervals and tests do not depend on the reference, nor on the order of items. The omnibus test is Hotelling's (1931,
/// Ann. Math. Statist. 2:360; Anderson 2003, section 5.2) on participants' contributions: with a chi-square in place of F
/// it would reject far too often with a dozen participants.
///
/// # Errors
/// As [`fit`]: [`FitError::Disconnected`] where there is no one scale.
///
/// # Panics
/// If there is no such item as the reference.
pub fn scale(participants: &Participants, reference: usize) -> Result<Scale, FitError> {
    let items = participants.items();
    assert!(reference < items.max(1), "no item {reference}");
    let fit = fit_on_one_scale(&participants.sum(&participants.counts))?;
    let clustered = clustered_covariance(&fit, participants);
    let m = participants.number();
    let mut differences: Vec<Difference> = (0..items)
        .flat_map(|first| (first + 1..items).map(move |second| (first, second)))
        .map(|(first, second)| difference(&fit, clustered.as_ref(), m, first, second))
        .collect();
    let p: Vec<f64> = differences.iter().map(|of| of.spread.map_or(1.0, |spread| spread.p)).collect();
    for (of, adjusted) in differences.iter_mut().zip(holm(&p)) {
        of.spread = of.spread.map(|spread| Spread { adjusted, ..spread });
    }
    let positions = (0..items).map(|item| position(&differences, item, reference)).collect();
    let omnibus = omnibus(&fit, clustered.as_ref(), m);
    Ok(Scale { fit, participants: m, reference, positions, differences, omnibus })
}

fn difference(fit: &WorthFit, clustered: Option<&Matrix>, m: u64, first: usize, second: usize) -> Difference {
    let log_odds = fit.log_worths[first] - fit.log_worths[second];
    let independent = fit.standard_error(&fit.covariance, first, second);
    let error = clustered.map(|clustered| fit.standard_error(clustered, first, second));
    let spread = error.filter(|&se| has_spread(se, independent)).and_then(|se| {
        let t = StudentsT::new(0.0, 1.0, m as f64 - 1.0).expect("two participants or more");
        let half = t_half_width(m as f64 - 1.0)? * se;
        let interval = Interval { low: log_odds - half, high: log_odds + half };
        let p = 2.0 * t.cdf(-(log_odds / se).abs());
        Some(Spread { se, interval, p, adjusted: p })
    });
    Difference { first, second, log_odds, spread }
}

/// An item less the reference, out of the differences of the lower and the higher number.
fn position(differences: &[Difference], item: usize, reference: usize) -> Difference {
    let of = differences.iter().find(|d| (d.first, d.second) == (item.min(reference), item.max(reference)));
    match of {
        None => Difference { first: item, second: reference, log_odds: 0.0, spread: None },
        Some(of) if of.first == item => *of,
        Some(of) => {
            let turned = |Interval { low, high }| Interval { low: -high, high: -low };
            let spread = of.spread.map(|spread| Spread { interval: turned(spread.interval), ..spread });
            Difference { first: item, second: reference, log_odds: -of.log_odds, spread }
        }
    }
}

fn omnibus(fit: &WorthFit, clustered: Option<&Matrix>, m: u64) -> Result<Omnibus, NoOmnibus> {
    let items = fit.log_worths.len();
    if fit.penalised() {
        return Err(NoOmnibus::Separated);
    }
    let (free, rest) = (items as u64 - 1, (m + 1).saturating_sub(items as u64));
    let clustered =
        clustered.filter(|_| rest > 0).ok_or(NoOmnibus::Participants { participants: m, items })?;
    let worths = &fit.log_worths[1..];
    let of_worths: Matrix = clustered[..items - 1].iter().map(|row| row[..items - 1].to_vec()).collect();
    let varies = |item| {
        has_spread(fit.standard_error(clustered, item, 0), fit.standard_error(&fit.covariance, item, 0))
    };
    let varied = (1..items).all(varies);
    let precision = inverse(&of_worths).filter(|_| varied).ok_or(NoOmnibus::NoSpread)?;
    let wald = quadratic(worths, &precision, worths);
    let f = wald * rest as f64 / (free as f64 * (m as f64 - 1.0));
    let of_f = FisherSnedecor::new(free as f64, rest as f64).expect("degrees above zero");
    Ok(Omnibus { f, degrees: [free, rest], p: of_f.sf(f) })
}

#[cfg(test)]
mod tests;
