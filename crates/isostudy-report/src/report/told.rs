//! Conclusions in sentences: what the abstract finds, and the last lines of `analyse`.

use super::evidence::{WEIGHTS, answer_unequally, participants};
use super::{checks, sides};
use crate::wants;
use crate::words::{capital, counted, interval, list, number, of_all, people, percent};
use isostudy_design::{MethodId, Study};
use isostudy_inference::conclusions::{About, Conclusion, Conclusions, Verdict, Why};
use isostudy_inference::decision::Goal;
use isostudy_inference::glance::Row;
use isostudy_inference::hypotheses::Target;
use isostudy_inference::prediction::MetricPrediction;
use isostudy_inference::{Preferences, Results};
use isostudy_statistics::{Outcome, ShownBallot};
use std::collections::BTreeSet;

/// Contrasts over all answers that are not named one by one.
const MANY: usize = 12;

/// Names in one sentence at most; the tables have all.
const NAMED: usize = 6;

/// What was found in answers, a sentence per kind of conclusion, the most telling first; empty without answers.
pub(crate) fn sentences(preferences: &Preferences<'_>, results: Option<&Results<'_>>) -> Vec<String> {
    if preferences.shown.is_empty() {
        return Vec::new();
    }
    let told = Told { preferences, results };
    // Of many pairs the scale tells more than the first few.
    let (pairs, objects, scale, liked) = (told.contrasts(), told.objects(), told.scale(), told.most_liked());
    let first = match told.whole().len() > MANY {
        true => [liked, scale, pairs, objects],
        false => [pairs, objects, scale, liked],
    };
    // Where the side may have made every preference, nothing tells more.
    let whole = told.whole();
    let hidden = Verdict::NotJudged(Why::Side);
    let is_hidden = !whole.is_empty() && whole.iter().all(|(_, verdict)| **verdict == hidden);
    let (before, after) = if is_hidden { (told.side(), None) } else { (None, told.side()) };
    let rest = [told.weights(), after, told.spread(), told.screening(), told.prediction()];
    before.into_iter().chain(first.into_iter().chain(rest).flatten()).collect()
}

/// The first sentence: the main finding.
pub(crate) fn main_sentence(preferences: &Preferences<'_>, results: Option<&Results<'_>>) -> Option<String> {
    let first = sentences(preferences, results).into_iter().next()?;
    let is_end = |&(place, _): &(usize, &str)| {
        first[place + 2..].starts_with(|letter: char| letter.is_uppercase() || letter.is_ascii_digit())
    };
    let end = first.match_indices(". ").find(is_end).map_or(first.len(), |(place, _)| place + 1);
    Some(first[..end].to_owned())
}

struct Told<'a, 'b> {
    preferences: &'b Preferences<'a>,
    results: Option<&'b Results<'a>>,
}

impl Told<'_, '_> {
    fn conclusions(&self) -> &Conclusions {
        self.results.map_or(&self.preferences.conclusions, |of| &of.conclusions)
    }

    fn all(&self) -> &[Conclusion] {
        &self.conclusions().all
    }

    /// The contrasts over all answers.
    fn whole(&self) -> Vec<(&Row, &Verdict)> {
        let whole =
            self.preferences.concluded().into_iter().filter(|(row, _)| row.is_whole && !row.is_difference);
        whole.map(|(row, of)| (row, &of.verdict)).collect()
    }

