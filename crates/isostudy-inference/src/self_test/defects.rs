//! Studies with one planted defect, answered through the forms that they deal.

use super::studies::{Dealt, Design, PEOPLE};
use crate::audit::{Probe, Report, audit};
use crate::ballots::{ballot_groups, ballots, method_of_item};
use crate::recorded::Recorded;
use isostudy_design::Factor;
use isostudy_responses::{Answer, Choice, Participant, Responses, StimulusId};
use isostudy_statistics::Outcome;
use isostudy_statistics::simulation::{davidson, draw, normal, stream};
use rand_pcg::Pcg64;

/// Tie parameter: two equal items tie with chance nu / (2 + nu).
const NU: f64 = 0.3;
/// Difference between people, in logits.
const SD: f64 = 0.5;
/// How the studies are, for people.
/// What the studies with one defect are.
pub const DESCRIPTION: &str = "36 people, forms as they are dealt, orders and times recorded; Davidson's model with tie \
    parameter 0.3, people 0.5 logits apart; with preferences, clusterings are 1.5 logits apart (1 of four methods) and lattices 1";

/// What is shown in the table and not asked for, for people.
/// What is not asked of probes, and why.
pub const TOO_FEW: &str = "Not asked for, because answers are too few: an outlying respondent in three blocks and of four \
    methods; there, without orders and times, a copied row; turned answers in three blocks; a side of 0.8 logits of two methods.";

/// What is wrong with a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Defect {
    /// Nothing; people have preferences or not, and favour the left side by so many tenths of a logit.
    None {
        /// Whether people have preferences.
        preferences: bool,
        /// What they favour the left side by, in tenths of a logit.
        side: u8,
    },
    /// Respondent 8 prefers everything the other way round.
    OutlyingRespondent,
    /// Respondent 17's row is respondent 5's; neither orders nor times are recorded.
    CopiedRows,
    /// Respondent 17's orders and times are respondent 5's; the answers are not.
    CopiedTimes,
    /// The key has the sides of one file mixed up, and the answers tell the file's code name.
    CodeName,
    /// The key has the sides of one file mixed up.
    OneFile,
    /// The key has the sides of both files of a pair mixed up.
    BothFiles,
    /// The answers to one file were turned, and their labels were not.
    TurnedAnswers,
    /// On the first object preferences are the other way round.
    ObjectInteraction,
    /// One method is chosen always.
    Separation,
    /// Respondents 4, 9, 14 and so on press left throughout, among others with preferences: both ways round of the forms.
    PressingLeft,
    /// Respondents 4, 10, 16 and so on press left throughout, among others with preferences: one way round of the forms.
    PressingLeftAlike,
}

impl Defect {
    /// The studies without a defect, then every defect.
    pub const ALL: [Self; 19] = [
        Self::None { preferences: false, side: 0 },
        Self::None { preferences: true, side: 0 },
        Self::None { preferences: false, side: 8 },
        Self::None { preferences: true, side: 8 },
        Self::None { preferences: false, side: 15 },
        Self::None { preferences: true, side: 15 },
        Self::None { preferences: false, side: 25 },
        Self::None { preferences: true, side: 25 },
        Self::OutlyingRespondent,
        Self::CopiedRows,
        Self::CopiedTimes,
        Self::CodeName,
        Self::OneFile,
        Self::BothFiles,
        Self::TurnedAnswers,
        Self::ObjectInteraction,
        Self::Separation,
        Self::PressingLeft,
        Self::PressingLeftAlike,
    ];

    /// The probe that has to find it.
    pub fn probe(self) -> Option<Probe> {
        match self {
            Self::None { side: 0, .. } | Self::PressingLeft | Self::PressingLeftAlike => None,
            Self::None { .. } => Some(Probe::Side),
            Self::OutlyingRespondent => Some(Probe::OutlyingRespondent),
            Self::CopiedRows | Self::CopiedTimes => Some(Probe::CopiedRows),
            Self::CodeName | Self::OneFile | Self::BothFiles | Self::TurnedAnswers => Some(Probe::SwappedKey),
            Self::ObjectInteraction => Some(Probe::ObjectInteraction),
            Self::Separation => Some(Probe::Separation),
        }
    }

