//! Everything that was answered, controls and repeats included, and how: what screening and probes look at.

use crate::audit::{Audited, Dealt};
use crate::ballots::{BallotGroup, is_asked, method_of_item, outcome};
use isostudy_design::Study;
use isostudy_responses::{Answer, Responses};
use isostudy_statistics::{Circumstances, Protocol, ShownBallot};
use std::borrow::Cow;
use std::collections::HashMap;

/// Answers as they were recorded. Participants and questions have the numbers of [`Responses`].
#[derive(Debug, Clone)]
pub struct Recorded<'a> {
    ballots: Cow<'a, [ShownBallot]>,
    /// One a ballot; none if nothing is known.
    circumstances: Vec<Circumstances>,
    /// By question, the object on which it shows its items, where it says one, else itself.
    scenes: Vec<usize>,
    questions: Vec<String>,
    objects: Vec<String>,
    sides_recorded: bool,
    shown_ms: Option<f64>,
    /// Whether nobody could answer "no preference".
    forced: bool,
    /// What the study knows of sides, where the file tells them itself.
    dealt: Option<Dealt<'a>>,
}

impl<'a> Recorded<'a> {
    /// A study's answers; items are methods. `ballots` are [`ballots`](crate::ballots::ballots()) of the same.
    ///
    /// A question's showing lasts as long as a turntable, or as declared.
    ///
    /// # Panics
    /// If the answers were read for another study.
    pub fn of_study(
        study: &'a Study,
        answers: &'a Responses,
        ballots: impl Into<Cow<'a, [ShownBallot]>>,
    ) -> Self {
        let mut order: Vec<&Answer> = answers.answers.iter().collect();
        order.sort_by_key(|answer| answer.question);
        let items = method_of_item(study, answers);
        let ballots = match order.iter().all(|answer| is_asked(study, answer)) {
            true => ballots.into(),
            false => order.iter().map(|answer| ballot(answer, |item| items[item as usize])).collect(),
        };
        let object = |item: u32| {
            let id = &study.configurations[item as usize].id;
            study.file.objects.iter().position(|o| o.id == id.object).expect("crossed from these objects")
        };
        let turntable = &study.file.turntable;
        // A frame lasts a whole number of centiseconds.
        let frames = f64::from(turntable.frames);
        let turn_ms = 10.0 * (100.0 * turntable.duration_s / frames).floor() * frames;
        let declared = study.file.responses.as_ref().and_then(|section| section.shown_s);
        Self {
            ballots,
            dealt: Dealt::of(study, answers, &order),
            circumstances: circumstances(order.into_iter()),
            scenes: answers.questions.iter().map(|question| object(question.left)).collect(),
            questions: answers.questions.iter().map(|question| question.id.clone()).collect(),
            objects: study.file.objects.iter().map(|object| object.name.clone()).collect(),
            sides_recorded: answers.sides_recorded,
            forced: study.file.forms.as_ref().is_some_and(|forms| !forms.way.has_ties()),
            shown_ms: Some(declared.map_or(turn_ms, |seconds| 1000.0 * seconds)),
        }
    }

    /// Answers without a study; items have the numbers of [`Responses`]. `shown_s` is how long what a question shows lasts.
    pub fn without_study(answers: &Responses, shown_s: Option<f64>) -> Recorded<'static> {
        let (mut objects, mut known) = (Vec::new(), HashMap::new());
        let mut scene = |question: &isostudy_responses::Question| match question.object.as_str() {
            "" => {
                objects.push(question.id.clone());
                objects.len() - 1
            }
            object => *known.entry(object.to_owned()).or_insert_with(|| {
                objects.push(object.to_owned());
                objects.len() - 1
            }),
        };
        let scenes = answers.questions.iter().map(&mut scene).collect();
        Recorded {
            ballots: answers.answers.iter().map(|answer| ballot(answer, |item| item as usize)).collect(),
            circumstances: circumstances(answers.answers.iter()),
            scenes,
            questions: answers.questions.iter().map(|question| question.id.clone()).collect(),
            objects,
            sides_recorded: answers.sides_recorded,
            forced: false,
            shown_ms: shown_s.map(|seconds| 1000.0 * seconds),
            dealt: None,
        }
    }

    /// Every answer, controls and repeats included.
    pub fn ballots(&self) -> &[ShownBallot] {
        &self.ballots
    }

    /// What screening can use.
    pub fn protocol(&self) -> Protocol<'_> {
        Protocol {
            circumstances: &self.circumstances,
            scenes: &self.scenes,
            shown_ms: self.shown_ms,
            sides_unknown: !self.sides_recorded,
            forced: self.forced,
        }
    }

    /// What probes look at, given the groups whose items are compared.
    pub fn audited<'s>(&'s self, groups: &'s [BallotGroup]) -> Audited<'s> {
        Audited {
            ballots: &self.ballots,
            groups,
            scenes: &self.scenes,
            questions: &self.questions,
            objects: &self.objects,
            sides_recorded: self.sides_recorded,
            circumstances: &self.circumstances,
            dealt: self.dealt.as_ref(),
        }
    }
}

fn ballot(answer: &Answer, item: impl Fn(u32) -> usize) -> ShownBallot {
    ShownBallot::new(
        answer.participant as usize,
        answer.question as usize,
        [item(answer.left), item(answer.right)],
        outcome(answer.choice),
    )
}

fn circumstances<'a>(answers: impl Iterator<Item = &'a Answer> + Clone) -> Vec<Circumstances> {
    let known = |answer: &Answer| answer.order.is_some() || answer.rt_ms.is_some();
    if !answers.clone().any(known) {
        return Vec::new();
    }
    answers.map(|a| Circumstances { order: a.order, rt_ms: a.rt_ms.map(f64::from) }).collect()
}