    /// The contrasts over all answers: those that hold, those that are equal, or that there are none.
    fn contrasts(&self) -> Option<String> {
        let whole =
            self.preferences.concluded().into_iter().filter(|(row, _)| row.is_whole && !row.is_difference);
        let own: Vec<(&Row, &Verdict)> = whole.map(|(row, of)| (row, &of.verdict)).collect();
        if own.is_empty() {
            return None;
        }
        let that = |wanted: fn(&Verdict) -> bool| own.iter().filter(move |(_, verdict)| wanted(verdict));
        let is_all = |why: Why| own.iter().all(|(_, of)| **of == Verdict::NotJudged(why));
        let undecidable =
            own.iter().all(|(_, of)| matches!(of, Verdict::NotJudged(Why::TooFew | Why::NobodyLeans)));
        let holding: Vec<String> = that(|of| matches!(of, Verdict::Holds { .. }))
            .map(|(row, _)| format!("{} ({})", row.pair(), percent(row.share)))
            .collect();
        let equal: Vec<String> =
            that(|of| *of == Verdict::Equal).map(|(row, _)| row.things.join(" and ")).collect();
        let given = self.preferences.shown.len();
        let is_tie = |of: &ShownBallot| of.outcome() == Outcome::Tie;
        let mut text = match holding.len() {
            0 if is_all(Why::NobodyLeans) && self.preferences.shown.iter().all(is_tie) => {
                format!("All {} were \u{201c}no preference\u{201d}.", counted(given, "answer"))
            }
            0 if is_all(Why::NobodyLeans) => "Nobody leans one way or the other over all answers.".into(),
            0 if undecidable && self.scale().is_some() => {
                "For a test of each pair alone, too few people were asked.".into()
            }
            0 if undecidable => format!(
                "No preference could be shown: {} gave {}, and no outcome of so few is significant.",
                people(participants(&self.preferences.shown)),
                counted(given, "answer")
            ),
            0 if is_all(Why::Side) => String::new(),
            0 if !equal.is_empty() => String::new(),
            0 => "No preference over all answers was shown.".into(),
            held if own.len() > MANY => {
                format!("Asked about two at a time, people preferred one in {held} of {} pairs.", own.len())
            }
            _ => in_sentences("People", &holding),
        };
        if !equal.is_empty() {
            let more = equal.len().saturating_sub(NAMED);
            let rest = if more > 0 { format!("; and {more} more") } else { String::new() };
            let pairs = equal[..equal.len() - more].join("; ");
            text.push_str(&format!(" Within the margin people like these alike: {pairs}{rest}."));
        }
        (!text.is_empty()).then(|| text.trim().to_owned())
    }

    /// Where the scale shows a difference and no test of a pair does, because people gave different numbers of answers.
    fn weights(&self) -> Option<String> {
        let none = !self.whole().iter().any(|(_, of)| matches!(of, Verdict::Holds { .. }));
        (none && self.scale().is_some() && answer_unequally(&self.preferences.shown)).then(|| WEIGHTS.into())
    }

    /// The scale with the most items.
    fn scale(&self) -> Option<String> {
        let own = self.all().iter().filter_map(|of| match (of.about, &of.verdict) {
            (About::Scale(place), Verdict::Holds { held, of }) => Some((place, *held, *of)),
            _ => None,
        });
        let (place, held, of) = own.max_by_key(|&(_, _, of)| of)?;
        let items = self.preferences.scales[place].group.items.len();
        let differences = of_all(held, of, "difference", ["holds", "hold"]);
        Some(format!("On one scale of {}, {differences}.", counted(items, "item")))
    }

    fn objects(&self) -> Option<String> {
        let study = self.preferences.study?;
        let own = self.all().iter().filter_map(|of| match of.about {
            About::Object(place) => Some(&self.preferences.hypotheses[place].target),
            _ => None,
        });
        let names: Vec<String> = own.filter_map(|of| between(study, of)).collect();
        (!names.is_empty()).then(|| format!("The preference depends on the object for {}.", named(&names)))
    }

    /// Of a study over all objects and on each; else of the scale with the most answers.
    fn most_liked(&self) -> Option<String> {
        self.named_most_liked().or_else(|| self.without_bounds())
    }

    /// Why nobody is called the most liked where answers agree too well.
    fn without_bounds(&self) -> Option<String> {
        let is_unbounded = |of: &&Conclusion| {
            matches!(of.about, About::MostLiked(_) | About::Scale(_))
                && of.verdict == Verdict::NotJudged(Why::Separated)
        };
        self.all().iter().find(is_unbounded)?;
        let text = "The most liked is not named, because some items never won against the others and nothing bounds the worths.";
        Some(text.into())
    }

