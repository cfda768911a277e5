//! Contrasts of a study: which answers speak for one property over another, with everything else equal.
//!
//! They follow from what the study asks alone, so linter, power and analysis count the same ones. A question counts for the
//! one declared factor in which its methods differ; where they differ in several or in none, for the pair of methods.

mod families;

pub use families::{PRIMARY, TestFamily, WHOLE, families};

use crate::method::{Factor, Level};
use crate::study::Study;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Objects up to which each is held against each other one: 190 pairs. Of more, correction would leave nothing, and what is to
/// be known is whether they differ at all.
pub const PAIRED_OBJECTS: usize = 20;

/// Kinds of contrasts. Each is a family within which p is adjusted, unless the study says otherwise: [`families`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Family {
    /// Levels of one factor, pooled over all others.
    Pooled,
    /// Methods that differ in several factors, or in none that is declared.
    Methods,
    /// Levels of one factor within each level of another.
    Groups,
    /// Levels of one factor by object.
    Objects(Factor),
    /// Whether a preference depends on another factor: differences of two contrasts of [`Groups`](Self::Groups).
    Interactions,
    /// Whether it depends on the object: differences of two contrasts of [`Objects`](Self::Objects), where there are at most
    /// [`PAIRED_OBJECTS`]. To be read after a test over all objects.
    ObjectPairs(Factor),
}

/// Over which answers a contrast goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Over {
    /// All that compare its two levels.
    All,
    /// Those where another factor has this value.
    Within(Level),
    /// Those on one object, by index.
    Object(usize),
    /// Those where another factor has the first value, less those where it has the second.
    Difference(Level, Level),
    /// Those on the first object, less those on the second, by index.
    ObjectDifference(usize, usize),
}

/// One hypothesis: a weighted sum of answers has mean zero.
///
/// Signs and weights are for the left side *as the study lists it*: 1 where the first level is listed on the left, -1 where it
/// is listed on the right.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Contrast {
    /// Its kind.
    pub family: Family,
    /// The kind's name in files, such as `pooled`.
    pub family_name: String,
    /// What is compared, such as `U-I`; of methods, `bu-si`. Where a code has a hyphen of its own, a colon is between them.
    pub name: String,
    /// Over which answers, such as `all`, `within B`, `sphere`, `B - S`, `sphere - bunny`.
    pub scope: String,
    /// What is compared: the level that counts as positive, and the other.
    pub levels: [Level; 2],
    /// Over which answers.
    pub over: Over,
    /// One part, or two of a difference, none of them empty: question index to sign.
    pub parts: Vec<BTreeMap<usize, i64>>,
    /// Question index to weight: the sign; in a difference whole multiples of it, such that both parts weigh the same and the second
    /// counts against the first.
    pub weights: BTreeMap<usize, i64>,
}

impl Family {
    /// The name in files.
    fn name(self, study: &Study) -> String {
        let by_object = |kind: &str, factor| format!("{kind}{}", study.factor(factor).suffix);
        match self {
            Self::Pooled => "pooled".into(),
            Self::Groups => "groups".into(),
            Self::Objects(factor) => by_object("objects", factor),
            Self::Interactions => "interactions".into(),
            Self::ObjectPairs(factor) => by_object("object-pairs", factor),
            Self::Methods => "methods".into(),
        }
    }
}

/// Name and scope as in [`AnalysisSection::primary`](crate::config::AnalysisSection::primary): `B-S` over all answers, else
/// `B-S within U`.
impl fmt::Display for Contrast {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.over {
            Over::All => f.write_str(&self.name),
            _ => write!(f, "{} {}", self.name, self.scope),
        }
    }
}

impl Contrast {
    /// Whether it is a difference of two mean scores.
    pub fn is_difference(&self) -> bool {
        self.parts.len() > 1
    }

    /// Whether somebody who answered these questions counts: they must have answered at least one of each part.
    pub fn counts(&self, answered: impl Fn(usize) -> bool) -> bool {
        self.parts.iter().all(|part| part.keys().any(|&question| answered(question)))
    }

    /// What else a question is about, as a number: in differences like is held against like first. Between values of another
    /// factor that is the object; between objects it is the values of the other factors.
    pub fn stratum(&self, study: &Study, question: usize) -> usize {
        let comparison = &study.comparisons[question];
        if let Over::Difference(..) = self.over {
            return comparison.object;
        }
        let factor = self.levels[0].factor;
        if factor == study.method_factor() {
            return 0;
        }
        let others = study.declared_factors().filter(|other| *other != factor);
        others.fold(0, |place, other| {
            let level = study.level_of(comparison.left.method, other);
            place * study.factor(other).levels.len() + level.map_or(0, |level| level.index)
        })
    }
}

/// A question, seen by the factor in which its methods differ.
struct Question {
    index: usize,
    object: usize,
    left: Level,
    right: Level,
    /// The values of the declared factors in which they do not differ; none where they are compared as methods.
    within: Vec<Level>,
}

impl Question {
    fn of(study: &Study, index: usize) -> Self {
        let comparison = &study.comparisons[index];
        let (left, right) = (comparison.left.method, comparison.right.method);
        let factor = study.difference(left, right);
        let others = study.declared_factors().filter(|other| *other != factor);
        let within = match factor == study.method_factor() {
            true => Vec::new(),
            false => others.filter_map(|other| study.level_of(left, other)).collect(),
        };
        let [left, right] = [left, right].map(|method| {
            study.level_of(method, factor).expect("methods that differ in a factor have a level of it")
        });
        Self { index, object: comparison.object, left, right, within }
    }
}

