//! Contrasts of a study: which answers speak for one property over another, with everything else equal.
//!
//! They follow from what the study asks alone, so linter, power and analysis count the same ones. A question counts for the
//! one factor in which its methods differ; where they differ in both, for the pair of methods.

mod families;

pub use families::{PRIMARY, TestFamily, WHOLE, families};

use crate::method::{Arrangement, Clustering, Method};
use crate::study::Study;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Objects up to which each is held against each other one: 190 pairs. Of more, correction would leave nothing, and what is to
/// be known is whether they differ at all.
pub const PAIRED_OBJECTS: usize = 20;

/// What two methods may differ in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Factor {
    /// How sample points are laid out.
    Arrangement,
    /// How vertices are merged.
    Clustering,
    /// Both at once, so that a preference can be put down to neither.
    Method,
}

/// Kinds of contrasts. Each is a family within which p is adjusted, unless the study says otherwise: [`families`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Family {
    /// Clusterings pooled over arrangements, arrangements pooled over clusterings.
    Pooled,
    /// Methods that differ in both factors.
    Methods,
    /// Clusterings within each arrangement, arrangements within each clustering.
    Groups,
    /// Levels of one factor by object.
    Objects(Factor),
    /// Whether a preference depends on the other factor: differences of two contrasts of [`Groups`](Self::Groups).
    Interactions,
    /// Whether it depends on the object: differences of two contrasts of [`Objects`](Self::Objects), where there are at most
    /// [`PAIRED_OBJECTS`]. To be read after a test over all objects.
    ObjectPairs(Factor),
}

/// One of two things compared: a value of a factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Level {
    /// How sample points are laid out.
    Arrangement(Arrangement),
    /// How vertices are merged.
    Clustering(Clustering),
    /// Both.
    Method(Method),
}

/// Over which answers a contrast goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Over {
    /// All that compare its two levels.
    All,
    /// Those where the other factor has this value.
    Within(Level),
    /// Those on one object, by index.
    Object(usize),
    /// Those where the other factor has the first value, less those where it has the second.
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
    /// What is compared, such as `U-I`; of methods, `bu-si`.
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

impl Factor {
    /// The name in files.
    pub fn code(self) -> &'static str {
        match self {
            Self::Arrangement => "arrangement",
            Self::Clustering => "clustering",
            Self::Method => "method",
        }
    }
}

impl Family {
    /// The name in files. Arrangements by object are the published ones, and have the plain name.
    pub fn code(self) -> &'static str {
        match self {
            Self::Pooled => "pooled",
            Self::Groups => "groups",
            Self::Objects(Factor::Arrangement) => "objects",
            Self::Objects(Factor::Clustering) => "objects-clustering",
            Self::Objects(Factor::Method) => "objects-method",
            Self::Interactions => "interactions",
            Self::ObjectPairs(Factor::Arrangement) => "object-pairs",
            Self::ObjectPairs(Factor::Clustering) => "object-pairs-clustering",
            Self::ObjectPairs(Factor::Method) => "object-pairs-method",
            Self::Methods => "methods",
        }
    }
}

impl Level {
    /// Whose value it is.
    pub fn factor(self) -> Factor {
        match self {
            Self::Arrangement(_) => Factor::Arrangement,
            Self::Clustering(_) => Factor::Clustering,
            Self::Method(_) => Factor::Method,
        }
    }

    /// The paper's letter, upper case; of a method, both letters, lower case.
    pub fn code(self) -> String {
        match self {
            Self::Arrangement(arrangement) => arrangement.code().to_ascii_uppercase().into(),
            Self::Clustering(clustering) => clustering.code().to_ascii_uppercase().into(),
            Self::Method(method) => method.to_string(),
        }
    }

    /// The name used in tables and figures.
    pub fn label(self) -> String {
        match self {
            Self::Arrangement(arrangement) => arrangement.label().into(),
            Self::Clustering(clustering) => clustering.label().into(),
            Self::Method(method) => method.label(),
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

    /// What else a question is about, as a number: in differences like is held against like first. Between values of the other
    /// factor that is the object; between objects it is the value of the other factor.
    pub fn stratum(&self, study: &Study, question: usize) -> usize {
        let comparison = &study.comparisons[question];
        let Method { arrangement, clustering } = comparison.left.method;
        let place = match (self.over, self.levels[0].factor()) {
            (Over::Difference(..), _) => Some(comparison.object),
            (_, Factor::Clustering) => study.file.arrangements.iter().position(|&a| a == arrangement),
            (_, Factor::Arrangement) => study.file.clusterings.iter().position(|&c| c == clustering),
            (_, Factor::Method) => None,
        };
        place.unwrap_or(0)
    }
}

/// A question, seen by the factor in which its methods differ.
struct Question {
    index: usize,
    object: usize,
    left: Level,
    right: Level,
    /// The value of the other factor; `None` where the methods differ in both.
    within: Option<Level>,
}

impl Question {
    fn of(study: &Study, index: usize) -> Self {
        let comparison = &study.comparisons[index];
        let (left, right) = (comparison.left.method, comparison.right.method);
        let (levels, within): (fn(Method) -> Level, _) =
            match (left.arrangement == right.arrangement, left.clustering == right.clustering) {
                (true, _) => {
                    (|m| Level::Clustering(m.clustering), Some(Level::Arrangement(left.arrangement)))
                }
                (_, true) => {
                    (|m| Level::Arrangement(m.arrangement), Some(Level::Clustering(left.clustering)))
                }
                _ => (Level::Method, None),
            };
        Self { index, object: comparison.object, left: levels(left), right: levels(right), within }
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
    for factor in [Factor::Clustering, Factor::Arrangement, Factor::Method] {
        let others: Vec<Level> = match factor {
            Factor::Clustering => study.file.arrangements.iter().map(|&a| Level::Arrangement(a)).collect(),
            Factor::Arrangement => study.file.clusterings.iter().map(|&c| Level::Clustering(c)).collect(),
            Factor::Method => Vec::new(),
        };
        let mut pairs: Vec<[Level; 2]> = Vec::new();
        for &Question { left, right, .. } in questions.iter().filter(|q| q.left.factor() == factor) {
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

/// The contrasts of two levels; `others` are the values of the other factor.
fn of_pair(study: &Study, questions: &[Question], levels: [Level; 2], others: &[Level]) -> Vec<Contrast> {
    let [a, b] = levels;
    let factor = a.factor();
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
            let name = format!("{}-{}", a.code(), b.code());
            let weights = weights(&parts);
            found.push(Contrast { family, name, scope, levels, over, parts, weights });
        }
    };
    let whole = if factor == Factor::Method { Family::Methods } else { Family::Pooled };
    add(whole, "all".into(), Over::All, vec![where_(&|_| true)]);

    let within = |level: Level| where_(&|q| q.within == Some(level));
    for (i, &first) in others.iter().enumerate() {
        let scope = format!("within {}", first.code());
        add(Family::Groups, scope, Over::Within(first), vec![within(first)]);
        for &second in &others[i + 1..] {
            let scope = format!("{} - {}", first.code(), second.code());
            let over = Over::Difference(first, second);
            add(Family::Interactions, scope, over, vec![within(first), within(second)]);
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
