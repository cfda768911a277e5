//! Forms as a file for whoever puts them to people, and the key for whoever reads the answers.

use super::about::AboutEntry;
use super::{Form, Questionnaire, Role, Trial};
use crate::config::{
    AboutSection, AnswerKind, ENDS, Presentation, Way, is_english_alone, is_false, is_steps, languages, steps,
};
use crate::method::ConfigurationId;
use crate::study::{Comparison, Study};
use crate::texts::{ENGLISH, Texts, english, shipped};
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
    /// How people are asked.
    #[serde(default, skip_serializing_if = "Way::is_pairs")]
    pub way: Way,
    /// The answers, left to right, such as left, no preference, right.
    pub choices: Vec<String>,
    /// The answers where one surface is over the other, unless they follow from `choices`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub choices_stacked: Option<Vec<String>>,
    /// Steps of the scale on which surfaces are rated, from 1.
    #[serde(default = "steps", skip_serializing_if = "is_steps")]
    pub steps: u32,
    /// What the first and the last step mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ends: Option<[String; 2]>,
    /// Whether people may take none of several surfaces.
    #[serde(default, skip_serializing_if = "is_false")]
    pub none: bool,
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

/// The form of lines of the key that are of no form: what a server may show anybody.
pub const ANY_FORM: usize = 0;

/// A line of the key to forms: what a participant was shown at a place. Never to be given to participants.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyEntry {
    /// The form's number, from 1; [`ANY_FORM`] of what a server may choose.
    pub form: usize,
    /// Place in the form, from 1, training included; 0 of what a server may choose.
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
    /// Configuration on the left; empty where people do not compare two.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub left: String,
    /// Configuration on the right.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub right: String,
    /// Where people do not compare two: every configuration that is shown, in the order of their places, spaces between.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub shown: String,
}

impl FormFile {
    /// The answers that people can give, in order.
    pub fn answers(&self) -> Vec<AnswerKind> {
        self.way.answers_of(self.steps, self.none)
    }
}

