//! Every path that the command takes, as clap's own model has them, with what is no file in its place; and every path of a study.
//!
//! The tests start themselves as the command. A new path argument is tried without a change here; one of a file that is written belongs
//! into [`WRITTEN`], and one that clap refuses alone into [`BESIDE`].

use crate::{Cli, help, run, with_causes};
use clap::{Arg, ArgAction, Command, CommandFactory, FromArgMatches, ValueHint};
use isostudy_foreign::{Child, End, Limits, Stopped};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;

/// Holds the words of a command that this process is to be, one per line.
const WORDS: &str = "ISOSTUDY_TEST_WORDS";
/// The longest that a command may take on a machine with other work.
const TIME_LIMIT: Duration = Duration::from_secs(60);
/// What it may take of memory, with all that a test binary has.
const MEMORY_LIMIT: u64 = 300 << 20;

/// Arguments of files and folders that are written, and the command that has them; none for all.
const WRITTEN: [(&str, &str); 7] = [
    ("", "out"),
    ("", "picture"),
    ("", "figure"),
    ("new", "folder"),
    ("serve", "answers"),
    ("collect", "about"),
    ("collect", "cameras"),
];
/// What else has to be said for an argument to be taken.
const BESIDE: [(&str, &str, &[&str]); 23] = [
    ("analyse", "responses", &["my/study.toml"]),
    ("analyse", "mapping", &["answers.csv"]),
    ("analyse", "merge", &["--self-test"]),
    ("distance", "a", &["ball.obj"]),
    ("distance", "study", &["--object", "torus"]),
    ("turntable", "study", &["--object", "torus", "--colour", "error", "-o", "x.gif"]),
    ("extract", "volume", &["--isovalue", "0", "-o", "x.ply"]),
    ("extract", "grid", &["--isovalue", "0", "-o", "x.ply"]),
    ("extract", "frames", &["--isovalue", "0", "--time", "0", "-o", "x.ply"]),
    ("extract", "labels", &["-o", "x.ply"]),
    ("extract", "mesh", &["-o", "x.ply"]),
    ("extract", "points", &["-o", "x.ply"]),
    ("extract", "soup", &["-o", "x.ply"]),
    ("extract", "study", &["-o", "x"]),
    ("table", "volume", &["--groups", "--isovalue", "0"]),
    ("table", "mesh", &["--groups"]),
    ("table", "points", &["--groups"]),
    ("table", "soup", &["--groups"]),
    ("turntable", "volume", &["--colour", "error", "--isovalue", "0", "-o", "x.gif"]),
    ("turntable", "mesh", &["--colour", "error", "-o", "x.gif"]),
    ("turntable", "points", &["--colour", "error", "-o", "x.gif"]),
    ("turntable", "soup", &["--colour", "error", "-o", "x.gif"]),
    ("distance", "volume", &["--isovalue", "0"]),
];

/// A folder with a study that is one, and with what is no file.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let made = as_command(folder.path(), &["new".into(), "my".into()]);
    assert_eq!(made.0, Ok(End::Code(0)), "{}", made.1);
    let ball = "v 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 0\nf 1 2 3\nf 2 1 4\nf 3 2 4\nf 1 3 4\n";
    std::fs::write(folder.path().join("ball.obj"), ball).unwrap();
    std::fs::write(folder.path().join("answers.csv"), "a,b\n1,2\n").unwrap();
    let volume = "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\nencoding: text\n\n0 0 0 0 2 2 2 2\n";
    std::fs::write(folder.path().join("half.nrrd"), volume).unwrap();
    folder
}

/// What is put in a file's place, under a name with an ending.
fn put(kind: &str, path: &Path) {
    use rustix::fs::{CWD, FileType, Mode, mknodat};
    match kind {
        "device" => std::os::unix::fs::symlink("/dev/null", path).unwrap(),
        "endless" => std::os::unix::fs::symlink("/dev/zero", path).unwrap(),
        "folder" => std::fs::create_dir(path).unwrap(),
        "pipe" => mknodat(CWD, path, FileType::Fifo, Mode::RWXU, 0).unwrap(),
        // Without a byte on the disk, and larger than any memory.
        "huge" => std::fs::File::create(path).unwrap().set_len(1 << 40).unwrap(),
        _ => {}
    }
}

const KINDS: [&str; 6] = ["device", "endless", "folder", "pipe", "huge", "missing"];

