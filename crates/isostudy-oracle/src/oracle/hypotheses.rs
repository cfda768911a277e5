//! Every contrast and every question, as the table of tests has to have them.

use super::omnibus::by_object;
use super::{Compares, Expected, Oracle, Question, Want};
use crate::exact::{
    Range, Ratio, add, benjamini_hochberg, binomial, common_divisor, equivalence, holm, interval, mean,
    minus, ratio, sign_flip, trinomial, value,
};
use crate::people::Pressed;
use isostudy_design::forms::Role;
use std::collections::{BTreeMap, BTreeSet};

/// One hypothesis.
#[derive(Debug, Clone)]
pub(crate) struct Hypothesis {
    pub(crate) family: String,
    pub(crate) contrast: String,
    pub(crate) scope: String,
    /// What is compared, such as `U` and `I`: lattices and clusterings by their letter, methods by both.
    pub(crate) levels: [String; 2],
    /// Answers for the first, for none and for the second; none of a difference.
    pub(crate) counts: Option<[u64; 3]>,
    /// By person, of those who have one.
    scores: Vec<Ratio>,
    reach: f64,
    pub(crate) p: Range,
    pub(crate) adjusted: Range,
    over_all: Option<Range>,
    equivalence: Option<f64>,
    /// Whether the preference was shown to depend on the object; `None` where rounding of p may decide.
    by_object: Option<bool>,
    /// Whether people favour a side; `None` where that is not plain to see.
    by_side: Option<bool>,
    /// Whether some pair was shown with its sides exchanged.
    alternates: bool,
    /// Whether the parts of a difference were asked about other things, of people without a thing that both parts share.
    other_things: bool,
    /// Question by sign, and by which part of a difference.
    parts: Vec<BTreeMap<usize, i64>>,
}

const MARGIN: f64 = 0.2;
const LEVEL: f64 = 0.05;

impl Hypothesis {
    /// Whether anybody has a score.
    pub(crate) fn is_tested(&self) -> bool {
        !self.scores.is_empty()
    }

    /// How many people have a score, and how many of them lean one way.
    pub(crate) fn people(&self) -> [usize; 2] {
        [self.scores.len(), self.scores.iter().filter(|score| score.0 != 0).count()]
    }

    /// What can be concluded; `None` where rounding of p may decide.
    pub(crate) fn conclusion(&self) -> Option<&'static str> {
        let differs = match self.adjusted {
            Range { high, .. } if high <= LEVEL => true,
            Range { low, .. } if low > LEVEL => false,
            _ => return None,
        };
        let [_, leaning] = self.people();
        let equal = self.equivalence.is_some_and(|p| p <= LEVEL);
        Some(match (differs, equal) {
            _ if !self.is_tested() => "not tested",
            _ if leaning == 0 => "nobody leans",
            _ if 2.0_f64.powi(1 - leaning as i32) > LEVEL => "too few",
            (false, true) if self.by_object? => "averages out",
            (false, true) if self.by_side? => "hidden by a side",
            (true, _) if !self.alternates && self.by_side? => "may be the side's",
            (true, _) if self.other_things => "parts about other things",
            (true, false) => "differs",
            (true, true) => "differs, within the margin",
            (false, true) => "equal within the margin",
            (false, false) => "open",
        })
    }
}

/// Every contrast that can be asked of the questions, then every question.
pub(crate) fn hypotheses(oracle: &Oracle<'_>) -> Vec<Hypothesis> {
    let mut all = contrasts(oracle);
    let families: Vec<String> = all.iter().map(|of| of.family.clone()).collect();
    for family in families {
        let mut own: Vec<&mut Hypothesis> = all.iter_mut().filter(|of| of.family == family).collect();
        correct(&mut own, holm);
    }
    let tested: Vec<usize> = (0..all.len()).filter(|&i| all[i].is_tested()).collect();
    let p: Vec<Range> = tested.iter().map(|&i| all[i].p).collect();
    tested.iter().zip(Range::adjusted(&p, holm)).for_each(|(&i, p)| all[i].over_all = Some(p));
    mark_by_object(oracle, &mut all);
    let mut single: Vec<Hypothesis> = (0..oracle.questions.len()).map(|q| of_question(oracle, q)).collect();
    correct(&mut single.iter_mut().collect::<Vec<_>>(), benjamini_hochberg);
    all.extend(single);
    let by_side = is_side_favoured(oracle);
    let alternates = lefts(oracle).values().any(|lefts| lefts.len() > 1);
    all.iter_mut().for_each(|of| (of.by_side, of.alternates) = (by_side, alternates));
    all
}

