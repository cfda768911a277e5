//! A study that asks where an answer tells most, from the file over the server to the report.

use crate::fixture::Fixture;
use crate::http::{get, post};
use crate::server::{Server, TOKEN, answer, begin, command};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::net::SocketAddr;

/// Log worths of the methods.
const WORTHS: [(&str, f64); 6] =
    [("bu", 0.0), ("bi", 1.6), ("bp", 0.8), ("su", -0.8), ("si", 0.8), ("sp", 0.0)];
const PEOPLE: usize = 36;

fn rows(text: &str) -> Vec<BTreeMap<String, String>> {
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = lines.next().unwrap();
    lines.map(|cells| header.iter().cloned().zip(cells).collect()).collect()
}

/// What a person whose n-th draw is this answers to a pair.
fn choice(left: f64, right: f64, draw: f64) -> &'static str {
    let weights = [left.exp(), 0.3 * ((left + right) / 2.0).exp(), right.exp()];
    let mut rest = draw * weights.iter().sum::<f64>();
    for (code, weight) in ["L", "NP"].into_iter().zip(weights) {
        rest -= weight;
        if rest < 0.0 {
            return code;
        }
    }
    "R"
}

fn questions(session: &Value) -> Vec<String> {
    session["form"]["questions"]
        .as_array()
        .unwrap()
        .iter()
        .map(|of| of.as_str().unwrap().to_owned())
        .collect()
}

fn state(address: SocketAddr, token: &str) -> Value {
    let (status, text) = post(address, "/api/state", &format!("{{\"token\":\"{token}\"}}")).unwrap();
    assert_eq!(status, 200, "{text}");
    serde_json::from_str(&text).unwrap()
}

/// Planted worths come out of the model that is made for chosen pairs; half of each form stays; a server that is killed still asks what it
/// chose; and nobody is asked about a comparison twice.
#[test]
fn what_was_answered_decides_half_of_what_is_asked_next() {
    let fixture = Fixture::balanced();
    fixture.edit("[forms]", "[forms]\nadaptive = true");
    fixture.edit_with(|text| {
        let line = |line: &str| match line.split(" = ").next() {
            Some("repeats") => "repeats = 0\n".to_owned(),
            Some("controls") => "controls = 1\n".to_owned(),
            Some("max_questions") => "max_questions = 13\n".to_owned(),
            _ => format!("{line}\n"),
        };
        text.lines().map(line).collect()
    });
    let serve = |port: u16| {
        let mut serve = command(&fixture, port);
        serve.args(["--sessions-per-address", "0"]);
        Server::of(serve)
    };
    let mut server = serve(0);
    let address = server.address;
    let read = |name: &str| std::fs::read_to_string(fixture.out().join(name)).unwrap();
    let key = rows(&read("key/forms.csv"));
    let plan: Value = serde_json::from_str(&read("bundle/forms.json")).unwrap();
    let shows: BTreeMap<&str, [&str; 2]> = key
        .iter()
        .map(|line| (line["stimulus"].as_str(), [line["left"].as_str(), line["right"].as_str()]))
        .collect();
    let anywhere = key.iter().filter(|line| line["form"] == "0").count();
    assert_eq!(anywhere, 2 * 27);
    let worth = |side: &str| {
        let method = side.split_once('_').unwrap().1;
        WORTHS.iter().find(|(id, _)| *id == method).unwrap().1
    };
    // A sequence that fills the line evenly (Weyl 1916).
    let mut draw = 0.0_f64;
    let mut changed = 0;
    for person in 0..PEOPLE {
        let session = begin(address);
        let asked = questions(&session);
        let form = session["form"]["form"].as_u64().unwrap() as usize;
        let planned = questions(&serde_json::json!({ "form": plan["forms"][form - 1] }));
        assert_eq!(asked.len(), planned.len());
        let kept = asked.iter().zip(&planned).filter(|(a, b)| a == b).count();
        assert!(kept >= asked.len() / 2, "{kept} of {}", asked.len());
        changed += asked.len() - kept;
        let once: BTreeSet<[&str; 2]> = asked
            .iter()
            .map(|code| {
                let mut sides = shows[code.as_str()];
                sides.sort_unstable();
                sides
            })
            .collect();
        assert_eq!(once.len(), asked.len(), "asked twice");
        for (place, code) in asked.iter().enumerate() {
            let [left, right] = shows[code.as_str()].map(worth);
            draw = (draw + 0.618_033_988_749_895).fract();
            let (status, text) =
                post(address, "/api/answers", &answer(&session, place, choice(left, right, draw))).unwrap();
            assert_eq!(status, 200, "{text}");
            if person == 10 && place == 3 {
                // What was chosen is on disk with the first answer.
                server.kill();
                server = serve(address.port());
                let again = state(address, session["token"].as_str().unwrap());
                assert_eq!((questions(&again), again["answered"].as_u64()), (asked.clone(), Some(4)));
            }
        }
        let token = session["token"].as_str().unwrap();
        assert_eq!(post(address, "/api/finish", &format!("{{\"token\":\"{token}\"}}")).unwrap().0, 200);
    }
    // Of nine pairs of methods up to six are dealt, so that three or more can be chosen.
    assert!(changed >= PEOPLE * 3, "{changed}");
    let (status, csv) = get(address, "/api/admin/answers.csv", TOKEN).unwrap();
    assert_eq!(status, 200, "{csv}");
    drop(server);
    let answers = fixture.folder().join("answers.csv");
    std::fs::write(&answers, &csv).unwrap();
    fixture.succeed("analyse", &["--responses", answers.to_str().unwrap()]);
    let report = read("report.md");
    for said in
        ["Answers that were there before decided half of what each person was asked", "worths drawn together"]
    {
        assert!(report.contains(said), "{said}: {report}");
    }
    let found = rows(&read("tables/ways.csv"));
    let own: Vec<_> =
        found.iter().filter(|row| row["model"] == "drawn-together" && row["group"] == "all").collect();
    assert_eq!(own.len(), WORTHS.len(), "{found:?}");
    let first = worth(&format!("ss_{}", own[0]["item"]));
    for row in own.iter().filter(|row| !row["low"].is_empty()) {
        let number = |column: &str| row[column].replace('\u{2212}', "-").parse::<f64>().unwrap();
        let truth = worth(&format!("ss_{}", row["item"])) - first;
        assert!((number("low")..=number("high")).contains(&truth), "{truth}: {row:?}");
    }
}

#[test]
fn what_cannot_be_chosen_is_refused() {
    for (from, to, wanted) in [
        ("[forms]", "[forms]\nadaptive = true", "forms.repeats"),
        (
            "[forms]",
            "[forms]\nadaptive = true\nway = \"graded\"",
            "forms.adaptive = true: goes with forms.way",
        ),
    ] {
        let fixture = Fixture::balanced();
        fixture.edit(from, to);
        let run = fixture.run("pairs", &[]);
        assert!(run.code != Some(0) && run.stderr.contains(wanted), "{}", run.stderr);
    }
}
