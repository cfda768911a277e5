//! Forms: what each participant is shown, in which order and on which side.
//!
//! A form is a function of the study and the participant's number, [`Questionnaire::form`], so any number of participants
//! can be dealt forms, one after the other, and the same study gives the same forms.
//!
//! # Guaranteed
//!
//! Whatever the number of participants dealt forms from the first on, with balanced sides and Latin-square order:
//! - Over participants, the times that a comparison is shown one way and the other differ by at most one, and so do the
//!   times that it appears at one place and at another among the forms of its block.
//! - Comparisons appear equally often to within one. Where [`FormsSection::max_questions`] is less than there are to
//!   ask, comparisons are dealt into blocks whose sizes differ by at most one; a participant is asked one block.
//! - Blocks do not tie pairs to people: of each pair of methods one block has as many comparisons as another, to within one.
//! - Within a form, a method is on the left as often as on the right, to within one, and so is each side of two methods
//!   that meet on several objects.
//! - A repeat shows its comparison the other way round, half a form away; in shuffled order too. As listed, repeats and then
//!   controls follow all comparisons. A control shows one configuration twice.
//! - Repeats favour nothing: over blocks, configurations appear through them as evenly as a search finds, then methods,
//!   pairs of methods and objects. Controls take methods evenly, then objects. Both are the same for all participants
//!   of a block: a place of the Latin square belongs to one question.
//!
//! Where people rate surfaces, or take the best of several, a block has single configurations or sets of them in the place of
//! comparisons:
//! - Ratings ask about every configuration of the comparisons once. Sets of an object's methods have each method equally often, to
//!   within one, and each two methods together as evenly as a search finds.
//! - Over participants, each configuration of a set is at each place equally often, to within one. A repeat shows it at other places.
//! - There are no controls.
//!
//! # Not guaranteed
//!
//! - That somebody is asked enough for every [contrast](crate::contrast), such as the same pair of methods on two objects. Blocks
//!   are searched for such that as few interactions as can be are left without, then as few differences between objects; then
//!   levels and groups are as even over blocks as can be, and blocks have whole triads: all pairs of three methods on one
//!   object. The linter says what blocks are too small for.
//! - Sides of two methods over blocks: with a multiple of twice as many participants as there are blocks they are even; with others
//!   they are as even as a search finds, and the linter says where they are not.
//! - Which question follows which: neighbours in a form are neighbours in most forms, in either order. Sources: a cyclic
//!   Latin square read alternately forwards and backwards; for squares balanced for neighbours see E. J. Williams,
//!   Australian Journal of Scientific Research A 2 (1949).

mod about;
mod file;
mod order;
mod several;
mod sides;
mod split;
mod spoken;
mod spread;
mod stimuli;

pub(crate) use about::texts as about_texts;
pub use about::{AboutEntry, Answers, COMMENT};
pub use file::{ANY_FORM, FormEntry, FormFile, KeyEntry, Quotas, Stimulus};
pub(crate) use several::{count as several, fewest};
pub use spoken::Language;

use crate::config::{FormsSection, OrderRule, SideRule};
use crate::method::ConfigurationId;
use crate::study::{Comparison, Study};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Why a participant is shown a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// To learn how it works; not analysed.
    Training,
    /// One of the study's comparisons.
    Comparison,
    /// The same configuration on both sides: a preference here is a sign of guessing.
    Control,
    /// A comparison of this form again, sides swapped: another answer is a sign of guessing, or of a side preference.
    Repeat,
}

/// One pair shown to one participant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Trial {
    /// Why.
    pub role: Role,
    /// The comparison's question; that and `-r` for its repeat; `control-1` and `training-1` and so on.
    pub question: String,
    /// Index into the study's comparisons, for comparisons and repeats.
    pub comparison: Option<usize>,
    /// What is shown, left to right: two, or as many as the way to ask shows at once.
    pub shown: Vec<ConfigurationId>,
}

impl Trial {
    /// The left and the right one of a pair.
    pub fn pair(&self) -> Option<[&ConfigurationId; 2]> {
        match &self.shown[..] {
            [left, right] => Some([left, right]),
            _ => None,
        }
    }

