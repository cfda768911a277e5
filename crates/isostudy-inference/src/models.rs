//! Models of preference: worths with their errors, and what each model says about ties and sides.

use crate::ballots::BallotGroup;
use isostudy_statistics::interval::Interval;
use isostudy_statistics::{
    FitError, Model, Pairs, Participants, Penalty, Separation, SideDesign, WorthFit, clustered_covariance,
    fit, separation, side_design,
};
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// One model of one group.
pub struct GroupModel<'a> {
    /// The group.
    pub group: &'a BallotGroup,
    /// The model.
    pub model: Model,
    /// What it was fitted to, or why it could not be.
    pub fitted: Result<WorthFit, FitError>,
    /// How many answers there are.
    pub answers: f64,
    /// The bonus of the left side in log-odds, and its standard error; none without a bound.
    pub side: [Option<f64>; 2],
    /// p of the side by likelihood ratio, as if all answers were independent.
    pub side_p: Option<f64>,
    /// Whether ties alone keep the estimates finite.
    pub held_by_ties: bool,
    /// Whether side is told from worth only if worths are additive.
    pub through_additivity: bool,
    /// By item; empty where the model could not be fitted.
    pub worths: Vec<Worth>,
}

/// An item's worth by one model.
#[derive(Debug, Clone, Copy)]
pub struct Worth {
    /// Log-odds of being preferred to the group's first item.
    pub log_worth: f64,
    /// Standard error, answers independent.
    pub independent_error: f64,
    /// Standard error with participants as clusters; 0 of the first item.
    pub clustered_error: Option<f64>,
    /// The t interval of that.
    pub interval: Option<Interval>,
}

/// Every model of every group. Without `sides_recorded` nobody knows what stood on which side, and there is no model with a side.
pub fn of_groups(groups: &[BallotGroup], sides_recorded: bool) -> Vec<GroupModel<'_>> {
    let mut found = Vec::new();
    for group in groups {
        let pairs = Pairs::of(group.items.len(), &group.ballots);
        let participants = Participants::of(group.items.len(), &group.ballots);
        let plain = fit(Model::Davidson, &pairs);
        let models =
            Model::ALL.into_par_iter().filter(|&model| sides_recorded || model != Model::DavidsonSide);
        let fitted = models.map(|model| GroupModel::of(group, &pairs, &participants, model, &plain));
        found.par_extend(fitted);
    }
    found
}

impl<'a> GroupModel<'a> {
    /// `plain` is Davidson's model on the same answers.
    fn of(
        group: &'a BallotGroup,
        pairs: &Pairs,
        participants: &Participants,
        model: Model,
        plain: &Result<WorthFit, FitError>,
    ) -> Self {
        let fitted = if model == Model::Davidson { plain.clone() } else { fit(model, pairs) };
        let plain = plain.as_ref().ok();
        let of = fitted.as_ref().ok();
        // Without a bound there is nothing to estimate, whatever half a win makes of it.
        let side = of.filter(|fit| fit.penalty != Penalty::SideSeparated);
        let side_index = |fit: &WorthFit| fit.side.map(|_| fit.parameters.len() - 1);
        let side_error = side.and_then(|fit| side_index(fit).map(|i| fit.covariance[i][i].sqrt()));
        let ratio = match (of, plain) {
            (Some(fit), Some(plain)) if fit.side.is_some() && !fit.penalised() && !plain.penalised() => {
                Some(2.0 * (fit.log_likelihood - plain.log_likelihood).max(0.0))
            }
            _ => None,
        };
        let one = ChiSquared::new(1.0).expect("one degree of freedom");
        let is_plain = of.is_some_and(|fit| fit.penalty == Penalty::None);
        Self {
            group,
            model,
            answers: pairs.answers(),
            side: [side.and_then(|fit| fit.side), side_error],
            side_p: ratio.map(|ratio| one.sf(ratio)),
            held_by_ties: is_plain && separation(pairs) == Separation::HeldByTies,
            through_additivity: model == Model::DavidsonSide
                && side_design(pairs) == SideDesign::ThroughAdditivity,
            worths: of.map(|fit| worths(fit, participants)).unwrap_or_default(),
            fitted,
        }
    }
}

fn worths(fitted: &WorthFit, participants: &Participants) -> Vec<Worth> {
    let clustered = clustered_covariance(fitted, participants);
    let of_item = |item: usize| {
        let sandwich = clustered.as_ref().filter(|_| item > 0);
        let found = sandwich.and_then(|s| fitted.clustered_error(s, participants.number(), item));
        let error = if item > 0 { found.map(|(error, _)| error) } else { Some(0.0) };
        Worth {
            log_worth: fitted.log_worths[item],
            independent_error: fitted.standard_error(&fitted.covariance, item, 0),
            clustered_error: clustered.as_ref().and(error),
            interval: found.map(|(_, interval)| interval),
        }
    };
    (0..fitted.log_worths.len()).map(of_item).collect()
}
