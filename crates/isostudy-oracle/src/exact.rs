//! Tests and corrections, by their definitions.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// A p, and what it may be rounded up to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Range {
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Range {
    /// Whether a printed p is that. What is too small for a double is printed as the least double.
    pub(crate) fn holds(&self, p: f64) -> bool {
        let least = f64::MIN_POSITIVE;
        (self.low * (1.0 - 1e-7)..=self.high * (1.0 + 1e-7)).contains(&p) || (self.low < least && p < least)
    }

    /// Adjusts several at once, by a rule under which no p falls when another rises.
    pub(crate) fn adjusted(all: &[Self], rule: impl Fn(&[f64]) -> Vec<f64>) -> Vec<Self> {
        let [low, high] =
            [|p: &Self| p.low, |p: &Self| p.high].map(|end| rule(&all.iter().map(end).collect::<Vec<_>>()));
        low.into_iter().zip(high).map(|(low, high)| Self { low, high }).collect()
    }
}

/// A fraction, in lowest terms, its denominator above zero.
pub(crate) type Ratio = (i128, i128);

pub(crate) fn ratio(numerator: i128, denominator: i128) -> Ratio {
    let divisor = common_divisor(numerator.abs(), denominator.abs());
    let sign = denominator.signum();
    (sign * numerator / divisor, sign * denominator / divisor)
}

pub(crate) fn add(a: Ratio, b: Ratio) -> Ratio {
    ratio(a.0 * b.1 + b.0 * a.1, a.1 * b.1)
}

pub(crate) fn minus(a: Ratio, b: Ratio) -> Ratio {
    add(a, (-b.0, b.1))
}

pub(crate) fn value(of: Ratio) -> f64 {
    of.0 as f64 / of.1 as f64
}

pub(crate) fn common_divisor(a: i128, b: i128) -> i128 {
    if b == 0 { a.max(1) } else { common_divisor(b, a % b) }
}

/// The program rounds scores where they have no common unit as coarse as this share of one, and its p is then an upper bound.
const COARSEST: i128 = 7_000;

/// The sum of scores is at least as far from zero as the one that was seen, over every pattern of signs.
pub(crate) fn sign_flip(scores: &[Ratio]) -> Range {
    let unit = scores.iter().fold(1, |unit, score| unit / common_divisor(unit, score.1) * score.1);
    let whole: Vec<i128> = scores.iter().map(|score| score.0 * (unit / score.1)).collect();
    let seen: i128 = whole.iter().sum::<i128>().abs();
    // Two halves of the people, each with every sum that its signs can give, ascending, and the chance of it.
    let (one, other) = whole.split_at(whole.len() / 2);
    let [one, other] =
        [one, other].map(|half| half.iter().filter(|d| **d != 0).fold(vec![(0, 1.0)], flipped));
    // Half a unit of rounding a person, twice.
    let slack = if unit > COARSEST { unit * scores.len() as i128 / COARSEST } else { 0 };
    Range { low: beyond(&one, &other, seen), high: beyond(&one, &other, (seen - slack).max(0)) }
}

/// Every sum with one more score, added and taken off.
fn flipped(sums: Vec<(i128, f64)>, score: &i128) -> Vec<(i128, f64)> {
    let by = |by: i128| sums.iter().map(move |&(sum, chance)| (sum + by, 0.5 * chance));
    let (mut less, mut more) = (by(-score.abs()).peekable(), by(score.abs()).peekable());
    let mut all: Vec<(i128, f64)> = Vec::with_capacity(2 * sums.len());
    loop {
        let (sum, chance) = match (less.peek(), more.peek()) {
            (Some(a), Some(b)) if a.0 <= b.0 => less.next(),
            (Some(_), None) => less.next(),
            (_, Some(_)) => more.next(),
            (None, None) => return all,
        }
        .expect("peeked");
        match all.last_mut() {
            Some(last) if last.0 == sum => last.1 += chance,
            _ => all.push((sum, chance)),
        }
    }
}

/// The chance that two sums together are at least so far from zero, which is the same above as below.
fn beyond(one: &[(i128, f64)], other: &[(i128, f64)], least: i128) -> f64 {
    if least == 0 {
        return 1.0;
    }
    let (mut at, mut tail, mut chance) = (other.len(), 0.0, 0.0);
    for &(sum, own) in one {
        while at > 0 && sum + other[at - 1].0 >= least {
            at -= 1;
            tail += other[at].1;
        }
        chance += own * tail;
    }
    (2.0 * chance).min(1.0)
}

