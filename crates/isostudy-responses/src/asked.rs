//! What a row asks: its question, and which item was on which side.

use crate::collect::Asking;
use crate::decode::records::Record;
use crate::error::{Fault, shorten};
use crate::formats::long::Rows;
use crate::natural;
use crate::plan::{Plan, REPEAT, is_training};
use crate::report::Kind;
use crate::shown::Sheet;
use crate::sides::SidesSource;
use isostudy_design::forms::Role;
use std::borrow::Cow;

/// A question, and the items on its left and right.
pub(crate) type Asked = (u32, [u32; 2]);

impl Rows<'_> {
    /// What a row asks; `None` is training, which is not analysed. `id` is empty where the file names no questions.
    ///
    /// # Errors
    /// What is no question, another pair than the question's, sides that nobody knows.
    pub(crate) fn asked(
        &mut self,
        record: &Record<'_>,
        id: &str,
        form: Option<&str>,
    ) -> Result<Option<Asked>, Fault> {
        let role = self.role(record)?;
        // Forms of a study have repeats and training beside its questions.
        let known = self.plan.is_some_and(|plan| plan.question(id).is_some());
        if role == Some(Role::Training) || (self.plan.is_some() && !known && is_training(id)) {
            self.collector.report.row(Kind::Noted, record.row, "training, which is not analysed: not read");
            return Ok(None);
        }
        match self.plan {
            None => self.open(record, id, role).map(Some),
            Some(plan) => self.planned(plan, record, id, form, role).map(Some),
        }
    }

    fn role(&self, record: &Record<'_>) -> Result<Option<Role>, Fault> {
        let Some(column) = self.columns.role else { return Ok(None) };
        match self.text(record, column).to_lowercase().as_str() {
            "" => Ok(None),
            "comparison" => Ok(Some(Role::Comparison)),
            "control" => Ok(Some(Role::Control)),
            "repeat" => Ok(Some(Role::Repeat)),
            "training" => Ok(Some(Role::Training)),
            _ => {
                let limit = "must be comparison, control, repeat or training";
                Err(self.refuse(record, column, "role", limit))
            }
        }
    }

    /// The names on both sides, where the file has them.
    fn names<'r>(&self, record: &'r Record<'_>) -> Result<Option<[&'r str; 2]>, Fault> {
        let Some((left, right)) = self.columns.sides else { return Ok(None) };
        Ok(Some([self.needed(record, left, "left")?, self.needed(record, right, "right")?]))
    }

    /// What a row says itself.
    fn open(&mut self, record: &Record<'_>, id: &str, role: Option<Role>) -> Result<Asked, Fault> {
        let names = self.names(record)?.expect("needed without a plan");
        let object = self.name(record, self.columns.object, "object")?;
        let group = self.name(record, self.columns.group, "group")?;
        let sides = names.map(|name| self.collector.items.number(name));
        let role = match role {
            _ if sides[0] == sides[1] => Role::Control,
            Some(Role::Control) => {
                let (_, right) = self.columns.sides.expect("they have names");
                let limit = "must be the left side's item in a control";
                return Err(self.refuse(record, right, "right", limit));
            }
            Some(Role::Repeat) => Role::Repeat,
            _ => Role::Comparison,
        };
        let id = if id.is_empty() { Cow::Owned(made_up([group, object], names)) } else { Cow::Borrowed(id) };
        let asking = Asking { id: &id, object, group, sides, role };
        Ok((self.collector.question(asking, record.row)?, sides))
    }

    /// What a study knows of a row. A control that no form has is a question of its own.
    fn planned(
        &mut self,
        plan: &Plan,
        record: &Record<'_>,
        id: &str,
        form: Option<&str>,
        role: Option<Role>,
    ) -> Result<Asked, Fault> {
        let names = self.names(record)?;
        let known = match names {
            Some(names) if self.columns.question.is_none() => Some(self.by_pair(plan, record, names)?),
            _ => plan.question(id),
        };
        let repeats = match known {
            Some(known) if role == Some(Role::Repeat) => Some(known),
            Some(_) => None,
            None => id.strip_suffix(REPEAT).and_then(|id| plan.question(id)),
        };
        let id = match repeats.is_some() && known.is_some() {
            true => Cow::Owned(format!("{id}{REPEAT}")),
            false => Cow::Borrowed(id),
        };
        let number = known.filter(|_| repeats.is_none()).or_else(|| plan.beside(&id));
        let sides = match names {
            Some(names) => {
                let [left, right] = names.map(|name| plan.item(name, repeats.or(known)));
                left.zip(right).map(|(left, right)| [left, right])
            }
            None if number.is_none() && repeats.is_none() => return Err(self.no_question(record)),
            None => Some(self.dealt(plan, record, &id, number, form)?),
        };
        let compared = repeats.or(known);
        match (compared, sides) {
            (None, Some(sides)) if sides[0] == sides[1] => {
                let own = self.name(record, self.columns.object, "object")?;
                let object = match number {
                    Some(number) if own.is_empty() => plan.asked(number).object.as_str(),
                    _ => own,
                };
                let group = self.name(record, self.columns.group, "group")?;
                let asking = Asking { id: &id, object, group, sides, role: Role::Control };
                Ok((self.collector.question(asking, record.row)?, sides))
            }
            (None, _) => Err(self.no_question(record)),
            (Some(question), Some(sides)) if plan.compares(question, sides) => match repeats {
                None => Ok((question, sides)),
                Some(_) => {
                    let of = &plan.questions()[question as usize];
                    let (object, group) = (&of.object, &of.group);
                    let asking = Asking { id: &id, object, group, sides, role: Role::Repeat };
                    Ok((self.collector.question(asking, record.row)?, sides))
                }
            },
            (Some(question), _) => {
                let pair =
                    |[left, right]: [u32; 2]| [left, right].map(|item| plan.items()[item as usize].as_str());
                let [left, right] = names.or(sides.map(pair)).unwrap_or_default();
                Err(Fault::Pair {
                    row: record.row,
                    question: shorten(&id),
                    declared: plan.pair(question),
                    found: format!("{} and {}", shorten(left), shorten(right)),
                })
            }
        }
    }

    /// The question that compares what a row names, in a file that names no questions.
    fn by_pair(&self, plan: &Plan, record: &Record<'_>, names: [&str; 2]) -> Result<u32, Fault> {
        let object = self.name(record, self.columns.object, "object")?;
        plan.comparing(object, names).ok_or_else(|| {
            let on = if object.is_empty() { String::new() } else { format!(" on {}", shorten(object)) };
            let found = format!("{} and {}{on}", shorten(names[0]), shorten(names[1]));
            Fault::NoSuchPair { row: record.row, found }
        })
    }

    /// The sides that the study showed.
    fn dealt(
        &self,
        plan: &Plan,
        record: &Record<'_>,
        id: &str,
        number: Option<u32>,
        form: Option<&str>,
    ) -> Result<[u32; 2], Fault> {
        let (row, question) = (record.row, shorten(id));
        match self.sides {
            SidesSource::FromCodeNames => {
                let column = self.columns.stimulus.expect("sides are told by it");
                let stimulus = self.needed(record, column, "stimulus")?;
                let limit = "is not a code name of this study";
                let sides =
                    plan.code(stimulus).ok_or_else(|| self.refuse(record, column, "stimulus", limit))?;
                let sheet = form.and_then(|form| plan.sheet(form));
                match number.zip(sheet).and_then(|(number, sheet)| sheet[number as usize]) {
                    Some(asked) if asked != sides => Err(Fault::OtherStimulus {
                        row,
                        stimulus: format!("{} shows {}", shorten(stimulus), plan.names_of(sides)),
                        form: shorten(form.unwrap_or_default()),
                        question,
                        asked: plan.names_of(asked),
                    }),
                    _ => Ok(sides),
                }
            }
            SidesSource::FromForms => {
                let column = self.columns.form.expect("sides are told by it");
                let sheet = sheet(plan, form).map_err(|limit| self.refuse(record, column, "form", limit))?;
                let sides = number.and_then(|number| sheet[number as usize]);
                let form = shorten(form.unwrap_or_default());
                sides.ok_or(Fault::NotInForm { row, form, question })
            }
            _ => number.and_then(|number| plan.listed(number)).ok_or(Fault::NoSidesOf { row, question }),
        }
    }

    fn no_question(&self, record: &Record<'_>) -> Fault {
        let column = self.columns.question.expect("pairs without an id are found or refused");
        let limit = "is not a question of this study, nor a control or a repeat";
        self.refuse(record, column, "question", limit)
    }
}

/// What a form asks.
///
/// # Errors
/// What the cell with its number may say.
pub(crate) fn sheet<'p>(plan: &'p Plan, form: Option<&str>) -> Result<&'p Sheet, String> {
    match form {
        None => Err("must not be empty, since the form says what was on which side".into()),
        Some(form) => plan.sheet(form).ok_or_else(|| match plan.forms() {
            1 => "is not a form of this study, which has form 1 alone".into(),
            forms => format!("is not a form of this study, whose forms are 1 to {forms}"),
        }),
    }
}

/// The id of a question that a file does not name: its group, its object and its pair, whichever way round it was shown.
fn made_up(scene: [&str; 2], names: [&str; 2]) -> String {
    let [mut first, mut second] = names;
    if natural::compare(first, second).is_gt() {
        (first, second) = (second, first);
    }
    let scene: Vec<&str> = scene.into_iter().filter(|part| !part.is_empty()).collect();
    match scene.is_empty() {
        true => format!("{first}-{second}"),
        false => format!("{}: {first}-{second}", scene.join(" ")),
    }
}
