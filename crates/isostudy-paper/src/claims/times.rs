//! Claims about times. Means of ratios are compared, not times; still, the machine decides them.

use super::Finding;
use super::numbers::{Measure, Numbers, Ours, Pair, Side, mean, mean_change};
use crate::verdict::Verdict;
use isostudy_design::Clustering::{self, EdgeCollapse, Integrated};
use isostudy_design::Stage;
use isostudy_design::published::Claim;
use isostudy_design::record::BenchRun;
use isostudy_statistics::interval::{Interval, LEVEL};
use isostudy_statistics::median;
use isostudy_timing::{ASSUMED_NOISE, NoiseFloor};

const ALL: [Clustering; 3] = [Clustering::None, Integrated, EdgeCollapse];

/// A pass of an extraction as the published tables have it, and the stage whose noise it has.
#[derive(Clone, Copy)]
pub(crate) struct Pass {
    measure: Measure,
    stage: Stage,
}

pub(crate) const VERTEX: Pass = Pass {
    measure: Measure { published: |p| p.vertex_s, ours: Ours::Times(|t| t.vertex_s) },
    stage: Stage::Vertex,
};
pub(crate) const GEOMETRY: Pass = Pass {
    measure: Measure { published: |p| p.geometry_s, ours: Ours::Times(|t| t.geometry_s) },
    stage: Stage::GeometryAsPublished,
};
/// Without normals, as published; they are a small part of the total, whose noise stands for it.
pub(crate) const WHOLE: Pass = Pass {
    measure: Measure {
        published: |p| p.total_without_normals_s,
        ours: Ours::Times(|t| t.total_without_normals_s()),
    },
    stage: Stage::Total,
};

/// By how much a time changes, as a mean over pairs of configurations, in per cent.
#[derive(Debug)]
pub(crate) struct Change {
    pub(crate) published: Option<f64>,
    /// Median over rounds.
    pub(crate) ours: f64,
    /// Of the median; `None` of fewer rounds than it takes.
    pub(crate) interval: Option<Interval>,
    /// What processes that differ may add or take away.
    pub(crate) noise: f64,
    /// Whether no A/A block tells it, so that it is [`ASSUMED_NOISE`].
    pub(crate) is_assumed: bool,
}

/// What can be said of a change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Direction {
    /// That of the published number.
    Same,
    /// The other one.
    Opposite,
    /// None: the interval does not lie beyond the noise.
    WithinNoise,
    /// Nothing was published.
    NotJudged,
    /// There is no interval.
    TooFewRounds,
}

impl Change {
    /// Of one pass; `None` without a benchmark of ours.
    pub(crate) fn of(numbers: &Numbers<'_>, pass: Pass, pairs: &[Pair]) -> Option<Self> {
        let run = numbers.inputs.bench?;
        let ratios = |side| numbers.ratios(side, pass.measure, pairs);
        let found = median(by_round(run, ratios, mean_change), LEVEL)?;
        let floor = NoiseFloor::of(run);
        // At worst all pairs are out to the same side.
        let noise = |&[top, bottom]: &Pair| {
            let [first, second] = [top, bottom].map(|(object, method)| numbers.id(object, method));
            let ratio = numbers.ratios(Side::Ours, pass.measure, &[[top, bottom]]).first().copied()?;
            let within = floor.within(pass.stage, &first, &second).unwrap_or(ASSUMED_NOISE);
            Some(100.0 * ratio * within.exp_m1())
        };
        let noise: Vec<f64> = pairs.iter().filter_map(noise).collect();
        Some(Self {
            published: mean_change(&ratios(Side::Published)),
            ours: found.median,
            interval: found.interval_at(LEVEL),
            noise: mean(&noise)?,
            is_assumed: floor.range(pass.stage).is_none(),
        })
    }

    /// What can be said of it.
    pub(crate) fn direction(&self) -> Direction {
        let Some(Interval { low, high }) = self.interval else { return Direction::TooFewRounds };
        let Some(published) = self.published else { return Direction::NotJudged };
        let ours = match () {
            () if low > self.noise => 1.0,
            () if high < -self.noise => -1.0,
            () => return Direction::WithinNoise,
        };
        if published * ours > 0.0 { Direction::Same } else { Direction::Opposite }
    }

    /// Whether the published number lies in the interval, noise included; `None` where one of them is not known.
    pub(crate) fn has_the_published_size(&self) -> Option<bool> {
        let (Interval { low, high }, noise) = (self.interval?, self.noise);
        self.published.map(|published| (low - noise..=high + noise).contains(&published))
    }

