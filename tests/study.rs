//! The whole chain as a user runs it: the `isostudy` command on a small study with real answers.

mod answers;
mod fixture;
mod page;

use fixture::{Fixture, Run, files, without_measured_times};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

#[test]
fn a_study_makes_everything_once_and_then_nothing() {
    let fixture = Fixture::new();
    assert!(fixture.succeed("study", &[]).stdout.ends_with("index.html\n"));
    let made = files(fixture.out());

    let count = |folder: &str, extension: &str| {
        let under = |path: &&String| path.starts_with(folder) && path.ends_with(extension);
        made.keys().filter(under).count()
    };
    assert_eq!(count("meshes/benchmark/", ".ply"), 18);
    assert_eq!(count("meshes/stimulus/", ".ply"), 18);
    assert_eq!(count("meshes/indexed/", ".json"), 18);
    assert_eq!(count("stimuli/turntables/", ".gif"), 18);
    assert_eq!(count("stimuli/pairs/", ".gif"), 27);
    for name in ["benchmark", "preference_groups", "preference_overall", "questionnaire", "answers"] {
        for extension in ["csv", "md", "tex"] {
            assert!(made.contains_key(&format!("tables/{name}.{extension}")), "{name}.{extension}");
        }
    }
    assert_eq!(count("figures/", ".svg"), count("figures/", ".png"));
    assert!(count("figures/", ".svg") >= 9);

    let again = fixture.succeed("study", &[]);
    assert!(!again.stderr.contains(" made, "), "{}", again.stderr);
    assert_eq!(files(fixture.out()), made);
}

/// One file, no request, headings in order, everything labelled, and text that stands out from what is behind it.
#[test]
fn the_report_can_be_read_alone() {
    let fixture = Fixture::new();
    fixture.succeed("study", &[]);
    let made = files(fixture.out());
    let page = String::from_utf8(made["report.html"].clone()).unwrap();
    assert_eq!(page::unclosed(&page), Vec::<String>::new());
    for forbidden in ["src=", "<link", "@import", "url(", "<script", "<img"] {
        assert!(!page.contains(forbidden), "{forbidden}");
    }
    // SVG's name is no request.
    let addresses = page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    assert!(!addresses.contains("http://") && !addresses.contains("https://"));
    let headings: Vec<&str> = page.match_indices("<h").map(|(i, _)| &page[i..i + 3]).collect();
    let headings: Vec<&&str> = headings.iter().filter(|h| h.as_bytes()[2].is_ascii_digit()).collect();
    assert!(
        *headings[0] == "<h1" && headings[1..].iter().all(|h| **h == "<h2") && headings.len() > 8,
        "{headings:?}"
    );
    let figures = page.matches("<svg").count();
    assert!(figures >= 13, "{figures}");
    assert_eq!(page.matches("role=\"img\" aria-label=\"").count(), figures);
    for target in page.split("href=\"#").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        assert!(page.contains(&format!("id=\"{target}\"")), "{target}");
    }
    for link in page.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        assert!(link.starts_with('#') || made.contains_key(link), "{link}");
    }
    for behind in ["ffffff", "f4f6f8"] {
        for ink in ["1c1f23", "545c66", "005e57", "8f4a00", "8a2f5b"] {
            assert!(page.contains(ink), "{ink}");
            assert!(page::contrast(ink, behind) >= 4.5, "{ink} on {behind}");
        }
    }
    let gallery = String::from_utf8(made["index.html"].clone()).unwrap();
    assert!(gallery.contains("href=\"report.html\"") && page.contains("href=\"index.html\""));
    let markdown = String::from_utf8(made["report.md"].clone()).unwrap();
    assert!(markdown.contains("\n## What holds\n") && markdown.contains("](figures/worths.svg)"));
}

#[test]
fn every_file_is_in_the_manifest_with_its_digest() {
    use sha2::Digest;
    let fixture = Fixture::new();
    fixture.succeed("study", &[]);
    let made = files(fixture.out());
    let manifest: serde_json::Value = serde_json::from_slice(&made["manifest.json"]).unwrap();
    let listed = manifest["files"].as_object().unwrap();
    for (path, bytes) in made.iter().filter(|(path, _)| *path != "manifest.json") {
        let digest: String = sha2::Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect();
        assert_eq!(listed[path]["sha256"], digest.as_str(), "{path}");
    }
    assert_eq!(listed.len(), made.len() - 1);
    assert_eq!(manifest["seed"], 2026);
}

