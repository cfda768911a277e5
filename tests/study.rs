//! The whole chain as a user runs it: the `isostudy` command on a small study with real answers.

use crate::command::{Folder, Run, isostudy};
use crate::fixture::{Fixture, files, without_measured_times};
use crate::page;
use std::collections::{BTreeMap, BTreeSet};
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
    // Six pictures of methods have no SVG, and every figure has one more for narrow screens.
    let narrow = count("figures/", "-narrow.svg");
    assert_eq!(count("figures/", ".svg") - narrow + 6, count("figures/", ".png"));
    let figures: serde_json::Value = serde_json::from_slice(&made["figures/contents.json"]).unwrap();
    assert_eq!(figures.as_array().unwrap().len(), narrow);
    assert!(narrow >= 14, "{narrow}");

    let again = fixture.succeed("study", &[]);
    assert!(!again.stderr.contains(" made, "), "{}", again.stderr);
    assert_eq!(files(fixture.out()), made);
    assert_golden(&made);
}

/// Every file but those with times, against SHA-256 of what the program made on 2026-11-22 (commit e343f5e), before methods were
/// anything but two letters. A change that is meant renews `golden/quick.sha256` from what this prints, and says so in the changelog:
/// so far records of meshes, digests of cameras, intervals of alpha, the note under what predicts preference, triangles that pass
/// through each other, distances from sharp edges, p over methods in what predicts preference, the captions of contrasts
/// and of shares of showings, distances to meshes from evenly spread points of the surface, a table of likings,
/// and figures: their colours on dark pages, one more of each for narrow screens, and an overview; and what a sweep leaves.
///
/// It says that nothing changed, not that anything is right. That is for other tests: tables of answers against `isostudy-oracle` and
/// published numbers, statistics against R and SciPy, meshes against genus, area and volume, pictures as `golden.rs` of
/// `isostudy-raster` says.
fn assert_golden(made: &BTreeMap<String, Vec<u8>>) {
    let golden = include_str!("golden/quick.sha256");
    let golden: BTreeMap<&str, &str> = golden
        .lines()
        .filter_map(|line| line.split_once("  "))
        .map(|(digest, path)| (path, digest))
        .collect();
    let found: BTreeMap<String, String> = without_measured_times(made.clone())
        .into_iter()
        .map(|(path, bytes)| (path, sha256(&bytes)))
        .collect();
    let lines: String = found.iter().map(|(path, digest)| format!("{digest}  {path}\n")).collect();
    let differs = |path: &&str| found.get(*path).map(String::as_str) != Some(golden[*path]);
    let mut differing: Vec<&str> = golden.keys().copied().filter(differs).collect();
    differing.extend(found.keys().map(String::as_str).filter(|path| !golden.contains_key(path)));
    if !differing.is_empty() {
        let path = std::env::temp_dir().join("quick.sha256");
        std::fs::write(&path, lines).unwrap();
        panic!("not as before: {differing:?}; {} lists what is now", path.display());
    }
}

