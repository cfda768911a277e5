//! Forms as a file for whoever puts them to people, and the key for whoever reads the answers.

use super::about::AboutEntry;
use super::{Form, Questionnaire, Role};
use crate::config::{AboutSection, Presentation, is_english_alone, is_false, languages};
use crate::method::ConfigurationId;
use crate::study::Study;
use crate::texts::Texts;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What a page, a printed sheet or an online form needs: `forms.json`.
///
/// It names stimuli by their code names alone and says nothing of roles, sides, methods or the seed, so that it can be given
/// to participants.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FormFile {
    /// Version of this layout; 1.
    pub schema: u32,
    /// The study's id.
    pub study: String,
    /// The study's title.
    pub title: String,
    /// What is asked about each pair.
    pub prompt: String,
    /// The answers: left, no preference, right.
    pub choices: [String; 3],
    /// The answers where one surface is over the other, unless they follow from `choices`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub choices_stacked: Option<[String; 3]>,
    /// Least width of each surface on the screen, in CSS pixels, at which it can be judged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_surface_px: Option<u32>,
    /// Languages of the page; the texts above and below are in the first.
    #[serde(default = "languages", skip_serializing_if = "is_english_alone")]
    pub languages: Vec<String>,
    /// The study's own texts of the page by language and key; [`FormFile::spoken`] has all.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub texts: BTreeMap<String, Texts>,
    /// What participants agree to before they begin.
    pub consent: String,
    /// What they are told to do.
    pub instructions: String,
    /// Questions about the person, in the order in which they are asked.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub about: Vec<AboutEntry>,
    /// Whom participants can ask.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<String>,
    /// Who has approved the study.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ethics: Option<String>,
    /// Least age of participants, in years.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least_age: Option<u32>,
    /// For how many days after its end the study keeps answers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub retention_days: Option<u32>,
    /// Whether participants may change their last answer.
    #[serde(default, skip_serializing_if = "is_false")]
    pub go_back: bool,
    /// As what participants see a pair.
    #[serde(default, skip_serializing_if = "Presentation::is_turntable")]
    pub stimulus: Presentation,
    /// How long a pair takes to turn once, in milliseconds.
    pub loop_ms: u32,
    /// Whole-number enlargement of the pairs by the page, nearest neighbour.
    pub page_scale: u32,
    /// One form a planned participant, in the order in which they are dealt.
    pub forms: Vec<FormEntry>,
}

/// One participant's form.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FormEntry {
    /// The form's number, from 1.
    pub form: usize,
    /// Code names of the pairs shown first, to learn how it works.
    pub training: Vec<String>,
    /// Code names of the pairs asked about, in order.
    pub questions: Vec<String>,
}

/// A line of the key to forms: what a participant was shown at a place. Never to be given to participants.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyEntry {
    /// The form's number, from 1.
    pub form: usize,
    /// Place in the form, from 1, training included.
    pub order: usize,
    /// Code name of the pair.
    pub stimulus: String,
    /// Why it is shown.
    pub role: Role,
    /// The comparison's question; that and `-r` for its repeat; `control-1` and `training-1` and so on.
    pub question: String,
    /// Name of the object.
    pub object: String,
    /// Id of the comparison group; empty for controls and training.
    pub group: String,
    /// Configuration on the left.
    pub left: String,
    /// Configuration on the right.
    pub right: String,
}

