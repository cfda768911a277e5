//! Who is liked most, by worths on one scale: on each object, and on all of them.
//!
//! A share of showings won is a share against whoever happened to stand beside a method, and shares against different others cannot be
//! compared. A worth takes the others into account, and the side where sides alternate. The most liked is the top of the scale, and
//! with it goes everybody from whom it was not shown to differ: neither by the scale nor by a question that showed both.

use crate::answered::Answered;
use crate::hypotheses::{Hypothesis, On, Target};
use isostudy_design::contrast::Over;
use isostudy_design::{Level, MethodId, Study};
use isostudy_statistics::interval::{Interval, t_half_width};
use isostudy_statistics::{
    Difference, FitError, Participants, Scale, ShownBallot, clustered_covariance, has_spread, scale,
};
use std::collections::BTreeSet;

/// Log-odds that differ by less differ by rounding.
const ALIKE: f64 = 1e-9;

/// The methods of a study on one scale.
pub struct Liking {
    /// The object by index; `None` for all of them.
    pub object: Option<usize>,
    /// The methods that were compared, in the study's order: if answers do not join all of them, those of the set that has more
    /// than half.
    pub methods: Vec<MethodId>,
    /// The methods that no answers join to these.
    pub apart: Vec<MethodId>,
    /// Whether so few people answered that no difference on the scale is judged.
    pub is_too_few: bool,
    /// By method, the log worth less the mean of all, with its interval at 95 % over people. `None` where there is no one scale.
    pub worths: Result<Vec<(f64, Option<Interval>)>, FitError>,
    /// The most liked; `None` where there is no one scale, or where nothing bounds the worths and tests about the two themselves do
    /// not take it apart from everybody else.
    pub top: Option<Top>,
    /// Every two methods, in the study's order; none where there is no one scale.
    pub pairs: Vec<LikedPair>,
}

/// What is known of two methods' worths on one scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LikedPair {
    /// The one method.
    pub first: MethodId,
    /// The other.
    pub second: MethodId,
    /// Log worth of the first less that of the second.
    pub log_odds: f64,
    /// p of no difference on the scale, adjusted by Holm over its pairs; `None` where it has none.
    pub adjusted: Option<f64>,
    /// Which of them a held test about the two themselves prefers.
    pub asked: Option<MethodId>,
    /// Which of them was shown to be liked more, by the scale or by a test about the two.
    pub shown: Option<MethodId>,
}

/// The top of a scale.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Top {
    /// The method with the largest worth; of equal ones the study's first.
    pub best: MethodId,
    /// The others by their worths, from which it was not shown to differ.
    pub alike: Vec<MethodId>,
}

impl Liking {
    /// On all objects, where methods hang together, then on each object with answers.
    pub fn all(study: &Study, answered: &Answered, level: f64) -> Vec<Self> {
        let of = |object: Option<usize>| Self::of(study, answered, object, level);
        let objects = (0..study.file.objects.len()).map(Some);
        std::iter::once(None).chain(objects).filter_map(of).collect()
    }

