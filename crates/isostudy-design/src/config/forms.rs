//! How the questions are put to people.

use super::about::AboutSection;
use super::way::Way;
use super::{perhaps_whole, whole};
use crate::method::ConfigurationId;
use crate::texts::{Texts, english};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Which configuration of a comparison is on the left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SideRule {
    /// Balanced within a form and over participants.
    Balanced,
    /// As the comparisons are listed, for everybody.
    AsListed,
}

/// In which order a participant is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OrderRule {
    /// Every question at every place equally often.
    LatinSquare,
    /// At random for each participant.
    Shuffled,
    /// As listed, for everybody.
    AsListed,
}

/// What participants can read off a stimulus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShownNames {
    /// Code names that say nothing.
    CodeNames,
    /// The ids of the configurations.
    ConfigurationIds,
}

/// As what participants see the two surfaces of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Presentation {
    /// Animations that turn by themselves.
    #[default]
    Turntable,
    /// Models that participants turn, both as one; turntables where a browser draws no models.
    Model,
}

impl Presentation {
    pub(crate) fn is_turntable(&self) -> bool {
        *self == Self::Turntable
    }
}

/// How the questions are put to people.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FormsSection {
    /// What is asked about each pair.
    pub prompt: String,
    /// How people are asked.
    #[serde(default, skip_serializing_if = "Way::is_pairs")]
    pub way: Way,
    /// The answers, left to right, such as left, no preference, right; none for the shipped texts.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub choices: Vec<String>,
    /// The answers where one surface is over the other, on screens higher than wide: such as upper, no preference, lower.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub choices_stacked: Option<Vec<String>>,
    /// Steps of the scale on which surfaces are rated, from 1.
    #[serde(default = "steps", deserialize_with = "whole", skip_serializing_if = "is_steps")]
    pub steps: u32,
    /// What the first and the last step mean; none for the shipped texts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ends: Option<[String; 2]>,
    /// Whether people may take none of several surfaces.
    #[serde(default, skip_serializing_if = "is_false")]
    pub none: bool,
    /// Least width of each surface on the screen, in CSS pixels, at which it can be judged.
    #[serde(default, deserialize_with = "perhaps_whole", skip_serializing_if = "Option::is_none")]
    pub min_surface_px: Option<u32>,
    /// How many participants are planned.
    #[serde(deserialize_with = "whole")]
    pub participants: u32,
    /// Which configuration of a comparison is on the left.
    pub sides: SideRule,
    /// In which order a participant is asked.
    pub order: OrderRule,
    /// What participants can read off a stimulus.
    pub names: ShownNames,
    /// Pairs of one configuration with itself in a form.
    #[serde(deserialize_with = "whole")]
    pub controls: u32,
    /// Comparisons asked twice in a form, the second time with the sides swapped.
    #[serde(deserialize_with = "whole")]
    pub repeats: u32,
    /// Most questions that one participant is asked, training left out.
    #[serde(deserialize_with = "whole")]
    pub max_questions: u32,
    /// Pairs shown first, to learn how it works.
    #[serde(default)]
    pub training: Vec<TrainingSection>,
    /// What participants agree to before they begin.
    #[serde(default = "consent")]
    pub consent: String,
    /// What they are told to do.
    #[serde(default = "instructions")]
    pub instructions: String,
    /// Whole-number enlargement of the pairs by the page, nearest neighbour.
    #[serde(default = "once", deserialize_with = "whole")]
    pub page_scale: u32,
    /// As what participants see a pair.
    #[serde(default, skip_serializing_if = "Presentation::is_turntable")]
    pub stimulus: Presentation,
    /// Folder with the library that draws models, unless the viewer names it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub three: Option<String>,
    /// Most megabytes that one participant loads; `isostudy bundle` makes the pairs small enough.
    #[serde(default = "web_mb", deserialize_with = "whole", skip_serializing_if = "is_web_mb")]
    pub web_mb: u32,
    /// A code or an `https://` address that participants get from the server when their last answer is saved.
    pub completion: Option<String>,
    /// Languages of the page as in `lang` of HTML. The study's other texts are in the first.
    #[serde(default = "languages", skip_serializing_if = "is_english_alone")]
    pub languages: Vec<String>,
    /// Texts of the page by language and key, in place of the shipped ones.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub texts: BTreeMap<String, Texts>,
    /// Files of such texts by language.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub texts_files: BTreeMap<String, String>,
    /// Questions about the person.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub about: Vec<AboutSection>,
    /// Whether questions about the person may take words.
    #[serde(default, skip_serializing_if = "is_false")]
    pub free_text: bool,
    /// Whether a free comment is asked for at the end.
    #[serde(default, skip_serializing_if = "is_false")]
    pub comment: bool,
    /// Whom participants can ask.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<String>,
    /// Who has approved the study, and under which number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ethics: Option<String>,
    /// Least age of participants, in years.
    #[serde(default, deserialize_with = "perhaps_whole", skip_serializing_if = "Option::is_none")]
    pub least_age: Option<u32>,
    /// For how many days after its end the study keeps answers.
    #[serde(default, deserialize_with = "perhaps_whole", skip_serializing_if = "Option::is_none")]
    pub retention_days: Option<u32>,
    /// Who sends participants, and names them in the page's address.
    #[serde(default, skip_serializing_if = "Panel::is_prolific")]
    pub panel: Panel,
    /// As `completion`, for those who withdrew.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub completion_withdrawn: Option<String>,
    /// As `completion`, for those who were screened out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub completion_screened: Option<String>,
    /// As `completion`, for those who came when the study was full.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub completion_full: Option<String>,
    /// Most people for each form, finished or answering.
    #[serde(default, deserialize_with = "perhaps_whole", skip_serializing_if = "Option::is_none")]
    pub per_form: Option<u32>,
    /// Whether participants may change their last answer.
    #[serde(default, skip_serializing_if = "is_false")]
    pub go_back: bool,
    /// Whether a server chooses half of a participant's questions by what others have answered.
    #[serde(default, skip_serializing_if = "is_false")]
    pub adaptive: bool,
}

