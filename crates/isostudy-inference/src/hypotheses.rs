//! Every hypothesis that is tested, with p adjusted within its family.

use crate::ballots::BallotGroup;
use crate::omnibus::{self, Omnibus};
use isostudy_design::Level;
use isostudy_design::Study;
use isostudy_design::config::AnalysisSection;
use isostudy_design::contrast::{Contrast, Over, PRIMARY, contrasts, families};
use isostudy_statistics::bootstrap::Resampling;
use isostudy_statistics::interval::Interval;
use isostudy_statistics::sign_test;
use isostudy_statistics::{DeclaredBallot, Look, MARGIN, ScoreTest, benjamini_hochberg, holm};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// How p values of a family are adjusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Adjustment {
    /// Against any false rejection in the family.
    Holm,
    /// Against too large a share of false rejections: for what is exploratory.
    BenjaminiHochberg,
}

impl Adjustment {
    /// For people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Holm => "Holm",
            Self::BenjaminiHochberg => "Benjamini-Hochberg",
        }
    }

    /// Whose correction it is.
    pub fn possessive(self) -> &'static str {
        match self {
            Self::Holm => "Holm's",
            Self::BenjaminiHochberg => "Benjamini and Hochberg's",
        }
    }

    fn of(self, p: &[f64]) -> Vec<f64> {
        match self {
            Self::Holm => holm(p),
            Self::BenjaminiHochberg => benjamini_hochberg(p),
        }
    }
}

/// What both adjusted p allow to say, at the level of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Conclusion {
    /// There is a preference.
    Differs,
    /// There is one, and it is smaller than the margin.
    DiffersWithinMargin,
    /// If there is one, it is smaller than the margin.
    Equal,
    /// The mean is smaller than the margin, and the preference depends on the object: opposite ones may have such a mean.
    AveragesOut,
    /// The mean is smaller than the margin, and people favour a side: who answers by the side hides what is preferred.
    HiddenBySide,
    /// A preference was shown, people favour a side, and nothing was shown on both sides: the side may have made it.
    MayBeSide,
    /// There is a difference of two preferences, and the one part was asked about other things than the other, which may make it.
    OtherParts,
    /// Neither can be said.
    Open,
    /// No outcome of so few participants who lean one way or the other could have shown anything.
    TooFew,
    /// Nobody leans one way or the other.
    NobodyLeans,
    /// Nobody has a score: nobody answered what it is about.
    NotTested,
}

impl Conclusion {
    /// For people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Differs => "differs",
            Self::DiffersWithinMargin => "differs, within the margin",
            Self::Equal => "equal within the margin",
            Self::AveragesOut => "averages out",
            Self::HiddenBySide => "hidden by a side",
            Self::MayBeSide => "may be the side's",
            Self::OtherParts => "parts about other things",
            Self::Open => "open",
            Self::TooFew => "too few",
            Self::NobodyLeans => "nobody leans",
            Self::NotTested => "not tested",
        }
    }
}

/// Parts of a difference that are farther apart than this are about different things, see
/// [`ScoreTest::apart`](isostudy_statistics::ScoreTest::apart).
const OTHER_THINGS: f64 = 0.1;

/// Level of tests where a study says nothing else.
pub const ALPHA: f64 = 0.05;

/// What decides conclusions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules {
    /// Level of tests, after correction.
    pub level: f64,
    /// Mean score up to which two things count as liked alike.
    pub margin: f64,
}

impl Default for Rules {
    fn default() -> Self {
        Self { level: ALPHA, margin: MARGIN }
    }
}

impl Rules {
    /// Those of a study.
    pub fn of(section: &AnalysisSection) -> Self {
        Self { level: section.level, margin: section.margin }
    }
}

/// What a hypothesis is about.
#[derive(Debug, Clone, PartialEq)]
pub enum Target {
    /// A contrast of the study.
    Contrast {
        /// What is compared.
        levels: [Level; 2],
        /// On which answers.
        over: Over,
    },
    /// One question of the study, by index.
    Question(usize),
    /// Two items of a group.
    Items {
        /// The name of the group.
        group: String,
        /// The one item.
        first: String,
        /// The other.
        second: String,
        /// On which objects.
        on: On,
    },
}

/// The objects on which two items of a group are compared.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum On {
    /// All of them.
    All,
    /// One.
    Object(String),
    /// The first rather than the second: whether the preference differs.
    Difference([String; 2]),
}