    fn named_most_liked(&self) -> Option<String> {
        let Some(results) = self.results else {
            let tops = self.all().iter().filter_map(|of| match of.about {
                About::Top(place) => Some((self.preferences.scales[place].group, &of.verdict)),
                _ => None,
            });
            let (_, verdict) = tops.max_by_key(|(group, _)| group.ballots.len())?;
            return top(verdict, |name| name.to_owned()).map(|text| format!("Most liked: {text}."));
        };
        let study = results.inputs.study;
        let mut parts: Vec<(String, String)> = Vec::new();
        for of in self.all() {
            let About::MostLiked(place) = of.about else { continue };
            let Some(text) = top(&of.verdict, |id| label(study, id)) else { continue };
            let on = match results.likings[place].object {
                None => "over all objects".into(),
                Some(object) => format!("on the {}", study.file.objects[object].name),
            };
            parts.push((on, text));
        }
        let (_, first) = parts.first()?;
        // Over all objects, and on each of them.
        let is_one =
            parts.len() == 1 + study.file.objects.len() && parts.iter().all(|(_, text)| text == first);
        let mut said: Vec<String> = match is_one {
            true => vec![format!("Most liked on every object: {first}.")],
            false => parts.iter().map(|(on, text)| format!("Most liked {on}: {text}.")).collect(),
        };
        let apart: BTreeSet<&MethodId> = results.likings.iter().flat_map(|of| &of.apart).collect();
        if !apart.is_empty() {
            let names: Vec<String> = apart.into_iter().map(ToString::to_string).collect();
            said.push(format!("No answers join {} to the other methods.", named(&names)));
        }
        Some(said.join(" "))
    }

    fn side(&self) -> Option<String> {
        let found = self.conclusions().about(About::Side)?;
        match found.verdict {
            Verdict::Holds { .. } => {
                let size = side_share(self.preferences).map_or(String::new(), |(side, share)| {
                    format!(": {} of the decided answers went {side}", percent(share))
                });
                let is_hidden = self.all().iter().any(|of| of.verdict == Verdict::NotJudged(Why::Side));
                let so = match is_hidden {
                    true => "No pair was shown on both sides, so the side may have made every preference.",
                    false => "Whoever answers by the side hides what they prefer.",
                };
                Some(format!("People favour a side{size}. {so}"))
            }
            // The probe cannot look where no pair was seen in both orders on one object; the model may still tell.
            Verdict::NotJudged(_) => sides::favoured(self.preferences.sides.as_ref()?),
            _ => None,
        }
    }

    fn spread(&self) -> Option<String> {
        self.conclusions().about(About::People).filter(|of| of.holds())?;
        let spread = self.preferences.conclusions.spread?;
        let more = match spread.of.sd > spread.largest_difference {
            true => " That is more than any two items differ by on average.",
            false => "",
        };
        let size = match spread.of.is_bounded() {
            true => format!("{} log-odds ({})", number(spread.of.sd, 1), interval(spread.of.interval, 1)),
            false => format!("at least {} log-odds", number(spread.of.interval.low, 1)),
        };
        Some(format!(
            "People differ in taste. The difference of two items has a standard deviation between people of {size}.{more}"
        ))
    }

    fn screening(&self) -> Option<String> {
        self.conclusions().about(About::Screening).filter(|of| of.verdict != Verdict::Undecided)?;
        Some(checks::without_them(self.preferences.screened.first()?, self.preferences.respondents.len()))
    }

    fn prediction(&self) -> Option<String> {
        let results = self.results?;
        let metrics = &results.prediction.as_ref()?.metrics;
        let own = self.all().iter().filter_map(|of| match of.about {
            About::Prediction(place) => Some((&metrics[place], &of.verdict)),
            _ => None,
        });
        let holding: Vec<&MetricPrediction> =
            own.filter(|(_, verdict)| matches!(verdict, Verdict::Holds { .. })).map(|(of, _)| of).collect();
        let way = |of: &&MetricPrediction| {
            let way = if of.better.test.mean >= 0.0 {
                of.metric.better.to_owned()
            } else {
                format!("not {}", of.metric.better)
            };
            format!("{} ({way} is preferred)", of.metric.label)
        };
        Some(match holding.len() {
            0 => "No measure of the meshes was shown to go with preference among other methods.".into(),
            _ => format!(
                "These measures go with preference, before other people and among other methods: {}.",
                named(&holding.iter().map(way).collect::<Vec<_>>())
            ),
        })
    }
}