impl Questionnaire<'_> {
    /// The planned forms, for participants.
    pub fn file(&self) -> FormFile {
        let codes = self.codes();
        let entry = |form: &Form| {
            let of = |training: bool| {
                let own = form.trials.iter().filter(|trial| (trial.role == Role::Training) == training);
                own.map(|trial| codes[&trial.left][&trial.right].clone()).collect()
            };
            FormEntry { form: form.participant + 1, training: of(true), questions: of(false) }
        };
        FormFile {
            schema: 1,
            study: self.study.file.study.id.clone(),
            title: self.study.file.study.title.clone(),
            prompt: self.section.prompt.clone(),
            choices: self.section.choices.clone(),
            choices_stacked: self.section.choices_stacked.clone(),
            min_surface_px: self.section.min_surface_px,
            languages: self.section.languages.clone(),
            texts: self.study.texts.clone(),
            consent: self.section.consent.clone(),
            instructions: self.section.instructions.clone(),
            about: self.about(),
            contact: self.section.contact.clone(),
            ethics: self.section.ethics.clone(),
            least_age: self.section.least_age,
            retention_days: self.section.retention_days,
            go_back: self.section.go_back,
            stimulus: self.section.stimulus,
            loop_ms: self.study.file.turntable.loop_ms(),
            page_scale: self.section.page_scale,
            forms: self.planned().iter().map(entry).collect(),
        }
    }

    fn about(&self) -> Vec<AboutEntry> {
        let comment = self.section.comment.then(AboutEntry::comment);
        self.section.about.iter().map(AboutEntry::of).chain(comment).collect()
    }

    /// Questions that check attention, with the value of whoever reads them. Never to be given to participants.
    pub fn attention(&self) -> Vec<(String, String)> {
        let check = |about: &AboutSection| Some((about.id.clone(), about.expects?.to_string()));
        self.section.about.iter().filter_map(check).collect()
    }

    /// How many people the study takes.
    pub fn quotas(&self) -> Quotas {
        let of = |about: &AboutSection| (about.id.clone(), about.most.clone());
        let options = self.section.about.iter().filter(|about| !about.most.is_empty()).map(of);
        Quotas { per_form: self.section.per_form, options: options.collect() }
    }

    /// What each place of each planned form shows.
    pub fn key(&self) -> Vec<KeyEntry> {
        let codes = self.codes();
        let mut key = Vec::new();
        for form in self.planned() {
            for (place, trial) in form.trials.iter().enumerate() {
                let comparison = trial.comparison.map(|i| &self.study.comparisons[i]);
                let objects = &self.study.file.objects;
                let object = objects.iter().find(|object| object.id == trial.left.object);
                key.push(KeyEntry {
                    form: form.participant + 1,
                    order: place + 1,
                    stimulus: codes[&trial.left][&trial.right].clone(),
                    role: trial.role,
                    question: trial.question.clone(),
                    object: object.map_or_else(String::new, |object| object.name.clone()),
                    group: comparison.map_or_else(String::new, |c| self.study.groups[c.group].id.clone()),
                    left: trial.left.to_string(),
                    right: trial.right.to_string(),
                });
            }
        }
        key
    }

    /// Code names by what is on the left, then on the right. A study's stimuli are all that its forms show.
    fn codes(&self) -> BTreeMap<ConfigurationId, BTreeMap<ConfigurationId, String>> {
        let mut codes: BTreeMap<_, BTreeMap<_, _>> = BTreeMap::new();
        for Stimulus { code, left, right } in self.study.stimuli() {
            codes.entry(left).or_default().insert(right, code);
        }
        codes
    }
}

/// Most people, finished or answering. They may change while a study runs, and are no part of its [`FormFile`].
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Quotas {
    /// For each form.
    pub per_form: Option<u32>,
    /// For the options of questions about the person, by id; 0 for any number.
    pub options: Vec<(String, Vec<u32>)>,
}

impl Study {
    /// Every pair of animations that has to be made: the comparisons as listed, then what else the forms show.
    pub fn stimuli(&self) -> Vec<Stimulus> {
        let (_, codes) = self.code_names();
        let pairs = self.pairs().into_iter();
        pairs.zip(codes).map(|((left, right), code)| Stimulus { code, left, right }).collect()
    }
}

/// Two configurations side by side, as one animation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stimulus {
    /// Its code name.
    pub code: String,
    /// On the left.
    pub left: ConfigurationId,
    /// On the right.
    pub right: ConfigurationId,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::tests::load;

    #[test]
    fn the_file_tells_nothing_and_the_key_everything() {
        let study = load("balanced.toml");
        let questionnaire = Questionnaire::of(&study).unwrap();
        let (file, key) = (questionnaire.file(), questionnaire.key());
        let text = serde_json::to_string(&file).unwrap();
        for id in study.configurations.iter().map(|c| c.id.to_string()) {
            assert!(!text.contains(&id), "{id}");
        }
        for word in ["control", "repeat", "left\"", "2026", "mirrored", "block"] {
            assert!(!text.contains(word), "{word}");
        }
        assert_eq!(serde_json::from_str::<FormFile>(&text).unwrap(), file);

        assert_eq!(file.forms.len(), 36);
        assert_eq!(key.len(), 36 * 33);
        let codes: BTreeMap<String, (String, String)> = study
            .stimuli()
            .into_iter()
            .map(|s| (s.code, (s.left.to_string(), s.right.to_string())))
            .collect();
        let mut lines = key.iter();
        for form in &file.forms {
            assert_eq!((form.training.len(), form.questions.len()), (1, 32));
            for (order, stimulus) in (1..).zip(form.training.iter().chain(&form.questions)) {
                let line = lines.next().unwrap();
                assert_eq!((line.form, line.order, &line.stimulus), (form.form, order, stimulus));
                assert_eq!(codes[stimulus], (line.left.clone(), line.right.clone()));
                assert_eq!(line.role == Role::Training, order == 1);
            }
        }
        let of = |role: Role| key.iter().filter(move |line| line.role == role);
        assert!(of(Role::Control).all(|line| line.left == line.right && line.group.is_empty()));
        assert!(of(Role::Repeat).all(|line| line.question.starts_with('Q') && !line.group.is_empty()));
    }

    #[test]
    fn code_names_say_nothing_of_order() {
        let study = load("balanced.toml");
        let stimuli = study.stimuli();
        // 27 comparisons both ways round, and two controls; training is one of the comparisons.
        assert_eq!(stimuli.len(), 2 * 27 + 2);
        let mut sorted: Vec<&str> = stimuli.iter().map(|s| s.code.as_str()).collect();
        assert!(!sorted.is_sorted());
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), stimuli.len());
    }
}