/// By question, what stood on the left.
fn lefts<'a>(oracle: &'a Oracle<'_>) -> BTreeMap<usize, BTreeSet<&'a str>> {
    let mut lefts: BTreeMap<usize, BTreeSet<&str>> = BTreeMap::new();
    for &(question, given) in oracle.comparisons.iter().flatten() {
        lefts.entry(question).or_default().insert(given.left());
    }
    lefts
}

/// Whether a side is favoured, where it is plain: everybody always took the same side of pairs that were shown in both orders; or answers
/// fall about evenly on both; or no pair was shown in both orders.
fn is_side_favoured(oracle: &Oracle<'_>) -> Option<bool> {
    let alternate = lefts(oracle).values().any(|lefts| lefts.len() > 1);
    let count = |pressed| oracle.given.iter().filter(|of| of.pressed == pressed).count() as f64;
    let [left, right] = [Pressed::Left, Pressed::Right].map(count);
    match left / (left + right) {
        _ if !alternate && oracle.given.iter().all(|of| of.shown.role == Role::Comparison) => Some(false),
        _ if left + right == 0.0 => Some(false),
        share if alternate && (share == 0.0 || share == 1.0) => Some(true),
        // Whoever decides between equals may do so by the side.
        _ if oracle
            .given
            .iter()
            .any(|of| of.shown.role == Role::Control && of.pressed != Pressed::Neither) =>
        {
            None
        }
        _ if (left - right).abs() <= 1.5 * (left + right).sqrt() => Some(false),
        _ => None,
    }
}

/// Whether Friedman's test over objects, or a pair of objects, shows that a preference depends on the object.
fn mark_by_object(oracle: &Oracle<'_>, all: &mut [Hypothesis]) {
    let omnibus = by_object(oracle);
    let pairs: Vec<([String; 2], Range)> = all
        .iter()
        .filter(|of| of.family.starts_with("object-pairs") && of.is_tested())
        .map(|of| (of.levels.clone(), of.adjusted))
        .collect();
    for of in all.iter_mut() {
        let objects = of.family.starts_with("object") || of.parts.len() > 1;
        let own = || pairs.iter().filter(|(levels, _)| *levels == of.levels);
        let ranked = omnibus.iter().any(|(levels, p)| *levels == of.levels && *p <= LEVEL);
        of.by_object = match () {
            () if objects => Some(false),
            () if ranked || own().any(|(_, p)| p.high <= LEVEL) => Some(true),
            () if own().any(|(_, p)| p.low <= LEVEL) => None,
            () => Some(false),
        };
    }
}

/// Corrects a family; what nobody answered is no test of it.
fn correct(family: &mut [&mut Hypothesis], rule: fn(&[f64]) -> Vec<f64>) {
    let mut tested: Vec<&mut &mut Hypothesis> = family.iter_mut().filter(|of| of.is_tested()).collect();
    let p: Vec<Range> = tested.iter().map(|of| of.p).collect();
    tested.iter_mut().zip(Range::adjusted(&p, rule)).for_each(|(of, p)| of.adjusted = p);
    let alike = |of: &Hypothesis| {
        let scores: Vec<f64> = of.scores.iter().map(|score| value(*score)).collect();
        equivalence(&scores, MARGIN, of.reach)
    };
    let alike: Vec<Option<f64>> = tested.iter().map(|of| alike(of)).collect();
    let mut adjusted = rule(&alike.iter().flatten().copied().collect::<Vec<_>>()).into_iter();
    for (of, p) in tested.iter_mut().zip(alike) {
        of.equivalence = p.and_then(|_| adjusted.next());
    }
}