    /// Whether it asks about the same as another, on whatever sides.
    fn asks_the_same(&self, other: &Self) -> bool {
        let sorted = |of: &Self| {
            let mut shown = of.shown.clone();
            shown.sort_unstable();
            shown
        };
        self.comparison == other.comparison && sorted(self) == sorted(other)
    }
}

/// What one participant is shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Form {
    /// The participant's number, from 0.
    pub participant: usize,
    /// The block of comparisons, from 0.
    pub block: usize,
    /// Whether every side is the opposite of the block's first form's.
    pub mirrored: bool,
    /// The trials in order, training first.
    pub trials: Vec<Trial>,
}

impl Form {
    /// The study's comparisons that somebody who answers the form can be said to have judged, by their places: those that are asked;
    /// those of which both sides are rated; or those of which both sides stand in one set.
    pub fn comparisons(&self, study: &Study) -> BTreeSet<usize> {
        let asked = || self.trials.iter().filter(|trial| trial.role == Role::Comparison);
        if asked().any(|trial| trial.comparison.is_some()) {
            return asked().filter_map(|trial| trial.comparison).collect();
        }
        let rated: Vec<&ConfigurationId> =
            asked().filter(|trial| trial.shown.len() == 1).flat_map(|trial| &trial.shown).collect();
        let judged = |comparison: &Comparison| {
            let both = [&comparison.left, &comparison.right];
            both.iter().all(|id| rated.contains(id))
                || asked().any(|trial| both.iter().all(|id| trial.shown.contains(id)))
        };
        (0..study.comparisons.len()).filter(|&i| judged(&study.comparisons[i])).collect()
    }
}

/// A study's questionnaire, from which forms are dealt.
#[derive(Debug, Clone)]
pub struct Questionnaire<'a> {
    study: &'a Study,
    section: &'a FormsSection,
    blocks: Vec<Block>,
}

/// What the participants of a block are asked, sides as in its first form.
#[derive(Debug, Clone)]
struct Block {
    comparisons: Vec<Trial>,
    repeats: Vec<Trial>,
    controls: Vec<Trial>,
}

impl<'a> Questionnaire<'a> {
    /// The questionnaire of a study; `None` if it plans no forms or compares nothing.
    pub fn of(study: &'a Study) -> Option<Self> {
        let section = study.file.forms.as_ref().filter(|_| !study.comparisons.is_empty())?;
        if !section.way.is_of_pairs() {
            return Some(Self { study, section, blocks: several::blocks(study, section) });
        }
        let split = blocks(study, section);
        let repeated = repeated(study, section, &split);
        let controls = controls(study, section);
        let swapped = swapped(study, section, &split);
        let blocks = split.iter().zip(&swapped).zip(&repeated).map(|((members, swapped), repeated)| {
            let comparisons = oriented(study, members, swapped);
            let repeats = repeated.iter().map(|&place| again(&comparisons[place])).collect();
            Block { comparisons, repeats, controls: controls.clone() }
        });
        Some(Self { study, section, blocks: blocks.collect() })
    }

    /// How many blocks the comparisons are dealt into; 1 where a participant is asked all of them.
    pub fn blocks(&self) -> usize {
        self.blocks.len()
    }

    /// Trials of a participant's form, training left out.
    pub fn questions(&self, participant: usize) -> usize {
        let block = &self.blocks[participant % self.blocks.len()];
        block.comparisons.len() + block.repeats.len() + block.controls.len()
    }

