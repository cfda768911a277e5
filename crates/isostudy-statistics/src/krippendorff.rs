//! Krippendorff's alpha over questions (units) and participants (raters), with its interval.

mod by_odds;
mod jackknife;
mod printed;
mod shared;

use super::ballot::DeclaredBallot;
use super::kendall::outcome_counts;
use crate::interval::Interval;

/// What counts as disagreement between two of the values first < neither < second.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Metric {
    /// Different is different.
    Nominal,
    /// By the number of answers that lie between, half of the ends' own: depends on the margins.
    Ordinal,
}

/// Agreement of participants about items.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alpha {
    /// 1 in full agreement, 0 by chance, negative below.
    pub value: f64,
    /// At [`LEVEL`](crate::interval::LEVEL), within -1 and 1: see [`alpha_with_interval`], which says where it is withheld.
    pub interval: Option<Interval>,
}

/// Krippendorff's alpha (2004, *Content Analysis*, chapter 11): 1 - observed / expected disagreement, from the counts
/// `[first, neither, second]` of each question.
///
/// Every question is counted in both orientations, items named one way and the other, so that it makes no difference which
/// item somebody named first or put on the left. Counted once, chance agreement would rise with how one-sided the design
/// is, and alpha would speak of the design. So counted, chance is that of people who like the first and the second alike.
///
/// Questions with fewer than two answers are left out, as the definition has it; different numbers of answers are fine.
/// `None` if nothing can be paired or if nobody decided, which leaves 0/0.
pub fn alpha(questions: &[[u64; 3]], metric: Metric) -> Option<f64> {
    let mut table = Table::default();
    questions.iter().for_each(|counts| table.add(counts, 1.0));
    table.alpha(metric)
}

/// [`alpha`] with an interval for what so many more people of the kind would show, asked what these were asked. It speaks of other
/// people, not of other questions.
///
/// The interval is withheld where simulation does not bear it out. It takes all of:
///
/// - four questions or more;
/// - 12 people per question, on average, or more;
/// - questions times (1 - alpha) of 3 or more: people disagree as much as chance would on three questions.
///
/// Questions with fewer than two answers do not count. The interval is also `None` where all agree on everything, and where
/// leaving one out leaves nothing.
///
/// Alpha estimates a sum of squares: near 0 it is skewed, and its standard error rises and falls with it. So the interval is
/// not alpha -+ t s, but all x that a test does not reject, with the variance that x would give. Of the odds o = alpha / (1 - alpha),
/// and b = how much agreement with oneself would add to them (each answer paired with itself as well):
///
/// - o + b has mean x + b and variance v = 2 b^2 / f + s^2 / (1 - alpha)^4 x / (o + b), x of the second part cut at 0;
/// - s is the jackknife's standard error of alpha over the m participants (Efron and Tibshirani 1993, *An Introduction to the
///   Bootstrap*, chapter 11). From what leaving a participant out does, the mean effect of one answer less is taken off for each
///   question that the participant answered: who was asked what is fixed, and no chance;
/// - f counts independent deviations of the questions' shares: trace squared over trace of the square of their covariance over
///   participants (Satterthwaite 1946), the latter unbiased (Himeno and Yamada 2014, *J. Multivariate Analysis* 130);
/// - the cube root of a sum of squares is nearly normal (Wilson and Hilferty 1931; Abdel-Aty 1954): with h = v / (9 (x + b)^2), z =
///   (((o + b) / (x + b))^(1/3) - 1 + h) / sqrt h is compared with t, on as many degrees as v has: (m - 1) f of its first part
///   and a - 1 of its second (Satterthwaite), a the people per question. Below x = 0 everything is as at 0, but moved;
/// - the rule prints low estimates and withholds high ones. So the upper end is of a test among estimates that are printed: x is
///   rejected below if P(z) <= 0.0375 P(c) - max(0, P(c) - 0.975) / 2, P(c) the chance under x to be printed. That is 0.025 where
///   P(c) is 1, and takes half of what the lower end leaves over where it is not. The upper end is the least x so rejected, or 1.
///
/// Simulated (docs/statistics.md has the table), intervals that are printed cover 94 to 96 % on average, and
/// 92 to 99 % in single populations. The bootstrap does not serve: resamples have people more than once, who agree with themselves, and alpha rises.
///
/// Takes time in proportion to the sum over participants of their answers squared, and memory to the square of the questions'
/// number. The order of ballots makes no difference. Questions are numbered from 0.
pub fn alpha_with_interval(ballots: &[DeclaredBallot], metric: Metric) -> Option<Alpha> {
    let counts = outcome_counts(ballots);
    let mut all = Table::default();
    counts.iter().for_each(|counts| all.add(counts, 1.0));
    let value = all.alpha(metric)?;
    let mut sorted = ballots.to_vec();
    sorted.sort_unstable();
    let interval = printed::most(&sorted, &counts).filter(|most| value <= *most).and_then(|most| {
        let jackknife = jackknife::of(&sorted, &counts, &all, metric)?;
        let own_pairs = own_pairs(&counts, metric)?;
        let degrees = shared::degrees(&sorted, &counts, metric)?;
        let jackknife::Jackknife { people, per_question, variance } = jackknife;
        Some(
            by_odds::Odds { alpha: value, own_pairs, degrees, variance, people, per_question, most }
                .interval(),
        )
    });
    Some(Alpha { value, interval })
}