#[test]
fn stimuli_say_nothing_about_what_they_show() {
    let fixture = Fixture::new();
    fixture.succeed("pairs", &[]);
    let made = files(fixture.out());
    for path in made.keys().filter(|path| path.starts_with("stimuli/")) {
        let name = Path::new(path).file_name().unwrap().to_str().unwrap();
        let stem = name.strip_suffix(".gif").unwrap_or_else(|| panic!("{path} among the stimuli"));
        assert!(stem.len() == 4 && stem.bytes().all(|b| b.is_ascii_lowercase()), "{path}");
        assert_eq!(extensions(&made[path]), ["NETSCAPE2.0"], "{path}: extensions that hold text");
    }
    let key = String::from_utf8(made["key/stimuli.csv"].clone()).unwrap();
    assert_eq!(key.lines().count(), 1 + 18 + 27);
    assert!(key.contains(",Q1,ss_bu,ss_bi\n"));
    for line in key.lines().skip(1) {
        assert!(made.contains_key(line.split(',').next().unwrap()), "{line}");
    }
}

/// Killed again and again at moments spread over the run, a study ends with the bytes of one that was left alone.
#[test]
fn a_killed_study_resumes_to_the_same_bytes() {
    let whole = Fixture::new();
    whole.succeed("study", &[]);
    let expected = without_measured_times(files(whole.out()));

    let killed = Fixture::new();
    let mut kills = 0;
    for round in 1.. {
        let mut command = killed.command("study");
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        // Ever longer, so that the run gets to its end on a machine of any speed.
        std::thread::sleep(Duration::from_millis(20).mul_f64(1.15_f64.powi(round)));
        match child.try_wait().unwrap() {
            Some(status) => {
                assert!(status.success());
                break;
            }
            None => {
                child.kill().unwrap();
                child.wait().unwrap();
                kills += 1;
            }
        }
    }
    assert!(kills >= 3, "killed only {kills} times");
    let found = without_measured_times(files(killed.out()));
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    for (path, bytes) in &expected {
        assert!(found[path] == *bytes, "{path} differs");
    }
}

#[test]
fn threads_change_no_byte() {
    let run = |threads: &str| -> BTreeMap<String, Vec<u8>> {
        let fixture = Fixture::new();
        fixture.succeed("pairs", &["--threads", threads]);
        files(fixture.out())
    };
    let (one, three) = (run("1"), run("3"));
    assert_eq!(one.keys().collect::<Vec<_>>(), three.keys().collect::<Vec<_>>());
    assert!(one.iter().all(|(path, bytes)| three[path] == *bytes));
}

#[test]
fn force_redoes_and_a_changed_seed_renames() {
    let fixture = Fixture::new();
    let extract = |arguments: &[&str]| fixture.succeed("extract", arguments).stderr;
    assert!(extract(&["--only", "ss_bi"]).contains("3 of 3 made"));
    assert!(extract(&["--only", "ss_bi"]).contains("up to date"));
    assert!(extract(&["--only", "ss_bi", "--force"]).contains("3 of 3 made"));

    let turntable = || fixture.succeed("turntable", &["--only", "ss_bi"]);
    let names = || -> Vec<String> {
        files(fixture.out()).into_keys().filter(|path| path.starts_with("stimuli/")).collect()
    };
    turntable();
    let before = names();
    fixture.edit("seed = 2026", "seed = 2027");
    turntable();
    assert_eq!((before.len(), names().len()), (1, 1));
    assert_ne!(before, names());
}

#[test]
fn report_draws_again_but_never_extracts() {
    let fixture = Fixture::new();
    let first = fixture.run("report", &[]);
    assert_eq!(first.code, Some(2));
    assert!(first.stderr.contains("run `isostudy study` first"), "{}", first.stderr);
    fixture.succeed("study", &[]);
    std::fs::remove_file(fixture.out().join("tables/answers.csv")).unwrap();
    fixture.succeed("report", &[]);
    assert!(fixture.out().join("tables/answers.csv").exists());
}