    /// The form of a participant, counted from 0; any number has one.
    pub fn form(&self, participant: usize) -> Form {
        let block = participant % self.blocks.len();
        let turn = participant / self.blocks.len();
        let count = self.questions(participant);
        let (row, cycle) = (turn % count, turn / count);
        let mirrored = self.is_mirrored(participant);
        let seed = self.study.file.study.seed;
        let Block { comparisons, repeats, controls } = &self.blocks[block];
        let mut trials: Vec<Trial> =
            [comparisons, repeats, controls].into_iter().flatten().cloned().collect();
        match self.section.order {
            OrderRule::AsListed => {}
            OrderRule::Shuffled => {
                // A circle for each participant, begun anywhere: what lies opposite stays half a form apart.
                let mut random = random(seed, &[block, SHUFFLED, turn]);
                trials = order::circle(comparisons, repeats, controls, &mut random);
                trials.rotate_left(random.random_range(..count));
            }
            OrderRule::LatinSquare => {
                // A cycle and its mirror image have one circle, so that each form has a twin with all sides swapped.
                let mut random = random(seed, &[block, CIRCLE, cycle / 2]);
                let circle = order::circle(comparisons, repeats, controls, &mut random);
                trials =
                    order::row(count, row, cycle).into_iter().map(|place| circle[place].clone()).collect();
            }
        }
        if mirrored {
            trials.iter_mut().for_each(|trial| trial.shown.reverse());
        }
        if self.section.way.is_best() && self.section.sides == SideRule::Balanced {
            // Everything that is shown at once comes to each place in turn.
            trials.iter_mut().for_each(|trial| several::turn(trial, turn));
        }
        trials.splice(0..0, self.training());
        Form { participant, block, mirrored, trials }
    }

    /// Whether a participant, counted from 0, sees every side the other way round than the block's first form shows it.
    pub fn is_mirrored(&self, participant: usize) -> bool {
        let turn = participant / self.blocks.len();
        let count = self.questions(participant);
        // Rows alternate between the two ways round; where their number is even, so do whole cycles.
        self.section.sides == SideRule::Balanced
            && self.section.way.is_of_pairs()
            && (if count.is_multiple_of(2) { turn + turn / count } else { turn }) % 2 == 1
    }

    /// The forms of the planned participants.
    pub fn planned(&self) -> Vec<Form> {
        (0..self.section.participants as usize).map(|participant| self.form(participant)).collect()
    }

    /// Everything that some participant is shown at once, left to right, each once: of pairs the comparisons as listed, then what
    /// else forms need, in the order of blocks.
    pub fn pairs(&self) -> Vec<Vec<ConfigurationId>> {
        let of_pairs = self.section.way.is_of_pairs();
        let as_listed = self.study.comparisons.iter().map(|c| vec![c.left.clone(), c.right.clone()]);
        let mut pairs: Vec<_> = as_listed.filter(|_| of_pairs).collect();
        let mut add = |shown: &[ConfigurationId]| {
            if !pairs.iter().any(|known| known == shown) {
                pairs.push(shown.to_vec());
            }
        };
        for Block { comparisons, repeats, controls } in &self.blocks {
            for trial in [comparisons, repeats, controls].into_iter().flatten() {
                add(&trial.shown);
                if self.section.sides == SideRule::Balanced {
                    // The other way round, or with everything at each place.
                    for turn in 1..trial.shown.len() {
                        let mut turned = trial.shown.clone();
                        turned.rotate_left(turn);
                        add(&turned);
                    }
                }
            }
        }
        self.training().iter().for_each(|trial| add(&trial.shown));
        pairs
    }

    fn training(&self) -> Vec<Trial> {
        let shown =
            |pair: &crate::config::TrainingSection| several::training(self.study, self.section.way, pair);
        let trial = |(i, shown): (usize, Vec<ConfigurationId>)| Trial {
            role: Role::Training,
            question: format!("training-{}", i + 1),
            comparison: None,
            shown,
        };
        self.section.training.iter().flat_map(shown).enumerate().map(trial).collect()
    }
}

/// The comparisons of each block, ascending.
fn blocks(study: &Study, section: &FormsSection) -> Vec<Vec<usize>> {
    let room = (section.max_questions - section.controls - section.repeats) as usize;
    match study.comparisons.len().div_ceil(room) {
        1 => vec![(0..study.comparisons.len()).collect()],
        count => split::split(study, count, &mut random(study.file.study.seed, &[BLOCKS])),
    }
}

