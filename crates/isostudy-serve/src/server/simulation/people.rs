//! What clients know and were told, and what every export must therefore hold.

use super::running::Reply;
use crate::cameras::Tracked;
use crate::export::Given;
use crate::record::Choice;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// What was sent to a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Said {
    pub(super) choice: Choice,
    pub(super) rt_ms: u32,
    /// Width of the window, where the page told its screen.
    pub(super) width: Option<u32>,
}

/// What is certain of a place, since somebody was told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Certain {
    Nothing,
    /// There is an answer.
    Answered,
    /// It is this choice.
    Choice(Choice),
    /// It is this, and was read.
    Said(Said),
}

/// A form that was dealt.
pub(super) struct Session {
    pub(super) name: String,
    form: usize,
    pub(super) questions: Vec<String>,
    panel: Option<usize>,
    sent: Vec<Vec<Said>>,
    certain: Vec<Certain>,
    /// Times of the cameras that were sent to a place, and whether one of them was acknowledged.
    looked: Vec<(Vec<i32>, bool)>,
    finished: bool,
    /// In which life of the server it was dealt.
    life: u64,
}

impl Session {
    /// How many answers are certain to be kept.
    pub(super) fn acknowledged(&self) -> usize {
        self.certain.iter().take_while(|of| **of != Certain::Nothing).count()
    }

    /// What was sent to a place, in order.
    pub(super) fn sent(&self, place: usize) -> &[Said] {
        &self.sent[place]
    }

    fn at_least(&mut self, places: usize) {
        let unknown = |of: &&mut Certain| **of == Certain::Nothing;
        self.certain.iter_mut().take(places).filter(unknown).for_each(|of| *of = Certain::Answered);
    }
}

/// A request of somebody to whom a form was dealt.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Asked {
    Begin { panel: Option<usize> },
    State { token: String },
    Answer { token: String, place: usize, said: Said },
    Cameras { token: String, place: usize, t_ms: i32 },
    Finish { token: String },
}

/// Training pairs of every form, before its questions.
pub(super) const TRAINING: usize = 1;

impl Asked {
    pub(super) fn token(&self) -> Option<&str> {
        match self {
            Self::Begin { .. } => None,
            Self::State { token }
            | Self::Answer { token, .. }
            | Self::Cameras { token, .. }
            | Self::Finish { token } => Some(token),
        }
    }
}

/// Everybody to whom a form was dealt, by token.
#[derive(Default)]
pub(super) struct People {
    pub(super) sessions: BTreeMap<String, Session>,
    /// How often the server was started.
    pub(super) life: u64,
}

pub(super) type Rows = BTreeMap<(String, u32), (usize, String, Said)>;

impl People {
    /// How many answers of whoever asks are certain.
    pub(super) fn acknowledged(&self, asked: &Asked) -> usize {
        let of = |session: &Session| session.acknowledged();
        match asked {
            Asked::Begin { panel: None } => 0,
            Asked::Begin { panel } => {
                self.sessions.values().filter(|one| one.panel == *panel).map(of).max().unwrap_or(0)
            }
            _ => asked.token().and_then(|token| self.sessions.get(token)).map_or(0, of),
        }
    }

    /// Sessions of which an answer was acknowledged.
    pub(super) fn answered(&self) -> usize {
        self.sessions.values().filter(|session| session.acknowledged() > 0).count()
    }

    pub(super) fn send(&mut self, token: &str, place: usize, said: Said) {
        let sent = &mut self.sessions.get_mut(token).expect("somebody").sent[place];
        if !sent.contains(&said) {
            sent.push(said);
        }
    }

    /// Somebody sends cameras of an answer that was acknowledged.
    pub(super) fn look(&mut self, token: &str, place: usize, t_ms: i32) {
        self.sessions.get_mut(token).expect("somebody").looked[place].0.push(t_ms);
    }

