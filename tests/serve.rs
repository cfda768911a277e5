//! The questionnaire's server as participants, and those who mean ill, meet it.

use crate::command::{Run, isostudy};
use crate::fixture;
use crate::fixture::Fixture;
use crate::http::{get, post, raw};
use crate::server::{Server, TOKEN, answer, begin, command};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::Path;
use std::process::Stdio;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU16, Ordering};
use std::time::Duration;

/// The quick study asked as in configs/balanced.toml, bundled.
fn bundled() -> Fixture {
    let fixture = Fixture::balanced();
    fixture.succeed("bundle", &[]);
    fixture
}

/// A port that stays free while no server has it: none twice, and below those that a system gives to whoever asks for any.
fn free_port() -> u16 {
    static GIVEN: AtomicU16 = AtomicU16::new(0);
    let first = 20_000 + (std::process::id() % 10_000) as u16;
    let mut ports = std::iter::repeat_with(|| first + GIVEN.fetch_add(1, Ordering::Relaxed));
    ports.find(|&port| TcpListener::bind(("127.0.0.1", port)).is_ok()).unwrap()
}

/// Every answer there is: participant and place to choice.
fn kept(address: SocketAddr) -> BTreeMap<(String, String), String> {
    let (status, csv) = get(address, "/api/admin/answers.csv", TOKEN).unwrap();
    assert_eq!(status, 200, "{csv}");
    let lines: Vec<Vec<&str>> = csv.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let count = lines.len();
    let kept: BTreeMap<_, _> = lines
        .into_iter()
        .map(|line| ((line[0].to_owned(), line[2].to_owned()), line[8].to_owned()))
        .collect();
    assert_eq!(kept.len(), count, "an answer is there twice");
    kept
}