fn sha256(bytes: &[u8]) -> String {
    use sha2::Digest;
    sha2::Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Where half of the people see another file than the one on the page, the page says so.
#[test]
fn the_page_says_where_sides_differ() {
    let fixture = Fixture::balanced();
    fixture.succeed("study", &[]);
    let page = String::from_utf8(files(fixture.out())["index.html"].clone()).unwrap();
    assert!(page.contains("Pairs, as the study lists them") && !page.contains("as shown to respondents"));
    assert!(page.contains("Half of the people see the sides of a pair exchanged, in a file of its own."));
}

/// One file, no request, headings in order, everything labelled, and text that stands out from what is behind it.
#[test]
fn the_report_can_be_read_alone() {
    let fixture = Fixture::new();
    fixture.succeed("study", &[]);
    let made = files(fixture.out());
    let page = String::from_utf8(made["report.html"].clone()).unwrap();
    assert_eq!(page::unclosed(&page), Vec::<String>::new());
    for forbidden in ["<link", "@import", "url(", "<script src"] {
        assert!(!page.contains(forbidden), "{forbidden}");
    }
    // Pictures are in the page.
    let sources: Vec<&str> = page.split(" src=\"").skip(1).collect();
    assert!(sources.len() == 6 && sources.iter().all(|source| source.starts_with("data:image/png;base64,")));
    // SVG's name is no request.
    let addresses = page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    assert!(!addresses.contains("http://") && !addresses.contains("https://"));
    let headings: Vec<&str> = page.match_indices("<h").map(|(i, _)| &page[i..i + 3]).collect();
    let headings: Vec<&&str> = headings.iter().filter(|h| h.as_bytes()[2].is_ascii_digit()).collect();
    assert!(
        *headings[0] == "<h1" && headings[1..].iter().all(|h| **h == "<h2") && headings.len() > 8,
        "{headings:?}"
    );
    // Each is drawn for wide and for narrow screens.
    let figures = page.matches("<svg").count();
    assert!(figures >= 26, "{figures}");
    assert_eq!(2 * page.matches("role=\"img\" aria-label=\"").count(), figures);
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
    for behind in ["14181d", "1e242b"] {
        for ink in ["e6e9ed", "b0bac5", "62cfc0", "ff9d9d", "f0ad62", "e9a9d0"] {
            assert!(page.contains(ink), "{ink}");
            assert!(page::contrast(ink, behind) >= 4.5, "{ink} on {behind}");
        }
    }
    // What comes first, in both pages and in Markdown.
    let index = String::from_utf8(made["index.html"].clone()).unwrap();
    for (text, next) in [(&page, "id=\"worths\""), (&index, "id=\"contrasts\"")] {
        let place = |what: &str| text.find(what).unwrap_or_else(|| panic!("{what}"));
        assert!(place("<h1>") < place("<p class=\"finding\">People preferred "));
        assert!(place("<p class=\"finding\">") < place("<figure class=\"overview\">"));
        assert!(place("<figure class=\"overview\">") < place("alt=\"body-centred, none on the asteroid\""));
        assert!(place("alt=\"body-centred, none on the asteroid\"") < place("<dt>Compared</dt>"));
        assert!(place("<dt>Compared</dt>") < place("<dt>Next</dt>"));
        assert!(place("<dt>Next</dt>") < place(next));
        for id in ["bu", "bi", "bp", "su", "si", "sp"] {
            assert!(text.contains(&format!("<span><code>{id}</code> ")), "tables call it {id}");
        }
        assert!(!text.replace('\u{a0}', " ").contains("p = 0.000"), "a small p is said to be small");
        assert!(text.contains("&lt; 0.001"));
    }
    let gallery = String::from_utf8(made["index.html"].clone()).unwrap();
    // Pairs in words, with what people said of them.
    let votes: serde_json::Value = serde_json::from_slice(&made["tables/votes.json"]).unwrap();
    let [left, none, right] = ["left", "none", "right"].map(|of| votes["Q8"][of].as_u64().unwrap());
    assert_eq!(left + none + right, 18);
    let said = format!(
        "Question 8, sphere: body-centred, integrated (left) beside simple cubic, integrated: {left} left, {right} right, {none} no \
         preference <code>ss_bi | ss_si</code>"
    );
    assert!(gallery.contains(&said), "{said}");
    assert!(gallery.contains("href=\"report.html\"") && page.contains("href=\"index.html\""));
    assert!(
        gallery.contains("Pairs, as shown to respondents")
            && !gallery.contains("see the sides of a pair exchanged")
    );
    let markdown = String::from_utf8(made["report.md"].clone()).unwrap();
    assert!(
        markdown.contains("\n## What was preferred to what\n") && markdown.contains("](figures/worths.svg)")
    );
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
        std::thread::sleep(Duration::from_millis(20).mul_f64(1.25_f64.powi(round)));
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
    assert!(kills >= 5, "killed only {kills} times");
    let found = without_measured_times(files(killed.out()));
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    for (path, bytes) in &expected {
        assert!(found[path] == *bytes, "{path} differs");
    }
}

/// Frames of an animation: how bright each is where it differs from the first pixel, on average, and the darkest of it.
fn brightness(gif: &[u8]) -> Vec<(f64, u32)> {
    let animation = isostudy_raster::Animation::read_gif(gif).unwrap();
    let sum = |index: u8| animation.palette.colours()[usize::from(index)].iter().map(|&v| u32::from(v)).sum();
    let of_frame = |frame: &Vec<u8>| {
        let shown: Vec<u32> = frame.iter().filter(|&&i| i != frame[0]).map(|&i| sum(i)).collect();
        let total: u32 = shown.iter().sum();
        (f64::from(total) / shown.len() as f64, *shown.iter().min().unwrap())
    };
    animation.frames.iter().map(of_frame).collect()
}

/// `[turntable] look`, `[shading] light_follows` and `ambient`, and the looks of a still reach the files; leaving them out
/// is as before.
#[test]
fn looks_and_light_reach_the_pictures() {
    let fixture = Fixture::new();
    let sphere = |fixture: &Fixture| {
        fixture.succeed("turntable", &["--only", "ss_bi"]);
        let made = files(fixture.out());
        let gifs: Vec<_> = made.keys().filter(|path| path.starts_with("stimuli/turntables/")).collect();
        assert_eq!(gifs.len(), 1);
        made[gifs[0]].clone()
    };
    let published = sphere(&fixture);
    let range = |frames: &[(f64, u32)]| {
        let (low, high) = frames.iter().fold((f64::MAX, 0.0f64), |(a, b), f| (a.min(f.0), b.max(f.0)));
        high / low
    };
    assert!(range(&brightness(&published)) > 2.0);

    fixture.edit("supersampling = 2", "supersampling = 2\nlook = \"flat\"");
    fixture.edit("[shading]\n", "[shading]\nlight_follows = \"camera\"\nambient = 0.25\n");
    let lit = brightness(&sphere(&fixture));
    assert!(range(&lit) < 1.05, "{lit:?}");
    // A quarter of the lit colour at least, less what rounding takes.
    let least = (0.25 * (0.949 + 0.553 + 0.027) * 255.0) as u32 - 6;
    assert!(lit.iter().all(|&(_, darkest)| darkest >= least), "{lit:?}");

    fixture.edit("look = \"flat\"\n", "");
    fixture
        .edit("light_follows = \"camera\"\nambient = 0.25\n", "light_follows = \"scene\"\nambient = 0.0\n");
    assert!(sphere(&fixture) == published, "what is written out is as by default");
}

#[test]
fn stills_turn_and_have_colours_for_numbers() {
    let fixture = Fixture::new();
    let stills = "turntable = true\nlooks = [\"flat\", \"quality\", \"error\"]";
    fixture.edit("looks = [\"smooth\", \"flat\", \"smooth-wireframe\"]", stills);
    fixture.succeed("study", &[]);
    let made = files(fixture.out());
    let gif = |look: &str| {
        let bytes = &made[&format!("figures/still_sphere_{look}.gif")];
        isostudy_raster::Animation::read_gif(bytes.as_slice()).unwrap()
    };
    let (flat, quality, error) = (gif("flat"), gif("quality"), gif("error"));
    assert_eq!((flat.width, flat.height, flat.frames.len()), (96, 96, 12));
    assert!(quality.height > flat.height && error.height > flat.height, "the scale is below");
    let page = String::from_utf8(made["index.html"].clone()).unwrap();
    assert!(page.contains("href=\"figures/still_sphere_error.gif\">error</a>"));
    assert!(!page.contains("still_bunny_"), "only where it is asked for");
    let sheet = isostudy_raster::pixmap_from_png(&made["figures/still_sphere.png"]).unwrap();
    assert!(sheet.width() > 3 * 96 && sheet.height() > quality.height);
    let again = fixture.succeed("study", &[]);
    assert!(!again.stderr.contains(" made, "), "{}", again.stderr);
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
    assert!(first.stderr.contains("isostudy study"), "{}", first.stderr);
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
    refused("benchmark_spacing = 0.125", "benchmark_spacing = 5e-6", &[key, "sample points"]);
    refused("spacing = 0.4", "spacing = 1e-9", &["stills[1].spacing"]);
    refused("schema = 1", "schema = [", &["line"]);
    refused("frames = 12", "frames = -12", &["frames", "-12", "whole number"]);
}

/// The same lattice streamed takes a few layers only, and those are held against the limit.
#[test]
fn memory_is_checked_for_the_extractor_that_runs() {
    let validated = |positions: &str, limit: &str| {
        let fixture = Fixture::new();
        fixture.edit("benchmark_spacing = 0.125", "benchmark_spacing = 0.01");
        fixture.edit("positions = \"accumulated\"", positions);
        fixture.edit("memory_gib = 8.0", limit);
        let run = Run::of(isostudy().arg("validate").arg(fixture.config()));
        (run.code, run.stderr)
    };
    let streamed = "positions = \"indexed\"";
    assert_eq!(validated(streamed, "memory_gib = 0.5"), (Some(0), String::new()));
    for (positions, limit, allowed) in [
        ("positions = \"accumulated\"", "memory_gib = 0.5", "512.0 MiB"),
        (streamed, "memory_gib = 0.001", "1.0 MiB"),
    ] {
        let (code, said) = validated(positions, limit);
        assert_eq!(code, Some(2), "{said}");
        for part in ["benchmark_spacing = 0.01", "limits.memory_gib", allowed] {
            assert!(said.contains(part), "{part:?} is not in: {said}");
        }
    }
}

/// A billion cubes of a sphere are made in seconds, and in days 100,000 times.
#[test]
fn a_study_of_more_than_an_hour_is_refused() {
    let refused = |rounds: &str| {
        let fixture = Fixture::new();
        fixture.edit("benchmark_spacing = 0.125", "benchmark_spacing = 0.002");
        fixture.edit("positions = \"accumulated\"", "positions = \"indexed\"");
        fixture.edit_with(|text| {
            let lines =
                text.lines().map(|line| if line.starts_with("short_iterations") { rounds } else { line });
            lines.collect::<Vec<_>>().join("\n")
        });
        (Run::of(isostudy().arg("validate").arg(fixture.config())), fixture.run("study", &[]), fixture)
    };
    let (validated, made, fixture) = refused("short_iterations = 100000");
    for run in [validated, made] {
        assert_eq!(run.code, Some(2), "{}", run.stderr);
        for part in [
            "takes ",
            " hours or more by trials",
            "limits.hours allows 1. ",
            "objects[0].benchmark_spacing = 0.002",
        ] {
            assert!(run.stderr.contains(part), "{part:?} is not in: {}", run.stderr);
        }
    }
    assert!(!fixture.out().exists(), "something was written");
    // Who wants less says so; who wants more, too.
    let fixture = Fixture::new();
    fixture.edit("memory_gib = 8.0", "memory_gib = 8.0\nhours = 1e-6");
    let run = Run::of(isostudy().arg("validate").arg(fixture.config()));
    assert!(run.code == Some(2) && run.stderr.contains("limits.hours allows 0.000001. "), "{}", run.stderr);
    fixture.edit("hours = 1e-6", "hours = 0.0");
    let run = Run::of(isostudy().arg("validate").arg(fixture.config()));
    assert!(run.code == Some(2) && run.stderr.contains("limits.hours"), "{}", run.stderr);
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
    assert!(said.contains("solid.obj") && said.contains("SHA-256"), "{said}");
    assert!(!fixture.out().exists(), "something was written");
    assert_eq!(Run::of(isostudy().arg("validate").arg(fixture.config())).code, Some(2));
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
    assert!(said.contains("objects[0]") && said.contains("isovalue = 50"), "{said}");
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
    // At most thirty lines: short tables, the files of the others, one sentence, and the file to open.
    let lines: Vec<&str> = said.lines().collect();
    assert!(lines.len() <= 30, "{}: {said}", lines.len());
    let [.., found, file] = lines[..] else { panic!("{said}") };
    assert!(file.ends_with("report.html") && !found.trim_end_matches('.').contains(". "), "{said}");
    assert!(found.starts_with("People preferred "), "{said}");
    assert!(said.contains("preference_groups.md") && said.contains("12 rows: "), "{said}");
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

/// A device that ends at once, in place of those that never do and of pipes that nobody writes to.
#[cfg(unix)]
#[test]
fn what_is_no_file_is_not_read() {
    let fixture = Fixture::new();
    let study = fixture.config();
    let (study, null) = (study.to_str().unwrap(), "/dev/null");
    let out = fixture.out().to_str().unwrap();
    let link = fixture.folder().join("device.ply");
    std::os::unix::fs::symlink(null, &link).unwrap();
    let link = link.to_str().unwrap();
    let surface = fixture.folder().join("surface.ply");
    let surface = surface.to_str().unwrap();
    let refused: [&[&str]; 8] = [
        &["validate", null],
        &["convert", null, "--to", "long", "--out", out],
        &["convert", study, "--to", "long", "--mapping", null, "--out", out],
        &["analyse", null, "--out", out],
        &["analyse", study, "--responses", null, "--out", out],
        &["bench", "import", null, "--source", "x", "--iterations", "1", "--threads", "1", "--out", out],
        &["bench", "compare", null, null],
        &["extract", "--mesh", link, "--out", surface],
    ];
    for words in refused {
        let Run { code, stderr: said, .. } = Run::of(isostudy().args(words));
        assert!(code == Some(2) && said.contains(": not a file, but a device"), "{words:?}: {said}");
    }
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

/// Two study files of one id would write one folder: the second is refused with both names, wherever its results go by default.
#[test]
fn two_studies_of_one_id_do_not_write_over_each_other() {
    let folder = Folder::new();
    let run = |arguments: &[&str]| Run::of(folder.isostudy().args(arguments));
    assert_eq!(run(&["new", "my-study"]).code, Some(0));
    let second = run(&["new", "My Study"]);
    assert!(second.stderr.contains("my-study/study.toml has the id my-study"), "{}", second.stderr);
    assert!(folder.read("My Study/study.toml").contains("id = \"my-study-2\""));

    std::fs::create_dir_all(folder.path("other/cpu")).unwrap();
    for file in ["study.toml", "cpu/x86-64-v3.toml"] {
        std::fs::copy(folder.path("my-study").join(file), folder.path("other").join(file)).unwrap();
    }
    let makes: [&[&str]; 2] = [
        &["extract", "STUDY", "--only", "torus_bi"],
        &["design", "power", "STUDY", "--studies", "100", "--participants", "6"],
    ];
    for make in makes {
        let of = |study: &str| {
            let arguments: Vec<&str> =
                make.iter().map(|word| if *word == "STUDY" { study } else { word }).collect();
            run(&arguments)
        };
        let first = of("my-study/study.toml");
        assert_eq!(first.code, Some(0), "{}", first.stderr);
        let results = folder.path("results");
        let before = files(&results);
        let refused = of("other/study.toml");
        assert_eq!(refused.code, Some(2), "{}", refused.stderr);
        for part in
            ["results of my-study/study.toml, not of other/study.toml", "study.id", "--out", ".stages/study"]
        {
            assert!(refused.stderr.contains(part), "{part}: {}", refused.stderr);
        }
        assert_eq!(files(&results), before);
        assert_eq!(of("my-study/study.toml").code, Some(0));
    }
    // What was moved keeps its results.
    std::fs::rename(folder.path("my-study/study.toml"), folder.path("my-study/renamed.toml")).unwrap();
    let moved = run(&["extract", "my-study/renamed.toml", "--only", "torus_bi"]);
    assert!(moved.code == Some(0) && moved.stderr.contains("which is gone"), "{}", moved.stderr);
    assert_eq!(run(&["extract", "other/study.toml", "--only", "torus_bi"]).code, Some(2));
}