    /// Learns from a reply. `before` answers were certain when the request was sent.
    ///
    /// Returns what was promised and is not so.
    pub(super) fn learn(&mut self, asked: &Asked, before: usize, reply: &Reply) -> Result<(), String> {
        let wrong = |what: &str| Err(format!("{what}: {asked:?} got {} {}", reply.status, reply.text));
        let said: Value = serde_json::from_str(&reply.text).unwrap_or_default();
        match (asked, reply.status) {
            // Nothing is known of what was not saved: it may be there.
            (_, 503) => return Ok(()),
            (Asked::Begin { panel }, 200) => return self.dealt(*panel, before, &said),
            (Asked::Begin { .. }, _) => return wrong("a form was not dealt"),
            _ => {}
        }
        let token = asked.token().expect("all but the first have one");
        let session = self.sessions.get_mut(token).expect("it was dealt");
        let all = session.questions.len();
        match (asked, reply.status) {
            // Those who have answered nothing are in memory alone.
            (_, 404) if before == 0 && session.life < self.life => Ok(()),
            (_, 404) => wrong("a participant is forgotten"),
            (Asked::State { .. }, 200) => {
                let kept = said["answered"].as_u64().unwrap_or(0) as usize;
                if kept < before || said["participant"] != session.name {
                    return wrong("more was acknowledged");
                }
                session.at_least(kept);
                Ok(())
            }
            (Asked::Answer { place, said, .. }, 200) => {
                session.at_least(*place);
                let certain = &mut session.certain[*place];
                match *certain {
                    Certain::Choice(choice) | Certain::Said(Said { choice, .. }) if choice != said.choice => {
                        return wrong("another choice was acknowledged");
                    }
                    Certain::Said(_) => {}
                    _ => *certain = Certain::Choice(said.choice),
                }
                Ok(())
            }
            (Asked::Answer { place, said, .. }, 409) if reply.text.contains("answered otherwise") => {
                session.at_least(*place + 1);
                match session.certain[*place] {
                    Certain::Choice(choice) | Certain::Said(Said { choice, .. }) if choice == said.choice => {
                        wrong("the same was acknowledged")
                    }
                    _ => Ok(()),
                }
            }
            (Asked::Answer { place, .. }, 409) if before < *place => Ok(()),
            (Asked::Cameras { place, .. }, 200) => {
                session.looked[*place].1 = true;
                Ok(())
            }
            (Asked::Finish { .. }, 200) => {
                session.at_least(all);
                session.finished = true;
                Ok(())
            }
            (Asked::Finish { .. }, 409) if before < all => Ok(()),
            _ => wrong("it should have been taken"),
        }
    }

    fn dealt(&mut self, panel: Option<usize>, before: usize, said: &Value) -> Result<(), String> {
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let questions: Vec<String> =
            said["form"]["questions"].as_array().into_iter().flatten().map(text).collect();
        let session = self.sessions.entry(text(&said["token"])).or_insert_with(|| Session {
            name: text(&said["participant"]),
            form: said["form"]["form"].as_u64().unwrap_or(0) as usize,
            sent: vec![Vec::new(); questions.len()],
            certain: vec![Certain::Nothing; questions.len()],
            looked: vec![(Vec::new(), false); questions.len()],
            questions,
            panel,
            finished: false,
            life: 0,
        });
        session.life = self.life;
        let kept = said["answered"].as_u64().unwrap_or(0) as usize;
        if session.panel != panel || session.name != said["participant"] {
            return Err(format!("a form of somebody else was dealt to {panel:?}: {said}"));
        }
        if kept < before {
            return Err(format!("less was kept than was acknowledged: {said}"));
        }
        session.at_least(kept);
        Ok(())
    }

    /// Holds what an export says against what was told. Whoever reads a running server's answers can `learn` from them.
    pub(super) fn check_rows(&mut self, what: &str, rows: &Rows, learn: bool) -> Result<(), String> {
        let mut names: BTreeSet<&str> = rows.keys().map(|(name, _)| name.as_str()).collect();
        for session in self.sessions.values_mut() {
            names.remove(session.name.as_str());
            let mut ended = false;
            for place in 0..session.questions.len() {
                let order = (place + TRAINING + 1) as u32;
                let row = rows.get(&(session.name.clone(), order));
                let at = || format!("{what}: participant {}, place {order}", session.name);
                let certain = session.certain[place];
                let Some((form, stimulus, said)) = row else {
                    if certain != Certain::Nothing {
                        return Err(format!("{}: was acknowledged ({certain:?}), and is not there", at()));
                    }
                    ended = true;
                    continue;
                };
                if ended || *form != session.form || *stimulus != session.questions[place] {
                    return Err(format!("{}: form {form}, {stimulus} is not what was asked next", at()));
                }
                let as_told = match certain {
                    Certain::Choice(choice) => said.choice == choice,
                    Certain::Said(known) => *said == known,
                    _ => true,
                };
                if !as_told || !session.sent[place].contains(said) {
                    return Err(format!("{}: {said:?} is not what was sent ({certain:?})", at()));
                }
                if learn {
                    session.certain[place] = Certain::Said(*said);
                }
            }
            if rows.keys().any(|(name, order)| {
                *name == session.name && *order as usize > session.questions.len() + TRAINING
            }) {
                return Err(format!("{what}: {} answered more than was asked", session.name));
            }
        }
        if names.is_empty() { Ok(()) } else { Err(format!("{what}: answers of nobody: {names:?}")) }
    }

