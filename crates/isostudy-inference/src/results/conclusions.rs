//! What was found, as data: what each conclusion is about, its verdict, and what limits it.
//!
//! The abstract, the report's sections, the tables' verdicts, what both pages show first and the last lines of `analyse` render these.
//! A verdict stands on the test of that very thing, so no rendering can say what another denies.

use crate::audit;
use crate::ballots::widest;
use crate::decision::{Goal, Pick};
use crate::glance::Row;
use crate::hypotheses::{self, Conclusion as Tested, Hypothesis};
use crate::liking::{self, Liking, Order, is_too_few};
use crate::prediction::Prediction;
use crate::results::Preferences;
use crate::scale::GroupScale;
use isostudy_design::contrast::Over;
use isostudy_statistics::{Difference, FitError, Heterogeneity, Participants, heterogeneity};

/// What a conclusion is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum About {
    /// A contrast, by its place among [`Preferences::contrasts`].
    Contrast(usize),
    /// Differences of a group's items on one scale, by its place among [`Preferences::scales`].
    Scale(usize),
    /// Whether a contrast over all answers depends on the object, by its place among [`Preferences::hypotheses`].
    Object(usize),
    /// The top of a group's scale, by its place among [`Preferences::scales`].
    Top(usize),
    /// The most liked method, by its place among [`Results::likings`](crate::Results::likings).
    MostLiked(usize),
    /// Whether people favour a side.
    Side,
    /// Whether people differ in their tastes.
    People,
    /// Whether those who broke a rule of screening decide a contrast.
    Screening,
    /// Whether a metric goes with preference, by its place among [`Prediction::metrics`].
    Prediction(usize),
    /// Who is the best in time, error, shape or topology on an object: the place among
    /// [`Decision::picks`](crate::results::Decision::picks), and that among its objects.
    Take(usize, usize),
}

/// How it came out.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// It was shown. On a scale: so many differences of so many.
    Holds {
        /// How many tests hold.
        held: usize,
        /// How many there are.
        of: usize,
    },
    /// What is there is smaller than the declared margin.
    Equal,
    /// Neither was shown.
    Undecided,
    /// The best, and the others from whom it was not shown to differ.
    Best {
        /// The name of the best.
        best: String,
        /// The names of others, from the best on.
        tied: Vec<String>,
        /// Whether nobody was shown to be worse.
        is_everybody: bool,
    },
    /// Nothing could be said.
    NotJudged(Why),
}

/// Why something was not judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Why {
    /// No outcome of so few people could have shown anything.
    TooFew,
    /// Nobody leans one way or the other.
    NobodyLeans,
    /// The design, or what was recorded, does not tell.
    Design,
    /// People favour a side, and nothing was shown on both sides: the side may have made what is there.
    Side,
    /// The model has no estimate.
    NoEstimate(FitError),
    /// Some items never won against the others, so that nothing bounds their worths.
    Separated,
    /// Times were measured beside other work.
    Busy,
}

/// What limits a conclusion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// No pair that counts was shown with its sides exchanged: the preference may be one for a side.
    SidesGoWithItems,
    /// People favour a side.
    SideFavoured,
    /// Only repeats show pairs with their sides exchanged.
    OnlyRepeatsExchange,
    /// It depends on the object: what is there over all objects need not be there on any.
    DependsOnObject,
    /// It holds, and is smaller than the margin.
    WithinMargin,
    /// It would not hold with one correction over all tests.
    NotOverAll,
    /// The one part was asked about other objects than the other, so that objects may make the difference.
    OtherObjects,
}

/// A conclusion.
#[derive(Debug, Clone, PartialEq)]
pub struct Conclusion {
    /// What it is about.
    pub about: About,
    /// How it came out.
    pub verdict: Verdict,
    /// What limits it.
    pub limits: Vec<Limit>,
}

impl Conclusion {
    /// Whether it was shown.
    pub fn holds(&self) -> bool {
        matches!(self.verdict, Verdict::Holds { .. })
    }

    /// Whether this limits it.
    pub fn is_limited(&self, limit: Limit) -> bool {
        self.limits.contains(&limit)
    }
}

/// All conclusions, in the order in which they are told.
#[derive(Debug, Clone, Default)]
pub struct Conclusions {
    /// The conclusions.
    pub all: Vec<Conclusion>,
    /// The spread between people, of the scale with the most answers; `None` where it has no estimate.
    pub spread: Option<Spread>,
}

/// How far people differ in their tastes.
#[derive(Debug, Clone, Copy)]
pub struct Spread {
    /// The standard deviation between people.
    pub of: Heterogeneity,
    /// The largest difference of two items on the same scale, in log-odds; 0 where there is no scale.
    pub largest_difference: f64,
}

