//! Sentences of tests of preference.

use crate::statement::{Finding, Standing};
use crate::words::{against, capital, counted, interval, number, p};
use isostudy_inference::hypotheses::{Conclusion, Hypothesis, Target};
use isostudy_statistics::ScoreTest;
use isostudy_statistics::interval::{Interval, unanimous};

impl Finding {
    /// Whether the first was preferred to the second; `scope` says over which answers, with a space before it.
    pub(super) fn of_preference(hypothesis: &Hypothesis, first: &str, second: &str, scope: &str) -> Self {
        let (test, margin) = (&hypothesis.test, hypothesis.rules.margin);
        let counts = test.counts.unwrap_or_default();
        // A name that somebody gave stays as it is, at the head of a sentence too.
        let opening = |name: &str| match hypothesis.target {
            Target::Items { .. } => name.to_owned(),
            _ => capital(name),
        };
        let towards_first = test.mean >= 0.0;
        let [winner, loser] = if towards_first { [first, second] } else { [second, first] };
        let [a, ties, b] = counts;
        let turned = if towards_first { counts } else { [b, ties, a] };
        let (score, tested) = (score(test, towards_first), tested(hypothesis));
        match hypothesis.conclusion() {
            Conclusion::Differs => {
                let text = format!(
                    "{} was preferred to {loser}{scope}: {}. {score}; {tested}.{}",
                    opening(winner),
                    against(turned),
                    over_all(hypothesis)
                );
                Self::new(Standing::Holds, text)
            }
            Conclusion::DiffersWithinMargin => {
                let text = format!(
                    "{} was preferred to {loser}{scope}, but by little: {}. {score}; {tested}. The mean lies within \
                     {margin} of none ({}).{}",
                    opening(winner),
                    against(turned),
                    equivalence(hypothesis),
                    over_all(hypothesis)
                );
                Self::new(Standing::Holds, text)
            }
            Conclusion::Equal => {
                // Names stand in the order of the contrast, and so do counts and score.
                let text = format!(
                    "{} and {second}{scope} are liked alike, within the margin of {margin}: {}. {}; {}; \
                     {tested}.",
                    opening(first),
                    against(counts),
                    self::score(test, true),
                    equivalence(hypothesis)
                );
                Self::new(Standing::Equal, text)
            }
            // A mean of opposite preferences says nothing about any object.
            Conclusion::AveragesOut => {
                let text = format!(
                    "{} and {second}{scope} average out within the margin of {margin}: {}. {}; {}; {tested}. That does not \
                     say that they are liked alike.",
                    opening(first),
                    against(counts),
                    self::score(test, true),
                    equivalence(hypothesis)
                );
                Self::new(Standing::Open, text)
            }
            Conclusion::HiddenBySide => {
                let text = format!(
                    "{} and {second}{scope} average out within the margin of {margin}: {}. {}; {}; {tested}. People favour a \
                     side, and who answers by the side hides what is preferred. So that does not say that they are liked alike.",
                    opening(first),
                    against(counts),
                    self::score(test, true),
                    equivalence(hypothesis)
                );
                Self::new(Standing::Open, text)
            }
            Conclusion::NobodyLeans => {
                let text = format!(
                    "{} against {second}{scope}: nobody leans either way ({}), so no test has anything to work on.",
                    opening(first),
                    against(counts)
                );
                Self::new(Standing::Open, text)
            }
            Conclusion::TooFew => {
                let leaning = test.leaning();
                let lean = if leaning == 1 { "leans" } else { "lean" };
                let text = format!(
                    "{} against {second}{scope} is not decided: {}. {} {lean} one way or the other, and no outcome of so \
                     few is significant (exact sign-flip test, smallest possible {}).",
                    opening(first),
                    against(counts),
                    capital(&counted(leaning, "participant")),
                    p(hypothesis.least_possible())
                );
                Self::new(Standing::TooFew, text)
            }
            Conclusion::Open | Conclusion::NotTested => {
                let alone = match test.sign_flip.p() <= hypothesis.rules.level {
                    true => " As the only test it would have passed; among so many it does not.",
                    false => "",
                };
                let text = format!(
                    "{} and {second}{scope} cannot be distinguished here: {}. {}; {tested}.{alone}{}",
                    opening(first),
                    against(counts),
                    self::score(test, true),
                    not_equal(test)
                );
                Self::new(Standing::Open, text)
            }
        }
    }
}

/// `Mean score 0.17 (95 % t interval 0.06 to 0.29, 18 participants)`, turned round for the second.
pub(super) fn score(test: &ScoreTest, towards_first: bool) -> String {
    let sign = if towards_first { 1.0 } else { -1.0 };
    let people = counted(test.participants(), "participant");
    let turned = test.interval.map(|i| i.cut(-test.reach, test.reach)).map(|i| match towards_first {
        true => i,
        false => Interval { low: -i.high, high: -i.low },
    });
    let kind = if unanimous(&test.scores()).is_some() { "interval" } else { "t interval" };
    let within = turned.map_or(people.clone(), |i| format!("95 % {kind} {}, {people}", interval(i, 2)));
    format!("Mean score {} ({within})", number(sign * test.mean, 2))
}

/// `exact sign-flip test, p = 0.0094, p = 0.028 after Holm's correction for 4 tests`.
pub(super) fn tested(hypothesis: &Hypothesis) -> String {
    let alone = format!("exact sign-flip test, {}", p(hypothesis.test.sign_flip.p()));
    match hypothesis.family_size {
        0 | 1 => alone,
        size => {
            let (adjusted, rule) = (p(hypothesis.adjusted), hypothesis.adjustment.possessive());
            format!("{alone}, {adjusted} after {rule} correction for {size} tests")
        }
    }
}

fn equivalence(hypothesis: &Hypothesis) -> String {
    let p = p(hypothesis.equivalence.unwrap_or(1.0));
    match hypothesis.family_size {
        0 | 1 => format!("two one-sided t tests, {p}"),
        _ => format!("two one-sided t tests, {p} after correction"),
    }
}

/// What one correction over all tests makes of a result, where that is another.
pub(super) fn over_all(hypothesis: &Hypothesis) -> String {
    match hypothesis.adjusted_over_all {
        Some(over_all) if over_all > hypothesis.rules.level => {
            format!(" With one correction over all tests it does not hold ({}).", p(over_all))
        }
        _ => String::new(),
    }
}

/// How large a preference is not ruled out.
fn not_equal(test: &ScoreTest) -> String {
    let Some(i) = test.interval else { return " Not significant is not equal.".into() };
    let room = |end: f64| number(end.abs().min(1.0), 2);
    match (i.low < 0.0, i.high > 0.0) {
        (true, true) => format!(
            " Not significant is not equal: a mean score of up to {} for the one or {} for the other remains possible.",
            room(i.high),
            room(i.low)
        ),
        _ => {
            " Not significant is not equal: the interval leaves zero out, the corrected test does not.".into()
        }
    }
}
