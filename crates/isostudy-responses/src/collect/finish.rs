//! What is checked, numbered and named once every answer is there.

use super::{Collector, Ids, Place};
use crate::choice::Choice;
use crate::error::{Fault, shorten};
use crate::mapping::Duplicates;
use crate::name;
use crate::natural;
use crate::plan::REPEAT;
use crate::report::Kind;
use crate::sides::SidesSource;
use crate::value::{Answer, Responses, UnknownStimuli};
use isostudy_design::forms::Role;
use std::collections::{HashMap, HashSet};

impl Collector<'_> {
    /// Checks what was gathered.
    ///
    /// # Errors
    /// Cells that are no answers, answers given twice, no answers at all.
    pub(crate) fn finish(
        mut self,
        sides: SidesSource,
        (header_row, end): (u64, u64),
    ) -> Result<Responses, Fault> {
        if !self.unknown.is_empty() {
            return Err(Fault::UnknownAnswers {
                cells: self.unknown,
                known: self.mapping.words.summary(self.way),
            });
        }
        if let Some((Place { row, column }, cells)) = self.missing {
            let action = match cells {
                1 => "R's mark for a missing value: read as no answer".to_owned(),
                _ => {
                    format!("R's mark for a missing value: read as no answer, here and in {} more", cells - 1)
                }
            };
            self.report.cell(Kind::Noted, row, column, "NA", action);
        }
        let nameless = self.nameless.iter().cloned().flatten();
        for number in self.unnamed.iter().copied().chain(nameless) {
            let name = &mut self.participants[number as usize].id;
            while self.by_id.contains_key(name) {
                name.push('\'');
            }
        }
        let without_participant: u64 = self.nameless.iter().map(|range| range.len() as u64).sum();
        if without_participant > 0 {
            let of = match without_participant {
                1 => "1 answer names no participant: it is".to_owned(),
                n => format!("{n} answers name no participant: each is"),
            };
            self.report.row(Kind::Noted, header_row, format!("{of} read as that of another person"));
        }
        self.join_split_ties();
        self.check_repeats()?;
        if self.answers.is_empty() {
            return Err(Fault::NoAnswers { row: end });
        }
        self.drop_silent_participants();
        if self.open {
            self.sort_items();
        }
        self.name_pairs();
        let unknown_stimuli = self.unknown_stimuli();
        // Millions of answers live as long as the program, and they grew by doubling.
        self.answers.shrink_to_fit();
        Ok(Responses {
            participants: self.participants,
            questions: self.questions,
            items: self.items.names,
            answers: self.answers,
            sides_recorded: sides != SidesSource::Unknown,
            sides,
            stimuli: self.stimuli.names,
            screens: self.screens,
            judged: Vec::new(),
            people: Vec::new(),
            without_participant,
            unknown_stimuli,
        })
    }

    /// Numbers the items by their names, so that their order does not depend on that of the rows.
    fn sort_items(&mut self) {
        let names = std::mem::take(&mut self.items.names);
        let mut order: Vec<u32> = (0..names.len() as u32).collect();
        order.sort_by(|&a, &b| natural::compare(&names[a as usize], &names[b as usize]));
        let mut place = vec![0; names.len()];
        order.iter().zip(0..).for_each(|(&item, new)| place[item as usize] = new);
        let renumber = |item: &mut u32| *item = place[*item as usize];
        self.questions.iter_mut().flat_map(|q| [&mut q.left, &mut q.right]).for_each(renumber);
        self.answers.iter_mut().flat_map(|a| [&mut a.left, &mut a.right]).for_each(renumber);
        self.items.names = order.iter().map(|&item| names[item as usize].clone()).collect();
    }

    /// Makes one answer without preference of a won and a lost row of one session, as formats without ties have it.
    /// This comes before `duplicates`, which would make each tie a win of whatever is in its first or last row.
    fn join_split_ties(&mut self) {
        if self.session_of.is_empty() {
            return;
        }
        let key = |i: u32| {
            let Answer { participant, question, left, .. } = self.answers[i as usize];
            (participant, question, left, self.session_of[i as usize])
        };
        let mut sorted: Vec<u32> = (0..self.answers.len() as u32).collect();
        sorted.sort_by_key(|&i| key(i));
        let mut halves: Vec<[u32; 2]> = Vec::new();
        for same in sorted.chunk_by(|&a, &b| key(a) == key(b)) {
            if let &[first, second] = same
                && self.answers[first as usize].choice != Choice::NoPreference
                && self.answers[first as usize].choice == self.answers[second as usize].choice.swapped()
            {
                halves.push([first, second]);
            }
        }
        halves.sort_unstable();
        let Some(&first) = halves.first() else { return };
        let [row, other] = first.map(|i| u64::from(self.rows[i as usize]));
        let more = match halves.len() - 1 {
            0 => String::new(),
            1 => ", and so is 1 more pair of rows".into(),
            more => format!(", and so are {more} more pairs of rows"),
        };
        let action =
            format!("won and lost, here and in row {other}: read as one answer without preference{more}");
        self.report.row(Kind::Noted, row, action);
        let mut kept = vec![true; self.answers.len()];
        for [first, second] in halves.into_iter().map(|half| half.map(|i| i as usize)) {
            (self.answers[first].choice, self.answers[first].much) = (Choice::NoPreference, false);
            kept[second] = false;
        }
        let (mut of_answer, mut of_row) = (kept.iter(), kept.iter());
        self.answers.retain(|_| *of_answer.next().expect("one an answer"));
        self.rows.retain(|_| *of_row.next().expect("one an answer"));
    }

    /// Answers with code names that the study lacks.
    fn unknown_stimuli(&mut self) -> Option<UnknownStimuli> {
        let of = |answer: &Answer| answer.stimulus.filter(|id| self.unknown_stimuli.contains_key(id));
        let mut unknown = self.answers.iter().filter_map(of);
        let first = unknown.next()?;
        let answers = 1 + unknown.count() as u64;
        let Place { row, column } = self.unknown_stimuli[&first];
        let more = match answers {
            1 => String::new(),
            2 => "; 1 more answer has such a name".into(),
            n => format!("; {} more answers have such names", n - 1),
        };
        let name = &self.stimuli.names[first.place()];
        self.report.cell(Kind::Noted, row, column, name, format!("not a code name of this study{more}"));
        Some(UnknownStimuli { first, row, answers })
    }

    /// Nobody answers a question twice, unless it was shown twice or the other way round.
    fn check_repeats(&mut self) -> Result<(), Fault> {
        let key = |i: usize| {
            let Answer { participant, question, left, .. } = self.answers[i];
            (participant, question, left)
        };
        let mut sorted: Vec<u32> = (0..self.answers.len() as u32).collect();
        sorted.sort_by_key(|&i| key(i as usize));
        let mut dropped = Vec::new();
        for same in sorted.chunk_by(|&a, &b| key(a as usize) == key(b as usize)).filter(|same| same.len() > 1)
        {
            let mut orders: Vec<Option<u32>> = same.iter().map(|&i| self.answers[i as usize].order).collect();
            orders.sort_unstable();
            orders.dedup();
            if self.shown_again && orders.len() == same.len() && orders[0].is_some() {
                continue;
            }
            let kept = match self.mapping.duplicates {
                Duplicates::Refuse => {
                    let [first, second] = [same[0], same[1]].map(|i| u64::from(self.rows[i as usize]));
                    let (participant, question, _) = key(same[0] as usize);
                    return Err(Fault::DuplicateAnswer {
                        row: second,
                        first,
                        participant: shorten(&self.participants[participant as usize].id),
                        question: shorten(&self.questions[question as usize].id),
                        ordered: self.ordered,
                    });
                }
                Duplicates::First => same[0],
                Duplicates::Last => same[same.len() - 1],
            };
            dropped.extend(same.iter().copied().filter(|&i| i != kept));
        }
        dropped.sort_unstable();
        for &i in &dropped {
            let question = &self.questions[self.answers[i as usize].question as usize].id;
            let action = format!("{} answered more than once: this one is left out", shorten(question));
            self.report.row(Kind::Rejected, u64::from(self.rows[i as usize]), action);
        }
        let mut i = 0;
        self.answers.retain(|_| {
            i += 1;
            dropped.binary_search(&(i - 1)).is_err()
        });
        Ok(())
    }

    /// Takes out participants without an answer; the reader has said so where it saw them.
    fn drop_silent_participants(&mut self) {
        let mut number = vec![u32::MAX; self.participants.len()];
        self.answers.iter().for_each(|answer| number[answer.participant as usize] = 0);
        let mut next = 0;
        let mut renumber = number.iter_mut();
        self.participants.retain(|_| {
            let own = renumber.next().expect("one a participant");
            let kept = *own == 0;
            if kept {
                *own = next;
                next += 1;
            }
            kept
        });
        self.answers.iter_mut().for_each(|answer| answer.participant = number[answer.participant as usize]);
    }

    /// Tells questions apart that share an id.
    fn name_pairs(&mut self) {
        /// Leaves room for a number.
        const CUT: usize = name::LONGEST_NAME - 20;
        let repeated: HashSet<String> =
            self.questions.iter().filter(|q| q.role != Role::Repeat).map(|q| q.id.clone()).collect();
        for question in self.questions.iter_mut().filter(|q| q.role == Role::Repeat) {
            if repeated.contains(&question.id) && question.id.len() < CUT {
                question.id.push_str(REPEAT);
            }
        }
        let mut of_id: HashMap<String, u32> = HashMap::new();
        self.questions.iter().for_each(|q| *of_id.entry(q.id.clone()).or_default() += 1);
        for (i, question) in self.questions.iter_mut().enumerate().filter(|(_, q)| of_id[&q.id] > 1) {
            let [left, right] = [question.left, question.right].map(|item| &self.items.names[item as usize]);
            let parts = [&question.id, &question.group, &question.object].map(String::as_str);
            let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
            let full = format!("{}: {left}-{right}", parts.join(" "));
            let named = match name::is_too_long(&full) {
                false => full,
                true => format!("{}... {}", question.id.chars().take(CUT).collect::<String>(), i + 1),
            };
            let id = std::mem::replace(&mut question.id, named);
            if self.naming == Ids::Scene && question.object.is_empty() {
                question.object = id;
            }
        }
    }
}
