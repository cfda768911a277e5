//! Studies whose forms are dealt as for people, so that probes are tried on designs that people use.

use isostudy_design::forms::Questionnaire;
use isostudy_design::machine::CpuProfile;
use isostudy_design::{ConfigurationId, Study};
use isostudy_responses::{Question, Responses, SidesSource};
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// Participants that are planned.
pub(super) const PEOPLE: usize = 36;

/// How the questions are dealt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Design {
    /// Six methods, three objects, 27 comparisons, three repeats, two controls; order by Latin square.
    Latin,
    /// The same in shuffled order.
    Shuffled,
    /// The same in three blocks of nine comparisons.
    Blocks,
    /// Four methods, two objects, twelve comparisons, two repeats, two controls.
    FourMethods,
    /// Two methods, two objects, two comparisons, both repeated, two controls.
    TwoMethods,
}

impl Design {
    /// Every design.
    pub const ALL: [Self; 5] =
        [Self::Latin, Self::Shuffled, Self::Blocks, Self::FourMethods, Self::TwoMethods];

    /// For people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Latin => "balanced, Latin square",
            Self::Shuffled => "balanced, shuffled",
            Self::Blocks => "three blocks",
            Self::FourMethods => "four methods",
            Self::TwoMethods => "two methods",
        }
    }

    /// The study with its forms.
    pub(super) fn dealt(self) -> &'static Dealt {
        static ALL: [OnceLock<Dealt>; Design::ALL.len()] = [const { OnceLock::new() }; Design::ALL.len()];
        ALL[self as usize].get_or_init(|| Dealt::of(self))
    }

    /// Letters of the methods of each group, and how many objects there are.
    fn methods(self) -> (&'static [&'static [&'static str]], usize) {
        match self {
            Self::Latin | Self::Shuffled | Self::Blocks => {
                (&[&["bu", "bi", "bp"], &["su", "si", "sp"], &["su", "bu"], &["si", "bi"], &["sp", "bp"]], 3)
            }
            Self::FourMethods => (&[&["bu", "bi", "bp", "bc"]], 2),
            Self::TwoMethods => (&[&["bu", "bi"]], 2),
        }
    }

    /// What a study file says of it.
    fn text(self) -> String {
        let (groups, objects) = self.methods();
        let (arrangements, clusterings) = match self {
            Self::FourMethods => {
                (r#""body-centred""#, r#""none", "integrated", "edge-collapse", "integrated-collapse""#)
            }
            Self::TwoMethods => (r#""body-centred""#, r#""none", "integrated""#),
            _ => (r#""body-centred", "simple-cubic""#, r#""none", "integrated", "edge-collapse""#),
        };
        let mut comparisons = Vec::new();
        for object in 0..objects {
            for members in groups {
                let pairs = (0..members.len()).flat_map(|a| (a + 1..members.len()).map(move |b| (a, b)));
                for (a, b) in pairs {
                    let sides = [members[a], members[b]].map(|method| format!("o{object}_{method}"));
                    let question = comparisons.len() + 1;
                    comparisons.push(format!(
                        r#"{{ question = "Q{question}", left = "{}", right = "{}" }}"#,
                        sides[0], sides[1]
                    ));
                }
            }
        }
        let (order, repeats, most) = match self {
            Self::Latin => ("latin-square", 3, 32),
            Self::Shuffled => ("shuffled", 3, 32),
            Self::Blocks => ("latin-square", 3, 14),
            Self::FourMethods => ("latin-square", 2, 16),
            Self::TwoMethods => ("latin-square", 2, 6),
        };
        let mut text = format!(
            "schema = 1\narrangements = [{arrangements}]\nclusterings = [{clusterings}]\ncomparisons = [{}]\n{SECTIONS}\
             [forms]\nprompt = \"Which?\"\nchoices = [\"Left\", \"No preference\", \"Right\"]\nparticipants = {PEOPLE}\n\
             sides = \"balanced\"\norder = \"{order}\"\nnames = \"code-names\"\ncontrols = 2\nrepeats = {repeats}\n\
             max_questions = {most}\n",
            comparisons.join(", ")
        );
        for object in 0..objects {
            text += &format!("[[objects]]\nid = \"o{object}\"\nname = \"object {}\"\n{OBJECT}", object + 1);
        }
        for (number, members) in groups.iter().enumerate() {
            let id = ["A", "B", "C", "D", "E"][number];
            text += &format!("[[groups]]\nid = \"{id}\"\nlabel = \"group {id}\"\nmembers = {members:?}\n");
        }
        text
    }
}

/// What a study needs beside its questions; nothing is made of it.
const SECTIONS: &str = r#"
[study]
id = "self-test"
title = "Self-test"
seed = 7
[limits]
memory_gib = 1.0
[extraction]
positions = "indexed"
[turntable]
width = 64
height = 64
frames = 10
duration_s = 1.0
elevation_rad = 0.5
near = 1e-4
far = 100.0
supersampling = 1
[shading]
light = [-0.6, 0.2, -0.8]
lit = [0.9, 0.5, 0.0]
shade = [0.2, 0.0, 0.3]
highlight = [1.0, 0.9, 0.8]
background = [0.0, 0.5, 0.5]
[stimuli]
pair_scale = 1
[benchmark]
warmup = 1
iterations = 2
short_iterations = 1
threads = 1
target = "any.toml"
"#;

const OBJECT: &str = "field = { kind = \"sphere\", radius = 0.8 }\nisovalue = 0.0\nmin = [-1.0, -1.0, -1.0]\n\
    max = [1.0, 1.0, 1.0]\nbenchmark_spacing = 0.2\nstimulus_spacing = 0.2\n\
    camera = { distance = 1.2, vertical_fov_rad = 1.0 }\n";

/// A study, and what its planned participants are asked.
pub(super) struct Dealt {
    pub(super) study: Study,
    /// By participant and place.
    pub(super) forms: Vec<Vec<Asked>>,
    /// The questions as a file of answers has them; no answers.
    pub(super) unanswered: Responses,
    /// The code name of each stimulus.
    pub(super) codes: Vec<String>,
}

/// One place of a form.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked {
    pub(super) question: u32,
    /// Configurations left and right.
    pub(super) sides: [u32; 2],
    /// Place of the shown file among the study's stimuli.
    pub(super) stimulus: u32,
}

impl Dealt {
    fn of(design: Design) -> Self {
        let any = CpuProfile::parse("name = \"any\"\nmodel = \"\"\n", "any.toml".as_ref());
        let study =
            any.and_then(|any| Study::in_memory(&design.text(), any)).expect("sound, as a test proves");
        let item: BTreeMap<&ConfigurationId, u32> =
            study.configurations.iter().map(|c| &c.id).zip(0..).collect();
        let sides = |left: &ConfigurationId, right: &ConfigurationId| [item[left], item[right]];
        let stimuli = study.stimuli();
        let stimulus: BTreeMap<[u32; 2], u32> =
            stimuli.iter().map(|s| sides(&s.shown[0], &s.shown[1])).zip(0..).collect();
        let mut questions: Vec<Question> = study
            .comparisons
            .iter()
            .map(|c| Question::new(&c.question, &c.left.object, "", sides(&c.left, &c.right)))
            .collect();
        let questionnaire = Questionnaire::of(&study).expect("it plans forms");
        let mut asked = |trial: &isostudy_design::forms::Trial| {
            let sides = sides(&trial.shown[0], &trial.shown[1]);
            let known = questions.iter().position(|question| question.id == trial.question);
            let question = known.unwrap_or_else(|| {
                let own = Question::new(&trial.question, &trial.shown[0].object, "", sides);
                questions.push(Question { role: trial.role, ..own });
                questions.len() - 1
            });
            Asked { question: question as u32, sides, stimulus: stimulus[&sides] }
        };
        let forms = questionnaire.planned();
        let forms = forms.iter().map(|form| form.trials.iter().map(&mut asked).collect()).collect();
        let unanswered = Responses {
            items: study.configurations.iter().map(|c| c.id.to_string()).collect(),
            questions,
            sides_recorded: true,
            sides: SidesSource::InFile,
            ..Responses::default()
        };
        let codes = stimuli.into_iter().map(|s| s.code).collect();
        Self { study, forms, unanswered, codes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_design_is_sound_and_dealt_to_all() {
        let asked = [32, 32, 14, 16, 6];
        for (design, asked) in Design::ALL.into_iter().zip(asked) {
            let dealt = design.dealt();
            assert_eq!(dealt.forms.len(), PEOPLE);
            assert!(dealt.forms.iter().all(|form| form.len() == asked), "{design:?}");
        }
        assert_eq!(Design::Blocks.dealt().unanswered.questions.len(), 27 + 9 + 2);
    }
}
