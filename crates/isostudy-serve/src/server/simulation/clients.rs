//! Pages in browsers: what each sends next, and what it makes of a reply.

use super::people::{Asked, People, Said, TRAINING, panel_session};
use super::running::Reply;
use super::{QUESTIONS, Simulation};
use crate::record::Choice;
use serde_json::{Value, json};

/// Most requests on their way.
const NETWORK: usize = 12;

/// A page in somebody's browser.
#[derive(Default)]
pub(super) struct Client {
    pub(super) panel: Option<usize>,
    pub(super) token: Option<String>,
    /// The next place, as far as the page knows.
    pub(super) next: usize,
    /// What is being sent to it.
    said: Option<Said>,
    pub(super) done: bool,
}

impl Client {
    /// Somebody who has just come, of a panel or not.
    pub(super) fn of(panel: Option<usize>) -> Self {
        Self { panel, ..Self::default() }
    }
}

impl Simulation<'_> {
    /// Has a page do the next thing, or something odd.
    pub(super) fn act(&mut self, number: usize, wild: bool) {
        if self.network.len() >= NETWORK {
            return;
        }
        let chance = &mut self.chance;
        let answers = self.settings.file.answers();
        let client = &mut self.clients[number];
        let Some(token) = client.token.clone() else {
            self.network.push((number, Asked::Begin { panel: client.panel }));
            return;
        };
        let mut say = || Said {
            choice: Choice::of_code(answers[chance.below(answers.len())].code).expect("an answer"),
            rt_ms: chance.below(9000) as u32,
            width: chance.percent(50).then(|| 300 + chance.below(1000) as u32),
        };
        let mut asked = Vec::new();
        if client.next < QUESTIONS {
            let said = *client.said.get_or_insert_with(&mut say);
            asked.push(Asked::Answer { token: token.clone(), place: client.next, said });
        } else if !client.done {
            asked.push(Asked::Finish { token: token.clone() });
        }
        if wild {
            let other = say();
            match self.chance.below(100) {
                0..10 => asked.extend(asked.first().cloned()),
                10..18 => {
                    let place = self.chance.below(QUESTIONS.min(client.next + 1));
                    asked.push(Asked::Answer { token, place, said: other });
                }
                18..24 if client.next + 1 < QUESTIONS => {
                    asked.push(Asked::Answer { token, place: client.next + 1, said: other });
                }
                24..32 if client.next > 0 => {
                    let place = self.chance.below(client.next);
                    let sent = self.people.sessions[&token].sent(place);
                    if let Some(&said) = sent.first() {
                        asked.push(Asked::Answer { token, place, said });
                    }
                }
                32..38 => asked.push(Asked::State { token }),
                38..42 => client.token = None,
                42..45 => asked.push(Asked::Finish { token }),
                _ => {}
            }
        }
        for asked in asked {
            if let Asked::Answer { token, place, said } = &asked {
                self.people.send(token, *place, *said);
            }
            self.network.push((number, asked));
        }
    }

    /// What a page makes of a reply.
    pub(super) fn hear(&mut self, number: usize, asked: &Asked, reply: &Reply) {
        let client = &mut self.clients[number];
        if client.token.as_deref() != asked.token() {
            return;
        }
        let said: Value = serde_json::from_str(&reply.text).unwrap_or_default();
        match (asked, reply.status) {
            (Asked::Begin { .. } | Asked::State { .. }, 200) => {
                client.token = said["token"].as_str().map(str::to_owned);
                client.next = said["answered"].as_u64().unwrap_or(0) as usize;
                client.said = None;
            }
            (Asked::Answer { place, .. }, 200) if *place == client.next => {
                client.next += 1;
                client.said = None;
                // Somebody who turned models tells it after the answer, and perhaps once more.
                if self.chance.percent(40) {
                    let token = client.token.clone().expect("it asked with it");
                    let (place, t_ms) = (*place, 50 + self.chance.below(9000) as i32);
                    self.people.look(&token, place, t_ms);
                    let looked = Asked::Cameras { token, place, t_ms };
                    if self.chance.percent(20) {
                        self.network.push((number, looked.clone()));
                    }
                    self.network.push((number, looked));
                }
            }
            (Asked::Finish { .. }, 200) => client.done = true,
            (_, 404) => *client = Client::of(client.panel),
            (_, 409) => {
                let token = client.token.clone().expect("it asked with it");
                self.network.push((number, Asked::State { token }));
            }
            _ => {}
        }
    }
}

/// What a page sends.
pub(super) fn body(people: &People, asked: &Asked) -> String {
    let body = match asked {
        Asked::Begin { panel: None } => json!({}),
        Asked::Begin { panel: Some(panel) } => {
            json!({"prolific_pid": "5f9", "study_id": "61a", "session_id": panel_session(*panel)})
        }
        Asked::State { token } | Asked::Finish { token } => json!({ "token": token }),
        Asked::Cameras { token, place, t_ms } => {
            let track = json!({"hz": 20, "cameras": [0, 450, 222, 1000, t_ms, 525, 222, 1000]});
            json!({"token": token, "order": place + TRAINING + 1, "track": track})
        }
        Asked::Answer { token, place, said } => {
            let stimulus = &people.sessions[token].questions[*place];
            let screen = said.width.map(|width| {
                json!({
                    "viewport_width": width, "viewport_height": 800, "pixel_ratio": 1.5, "surface_px": 300,
                    "layout": "beside", "input": "mouse", "dropped": 0, "hidden_ms": 0, "shown_as": "gif",
                })
            });
            json!({
                "token": token, "order": place + TRAINING + 1, "stimulus": stimulus,
                "choice": said.choice, "rt_ms": said.rt_ms, "screen": screen,
            })
        }
    };
    body.to_string()
}

/// Where to.
pub(super) fn path(asked: &Asked) -> &'static str {
    match asked {
        Asked::Begin { .. } => "/api/sessions",
        Asked::State { .. } => "/api/state",
        Asked::Answer { .. } => "/api/answers",
        Asked::Cameras { .. } => "/api/cameras",
        Asked::Finish { .. } => "/api/finish",
    }
}