#[test]
fn wrong_input_is_refused_before_anything_is_made() {
    let refused = |from: &str, to: &str, expected: &[&str]| {
        let fixture = Fixture::new();
        fixture.edit(from, to);
        let Run { code, stderr: said, .. } = fixture.run("study", &[]);
        assert_eq!(code, Some(2), "{said}");
        for part in expected.iter().chain(&["study.toml"]) {
            assert!(said.contains(part), "{part:?} is not in: {said}");
        }
        assert!(!said.contains("panicked"), "{said}");
        assert!(!fixture.out().exists(), "something was written");
    };
    refused("seed = 2026", "seed = 2026\ncolour = 1", &["colour"]);
    refused("isovalue = 0.0", "isovalue = nan", &["objects[0].isovalue", "finite"]);
    refused("responses.csv", "nobody.csv", &["responses.file", "nobody.csv", "no such file"]);
    refused("solid.obj", "nothing.obj", &["field.sources[0].file", "nothing.obj", "make bunny"]);
    let key = "objects[0].benchmark_spacing";
    refused("benchmark_spacing = 0.125", "benchmark_spacing = 0.002", &[key, "0.002", "GiB"]);
    refused("benchmark_spacing = 0.125", "benchmark_spacing = 1e-4", &[key, "sample points"]);
    refused("spacing = 0.4", "spacing = 1e-9", &["stills[1].spacing"]);
    refused("schema = 1", "schema = [", &["line"]);
    refused("frames = 12", "frames = -12", &["frames", "-12", "whole number"]);
}

/// The same lattice streamed takes a few layers only, and those are held against the limit.
#[test]
fn memory_is_checked_for_the_extractor_that_runs() {
    let validated = |limit: &str| {
        let fixture = Fixture::new();
        fixture.edit("benchmark_spacing = 0.125", "benchmark_spacing = 0.002");
        fixture.edit("positions = \"accumulated\"", "positions = \"indexed\"");
        fixture.edit("memory_gib = 8.0", limit);
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_isostudy"));
        let output = command.arg("validate").arg(fixture.config()).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(validated("memory_gib = 1.0"), (Some(0), String::new()));
    let (code, said) = validated("memory_gib = 0.001");
    assert_eq!(code, Some(2), "{said}");
    for part in ["benchmark_spacing = 0.002", "MiB", "limits.memory_gib allows 1.0 MiB"] {
        assert!(said.contains(part), "{part:?} is not in: {said}");
    }
}

#[test]
fn a_mesh_with_another_digest_is_refused() {
    let fixture = Fixture::new();
    fixture.edit("sha256 = \"", "sha256 = \"00");
    fixture.edit_with(|text| {
        // Keep the length right: drop the last two digits of the same line.
        let start = text.find("sha256 = \"00").unwrap() + "sha256 = \"".len();
        format!("{}{}", &text[..start + 64], &text[start + 66..])
    });
    let Run { code, stderr: said, .. } = fixture.run("study", &[]);
    assert_eq!(code, Some(2));
    assert!(said.contains("solid.obj") && said.contains("has SHA-256"), "{said}");
    assert!(!fixture.out().exists(), "something was written");
    let validated = std::process::Command::new(env!("CARGO_BIN_EXE_isostudy"))
        .arg("validate")
        .arg(fixture.config())
        .output()
        .unwrap();
    assert_eq!(validated.status.code(), Some(2));
}

#[test]
fn answers_are_read_before_anything_is_made() {
    for (answers, expected) in [("", "responses.csv"), ("Q1,Q2\n", "Q3"), ("Q1,Q2\nL,X\n", "Q3")] {
        let fixture = Fixture::new();
        let path = fixture.folder().join("responses.csv");
        std::fs::write(&path, answers).unwrap();
        fixture.edit_with(|text| {
            let line = text.lines().find(|line| line.contains("responses.csv")).unwrap();
            text.replace(line, &format!("file = {path:?}"))
        });
        let Run { code, stderr: said, .. } = fixture.run("study", &[]);
        assert_eq!(code, Some(2), "{said}");
        assert!(said.contains(expected), "{expected} is not in: {said}");
        assert!(!fixture.out().exists(), "something was written");
    }
}

#[test]
fn a_surface_that_misses_the_volume_is_refused() {
    let fixture = Fixture::new();
    fixture.edit("isovalue = 0.0", "isovalue = 50.0");
    let Run { code, stderr: said, .. } = fixture.run("extract", &[]);
    assert_eq!(code, Some(2));
    assert!(said.contains("objects[0]") && said.contains("isovalue 50"), "{said}");
}

#[test]
fn a_published_number_that_nothing_explains_fails_the_study() {
    let fixture = Fixture::new();
    let path = fixture.folder().join("preferences.csv");
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = std::fs::read_to_string(root.join("study/paper/published_preferences.csv")).unwrap();
    assert!(text.contains("group,S,si,0.562"));
    std::fs::write(&path, text.replace("group,S,si,0.562", "group,S,si,0.662")).unwrap();
    fixture.edit_with(|text| {
        let line = text.lines().find(|line| line.starts_with("preferences = ")).unwrap();
        text.replace(line, &format!("preferences = {path:?}"))
    });
    let Run { code, stdout, stderr } = fixture.run("study", &[]);
    assert_eq!(code, Some(1), "{stderr}");
    assert!(stderr.contains("0.662") && stdout.ends_with("index.html\n"), "{stderr}");
}

/// What a study no longer has, its folder no longer has either: nothing that the key does not name is given away.
#[test]
fn what_an_edited_study_drops_goes() {
    let fixture = Fixture::new();
    fixture.succeed("study", &[]);
    fixture.edit_with(|text| {
        let asteroid = text.find("[[objects]]\nid = \"as\"").unwrap();
        let bunny = text.find("[[objects]]\nid = \"bs\"").unwrap();
        let without: String = text[..asteroid]
            .lines()
            .filter(|line| !line.contains("as_"))
            .fold(String::new(), |text, line| text + line + "\n");
        format!("{without}{}", &text[bunny..])
    });
    fixture.edit_with(|text| {
        // The answers have columns for the asteroid's questions.
        let from = text.find("[responses]").unwrap();
        let to = text.find("[published]").unwrap();
        format!("{}{}", &text[..from], &text[to..])
    });
    fixture.succeed("study", &[]);
    let made = files(fixture.out());
    let manifest: serde_json::Value = serde_json::from_slice(&made["manifest.json"]).unwrap();
    let listed: BTreeSet<&String> = manifest["files"].as_object().unwrap().keys().collect();
    let found: BTreeSet<&String> = made.keys().filter(|path| *path != "manifest.json").collect();
    let differing: Vec<_> = listed.symmetric_difference(&found).collect();
    assert!(differing.is_empty(), "{differing:?}");
    assert_eq!(found.iter().filter(|path| path.starts_with("stimuli/pairs/")).count(), 18);
}

#[test]
fn analyse_prints_the_papers_numbers() {
    let fixture = Fixture::new();
    let said = fixture.succeed("analyse", &[]).stdout;
    assert!(said.contains("1.06"), "simple cubic, integrated, overall: {said}");
    let groups = std::fs::read_to_string(fixture.out().join("tables/preference_groups.csv")).unwrap();
    let mut lines = groups.lines();
    assert!(lines.next().unwrap().starts_with("group,configuration,wins,ties,answers,factor"));
    assert_eq!(lines.count(), 12);
    let of = |start: &str| groups.lines().find(|line| line.starts_with(start)).unwrap().to_owned();
    assert!(of("B,bi,").starts_with("B,bi,68,19,162,0.41975"), "{}", of("B,bi,"));
    let overall = std::fs::read_to_string(fixture.out().join("tables/preference_overall.csv")).unwrap();
    assert!(overall.starts_with("configuration,factor"));
    assert_eq!(overall.lines().count(), 7);
}

#[test]
fn answers_that_do_not_fit_are_refused_with_their_place() {
    let fixture = Fixture::new();
    let path = fixture.folder().join("answers.csv");
    std::fs::write(&path, "Q1,Q2\nL,R\nX,NP\n").unwrap();
    let Run { code, stderr: said, .. } = fixture.run("analyse", &["--responses", path.to_str().unwrap()]);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("answers.csv") && said.contains("Q3"), "{said}");
}

