//! A server of a questionnaire, for as long as a test needs it.

use crate::fixture::Fixture;
use crate::http::post;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::process::{Child, Command, Stdio};

pub(crate) const TOKEN: &str = "a-token-for-this-test";

pub(crate) struct Server {
    pub(crate) child: Child,
    pub(crate) address: SocketAddr,
}

/// `isostudy serve`.
pub(crate) fn command(fixture: &Fixture, port: u16) -> Command {
    let mut command = fixture.command("serve");
    command.arg("--answers").arg(fixture.folder().join("answers")).stdout(Stdio::null());
    command.args(["--port", &port.to_string(), "--admin-token", TOKEN, "--with-faults"]);
    command
}

impl Server {
    /// Answers are kept in the fixture's folder `answers`.
    pub(crate) fn start(fixture: &Fixture, port: u16) -> Self {
        Self::of(command(fixture, port))
    }

    /// As the command says.
    pub(crate) fn of(mut command: Command) -> Self {
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
        let line = lines.find(|line| line.starts_with("questionnaire")).expect("it listens");
        let address = line.split("http://").nth(1).unwrap().trim_end_matches('/').parse().unwrap();
        // Nobody reads the rest, and a full pipe must not stop the server.
        std::thread::spawn(move || lines.for_each(drop));
        Self { child, address }
    }

    pub(crate) fn kill(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

/// A session, as a participant's page has it.
pub(crate) fn begin(address: SocketAddr) -> Value {
    let (status, body) = post(address, "/api/sessions", "{}").unwrap();
    assert_eq!(status, 200, "{body}");
    serde_json::from_str(&body).unwrap()
}

/// What the page sends for the session's question at this place, training left out.
pub(crate) fn answer(session: &Value, question: usize, choice: &str) -> String {
    let form = &session["form"];
    let first = form["training"].as_array().unwrap().len() + 1;
    json!({
        "token": session["token"], "order": first + question, "stimulus": form["questions"][question],
        "choice": choice, "rt_ms": 1500,
    })
    .to_string()
}