/// One hypothesis, tested.
#[derive(Debug, Clone)]
pub struct Hypothesis {
    /// Name of the family.
    pub family: String,
    /// What is compared, such as `U-I`.
    pub contrast: String,
    /// Over which answers, such as `within B`.
    pub scope: String,
    /// What it is about.
    pub target: Target,
    /// The test of it.
    pub test: ScoreTest,
    /// The sign-flip p, at a look its repeated p, adjusted within the family.
    pub adjusted: f64,
    /// The same, adjusted over every test but those of single questions; `None` for those.
    pub adjusted_over_all: Option<f64>,
    /// p of the test that the mean score lies within the margin of zero, adjusted within the family; `None` for one
    /// participant.
    pub equivalence: Option<f64>,
    /// How p is adjusted.
    pub adjustment: Adjustment,
    /// The name of what p is corrected with, and how many hypotheses of that were tested.
    pub corrected_with: String,
    /// How many hypotheses of that were tested.
    pub family_size: usize,
    /// Whether the same preference was shown to depend on the object.
    by_object: bool,
    /// Whether people were shown to favour a side.
    by_side: bool,
    /// Whether besides no pair was shown with its sides exchanged.
    on_one_side: bool,
    /// What decides its conclusion.
    pub rules: Rules,
    /// The look at which it was tested, where the study may stop by it.
    pub look: Option<Look>,
}

impl Hypothesis {
    fn new(contrast: String, scope: &str, target: Target, test: ScoreTest, rules: Rules) -> Self {
        Self {
            family: String::new(),
            contrast,
            scope: scope.into(),
            target,
            test,
            adjusted: 1.0,
            adjusted_over_all: None,
            equivalence: None,
            adjustment: Adjustment::Holm,
            corrected_with: String::new(),
            family_size: 1,
            by_object: false,
            by_side: false,
            on_one_side: false,
            rules,
            look: None,
        }
    }

    /// p of a test of it, before correction within its family: at a look the repeated p.
    pub fn p_at_look(&self, p: f64) -> f64 {
        self.look.as_ref().map_or(p, |look| look.repeated_p(p))
    }

    /// Says that people were shown to favour a side: what is equal within the margin may then be hidden by it. If no pair was shown
    /// with its sides exchanged, a preference may be made by it.
    pub(crate) fn mark_side(&mut self, on_one_side: bool) {
        (self.by_side, self.on_one_side) = (true, on_one_side);
    }

    /// Whether anybody has a score.
    pub fn is_tested(&self) -> bool {
        self.test.participants() > 0
    }

    /// What both adjusted p allow to say.
    pub fn conclusion(&self) -> Conclusion {
        let level = self.rules.level;
        match (self.adjusted <= level, self.equivalence.is_some_and(|p| p <= level)) {
            _ if !self.is_tested() => Conclusion::NotTested,
            _ if self.test.leaning() == 0 => Conclusion::NobodyLeans,
            _ if self.p_at_look(self.least_possible()) > level => Conclusion::TooFew,
            (true, _) if self.on_one_side => Conclusion::MayBeSide,
            (true, _) if self.is_difference() && self.test.apart > OTHER_THINGS => Conclusion::OtherParts,
            (true, false) => Conclusion::Differs,
            (true, true) => Conclusion::DiffersWithinMargin,
            (false, true) if self.by_object => Conclusion::AveragesOut,
            (false, true) if self.by_side => Conclusion::HiddenBySide,
            (false, true) => Conclusion::Equal,
            (false, false) => Conclusion::Open,
        }
    }

    /// The smallest p that any answers of those who lean one way or the other could have.
    pub fn least_possible(&self) -> f64 {
        2.0_f64.powi(1 - self.test.leaning() as i32)
    }

    /// Whether a preference was shown.
    pub fn differs(&self) -> bool {
        matches!(self.conclusion(), Conclusion::Differs | Conclusion::DiffersWithinMargin)
    }

    /// Whether it is about one question alone, which is exploratory.
    pub fn is_question(&self) -> bool {
        matches!(self.target, Target::Question(_))
    }

    /// Whether it is about the difference of two preferences.
    pub fn is_difference(&self) -> bool {
        match &self.target {
            Target::Contrast { over, .. } => {
                matches!(over, Over::Difference(..) | Over::ObjectDifference(..))
            }
            Target::Items { on, .. } => matches!(on, On::Difference(_)),
            Target::Question(_) => false,
        }
    }

    /// Whether two hypotheses are the same one, tested on different answers.
    pub fn is_about_the_same(&self, other: &Self) -> bool {
        (&self.family, &self.contrast, &self.scope) == (&other.family, &other.contrast, &other.scope)
    }
}