impl Questionnaire<'_> {
    /// The planned forms, for participants.
    pub fn file(&self) -> FormFile {
        let codes = self.codes();
        let entry = |form: &Form| {
            let of = |training: bool| {
                let own = form.trials.iter().filter(|trial| (trial.role == Role::Training) == training);
                own.map(|trial| codes[&trial.shown].clone()).collect()
            };
            FormEntry { form: form.participant + 1, training: of(true), questions: of(false) }
        };
        FormFile {
            schema: 1,
            study: self.study.file.study.id.clone(),
            title: self.study.file.study.title.clone(),
            prompt: self.section.prompt.clone(),
            way: self.section.way,
            choices: self.choices(),
            steps: self.section.steps,
            ends: (self.section.way == Way::Ratings).then(|| self.ends()),
            none: self.section.none,
            choices_stacked: self.section.choices_stacked.clone(),
            min_surface_px: self.section.min_surface_px,
            languages: self.section.languages.clone(),
            texts: self.study.texts.clone(),
            consent: self.usual("consent", &self.section.consent),
            instructions: self.usual("instructions", &self.section.instructions),
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

    /// The answers in the study's first language: its own texts, or those of the language.
    fn choices(&self) -> Vec<String> {
        if !self.section.choices.is_empty() {
            return self.section.choices.clone();
        }
        let answers = self.section.way.answers_of(self.section.steps, self.section.none);
        answers.iter().filter(|of| !of.text.is_empty()).map(|of| self.text(of.text)).collect()
    }

    /// What the ends of the scale mean in the study's first language.
    fn ends(&self) -> [String; 2] {
        self.section.ends.clone().unwrap_or_else(|| ENDS.map(|key| self.text(key)))
    }

    /// A text of the page in the study's first language, which it does not say in [forms].
    fn text(&self, key: &str) -> String {
        let lang = self.section.languages.first().map_or(ENGLISH, String::as_str);
        let own = self.study.texts.get(lang).and_then(|texts| texts.get(key));
        own.or_else(|| shipped(lang)?.get(key)).unwrap_or_else(|| &english()[key]).clone()
    }

    /// A text of the study; where nobody wrote it, that of the way to ask.
    fn usual(&self, key: &str, text: &str) -> String {
        if text == english()[key] {
            english()[self.section.way.instead(key)].clone()
        } else {
            text.to_owned()
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

    /// What each place of each planned form shows. Where a server chooses questions, everything that it may choose follows, in
    /// [`ANY_FORM`].
    pub fn key(&self) -> Vec<KeyEntry> {
        let codes = self.codes();
        let planned = self.planned();
        let of_form = |form: &Form| {
            let entry = |(place, trial): (usize, &Trial)| {
                self.key_entry(trial, (form.participant + 1, place + 1), codes[&trial.shown].clone())
            };
            form.trials.iter().enumerate().map(entry).collect::<Vec<_>>()
        };
        let mut key: Vec<KeyEntry> = planned.iter().flat_map(of_form).collect();
        if self.section.adaptive {
            key.extend(
                self.choices_of_server()
                    .iter()
                    .map(|trial| self.key_entry(trial, (ANY_FORM, 0), codes[&trial.shown].clone())),
            );
        }
        key
    }

    fn key_entry(&self, trial: &Trial, (form, order): (usize, usize), stimulus: String) -> KeyEntry {
        let comparison = trial.comparison.map(|i| &self.study.comparisons[i]);
        let objects = &self.study.file.objects;
        let object = objects.iter().find(|object| object.id == trial.shown[0].object);
        let of_pair = self.section.way.is_of_pairs();
        let names: Vec<String> = trial.shown.iter().map(ToString::to_string).collect();
        KeyEntry {
            form,
            order,
            stimulus,
            role: trial.role,
            question: trial.question.clone(),
            object: object.map_or_else(String::new, |object| object.name.clone()),
            group: comparison.map_or_else(String::new, |c| self.study.groups[c.group].id.clone()),
            left: names.first().filter(|_| of_pair).cloned().unwrap_or_default(),
            right: names.get(1).filter(|_| of_pair).cloned().unwrap_or_default(),
            shown: if of_pair { String::new() } else { names.join(" ") },
        }
    }

    /// Every comparison on each of the sides on which there is a stimulus of it.
    fn choices_of_server(&self) -> Vec<Trial> {
        let known = self.codes();
        let of = |(i, comparison): (usize, &Comparison)| {
            let both = [
                vec![comparison.left.clone(), comparison.right.clone()],
                vec![comparison.right.clone(), comparison.left.clone()],
            ];
            let question = &comparison.question;
            let trial = |shown| Trial {
                role: Role::Comparison,
                question: question.clone(),
                comparison: Some(i),
                shown,
            };
            both.into_iter().filter(|shown| known.contains_key(shown)).map(trial).collect::<Vec<_>>()
        };
        self.study.comparisons.iter().enumerate().flat_map(of).collect()
    }

    /// Code names by what is shown. A study's stimuli are all that its forms show.
    fn codes(&self) -> BTreeMap<Vec<ConfigurationId>, String> {
        self.study.stimuli().into_iter().map(|of| (of.shown, of.code)).collect()
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
    /// Every animation for participants that has to be made: of pairs the comparisons as listed, then what else the forms show.
    pub fn stimuli(&self) -> Vec<Stimulus> {
        let (_, codes) = self.code_names();
        self.pairs().into_iter().zip(codes).map(|(shown, code)| Stimulus { code, shown }).collect()
    }
}

/// Configurations side by side, as one animation: two, or as many as the way to ask shows at once.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stimulus {
    /// Its code name.
    pub code: String,
    /// Left to right.
    pub shown: Vec<ConfigurationId>,
}

impl Stimulus {
    /// The left and the right one of a pair.
    pub fn pair(&self) -> Option<[&ConfigurationId; 2]> {
        match &self.shown[..] {
            [left, right] => Some([left, right]),
            _ => None,
        }
    }
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
            .map(|s| (s.code, (s.shown[0].to_string(), s.shown[1].to_string())))
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