    /// For people.
    pub fn label(self) -> String {
        match self {
            Self::None { preferences: false, side: 0 } => "no effect".into(),
            Self::None { preferences: true, side: 0 } => "preferences".into(),
            Self::None { preferences, side } => {
                let by = f64::from(side) / 10.0;
                let of = if preferences { "preferences and left side" } else { "left side" };
                format!("{of}, {by:.1} logits")
            }
            Self::OutlyingRespondent => "one outlying respondent".into(),
            Self::CopiedRows => "copied row".into(),
            Self::CopiedTimes => "copied times".into(),
            Self::CodeName => "wrong key: one file, code names recorded".into(),
            Self::OneFile => "wrong key: one file".into(),
            Self::BothFiles => "wrong key: both files of a pair".into(),
            Self::TurnedAnswers => "answers to one file turned".into(),
            Self::ObjectInteraction => "object interaction".into(),
            Self::Separation => "separation".into(),
            Self::PressingLeft => "seven respondents press left throughout".into(),
            Self::PressingLeftAlike => "six press left throughout, forms the same way round".into(),
        }
    }

    /// Whether a probe that speaks up is right to, though the defect is not its own: some respondents with a side and no preference
    /// of their own are a side, and outlying.
    pub(super) fn may_be_seen_by(self, probe: Probe) -> bool {
        matches!(self, Self::PressingLeft | Self::PressingLeftAlike)
            && matches!(probe, Probe::Side | Probe::OutlyingRespondent)
    }

    /// Whether so many answers are enough to find it, dealt like this.
    pub fn is_told_by(self, design: Design) -> bool {
        match design {
            Design::Latin | Design::Shuffled => true,
            Design::Blocks => {
                !matches!(self, Self::OutlyingRespondent | Self::CopiedRows | Self::TurnedAnswers)
            }
            Design::FourMethods => !matches!(self, Self::OutlyingRespondent | Self::CopiedRows),
            Design::TwoMethods => !matches!(self, Self::None { side: 8, .. }),
        }
    }

    /// Whether it is planted: of two pairs, turned answers to one file are what a side and an object make as well.
    pub(super) fn is_planted(self, design: Design) -> bool {
        (self, design) != (Self::TurnedAnswers, Design::TwoMethods)
    }

    fn has_preferences(self) -> bool {
        !matches!(self, Self::None { preferences: false, .. })
    }

    /// What people favour the left side by, in logits.
    fn side(self) -> f64 {
        if let Self::None { side, .. } = self { f64::from(side) / 10.0 } else { 0.0 }
    }
}

/// A simulated study.
#[derive(Debug, Clone, PartialEq)]
pub struct Planted {
    /// How it was dealt.
    pub design: Design,
    /// What was answered, as it would be read.
    pub responses: Responses,
}

impl Planted {
    /// Runs every probe.
    pub fn audit(&self) -> Vec<Report> {
        let study = &self.design.dealt().study;
        let shown = ballots(study, &self.responses);
        let groups = ballot_groups(study, &shown);
        audit(&Recorded::of_study(study, &self.responses, &shown).audited(&groups))
    }
}

/// Study number `study` with a defect. The same numbers, the same study.
pub fn planted(defect: Defect, design: Design, seed: u64, study: u64) -> Planted {
    let dealt = design.dealt();
    let mut numbers = stream(seed, study);
    let mut responses = answered(dealt, &Worths::of(dealt, defect), defect.side(), &mut numbers);
    match defect {
        Defect::CopiedRows => {
            responses.answers.iter_mut().for_each(|answer| (answer.order, answer.rt_ms) = (None, None));
            copy(&mut responses, |copied, _| copied);
        }
        Defect::CopiedTimes => copy(&mut responses, |copied, own| Answer { choice: own, ..copied }),
        Defect::CodeName => {
            responses.stimuli.clone_from(&dealt.codes);
            let codes: Vec<u32> =
                dealt.forms[..PEOPLE].iter().flatten().map(|asked| asked.stimulus).collect();
            let coded = responses.answers.iter_mut().zip(codes);
            coded.for_each(|(answer, code)| answer.stimulus = Some(StimulusId::new(code)));
            mix_up(&mut responses, dealt, false);
        }
        Defect::OneFile => mix_up(&mut responses, dealt, false),
        Defect::BothFiles => mix_up(&mut responses, dealt, true),
        Defect::TurnedAnswers => {
            let sides = mixed_up(dealt);
            let of_file = responses.answers.iter_mut().filter(|answer| [answer.left, answer.right] == sides);
            of_file.for_each(|answer| answer.choice = answer.choice.swapped());
        }
        Defect::PressingLeft => press_left(&mut responses, 5),
        Defect::PressingLeftAlike => press_left(&mut responses, 6),
        _ => {}
    }
    Planted { design, responses }
}

/// Log-worth of each configuration, and of one participant alone.
struct Worths {
    everybodys: Vec<f64>,
    of_the_eighth: Vec<f64>,
}