#[test]
fn what_is_not_meant_well_changes_nothing() {
    let fixture = bundled();
    let server = Server::start(&fixture, 0);
    let at = server.address;
    let status = |path: &str, body: &str| post(at, path, body).unwrap().0;
    let session = begin(at);
    let token = session["token"].as_str().unwrap();
    assert_eq!(status("/api/answers", &answer(&session, 0, "L")), 200);
    let before = kept(at);
    assert_eq!(before.len(), 1);

    // Replayed, changed, out of order, of another form, of nobody.
    assert_eq!(status("/api/answers", &answer(&session, 0, "L")), 200);
    assert_eq!(status("/api/answers", &answer(&session, 0, "R")), 409);
    assert_eq!(status("/api/answers", &answer(&session, 2, "R")), 409);
    let mut other = session.clone();
    other["form"]["questions"][1] = json!("../key");
    assert_eq!(status("/api/answers", &answer(&other, 1, "R")), 422);
    other = session.clone();
    other["token"] = json!("00000000000000000000000000000000");
    assert_eq!(status("/api/answers", &answer(&other, 1, "R")), 404);
    assert_eq!(status("/api/finish", &json!({ "token": token }).to_string()), 409);

    // Wrong types, words and sizes.
    for bad in [
        "",
        "{",
        "[]",
        "{}",
        r#"{"token":1}"#,
        "\u{0}",
        r#"{"token":"x","order":-1,"stimulus":"a","choice":"L","rt_ms":1}"#,
    ] {
        let found = status("/api/answers", bad);
        assert!(found == 400 || found == 422, "{bad}: {found}");
    }
    let long = answer(&session, 1, "L").replace(r#""rt_ms":1500"#, r#""rt_ms":86400001"#);
    assert_eq!(status("/api/answers", &long), 422);
    assert_eq!(status("/api/answers", &answer(&session, 1, "maybe")), 422);
    assert_eq!(status("/api/answers", &format!("{{\"token\":\"{}\"}}", "x".repeat(10_000))), 413);
    assert_eq!(status("/api/sessions", r#"{"prolific_pid":"<script>"}"#), 422);
    assert_eq!(status("/api/sessions", r#"{"ip":"1.2.3.4"}"#), 422);
    let plain =
        "POST /api/answers HTTP/1.1\r\nhost: localhost\r\ncontent-length: 2\r\nconnection: close\r\n\r\n{}";
    assert_eq!(raw(at, plain.as_bytes()).unwrap().0, 415);

    // Files that are nobody's.
    for path in [
        "/stimuli/../key/stimuli.csv",
        "/stimuli/..%2f..%2fkey%2fstimuli.csv",
        "/%2e%2e/key/forms.csv",
        "/key/forms.csv",
        "/answers.sqlite",
        "/stimuli/none.gif",
        "/stimuli/",
        "/forms.json",
        "//etc/passwd",
    ] {
        assert_eq!(get(at, path, "").unwrap().0, 404, "{path}");
    }
    let code = session["form"]["questions"][0].as_str().unwrap();
    let whole = get(at, &format!("/stimuli/{code}.gif"), "").unwrap();
    assert!(whole.0 == 200 && whole.1.starts_with("GIF89a"));

    // The researcher's door.
    for path in ["/api/admin/summary", "/api/admin/answers.csv", "/api/admin/identities.csv"] {
        for wrong in ["", "a", "a-token-for-this-tesT", "a-token-for-this-test "] {
            let found = get(at, path, wrong).unwrap();
            // Spaces round a header's value are no part of it.
            assert_eq!(found.0, if wrong.ends_with(' ') { 200 } else { 401 }, "{path} {wrong:?}");
        }
    }
    // What a participant's page knows says nothing of others, nor of what is shown.
    let known = get(at, "/forms.js", "").unwrap().1;
    assert!(known.contains("\"forms\":[]") && !known.contains("_b"), "{known}");
    assert_eq!(kept(at), before);
}

#[test]
fn a_slow_client_is_cut_off_and_holds_up_nobody() {
    let fixture = bundled();
    let server = Server::start(&fixture, 0);
    let mut slow = TcpStream::connect(server.address).unwrap();
    slow.write_all(b"POST /api/answers HTTP/1.1\r\nhost: localhost\r\n").unwrap();
    let session = begin(server.address);
    assert_eq!(post(server.address, "/api/answers", &answer(&session, 0, "NP")).unwrap().0, 200);
    // The server gives up after ten seconds; the client would wait for a minute.
    slow.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    let mut said = Vec::new();
    std::io::Read::read_to_end(&mut slow, &mut said).unwrap();
    let said = String::from_utf8_lossy(&said);
    assert!(said.is_empty() || said.contains(" 408 "), "{said}");
}

/// Killed ten times while people answer: what was acknowledged is there once, and forms stay balanced.
#[test]
fn nothing_acknowledged_is_lost_when_the_server_is_killed() {
    const PEOPLE: usize = 40;
    let fixture = bundled();
    let port = free_port();
    let address = SocketAddr::from(([127, 0, 0, 1], port));
    let server = Mutex::new(Server::start(&fixture, port));
    let acknowledged: Mutex<BTreeMap<(String, String), String>> = Mutex::default();
    let enough = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for person in 0..PEOPLE {
            let (acknowledged, enough) = (&acknowledged, &enough);
            scope.spawn(move || {
                let pause = || std::thread::sleep(Duration::from_millis(20));
                let begun = || -> Value {
                    loop {
                        match post(address, "/api/sessions", "{}") {
                            Ok((200, body)) => break serde_json::from_str(&body).unwrap(),
                            _ => pause(),
                        }
                    }
                };
                let mut session = begun();
                let count = session["form"]["questions"].as_array().unwrap().len();
                for question in 0..count {
                    let choice = ["L", "NP", "R"][(person + question) % 3];
                    let order = loop {
                        let sent = answer(&session, question, choice);
                        match post(address, "/api/answers", &sent) {
                            Ok((200, _)) => {
                                break serde_json::from_str::<Value>(&sent).unwrap()["order"].to_string();
                            }
                            // Nobody is written down before the first answer.
                            Ok((404, _)) if question == 0 => session = begun(),
                            Ok((status, body)) => panic!("{status} {body}"),
                            Err(_) => pause(),
                        }
                    };
                    let key = (session["participant"].as_str().unwrap().to_owned(), order);
                    acknowledged.lock().unwrap().insert(key, choice.to_owned());
                    if !enough.load(Ordering::Relaxed) {
                        pause();
                    }
                }
            });
        }
        for _ in 0..10 {
            std::thread::sleep(Duration::from_millis(150));
            let mut server = server.lock().unwrap();
            server.kill();
            *server = Server::start(&fixture, port);
        }
        enough.store(true, Ordering::Relaxed);
    });
    let (kept, acknowledged) = (kept(address), acknowledged.into_inner().unwrap());
    assert_eq!(acknowledged.len(), PEOPLE * 32);
    assert!(kept == acknowledged, "{} kept, {} acknowledged", kept.len(), acknowledged.len());
    let (_, summary) = get(address, "/api/admin/summary", TOKEN).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let live: Vec<u64> =
        summary["forms"].as_array().unwrap().iter().map(|form| form[1].as_u64().unwrap()).collect();
    assert!(live.iter().max().unwrap() - live.iter().min().unwrap() <= 1, "{live:?}");
}

/// While a server has the answers they can be given away; the study file may be changed in its texts for that, and in the number of
/// its participants for the server too.
#[test]
fn answers_outlive_changes_of_the_study_file() {
    let fixture = bundled();
    let server = Server::start(&fixture, 0);
    let session = begin(server.address);
    assert_eq!(post(server.address, "/api/answers", &answer(&session, 0, "R")).unwrap().0, 200);
    let shared = fixture.folder().join("shared");
    let deidentify = || {
        let answers = fixture.folder().join("answers");
        let words = [fixture.config(), "--answers".into(), answers, "--out".into(), shared.clone()];
        let said = Run::succeed(isostudy().arg("deidentify").args(words)).stderr;
        assert_eq!(std::fs::read_to_string(shared.join("answers.csv")).unwrap().lines().count(), 2);
        (said, std::fs::read_to_string(shared.join("codebook.md")).unwrap())
    };
    let (said, codebook) = deidentify();
    assert!(
        said.is_empty()
            && codebook.contains("1 answer of 1 participant, in")
            && !codebook.contains("changed"),
        "{said}"
    );
    let prompt = "prompt = \"Which of the two do you like better?\"";
    fixture.edit(prompt, "prompt = \"Which one?\"");
    let (said, codebook) = deidentify();
    assert!(
        said.contains("was changed since") && codebook.contains("was changed after the first answer"),
        "{said}"
    );
    fixture.edit("prompt = \"Which one?\"", prompt);
    drop(server);

    fixture.edit("participants = 36", "participants = 40");
    let server = Server::start(&fixture, 0);
    assert_eq!(post(server.address, "/api/answers", &answer(&session, 1, "L")).unwrap().0, 200);
    let state =
        post(server.address, "/api/state", &json!({ "token": session["token"] }).to_string()).unwrap();
    let state: Value = serde_json::from_str(&state.1).unwrap();
    assert!(state["answered"] == 2 && state["form"] == session["form"], "{state}");
    let unknown = post(server.address, "/api/state", &json!({ "token": "00" }).to_string()).unwrap();
    assert_eq!(unknown.0, 404);
}

#[cfg(unix)]
#[test]
fn serving_keeps_the_bundles_videos() {
    let fixture = bundled();
    let script = "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\n[ \"$3\" = -encoders ] && echo libx264 && exit 0\n\
        for last; do :; done\ncksum > \"$last\"\n";
    let path = fixture.with_ffmpeg(script);
    let output = fixture.command("bundle").arg("--mp4").env("PATH", path).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let videos = || {
        let made = fixture::files(&fixture.out().join("bundle/stimuli"));
        made.keys().filter(|name| name.ends_with(".mp4")).count()
    };
    assert_eq!(videos(), 56);
    drop(Server::start(&fixture, 0));
    assert_eq!(videos(), 56);
}

/// The log is on a full disk from the start.
#[cfg(target_os = "linux")]
#[test]
fn a_server_that_cannot_say_a_word_serves() {
    let fixture = bundled();
    let port = free_port();
    let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
    let child = command(&fixture, port).stderr(full).spawn().unwrap();
    let address = SocketAddr::from(([127, 0, 0, 1], port));
    let server = Server { child, address };
    let listens = (0..600).any(|_| {
        std::thread::sleep(Duration::from_millis(50));
        TcpStream::connect(address).is_ok()
    });
    assert!(listens);
    let session = begin(server.address);
    assert_eq!(post(server.address, "/api/answers", &answer(&session, 0, "L")).unwrap().0, 200);
}

/// What a server says when it starts: how much it holds, and that something is missing.
#[test]
fn a_server_counts_its_answers() {
    let fixture = bundled();
    let mut server = Server::start(&fixture, 0);
    let session = begin(server.address);
    for question in 0..3 {
        assert_eq!(post(server.address, "/api/answers", &answer(&session, question, "L")).unwrap().0, 200);
    }
    server.kill();
    std::fs::remove_file(fixture.folder().join("answers/answers.sqlite-wal")).unwrap();
    let output = command(&fixture, 0).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && said.contains("3 answers of 1 participant"), "{said}");
    let mut child = command(&fixture, 0).arg("--accept-loss").stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    let holds = lines.find(|line| line.starts_with("holds")).expect("it says so");
    assert!(holds.ends_with(" 0 answers of 0 participants"), "{holds}");
    drop(Server { child, address: SocketAddr::from(([127, 0, 0, 1], 0)) });
}

/// A download that was changed on its way, and what a spreadsheet makes of what is made from it.
#[test]
fn a_download_brings_no_formula() {
    let fixture = bundled();
    let server = Server::start(&fixture, 0);
    let form = &begin(server.address)["form"];
    let (number, order) = (&form["form"], form["training"].as_array().unwrap().len() + 1);
    let stimulus = form["questions"][0].as_str().unwrap();
    let [download, out] = ["download.csv", "answers.csv"].map(|name| fixture.folder().join(name));
    let row =
        format!("participant,form,order,stimulus,choice,rt_ms\n=1+1,{number},{order},{stimulus},NP,812\n");
    std::fs::write(&download, row).unwrap();
    let collect = |download: &Path| {
        Run::of(isostudy().arg("collect").arg(fixture.config()).arg(download).arg("--out").arg(&out))
    };
    assert_eq!(collect(&download).code, Some(0));
    let text = std::fs::read_to_string(&out).unwrap();
    assert!(text.lines().nth(1).unwrap().starts_with("'=1+1,"), "{text}");
    // A download is not written over, and a file without answers is none.
    let onto_itself = [&download, Path::new("--out"), &download];
    let over = Run::of(isostudy().arg("collect").arg(fixture.config()).args(onto_itself));
    assert_eq!(over.code, Some(2));
    assert!(over.stderr.contains("download.csv: is a download; it would be written over"), "{}", over.stderr);
    for (nothing, what) in [
        ("", "This file is empty"),
        ("hello\n", "This file has hello"),
        ("[1,2]\n", "This file has [1, 2]"),
        ("participant,form,order,stimulus,choice,rt_ms\n", "empty.csv: no answers in it"),
    ] {
        let empty = fixture.folder().join("empty.csv");
        std::fs::write(&empty, nothing).unwrap();
        let Run { code, stderr: said, .. } = collect(&empty);
        assert!(code == Some(2) && said.contains("empty.csv: ") && said.contains(what), "{said}");
    }
    let Run { code, stderr: said, .. } = collect(Path::new("/dev/null"));
    assert!(code == Some(2) && said == "isostudy: /dev/null: not a file, but a device\n", "{said}");
    // A folder of downloads gives what its files give, but for hidden ones.
    let folder = fixture.folder().join("downloads");
    std::fs::create_dir(&folder).unwrap();
    assert!(collect(&folder).stderr.contains("downloads: no files in it"));
    std::fs::copy(&download, folder.join("one.csv")).unwrap();
    std::fs::write(folder.join(".DS_Store"), "x").unwrap();
    assert_eq!(collect(&folder).code, Some(0));
    assert_eq!(std::fs::read_to_string(&out).unwrap(), text);
}

/// Between the first answer and `analyse`, the page and the command say that answers are there, and what reads them.
#[test]
fn a_page_knows_of_answers_that_it_has_not_read() {
    let fixture = Fixture::balanced();
    let id = "quick";
    let study = || {
        let run = Run::of(fixture.command("study").current_dir(fixture.folder()));
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        let page = std::fs::read_to_string(fixture.out().join("index.html")).unwrap();
        (run.stderr, page.replace("&#x2f;", "/").replace("&#x27;", "'"))
    };
    let (said, page) = study();
    assert!(!said.contains("isostudy analyse") && page.contains("Nobody's answers"), "{said}");

    let folder = format!("answers/{id}");
    let mut serve = fixture.command("serve");
    serve.current_dir(fixture.folder()).args(["--port", "0", "--admin-token", TOKEN, "--with-faults"]);
    let server = Server::of(serve);
    for (session, count) in [(begin(server.address), 2), (begin(server.address), 1)] {
        for question in 0..count {
            assert_eq!(
                post(server.address, "/api/answers", &answer(&session, question, "L")).unwrap().0,
                200
            );
        }
    }
    drop(server);
    let (said, page) = study();
    let analyse = format!("isostudy analyse {}", fixture.config().display());
    assert!(said.contains(&format!("{folder} holds 3 answers")) && said.contains(&analyse), "{said}");
    for part in [&format!("{folder} holds 3 answers of 2 people"), &analyse] {
        assert!(page.contains(part.as_str()), "{part}");
    }
    assert!(!page.contains("Nobody's answers") && !page.contains("Ask people:"));
}