/// The quick study asked as in configs/balanced.toml.
fn balanced() -> Fixture {
    let fixture = Fixture::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = std::fs::read_to_string(root.join("configs/balanced.toml")).unwrap();
    let forms = &text[text.find("[forms]").unwrap()..];
    fixture.edit_with(|study| format!("{study}\n{forms}"));
    fixture
}

#[test]
fn a_design_is_judged_before_anyone_answers() {
    let check = |study: &str, arguments: &[&str]| {
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_isostudy"))
            .args(["design", "check", study])
            .args(arguments)
            .output()
            .unwrap();
        (
            output.status.code(),
            String::from_utf8(output.stdout).unwrap(),
            String::from_utf8(output.stderr).unwrap(),
        )
    };
    let fixture = balanced();
    let (config, out) = (fixture.config(), fixture.out().to_str().unwrap());
    let (code, said, _) = check(config.to_str().unwrap(), &["--results", out]);
    assert!(code == Some(0) && said.ends_with(": no faults\n"), "{said}");

    // The original's sides, and animations of which one is not like the others.
    fixture.edit("sides = \"balanced\"", "sides = \"as-listed\"");
    fixture.succeed("pairs", &[]);
    let key = std::fs::read_to_string(fixture.out().join("key/stimuli.csv")).unwrap();
    let code_of = |id: &str| {
        let line = key.lines().find(|line| line.ends_with(&format!(",,{id},"))).unwrap();
        line.split(',').next().unwrap().to_owned()
    };
    let [odd, other] = ["ss_bu", "as_si"].map(|id| fixture.out().join(code_of(id)));
    let mut bytes = std::fs::read(&other).unwrap();
    bytes.splice(bytes.len() - 1.., *b"\x21\xfe\x05as_si\x00\x3b");
    std::fs::write(&other, bytes).unwrap();
    // Three times the delay between frames: every graphic control block holds it, little-endian, at the third byte.
    let mut bytes = std::fs::read(&odd).unwrap();
    for at in 0..bytes.len() - 8 {
        if bytes[at..at + 3] == [0x21, 0xf9, 4] {
            bytes[at + 4] *= 3;
        }
    }
    std::fs::write(&odd, bytes).unwrap();
    let (code, said, _) = check(config.to_str().unwrap(), &["--results", out, "--json"]);
    assert_eq!(code, Some(1));
    let faults: serde_json::Value = serde_json::from_str(&said).unwrap();
    let rules: BTreeSet<&str> =
        faults.as_array().unwrap().iter().map(|f| f["rule"].as_str().unwrap()).collect();
    assert_eq!(rules.into_iter().collect::<Vec<_>>(), ["names-reveal", "side-confounded", "stimuli-differ"]);
    let differing = faults.as_array().unwrap().iter().filter(|f| f["rule"] == "stimuli-differ");
    // Every pair that has the odd one on one side.
    let odd = |line: &&str| {
        let cells: Vec<&str> = line.split(',').collect();
        !cells[3].is_empty() && (cells[2] == "ss_bu") != (cells[3] == "ss_bu")
    };
    assert_eq!(differing.clone().count(), key.lines().skip(1).filter(odd).count());
    assert!(differing.clone().all(|f| f["evidence"].as_str().unwrap().starts_with("duration")));

    let quick = Fixture::new();
    let (code, _, said) = check(quick.config().to_str().unwrap(), &[]);
    assert!(code == Some(2) && said.contains("no [forms] section"), "{said}");
}