/// Which of each block's comparisons its first form shows the other way round than listed.
fn swapped(study: &Study, section: &FormsSection, split: &[Vec<usize>]) -> Vec<Vec<bool>> {
    let ends = |&i: &usize| {
        let Comparison { left, right, .. } = &study.comparisons[i];
        (study.place(left.method), study.place(right.method))
    };
    let of_block = |members: &Vec<usize>| members.iter().map(ends).collect();
    match section.sides {
        SideRule::AsListed => split.iter().map(|members| vec![false; members.len()]).collect(),
        SideRule::Balanced => {
            let blocks: Vec<Vec<(usize, usize)>> = split.iter().map(of_block).collect();
            sides::over_blocks(&blocks, &mut random(study.file.study.seed, &[SIDES]))
        }
    }
}

/// The comparisons of a block, sides as in its first form.
fn oriented(study: &Study, members: &[usize], swapped: &[bool]) -> Vec<Trial> {
    let trial = |(&i, &swapped): (&usize, &bool)| {
        let Comparison { question, left, right, .. } = &study.comparisons[i];
        let (left, right) = if swapped { (right, left) } else { (left, right) };
        let shown = vec![left.clone(), right.clone()];
        Trial { role: Role::Comparison, question: question.clone(), comparison: Some(i), shown }
    };
    members.iter().zip(swapped).map(trial).collect()
}

/// A comparison's repeat.
fn again(of: &Trial) -> Trial {
    let mut again = Trial { role: Role::Repeat, question: format!("{}-r", of.question), ..of.clone() };
    again.shown.rotate_left(1 % of.shown.len());
    again
}

/// Which of each block's comparisons are repeated: over all blocks configurations as evenly as can be, then methods, then
/// pairs of methods, then objects.
fn repeated(study: &Study, section: &FormsSection, split: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let (methods, objects) = (study.methods.len(), study.file.objects.len());
    let labels = |&i: &usize| {
        let Comparison { object, left, right, .. } = &study.comparisons[i];
        let (a, b) = (study.place(left.method), study.place(right.method));
        let ends = vec![object * methods + a, object * methods + b];
        vec![ends, vec![a, b], vec![a.min(b) * methods + a.max(b)], vec![*object]]
    };
    let sizes = [objects * methods, methods, methods.pow(2), objects];
    let pools: Vec<Vec<spread::Labels>> =
        split.iter().map(|members| members.iter().map(labels).collect()).collect();
    let mut random = random(study.file.study.seed, &[REPEATS]);
    spread::spread(section.repeats as usize, &pools, &sizes, &mut random)
}

/// The same in every block: fewer animations, more answers to each. Methods as evenly as can be, then objects.
fn controls(study: &Study, section: &FormsSection) -> Vec<Trial> {
    let methods = study.methods.len();
    // Configurations are objects crossed with methods.
    let labels = |i: usize| vec![vec![i % methods], vec![study.configurations[i].object]];
    let pool = (0..study.configurations.len()).map(labels).collect();
    let sizes = [methods, study.file.objects.len()];
    let mut random = random(study.file.study.seed, &[CONTROLS]);
    let chosen = spread::spread(section.controls as usize, &[pool], &sizes, &mut random);
    let control = |(n, i): (usize, usize)| {
        let shown = vec![study.configurations[i].id.clone(); 2];
        let question = format!("control-{}", n + 1);
        Trial { role: Role::Control, question, comparison: None, shown }
    };
    chosen.into_iter().flatten().enumerate().map(control).collect()
}

/// What random numbers are drawn for; each has a stream of its own.
const SIDES: usize = 1;
const CONTROLS: usize = 2;
const CIRCLE: usize = 3;
const SHUFFLED: usize = 4;
const REPEATS: usize = 5;
const BLOCKS: usize = 6;
const SETS: usize = 7;

fn random(seed: u64, parts: &[usize]) -> Pcg64 {
    // FNV-1a: any fixed mixing will do, as long as it is ours and never changes.
    let mix = |state: u64, part: &usize| {
        (*part as u64)
            .to_le_bytes()
            .iter()
            .fold(state, |s, &b| (s ^ u64::from(b)).wrapping_mul(0x100_0000_01b3))
    };
    Pcg64::seed_from_u64(parts.iter().fold(seed ^ 0xcbf2_9ce4_8422_2325, mix))
}

#[cfg(test)]
mod tests;
