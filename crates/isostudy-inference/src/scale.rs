//! All items of a group on one scale.

use crate::ballots::BallotGroup;
use isostudy_statistics::{
    Closeness, FitError, Goodness, Model, Pairs, Participants, Scale, WorthFit, closeness, fit, goodness,
    holm, scale,
};
use rayon::prelude::*;

/// A group's items on one scale, its first item at zero; what cannot be placed has the reason.
pub struct GroupScale<'a> {
    /// The group.
    pub group: &'a BallotGroup,
    /// Positions and differences, or why there are none.
    pub scale: Result<Scale, FitError>,
    /// Davidson's model and Rao and Kupper's, as far as they can be judged by the answers.
    pub fits: Vec<GroupFit>,
    /// p of the omnibus test by Holm over the groups that have one.
    pub omnibus_adjusted: Option<f64>,
}

/// The scale of every group.
pub fn scales(groups: &[BallotGroup]) -> Vec<GroupScale<'_>> {
    fn of(group: &BallotGroup) -> GroupScale<'_> {
        let participants = Participants::of(group.items.len(), &group.ballots);
        GroupScale {
            group,
            scale: scale(&participants, 0),
            fits: fits(group, &participants),
            omnibus_adjusted: None,
        }
    }
    let mut scales: Vec<GroupScale<'_>> = groups.par_iter().map(of).collect();
    let omnibus = |of: &GroupScale<'_>| of.scale.as_ref().ok().and_then(|scale| scale.omnibus.ok());
    let tested: Vec<usize> = (0..scales.len()).filter(|&i| omnibus(&scales[i]).is_some()).collect();
    let p: Vec<f64> = tested.iter().filter_map(|&i| omnibus(&scales[i])).map(|of| of.p).collect();
    tested.into_iter().zip(holm(&p)).for_each(|(i, p)| scales[i].omnibus_adjusted = Some(p));
    scales
}

/// How well a model of worths reproduces the answers.
pub struct GroupFit {
    /// The model, fitted.
    pub model: WorthFit,
    /// Against chances of its own for every pair.
    pub goodness: Goodness,
    /// What Rao and Kupper's gains on Davidson's.
    pub gain: Option<Closeness>,
}

fn fits(group: &BallotGroup, participants: &Participants) -> Vec<GroupFit> {
    let pairs = Pairs::of(group.items.len(), &group.ballots);
    let [davidson, rao_kupper] = [Model::Davidson, Model::RaoKupper].map(|model| fit(model, &pairs).ok());
    let gain = match (&davidson, &rao_kupper) {
        (Some(davidson), Some(rao)) => closeness(rao, davidson, participants),
        _ => None,
    };
    let judged = |(model, gain): (Option<WorthFit>, Option<Closeness>)| {
        let model = model?;
        Some(GroupFit { goodness: goodness(&model, &pairs)?, model, gain })
    };
    [(davidson, None), (rao_kupper, gain)].into_iter().filter_map(judged).collect()
}