/// What else is known of a test: for comparison, and how much hangs on one participant.
#[derive(Debug, Clone, Copy)]
pub struct Robustness {
    /// Interval of the mean score by resampling participants, cut at what scores can be; not of single questions.
    pub studentised: Option<Interval>,
    /// Smallest and largest p when each participant in turn is left out.
    pub without_one: Option<[f64; 2]>,
    /// p of the binomial test, as if all answers were independent.
    pub binomial: Option<f64>,
    /// p of the trinomial test of a single question.
    pub trinomial: Option<f64>,
}

impl Robustness {
    /// Of each hypothesis, in their order.
    pub fn of(hypotheses: &[Hypothesis]) -> Vec<Self> {
        let of_one = |hypothesis: &Hypothesis| {
            let (test, question) = (&hypothesis.test, hypothesis.is_question());
            let studentised = if question { None } else { test.studentised(Resampling::default()) };
            let without = test.leave_one_out();
            let least = without.iter().copied().min_by(f64::total_cmp);
            let most = without.iter().copied().max_by(f64::total_cmp);
            Self {
                studentised: studentised.map(|of| of.interval.cut(-test.reach, test.reach)),
                without_one: least.zip(most).map(|(least, most)| [least, most]),
                binomial: test.counts.map(|[first, _, second]| sign_test::binomial(first, second)),
                trinomial: test.counts.filter(|_| question).map(|[a, t, b]| sign_test::trinomial(a, t, b)),
            }
        };
        hypotheses.par_iter().map(of_one).collect()
    }
}

/// Every contrast of a study, then every question. `ballots` are by question, as the study declares them.
pub fn of_study(study: &Study, ballots: &[DeclaredBallot], look: Option<&Look>) -> Vec<Hypothesis> {
    let mut all = of_contrasts(study, ballots, look);
    all.extend(of_questions(study, ballots));
    all
}

/// Every contrast of a study. `ballots` are by question, as the study declares them; of fewer people, too, the look is that of all
/// answers.
pub fn of_contrasts(study: &Study, ballots: &[DeclaredBallot], look: Option<&Look>) -> Vec<Hypothesis> {
    let rules = Rules::of(&study.file.analysis);
    let contrasts = contrasts(study);
    let families = families(&contrasts, &study.file.analysis);
    let of_contrast = |contrast: &Contrast| {
        let target = Target::Contrast { levels: contrast.levels, over: contrast.over };
        Hypothesis::new(contrast.name.clone(), &contrast.scope, target, test(study, contrast, ballots), rules)
    };
    let mut all: Vec<Hypothesis> = contrasts.par_iter().map(of_contrast).collect();
    for family in &families {
        for &member in &family.members {
            // A family that mixes kinds is named after what it is, its members after their kind.
            all[member].family = match family.name.as_str() {
                PRIMARY => PRIMARY.into(),
                _ => contrasts[member].family_name.clone(),
            };
            all[member].corrected_with.clone_from(&family.name);
        }
        let mut members: Vec<&mut Hypothesis> = all
            .iter_mut()
            .enumerate()
            .filter(|(i, _)| family.members.contains(i))
            .map(|(_, hypothesis)| hypothesis)
            .collect();
        if family.name == PRIMARY {
            members.iter_mut().for_each(|of| of.look = look.cloned());
        }
        adjust(&mut members, Adjustment::Holm);
    }
    let first = |h: &Hypothesis| h.family != PRIMARY;
    all.sort_by_key(first);
    adjust_over_all(&mut all);
    mark_by_object(study, ballots, &mut all);
    all
}

/// Marks what compares two levels on all objects where their preference was shown to depend on the object.
fn mark_by_object(study: &Study, ballots: &[DeclaredBallot], all: &mut [Hypothesis]) {
    // Nothing else asks.
    if all.iter().all(|h| h.conclusion() != Conclusion::Equal) {
        return;
    }
    let omnibus = omnibus::tests(study, ballots);
    let depends: Vec<[Level; 2]> = contrasts_of(all)
        .filter(|(h, levels, _)| depends_on_object(all, &omnibus, *levels, h.rules.level).is_some())
        .map(|(_, levels, _)| levels)
        .collect();
    for hypothesis in all {
        if let Target::Contrast { levels, over: Over::All | Over::Within(_) } = hypothesis.target {
            hypothesis.by_object = depends.contains(&levels);
        }
    }
}