/// What participants are given is judged, and the camera that each side was really made with.
#[test]
fn finished_files_are_judged() {
    let fixture = balanced();
    fixture.succeed("bundle", &[]);
    let faults = || -> Vec<(String, String, String)> {
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_isostudy"))
            .args(["design", "check", "--json", "--results"])
            .args([fixture.out(), &fixture.config()])
            .output()
            .unwrap();
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let text = |fault: &serde_json::Value, key: &str| fault[key].as_str().unwrap().to_owned();
        let all = found.as_array().unwrap().iter();
        all.map(|f| (text(f, "rule"), text(f, "place"), text(f, "evidence"))).collect()
    };
    assert_eq!(faults(), []);
    for folder in ["stimuli/pairs", "bundle/stimuli"] {
        let folder = fixture.out().join(folder);
        let file = folder.join(files(&folder).keys().next().unwrap());
        let whole = std::fs::read(&file).unwrap();
        let mut planted = whole.clone();
        let end = gif_length(&whole) - 1;
        planted.splice(end..end, *b"\x21\xfe\x05as_bi\x00");
        planted.truncate(whole.len().max(end + 10));
        std::fs::write(&file, planted).unwrap();
        let found = faults();
        assert!(found.len() == 1 && found[0].0 == "names-reveal", "{found:?}");
        assert!(found[0].1 == file.display().to_string() && found[0].2.ends_with("names as_bi"), "{found:?}");
        std::fs::write(&file, &whole).unwrap();
        if folder.ends_with("bundle/stimuli") {
            std::fs::write(&file, &whole[..whole.len() - 1]).unwrap();
            let found = faults();
            assert!(found.len() == 1 && found[0].2.contains(" bytes, "), "{found:?}");
            std::fs::write(&file, &whole).unwrap();
        }
    }
    fixture.edit("camera = { distance = 1.2,", "camera = { distance = 1.21,");
    fixture.succeed("turntable", &["--only", "ss_bu"]);
    let found = faults();
    assert!(
        !found.is_empty() && found.iter().all(|f| f.0 == "stimuli-differ" && f.2.starts_with("camera")),
        "{found:?}"
    );
}