/// Who sends participants.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Panel {
    /// Prolific: `PROLIFIC_PID`, `STUDY_ID`, `SESSION_ID`.
    #[default]
    Prolific,
    /// Amazon Mechanical Turk: `workerId`, `hitId`, `assignmentId`.
    MTurk,
    /// SONA: `survey_code`.
    Sona,
}

impl Panel {
    /// What the address calls the person, the study and the session; SONA's code stands for person and session.
    pub fn names(self) -> [Option<&'static str>; 3] {
        match self {
            Self::Prolific => ["PROLIFIC_PID", "STUDY_ID", "SESSION_ID"].map(Some),
            Self::MTurk => ["workerId", "hitId", "assignmentId"].map(Some),
            Self::Sona => [Some("survey_code"), None, Some("survey_code")],
        }
    }

    pub(crate) fn is_prolific(&self) -> bool {
        *self == Self::Prolific
    }
}

pub(crate) fn is_false(value: &bool) -> bool {
    !value
}

fn consent() -> String {
    english()["consent"].clone()
}

fn instructions() -> String {
    english()["instructions"].clone()
}

pub(crate) fn languages() -> Vec<String> {
    vec!["en".into()]
}

pub(crate) fn is_english_alone(languages: &[String]) -> bool {
    languages == ["en"]
}

pub(crate) fn steps() -> u32 {
    7
}

pub(crate) fn is_steps(value: &u32) -> bool {
    *value == steps()
}

fn once() -> u32 {
    1
}

/// A minute and a half on a line of 3.5 Mbit/s, which is spent while pairs are judged.
fn web_mb() -> u32 {
    40
}

fn is_web_mb(value: &u32) -> bool {
    *value == web_mb()
}

/// A pair to learn with.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingSection {
    /// Shown on the left.
    pub left: ConfigurationId,
    /// Shown on the right.
    pub right: ConfigurationId,
}