    /// `None` where fewer than two methods were compared.
    fn of(study: &Study, answered: &Answered, object: Option<usize>, level: f64) -> Option<Self> {
        let asked = |b: &&ShownBallot| object.is_none_or(|o| study.comparisons[b.question()].object == o);
        let ballots: Vec<&ShownBallot> =
            answered.shown.iter().filter(asked).filter(|b| b.left() != b.right()).collect();
        let all = study.method_ids();
        let mut items: Vec<usize> = ballots.iter().flat_map(|b| [b.left(), b.right()]).collect();
        items.sort_unstable();
        items.dedup();
        if items.len() < 2 {
            return None;
        }
        let pairs: BTreeSet<[usize; 2]> = ballots.iter().map(|b| [b.left(), b.right()]).collect();
        let joined = most_joined(&items, &pairs);
        let (items, apart): (Vec<usize>, Vec<usize>) =
            items.into_iter().partition(|item| joined.contains(item));
        let apart = apart.into_iter().map(|item| all[item]).collect();
        let place = |item: usize| items.binary_search(&item).ok();
        let own: Vec<ShownBallot> = ballots
            .iter()
            .filter_map(|b| Some(b.with_items([place(b.left())?, place(b.right())?])))
            .collect();
        let participants = Participants::of(items.len(), &own);
        let methods: Vec<MethodId> = items.iter().map(|&item| all[item]).collect();
        let found = scale(&participants, 0);
        let is_too_few = is_too_few(participants.number(), level);
        let level = if is_too_few { f64::NEG_INFINITY } else { level };
        let shown = |a: usize, b: usize| match object {
            Some(object) => is_shown_on(study, &answered.hypotheses, object, [methods[a], methods[b]]),
            None => is_shown(Some(study), &answered.hypotheses, "", methods[a].as_str(), methods[b].as_str()),
        };
        let top = found.as_ref().ok().and_then(|scale| Top::of(scale, &methods, level, &shown));
        let pair = |of: &Difference| {
            let [first, second] = [methods[of.first], methods[of.second]];
            let adjusted = of.spread.map(|spread| spread.adjusted);
            let asked = match (shown(of.first, of.second), shown(of.second, of.first)) {
                (true, _) => Some(first),
                (_, true) => Some(second),
                _ => None,
            };
            let by_scale =
                adjusted.filter(|&p| p <= level).map(|_| if of.log_odds > 0.0 { first } else { second });
            LikedPair { first, second, log_odds: of.log_odds, adjusted, asked, shown: asked.or(by_scale) }
        };
        let pairs =
            found.as_ref().map_or_else(|_| Vec::new(), |scale| scale.differences.iter().map(pair).collect());
        let worths = found.map(|scale| centred(&scale, &participants));
        Some(Self { object, methods, apart, is_too_few, worths, top, pairs })
    }

    /// The method that was shown to be liked more, then the other, of every two of which one was.
    pub fn shown(&self) -> Vec<[MethodId; 2]> {
        let other = |of: &LikedPair, one| if of.first == one { of.second } else { of.first };
        self.pairs.iter().filter_map(|of| of.shown.map(|one| [one, other(of, one)])).collect()
    }

    /// A method's worth; `None` where it has none.
    pub fn worth(&self, method: MethodId) -> Option<(f64, Option<Interval>)> {
        let place = self.methods.iter().position(|&of| of == method)?;
        Some(self.worths.as_ref().ok()?[place])
    }
}

impl Top {
    fn of(
        scale: &Scale,
        methods: &[MethodId],
        level: f64,
        is_shown: &dyn Fn(usize, usize) -> bool,
    ) -> Option<Self> {
        let Order { best, alike } = Order::of(scale, level, is_shown);
        let alike: Vec<MethodId> = alike.into_iter().map(|item| methods[item]).collect();
        (!scale.fit.penalised() || alike.is_empty()).then_some(Self { best: methods[best], alike })
    }
}

/// The top of a scale, by items.
pub(crate) struct Order {
    /// The item with the largest worth; of equal ones the first.
    pub(crate) best: usize,
    /// The others from which it was not shown to differ, by their worths.
    pub(crate) alike: Vec<usize>,
}

impl Order {
    /// `is_shown` says whether a held test about two items themselves prefers the first.
    pub(crate) fn of(scale: &Scale, level: f64, is_shown: &dyn Fn(usize, usize) -> bool) -> Self {
        let worths = &scale.fit.log_worths;
        let mut order: Vec<usize> = (0..worths.len()).collect();
        order.sort_by(|&a, &b| {
            let is_alike = (worths[a] - worths[b]).abs() < ALIKE;
            if is_alike { a.cmp(&b) } else { worths[b].total_cmp(&worths[a]) }
        });
        let best = order[0];
        let differs = |other: usize| {
            let pair = |of: &&Difference| (of.first, of.second) == (best.min(other), best.max(other));
            let found = scale.differences.iter().find(pair).and_then(|of| of.spread);
            found.is_some_and(|spread| spread.adjusted <= level) || is_shown(best, other)
        };
        let alike = order[1..].iter().copied().filter(|&other| !differs(other)).collect();
        Self { best, alike }
    }
}

/// The set that has more than half of the items, of the sets that pairs join; all items if none has.
fn most_joined(items: &[usize], pairs: &BTreeSet<[usize; 2]>) -> Vec<usize> {
    let mut open = items.to_vec();
    while let Some(&first) = open.first() {
        let mut set = vec![first];
        loop {
            let before = set.len();
            for &[one, other] in pairs {
                match (set.contains(&one), set.contains(&other)) {
                    (true, false) => set.push(other),
                    (false, true) => set.push(one),
                    _ => {}
                }
            }
            if set.len() == before {
                break;
            }
        }
        if 2 * set.len() > items.len() {
            return set;
        }
        open.retain(|item| !set.contains(item));
    }
    items.to_vec()
}