fn contrasts(oracle: &Oracle<'_>) -> Vec<Hypothesis> {
    let seen: Vec<&Compares> = oracle.questions.iter().map(|question| &question.compared).collect();
    let mut all: Vec<(usize, Hypothesis)> = Vec::new();
    for factor in ["clustering", "arrangement", "method"] {
        let mut pairs: Vec<[String; 2]> = Vec::new();
        for [a, b] in seen.iter().filter(|own| own.factor == factor).map(|own| &own.levels) {
            if !pairs.iter().any(|[x, y]| [x, y] == [a, b] || [y, x] == [a, b]) {
                pairs.push([a.clone(), b.clone()]);
            }
        }
        let others: Vec<String> = match factor {
            "clustering" => oracle.lattices.iter().map(|letter| letter.to_uppercase().to_string()).collect(),
            "arrangement" => {
                oracle.clusterings.iter().map(|letter| letter.to_uppercase().to_string()).collect()
            }
            _ => Vec::new(),
        };
        for levels in pairs {
            let part = |kept: &dyn Fn(usize) -> bool| -> BTreeMap<usize, i64> {
                let sign = |q: usize| match &seen[q].levels {
                    own if *own == levels => Some((q, 1)),
                    [a, b] if [b, a] == [&levels[0], &levels[1]] => Some((q, -1)),
                    _ => None,
                };
                (0..seen.len()).filter(|&q| seen[q].factor == factor && kept(q)).filter_map(sign).collect()
            };
            let mut add = |rank: usize, family: &str, scope: String, parts: Vec<BTreeMap<usize, i64>>| {
                if parts.iter().all(|part| !part.is_empty()) {
                    all.push((rank, tested(oracle, family.into(), scope, &levels, parts)));
                }
            };
            let kind = match factor {
                "arrangement" => String::new(),
                other => format!("-{other}"),
            };
            let whole = if factor == "method" { (1, "methods") } else { (0, "pooled") };
            add(whole.0, whole.1, "all".into(), vec![part(&|_| true)]);
            let within = |other: &String| part(&|q| seen[q].within.as_ref() == Some(other));
            for (i, other) in others.iter().enumerate() {
                add(2, "groups", format!("within {other}"), vec![within(other)]);
                for another in &others[i + 1..] {
                    let parts = vec![within(other), within(another)];
                    add(4, "interactions", format!("{other} - {another}"), parts);
                }
            }
            let on = |object: usize| part(&|q| oracle.questions[q].object == object);
            for (i, object) in oracle.objects.iter().enumerate() {
                add(3, &format!("objects{kind}"), object.clone(), vec![on(i)]);
                for (j, another) in oracle.objects.iter().enumerate().skip(i + 1) {
                    let parts = vec![on(i), on(j)];
                    add(5, &format!("object-pairs{kind}"), format!("{object} - {another}"), parts);
                }
            }
        }
    }
    // The plainer hypothesis first; what asks the same of the same answers again is not tested again.
    all.sort_by_key(|(rank, _)| *rank);
    let mut known: Vec<Vec<(usize, i128)>> = Vec::new();
    all.retain(|(_, of)| {
        let own = up_to_sign_and_scale(&of.parts);
        let new = !known.contains(&own);
        known.push(own);
        new
    });
    all.into_iter().map(|(_, of)| of).collect()
}

/// How much each answer weighs, the first weight above zero and all of them without a common divisor.
fn up_to_sign_and_scale(parts: &[BTreeMap<usize, i64>]) -> Vec<(usize, i128)> {
    let sizes: Vec<i128> = parts.iter().map(|part| part.len() as i128).collect();
    let mut weights: BTreeMap<usize, i128> = BTreeMap::new();
    for (place, part) in parts.iter().enumerate() {
        let other = sizes.get(1 - place).copied().unwrap_or(1);
        for (&question, &sign) in part {
            weights.insert(question, i128::from(sign) * other * if place == 0 { 1 } else { -1 });
        }
    }
    let divisor = weights.values().fold(0, |divisor, weight| common_divisor(weight.abs(), divisor)).max(1);
    let sign = weights.values().next().map_or(1, |first| first.signum());
    weights.into_iter().map(|(question, weight)| (question, sign * weight / divisor)).collect()
}

