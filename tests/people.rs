//! People with all that a study can ask of them and give them: 300 of them under kills; and a study that stops early.

use crate::command::Folder;
use crate::http::{get, post};
use crate::server::{Server, TOKEN, answer};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::net::SocketAddr;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The study of two methods with small and quick animations, and this in place of some of its lines.
fn folder(changes: &[(&str, &str)]) -> Folder {
    let small = [
        ("width = 320", "width = 64"),
        ("height = 320", "height = 64"),
        ("frames = 72", "frames = 2"),
        ("duration_s = 5.76", "duration_s = 0.4"),
        ("stimulus_spacing = 0.08", "stimulus_spacing = 0.25"),
        ("cpu/x86-64-v3.toml", "cpu.toml"),
    ];
    let mut study = include_str!("../configs/two-methods.toml").to_owned();
    for (from, to) in small.iter().chain(changes) {
        assert!(study.contains(from), "{from}");
        study = study.replace(from, to);
    }
    let folder = Folder::new();
    folder.write("cpu.toml", include_str!("../configs/cpu/x86-64-v3.toml"));
    folder.write("study.toml", study);
    folder.succeed(&["bundle", "study.toml", "--out", "out", "--with-faults"]);
    folder
}

fn serve(folder: &Folder, port: u16) -> Server {
    let mut command = folder.isostudy();
    command.args(["serve", "study.toml", "--out", "out", "--answers", "answers", "--with-faults"]);
    command.args(["--port", &port.to_string(), "--admin-token", TOKEN, "--sessions-per-address", "0"]);
    Server::of(command)
}

/// A file of the researcher's, as rows by the names of columns. No cell has a line break.
fn rows(address: SocketAddr, file: &str) -> Vec<BTreeMap<String, String>> {
    let (status, text) = get(address, &format!("/api/admin/{file}"), TOKEN).unwrap();
    assert_eq!(status, 200, "{text}");
    let mut reader = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<String>>());
    let header = reader.next().unwrap();
    reader.map(|cells| header.iter().cloned().zip(cells).collect()).collect()
}

fn summary(address: SocketAddr) -> Value {
    serde_json::from_str(&get(address, "/api/admin/summary", TOKEN).unwrap().1).unwrap()
}

/// All that can be switched on.
const KEYS: &str = r#"[forms]
languages = ["en", "de", "ar"]
contact = "Ada Lovelace"
ethics = "Board 17"
least_age = 18
retention_days = 365
comment = true
go_back = true
panel = "sona"
per_form = 40
completion = "https://example.org/credit?code={survey_code}"
completion_withdrawn = "GONE-1"
completion_screened = "OTHER-2"
completion_full = "FULL-3""#;

const ABOUT: &str = r#"[[forms.about]]
id = "vision"
kind = "colour-vision"
screens_out = [3]
most = [290, 0, 0, 0]
[[forms.about]]
id = "tools"
kind = "multiple"
ask = "Which tools do you use?"
options = ["Pencils", "Brushes", "Computers"]
[[forms.about]]
id = "age"
kind = "number"
ask = "How old are you?"
from = 18
to = 999
[[forms.about]]
id = "careful"
kind = "scale"
ask = "Please choose 2 here."
ends = ["low", "high"]
when = "after"
expects = 2

[analysis]"#;

const PEOPLE: usize = 300;
const KILLS: usize = 10;
const QUESTIONS: usize = 6;