/// Faults are said and nothing is bundled, unless they are accepted; a study without forms is named.
#[test]
fn a_faulty_design_is_not_bundled() {
    let fixture = balanced();
    fixture.edit("sides = \"balanced\"", "sides = \"as-listed\"");
    for verb in ["bundle", "serve"] {
        let Run { code, stderr, .. } = fixture.run(verb, &[]);
        assert!(
            code == Some(1) && stderr.contains("side-confounded") && stderr.contains("--with-faults"),
            "{stderr}"
        );
        assert!(!fixture.out().exists(), "{verb}");
    }
    let said = fixture.succeed("bundle", &["--with-faults"]).stderr;
    assert!(said.contains("side-confounded") && fixture.out().join("bundle/forms.json").is_file(), "{said}");

    let quick = Fixture::new();
    let Run { code, stderr, .. } = quick.run("bundle", &[]);
    assert!(code == Some(2) && stderr.contains("study.toml: no [forms] section"), "{stderr}");
}

/// Turntables that are wider than high are so in the contact sheet.
#[test]
fn the_contact_sheet_keeps_proportions() {
    let height = |edit: bool| {
        let fixture = balanced();
        if edit {
            fixture.edit_with(|text| {
                let line = text.lines().find(|line| line.starts_with("height = ")).unwrap();
                let half = line["height = ".len()..].parse::<u32>().unwrap() / 2;
                text.replacen(line, &format!("height = {half}"), 1)
            });
        }
        fixture.succeed("bundle", &[]);
        let png = std::fs::read(fixture.out().join("key/contact_sheet.png")).unwrap();
        // The header's height, after the signature, the chunk's own header and the width.
        u32::from_be_bytes(png[20..24].try_into().unwrap())
    };
    let (square, flat) = (height(false), height(true));
    assert!((square - flat) % 64 == 0 && square - flat >= 5 * 64, "{square} and {flat}");
}

#[test]
fn the_smallest_study_is_sound_and_says_its_power() {
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/two-methods.toml");
    let out = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_isostudy"));
        let output =
            command.args(["design", arguments[0]]).arg(&config).args(&arguments[1..]).output().unwrap();
        (
            output.status.code(),
            String::from_utf8(output.stdout).unwrap(),
            String::from_utf8(output.stderr).unwrap(),
        )
    };
    let (code, said, _) = run(&["check", "--results", out.path().to_str().unwrap()]);
    assert!(code == Some(0) && said.ends_with(": no faults\n"), "{said}");

    let folder = out.path().to_str().unwrap();
    let (code, said, _) = run(&["power", "--studies", "200", "--participants", "48,6", "--out", folder]);
    assert!(code == Some(0) && said.contains("N = 6 | N = 48"), "{said}");
    let table = std::fs::read_to_string(out.path().join("power.csv")).unwrap();
    let powers = |n: &str| -> Vec<f64> {
        let rows = table.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
        rows.filter(|row| row[5] == n && row[4] == "0.77").map(|row| row[6].parse().unwrap()).collect()
    };
    // Two contrasts, all answers and within the only lattice, and two questions.
    assert_eq!(powers("6").len(), 4);
    assert!(powers("6").iter().zip(powers("48")).all(|(few, many)| few + 0.3 < many), "{table}");
    assert!(out.path().join("power.png").is_file() && out.path().join("power.svg").is_file());
    for (wrong, place) in
        [("--shares=1.5", "above 0 and below 1"), ("--person-sd=-1", "0 to 100"), ("--studies=3", "100..")]
    {
        let (code, _, said) = run(&["power", wrong]);
        assert!(code == Some(2) && said.contains(place), "{said}");
    }
}

