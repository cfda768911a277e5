//! What a study shows whom: the sides of every question, repeat and control, by form and by code name.

use crate::value::Question;
use crate::words::normalise;
use isostudy_design::config::SideRule;
use isostudy_design::forms::{Form, Questionnaire, Role};
use isostudy_design::{ConfigurationId, Study};
use std::collections::{BTreeMap, HashMap};

/// The items on the left and right of what a form asks; `None` where it does not ask that. One a question, then one a repeat or
/// control.
pub(crate) type Sheet = Vec<Option<[u32; 2]>>;

/// What the forms of a study show.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shown {
    /// Whether everybody sees the questions with the sides that are listed.
    pub(crate) as_listed: bool,
    /// Repeats and controls, as some form shows them.
    pub(crate) beside: Vec<Question>,
    by_id: HashMap<String, u32>,
    /// What forms ask; several may ask the same.
    sheets: Vec<Sheet>,
    /// The sheet of each planned form; none where forms do not matter.
    of_form: Vec<u32>,
    /// Sides by code name.
    codes: HashMap<String, [u32; 2]>,
}

impl Shown {
    /// Declared pairs, which everybody is shown as declared.
    pub(crate) fn as_declared() -> Self {
        let (beside, sheets, of_form) = (Vec::new(), Vec::new(), Vec::new());
        Self { as_listed: true, beside, by_id: HashMap::new(), sheets, of_form, codes: HashMap::new() }
    }

    /// What a study shows. `questions` are its comparisons, `item` numbers its configurations.
    pub(crate) fn of_study(study: &Study, questions: &[Question]) -> Self {
        let numbers: BTreeMap<&ConfigurationId, u32> =
            study.configurations.iter().zip(0..).map(|(configuration, i)| (&configuration.id, i)).collect();
        let sides = |left: &ConfigurationId, right: &ConfigurationId| [numbers[left], numbers[right]];
        let mut shown = Self::as_declared();
        let stimuli = study.stimuli().into_iter();
        // What is shown one at a time, or several at once, has no sides.
        shown.codes = stimuli
            .filter_map(|stimulus| {
                let [left, right] = stimulus.pair()?;
                Some((stimulus.code.clone(), sides(left, right)))
            })
            .collect();
        let section = study.file.forms.as_ref().filter(|section| section.way.is_of_pairs());
        let Some((forms, section)) = Questionnaire::of(study).zip(section) else {
            return shown;
        };
        shown.as_listed = section.sides == SideRule::AsListed;
        // As listed, the forms of a block differ in order alone.
        let dealt = if shown.as_listed { forms.blocks() } else { section.participants as usize };
        let mut known: HashMap<Vec<(u32, [u32; 2])>, u32> = HashMap::new();
        let mut asked: Vec<Vec<(u32, [u32; 2])>> = Vec::new();
        for participant in 0..dealt {
            let form = forms.form(participant);
            let mut trials = shown.trials(&form, study, questions, sides);
            trials.sort_unstable();
            let sheet = *known.entry(trials).or_insert_with_key(|trials| {
                asked.push(trials.clone());
                asked.len() as u32 - 1
            });
            shown.of_form.push(sheet);
        }
        let width = questions.len() + shown.beside.len();
        shown.sheets = asked
            .iter()
            .map(|trials| {
                let mut sheet = vec![None; width];
                trials.iter().for_each(|&(number, sides)| sheet[number as usize] = Some(sides));
                sheet
            })
            .collect();
        shown
    }

    /// What a form asks, as numbers with sides. Repeats and controls are numbered as they come.
    fn trials(
        &mut self,
        form: &Form,
        study: &Study,
        questions: &[Question],
        sides: impl Fn(&ConfigurationId, &ConfigurationId) -> [u32; 2],
    ) -> Vec<(u32, [u32; 2])> {
        let mut trials = Vec::new();
        for trial in &form.trials {
            let Some([left, right]) = trial.pair() else { continue };
            let [left, right] = sides(left, right);
            let number = match (trial.role, trial.comparison) {
                (Role::Training, _) => continue,
                (Role::Comparison, Some(comparison)) => comparison as u32,
                (role, comparison) => {
                    let beside = &mut self.beside;
                    *self.by_id.entry(normalise(&trial.question)).or_insert_with(|| {
                        let (object, group) = match comparison {
                            Some(i) => (questions[i].object.clone(), questions[i].group.clone()),
                            None => (study.configurations[left as usize].id.object.clone(), String::new()),
                        };
                        let id = trial.question.clone();
                        beside.push(Question { id, object, group, left, right, role });
                        (questions.len() + beside.len() - 1) as u32
                    })
                }
            };
            trials.push((number, [left, right]));
        }
        trials
    }

    /// The number of a repeat or control.
    pub(crate) fn beside(&self, id: &str) -> Option<u32> {
        self.by_id.get(&normalise(id)).copied()
    }

    /// What the form with this number asks.
    pub(crate) fn sheet(&self, form: &str) -> Option<&Sheet> {
        let place = form.parse::<usize>().ok()?.checked_sub(1)?;
        self.of_form.get(place).map(|&sheet| &self.sheets[sheet as usize])
    }

    /// How many forms are known by their number.
    pub(crate) fn forms(&self) -> usize {
        self.of_form.len()
    }

    /// The sides of a repeat or control where everybody who is asked sees the same ones.
    pub(crate) fn same_for_all(&self, number: u32) -> Option<[u32; 2]> {
        let mut sides = self.sheets.iter().filter_map(|sheet| sheet[number as usize]);
        let first = sides.next()?;
        sides.all(|other| other == first).then_some(first)
    }

    /// The sides of the pair with this code name.
    pub(crate) fn code(&self, name: &str) -> Option<[u32; 2]> {
        self.codes.get(name).copied()
    }

    /// Whether there are code names.
    pub(crate) fn has_codes(&self) -> bool {
        !self.codes.is_empty()
    }
}