/// Net and number of one person's answers to some questions.
fn net(own: &[(usize, i64)], part: &BTreeMap<usize, i64>, meant: impl Fn(usize) -> bool) -> Option<Ratio> {
    let own: Vec<i64> = own
        .iter()
        .filter(|(q, _)| meant(*q))
        .filter_map(|(q, said)| part.get(q).map(|sign| sign * said))
        .collect();
    (!own.is_empty()).then(|| ratio(own.iter().sum::<i64>().into(), own.len() as i128))
}

/// A person's score: one mean, or the difference of two, taken where both were answered.
fn score(own: &[(usize, i64)], parts: &[BTreeMap<usize, i64>], strata: &[usize]) -> Option<Ratio> {
    let [first, second] = parts else { return net(own, &parts[0], |_| true) };
    let in_both = (0..strata.len()).filter_map(|stratum| {
        let of = |part| net(own, part, |q| strata[q] == stratum);
        Some(minus(of(first)?, of(second)?))
    });
    let both: Vec<Ratio> = in_both.collect();
    if both.is_empty() {
        return Some(minus(net(own, first, |_| true)?, net(own, second, |_| true)?));
    }
    let (numerator, denominator) = both.iter().fold((0, 1), |sum, one| add(sum, *one));
    Some(ratio(numerator, denominator * both.len() as i128))
}

/// Objects are compared value by value of the other thing, everything else object by object.
fn stratum(question: &Question, of_objects: bool) -> String {
    if of_objects {
        question.compared.within.clone().unwrap_or_default()
    } else {
        question.object_name.clone()
    }
}

/// Whether two parts' answers, of people who have both and no stratum with both, lie in other strata: a tenth of one part's answers
/// would have to be about other strata to be spread as the other's.
fn are_about_other_things(
    people: &[Vec<(usize, i64)>],
    parts: &[BTreeMap<usize, i64>],
    strata: &[usize],
) -> bool {
    let [first, second] = parts else { return false };
    let mut answers: [BTreeMap<usize, f64>; 2] = Default::default();
    for own in people {
        let of = |part: &BTreeMap<usize, i64>| -> Vec<usize> {
            own.iter().filter(|(q, _)| part.contains_key(q)).map(|(q, _)| strata[*q]).collect()
        };
        let both = [of(first), of(second)];
        let is_whole = both.iter().all(|of| !of.is_empty());
        if is_whole && !both[0].iter().any(|stratum| both[1].contains(stratum)) {
            for (sum, of) in answers.iter_mut().zip(both) {
                of.into_iter().for_each(|stratum| *sum.entry(stratum).or_default() += 1.0);
            }
        }
    }
    let [a, b] = answers.each_ref().map(|of| of.values().sum::<f64>());
    let share = |of: &BTreeMap<usize, f64>, stratum, all: f64| of.get(&stratum).map_or(0.0, |n| n / all);
    // What the first has more of, over all strata: half of the sum of all differences.
    let more = |stratum: &usize| share(&answers[0], *stratum, a) - share(&answers[1], *stratum, b);
    answers[0].keys().map(|stratum| more(stratum).max(0.0)).sum::<f64>() > 0.1
}

fn tested(
    oracle: &Oracle<'_>,
    family: String,
    scope: String,
    levels: &[String; 2],
    parts: Vec<BTreeMap<usize, i64>>,
) -> Hypothesis {
    let said = |&(q, given): &(usize, &super::Given)| {
        let sign = given.chosen().map_or(0, |chosen| if chosen == oracle.questions[q].left { 1 } else { -1 });
        (q, sign)
    };
    let people: Vec<Vec<(usize, i64)>> =
        oracle.comparisons.iter().map(|own| own.iter().map(said).collect()).collect();
    let of_objects = family.starts_with("object-pairs");
    let names: Vec<String> = oracle.questions.iter().map(|q| stratum(q, of_objects)).collect();
    // A stratum has the number of the first question in it.
    let strata: Vec<usize> =
        names.iter().map(|name| names.iter().position(|own| own == name).unwrap_or(0)).collect();
    let scores: Vec<Ratio> = people.iter().filter_map(|own| score(own, &parts, &strata)).collect();
    let mut counts = [0; 3];
    for (q, said) in people.iter().flatten() {
        if let Some(sign) = parts[0].get(q) {
            counts[(1 - sign * said) as usize] += 1;
        }
    }
    let p = sign_flip(&scores);
    let other_things = are_about_other_things(&people, &parts, &strata);
    Hypothesis {
        other_things,
        contrast: format!("{}-{}", levels[0], levels[1]),
        levels: levels.clone(),
        reach: parts.len() as f64,
        counts: (parts.len() == 1).then_some(counts),
        adjusted: Range { low: 1.0, high: 1.0 },
        over_all: None,
        equivalence: None,
        by_object: Some(false),
        by_side: Some(false),
        alternates: true,
        family,
        scope,
        scores,
        p,
        parts,
    }
}

