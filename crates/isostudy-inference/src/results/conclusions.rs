//! What was found, as data: what each conclusion is about, its verdict, and what limits it.
//!
//! The abstract, the sections of the report, the tables' column of conclusions, both pages and the last lines of `analyse` render these.
//! A verdict stands on the test of that very thing, so no rendering can say what another denies.

use crate::audit;
use crate::hypotheses::{self, Conclusion as Tested};
use crate::liking::{self, Liking, Order};
use crate::prediction::Prediction;
use crate::results::Preferences;
use crate::standing::Standing;
use isostudy_design::contrast::Over;
use isostudy_statistics::{FitError, Heterogeneity, Participants, heterogeneity};

/// What a conclusion is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum About {
    /// A contrast over all answers, by its place among [`Preferences::contrasts`].
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
        /// The name of the top of the scale.
        best: String,
        /// The names of others, from the largest worth on.
        tied: Vec<String>,
        /// Whether nobody was shown to be liked less.
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
    /// The design, or what was recorded, does not tell.
    Design,
    /// The model has no estimate.
    NoEstimate(FitError),
    /// Some items never won against the others, so that nothing bounds their worths.
    Separated,
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
    /// It depends on the object.
    DependsOnObject,
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

/// All conclusions of answers, in the order in which they are told.
#[derive(Debug, Clone, Default)]
pub struct Conclusions {
    /// The conclusions.
    pub all: Vec<Conclusion>,
    /// The spread between people, of the group with the most answers; `None` where it has no estimate.
    pub spread: Option<Heterogeneity>,
}

impl Conclusions {
    /// Of what answers say alone.
    pub fn of(preferences: &Preferences<'_>) -> Self {
        let level = preferences.rules().level;
        let limits = limits(preferences);
        let mut all = Vec::new();
        let whole = |row: &crate::glance::Row| !row.is_difference && row.is_whole;
        for (place, row) in preferences.contrasts.iter().enumerate().filter(|(_, row)| whole(row)) {
            let verdict = match row.standing {
                Standing::Holds => Verdict::Holds { held: 1, of: 1 },
                Standing::Equal => Verdict::Equal,
                Standing::TooFew => Verdict::NotJudged(Why::TooFew),
                _ => Verdict::Undecided,
            };
            all.push(Conclusion { about: About::Contrast(place), verdict, limits: limits.clone() });
        }
        for (place, of) in preferences.scales.iter().enumerate().filter(|(_, of)| of.group.items.len() > 2) {
            let verdict = match &of.scale {
                Err(reason) => Verdict::NotJudged(Why::NoEstimate(*reason)),
                Ok(scale) if scale.fit.penalised() => Verdict::NotJudged(Why::Separated),
                Ok(scale) => {
                    let is_shown = |of: &&isostudy_statistics::Difference| {
                        of.spread.is_some_and(|spread| spread.adjusted <= level)
                    };
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
        let spread = widest(preferences)
            .and_then(|group| heterogeneity(&Participants::of(group.items.len(), &group.ballots)).ok());
        let verdict = match spread {
            None => Verdict::NotJudged(Why::Design),
            Some(of) if of.p <= level => Verdict::Holds { held: 1, of: 1 },
            Some(_) => Verdict::Undecided,
        };
        all.push(Conclusion { about: About::People, verdict, limits: Vec::new() });
        all.extend(screening(preferences));
        Self { all, spread }
    }

    /// Adds who is liked most and what predicts it.
    pub(crate) fn with(mut self, likings: &[Liking], prediction: Option<&Prediction>, level: f64) -> Self {
        let limits = self.all.first().map_or_else(Vec::new, |of| of.limits.clone());
        for (place, liking) in likings.iter().enumerate() {
            let verdict = match (&liking.top, &liking.worths) {
                (Some(top), _) => Verdict::Best {
                    best: top.best.to_string(),
                    tied: top.alike.iter().map(ToString::to_string).collect(),
                    is_everybody: top.alike.len() + 1 == liking.methods.len(),
                },
                (None, Err(reason)) => Verdict::NotJudged(Why::NoEstimate(*reason)),
                (None, Ok(_)) => Verdict::NotJudged(Why::Design),
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

    /// The one about this.
    pub fn about(&self, about: About) -> Option<&Conclusion> {
        self.all.iter().find(|of| of.about == about)
    }
}

/// The top of a group's scale.
fn top(preferences: &Preferences<'_>, place: usize, level: f64, limits: &[Limit]) -> Option<Conclusion> {
    let of = &preferences.scales[place];
    let (scale, items) = (of.scale.as_ref().ok()?, &of.group.items);
    let is_shown = |a: usize, b: usize| {
        liking::is_shown(preferences.study, &preferences.hypotheses, &of.group.name, &items[a], &items[b])
    };
    let Order { best, alike } = Order::of(scale, level, &is_shown);
    let verdict = Verdict::Best {
        best: items[best].clone(),
        is_everybody: alike.len() + 1 == items.len(),
        tied: alike.into_iter().map(|item| items[item].clone()).collect(),
    };
    Some(Conclusion { about: About::Top(place), verdict, limits: limits.to_vec() })
}

/// The group with the most answers: of equal ones the one with the most items.
fn widest<'a>(preferences: &'a Preferences<'_>) -> Option<&'a crate::BallotGroup> {
    preferences.groups.iter().max_by_key(|of| (of.ballots.len(), of.items.len()))
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
    let hypotheses = preferences.hypotheses.iter().enumerate();
    let depends = hypotheses.filter(|(_, of)| match of.target {
        hypotheses::Target::Contrast { levels, over: Over::All } => {
            of.is_tested()
                && hypotheses::depends_on_object(
                    &preferences.hypotheses,
                    &preferences.omnibus,
                    levels,
                    of.rules.level,
                )
                .is_some()
        }
        _ => false,
    });
    let conclusion = |(place, _)| Conclusion {
        about: About::Object(place),
        verdict: Verdict::Holds { held: 1, of: 1 },
        limits: Vec::new(),
    };
    depends.map(conclusion).collect()
}

/// Whether a contrast is decided otherwise without those who broke any rule.
fn screening(preferences: &Preferences<'_>) -> Option<Conclusion> {
    let any = preferences.screened.iter().find(|of| of.rule.is_none())?;
    if any.people.is_empty() {
        return None;
    }
    let changed = any.tests.iter().filter(|(with, without)| {
        let holds = |of: &hypotheses::Hypothesis| {
            matches!(of.conclusion(), Tested::Differs | Tested::DiffersWithinMargin)
        };
        without.as_ref().is_none_or(|without| holds(with) != holds(without))
    });
    let verdict = match changed.count() {
        0 => Verdict::Undecided,
        held => Verdict::Holds { held, of: any.tests.len() },
    };
    Some(Conclusion { about: About::Screening, verdict, limits: Vec::new() })
}