/// What shows that a preference depends on the object.
#[derive(Debug, Clone, Copy)]
pub enum Dependence<'a> {
    /// Friedman's test over objects.
    Omnibus(&'a Omnibus),
    /// The clearest difference between two objects.
    Difference(&'a Hypothesis),
}

/// What shows that the preference between two levels depends on the object; `None` if nothing does.
pub fn depends_on_object<'a>(
    all: &'a [Hypothesis],
    omnibus: &'a [Omnibus],
    levels: [Level; 2],
    level: f64,
) -> Option<Dependence<'a>> {
    if let Some(of) = omnibus::depends_on_object(omnibus, levels, level) {
        return Some(Dependence::Omnibus(of));
    }
    let differ = contrasts_of(all)
        .filter(|(h, l, over)| matches!(over, Over::ObjectDifference(..)) && *l == levels && h.differs());
    let clearest = differ.min_by(|(a, ..), (b, ..)| a.test.sign_flip.ln_p.total_cmp(&b.test.sign_flip.ln_p));
    clearest.map(|(of, ..)| Dependence::Difference(of))
}

/// Every contrast that was tested.
pub fn contrasts_of(all: &[Hypothesis]) -> impl Iterator<Item = (&Hypothesis, [Level; 2], Over)> {
    all.iter().filter(|h| h.is_tested()).filter_map(|h| match h.target {
        Target::Contrast { levels, over } => Some((h, levels, over)),
        _ => None,
    })
}

/// The test of one contrast.
///
/// Differences between values of the other factor are taken object by object, differences between objects value by value of
/// the other factor.
pub fn test(study: &Study, contrast: &Contrast, ballots: &[DeclaredBallot]) -> ScoreTest {
    let part = |place: usize| {
        contrast.parts[place].iter().flat_map(move |(&question, &sign)| {
            let stratum = contrast.stratum(study, question);
            of_one(ballots, question)
                .iter()
                .map(move |b| (b.participant(), stratum, sign * b.preference().sign()))
        })
    };
    if !contrast.is_difference() {
        return ScoreTest::of(part(0).map(|(person, _, sign)| (person, sign)));
    }
    let both = [false, true].into_iter().flat_map(|second| {
        part(usize::from(second)).map(move |(person, stratum, sign)| (person, stratum, second, sign))
    });
    ScoreTest::of_difference(both)
}

fn of_questions(study: &Study, ballots: &[DeclaredBallot]) -> Vec<Hypothesis> {
    let rules = Rules::of(&study.file.analysis);
    let of_question = |(q, comparison): (usize, &isostudy_design::Comparison)| {
        let test = ScoreTest::of(of_one(ballots, q).iter().map(|b| (b.participant(), b.preference().sign())));
        let contrast = format!("{}-{}", comparison.left.method, comparison.right.method);
        let mut of = Hypothesis::new(contrast, &comparison.question, Target::Question(q), test, rules);
        of.family = "questions".into();
        of.corrected_with = "questions".into();
        of
    };
    let mut all: Vec<Hypothesis> = study.comparisons.par_iter().enumerate().map(of_question).collect();
    adjust(&mut all.iter_mut().collect::<Vec<_>>(), Adjustment::BenjaminiHochberg);
    all
}

/// The ballots of one question.
fn of_one(ballots: &[DeclaredBallot], question: usize) -> &[DeclaredBallot] {
    let below = |end: usize| ballots.partition_point(|ballot| ballot.question() < end);
    &ballots[below(question)..below(question + 1)]
}

/// Every pair of items that was compared, group by group; the group is the family. Where a pair was shown on several objects,
/// the same on each object, and the difference between every two objects: each kind a family of its own.
pub fn of_groups(groups: &[BallotGroup]) -> Vec<Hypothesis> {
    let mut all = Vec::new();
    for group in groups {
        let [mut pooled, mut on_each, mut between] = [const { Vec::new() }; 3];
        for i in 0..group.items.len() {
            for j in i + 1..group.items.len() {
                let pair = Pair::of(group, [i, j]);
                pooled.extend(pair.pooled());
                on_each.extend(pair.on_each());
                between.extend(pair.between());
            }
        }
        let families = [("", &mut pooled), (" on objects", &mut on_each), (" between objects", &mut between)];
        for (kind, family) in families {
            for of in family.iter_mut() {
                of.family = format!("{}{kind}", group.name);
                of.corrected_with.clone_from(&of.family);
            }
            adjust(&mut family.iter_mut().collect::<Vec<_>>(), Adjustment::Holm);
        }
        for of in &mut pooled {
            let differs =
                |other: &Hypothesis| other.contrast == of.contrast && other.adjusted <= other.rules.level;
            of.by_object = between.iter().any(differs);
        }
        all.extend(pooled.into_iter().chain(on_each).chain(between));
    }
    adjust_over_all(&mut all);
    all
}

