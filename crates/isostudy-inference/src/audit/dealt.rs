//! What a study knows of sides, whatever its answers say: what its forms show on which side, and what its code names show.

use crate::ballots::method_of_item;
use isostudy_design::forms::{Form, Questionnaire};
use isostudy_design::{ConfigurationId, Study};
use isostudy_responses::{Answer, Responses, SidesSource, StimulusId};
use std::collections::BTreeMap;

/// By question, the items that a form shows left and right; `None` where it does not ask that.
pub(super) type Sheet = Vec<Option<[usize; 2]>>;

/// What a study shows whom. Items, questions and participants have the numbers of the ballots.
#[derive(Debug, Clone)]
pub struct Dealt<'a> {
    questionnaire: Option<Questionnaire<'a>>,
    /// What forms show, by block and way round.
    sheets: BTreeMap<(usize, bool), Sheet>,
    /// By participant, the form from 0 that the file says.
    forms: Vec<Option<usize>>,
    /// By code name, what it shows, if it is the study's.
    pub(super) codes: Vec<Option<Shown>>,
    /// Names of these.
    pub(super) names: &'a [String],
    /// By ballot, its code name; none if the file has none.
    pub(super) code_of: Vec<Option<StimulusId>>,
}

/// What is in one file of animations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Shown {
    /// The object.
    pub(super) scene: usize,
    /// Items left and right.
    pub(super) sides: [usize; 2],
}

impl<'a> Dealt<'a> {
    /// What the study knows of these answers, of which `order` are in the order of the ballots. Nothing where sides were
    /// taken from the study itself: there they cannot contradict it.
    pub fn of(study: &'a Study, answers: &'a Responses, order: &[&Answer]) -> Option<Self> {
        if answers.sides != SidesSource::InFile {
            return None;
        }
        let method = method_of_item(study, answers);
        let item: BTreeMap<&ConfigurationId, usize> =
            study.configurations.iter().map(|c| &c.id).zip(method).collect();
        let questionnaire = Questionnaire::of(study);
        let mut sheets = BTreeMap::new();
        if let Some(dealt) = &questionnaire {
            let beside: BTreeMap<&str, usize> =
                answers.questions.iter().map(|question| question.id.as_str()).zip(0..).collect();
            // The first two forms of each block are its two ways round.
            for form in (0..2 * dealt.blocks()).map(|participant| dealt.form(participant)) {
                let mut sheet = vec![None; answers.questions.len()];
                for trial in &form.trials {
                    let Some([left, right]) = trial.pair().filter(|[left, right]| left != right) else {
                        continue;
                    };
                    let question = beside.get(trial.question.as_str());
                    if let Some(&question) = question {
                        sheet[question] = Some([item[left], item[right]]);
                    }
                }
                sheets.insert(way(&form), sheet);
            }
        }
        let code_of = match answers.stimuli.is_empty() {
            true => Vec::new(),
            false => order.iter().map(|answer| answer.stimulus).collect(),
        };
        let object = |id: &ConfigurationId| study.file.objects.iter().position(|o| o.id == id.object);
        let mut known = BTreeMap::new();
        if !code_of.is_empty() {
            for stimulus in study.stimuli() {
                let Some([left, right]) = stimulus.pair() else { continue };
                let scene = object(left).expect("crossed from these objects");
                let sides = [item[left], item[right]];
                known.insert(stimulus.code, Shown { scene, sides });
            }
        }
        let number = |form: &str| form.parse::<usize>().ok()?.checked_sub(1);
        Some(Self {
            questionnaire,
            sheets,
            forms: answers.participants.iter().map(|p| p.form.as_deref().and_then(number)).collect(),
            codes: answers.stimuli.iter().map(|name| known.get(name).copied()).collect(),
            names: &answers.stimuli,
            code_of,
        })
    }

    /// What forms show.
    pub(super) fn sheets(&self) -> Vec<&Sheet> {
        self.sheets.values().collect()
    }

    /// The sheet, as numbered by [`sheets`](Self::sheets), of the form that the file says a participant had.
    pub(super) fn said(&self, participant: usize) -> Option<usize> {
        let number = (*self.forms.get(participant)?)?;
        let way = way(&self.questionnaire.as_ref()?.form(number));
        self.sheets.keys().position(|&of| of == way)
    }
}

/// The block of a form, and whether it is the other way round than the block's first.
fn way(form: &Form) -> (usize, bool) {
    (form.block, form.mirrored)
}