/// By how much the odds of alpha would rise if every answer were paired with itself as well, which never disagrees: 1 less the share of
/// observed disagreement that would be left. `None` if there is none.
fn own_pairs(questions: &[[u64; 3]], metric: Metric) -> Option<f64> {
    // Relative to neighbours: what `Table::alpha` has of the margins cancels out.
    let far_apart = match metric {
        Metric::Nominal => 1.0,
        Metric::Ordinal => 4.0,
    };
    let (mut fewer, mut all) = (0.0, 0.0);
    for [first, neither, second] in questions.iter().map(|counts| counts.map(|count| count as f64)) {
        let n = first + neither + second;
        if n >= 2.0 {
            let observed = ((first + second) * neither + far_apart * first * second) / (n - 1.0);
            fewer += observed / n;
            all += observed;
        }
    }
    (all > 0.0).then(|| fewer / all)
}

/// Sums over questions with two answers or more. What both orientations of a question make alike is added up together.
#[derive(Debug, Clone, Copy, Default)]
struct Table {
    /// Answers for the first or the second.
    decided: f64,
    /// Answers for neither.
    neither: f64,
    /// Pairs of a decided answer and neither; each pair of a question's n answers weighs 1 / (n - 1).
    near: f64,
    /// Pairs of the first and the second, likewise.
    far: f64,
}

impl Table {
    /// Adds a question so many times.
    fn add(&mut self, counts: &[u64; 3], times: f64) {
        let [first, neither, second] = counts.map(|count| count as f64);
        let n = first + neither + second;
        if n < 2.0 {
            return;
        }
        self.decided += times * (first + second);
        self.neither += times * neither;
        self.near += times * (first + second) * neither / (n - 1.0);
        self.far += times * first * second / (n - 1.0);
    }

    fn alpha(&self, metric: Metric) -> Option<f64> {
        // In both orientations together, each end is chosen as often as both ends in one, and neither twice as often.
        let (end, middle) = (self.decided, 2.0 * self.neither);
        let n = 2.0 * end + middle;
        let (near, far) = match metric {
            Metric::Nominal => (1.0, 1.0),
            Metric::Ordinal => (((end + middle) / 2.0).powi(2), (end + middle).powi(2)),
        };
        let observed = 2.0 * self.near * near + 2.0 * self.far * far;
        let expected = 2.0 * end * middle * near + end * end * far;
        (expected > 0.0).then(|| 1.0 - (n - 1.0) * observed / expected)
    }
}

#[cfg(test)]
mod tests;
