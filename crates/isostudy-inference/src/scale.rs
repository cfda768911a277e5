//! All items of a group on one scale.

use crate::ballots::BallotGroup;
use isostudy_statistics::{FitError, Participants, Scale, holm, scale};
use rayon::prelude::*;

/// A group's items on one scale, its first item at zero; what cannot be placed has the reason.
pub struct GroupScale<'a> {
    pub group: &'a BallotGroup,
    pub participants: Participants,
    pub scale: Result<Scale, FitError>,
    /// p of the omnibus test by Holm over the groups that have one.
    pub omnibus_adjusted: Option<f64>,
}

/// The scale of every group.
pub fn scales(groups: &[BallotGroup]) -> Vec<GroupScale<'_>> {
    fn of(group: &BallotGroup) -> GroupScale<'_> {
        let participants = Participants::of(group.items.len(), &group.ballots);
        GroupScale { group, scale: scale(&participants, 0), participants, omnibus_adjusted: None }
    }
    let mut scales: Vec<GroupScale<'_>> = groups.par_iter().map(of).collect();
    let omnibus = |of: &GroupScale<'_>| of.scale.as_ref().ok().and_then(|scale| scale.omnibus.ok());
    let tested: Vec<usize> = (0..scales.len()).filter(|&i| omnibus(&scales[i]).is_some()).collect();
    let p: Vec<f64> = tested.iter().filter_map(|&i| omnibus(&scales[i])).map(|of| of.p).collect();
    tested.into_iter().zip(holm(&p)).for_each(|(i, p)| scales[i].omnibus_adjusted = Some(p));
    scales
}
