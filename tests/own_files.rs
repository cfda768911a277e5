//! Studies whose stimuli are files of their own: pictures, films and meshes, from the file to the report.

use crate::command::{Folder, Run};
use crate::fixture::files;
use isostudy_raster::Film;
use std::collections::{BTreeMap, BTreeSet};

/// Three methods on two objects, asked about on one form; `{ending}` is that of the files.
const STUDY: &str = r#"schema = 1
[study]
id = "own"
title = "Three renderers"
seed = 5

[[objects]]
id = "room"
name = "Room"
[[objects]]
id = "street"
name = "Street"

[[methods]]
id = "a"
label = "Renderer A"
[[methods]]
id = "b"
label = "Renderer B"
[[methods]]
id = "c"
label = "Renderer C"

[stimuli]
duration_s = 0.4
files = [
    { configuration = "room_a", file = "room_a.{ending}" },
    { configuration = "room_b", file = "room_b.{ending}" },
    { configuration = "room_c", file = "room_c.{ending}" },
    { configuration = "street_a", file = "street_a.{ending}" },
    { configuration = "street_b", file = "street_b.{ending}" },
    { configuration = "street_c", file = "street_c.{ending}" },
]

[[comparisons]]
question = "Q1"
left = "room_a"
right = "room_b"
[[comparisons]]
question = "Q2"
left = "room_a"
right = "room_c"
[[comparisons]]
question = "Q3"
left = "room_b"
right = "room_c"
[[comparisons]]
question = "Q4"
left = "street_a"
right = "street_b"
[[comparisons]]
question = "Q5"
left = "street_a"
right = "street_c"
[[comparisons]]
question = "Q6"
left = "street_b"
right = "street_c"

[[groups]]
id = "all"
label = "Renderers"
members = ["a", "b", "c"]

[forms]
prompt = "Which picture looks more real to you?"
consent = "You will see pairs of pictures and say which looks more real. You can stop at any time."
instructions = "Look at both pictures, then say which looks more real."
participants = 12
sides = "balanced"
order = "shuffled"
names = "code-names"
controls = 0
repeats = 0
max_questions = 6
contact = "lab@example.org"
ethics = "Board 7"
least_age = 18
retention_days = 365
"#;

const NAMES: [&str; 6] = ["room_a", "room_b", "room_c", "street_a", "street_b", "street_c"];

/// So many frames in a colour of the file's own, with one white pixel that moves.
fn film(of: usize, frames: usize) -> Film {
    let frame = |number: usize| {
        let colour = [40 * of as u8, 100, 200 - 30 * of as u8];
        let mut pixels: Vec<u8> = (0..64 * 48).flat_map(|_| colour).collect();
        pixels[3 * number..3 * number + 3].fill(255);
        pixels
    };
    let duration_s = (frames > 1).then_some(0.4);
    Film { width: 64, height: 48, duration_s, frames: (0..frames).map(frame).collect() }
}

fn study(ending: &str, file: impl Fn(usize) -> Vec<u8>) -> Folder {
    let folder = Folder::new();
    folder.write("study.toml", STUDY.replace("{ending}", ending));
    for (of, name) in NAMES.iter().enumerate() {
        folder.write(&format!("{name}.{ending}"), file(of));
    }
    folder
}

fn run(folder: &Folder, words: &[&str]) -> Run {
    Run::succeed(folder.isostudy().args(words))
}

/// Code names of stimuli by what they show.
fn shown(folder: &Folder) -> BTreeMap<String, [String; 2]> {
    let key = folder.read("out/key/stimuli.csv");
    let lines = key.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
    let of_pairs = lines.filter(|cells| cells[0].starts_with("stimuli/pairs/"));
    of_pairs.map(|cells| (cells[0].to_owned(), [cells[2].to_owned(), cells[3].to_owned()])).collect()
}