/// Each p times the number of those that are not smaller, and never less than a smaller one's.
pub(crate) fn holm(p: &[f64]) -> Vec<f64> {
    let own = |of: f64| p.iter().filter(|other| **other >= of).count() as f64 * of;
    let adjusted = |of: &f64| {
        let smaller = p.iter().filter(|other| *other <= of);
        smaller.map(|&other| own(other)).fold(0.0, f64::max).min(1.0)
    };
    p.iter().map(adjusted).collect()
}

/// Each p times all of them over the number of those that are not larger, and never more than a larger one's.
pub(crate) fn benjamini_hochberg(p: &[f64]) -> Vec<f64> {
    let own = |of: f64| p.len() as f64 * of / p.iter().filter(|other| **other <= of).count() as f64;
    let adjusted = |of: &f64| {
        let larger = p.iter().filter(|other| *other >= of);
        larger.map(|&other| own(other)).fold(1.0, f64::min)
    };
    p.iter().map(adjusted).collect()
}

pub(crate) fn mean(scores: &[f64]) -> f64 {
    if scores.is_empty() { 0.0 } else { scores.iter().sum::<f64>() / scores.len() as f64 }
}

/// Standard error of a mean.
fn error(scores: &[f64]) -> f64 {
    let (n, mean) = (scores.len() as f64, mean(scores));
    (scores.iter().map(|score| (score - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt()
}

fn t(people: usize) -> StudentsT {
    StudentsT::new(0.0, 1.0, people as f64 - 1.0).expect("two people or more")
}

fn are_alike(scores: &[f64]) -> bool {
    scores.iter().all(|score| *score == scores[0])
}

/// The t interval at 95 %; none where there is no spread.
pub(crate) fn t_interval(scores: &[f64]) -> Option<[f64; 2]> {
    (scores.len() > 1 && !are_alike(scores)).then(|| {
        let half = t(scores.len()).inverse_cdf(0.975) * error(scores);
        [mean(scores) - half, mean(scores) + half]
    })
}

/// The same for scores between -`reach` and `reach`; where there is no spread, the means that would make so many equal scores
/// at least 2.5 % probable.
pub(crate) fn interval(scores: &[f64], reach: f64) -> Option<[f64; 2]> {
    if scores.len() < 2 {
        return None;
    }
    let unanimous = || {
        let root = 0.025_f64.powf(1.0 / scores.len() as f64);
        [(reach + scores[0]) * root - reach, reach - (reach - scores[0]) * root]
    };
    Some(t_interval(scores).unwrap_or_else(unanimous).map(|end| end.clamp(-reach, reach)))
}

/// Two one-sided tests of a mean within `margin` of zero.
pub(crate) fn equivalence(scores: &[f64], margin: f64, reach: f64) -> Option<f64> {
    if scores.len() < 2 {
        return None;
    }
    let one_sided = |sign: f64| {
        let own: Vec<f64> = scores.iter().map(|score| sign * score).collect();
        match own[0] {
            score if are_alike(&own) && score >= margin => 1.0,
            // The greatest chance of such scores with a mean at the margin: the others are then as far as can be.
            score if are_alike(&own) => ((reach - margin) / (reach - score)).powi(own.len() as i32),
            _ => t(own.len()).cdf((mean(&own) - margin) / error(&own)),
        }
    };
    Some(one_sided(1.0).max(one_sided(-1.0)))
}

/// The sign test: fair coins that fall at least as unevenly.
pub(crate) fn binomial(wins: u64, losses: u64) -> f64 {
    steps(wins + losses, 0.0, wins.abs_diff(losses))
}

/// The same with ties as often as they were seen.
pub(crate) fn trinomial(wins: u64, ties: u64, losses: u64) -> f64 {
    let all = wins + ties + losses;
    steps(all, ties as f64 / all.max(1) as f64, wins.abs_diff(losses))
}

/// The chance that so many steps of +1, 0, -1 lead at least so far from where they began.
fn steps(number: u64, resting: f64, far: u64) -> f64 {
    if far == 0 {
        return 1.0;
    }
    let middle = number as usize + 1;
    let mut at = vec![0.0; 2 * middle + 1];
    at[middle] = 1.0;
    for _ in 0..number {
        let step = |place: usize| {
            let from = |place: Option<usize>| place.and_then(|place| at.get(place)).copied().unwrap_or(0.0);
            let beside = from(place.checked_sub(1)) + from(Some(place + 1));
            0.5 * (1.0 - resting) * beside + resting * at[place]
        };
        at = (0..at.len()).map(step).collect();
    }
    let beyond = |place: usize| place.abs_diff(middle) as u64 >= far;
    (0..at.len()).filter(|&place| beyond(place)).map(|place| at[place]).sum::<f64>().min(1.0)
}

#[cfg(test)]
mod tests;
