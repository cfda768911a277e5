//! Who stood on which side, and how far a liking for a side can be told from a liking for what stood there.

use crate::ballots::BallotGroup;
use isostudy_statistics::interval::{Interval, t_half_width};
use isostudy_statistics::{
    Model, Pairs, Participants, Separation, ShownBallot, SideBound, SideDesign, clustered_covariance, fit,
    has_spread, separation, side_bound, side_design,
};

/// What a design says about sides, over all answers and group by group.
pub struct Sides<'a> {
    /// Of all answers together.
    pub design: SideDesign,
    /// Of each group.
    pub groups: Vec<GroupSides<'a>>,
}

/// The sides of a group.
pub struct GroupSides<'a> {
    /// The group.
    pub group: &'a BallotGroup,
    /// What its answers can tell.
    pub design: SideDesign,
    /// What people like a side by, where it can be estimated.
    pub bonus: Option<SideBonus>,
}

/// A liking for a side, in log-odds, by Davidson's model with a side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SideBonus {
    /// It has no upper bound.
    AtLeast(SideBound),
    /// Of the left side; its t interval takes participants as clusters, and is none where they do not differ.
    Left(f64, Option<Interval>),
}

impl<'a> Sides<'a> {
    /// Of answers on the sides that people saw, and of the same in groups.
    pub fn of(shown: &[ShownBallot], groups: &'a [BallotGroup]) -> Self {
        let items = shown.iter().map(|b| b.left().max(b.right()) + 1).max().unwrap_or(0);
        let of = |group: &'a BallotGroup| {
            let pairs = Pairs::of(group.items.len(), &group.ballots);
            let design = side_design(&pairs);
            let is_estimable = matches!(design, SideDesign::Counterbalanced | SideDesign::ThroughAdditivity);
            GroupSides { group, design, bonus: is_estimable.then(|| bonus(group, &pairs)).flatten() }
        };
        Self { design: side_design(&Pairs::of(items, shown)), groups: groups.iter().map(of).collect() }
    }

    /// The groups with a design.
    pub fn with(&self, design: SideDesign) -> impl Iterator<Item = &GroupSides<'a>> {
        self.groups.iter().filter(move |of| of.design == design)
    }

    /// Whether no pair was shown in both orders, in all answers or in a group.
    pub fn go_with_items(&self) -> bool {
        let both = SideDesign::Counterbalanced;
        self.design != both && self.with(both).next().is_none()
    }
}

fn bonus(group: &BallotGroup, pairs: &Pairs) -> Option<SideBonus> {
    // Where ties alone keep the worths finite, the side would take the blame.
    if separation(pairs) != Separation::None {
        return None;
    }
    let participants = Participants::of(group.items.len(), &group.ballots);
    if let Some(bound) = side_bound(&participants) {
        return Some(SideBonus::AtLeast(bound));
    }
    let fitted = fit(Model::DavidsonSide, pairs).ok().filter(|fit| !fit.penalised())?;
    let covariance = clustered_covariance(&fitted, &participants)?;
    let place = fitted.parameters.len() - 1;
    let side = fitted.side?;
    let (people, se) = (participants.number() as f64, covariance[place][place].sqrt());
    let half = t_half_width(people - 1.0)? * se;
    let has_spread = has_spread(se, fitted.covariance[place][place].sqrt());
    let interval = has_spread.then_some(Interval { low: side - half, high: side + half });
    Some(SideBonus::Left(side, interval))
}
