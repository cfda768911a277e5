//! Worths by the model of the way in which people were asked, beside those that pairs give.

use crate::ballots::BallotGroup;
use isostudy_design::Study;
use isostudy_responses::{Judged, Responses, Verdict};
use isostudy_statistics::interval::Interval;
use isostudy_statistics::{
    Choice, Coefficient, FitError, GradedBallot, Link, Participants, Rating, first_choice, graded, ratings,
    shrunken,
};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// A model of answers that say more than which of two was chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WayModel {
    /// Steps, each against the next one: on the scale of pairs.
    Adjacent,
    /// Steps, each and all beyond against the others: on a scale of its own.
    Cumulative,
    /// Mean ratings, in steps of the scale.
    Ratings,
    /// What was taken of several: on the scale of pairs.
    FirstChoice,
    /// Pairs of which earlier answers chose some: worths drawn from one distribution, on the scale of pairs.
    DrawnTogether,
}

impl WayModel {
    /// Both models of steps.
    const OF_STEPS: [(Self, Link); 2] =
        [(Self::Adjacent, Link::Adjacent), (Self::Cumulative, Link::Cumulative)];

    /// The name in files.
    pub fn code(self) -> &'static str {
        match self {
            Self::Adjacent => "adjacent-steps",
            Self::Cumulative => "cumulative-steps",
            Self::Ratings => "ratings",
            Self::FirstChoice => "first-choice",
            Self::DrawnTogether => "drawn-together",
        }
    }
}

/// One model of one group.
#[derive(Debug, Clone, PartialEq)]
pub struct OfGroup<'a> {
    /// The group.
    pub group: &'a BallotGroup,
    /// The model.
    pub model: WayModel,
    /// How many answers it was fitted to.
    pub answers: u64,
    /// Of steps, how many of them say that something is much better.
    pub much: u64,
    /// By item; or why there is none.
    pub worths: Result<Vec<Worth>, FitError>,
}

/// What an item is worth, less the worth of its group's first item.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worth {
    /// The difference; 0 of the first item.
    pub value: f64,
    /// Its standard error with participants as clusters; none of the first item, and where people tell no spread.
    pub error: Option<f64>,
    /// The t interval of that.
    pub interval: Option<Interval>,
    /// Two-sided p.
    pub p: Option<f64>,
}

/// Both models of steps, of every group in which somebody said that something is much better.
pub fn of_steps(groups: &[BallotGroup]) -> Vec<OfGroup<'_>> {
    let stepped = groups.iter().filter(|group| group.ballots.iter().any(|ballot| ballot.step().abs() > 1));
    let wanted: Vec<(&BallotGroup, (WayModel, Link))> =
        stepped.flat_map(|group| WayModel::OF_STEPS.map(|model| (group, model))).collect();
    wanted.into_par_iter().map(|(group, model)| steps(group, model)).collect()
}

fn steps(group: &BallotGroup, (model, link): (WayModel, Link)) -> OfGroup<'_> {
    let ballots: Vec<GradedBallot> = group
        .ballots
        .iter()
        .map(|ballot| GradedBallot {
            participant: ballot.participant(),
            left: ballot.left(),
            right: ballot.right(),
            step: ballot.step(),
        })
        .collect();
    let fitted = graded(link, group.items.len(), &ballots);
    OfGroup {
        group,
        model,
        answers: ballots.len() as u64,
        much: ballots.iter().filter(|of| of.step.abs() > 1).count() as u64,
        worths: fitted.map(|fit| worths(&fit.log_worths, |item| fit.difference(item, 0))),
    }
}

/// Worths drawn together, of every group: for answers to pairs that earlier answers chose.
pub fn of_adaptive(groups: &[BallotGroup]) -> Vec<OfGroup<'_>> {
    let one = |group| {
        let group: &BallotGroup = group;
        let participants = Participants::of(group.items.len(), &group.ballots);
        let worths = shrunken(&participants).map(|of| worths(&of.log_worths, |item| of.difference(item, 0)));
        OfGroup {
            group,
            model: WayModel::DrawnTogether,
            answers: group.ballots.len() as u64,
            much: 0,
            worths,
        }
    };
    groups.par_iter().map(one).collect()
}