impl Worths {
    fn of(dealt: &Dealt, defect: Defect) -> Self {
        let study = &dealt.study;
        let (methods, objects) = (study.method_ids(), &study.file.objects);
        let [lattices, mergings] = [Factor(0), Factor(1)];
        let step = if study.factor(mergings).levels.len() > 3 { 1.0 } else { 1.5 };
        let place = |m: isostudy_design::MethodId| {
            let of = |factor| study.level_of(m, factor).map_or(0.0, |level| level.index as f64);
            step * of(mergings) + of(lattices)
        };
        let worth = |configuration: &isostudy_design::Configuration| {
            let method = configuration.id.method;
            let of_object = if objects[0].id == configuration.id.object { -1.0 } else { 1.0 };
            match defect {
                _ if !defect.has_preferences() => 0.0,
                Defect::ObjectInteraction => of_object * place(method),
                Defect::Separation if Some(&method) == methods.last() => 25.0,
                _ => place(method),
            }
        };
        let everybodys: Vec<f64> = study.configurations.iter().map(worth).collect();
        let turned = if defect == Defect::OutlyingRespondent { -1.0 } else { 1.0 };
        Self { of_the_eighth: everybodys.iter().map(|worth| turned * worth).collect(), everybodys }
    }
}

fn answered(dealt: &Dealt, worths: &Worths, side: f64, numbers: &mut Pcg64) -> Responses {
    let mut responses = dealt.unanswered.clone();
    let method = method_of_item(&dealt.study, &responses);
    // Two independent deviations of sd / sqrt(2) differ by sd.
    let scale = SD / std::f64::consts::SQRT_2;
    for (participant, form) in dealt.forms.iter().enumerate() {
        let number = (participant + 1).to_string();
        responses.participants.push(Participant { id: format!("p{number}"), form: Some(number) });
        let worths = if participant == 7 { &worths.of_the_eighth } else { &worths.everybodys };
        let deviations: Vec<f64> = dealt.study.methods.iter().map(|_| scale * normal(numbers)).collect();
        let speed = 8.0 + 0.3 * normal(numbers);
        for (order, asked) in (1..).zip(form) {
            let own = asked.sides.map(|item| worths[item as usize] + deviations[method[item as usize]]);
            let choice = match draw(davidson(own[0] - own[1] + side, NU), numbers) {
                Outcome::Left => Choice::Left,
                Outcome::Tie => Choice::NoPreference,
                Outcome::Right => Choice::Right,
            };
            let rt_ms = Some((speed + 0.5 * normal(numbers)).exp().round() as f32);
            let answer = Answer::new(participant as u32, asked.question, asked.sides, choice);
            responses.answers.push(Answer { order: Some(order), rt_ms, ..answer });
        }
    }
    responses
}

/// The fifth respondent's rows instead of the seventeenth's, changed given the choices that these had.
fn copy(responses: &mut Responses, changed: impl Fn(Answer, Choice) -> Answer) {
    let of = |participant: u32| responses.answers.iter().filter(move |a| a.participant == participant);
    let own = |copied: &Answer| {
        let own = of(16).find(|own| own.question == copied.question).expect("of the same block");
        if own.left == copied.left { own.choice } else { own.choice.swapped() }
    };
    let copied: Vec<Answer> = of(4).map(|a| changed(Answer { participant: 16, ..*a }, own(a))).collect();
    responses.participants[16].form = responses.participants[4].form.clone();
    let own = responses.answers.iter_mut().filter(|answer| answer.participant == 16);
    own.zip(copied).for_each(|(answer, copied)| *answer = copied);
}

/// Every so many people, from the fourth, press left throughout.
fn press_left(responses: &mut Responses, every: u32) {
    let careless = responses.answers.iter_mut().filter(|answer| answer.participant % every == 3);
    careless.for_each(|answer| answer.choice = Choice::Left);
}

/// The file whose sides are mixed up: of the pairs on the first object one that people judge very differently.
fn mixed_up(dealt: &Dealt) -> [u32; 2] {
    let place = [0, 1, 2][dealt.study.factor(Factor(1)).levels.len() - 2];
    let question = &dealt.unanswered.questions[place];
    [question.left, question.right]
}

/// Labels with the sides mixed up: of one file, or of both that show the pair.
fn mix_up(responses: &mut Responses, dealt: &Dealt, both: bool) {
    let [left, right] = mixed_up(dealt);
    for answer in &mut responses.answers {
        let shown = [answer.left, answer.right];
        if shown == [left, right] || (both && shown == [right, left]) {
            [answer.left, answer.right] = [shown[1], shown[0]];
        }
    }
}