/// Everybody presses the method with the planted worth on whichever side it stands: `a` before `b` before `c`.
fn answers(folder: &Folder) -> String {
    let mut csv = "participant,question,left,right,choice\n".to_owned();
    for person in 0..12 {
        for (question, object, [left, right]) in [
            ("Q1", "room", ["a", "b"]),
            ("Q2", "room", ["c", "a"]),
            ("Q3", "room", ["b", "c"]),
            ("Q4", "street", ["b", "a"]),
            ("Q5", "street", ["a", "c"]),
            ("Q6", "street", ["c", "b"]),
        ] {
            // One person in six is of another mind.
            let likes_left = (left < right) != (person % 6 == 0);
            let choice = if likes_left { "left" } else { "right" };
            csv += &format!("p{person},{question},{object}_{left},{object}_{right},{choice}\n");
        }
    }
    folder.write("answers.csv", &csv);
    folder.path("answers.csv").display().to_string()
}

/// What is on each side of a pair's file is the picture that the key names, pixel by pixel; the bundle's files have one size and their names
/// tell nothing.
#[test]
fn still_pictures_are_shown_as_they_are_and_their_answers_analysed() {
    let folder = study("png", |of| film(of, 1).to_png().unwrap());
    let valid = run(&folder, &["validate", "study.toml"]).stdout;
    assert!(valid.contains("street_c  Street, Renderer C, street_c.png\n"), "{valid}");
    run(&folder, &["bundle", "study.toml", "--out", "out", "--with-faults"]);
    let pairs = shown(&folder);
    // Both ways round, and none with itself.
    assert_eq!(pairs.len(), 12);
    for (path, sides) in &pairs {
        let row = Film::from_png(&std::fs::read(folder.path(&format!("out/{path}"))).unwrap()).unwrap();
        let films = sides.each_ref().map(|side| film(NAMES.iter().position(|name| name == side).unwrap(), 1));
        assert_eq!(row, Film::in_a_row(&films).unwrap().unwrap(), "{path}");
    }
    let bundle = files(&folder.path("out/bundle"));
    let pictures: Vec<&String> = bundle.keys().filter(|name| name.ends_with(".png")).collect();
    let sizes: BTreeSet<usize> = pictures.iter().map(|name| bundle[*name].len()).collect();
    assert_eq!((pictures.len(), sizes.len()), (12, 1));
    let script = String::from_utf8_lossy(&bundle["forms.js"]).into_owned();
    assert!(script.contains(r#""kind":"png""#) && script.contains(r#""surface":[64,48]"#), "{script}");
    assert!(!NAMES.iter().any(|name| script.contains(name)));
    // The padding is no part of the picture.
    let first = Film::from_png(&bundle[pictures[0]]).unwrap();
    assert_eq!([first.width, first.height], [128, 48]);

    let csv = answers(&folder);
    run(&folder, &["analyse", "study.toml", "--responses", &csv, "--out", "read"]);
    let report = folder.read("read/report.md");
    assert!(report.contains("**Compared:** 3 methods on 2 objects (Room and Street)."), "{report}");
    assert!(!report.contains("isosurface"), "{report}");
    let worths = folder.read("read/tables/worths.csv");
    let davidson: Vec<&str> = worths.lines().filter(|line| line.contains(",davidson,")).collect();
    assert_eq!(davidson.len(), 3, "{worths}");

    // The same bytes by a run of all, and by jobs.
    run(&folder, &["study", "study.toml", "--out", "whole"]);
    let plan = run(&folder, &["plan", "study.toml", "--json", "--out", "jobs"]).stdout;
    let plan: serde_json::Value = serde_json::from_str(&plan).unwrap();
    for job in plan["jobs"].as_array().unwrap() {
        run(&folder, &["job", "study.toml", job["id"].as_str().unwrap(), "--out", "jobs"]);
        for output in job["outputs"].as_array().unwrap() {
            assert!(folder.path(&format!("jobs/{}", output.as_str().unwrap())).is_file(), "{job}");
        }
    }
    let without = |folder: BTreeMap<String, Vec<u8>>| -> BTreeMap<String, Vec<u8>> {
        folder.into_iter().filter(|(name, _)| name != "manifest.json" && !name.starts_with('.')).collect()
    };
    let (whole, jobs) = (without(files(&folder.path("whole"))), without(files(&folder.path("jobs"))));
    assert_eq!(whole.keys().collect::<Vec<_>>(), jobs.keys().collect::<Vec<_>>());
    assert!(whole.iter().all(|(name, bytes)| jobs[name] == *bytes));
    let page = String::from_utf8_lossy(&whole["index.html"]).into_owned();
    assert!(page.contains(".png\"") && !page.contains("Turntables") && !page.contains(".gif"));
}

#[test]
fn films_keep_their_frames_and_their_time() {
    let folder = study("gif", |of| film(of, 8).to_gif(0.4).unwrap());
    run(&folder, &["pairs", "study.toml", "--out", "out"]);
    for (path, sides) in shown(&folder) {
        let row = Film::from_gif(&std::fs::read(folder.path(&format!("out/{path}"))).unwrap()).unwrap();
        let films = sides.each_ref().map(|side| film(NAMES.iter().position(|name| name == side).unwrap(), 8));
        let wanted = Film::in_a_row(&films).unwrap().unwrap();
        assert_eq!(row.frames, wanted.frames, "{path}");
        assert!((row.duration_s.unwrap() - 0.4).abs() < 1e-9);
    }
    // With ffmpeg, videos are for whoever plays them.
    run(&folder, &["bundle", "study.toml", "--out", "out", "--with-faults"]);
    let bundle = files(&folder.path("out/bundle"));
    let of = |ending: &str| bundle.keys().filter(|name| name.ends_with(ending)).count();
    assert_eq!(of(".gif"), 12);
    if !has_ffmpeg() {
        eprintln!("SKIPPED: NO FFMPEG - no video was tried");
        return;
    }
    assert_eq!(of(".mp4") + of(".webm"), 12);

    // A video comes in as it goes out, within what its codec loses.
    let video = bundle.keys().find(|name| name.ends_with(".mp4") || name.ends_with(".webm")).unwrap();
    let ending = if video.ends_with(".mp4") { "mp4" } else { "webm" };
    let bytes = bundle[video].clone();
    let again = study(ending, |_| bytes.clone());
    run(&again, &["pairs", "study.toml", "--out", "out"]);
    let gif = shown(&again).into_keys().next().unwrap();
    let row = Film::from_gif(&std::fs::read(again.path(&format!("out/{gif}"))).unwrap()).unwrap();
    assert_eq!([row.width, row.height, row.frames.len() as u32], [256, 48, 8]);
    let code = video.trim_start_matches("stimuli/").split('.').next().unwrap().to_owned();
    let sides = &shown(&folder)[&format!("stimuli/pairs/{code}.gif")];
    let films = sides.each_ref().map(|side| film(NAMES.iter().position(|name| name == side).unwrap(), 8));
    let wanted = Film::in_a_row(&films).unwrap().unwrap();
    // Its left half is the pair; the white pixel in the first row is left out.
    for (frame, own) in row.frames.iter().zip(&wanted.frames) {
        for y in 1..48 {
            let (read, meant) = (&frame[3 * 256 * y..][..3 * 128], &own[3 * 128 * y..][..3 * 128]);
            let off = read.iter().zip(meant).map(|(a, b)| a.abs_diff(*b)).filter(|off| *off > 16).count();
            // Chroma is of half the width, so that the middle may bleed.
            assert!(off <= 12, "{off} of {}", read.len());
        }
    }
}

fn has_ffmpeg() -> bool {
    std::process::Command::new("ffmpeg").arg("-version").output().is_ok_and(|run| run.status.success())
}

/// Meshes of one object fill one ball: what is half as large stays half as large.
#[test]
fn meshes_are_drawn_beside_each_other_at_one_scale() {
    let solid = |size: f32| {
        format!("v {size} 0 0\nv -{size} 0 0\nv 0 {size} 0\nv 0 -{size} 0\nv 0 0 {size}\nv 0 0 -{size}\n")
            + "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n"
    };
    let folder = study("obj", |of| solid([4.0, 2.0, 4.0, 1.0, 1.0, 1.0][of]).into_bytes());
    let text = folder.read("study.toml").replace("duration_s = 0.4\n", "");
    folder.write("study.toml", text + "\n[turntable]\nwidth = 48\nheight = 48\nframes = 4\nduration_s = 0.4\nelevation_rad = 0.3\nnear = 0.01\nfar = 100.0\nsupersampling = 1\n");
    run(&folder, &["study", "study.toml", "--out", "out"]);
    let reach = |id: &str| {
        let bytes = std::fs::read(folder.path(&format!("out/meshes/stimulus/{id}.ply"))).unwrap();
        let mesh = isostudy_mesh::read_ply(&bytes[..]).unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (6, 8));
        mesh.positions.iter().map(|p| p.length()).fold(0.0, f32::max)
    };
    // The ball round the box that holds all of an object.
    let whole = 1.0 / 3f32.sqrt();
    for (id, wanted) in [("room_a", whole), ("room_b", whole / 2.0), ("street_c", whole)] {
        assert!((reach(id) - wanted).abs() < 1e-6, "{id}: {}", reach(id));
    }
    let animation = shown(&folder).into_keys().next().unwrap();
    let row = Film::from_gif(&std::fs::read(folder.path(&format!("out/{animation}"))).unwrap()).unwrap();
    assert_eq!([row.width, row.height, row.frames.len() as u32], [96, 48, 4]);
}

#[test]
fn what_cannot_be_shown_is_refused_and_named() {
    let folder = study("png", |of| film(of, 1).to_png().unwrap());
    let refused = |from: &str, to: &str, verb: &str, wanted: &[&str]| {
        let text = STUDY.replace("{ending}", "png");
        assert!(text.contains(from), "{from}");
        folder.write("study.toml", text.replacen(from, to, 1));
        let run = Run::of(folder.isostudy().args([verb, "study.toml", "--out", "refused"]));
        assert_ne!(run.code, Some(0), "{from} -> {to}");
        assert!(wanted.iter().all(|word| run.stderr.contains(word)), "{from} -> {to}: {}", run.stderr);
    };
    refused("room_a.png", "none.png", "pairs", &["line 27: stimuli.files[0].file", "none.png: no such file"]);
    refused(
        "room_a.png",
        "room_a.tif",
        "pairs",
        &["stimuli.files[0].file = room_a.tif", "must end with one of .png"],
    );
    refused(
        "room_a.png",
        "room_a.glb",
        "pairs",
        &["stimuli.files[1].file", "must be of the kind of the first file"],
    );
    refused(
        "\"room_b\", file",
        "\"room_a\", file",
        "pairs",
        &["stimuli.files[1].configuration", "already used"],
    );
    refused("\"street_c\", file", "\"street_d\", file", "pairs", &["street_d", "street_c"]);
    refused(
        "    { configuration = \"street_c\", file = \"street_c.png\" },\n",
        "",
        "pairs",
        &["has no file of street_c"],
    );
    refused(
        "name = \"Room\"",
        "name = \"Room\"\nfield = { kind = \"asteroid\" }",
        "pairs",
        &["missing", "isovalue"],
    );
    refused("[[groups]]", "[benchmark]\n[[groups]]", "pairs", &["benchmark", "must be left out"]);
    refused("consent = ", "# consent = ", "pairs", &["forms.consent", "must be written"]);
    refused("[stimuli]", "[[stills]]\n[stimuli]", "pairs", &["stills", "must be left out"]);
    // What needs meshes says that there are none.
    folder.write("study.toml", STUDY.replace("{ending}", "png"));
    for verb in ["bench", "turntable"] {
        let run = Run::of(folder.isostudy().args([verb, "study.toml", "--out", "refused"]));
        assert_ne!(run.code, Some(0), "{verb}");
        assert!(!run.stderr.contains("panicked") && run.stderr.contains("study"), "{verb}: {}", run.stderr);
    }
    // Files that are not alike.
    let wide = Film { width: 32, height: 96, ..film(2, 1) };
    folder.write("room_c.png", wide.to_png().unwrap());
    let run = Run::of(folder.isostudy().args(["pairs", "study.toml", "--out", "refused"]));
    let said = ["room_a.png has 64 x 48 pixels", "room_c.png has 32 x 96 pixels", "all have to be alike"];
    assert!(said.iter().all(|word| run.stderr.contains(word)), "{}", run.stderr);
    folder.write("room_c.png", b"no picture");
    let run = Run::of(folder.isostudy().args(["pairs", "study.toml", "--out", "refused"]));
    assert!(run.code != Some(0) && run.stderr.contains("room_c.png"), "{}", run.stderr);
}