/// The answers about two items of a group.
struct Pair<'a> {
    group: &'a BallotGroup,
    items: [usize; 2],
    ballots: Vec<DeclaredBallot>,
    /// The objects on which they were shown, where the file says them; none of fewer than two.
    objects: Vec<&'a str>,
}

impl<'a> Pair<'a> {
    fn of(group: &'a BallotGroup, items: [usize; 2]) -> Self {
        let [i, j] = items;
        let about_both =
            |b: &&isostudy_statistics::ShownBallot| [(i, j), (j, i)].contains(&(b.left(), b.right()));
        let ballots: Vec<DeclaredBallot> =
            group.ballots.iter().filter(about_both).map(|b| b.declared(i)).collect();
        let mut objects: Vec<&str> = Vec::new();
        if !group.objects.is_empty() {
            let names: BTreeSet<&str> =
                ballots.iter().map(|b| group.objects[b.question()].as_str()).collect();
            objects = names.into_iter().filter(|name| !name.is_empty()).collect();
        }
        if objects.len() < 2 {
            objects.clear();
        }
        Self { group, items, ballots, objects }
    }

    fn object(&self, ballot: &DeclaredBallot) -> &str {
        &self.group.objects[ballot.question()]
    }

    fn tested(&self, scope: &str, on: On, test: ScoreTest) -> Option<Hypothesis> {
        let [first, second] = self.items.map(|item| self.group.items[item].clone());
        let contrast = format!("{first}-{second}");
        let target = Target::Items { group: self.group.name.clone(), first, second, on };
        (test.participants() > 0).then(|| Hypothesis::new(contrast, scope, target, test, Rules::default()))
    }

    fn pooled(&self) -> Option<Hypothesis> {
        let test = ScoreTest::of(self.ballots.iter().map(|b| (b.participant(), b.preference().sign())));
        self.tested("all", On::All, test)
    }

    fn on_each(&self) -> impl Iterator<Item = Hypothesis> {
        self.objects.iter().filter_map(|&object| {
            let own = self.ballots.iter().filter(|b| self.object(b) == object);
            let test = ScoreTest::of(own.map(|b| (b.participant(), b.preference().sign())));
            self.tested(object, On::Object(object.into()), test)
        })
    }

    fn between(&self) -> impl Iterator<Item = Hypothesis> {
        let pairs = (0..self.objects.len()).flat_map(|a| (a + 1..self.objects.len()).map(move |b| [a, b]));
        pairs.filter_map(|pair| {
            let [one, other] = pair.map(|place| self.objects[place]);
            let own = self.ballots.iter().filter(|b| [one, other].contains(&self.object(b)));
            let test = ScoreTest::of_difference(
                own.map(|b| (b.participant(), 0, self.object(b) == other, b.preference().sign())),
            );
            self.tested(&format!("{one} - {other}"), On::Difference([one.into(), other.into()]), test)
        })
    }
}

/// Adjusts the p of one family; what nobody answered is not among its tests.
fn adjust(family: &mut [&mut Hypothesis], adjustment: Adjustment) {
    let mut tested: Vec<&mut &mut Hypothesis> = family.iter_mut().filter(|h| h.is_tested()).collect();
    let different =
        adjustment.of(&tested.iter().map(|h| h.p_at_look(h.test.sign_flip.p())).collect::<Vec<_>>());
    let equal: Vec<Option<f64>> =
        tested.iter().map(|h| h.test.equivalence(h.rules.margin).map(|test| h.p_at_look(test.p))).collect();
    // One participant alone has no test of equivalence, and then adds none to the family.
    let mut adjusted_equal = adjustment.of(&equal.iter().flatten().copied().collect::<Vec<_>>()).into_iter();
    let size = tested.len();
    for ((of, different), equal) in tested.iter_mut().zip(different).zip(equal) {
        (of.adjusted, of.adjustment, of.family_size) = (different, adjustment, size);
        of.equivalence = equal.and_then(|_| adjusted_equal.next());
    }
}

/// Holm over every test, whatever its family.
fn adjust_over_all(all: &mut [Hypothesis]) {
    let tested: Vec<usize> = (0..all.len()).filter(|&i| all[i].is_tested()).collect();
    let adjusted =
        holm(&tested.iter().map(|&i| all[i].p_at_look(all[i].test.sign_flip.p())).collect::<Vec<_>>());
    tested.into_iter().zip(adjusted).for_each(|(i, p)| all[i].adjusted_over_all = Some(p));
}

#[cfg(test)]
mod tests;