/// Whether no outcome of so many people is significant by the exact sign-flip test, all of one mind included. A test by the spread
/// between so few is no better.
pub(crate) fn is_too_few(people: u64, level: f64) -> bool {
    people == 0 || 2.0_f64.powi(1 - people as i32) > level
}

/// Whether a held test about these two themselves, over all answers, prefers the first. Items are methods, levels of a factor, or what
/// a group of answers without a study compares.
pub(crate) fn is_shown(
    study: Option<&Study>,
    hypotheses: &[Hypothesis],
    group: &str,
    first: &str,
    second: &str,
) -> bool {
    hypotheses.iter().filter(|of| of.differs()).any(|of| {
        let towards = |[a, b]: [&str; 2]| {
            (a == first && b == second && of.test.mean > 0.0)
                || (b == first && a == second && of.test.mean < 0.0)
        };
        match (&of.target, study) {
            (Target::Items { group: own, first, second, on: On::All }, _) => {
                own == group && towards([first, second])
            }
            (Target::Contrast { levels: [a, b], over: Over::All }, Some(study)) => {
                towards([&study.level(*a).code, &study.level(*b).code])
                    || only(study, &[*a])
                        .zip(only(study, &[*b]))
                        .is_some_and(|(a, b)| towards([a.as_str(), b.as_str()]))
            }
            (Target::Contrast { levels: [a, b], over: Over::Within(within) }, Some(study)) => {
                only(study, &[*a, *within])
                    .zip(only(study, &[*b, *within]))
                    .is_some_and(|(a, b)| towards([a.as_str(), b.as_str()]))
            }
            _ => false,
        }
    })
}

/// The only method that has these levels.
fn only(study: &Study, levels: &[Level]) -> Option<MethodId> {
    let has = |method: &MethodId| levels.iter().all(|of| study.level_of(*method, of.factor) == Some(*of));
    let mut own = study.method_ids().into_iter().filter(has);
    own.next().filter(|_| own.next().is_none())
}

/// Whether a question on this object that showed both was shown to prefer the first.
fn is_shown_on(study: &Study, hypotheses: &[Hypothesis], object: usize, pair: [MethodId; 2]) -> bool {
    hypotheses.iter().filter(|of| of.differs()).any(|of| {
        let Target::Question(q) = of.target else { return false };
        let asked = &study.comparisons[q];
        let own = [asked.left.method, asked.right.method];
        let turned = [own[1], own[0]];
        asked.object == object
            && ((own == pair && of.test.mean > 0.0) || (turned == pair && of.test.mean < 0.0))
    })
}

/// Log worths less their mean, each with its t interval where people tell a spread.
fn centred(scale: &Scale, participants: &Participants) -> Vec<(f64, Option<Interval>)> {
    let fit = &scale.fit;
    let items = fit.log_worths.len();
    let mean = fit.log_worths.iter().sum::<f64>() / items as f64;
    let covariance = clustered_covariance(fit, participants).filter(|_| !fit.penalised());
    let m = participants.number() as f64;
    let interval = |item: usize, worth: f64| {
        let weight = |other: usize| f64::from(u8::from(other == item)) - 1.0 / items as f64;
        // The first item's parameter is fixed at zero.
        let error = |covariance: &isostudy_statistics::Matrix| {
            let terms = (1..items).flat_map(|a| (1..items).map(move |b| (a, b)));
            let variance: f64 = terms.map(|(a, b)| weight(a) * weight(b) * covariance[a - 1][b - 1]).sum();
            variance.max(0.0).sqrt()
        };
        let se = error(covariance.as_ref()?);
        let half = t_half_width(m - 1.0).filter(|_| has_spread(se, error(&fit.covariance)))? * se;
        Some(Interval { low: worth - half, high: worth + half })
    };
    let of = |item: usize| {
        let worth = fit.log_worths[item] - mean;
        (worth, interval(item, worth))
    };
    (0..items).map(of).collect()
}

#[cfg(test)]
mod tests;