/// What can be told of a file without looking at its pictures tells nothing of what it shows.
#[test]
fn a_bundle_tells_nothing_of_the_key() {
    let fixture = balanced();
    fixture.succeed("bundle", &[]);
    let bundle = fixture.out().join("bundle");
    let made = files(&bundle);
    assert_eq!(made.len(), 5 + 2 * 27 + 2, "{:?}", made.keys());
    let key = std::fs::read_to_string(fixture.out().join("key/stimuli.csv")).unwrap();
    let shown: BTreeMap<&str, &str> =
        key.lines().filter_map(|line| line.strip_prefix("stimuli/pairs/")?.split_once(',')).collect();
    let mut stimuli: Vec<&String> = made.keys().filter(|path| path.ends_with(".gif")).collect();
    let file = |path: &str| std::fs::metadata(bundle.join(path)).unwrap();
    let sizes: BTreeSet<u64> = stimuli.iter().map(|path| file(path).len()).collect();
    assert_eq!(sizes.len(), 1, "a smoother surface makes a smaller file");
    // Nor does trimming or packing a file bring its own size back: the pictures themselves can be packed by 0 to 3 %, the
    // noise after them not at all.
    let pad = |path: &&String| made[*path].len() - gif_length(&made[*path]);
    assert!(stimuli.iter().map(pad).all(|pad| pad >= 64));
    let trimmed = |path: &&String| made[*path].iter().rposition(|byte| *byte != 0).unwrap() + 1;
    assert!(stimuli.iter().all(|path| trimmed(path) + 4 > made[*path].len()));
    let packed = |path: &&String| {
        let mut packer = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::default());
        packer.write_all(&made[*path]).unwrap();
        packer.finish().unwrap().len()
    };
    let packed: Vec<usize> = stimuli.iter().map(packed).collect();
    let (least, most) = (*packed.iter().min().unwrap(), *packed.iter().max().unwrap());
    let own = stimuli.iter().map(|path| gif_length(&made[*path]));
    let (shortest, longest) = (own.clone().min().unwrap(), own.max().unwrap());
    assert!(shortest * 10 < longest * 9, "{shortest} to {longest}: there is something to hide");
    assert!(least * 100 > most * 97, "packed {least} to {most}");
    assert!(stimuli.is_sorted());
    stimuli.sort_by_key(|path| file(path).modified().unwrap());
    assert!(stimuli.is_sorted(), "files are as old as their names say");
    for path in &stimuli {
        assert_eq!(extensions(&made[*path]), ["NETSCAPE2.0"], "{path}");
    }
    // The order of names against the order of the study: Spearman's rho of 56 is within 0.4 with probability 0.998.
    let place = |path: &&String| {
        key.lines().position(|line| line.contains(path.rsplit('/').next().unwrap())).unwrap()
    };
    let places: Vec<f64> = stimuli.iter().map(|path| place(path) as f64 - 19.0).collect();
    let mean = (places.len() - 1) as f64 / 2.0;
    let products: f64 = places.iter().enumerate().map(|(i, place)| (i as f64 - mean) * (place - mean)).sum();
    let squares: f64 = (0..places.len()).map(|i| (i as f64 - mean).powi(2)).sum();
    assert!((products / squares).abs() < 0.4, "{}", products / squares);

    let text = String::from_utf8(made["forms.json"].clone()).unwrap();
    for id in shown.values().flat_map(|line| line.split(',')).filter(|id| id.contains('_')) {
        assert!(!text.contains(id), "{id}");
    }
    let forms: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(forms["forms"].as_array().unwrap().len(), 36);
    let of_form = |form: &serde_json::Value| form["questions"].as_array().unwrap().clone();
    for stimulus in forms["forms"].as_array().unwrap().iter().flat_map(of_form) {
        assert!(made.contains_key(&format!("stimuli/{}.gif", stimulus.as_str().unwrap())), "{stimulus}");
    }
    let again = fixture.succeed("bundle", &[]);
    assert!(!again.stderr.contains(" made, "), "{}", again.stderr);
}

#[test]
fn videos_are_ffmpegs_and_said_to_be_missing_where_it_is() {
    let fixture = Fixture::new();
    let mut command = fixture.command("pairs");
    let output = command.arg("--mp4").env("PATH", fixture.folder()).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("no ffmpeg on the PATH"), "{said}");
    assert!(!fixture.out().exists(), "nothing is made before");

    // A stand-in that keeps how many bytes it was sent, and writes that as the video.
    if cfg!(unix) {
        let script = "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\nfor last; do :; done\nwc -c > \"$last\"\n";
        let program = fixture.folder().join("ffmpeg");
        std::fs::write(&program, script).unwrap();
        make_executable(&program);
        let path = format!("{}:{}", fixture.folder().display(), std::env::var("PATH").unwrap());
        let output = fixture.command("pairs").arg("--mp4").env("PATH", path).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let made = files(fixture.out());
        let videos: Vec<&Vec<u8>> =
            made.iter().filter(|(path, _)| path.ends_with(".mp4")).map(|(_, v)| v).collect();
        assert_eq!(videos.len(), 27);
        let study = std::fs::read_to_string(fixture.config()).unwrap();
        let number = |key: &str| -> u64 {
            let line = study.lines().find_map(|line| line.strip_prefix(&format!("{key} = "))).unwrap();
            line.parse().unwrap()
        };
        let sent = 2 * number("width") * number("height") * 3 * number("frames");
        let read = |video: &Vec<u8>| String::from_utf8_lossy(video).trim().parse::<u64>().unwrap();
        assert!(videos.iter().all(|video| read(video) == sent), "{sent}");
    }
}