    /// Holds cameras against what was told: those of an answer are all there or none, and what was acknowledged is there.
    pub(super) fn check_cameras(&self, what: &str, kept: &[Tracked]) -> Result<(), String> {
        let mut found = BTreeMap::new();
        for of in kept {
            let [.., t_ms, _, _, _] = of.track.cameras[..] else { return Err(format!("{what}: {of:?}")) };
            found.insert((of.participant.as_str(), of.order as usize), t_ms);
        }
        for session in self.sessions.values() {
            for (place, (sent, is_certain)) in session.looked.iter().enumerate() {
                let known = found.remove(&(session.name.as_str(), place + TRAINING + 1));
                if known.map_or(*is_certain, |t_ms| !sent.contains(&t_ms)) {
                    let place = place + TRAINING + 1;
                    return Err(format!(
                        "{what}: participant {}, place {place}: cameras {known:?}",
                        session.name
                    ));
                }
            }
        }
        if found.is_empty() { Ok(()) } else { Err(format!("{what}: cameras of nobody: {found:?}")) }
    }

    /// Holds the panel's identifiers against those who have answered; `exact` where nobody else's may be there.
    pub(super) fn check_identities(&self, text: &str, rows: &Rows, exact: bool) -> Result<(), String> {
        let mut found = BTreeMap::new();
        for record in csv::Reader::from_reader(text.as_bytes()).records() {
            let record = record.map_err(|error| error.to_string())?;
            if found.insert(record[0].to_owned(), record[3].to_owned()).is_some() {
                return Err(format!("identities: {} is there twice", &record[0]));
            }
        }
        for session in self.sessions.values() {
            let answered = rows.keys().any(|(name, _)| *name == session.name);
            let known = found.remove(&session.name);
            let expected = session.panel.map(panel_session).filter(|_| answered);
            if known != expected && (exact || known.is_none() || answered) {
                return Err(format!("identities: {} has {known:?} in place of {expected:?}", session.name));
            }
        }
        if found.is_empty() { Ok(()) } else { Err(format!("identities: {found:?} are nobody's")) }
    }

    /// Holds the researcher's numbers against the rows and what was told.
    pub(super) fn check_summary(&self, text: &str, rows: &Rows) -> Result<(), String> {
        let said: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let number = |name: &str| said[name].as_u64().unwrap_or(u64::MAX) as usize;
        let finished = self.sessions.values().filter(|session| session.finished).count();
        let complete = self.sessions.values().filter(|one| one.acknowledged() == one.questions.len()).count();
        if number("answers") != rows.len() || !(finished..=complete).contains(&number("finished")) {
            return Err(format!(
                "summary: {} answers, {finished} to {complete} finished: {text}",
                rows.len()
            ));
        }
        Ok(())
    }
}

pub(super) fn panel_session(panel: usize) -> String {
    format!("session-{panel}")
}

/// The rows of the long format.
///
/// Returns what is wrong with it: a row that is there twice, a cell that cannot be.
pub(super) fn rows(text: &str) -> Result<Rows, String> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| error.to_string())?.clone();
    let column = |name: &str| header.iter().position(|of| of == name).ok_or(format!("no column {name}"));
    let names = ["participant", "order", "form", "stimulus", "choice", "rt_ms", "viewport_width"];
    let places = names.into_iter().map(column).collect::<Result<Vec<_>, _>>()?;
    let mut rows = Rows::new();
    for record in reader.records() {
        let record = record.map_err(|error| error.to_string())?;
        let cell = |column: usize| record[places[column]].to_owned();
        let number =
            |column: usize| cell(column).parse::<u32>().map_err(|error| format!("{record:?}: {error}"));
        let choice = Choice::of_code(&cell(4)).ok_or(format!("{record:?}: no choice"))?;
        let width = if cell(6).is_empty() { None } else { Some(number(6)?) };
        let said = Said { choice, rt_ms: number(5)?, width };
        if rows.insert((cell(0), number(1)?), (number(2)? as usize, cell(3), said)).is_some() {
            return Err(format!("a row is there twice: {record:?}"));
        }
    }
    Ok(rows)
}

/// The rows of what is read from a folder.
pub(super) fn rows_of(given: &[Given]) -> Result<Rows, String> {
    let mut rows = Rows::new();
    for Given { participant, form, answer } in given {
        let said = Said {
            choice: answer.choice,
            rt_ms: answer.rt_ms,
            width: answer.screen.map(|screen| screen.viewport_width),
        };
        if rows.insert((participant.clone(), answer.order), (*form, answer.stimulus.clone(), said)).is_some()
        {
            return Err(format!("{participant}, place {}, is there twice", answer.order));
        }
    }
    Ok(rows)
}