impl Conclusions {
    /// Of what answers say alone.
    pub fn of(preferences: &Preferences<'_>) -> Self {
        let level = preferences.rules().level;
        let limits = limits(preferences);
        let contrasts = preferences.contrasts.iter().enumerate();
        let mut all: Vec<Conclusion> =
            contrasts.map(|(place, row)| contrast(preferences, place, row, &limits)).collect();
        for (place, of) in preferences.scales.iter().enumerate().filter(|(_, of)| of.group.items.len() > 2) {
            let verdict = match &of.scale {
                Err(reason) => Verdict::NotJudged(Why::NoEstimate(*reason)),
                Ok(_) if is_too_few(people(of), level) => Verdict::NotJudged(Why::TooFew),
                Ok(scale) if scale.fit.penalised() => Verdict::NotJudged(Why::Separated),
                Ok(scale) => {
                    let is_shown =
                        |of: &&Difference| of.spread.is_some_and(|spread| spread.adjusted <= level);
                    match scale.differences.iter().filter(is_shown).count() {
                        0 => Verdict::Undecided,
                        held => Verdict::Holds { held, of: scale.differences.len() },
                    }
                }
            };
            all.push(Conclusion { about: About::Scale(place), verdict, limits: limits.clone() });
            all.extend(top(preferences, place, level, &limits));
        }
        all.extend(objects(preferences));
        all.push(Conclusion { about: About::Side, verdict: side(preferences), limits: Vec::new() });
        let spread = spread(preferences);
        let verdict = match spread {
            None => Verdict::NotJudged(Why::Design),
            Some(spread) if spread.of.p <= level => Verdict::Holds { held: 1, of: 1 },
            Some(_) => Verdict::Undecided,
        };
        all.push(Conclusion { about: About::People, verdict, limits: Vec::new() });
        all.extend(screening(preferences));
        Self { all, spread }
    }

    /// Adds who is liked most and what predicts it.
    pub(crate) fn with(mut self, likings: &[Liking], prediction: Option<&Prediction>, level: f64) -> Self {
        let limits = self.about(About::Contrast(0)).map_or_else(Vec::new, |of| of.limits.clone());
        for (place, liking) in likings.iter().enumerate() {
            let verdict = match (&liking.top, &liking.worths) {
                (Some(top), _) => Verdict::Best {
                    best: top.best.to_string(),
                    tied: top.alike.iter().map(ToString::to_string).collect(),
                    is_everybody: top.alike.len() + 1 == liking.methods.len(),
                },
                (None, Err(reason)) => Verdict::NotJudged(Why::NoEstimate(*reason)),
                (None, Ok(_)) => Verdict::NotJudged(Why::Separated),
            };
            self.all.push(Conclusion { about: About::MostLiked(place), verdict, limits: limits.clone() });
        }
        for (place, metric) in prediction.iter().flat_map(|of| &of.metrics).enumerate() {
            let verdict = match metric.holds(level) {
                true => Verdict::Holds { held: 1, of: 1 },
                false if metric.relabelled.is_none() => Verdict::NotJudged(Why::Design),
                false => Verdict::Undecided,
            };
            self.all.push(Conclusion { about: About::Prediction(place), verdict, limits: limits.clone() });
        }
        self
    }