/// What became of somebody, as the server confirmed it.
enum Ended {
    /// With these choices, by place.
    Finished { name: String, choices: Vec<&'static str> },
    /// Nothing of this token is kept.
    Withdrawn { token: String },
    /// A reply that counted the person may have been lost, and came again.
    ScreenedOut { again: bool },
}

/// The server forgot somebody who has not answered yet.
struct Forgotten;

struct Person {
    address: SocketAddr,
    number: usize,
}

impl Person {
    /// Asks until there is a reply: status, text, and whether an earlier one was lost.
    fn ask(&self, path: &str, body: &str) -> (u16, String, bool) {
        let mut lost = false;
        loop {
            match post(self.address, path, body) {
                Ok((503, _)) => {}
                Ok((status, text)) => return (status, text, lost),
                Err(_) => lost = true,
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    fn code(&self) -> String {
        format!("code-{}-", self.number)
    }

    fn about(&self, token: &str, id: &str, value: &str) -> Result<(String, bool), Forgotten> {
        let (status, text, lost) =
            self.ask("/api/about", &json!({ "token": token, "id": id, "value": value }).to_string());
        match status {
            200 => {
                Ok((serde_json::from_str::<Value>(&text).unwrap()["taken"].as_str().unwrap().into(), lost))
            }
            404 if lost => Err(Forgotten),
            404 => Err(Forgotten),
            other => panic!("{other} {text}"),
        }
    }

    fn withdraw(&self, token: &str) -> Ended {
        let (status, text, lost) = self.ask("/api/withdraw", &json!({ "receipt": &token[..16] }).to_string());
        assert!(status == 200 || (lost && status == 404), "{status} {text}");
        Ended::Withdrawn { token: token.into() }
    }

    /// From the first screen to the end.
    fn take_part(&self) -> Result<Ended, Forgotten> {
        let code = self.code();
        let lang = ["en", "de", "ar"][self.number % 3];
        let (status, text, _) = self.ask(
            "/api/sessions",
            &json!({ "lang": lang, "prolific_pid": code, "session_id": code }).to_string(),
        );
        assert_eq!(status, 200, "{text}");
        let session: Value = serde_json::from_str(&text).unwrap();
        let token = session["token"].as_str().unwrap();
        if self.number % 10 == 9 {
            // Where the reply was lost with the person, nobody knows whether that was counted.
            return match self.about(token, "vision", "3") {
                Ok((taken, lost)) => {
                    assert_eq!(taken, "screened");
                    Ok(Ended::ScreenedOut { again: lost })
                }
                Err(Forgotten) => Ok(Ended::ScreenedOut { again: true }),
            };
        }
        for (id, value) in [("vision", "1"), ("tools", "1;3"), ("age", &(100 + self.number).to_string())] {
            assert_eq!(self.about(token, id, value)?.0, "kept");
        }
        let mut choices = Vec::new();
        for question in 0..QUESTIONS {
            let mut choice = ["L", "NP", "R"][(self.number + question) % 3];
            let sent = answer(&session, question, choice);
            match self.ask("/api/answers", &sent) {
                (200, ..) => {}
                (404, ..) if question == 0 => return Err(Forgotten),
                (status, text, _) => panic!("{status} {text}"),
            }
            if self.number.is_multiple_of(4) {
                choice = if choice == "R" { "L" } else { "R" };
                let mut changed: Value = serde_json::from_str(&answer(&session, question, choice)).unwrap();
                changed["change"] = json!(1);
                let (status, text, _) = self.ask("/api/answers", &changed.to_string());
                assert_eq!(status, 200, "{text}");
            }
            choices.push(choice);
            if self.number % 5 == 2 && question == 2 {
                return Ok(self.withdraw(token));
            }
        }
        let words = format!("words of {code}");
        for (id, value) in [("careful", "2"), ("comment", words.as_str())] {
            assert_eq!(self.about(token, id, value)?.0, "kept");
        }
        let (status, text, _) = self.ask("/api/finish", &json!({ "token": token }).to_string());
        assert_eq!(status, 200, "{text}");
        if self.number % 5 == 3 {
            return Ok(self.withdraw(token));
        }
        Ok(Ended::Finished { name: session["participant"].as_str().unwrap().into(), choices })
    }
}

#[test]
fn with_everything_switched_on_300_people_lose_nothing_under_kills() {
    let folder =
        folder(&[("[forms]", KEYS), ("[analysis]", ABOUT), ("participants = 24", "participants = 12")]);
    let server = Mutex::new(serve(&folder, 0));
    let address = server.lock().unwrap().address;
    let ended: Mutex<BTreeMap<usize, Ended>> = Mutex::default();
    let killed = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for number in 0..PEOPLE {
            let (ended, killed) = (&ended, &killed);
            scope.spawn(move || {
                // Some come later: every kill meets people at all places.
                let mut later = number % 40;
                while later > 0 && !killed.load(Ordering::Relaxed) {
                    std::thread::sleep(Duration::from_millis(50));
                    later -= 1;
                }
                let person = Person { address, number };
                let end = loop {
                    if let Ok(end) = person.take_part() {
                        break end;
                    }
                };
                ended.lock().unwrap().insert(number, end);
            });
        }
        for _ in 0..KILLS {
            std::thread::sleep(Duration::from_millis(200));
            let mut server = server.lock().unwrap();
            server.kill();
            *server = serve(&folder, address.port());
        }
        killed.store(true, Ordering::Relaxed);
    });
    let ended = ended.into_inner().unwrap();
    assert_eq!(ended.len(), PEOPLE);

    let (mut choices, mut abouts, mut codes) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
    let (mut withdrawn, mut screened, mut doubtful) = (Vec::new(), 0, 0);
    for (&number, end) in &ended {
        let code = Person { address, number }.code();
        match end {
            Ended::Finished { name, choices: own } => {
                for (place, choice) in own.iter().enumerate() {
                    choices.insert((name.clone(), (2 + place).to_string()), (*choice).to_owned());
                }
                let age = (100 + number).to_string();
                abouts.insert(
                    name.clone(),
                    ["Pencils; Computers".to_owned(), age, "2".into(), format!("words of {code}")],
                );
                codes.insert(name.clone(), code);
            }
            Ended::Withdrawn { token } => withdrawn.push((token.clone(), code)),
            Ended::ScreenedOut { again } => {
                screened += 1;
                doubtful += u64::from(*again);
            }
        }
    }
    assert!(choices.len() > 700 && withdrawn.len() > 80 && screened == 30, "{}", choices.len());
    let kept = rows(address, "answers.csv");
    let count = kept.len();
    let kept: BTreeMap<(String, String), String> = kept
        .into_iter()
        .map(|row| ((row["participant"].clone(), row["order"].clone()), row["choice"].clone()))
        .collect();
    assert_eq!(kept.len(), count, "an answer is there twice");
    assert!(kept == choices, "{} kept, {} confirmed", kept.len(), choices.len());
    let said: BTreeMap<String, [String; 4]> = rows(address, "about.csv")
        .into_iter()
        .map(|row| {
            (row["participant"].clone(), ["tools", "age", "careful", "comment"].map(|of| row[of].clone()))
        })
        .collect();
    assert!(said == abouts, "{} of {} said the same of themselves", said.len(), abouts.len());
    let identities: BTreeMap<String, String> = rows(address, "identities.csv")
        .into_iter()
        .map(|row| (row["participant"].clone(), row["survey_code"].clone()))
        .collect();
    assert_eq!(identities, codes);
    // Of whoever withdrew there is nothing in any file.
    let files: Vec<Vec<u8>> = fs::read_dir(folder.path("answers"))
        .unwrap()
        .map(|file| fs::read(file.unwrap().path()).unwrap())
        .collect();
    let holds = |text: &str| {
        files.iter().any(|file| file.windows(text.len()).any(|window| window == text.as_bytes()))
    };
    assert!(holds(&codes.values().next().unwrap().clone()));
    for (token, code) in &withdrawn {
        assert!(!holds(token) && !holds(code), "something of {code} is left");
    }
    let stand = summary(address);
    assert_eq!(stand["finished"], codes.len());
    assert_eq!(stand["title"], "Which of two surfaces do you like better?");
    assert_eq!(stand["departures"]["withdrawn"], withdrawn.len());
    let counted = stand["departures"]["screened_out"].as_u64().unwrap();
    assert!(
        (screened - doubtful..=screened + doubtful).contains(&counted),
        "{counted} {screened} {doubtful}"
    );
    assert_eq!(
        stand["options"],
        json!([{ "question": "vision", "option": 1, "people": codes.len(), "most": 290 }])
    );
    assert_eq!(stand["words"], json!([["How well do you tell colours apart?", "As most people do"]]));
}

/// A study that looks at 8 and 12 people.
fn looking(when: &str) -> Folder {
    let rule = format!(
        "[analysis]\nprimary = [\"U-I\"]\nstopping = {{ looks = [8, 12], boundary = \"pocock\", when = \"{when}\" }}"
    );
    folder(&[("[analysis]", &rule), ("participants = 24", "participants = 12")])
}

/// Lets people answer, all of whom like the one method, or all of whom like neither; returns what the rule says after each.
fn says(folder: &Folder, server: &Server, people: usize, liked: Option<&str>) -> Vec<Value> {
    let key = fs::read_to_string(folder.path("out/key/forms.csv")).unwrap();
    let mut lines = key.lines().map(|line| line.split(',').collect::<Vec<&str>>());
    let header = lines.next().unwrap();
    let place = |name: &str| header.iter().position(|of| *of == name).unwrap();
    let left: BTreeMap<&str, &str> =
        lines.map(|line| (line[place("stimulus")], line[place("left")])).collect();
    let one = |_| {
        let session = crate::server::begin(server.address);
        for question in 0..QUESTIONS {
            let shown = session["form"]["questions"][question].as_str().unwrap();
            let choice = match liked {
                None => "NP",
                Some(liked) if left[shown].ends_with(liked) => "L",
                Some(_) => "R",
            };
            let (status, text) =
                post(server.address, "/api/answers", &answer(&session, question, choice)).unwrap();
            assert_eq!(status, 200, "{text}");
        }
        let finish = json!({ "token": session["token"] }).to_string();
        assert_eq!(post(server.address, "/api/finish", &finish).unwrap().0, 200);
        let stopping = summary(server.address)["stopping"].clone();
        assert_eq!(stopping["looks"], json!([8, 12]));
        json!([stopping["look"], stopping["says"]])
    };
    (0..people).map(one).collect()
}

#[test]
fn a_declared_rule_stops_a_study_at_a_look_and_the_report_judges_by_it() {
    let folder = looking("all");
    let server = serve(&folder, 0);
    let all = says(&folder, &server, 9, Some("_bi"));
    assert!(all[..7].iter().all(|says| *says == json!([0, "wait"])), "{all:?}");
    assert!(all[7..].iter().all(|says| *says == json!([1, "stop"])), "{all:?}");
    // Four more begin and do not finish: they reach no further look, and say nothing of the methods.
    for _ in 0..4 {
        let session = crate::server::begin(server.address);
        assert_eq!(post(server.address, "/api/answers", &answer(&session, 0, "NP")).unwrap().0, 200);
    }
    assert_eq!(summary(server.address)["stopping"]["look"], 1);
    fs::write(folder.path("answers.csv"), get(server.address, "/api/admin/answers.csv", TOKEN).unwrap().1)
        .unwrap();
    drop(server);
    folder.succeed(&["analyse", "study.toml", "--responses", "answers.csv", "--out", "read"]);
    let report = folder.read("read/report.html");
    assert!(report.contains("These answers are look 1"), "the look is not said");
    // Nine who agree: 2 / 2^9. SciPy's normal distribution of two looks at 2/3 and 1 gives the repeated p.
    let tests = folder.read("read/tables/tests.csv");
    let header: Vec<&str> = tests.lines().find(|line| !line.starts_with('#')).unwrap().split(',').collect();
    let place = |name: &str| header.iter().position(|of| *of == name).unwrap_or_else(|| panic!("{header:?}"));
    let primary = tests.lines().map(|line| line.split(',').collect::<Vec<&str>>());
    let primary: Vec<Vec<&str>> = primary.filter(|line| line[0] == "primary").collect();
    assert_eq!(primary.len(), 1, "{tests}");
    let number = |name: &str| primary[0][place(name)].parse::<f64>().unwrap();
    assert!((number("p_sign_flip") - 2.0 / 512.0).abs() < 1e-6, "{}", number("p_sign_flip"));
    assert!((number("p_adjusted") - REPEATED).abs() < 1e-4, "{}", number("p_adjusted"));
}

/// 1 - P(|z1| < c, |z2| < c) with correlation sqrt(2/3) and c of p = 2/512, by `scipy.stats.multivariate_normal`.
const REPEATED: f64 = 0.006_584_36;

#[test]
fn without_a_difference_a_rule_goes_on_to_the_end() {
    let folder = looking("any");
    let server = serve(&folder, 0);
    let all = says(&folder, &server, 12, None);
    assert!(all[..7].iter().all(|says| *says == json!([0, "wait"])), "{all:?}");
    assert!(all[7..11].iter().all(|says| *says == json!([1, "go-on"])), "{all:?}");
    assert_eq!(all[11], json!([2, "end"]));
}
