//! What comes from strangers: programs that have to be allowed, that are ended with the command, and that show nothing but what they are.

use crate::command::{Folder, Run};
use crate::fixture::files;
use rustix::process::{Pid, Signal, kill_process};
use std::collections::BTreeSet;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// What hides its beginning from whoever reads it in a terminal: finding 1 of the review of 2026-11-23.
const FORGED: &str = r#"["sh", "-c", "touch ran #\r\u001b[2K  program: python3 ./example.py"]"#;

/// A new study whose first method is a program.
fn study(command: &str) -> Folder {
    let folder = Folder::new();
    folder.succeed(&["new", "my"]);
    let text = folder.read("my/study.toml");
    let recipe = text.lines().find(|line| line.starts_with("recipe = ")).expect("a method has a recipe");
    let program = format!("recipe = {{ kind = \"program\", command = {command}, time_limit_s = 600 }}");
    folder.write("my/study.toml", text.replacen(recipe, &program, 1));
    folder
}

const EXTRACT: [&str; 6] = ["extract", "my/study.toml", "--out", "out", "--only", "torus_bi"];

/// The configuration that the program makes.
fn extract(folder: &Folder, more: &[&str]) -> Run {
    let id = first(folder);
    let mut words = EXTRACT;
    words[5] = &id;
    folder.run(&[&words[..], more].concat())
}

fn first(folder: &Folder) -> String {
    let valid = folder.succeed(&["validate", "my/study.toml"]).stdout;
    valid.split_whitespace().next().expect("a configuration").to_owned()
}

fn assert_shows_nothing_forged(text: &str) {
    let forging = |c: char| (c.is_control() && c != '\n' && c != '\t') || "\u{202e}\u{2066}".contains(c);
    assert!(!text.contains(forging), "{text:?}");
}

#[test]
fn a_forged_command_shows_what_runs() {
    let folder = study(FORGED);
    let shown = r#""sh" "-c" "touch ran #\r\u{1b}[2K  program: python3 ./example.py""#;
    let refused = extract(&folder, &[]);
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    assert!(refused.stderr.contains(shown), "{}", refused.stderr);
    assert!(
        refused.stderr.trim_end().ends_with("--allow-programs"),
        "the command to type: {}",
        refused.stderr
    );
    assert_shows_nothing_forged(&refused.stderr);
    let ran = extract(&folder, &["--allow-programs"]);
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    assert!(ran.stderr.contains(shown), "{}", ran.stderr);
    assert_shows_nothing_forged(&ran.stderr);
}

/// The study that `isostudy new` makes, of coarse meshes and small animations.
fn new_study() -> Folder {
    let folder = Folder::new();
    folder.succeed(&["new", "my"]);
    let small = |line: &str| {
        let value = match line.split_once(" = ").map(|(key, _)| key) {
            Some("benchmark_spacing" | "stimulus_spacing") => "0.25",
            Some("width" | "height") => "64",
            Some("frames") => "8",
            Some("duration_s") => "0.64",
            _ => return format!("{line}\n"),
        };
        let (key, _) = line.split_once(" = ").unwrap();
        format!("{key} = {value}\n")
    };
    let text: String = folder.read("my/study.toml").lines().map(small).collect();
    folder.write("my/study.toml", text);
    folder
}

