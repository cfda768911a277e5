//! Pareto fronts: who is beaten in both of two quantities, and by whom.

use super::{Candidate, Estimate, ObjectCandidates};
use isostudy_design::MethodId;

/// What is set against what. Both quantities of a front are better if they are smaller, but for preference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axes {
    /// Seconds against error.
    TimeError,
    /// Triangles against error.
    TrianglesError,
    /// Seconds against preference.
    TimePreference,
}

impl Axes {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::TimeError, Self::TrianglesError, Self::TimePreference];

    /// In words.
    pub fn label(self) -> &'static str {
        match self {
            Self::TimeError => "time and error",
            Self::TrianglesError => "triangles and error",
            Self::TimePreference => "time and preference",
        }
    }

    /// Whether a time is one of both quantities.
    pub fn is_of_times(self) -> bool {
        matches!(self, Self::TimeError | Self::TimePreference)
    }

    /// Both quantities of a candidate that has them.
    pub fn of(self, candidate: &Candidate<'_>) -> Option<[Estimate; 2]> {
        match self {
            Self::TimeError => Some([candidate.time_s?, candidate.error?]),
            Self::TrianglesError => Some([candidate.triangles(), candidate.error?]),
            Self::TimePreference => Some([candidate.time_s?, candidate.preference?]),
        }
    }
}

/// Where a method stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Standing {
    /// Nobody is better in one and as good in the other.
    OnFront,
    /// Somebody is, by their estimates; not beyond the intervals.
    PerhapsBeaten(Vec<MethodId>),
    /// Somebody is, beyond the intervals of both.
    Beaten(Vec<MethodId>),
}

/// The methods of an object in two quantities, in the study's order.
pub struct Front {
    /// The two quantities.
    pub axes: Axes,
    /// Every method that has both.
    pub points: Vec<FrontPoint>,
}

/// A method on a front or behind it.
pub struct FrontPoint {
    /// The method.
    pub method: MethodId,
    /// Both quantities.
    pub at: [Estimate; 2],
    /// Whether another is better in both.
    pub standing: Standing,
}

/// The fronts of an object on which two methods at least have a place. Who met a budget with the very cells of an earlier method of
/// the same recipe is that method. In preference one beats another if it was shown to be liked more: two intervals, each about one worth,
/// do not tell that.
pub fn fronts(of: &ObjectCandidates<'_>) -> Vec<Front> {
    let candidates = &of.candidates;
    let is_new = |(place, candidate): &(usize, &Candidate<'_>)| {
        let same = |other: &Candidate<'_>| {
            other.method.recipe == candidate.method.recipe && other.mesh.spacing == candidate.mesh.spacing
        };
        !candidates[..*place].iter().any(same)
    };
    let candidates: Vec<&Candidate<'_>> =
        candidates.iter().enumerate().filter(is_new).map(|(_, candidate)| candidate).collect();
    let front = |axes: Axes| {
        let placed = candidates.iter().filter_map(|candidate| Some((candidate.id(), axes.of(candidate)?)));
        let placed: Vec<(MethodId, [Estimate; 2])> = placed.collect();
        let costs: Vec<[Estimate; 2]> = placed
            .iter()
            .map(|&(_, [x, y])| [x, if axes == Axes::TimePreference { -y } else { y }])
            .collect();
        let point = |(place, &(method, at)): (usize, &(MethodId, [Estimate; 2]))| {
            let beating = |rule: &dyn Fn(MethodId, &[Estimate; 2]) -> bool| -> Vec<MethodId> {
                let others = placed.iter().zip(&costs).filter(|((method, _), cost)| rule(*method, cost));
                others.map(|((method, _), _)| *method).collect()
            };
            let own = &costs[place];
            let is_liked_more = |other: MethodId| of.liked_more.contains(&[other, method]);
            let surely = beating(&|other, cost| match axes {
                Axes::TimePreference => is_liked_more(other) && cost[0].high <= own[0].low,
                Axes::TimeError | Axes::TrianglesError => beats_surely(cost, own),
            });
            let perhaps = beating(&|_, cost| beats(cost, own));
            let standing = match (surely.is_empty(), perhaps.is_empty()) {
                (false, _) => Standing::Beaten(surely),
                (true, false) => Standing::PerhapsBeaten(perhaps),
                (true, true) => Standing::OnFront,
            };
            FrontPoint { method, at, standing }
        };
        Front { axes, points: placed.iter().enumerate().map(point).collect() }
    };
    Axes::ALL.into_iter().map(front).filter(|front| front.points.len() > 1).collect()
}

/// No larger in either, smaller in one.
fn beats(one: &[Estimate; 2], other: &[Estimate; 2]) -> bool {
    let pairs = || one.iter().zip(other);
    pairs().all(|(a, b)| a.value <= b.value) && pairs().any(|(a, b)| a.value < b.value)
}

/// The same of whatever may be within both intervals.
fn beats_surely(one: &[Estimate; 2], other: &[Estimate; 2]) -> bool {
    let pairs = || one.iter().zip(other);
    pairs().all(|(a, b)| a.high <= b.low) && pairs().any(|(a, b)| a.high < b.low)
}