/// Every contrast that the study's questions allow, by family, then in the study's order. No two are the same hypothesis:
/// of those whose weights differ in sign or scale alone, such as `all` and `within B` in a study of one arrangement, the first
/// stays.
///
/// `A-B` counts answers for A as positive; A is what a question lists on the left first.
pub fn contrasts(study: &Study) -> Vec<Contrast> {
    let questions: Vec<Question> = (0..study.comparisons.len()).map(|q| Question::of(study, q)).collect();
    let mut found = Vec::new();
    // The factor that changes fastest from method to method first; the factor `method` last.
    for factor in study.declared_factors().rev().chain([study.method_factor()]) {
        let others: Vec<Vec<Level>> = match factor == study.method_factor() {
            true => Vec::new(),
            false => study.declared_factors().filter(|o| *o != factor).map(|o| study.levels(o)).collect(),
        };
        let mut pairs: Vec<[Level; 2]> = Vec::new();
        for &Question { left, right, .. } in questions.iter().filter(|q| q.left.factor == factor) {
            if !pairs.contains(&[left, right]) && !pairs.contains(&[right, left]) {
                pairs.push([left, right]);
            }
        }
        for levels in pairs {
            found.extend(of_pair(study, &questions, levels, &others));
        }
    }
    found.sort_by_key(|contrast| contrast.family);
    let mut known = BTreeSet::new();
    found.retain(|contrast| known.insert(up_to_sign_and_scale(&contrast.weights)));
    found
}

/// The contrasts of two levels; `others` are the values of each other declared factor.
fn of_pair(
    study: &Study,
    questions: &[Question],
    levels: [Level; 2],
    others: &[Vec<Level>],
) -> Vec<Contrast> {
    let [a, b] = levels;
    let factor = a.factor;
    let code = |level: Level| study.level(level).code.as_str();
    let where_ = |kept: &dyn Fn(&Question) -> bool| -> BTreeMap<usize, i64> {
        let sign = |q: &Question| match (q.left, q.right) {
            (left, right) if (left, right) == (a, b) => Some((q.index, 1)),
            (left, right) if (left, right) == (b, a) => Some((q.index, -1)),
            _ => None,
        };
        questions.iter().filter(|q| kept(q)).filter_map(sign).collect()
    };
    let mut found = Vec::new();
    let mut add = |family, scope: String, over, parts: Vec<BTreeMap<usize, i64>>| {
        if parts.iter().all(|part| !part.is_empty()) {
            let between = if code(a).contains('-') || code(b).contains('-') { ':' } else { '-' };
            let name = format!("{}{between}{}", code(a), code(b));
            let (family_name, weights) = (Family::name(family, study), weights(&parts));
            found.push(Contrast { family, family_name, name, scope, levels, over, parts, weights });
        }
    };
    let whole = if factor == study.method_factor() { Family::Methods } else { Family::Pooled };
    add(whole, "all".into(), Over::All, vec![where_(&|_| true)]);

    let within = |level: Level| where_(&|q| q.within.contains(&level));
    for others in others {
        for (i, &first) in others.iter().enumerate() {
            let scope = format!("within {}", code(first));
            add(Family::Groups, scope, Over::Within(first), vec![within(first)]);
            for &second in &others[i + 1..] {
                let scope = format!("{} - {}", code(first), code(second));
                let over = Over::Difference(first, second);
                add(Family::Interactions, scope, over, vec![within(first), within(second)]);
            }
        }
    }

    let on: Vec<(usize, &str, BTreeMap<usize, i64>)> = (study.file.objects.iter().enumerate())
        .map(|(i, object)| (i, object.name.as_str(), where_(&|q| q.object == i)))
        .filter(|(.., part)| !part.is_empty())
        .collect();
    for (n, (i, name, part)) in on.iter().enumerate() {
        add(Family::Objects(factor), (*name).to_owned(), Over::Object(*i), vec![part.clone()]);
        let others = if on.len() <= PAIRED_OBJECTS { &on[n + 1..] } else { &[] };
        for (j, other, second) in others {
            let over = Over::ObjectDifference(*i, *j);
            let parts = vec![part.clone(), second.clone()];
            add(Family::ObjectPairs(factor), format!("{name} - {other}"), over, parts);
        }
    }
    found
}

/// Of one part its signs; of two the first mean less the second, in whole numbers.
fn weights(parts: &[BTreeMap<usize, i64>]) -> BTreeMap<usize, i64> {
    let [first, second] = parts else { return parts.iter().flatten().map(|(&q, &sign)| (q, sign)).collect() };
    let (n, m) = (first.len() as i64, second.len() as i64);
    let divisor = common_divisor(n, m);
    let plus = first.iter().map(|(&q, &sign)| (q, sign * m / divisor));
    plus.chain(second.iter().map(|(&q, &sign)| (q, -sign * n / divisor))).collect()
}

/// The same for two sums of answers of which one is a multiple of the other.
fn up_to_sign_and_scale(weights: &BTreeMap<usize, i64>) -> Vec<(usize, i64)> {
    let divisor = weights.values().fold(0, |divisor, &weight| common_divisor(divisor, weight.abs())).max(1);
    let sign = weights.values().next().map_or(1, |first| first.signum());
    weights.iter().map(|(&q, &weight)| (q, sign * weight / divisor)).collect()
}

fn common_divisor(a: i64, b: i64) -> i64 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

#[cfg(test)]
mod tests;