    /// Adds who is the best in what. Of a run beside other work nothing that times decide is judged.
    pub(crate) fn with_picks(mut self, picks: &[Pick<'_>], is_busy: bool) -> Self {
        for (place, pick) in picks.iter().enumerate() {
            for (on, best) in pick.on.iter().enumerate() {
                let verdict = match is_busy && pick.want.goal.is_of_times() {
                    true => Verdict::NotJudged(Why::Busy),
                    false => Verdict::Best {
                        best: pick.method.id.to_string(),
                        tied: best.alike.iter().map(ToString::to_string).collect(),
                        is_everybody: best.is_everybody_alike,
                    },
                };
                self.all.push(Conclusion { about: About::Take(place, on), verdict, limits: Vec::new() });
            }
        }
        self
    }

    /// The one about this.
    pub fn about(&self, about: About) -> Option<&Conclusion> {
        self.all.iter().find(|of| of.about == about)
    }

    /// The ones about contrasts, in the order of [`Preferences::contrasts`].
    pub fn of_contrasts(&self) -> impl Iterator<Item = &Conclusion> {
        self.all.iter().filter(|of| matches!(of.about, About::Contrast(_)))
    }
}

impl Goal {
    /// Whether times decide it.
    pub fn is_of_times(self) -> bool {
        match self {
            Self::Fastest | Self::Chunk | Self::Edit => true,
            Self::StoredFastest | Self::StoredChunk | Self::StoredEdit => true,
            Self::Faultless | Self::Topology => true,
            Self::Preferred | Self::Closest | Self::ClosestPerTriangle | Self::SharpEdges | Self::Regular => {
                false
            }
        }
    }
}

fn contrast(preferences: &Preferences<'_>, place: usize, row: &Row, limits: &[Limit]) -> Conclusion {
    let hypothesis = &preferences.hypotheses[row.hypothesis];
    let mut limits = limits.to_vec();
    let verdict = match hypothesis.conclusion() {
        Tested::OtherParts => {
            limits.push(Limit::OtherObjects);
            Verdict::NotJudged(Why::Design)
        }
        Tested::Differs => Verdict::Holds { held: 1, of: 1 },
        Tested::DiffersWithinMargin => {
            limits.push(Limit::WithinMargin);
            Verdict::Holds { held: 1, of: 1 }
        }
        Tested::Equal => Verdict::Equal,
        Tested::TooFew => Verdict::NotJudged(Why::TooFew),
        Tested::NobodyLeans => Verdict::NotJudged(Why::NobodyLeans),
        Tested::MayBeSide => Verdict::NotJudged(Why::Side),
        Tested::Open | Tested::AveragesOut | Tested::HiddenBySide | Tested::NotTested => Verdict::Undecided,
    };
    let level = hypothesis.rules.level;
    if matches!(verdict, Verdict::Holds { .. }) && hypothesis.adjusted_over_all.is_some_and(|p| p > level) {
        limits.push(Limit::NotOverAll);
    }
    if preferences.dependence(hypothesis).is_some() {
        limits.push(Limit::DependsOnObject);
    }
    Conclusion { about: About::Contrast(place), verdict, limits }
}

/// Who answered a group's questions.
fn people(of: &GroupScale<'_>) -> u64 {
    Participants::of(of.group.items.len(), &of.group.ballots).number()
}

/// The top of a group's scale; none where nothing bounds the worths and tests about two items do not take it apart from everybody.
fn top(preferences: &Preferences<'_>, place: usize, level: f64, limits: &[Limit]) -> Option<Conclusion> {
    let of = &preferences.scales[place];
    let (scale, items) = (of.scale.as_ref().ok()?, &of.group.items);
    let is_shown = |a: usize, b: usize| {
        liking::is_shown(preferences.study, &preferences.hypotheses, &of.group.name, &items[a], &items[b])
    };
    let level = if is_too_few(people(of), level) { f64::NEG_INFINITY } else { level };
    let Order { best, alike } = Order::of(scale, level, &is_shown);
    if scale.fit.penalised() && !alike.is_empty() {
        return None;
    }
    let verdict = Verdict::Best {
        best: items[best].clone(),
        is_everybody: alike.len() + 1 == items.len(),
        tied: alike.into_iter().map(|item| items[item].clone()).collect(),
    };
    Some(Conclusion { about: About::Top(place), verdict, limits: limits.to_vec() })
}

/// Of the group with the most answers.
fn spread(preferences: &Preferences<'_>) -> Option<Spread> {
    let group = widest(preferences.groups)?;
    let of = heterogeneity(&Participants::of(group.items.len(), &group.ballots)).ok()?;
    let own = preferences.scales.iter().find(|scale| scale.group.name == group.name);
    let differences = own.and_then(|own| own.scale.as_ref().ok()).into_iter().flat_map(|of| &of.differences);
    Some(Spread { of, largest_difference: differences.map(|of| of.log_odds.abs()).fold(0.0, f64::max) })
}

fn limits(preferences: &Preferences<'_>) -> Vec<Limit> {
    let mut limits = Vec::new();
    if preferences.sides.as_ref().is_some_and(|of| of.go_with_items()) {
        let is_told = side(preferences) != Verdict::NotJudged(Why::Design);
        limits.push(if is_told { Limit::OnlyRepeatsExchange } else { Limit::SidesGoWithItems });
    }
    if preferences.is_side_favoured() {
        limits.push(Limit::SideFavoured);
    }
    limits
}

fn side(preferences: &Preferences<'_>) -> Verdict {
    match preferences.audit.iter().find(|of| of.probe == audit::Probe::Side).map(|of| of.finding) {
        Some(audit::Finding::Found) => Verdict::Holds { held: 1, of: 1 },
        Some(audit::Finding::NotFound) => Verdict::Undecided,
        Some(audit::Finding::NotAnswerable) | None => Verdict::NotJudged(Why::Design),
    }
}

/// Contrasts over all answers that depend on the object.
fn objects(preferences: &Preferences<'_>) -> Vec<Conclusion> {
    let is_whole = |of: &Hypothesis| {
        matches!(of.target, hypotheses::Target::Contrast { over: Over::All, .. }) && of.is_tested()
    };
    let all = preferences.hypotheses.iter().enumerate();
    let depends = all.filter(|(_, of)| is_whole(of) && preferences.dependence(of).is_some());
    let conclusion = |(place, _)| Conclusion {
        about: About::Object(place),
        verdict: Verdict::Holds { held: 1, of: 1 },
        limits: Vec::new(),
    };
    depends.map(conclusion).collect()
}

/// Whether a contrast is decided otherwise without those who broke any rule. Of one rule alone there is no other list.
fn screening(preferences: &Preferences<'_>) -> Option<Conclusion> {
    let any = preferences.screened.first()?;
    let verdict = match any.changes().number() {
        _ if !any.leaves_somebody() => Verdict::NotJudged(Why::TooFew),
        0 => Verdict::Undecided,
        held => Verdict::Holds { held, of: any.tests.len() },
    };
    Some(Conclusion { about: About::Screening, verdict, limits: Vec::new() })
}