/// The ending of a file that an argument could name, so that no reader refuses the name.
fn ending(id: &str) -> &'static str {
    match id {
        "volume" | "labels" => "nrrd",
        "grid" => "vtu",
        "mesh" | "a" | "b" | "points" | "soup" => "ply",
        "tables" | "spacings" | "run" | "merge" => "json",
        "responses" | "downloads" | "table" | "spread_of" => "csv",
        _ => "toml",
    }
}

/// What a required argument may be when another one is tried.
fn good(folder: &Path, argument: &Arg) -> Vec<String> {
    let known = argument.get_value_parser().possible_values().and_then(|mut all| all.next());
    if let Some(known) = known {
        return vec![known.get_name().to_owned()];
    }
    let this = std::env::current_exe().unwrap().display().to_string();
    vec![match argument.get_id().as_str() {
        "study" => "my/study.toml".into(),
        "old" | "new" => this,
        "out" => "written".into(),
        "a" | "b" | "mesh" | "input" => "ball.obj".into(),
        "volume" => "half.nrrd".into(),
        "tables" => "mc".into(),
        "id" => "torus_bi".into(),
        "threads" | "seconds" | "isovalue" => "1".into(),
        "sha256" => crate::store::sha256(&std::fs::read(folder.join("my/study.toml")).unwrap()),
        _ => "my/study.toml".into(),
    }]
}

/// Every command with its way there, that has none below it or can do without.
fn commands(of: &Command, way: &[String], all: &mut Vec<(Vec<String>, Command)>) {
    for own in of.get_subcommands().filter(|own| own.get_name() != "help") {
        let way = [way, &[own.get_name().to_owned()]].concat();
        commands(own, &way, all);
        if !own.is_subcommand_required_set() {
            all.push((way, own.clone()));
        }
    }
}

fn is_path(argument: &Arg) -> bool {
    !matches!(
        argument.get_value_hint(),
        ValueHint::Unknown | ValueHint::Other | ValueHint::Url | ValueHint::Hostname
    ) && !matches!(argument.get_action(), ArgAction::SetTrue)
}

/// An argument with its value, as it is typed.
fn typed(argument: &Arg, values: Vec<String>) -> Vec<String> {
    let option = argument.get_long().map(|long| format!("--{long}"));
    option.into_iter().chain(values).collect()
}

/// Runs words as the command; how it ended, and what it said.
fn as_command(folder: &Path, words: &[String]) -> (Result<End, Stopped>, String) {
    let mut command = std::process::Command::new(std::env::current_exe().unwrap());
    command.args(["--exact", "paths::this_process_as_the_command", "--nocapture"]);
    command.current_dir(folder).env(WORDS, words.join("\n"));
    let limits = Limits { line_bytes: 1 << 20, memory_bytes: Some(MEMORY_LIMIT) };
    let mut child = Child::start(&mut command, limits, None).unwrap();
    let end = child.wait(TIME_LIMIT);
    child.kill();
    (end, child.last_words())
}

#[test]
fn this_process_as_the_command() {
    let Ok(words) = std::env::var(WORDS) else { return };
    let words = std::iter::once("isostudy").chain(words.lines());
    let asked = help::grouped(Cli::command()).get_matches_from(words);
    let code = match run(&Cli::from_arg_matches(&asked).unwrap().command) {
        Ok(outcome) => i32::from(outcome.status()),
        Err(error) => {
            tell!("isostudy: {}", with_causes(&error));
            i32::from(crate::INPUT_ERROR)
        }
    };
    std::process::exit(code);
}

