//! A server as its clients and its folder meet it: in a process of its own, over sockets, with files that change under it.
//!
//! Linux alone: what a process has open is looked up in `/proc`, and other addresses of the machine are called from.

#![cfg(target_os = "linux")]

use crate::http::{get, post, raw};
use isostudy_design::config::Way;
use isostudy_design::forms::{FormEntry, FormFile, KeyEntry, Role};
use isostudy_serve::journal::Loss;
use isostudy_serve::page::{Media, MediaFormat};
use isostudy_serve::{Limits, Settings};
use rusqlite::Connection;
use serde_json::{Value, json};
use std::fs::{self, File};
use std::io::{Read, Write};
use std::net::{IpAddr, SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const TOKEN: &str = "a-token-for-this-test";
const QUESTIONS: usize = 3;
/// More than a socket's buffers hold.
const STIMULUS: usize = 8 << 20;
/// How long a client of these servers may take nothing.
const STALLED: Duration = Duration::from_secs(1);
const SESSIONS: u32 = 40;

fn settings(folder: &Path, loss: Loss) -> Settings {
    let place = |order| KeyEntry {
        form: 1,
        order,
        stimulus: format!("q{order}"),
        role: Role::Comparison,
        question: format!("Q{order}"),
        object: "sphere".into(),
        group: "g".into(),
        left: "a".into(),
        right: "b".into(),
        shown: String::new(),
    };
    let key: Vec<KeyEntry> = (2..2 + QUESTIONS).map(place).collect();
    let questions = key.iter().map(|entry| entry.stimulus.clone()).collect();
    Settings {
        file: FormFile {
            schema: 1,
            study: "trial".into(),
            title: "Trial".into(),
            prompt: "Which?".into(),
            way: Way::Pairs,
            choices: vec!["Left".into(), "None".into(), "Right".into()],
            choices_stacked: None,
            steps: 7,
            ends: None,
            none: false,
            min_surface_px: None,
            languages: vec!["en".into()],
            texts: std::collections::BTreeMap::new(),
            consent: "Yes".into(),
            instructions: "Look".into(),
            about: Vec::new(),
            contact: None,
            ethics: None,
            least_age: None,
            retention_days: None,
            go_back: false,
            stimulus: Default::default(),
            loop_ms: 100,
            page_scale: 1,
            forms: vec![FormEntry { form: 1, training: vec!["tani".into()], questions }],
        },
        key,
        digest: "d".into(),
        stimuli: folder.join("stimuli"),
        media: Media { kinds: vec![(MediaFormat::Gif, 1, 10)], surface: [8, 8], shading: None },
        library: Vec::new(),
        answers: folder.join("answers"),
        address: SocketAddr::from(([127, 0, 0, 1], 0)),
        admin_token: TOKEN.into(),
        completions: Default::default(),
        panel: Default::default(),
        quotas: Default::default(),
        chooser: None,
        attention: Vec::new(),
        rule: None,
        public_url: Some("https://study.example.org".parse().unwrap()),
        limits: Limits { stalled: STALLED, sessions_per_address: SESSIONS },
        loss,
    }
}

/// This test is what the other tests start as a process; by itself it does nothing.
#[test]
fn child() {
    let Ok(folder) = std::env::var("SERVE_FOLDER") else { return };
    let folder = PathBuf::from(folder);
    let told = folder.join("address");
    let ready = |address: SocketAddr, held| {
        fs::write(folder.join("new"), format!("{address} {held}")).unwrap();
        fs::rename(folder.join("new"), &told).unwrap();
    };
    if let Err(error) = isostudy_serve::serve(settings(&folder, Loss::Refuse), ready) {
        eprintln!("{error}");
        std::process::exit(3);
    }
    std::process::exit(0);
}

struct Server {
    folder: TempDir,
    child: Child,
    address: SocketAddr,
}

/// Starts a server on a folder, and waits until it listens.
fn spawn(folder: &Path, errors: impl FnOnce(&Path) -> Stdio) -> (Child, SocketAddr) {
    let child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "server::child", "--nocapture"])
        .env("SERVE_FOLDER", folder)
        .stdout(Stdio::null())
        .stderr(errors(folder))
        .spawn()
        .unwrap();
    let told = folder.join("address");
    let text = (0..600).find_map(|_| {
        std::thread::sleep(Duration::from_millis(50));
        fs::read_to_string(&told).ok()
    });
    let text = text.expect("it listens");
    (child, text.split(' ').next().unwrap().parse().unwrap())
}