    /// What can be said, in words, with interval and noise.
    fn told(&self) -> String {
        let what = match self.direction() {
            Direction::Same => "same direction",
            Direction::Opposite => "opposite direction",
            Direction::WithinNoise => "no change measurable here",
            Direction::NotJudged => "nothing published to hold it against",
            Direction::TooFewRounds => return "too few rounds to tell a change from noise".into(),
        };
        let interval = self.interval.map_or(String::new(), |Interval { low, high }| {
            format!("95 % interval over rounds {low:.2} to {high:.2} %")
        });
        let assumed = if self.is_assumed { ", assumed for want of an A/A block" } else { "" };
        format!("{what} ({interval}, noise up to {:.2} points{assumed})", self.noise)
    }
}

pub(super) fn find(numbers: &Numbers<'_>, claim: &Claim) -> Option<Finding> {
    let against_none = |clustering| numbers.clustering_pairs(clustering, Clustering::None);
    let (pass, pairs) = match claim.id.as_str() {
        "vertex_integrated" => (VERTEX, against_none(Integrated)),
        "geometry_integrated" => (GEOMETRY, against_none(Integrated)),
        "vertex_edge_collapse" => (VERTEX, against_none(EdgeCollapse)),
        "geometry_edge_collapse" => (GEOMETRY, against_none(EdgeCollapse)),
        "arrangement_vertex" => (VERTEX, numbers.arrangement_pairs(&ALL)),
        "arrangement_geometry" => (GEOMETRY, numbers.arrangement_pairs(&ALL)),
        _ => return None,
    };
    let (value, run) = (claim.value?, numbers.inputs.bench?);
    let found = Change::of(numbers, pass, &pairs)?;
    let from_published = found.published;
    // The text is what is checked, whatever its tables come to.
    let found = Change { published: Some(value), ..found };
    let told = found.told();
    let verdict = if !run.differences.is_empty() {
        let model = run.machine.model.as_deref().unwrap_or("an unnamed CPU");
        Verdict::not_comparable(format!("{told}; measured on {model}, not on {}", run.target.name))
    } else {
        let reason = format!("{told}; measured on a matching machine");
        match found.has_the_published_size() {
            Some(true) => Verdict::within("interval and noise", reason),
            Some(false) => Verdict::differs(reason),
            None => Verdict::not_comparable(reason),
        }
    };
    Some(Finding {
        from_published,
        as_published: Some(found.ours),
        ..Finding::of(Some(found.ours), 2, verdict)
    })
}

/// What `summary` makes of our cases, round by round.
///
/// Cases are paired within a round, so that what slows a whole round down cancels. A round that lacks a case would be a
/// mean over others and is left out.
pub(crate) fn by_round(
    run: &BenchRun,
    cases: impl Fn(Side) -> Vec<f64>,
    summary: fn(&[f64]) -> Option<f64>,
) -> Vec<f64> {
    let all = cases(Side::Ours).len();
    let rounds = (0..run.iterations).map(|round| cases(Side::Round(round))).filter(|of| of.len() == all);
    rounds.filter_map(|of| summary(&of)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twelve per cent were published.
    fn change(low: f64, high: f64, noise: f64) -> Change {
        let interval = Some(Interval { low, high });
        Change { published: Some(12.0), ours: 0.5 * (low + high), interval, noise, is_assumed: false }
    }

    #[test]
    fn a_direction_needs_an_interval_beyond_the_noise() {
        let of = |low, high, noise| change(low, high, noise).direction();
        assert_eq!(of(1.0, 5.0, 0.5), Direction::Same);
        assert_eq!(of(-5.0, -1.0, 0.5), Direction::Opposite);
        assert_eq!(of(1.0, 5.0, 1.0), Direction::WithinNoise);
        assert_eq!(of(-1.0, 5.0, 0.5), Direction::WithinNoise);
        let few = Change { interval: None, ..change(9.0, 9.0, 1.0) };
        assert_eq!(few.direction(), Direction::TooFewRounds);
        let alone = Change { published: None, ..change(2.0, 3.0, 1.0) };
        assert_eq!(alone.direction(), Direction::NotJudged);
    }

    #[test]
    fn a_size_is_the_published_one_within_interval_and_noise() {
        let of = |published| Change { published, ..change(10.0, 12.0, 1.0) }.has_the_published_size();
        assert_eq!([Some(13.0), Some(13.1), Some(8.9)].map(of), [Some(true), Some(false), Some(false)]);
        assert_eq!(of(None), None);
    }

    #[test]
    fn an_assumed_noise_judges_and_is_said() {
        // Four times as long: 5 % of that are 21 points.
        let far = Change { is_assumed: true, ..change(306.0, 340.0, 21.3) };
        assert_eq!(far.direction(), Direction::Same);
        assert_eq!(
            far.told(),
            "same direction (95 % interval over rounds 306.00 to 340.00 %, noise up to 21.30 points, assumed for want of an A/A \
             block)"
        );
    }
}