/// Each item's value less the first one's, with what is known of the difference.
fn worths(values: &[f64], difference: impl Fn(usize) -> Option<Coefficient>) -> Vec<Worth> {
    let of = |item: usize| {
        let found = difference(item).filter(|_| item > 0);
        Worth {
            value: values[item] - values[0],
            error: found.map(|of| of.se),
            interval: found.map(|of| of.interval),
            p: found.map(|of| of.p),
        }
    };
    (0..values.len()).map(of).collect()
}

/// The model of ratings, or of the best of several, of every group of methods; none of answers to pairs. Groups of other items than
/// methods are left out, and so is who is `excluded`.
pub fn of_judged<'a>(
    study: &Study,
    responses: &Responses,
    excluded: &BTreeSet<usize>,
    groups: &'a [BallotGroup],
) -> Vec<OfGroup<'a>> {
    let method: Vec<String> = study.configurations.iter().map(|of| of.id.method.to_string()).collect();
    let object: Vec<usize> = study.configurations.iter().map(|of| of.object).collect();
    let counted: Vec<&Judged> = responses
        .judged
        .iter()
        .filter(|of| !of.is_repeat && !excluded.contains(&(of.participant as usize)))
        .collect();
    let of_methods =
        groups.iter().filter(|group| group.items.iter().all(|item| method.iter().any(|of| of == item)));
    let one = |group: &'a BallotGroup| {
        let place = |item: u32| group.items.iter().position(|own| *own == method[item as usize]);
        match counted.first()?.verdict {
            Verdict::Rated(_) => Some(rated(group, &counted, place, &object)),
            Verdict::Taken(_) => Some(taken(group, &counted, place)),
        }
    };
    of_methods.filter_map(one).collect()
}

/// Ratings less the mean of their object: objects that are liked unlike tell nothing of methods.
fn rated<'a>(
    group: &'a BallotGroup,
    judged: &[&Judged],
    place: impl Fn(u32) -> Option<usize>,
    object: &[usize],
) -> OfGroup<'a> {
    let step = |of: &&Judged| match of.verdict {
        Verdict::Rated(step) => {
            Some((of.participant as usize, place(of.shown[0])?, of.shown[0], f64::from(step)))
        }
        Verdict::Taken(_) => None,
    };
    let own: Vec<(usize, usize, u32, f64)> = judged.iter().filter_map(step).collect();
    let mut sums: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    for &(_, _, item, value) in &own {
        let (sum, number) = sums.entry(object[item as usize]).or_default();
        (*sum, *number) = (*sum + value, *number + 1.0);
    }
    let mean = |item: u32| sums.get(&object[item as usize]).map_or(0.0, |(sum, number)| sum / number);
    let ratings_of: Vec<Rating> = own
        .iter()
        .map(|&(participant, place, item, value)| Rating {
            participant,
            item: place,
            value: value - mean(item),
        })
        .collect();
    let fitted = ratings(group.items.len(), &ratings_of);
    OfGroup {
        group,
        model: WayModel::Ratings,
        answers: ratings_of.len() as u64,
        much: 0,
        worths: fitted.map(|fit| worths(&fit.means, |item| fit.difference(item, 0))),
    }
}

/// What was taken of the group's items in each set. Of a set that has others too, only what was taken of the group's own counts: given that
/// one of them was taken, the chances are those of a set without the others.
fn taken<'a>(
    group: &'a BallotGroup,
    judged: &[&Judged],
    place: impl Fn(u32) -> Option<usize>,
) -> OfGroup<'a> {
    let choice = |of: &&Judged| {
        let Verdict::Taken(Some(taken)) = of.verdict else { return None };
        let shown: Vec<usize> = of.shown.iter().filter_map(|&item| place(item)).collect();
        let taken = place(taken).filter(|_| shown.len() > 1)?;
        Some(Choice { participant: of.participant as usize, shown, taken })
    };
    let choices: Vec<Choice> = judged.iter().filter_map(choice).collect();
    let fitted = first_choice(group.items.len(), &choices);
    OfGroup {
        group,
        model: WayModel::FirstChoice,
        answers: choices.len() as u64,
        much: 0,
        worths: fitted.map(|fit| worths(&fit.log_worths, |item| fit.difference(item, 0))),
    }
}

#[cfg(test)]
mod tests;
