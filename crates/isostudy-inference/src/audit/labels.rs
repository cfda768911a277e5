//! Do the answers' labels contradict what was shown? Then the key has the sides of a file mixed up.
//!
//! A wrong key names the sides of one file the wrong way round, so that all answers to it are labelled in the other order.
//! Where the file of answers has code names, the study knows what they show. Where forms were dealt, each participant saw one
//! of two ways round of a block, which all of the participant's other labels tell. Neither is a matter of chance.

use super::Audited;
use super::dealt::{Dealt, Shown};
use super::evidence::{Contradiction, Remark, WrongFile};
use std::collections::{BTreeMap, BTreeSet};

/// Answers to a file below which it is not held against the forms.
const FEWEST_OF_FILE: u64 = 3;
/// Answers that have to agree with the forms before others are said to contradict them.
const FEWEST_AGREEING: u64 = 20;
/// Of the answers to files that are labelled as dealt, one in so many may still contradict the forms.
const RARE: u64 = 50;

/// What was seen of labels.
#[derive(Debug, Default)]
pub(super) struct Labels {
    /// What contradicts.
    pub(super) found: Vec<Contradiction>,
    /// What agrees, and what cannot be said.
    pub(super) remarks: Vec<Remark>,
    /// Whether labels were held against anything.
    pub(super) looked: bool,
    /// The questions whose labels contradict.
    pub(super) suspects: BTreeSet<usize>,
}

pub(super) fn look(audited: &Audited<'_>) -> Labels {
    let mut labels = Labels::default();
    if let Some(dealt) = audited.dealt.filter(|_| audited.sides_recorded) {
        labels.hold_against_codes(audited, dealt);
        labels.hold_against_forms(audited, dealt);
    }
    labels
}

/// Answers to one file.
#[derive(Debug, Default)]
struct Counted {
    answers: u64,
    contradicting: u64,
    questions: BTreeSet<usize>,
}

impl Counted {
    fn add(&mut self, question: usize, contradicts: bool) {
        self.answers += 1;
        self.contradicting += u64::from(contradicts);
        self.questions.insert(question);
    }

    fn wrong(&self, audited: &Audited<'_>) -> WrongFile {
        let questions = audited.names(self.questions.iter().copied());
        WrongFile { questions, contradicting: self.contradicting, answers: self.answers }
    }
}

impl Labels {
    fn hold_against_codes(&mut self, audited: &Audited<'_>, dealt: &Dealt<'_>) {
        let mut files: BTreeMap<usize, Counted> = BTreeMap::new();
        for (ballot, code) in audited.ballots.iter().zip(&dealt.code_of) {
            let shown = code.and_then(|code| Some((code.place(), dealt.codes[code.place()]?)));
            if let Some((place, shown)) = shown {
                let sides = [ballot.left(), ballot.right()];
                let labelled = Shown { scene: audited.scenes[ballot.question()], sides };
                files.entry(place).or_default().add(ballot.question(), labelled != shown);
            }
        }
        if files.is_empty() {
            return;
        }
        self.looked = true;
        let wrong: Vec<(&usize, &Counted)> = files.iter().filter(|(_, of)| of.contradicting > 0).collect();
        if wrong.is_empty() {
            self.remarks.push(Remark::CodesAgree { files: files.len() });
            return;
        }
        let each = wrong.iter().map(|&(&place, of)| (of.wrong(audited), dealt.names[place].clone()));
        self.found.push(Contradiction::Codes { files: files.len(), wrong: each.collect() });
        self.suspects.extend(wrong.iter().flat_map(|(_, of)| of.questions.iter()));
    }

    fn hold_against_forms(&mut self, audited: &Audited<'_>, dealt: &Dealt<'_>) {
        let (files, others) = by_form(audited, dealt);
        let judged = || files.values().filter(|of| of.answers >= FEWEST_OF_FILE);
        let (wrong, right): (Vec<_>, Vec<_>) = judged().partition(|of| 2 * of.contradicting > of.answers);
        let agreeing: u64 = right.iter().map(|of| of.answers - of.contradicting).sum();
        let stray: u64 = right.iter().map(|of| of.contradicting).sum();
        if agreeing < FEWEST_AGREEING {
            return;
        }
        if RARE * stray > agreeing || wrong.len() > most_wrong(wrong.len() + right.len()) {
            self.remarks.push(Remark::OtherStudysForms);
            return;
        }
        self.looked = true;
        match wrong.is_empty() {
            false => {
                let each = wrong.iter().map(|of| of.wrong(audited));
                self.found.push(Contradiction::Forms(each.collect()));
            }
            true if others.is_empty() => self.remarks.push(Remark::FormsAgree),
            true => {}
        }
        if !others.is_empty() {
            self.found.push(Contradiction::OtherForm(others));
        }
        if stray > 0 {
            self.remarks.push(Remark::Stray { answers: stray });
        }
        self.suspects.extend(wrong.iter().flat_map(|of| of.questions.iter()));
    }
}

/// Of so many files, how many may be labelled in the other order before the forms are taken for those of another study: one in
/// four; of a few files, half.
fn most_wrong(files: usize) -> usize {
    if files < 8 { files / 2 } else { files / 4 }
}

/// By file, how many answers are labelled otherwise than the form shows that the participant's labels fit best. Where two forms
/// fit alike, the file's own form number decides; without one the participant is left out. And the participants whose labels
/// fit another form better than the one that the file names.
fn by_form(audited: &Audited<'_>, dealt: &Dealt<'_>) -> (BTreeMap<Shown, Counted>, Vec<usize>) {
    let sheets = dealt.sheets();
    let people = audited.ballots.iter().map(|b| b.participant() + 1).max().unwrap_or(0);
    // By participant and sheet: labels that agree less those that do not, and less those that it does not ask.
    let mut fits = vec![0_i64; people * sheets.len()];
    for ballot in audited.ballots.iter().filter(|b| b.left() != b.right()) {
        let own = &mut fits[ballot.participant() * sheets.len()..][..sheets.len()];
        for (fit, sheet) in own.iter_mut().zip(&sheets) {
            *fit += if sheet[ballot.question()] == Some([ballot.left(), ballot.right()]) { 1 } else { -1 };
        }
    }
    let fitting = |participant: usize| {
        let own = &fits[participant * sheets.len()..][..sheets.len()];
        let most = *own.iter().max()?;
        let mut best = (0..own.len()).filter(|&sheet| own[sheet] == most);
        match (best.next(), best.next()) {
            (first, None) => first,
            _ => dealt.said(participant).filter(|&said| own[said] == most),
        }
    };
    let fitting: Vec<Option<usize>> = (0..people).map(fitting).collect();
    let fits_other = |&participant: &usize| {
        let own = &fits[participant * sheets.len()..][..sheets.len()];
        let both = fitting[participant].zip(dealt.said(participant));
        both.is_some_and(|(best, said)| own[best] > own[said] && own[best] > 0)
    };
    let others = (0..people).filter(fits_other).collect();
    let mut files: BTreeMap<Shown, Counted> = BTreeMap::new();
    for ballot in audited.ballots.iter().filter(|b| b.left() != b.right()) {
        let sheet = fitting[ballot.participant()];
        if let Some(sides) = sheet.and_then(|sheet| sheets[sheet][ballot.question()]) {
            let file = Shown { scene: audited.scenes[ballot.question()], sides };
            let contradicts = sides != [ballot.left(), ballot.right()];
            files.entry(file).or_default().add(ballot.question(), contradicts);
        }
    }
    (files, others)
}