#[test]
fn no_path_argument_takes_what_is_no_file() {
    let mut all = Vec::new();
    let model = help::grouped(Cli::command());
    commands(&model, &[], &mut all);
    let folder = folder();
    let (mut tried, mut wrong) = (0, Vec::new());
    for (way, command) in &all {
        let given: Vec<&Arg> = command.get_arguments().filter(|own| is_path(own)).collect();
        let is_written = |own: &Arg| {
            WRITTEN.iter().any(|(of, id)| own.get_id() == *id && (of.is_empty() || way[0] == *of))
        };
        for argument in given.iter().filter(|own| !is_written(own)) {
            for kind in KINDS {
                let id = argument.get_id().as_str();
                // A folder of results is asked for what is in it.
                let name = format!("{}-{id}-{kind}.{}", way.join("-"), ending(id));
                put(kind, &folder.path().join(&name));
                let mut words = way.clone();
                let others = command
                    .get_arguments()
                    .filter(|own| own.is_required_set() && own.get_id() != argument.get_id());
                for other in others {
                    words.extend(typed(other, good(folder.path(), other)));
                }
                words.extend(typed(argument, vec![name.clone()]));
                // Positional arguments come in their order.
                if argument.get_long().is_none() {
                    words = way.clone();
                    let mut own: Vec<&Arg> = command
                        .get_arguments()
                        .filter(|own| own.is_required_set() || own.get_id() == argument.get_id())
                        .collect();
                    own.sort_by_key(|own| own.get_index().unwrap_or(usize::MAX));
                    let before = own.iter().flat_map(|own| {
                        typed(
                            own,
                            if own.get_id() == argument.get_id() {
                                vec![name.clone()]
                            } else {
                                good(folder.path(), own)
                            },
                        )
                    });
                    words.extend(before);
                }
                let beside = BESIDE.iter().find(|(of, argument, _)| way[0] == *of && id == *argument);
                words.extend(
                    beside.into_iter().flat_map(|(_, _, words)| words.iter().map(|word| (*word).to_owned())),
                );
                let (end, said) = as_command(folder.path(), &words);
                tried += 1;
                // A folder of results may be empty, or not made yet.
                let may_be = id == "results" && matches!(kind, "folder" | "missing");
                if !may_be && (end != Ok(End::Code(2)) || !said.contains(&name)) {
                    wrong.push(format!("{}: {end:?}: {said}", words.join(" ")));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "of {tried}, {}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(tried > 150, "{tried}");
}

/// What a study names: the key, and what stands in the study for it.
fn studies(name: &str, folder: &Path) -> Vec<(&'static str, String)> {
    let study = std::fs::read_to_string(folder.join("my/study.toml")).unwrap();
    let field =
        study.lines().find(|line| line.starts_with("field = ")).expect("an object has a field").to_owned();
    let recipe =
        study.lines().find(|line| line.starts_with("recipe = ")).expect("a method has a recipe").to_owned();
    let objects: Vec<&str> = study
        .split("[[objects]]")
        .skip(1)
        .map(|object| {
            object
                .lines()
                .find_map(|line| line.strip_prefix("id = "))
                .expect("an object has an id")
                .trim_matches('"')
        })
        .collect();
    let files: Vec<String> = objects.iter().map(|id| format!("{id} = \"../{name}.ply\"")).collect();
    let with = |from: &str, to: String| study.replacen(from, &to, 1);
    let target = study.lines().find(|line| line.starts_with("target = ")).map(str::to_owned);
    let mut all = vec![
        ("a volume", with(&field, format!("field = {{ kind = \"volume\", file = \"../{name}.nrrd\" }}"))),
        ("a grid", with(&field, format!("field = {{ kind = \"grid\", file = \"../{name}.vtu\" }}"))),
        ("a mesh", with(&field, format!("field = {{ kind = \"mesh\", file = \"../{name}.ply\" }}"))),
        (
            "meshes",
            with(&recipe, format!("recipe = {{ kind = \"meshes\", files = {{ {} }} }}", files.join(", "))),
        ),
        (
            "a program",
            with(&recipe, format!("recipe = {{ kind = \"program\", command = [\"../{name}.sh\"] }}")),
        ),
        (
            "a program's file",
            with(&recipe, format!("recipe = {{ kind = \"program\", command = [\"sh\", \"../{name}.sh\"] }}")),
        ),
        ("answers", format!("{study}\n[responses]\nfile = \"../{name}.csv\"\n")),
        ("published times", format!("{study}\n[published]\nsource = \"x\"\nbenchmark = \"../{name}.csv\"\n")),
    ];
    all.extend(target.map(|target| ("a machine", with(&target, format!("target = \"../{name}.toml\"")))));
    all
}

#[test]
fn no_path_of_a_study_takes_what_is_no_file() {
    let folder = folder();
    let mut wrong = Vec::new();
    for kind in KINDS {
        let name = format!("named-{kind}");
        for ending in ["nrrd", "vtu", "ply", "csv", "toml", "sh"] {
            put(kind, &folder.path().join(format!("{name}.{ending}")));
        }
        for (key, study) in studies(&name, folder.path()) {
            // A program may read what it likes from what it is given; only the study's own files are read here.
            if key == "a program's file" && kind != "missing" {
                continue;
            }
            std::fs::write(folder.path().join("my/bad.toml"), study).unwrap();
            let (end, said) = as_command(
                folder.path(),
                &["validate".into(), PathBuf::from("my/bad.toml").display().to_string()],
            );
            if end != Ok(End::Code(2)) || !said.contains(&name) {
                wrong.push(format!("{key}, {kind}: {end:?}: {said}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