/// A pair that is enlarged already is not enlarged again, and no player has to guess its colours.
#[cfg(unix)]
#[test]
fn a_video_has_twice_the_size_of_its_turntables_and_says_its_colours() {
    for (scale, filter) in [(1, "scale=iw*2:ih*2:"), (2, "scale=iw*1:ih*1:")] {
        let fixture = Fixture::new();
        fixture.edit("pair_scale = 1", &format!("pair_scale = {scale}"));
        let script = "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\nfor last; do :; done\ncat > /dev/null\necho \"$@\" > \"$last\"\n";
        let program = fixture.folder().join("ffmpeg");
        std::fs::write(&program, script).unwrap();
        make_executable(&program);
        let path = format!("{}:{}", fixture.folder().display(), std::env::var("PATH").unwrap());
        let output = fixture.command("pairs").arg("--mp4").env("PATH", path).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let made = files(fixture.out());
        let asked = made.iter().find(|(path, _)| path.ends_with(".mp4")).unwrap().1;
        let asked = String::from_utf8_lossy(asked);
        for part in [
            filter,
            "out_color_matrix=bt709",
            "-colorspace bt709",
            "-color_primaries bt709",
            "-color_trc bt709",
            "-color_range tv",
        ] {
            assert!(asked.contains(part), "{part} is not in {asked}");
        }
    }
}

/// What ffmpeg made, each of another length, is in the bundle: of one length, as old as its name says.
#[cfg(unix)]
#[test]
fn a_bundles_videos_tell_nothing_either() {
    let fixture = balanced();
    let script = "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\nfor last; do :; done\ncksum > \"$last\"\n\
        head -c $(($$ % 50)) /dev/zero >> \"$last\"\n";
    let program = fixture.folder().join("ffmpeg");
    std::fs::write(&program, script).unwrap();
    make_executable(&program);
    let path = format!("{}:{}", fixture.folder().display(), std::env::var("PATH").unwrap());
    let output = fixture.command("bundle").arg("--mp4").env("PATH", path).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let made = files(&fixture.out().join("stimuli/pairs"));
    let own: BTreeMap<&String, &Vec<u8>> = made.iter().filter(|(name, _)| name.ends_with(".mp4")).collect();
    assert!(own.len() == 56 && own.values().map(|video| video.len()).collect::<BTreeSet<_>>().len() > 1);
    let folder = fixture.out().join("bundle/stimuli");
    let given = files(&folder);
    let length = given[own.keys().next().unwrap().as_str()].len();
    for (name, video) in own {
        let padded = &given[name];
        assert!(padded.len() == length && padded.starts_with(video), "{name}");
        let free = &padded[video.len()..];
        assert_eq!(free[..4], (free.len() as u32).to_be_bytes(), "{name}");
        assert!(free[4..8] == *b"free" && free[8..].iter().any(|byte| *byte != 0), "{name}");
    }
    let mut by_age: Vec<&String> = given.keys().collect();
    by_age.sort_by_key(|name| std::fs::metadata(folder.join(name)).unwrap().modified().unwrap());
    assert!(by_age.is_sorted());
    // Not asked for, they go.
    fixture.succeed("bundle", &[]);
    assert!(files(&folder).keys().all(|name| name.ends_with(".gif")));
}

#[cfg(unix)]
fn make_executable(path: &Path) {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755)).unwrap();
}

#[cfg(not(unix))]
fn make_executable(_: &Path) {}

/// The text extensions of a GIF: comments, plain texts, and the names of application extensions.
fn extensions(gif: &[u8]) -> Vec<String> {
    blocks(gif).0
}

/// Up to and with the trailer.
fn gif_length(gif: &[u8]) -> usize {
    blocks(gif).1
}

fn blocks(gif: &[u8]) -> (Vec<String>, usize) {
    const GRAPHIC_CONTROL: u8 = 0xf9;
    let table = |flags: u8| if flags & 0x80 == 0 { 0 } else { 3 << ((flags & 7) + 1) };
    let mut at = 13 + table(gif[10]);
    let mut found = Vec::new();
    loop {
        let label = match gif[at] {
            0x21 => {
                at += 2;
                Some(gif[at - 1])
            }
            0x2c => {
                at += 10 + table(gif[at + 9]) + 1;
                None
            }
            0x3b => return (found, at + 1),
            other => panic!("block {other:#x} at {at}"),
        };
        let mut first = String::new();
        while gif[at] != 0 {
            let size = gif[at] as usize;
            if first.is_empty() {
                first = String::from_utf8_lossy(&gif[at + 1..at + 1 + size]).into_owned();
            }
            at += 1 + size;
        }
        at += 1;
        if label.is_some_and(|label| label != GRAPHIC_CONTROL) {
            found.push(first);
        }
    }
}