#[test]
fn names_cannot_forge_a_line_or_a_page() {
    let folder = new_study();
    let text = folder.read("my/study.toml");
    let (before, objects) = text.split_once("[[objects]]").expect("a study has objects");
    let name = objects.lines().find(|line| line.starts_with("name = ")).expect("an object has a name");
    let objects = objects.replacen(name, r#"name = "a\r\u001b[2Kb\u202ec\nd""#, 1);
    folder.write("my/study.toml", format!("{before}[[objects]]{objects}"));
    let valid = folder.succeed(&["validate", "my/study.toml"]);
    assert!(valid.stdout.contains("a\\u000d\\u001b[2Kb\\u202ec\\u000ad"), "{}", valid.stdout);
    assert_shows_nothing_forged(&valid.stdout);
    // And in whatever the study writes for people.
    folder.succeed(&["study", "my/study.toml", "--out", "out"]);
    let mut kinds = BTreeSet::new();
    for (path, bytes) in files(&folder.path("out")) {
        let kind = path.rsplit('.').next().unwrap().to_owned();
        let kind = TEXTS.into_iter().find(|of| **of == kind);
        // The page of the viewer has a library in it.
        let Some(kind) = kind.filter(|_| !path.ends_with("viewer.html")) else { continue };
        let text = String::from_utf8(bytes).unwrap_or_else(|_| panic!("{path} is no text"));
        let forging = |c: char| (c.is_control() && !"\n\t".contains(c)) || "\u{202e}\u{2066}".contains(c);
        let line = text.lines().find(|line| line.contains(forging));
        assert!(line.is_none(), "{path}: {line:?}");
        if text.contains("[2Kb") {
            kinds.insert(kind);
        }
    }
    assert_eq!(kinds, TEXTS.into(), "files of these kinds have the name");
}

/// Kinds of files that people read.
const TEXTS: [&str; 4] = ["csv", "html", "md", "tex"];

/// Runs a command in a terminal of its own, types an answer when it asks, and prints what it said.
const IN_A_TERMINAL: &str = r#"
import os, pty, sys
said, answered = b"", False
def read(terminal):
    global said, answered
    data = os.read(terminal, 1024)
    said += data
    if b"Type yes" in said and not answered:
        answered = True
        os.write(terminal, sys.argv[1].encode() + b"\n")
    return data
sys.exit(os.waitstatus_to_exitcode(pty.spawn(sys.argv[2:], read)))
"#;

#[test]
fn a_terminal_asks_and_only_yes_allows() {
    let folder = study(FORGED);
    let id = first(&folder);
    let asked = |answer: &str| {
        let command = folder.isostudy();
        let mut python = Command::new("python3");
        python.args(["-c", IN_A_TERMINAL, answer]).arg(command.get_program());
        python.args(&EXTRACT[..5]).arg(&id).current_dir(folder.root()).stdin(Stdio::null());
        for (name, value) in command.get_envs() {
            python.env(name, value.unwrap_or_default());
        }
        Run::of(&mut python)
    };
    let shown = r#""sh" "-c" "touch ran #\r\u{1b}[2K  program: python3 ./example.py""#;
    for answer in ["", "no", "y", "yes please"] {
        let ran = asked(answer);
        assert_eq!(ran.code, Some(2), "{answer}: {}", ran.stdout);
        assert!(ran.stdout.contains(shown) && ran.stdout.contains("Run them?"), "{answer}: {}", ran.stdout);
        assert!(ran.stdout.contains("its programs are not allowed to run"), "{answer}: {}", ran.stdout);
        assert!(!folder.path(".state").exists(), "{answer} allows nothing");
    }
    // The program is a bad one: it is run, fails, and is not asked about again.
    let ran = asked("yes");
    assert_eq!(ran.code, Some(1), "{}", ran.stdout);
    let again = asked("no");
    assert!(again.code == Some(1) && !again.stdout.contains("Run them?"), "{}", again.stdout);
}

/// A program in Python that answers well.
fn allowed() -> Folder {
    let folder = study(r#"["python3", "./example.py"]"#);
    let example = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scripts/methods/example.py");
    fs::copy(example, folder.path("my/example.py")).unwrap();
    folder
}

#[test]
fn what_is_allowed_is_remembered_until_a_file_changes() {
    let folder = allowed();
    let refused = extract(&folder, &[]);
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    let digest = |of: &str| {
        use sha2::Digest;
        let bytes = fs::read(folder.path(of)).unwrap();
        sha2::Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect::<String>()
    };
    assert!(refused.stderr.contains(&digest("my/example.py")), "{}", refused.stderr);
    assert!(!folder.path(".state").exists(), "nothing is allowed by being refused");
    let ran = extract(&folder, &["--allow-programs"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let again = extract(&folder, &["--force"]);
    assert_eq!(again.code, Some(0), "it is remembered: {}", again.stderr);
    let example = folder.read("my/example.py");
    folder.write("my/example.py", format!("{example}# changed\n"));
    let changed = extract(&folder, &[]);
    assert_eq!(changed.code, Some(2), "{}", changed.stderr);
    assert!(changed.stderr.contains("example.py, changed since you allowed it"), "{}", changed.stderr);
    let given = extract(&folder, &["--allow-programs"]);
    assert_eq!(given.code, Some(0), "the option is the consent: {}", given.stderr);
    assert!(given.stderr.contains("example.py, changed since you allowed it"), "{}", given.stderr);
    assert_eq!(extract(&folder, &[]).code, Some(0));
    // The same words elsewhere are another program: modules beside a script are not digested.
    fs::create_dir(folder.path("elsewhere")).unwrap();
    for entry in fs::read_dir(folder.path("my")).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.is_file() {
            fs::copy(&entry, folder.path("elsewhere").join(entry.file_name().unwrap())).unwrap();
        }
    }
    let cpu = folder.path("my/cpu");
    if cpu.is_dir() {
        std::os::unix::fs::symlink(cpu, folder.path("elsewhere/cpu")).unwrap();
    }
    let elsewhere = folder.run(&["extract", "elsewhere/study.toml", "--out", "other"]);
    assert_eq!(elsewhere.code, Some(2), "{}", elsewhere.stderr);
}

#[test]
fn a_sandbox_has_no_network_and_nothing_to_write_but_its_own_folder() {
    let folder = allowed();
    let example = folder.read("my/example.py");
    let look = "\
import os, socket\n\
def tries(what):\n    try:\n        what()\n        return 'can'\n    except OSError:\n        return 'cannot'\n\
open('own', 'w').write('x')\n\
outside = tries(lambda: open(os.environ['OUTSIDE'], 'w').write('x'))\n\
network = len(os.listdir('/sys/class/net')) if False else tries(lambda: socket.create_connection(('127.0.0.1', int(os.environ['PORT'])), 5))\n\
sys.stderr.write(f'outside {outside} network {network}\\n')\n\
sys.exit(9)\n";
    folder.write(
        "my/example.py",
        example.replacen(
            "import array, json, sys, time\n",
            &format!("import array, json, sys, time\n{look}"),
            1,
        ),
    );
    let server = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = server.local_addr().unwrap().port().to_string();
    let id = first(&folder);
    let run = |more: &[&str]| {
        let mut command = folder.isostudy();
        command
            .args(["extract", "my/study.toml", "--out", "out", "--only", &id, "--allow-programs"])
            .args(more);
        Run::of(command.env("OUTSIDE", folder.path("outside")).env("PORT", &port))
    };
    let free = run(&[]);
    assert!(free.stderr.contains("outside can network can"), "{}", free.stderr);
    let confined = run(&["--sandbox"]);
    if confined.stderr.contains("cannot be run in a sandbox") {
        assert_eq!(confined.code, Some(2), "it is not run without one");
        return eprintln!("SKIPPED: {}", confined.stderr);
    }
    assert!(confined.stderr.contains("outside cannot network cannot"), "{}", confined.stderr);
}

#[test]
fn a_sandbox_that_is_not_there_is_told_of() {
    let folder = allowed();
    let id = first(&folder);
    let mut command = folder.isostudy();
    command.args([
        "extract",
        "my/study.toml",
        "--out",
        "out",
        "--only",
        &id,
        "--allow-programs",
        "--sandbox",
    ]);
    // Python is found, and bubblewrap is not.
    let python = Command::new("sh").args(["-c", "command -v python3"]).output().unwrap();
    let python = String::from_utf8(python.stdout).unwrap();
    fs::create_dir(folder.path("bin")).unwrap();
    std::os::unix::fs::symlink(python.trim(), folder.path("bin/python3")).unwrap();
    let refused = Run::of(command.env("PATH", folder.path("bin")));
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    assert!(refused.stderr.contains("bubblewrap is not installed"), "{}", refused.stderr);
}

/// The command with a program that says its number and hangs.
fn hanging(folder: &Folder) -> (Child, u32) {
    let id = first(folder);
    let temporary = folder.path("tmp");
    fs::create_dir_all(&temporary).unwrap();
    let mut command = folder.isostudy();
    command.args(["extract", "my/study.toml", "--out", "out", "--only", &id, "--allow-programs"]);
    command.env("TMPDIR", &temporary).env("NUMBER", folder.path("number"));
    let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    (child, number_in(&folder.path("number")))
}

/// The number in a file, as soon as it is there.
fn number_in(path: &Path) -> u32 {
    let begin = Instant::now();
    loop {
        let number = fs::read_to_string(path).unwrap_or_default();
        if let Some(number) = number.strip_suffix('\n') {
            return number.parse().unwrap();
        }
        assert!(begin.elapsed() < Duration::from_secs(60), "it starts nothing");
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn is_alive(process: u32) -> bool {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    stat.rsplit_once(')').is_some_and(|(_, rest)| !rest.trim_start().starts_with(['Z', 'X']))
}

fn assert_ends(process: u32) {
    let begin = Instant::now();
    while is_alive(process) {
        assert!(begin.elapsed() < Duration::from_secs(20), "process {process} is still there");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn left(folder: &Folder) -> usize {
    fs::read_dir(folder.path("tmp")).unwrap().count()
}

#[test]
fn a_stuck_program_ends_with_the_command_however_that_ends() {
    let folder = study(
        r#"["sh", "-c", "trap '' TERM INT; echo $$ > $NUMBER.part; mv $NUMBER.part $NUMBER; exec sleep 1000"]"#,
    );
    for (signal, removes) in
        [(Signal::INT, true), (Signal::TERM, true), (Signal::KILL, false), (Signal::INT, true)]
    {
        let _ = fs::remove_file(folder.path("number"));
        let (mut command, program) = hanging(&folder);
        assert!(is_alive(program));
        kill_process(Pid::from_child(&command), signal).unwrap();
        let status = command.wait().unwrap();
        assert_eq!(std::os::unix::process::ExitStatusExt::signal(&status), Some(signal.as_raw()), "{status}");
        assert_ends(program);
        // What a kill leaves, the next one removes.
        assert_eq!(left(&folder), usize::from(!removes), "{signal:?}");
    }
}

#[test]
fn what_a_program_started_in_a_session_of_its_own_ends_with_the_command() {
    let folder = study(
        r#"["sh", "-c", "setsid sh -c 'echo $$ > $NUMBER.part; mv $NUMBER.part $NUMBER; exec sleep 1000' & exec sleep 1000"]"#,
    );
    let (mut command, grandchild) = hanging(&folder);
    kill_process(Pid::from_child(&command), Signal::TERM).unwrap();
    command.wait().unwrap();
    assert_ends(grandchild);
    assert_eq!(left(&folder), 0);
}

#[test]
fn binaries_that_keep_to_no_limit_end_a_comparison_by_name() {
    let folder = new_study();
    let this = env!("CARGO_BIN_EXE_isostudy");
    for (name, script, words) in [
        ("hangs", "sleep 1000", "took longer than 1 s to answer"),
        ("once", "echo '{\"ready\":null}'; sleep 1000", "took longer than 1 s to answer"),
        ("floods", "exec cat /dev/zero", "a line of more than"),
        ("lines", "exec yes", "said `y`"),
        ("errors", "yes >&2", "took longer than 1 s to answer"),
    ] {
        folder.write(name, format!("#!/bin/sh\n{script}\n"));
        fs::set_permissions(folder.path(name), fs::Permissions::from_mode(0o755)).unwrap();
        let words_of = [
            "bench",
            "ab",
            name,
            this,
            "my/study.toml",
            "--out",
            "out",
            "--time-limit",
            "1",
            "--seconds",
            "1",
        ];
        let ran = folder.run(&words_of);
        assert_eq!(ran.code, Some(2), "{name}: {}", ran.stderr);
        assert!(ran.stderr.contains(words), "{name}: {}", ran.stderr);
        assert!(ran.stderr.len() < 100_000, "{name}: {}", ran.stderr.len());
    }
}

#[test]
fn what_failed_is_not_up_to_date_and_what_is_gone_has_a_name() {
    let folder = study(r#"["sh", "-c", "exit 3"]"#);
    for _ in 0..2 {
        let ran = extract(&folder, &["--allow-programs"]);
        assert_eq!(ran.code, Some(1), "{}", ran.stderr);
        let meshes = ran.stderr.lines().find(|line| line.starts_with("meshes ")).expect("a line of meshes");
        assert!(meshes.contains("failed") && !meshes.contains("up to date"), "{meshes}");
    }
}