/// Who is the best at what most want of a mesh, a sentence per want.
pub(crate) fn best(results: &Results<'_>) -> Vec<String> {
    const WANTS: [Goal; 4] = [Goal::Fastest, Goal::Closest, Goal::SharpEdges, Goal::Regular];
    WANTS.iter().filter_map(|&goal| best_at(results, goal)).collect()
}

fn best_at(results: &Results<'_>, goal: Goal) -> Option<String> {
    let picks = &results.decision.picks;
    let mut parts: Vec<(String, Vec<&str>)> = Vec::new();
    let mut objects = 0;
    for of in &results.conclusions.all {
        let About::Take(pick, on) = of.about else { continue };
        if picks[pick].want.goal != goal {
            continue;
        }
        // A tie has no winner.
        let text = match &of.verdict {
            Verdict::Best { best, tied, .. } if tied.is_empty() => label(results.inputs.study, best),
            Verdict::Best { is_everybody: true, .. } => "not decided".into(),
            Verdict::Best { best, tied, .. } => {
                // In the study's order: the same set on two objects is told once.
                let is_in = |id: &str| best == id || tied.iter().any(|of| of == id);
                let ids = results.inputs.study.methods.iter().map(|method| method.id.as_str());
                let all: Vec<&str> = ids.filter(|id| is_in(id)).collect();
                format!("not distinguished are {}", named(&all))
            }
            _ => continue,
        };
        objects += 1;
        let object = picks[pick].on[on].object.name.as_str();
        match parts.iter_mut().find(|(own, _)| *own == text) {
            Some((_, on)) => on.push(object),
            None => parts.push((text, vec![object])),
        }
    }
    let is_everywhere = |on: &[&str]| on.len() == objects && objects > 1;
    let part = |(text, on): &(String, Vec<&str>)| match is_everywhere(on) {
        true => format!("{text} on every object"),
        false => format!("{text} on the {}", list(on)),
    };
    let parts: Vec<String> = parts.iter().map(part).collect();
    let heading = wants::heading(results.inputs.study, goal);
    (!parts.is_empty()).then(|| format!("{}: {}.", capital(&heading), parts.join("; ")))
}

/// The side that was chosen more often, and its share of the decided answers.
pub(crate) fn side_share(preferences: &Preferences<'_>) -> Option<(&'static str, f64)> {
    let count = |outcome| preferences.shown.iter().filter(|of| of.outcome() == outcome).count() as f64;
    let [left, right] = [Outcome::Left, Outcome::Right].map(count);
    let (side, more) = if left >= right { ("left", left) } else { ("right", right) };
    (left + right > 0.0).then(|| (side, more / (left + right)))
}

/// A sentence each, of so many as are named.
fn in_sentences(who: &str, preferred: &[String]) -> String {
    let mut text = String::new();
    for (place, pair) in preferred.iter().take(NAMED).enumerate() {
        let who = if place == 0 { who } else { " They" };
        text.push_str(&format!("{who} preferred {pair}."));
    }
    if preferred.len() > NAMED {
        text.push_str(&format!(" {} more preferences hold.", preferred.len() - NAMED));
    }
    text
}

/// The best and who is not shown to differ; `None` where there is none.
fn top(verdict: &Verdict, name: impl Fn(&str) -> String) -> Option<String> {
    let Verdict::Best { best, tied, is_everybody } = verdict else { return None };
    Some(match tied.len() {
        0 => name(best),
        _ if *is_everybody => "not decided".into(),
        _ => format!("{}, not shown to differ from {}", name(best), named(tied)),
    })
}

fn label(study: &Study, id: &str) -> String {
    let method = study.methods.iter().find(|method| method.id.as_str() == id);
    method.map_or_else(|| id.to_owned(), |method| format!("{id} ({})", method.label))
}

fn between(study: &Study, target: &Target) -> Option<String> {
    let Target::Contrast { levels, .. } = target else { return None };
    let [first, second] = levels.map(|level| study.level(level).phrase.as_str());
    Some(format!("{first} against {second}"))
}

/// Some of the names, and how many more there are.
pub(crate) fn named<T: AsRef<str>>(names: &[T]) -> String {
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    if names.len() <= NAMED {
        return list(&names);
    }
    let more = format!("{} more", names.len() - NAMED);
    list(&names[..NAMED].iter().copied().chain([more.as_str()]).collect::<Vec<_>>())
}