fn of_question(oracle: &Oracle<'_>, question: usize) -> Hypothesis {
    let of = &oracle.questions[question];
    let levels = [of.left.clone(), of.right.clone()];
    tested(oracle, "questions".into(), of.id.clone(), &levels, vec![BTreeMap::from([(question, 1)])])
}

const COLUMNS: &[&str] = &[
    "first",
    "no_preference",
    "second",
    "net",
    "participants",
    "p_sign_flip",
    "p_adjusted",
    "adjustment",
    "p_adjusted_over_all",
    "mean",
    "low",
    "high",
    "p_equivalence",
    "conclusion",
    "p_without_one_low",
    "p_without_one_high",
    "p_binomial",
    "p_trinomial",
];

/// The table of tests. `thorough`: with everybody left out in turn, which takes long.
pub(super) fn expected(oracle: &Oracle<'_>, thorough: bool) -> Expected {
    let mut table = Expected::new("tests", &["family", "contrast", "scope"], COLUMNS);
    for of in hypotheses(oracle) {
        let is_question = of.family == "questions";
        let count = |place: usize| of.counts.map_or(Want::Empty, |counts| Want::count(counts[place]));
        let scores: Vec<f64> = of.scores.iter().map(|score| value(*score)).collect();
        let ends = interval(&scores, of.reach);
        let without = match (thorough, of.scores.len()) {
            (false, _) => [Want::Any, Want::Any],
            (true, 0 | 1) => [Want::Empty, Want::Empty],
            _ => without_one(&of.scores).map(Want::Between),
        };
        let [without_low, without_high] = without;
        let rule = if is_question { "Benjamini-Hochberg" } else { "Holm" };
        table.push(
            [&of.family, &of.contrast, &of.scope],
            vec![
                count(0),
                count(1),
                count(2),
                of.counts.map_or(Want::Empty, |[a, _, b]| Want::Is((a as i64 - b as i64).to_string())),
                Want::Is(of.scores.len().to_string()),
                Want::Between(of.p),
                Want::Between(of.adjusted),
                if of.is_tested() { Want::Is(rule.into()) } else { Want::Any },
                Want::range(of.over_all),
                Want::Near(mean(&scores)),
                Want::number(ends.map(|ends| ends[0])),
                Want::number(ends.map(|ends| ends[1])),
                of.equivalence.map_or(Want::Empty, Want::p),
                of.conclusion().map_or(Want::Any, |said| Want::Is(said.into())),
                without_low,
                without_high,
                of.counts.map_or(Want::Empty, |[a, _, b]| Want::p(binomial(a, b))),
                of.counts
                    .filter(|_| is_question)
                    .map_or(Want::Empty, |[a, t, b]| Want::p(trinomial(a, t, b))),
            ],
        );
    }
    table
}

/// The smallest and the largest p with each person in turn left out.
fn without_one(scores: &[Ratio]) -> [Range; 2] {
    let mut kinds = scores.to_vec();
    kinds.sort_unstable();
    kinds.dedup();
    let without = |kind: &Ratio| {
        let place = scores.iter().position(|score| score == kind).expect("one of them");
        let mut others = scores.to_vec();
        others.remove(place);
        sign_flip(&others)
    };
    let all: Vec<Range> = kinds.iter().map(without).collect();
    let end =
        |of: fn(&Range) -> f64, pick: fn(f64, f64) -> f64| all.iter().map(of).reduce(pick).unwrap_or(1.0);
    [f64::min, f64::max].map(|pick| Range { low: end(|p| p.low, pick), high: end(|p| p.high, pick) })
}