impl Server {
    fn start(errors: impl FnOnce(&Path) -> Stdio) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("stimuli")).unwrap();
        for name in ["tani", "q2", "q3", "q4"] {
            fs::write(folder.path().join(format!("stimuli/{name}.gif")), vec![7; STIMULUS]).unwrap();
        }
        let (child, address) = spawn(folder.path(), errors);
        Self { folder, child, address }
    }

    fn answers(&self) -> PathBuf {
        self.folder.path().join("answers")
    }

    fn begin(&self) -> Value {
        let (status, body) = post(self.address, "/api/sessions", "{}").unwrap();
        assert_eq!(status, 200, "{body}");
        serde_json::from_str(&body).unwrap()
    }

    /// Status of the answer to a question.
    fn answer(&self, session: &Value, question: usize) -> u16 {
        let answer = json!({
            "token": session["token"], "order": 2 + question, "stimulus": session["form"]["questions"][question],
            "choice": "L", "rt_ms": 1500,
        });
        post(self.address, "/api/answers", &answer.to_string()).unwrap().0
    }

    fn stop(&self) {
        use rustix::process::{Pid, Signal, kill_process};
        kill_process(Pid::from_child(&self.child), Signal::TERM).unwrap();
    }

    /// The exit code, which has to come.
    fn ends(&mut self) -> Option<i32> {
        let ended = (0..600).find_map(|_| {
            std::thread::sleep(Duration::from_millis(50));
            self.child.try_wait().unwrap()
        });
        ended.expect("it ends").code()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

fn log(folder: &Path) -> Stdio {
    File::create(folder.join("log")).unwrap().into()
}

/// Waits until something is so.
fn until(what: &str, mut so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !so() {
        assert!(start.elapsed() < Duration::from_secs(30), "{what}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// Answers that cannot be saved are told on a log that cannot be written either: a full disk holds both.
#[test]
fn a_server_without_a_log_saves_again_once_it_can() {
    let pipe_without_reader = |_: &Path| {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        writer.into()
    };
    let full = |_: &Path| File::options().write(true).open("/dev/full").unwrap().into();
    let logs: [fn(&Path) -> Stdio; 2] = [pipe_without_reader, full];
    for log in logs {
        let server = Server::start(log);
        let session = server.begin();
        assert_eq!(server.answer(&session, 0), 200);
        let other = Connection::open(server.answers().join("answers.sqlite")).unwrap();
        other.execute_batch("BEGIN IMMEDIATE").unwrap();
        assert_eq!(server.answer(&session, 1), 503);
        assert_eq!(
            get(server.address, "/api/admin/answers.csv", TOKEN).unwrap().0,
            200,
            "nothing is saved for it"
        );
        other.execute_batch("ROLLBACK").unwrap();
        assert_eq!(server.answer(&session, 1), 200);
        let kept = get(server.address, "/api/admin/answers.csv", TOKEN).unwrap();
        assert_eq!((kept.0, kept.1.lines().count()), (200, 3));
    }
}

#[test]
fn a_server_that_cannot_go_on_ends_and_says_so() {
    let mut server = Server::start(log);
    let session = server.begin();
    assert_eq!(server.answer(&session, 0), 200);
    let other = Connection::open(server.answers().join("answers.sqlite")).unwrap();
    other.execute_batch("DROP TABLE answers").unwrap();
    assert_eq!(server.answer(&session, 1), 503);
    assert_eq!(server.ends(), Some(3));
}

#[test]
fn a_folder_removed_under_a_server_is_noticed() {
    let mut server = Server::start(log);
    let session = server.begin();
    assert_eq!(server.answer(&session, 0), 200);
    fs::remove_dir_all(server.answers()).unwrap();
    assert_eq!(server.answer(&session, 1), 503);
    let (status, said) = post(server.address, "/api/sessions", "{}").unwrap();
    assert!(status == 503 && said.contains("folder of answers"), "{status} {said}");
    // The last way to what was answered.
    for path in ["/api/admin/answers.csv", "/api/admin/identities.csv", "/api/admin/summary"] {
        assert_eq!(get(server.address, path, TOKEN).unwrap().0, 200, "{path}");
    }
    let kept = get(server.address, "/api/admin/answers.csv", TOKEN).unwrap().1;
    assert_eq!(kept.lines().count(), 2, "{kept}");
    server.stop();
    assert_eq!(server.ends(), Some(3));
    let log = fs::read_to_string(server.folder.path().join("log")).unwrap();
    assert!(log.contains("removed or replaced while the server ran"), "{log}");
}

/// Nobody asks: it is told all the same.
#[test]
fn a_folder_removed_under_an_idle_server_is_told() {
    let server = Server::start(log);
    fs::remove_dir_all(server.answers()).unwrap();
    until("it is told", || {
        fs::read_to_string(server.folder.path().join("log")).unwrap().contains("no answer is taken")
    });
}

/// Nobody can tell whether all are there.
#[test]
fn answers_without_a_count_are_told_at_the_start() {
    let mut server = Server::start(log);
    let session = server.begin();
    assert_eq!(server.answer(&session, 0), 200);
    server.stop();
    assert_eq!(server.ends(), Some(0));
    let folder = server.folder.path();
    fs::remove_file(folder.join("answers/count")).unwrap();
    fs::remove_file(folder.join("address")).unwrap();
    let (child, address) = spawn(folder, log);
    server.child = child;
    until("it is told", || {
        let log = fs::read_to_string(server.folder.path().join("log")).unwrap();
        log.contains("warning") && log.contains("holds 1 answer of 1 participant, but")
    });
    // Taken away once more, under the server.
    server.address = address;
    fs::remove_file(server.answers().join("count")).unwrap();
    assert_eq!(server.answer(&session, 1), 503);
}

fn ask_for_stimulus(address: SocketAddr) -> TcpStream {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    stream
        .write_all(b"GET /stimuli/q2.gif HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n")
        .unwrap();
    stream
}

/// Who reads slowly gets everything; who does not read at all is cut off, and holds no file meanwhile but one.
#[test]
fn who_does_not_read_is_cut_off() {
    let server = Server::start(log);
    let mut stuck: Vec<TcpStream> = (0..200).map(|_| ask_for_stimulus(server.address)).collect();
    let mut slow = ask_for_stimulus(server.address);
    let files = || fs::read_dir(format!("/proc/{}/fd", server.child.id())).unwrap().count();
    until("they are served", || files() > 200);
    let mut part = vec![0; STIMULUS / 8];
    let mut read = 0;
    for _ in 0..8 {
        std::thread::sleep(STALLED / 2);
        read += slow.read(&mut part).unwrap();
    }
    let mut rest = Vec::new();
    read += slow.read_to_end(&mut rest).unwrap();
    assert!(read > STIMULUS, "{read}");
    until("they are cut off", || files() < 100);
    let mut found = Vec::new();
    for stream in &mut stuck {
        found.clear();
        // Cut off at the end of what was on its way, or reset.
        drop(stream.read_to_end(&mut found));
        assert!(found.len() < STIMULUS, "{}", found.len());
    }
}

/// A socket that calls from another of this machine's addresses.
fn begin_from(address: SocketAddr, from: [u8; 4], forwarded: &str) -> (u16, String) {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    runtime.block_on(async {
        use tokio::io::{AsyncReadExt, AsyncWriteExt};
        let socket = tokio::net::TcpSocket::new_v4().unwrap();
        socket.bind(SocketAddr::new(IpAddr::from(from), 0)).unwrap();
        let mut stream = socket.connect(address).await.unwrap();
        let head = "POST /api/sessions HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\n";
        let rest = format!("{head}{forwarded}content-length: 2\r\nconnection: close\r\n\r\n{{}}");
        stream.write_all(rest.as_bytes()).await.unwrap();
        let mut reply = String::new();
        stream.read_to_string(&mut reply).await.unwrap();
        (reply[9..12].parse().unwrap(), reply)
    })
}

#[test]
fn one_address_cannot_take_all_the_forms() {
    let server = Server::start(log);
    let early = server.begin();
    let mut replies = (0..100).map(|_| post(server.address, "/api/sessions", "{}").unwrap());
    let (status, said) = replies.find(|reply| reply.0 != 200).expect("there is a limit");
    assert!(status == 429 && said.contains("try again in "), "{status} {said}");
    let (status, reply) = begin_from(server.address, [127, 0, 0, 1], "");
    assert!(status == 429 && reply.to_ascii_lowercase().contains("\r\nretry-after: "), "{reply}");
    // Others begin, whether they come themselves or through a proxy; and who had begun goes on.
    assert_eq!(begin_from(server.address, [127, 0, 0, 2], "").0, 200);
    assert_eq!(begin_from(server.address, [127, 0, 0, 1], "x-forwarded-for: 203.0.113.7\r\n").0, 200);
    assert!((0..QUESTIONS).all(|question| server.answer(&early, question) == 200));
}

#[test]
fn only_its_own_names_are_answered() {
    let server = Server::start(log);
    let ask = |host: &str| {
        let head = format!("GET / HTTP/1.1\r\n{host}connection: close\r\n\r\n");
        raw(server.address, head.as_bytes()).unwrap().0
    };
    for own in ["localhost", "127.0.0.1:8080", "study.example.org"] {
        assert_eq!(ask(&format!("host: {own}\r\n")), 200, "{own}");
    }
    assert_eq!(ask("host: evil.example\r\n"), 421);
    assert_ne!(ask(""), 200);
    let known = raw(server.address, b"POST /api/sessions HTTP/1.1\r\nhost: evil.example\r\ncontent-type: application/json\r\ncontent-length: 2\r\nconnection: close\r\n\r\n{}");
    assert_eq!(known.unwrap().0, 421);
}

/// Of many wrong ones at once most are refused, and a right one of the same address is accepted all the while; none is written to the
/// log.
#[test]
fn tokens_cannot_be_tried_without_end() {
    let server = Server::start(log);
    let wrong = "a-wrong-token-1234";
    let ask = |token: &str| get(server.address, "/api/admin/summary", token).unwrap().0;
    let statuses: Vec<u16> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..60).map(|_| scope.spawn(|| ask(wrong))).collect();
        assert!((0..30).all(|_| ask(TOKEN) == 200), "the right one waits for no wrong ones");
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    let count = |status| statuses.iter().filter(|found| **found == status).count();
    assert!(count(401) >= 10 && count(429) >= 10 && count(401) + count(429) == 60, "{statuses:?}");
    until("it is told", || {
        let log = fs::read_to_string(server.folder.path().join("log")).unwrap();
        assert!(!log.contains(wrong) && !log.contains(TOKEN), "{log}");
        // The first, and then at 2, 4, 8 and so on.
        assert!(log.lines().filter(|line| line.contains("wrong token")).count() <= 7, "{log}");
        log.contains("(1 since the start)") && log.contains("(8 since the start)")
    });
}
