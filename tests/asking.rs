//! The questionnaire as a researcher makes it and as participants get it.

use crate::command::{Run, isostudy};
use crate::fixture::{Fixture, files};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::Path;

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

#[test]
fn a_design_is_judged_before_anyone_answers() {
    let check = |study: &str, arguments: &[&str]| {
        let run = Run::of(isostudy().args(["design", "check", study]).args(arguments));
        (run.code, run.stdout, run.stderr)
    };
    let fixture = Fixture::balanced();
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
    assert!(code == Some(2) && said.contains("[forms]"), "{said}");
}

/// What participants are given is judged, and the camera that each side was really made with.
#[test]
fn finished_files_are_judged() {
    let fixture = Fixture::balanced();
    fixture.succeed("bundle", &[]);
    let faults = || -> Vec<(String, String, String)> {
        let check = ["design", "check", "--json", "--results"];
        let run = Run::of(isostudy().args(check).args([fixture.out(), &fixture.config()]));
        let found: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
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

/// Animations of an older study file are judged, and said to be that.
#[test]
fn outdated_animations_are_said_to_be() {
    let fixture = Fixture::balanced();
    fixture.succeed("pairs", &[]);
    let check = || {
        let words = [fixture.config(), "--results".into(), fixture.out().into()];
        let run = Run::of(isostudy().args(["design", "check"]).args(words));
        // The paper's cameras stand far away, and participants are told little of their rights: other matters.
        let is_other = |line: &&str| {
            let is_asked =
                line.starts_with("forms.") && line.contains(" is missing: participants are not told ");
            !is_asked && !line.starts_with("the box round the object takes less than half of a frame")
        };
        (run.code, run.stderr.lines().filter(is_other).map(|line| format!("{line}\n")).collect::<String>())
    };
    assert_eq!(check(), (Some(0), String::new()));
    fixture.edit("frames = 12", "frames = 10");
    let (code, said) = check();
    assert!(
        code == Some(0) && said.starts_with("18 of 18 animations in ") && said.contains("other settings"),
        "{said}"
    );
    // Colours that one side was made with alone.
    fixture.edit("frames = 10", "frames = 12");
    fixture.edit("lit = [0.949, 0.553, 0.027]", "lit = [0.573, 0.659, 0.027]");
    fixture.succeed("turntable", &["--only", "ss_bu"]);
    let (code, said) = check();
    assert!(code == Some(1) && said.starts_with("17 of 18 animations in "), "{said}");
}

/// The published designs need no mesh to be judged, which a fresh clone has not got.
#[test]
fn a_design_is_judged_without_meshes() {
    let fixture = Fixture::balanced();
    fixture.edit("solid.obj", "nothing.obj");
    let run = |verb: &str, words: &[&str]| {
        Run::of(isostudy().args(["design", verb]).arg(fixture.config()).args(words))
    };
    let out = fixture.out().to_str().unwrap();
    assert_eq!(run("check", &["--results", out]).code, Some(0));
    assert_eq!(run("power", &["--studies", "100", "--participants", "6", "--out", out]).code, Some(0));
    let Run { code, stderr, .. } = fixture.run("bundle", &[]);
    assert!(code == Some(2) && stderr.contains("nothing.obj"), "{stderr}");
}

/// Faults are said and nothing is bundled, unless they are accepted; a study without forms is named.
#[test]
fn a_faulty_design_is_not_bundled() {
    let fixture = Fixture::balanced();
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
    assert!(code == Some(2) && stderr.contains("study.toml: no [forms]"), "{stderr}");
}

/// Turntables that are wider than high are so in the contact sheet.
#[test]
fn the_contact_sheet_keeps_proportions() {
    let height = |edit: bool| {
        let fixture = Fixture::balanced();
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
        let mut command = isostudy();
        let run = Run::of(command.args(["design", arguments[0]]).arg(&config).args(&arguments[1..]));
        (run.code, run.stdout, run.stderr)
    };
    let (code, said, _) = run(&["check", "--results", out.path().to_str().unwrap()]);
    assert!(code == Some(0) && said.ends_with(": no faults\n"), "{said}");

    let folder = out.path().to_str().unwrap();
    let power = |more: &[&str]| {
        let (code, said, warned) = run(&[&["power", "--studies", "200", "--out", folder], more].concat());
        assert_eq!(code, Some(0), "{warned}");
        (said, warned, std::fs::read_to_string(out.path().join("power.csv")).unwrap())
    };
    let column = |table: &str, name: &str, rows: &[(&str, &str)]| -> Vec<f64> {
        let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let head = lines.next().unwrap();
        let place = |name: &str| head.iter().position(|&column| column == name).unwrap();
        let own = lines.filter(|row| rows.iter().all(|(name, value)| row[place(name)] == *value));
        own.map(|row| row[place(name)].parse().unwrap()).collect()
    };
    let (said, warned, table) = power(&["--participants", "48,6"]);
    assert!(
        said.contains("| N = 6 ") && said.contains("| N = 48 ") && said.contains("| N for 0.8 "),
        "{said}"
    );
    assert!(warned.contains("no answers to estimate it from"), "{warned}");
    let powers =
        |table: &str, name: &str, n: &str| column(table, name, &[("participants", n), ("share", "0.77")]);
    // Three contrasts, all answers and each of two objects, and two questions.
    let judged = powers(&table, "power_corrected", "6");
    assert_eq!(judged.len(), 5);
    let many = powers(&table, "power_corrected", "48");
    assert!(judged.iter().zip(&many).all(|(few, many)| few + 0.3 < *many), "{table}");
    let alone = powers(&table, "power_uncorrected", "6");
    assert!(judged.iter().zip(&alone).all(|(judged, alone)| judged <= alone) && judged != alone, "{table}");
    assert!(out.path().join("power.png").is_file() && out.path().join("power.svg").is_file());
    // A liking for a side hides preferences; so does a spread between people.
    let (_, _, table) = power(&["--participants", "6,48", "--side-bias", "0,2", "--spread", "1"]);
    let found = |side: &str| {
        column(&table, "power_corrected", &[("participants", "48"), ("share", "0.77"), ("side_bias", side)])
    };
    assert!(found("0").iter().zip(found("2")).all(|(without, with)| with + 0.05 < *without), "{table}");
    assert_eq!(found("0"), many);
    // Nine people each wholly for one and nine for the other are spread further than 18 who toss coins.
    let answers = out.path().join("answers.csv");
    let spread = |choice: &dyn Fn(usize, usize) -> bool| {
        let mut text = "participant,question,left,right,choice\n".to_owned();
        for (person, question) in (0..18).flat_map(|person| (1..=2).map(move |question| (person, question))) {
            let object = ["ss", "as"][question - 1];
            let choice = if choice(person, question) { "left" } else { "right" };
            text += &format!("p{person},Q{question},{object}_bu,{object}_bi,{choice}\n");
        }
        std::fs::write(&answers, text).unwrap();
        let path = answers.to_str().unwrap();
        let (_, warned, _) = power(&["--participants", "6", "--spread-of", path]);
        let line =
            warned.lines().find(|line| line.starts_with("spread between people: ")).unwrap().to_owned();
        assert!(line.contains("18 participants") && line.contains(path), "{line}");
        line.split(' ').nth(3).unwrap().parse::<f64>().unwrap()
    };
    assert!(spread(&|person, _| person % 2 == 0) > spread(&|person, q| (person / q).is_multiple_of(2)) + 1.0);
    for (wrong, place) in [
        ("--shares=1.5", "above 0 and below 1"),
        ("--person-sd=-1", "0 to 100"),
        ("--side-bias=99", "-20 to 20"),
        ("--studies=3", "100.."),
    ] {
        let (code, _, said) = run(&["power", wrong]);
        assert!(code == Some(2) && said.contains(place), "{said}");
    }
}

/// What can be told of a file without looking at its pictures tells nothing of what it shows.
#[test]
fn a_bundle_tells_nothing_of_the_key() {
    let fixture = Fixture::balanced();
    fixture.succeed("bundle", &[]);
    let bundle = fixture.out().join("bundle");
    let made = files(&bundle);
    assert_eq!(made.len(), 13 + 2 * 27 + 2, "{:?}", made.keys());
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
    assert!(said.contains("ffmpeg"), "{said}");
    assert!(!fixture.out().exists(), "nothing is made before");

    // A stand-in that keeps how many bytes it was sent, and writes that as the video.
    #[cfg(unix)]
    {
        let script = "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\nfor last; do :; done\nwc -c > \"$last\"\n";
        let path = fixture.with_ffmpeg(script);
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
fn a_video_has_twice_the_size_of_its_turntables_says_its_colours_and_is_the_same_anywhere() {
    for (scale, filter) in [(1, "scale=iw*2:ih*2:"), (2, "scale=iw*1:ih*1:")] {
        let fixture = Fixture::new();
        fixture.edit("pair_scale = 1", &format!("pair_scale = {scale}"));
        let script = "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\nfor last; do :; done\ncat > /dev/null\necho \"$@\" > \"$last\"\n";
        let path = fixture.with_ffmpeg(script);
        let output = fixture.command("pairs").arg("--mp4").env("PATH", path).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let made = files(fixture.out());
        let asked = made.iter().find(|(path, _)| path.ends_with(".mp4")).unwrap().1;
        let asked = String::from_utf8_lossy(asked);
        for part in [
            filter,
            // As many threads as there are cores would make other bytes on other machines.
            " -c:v libx264 ",
            " -threads 1 ",
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
    let fixture = Fixture::balanced();
    let script = "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\n[ \"$3\" = -encoders ] && echo libx264 && exit 0\n\
        for last; do :; done\ncksum > \"$last\"\nhead -c $(($$ % 50)) /dev/zero >> \"$last\"\n";
    let path = fixture.with_ffmpeg(script);
    let output = fixture.command("bundle").arg("--mp4").env("PATH", &path).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let made = files(&fixture.out().join("stimuli/web"));
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
    // Not asked for, they go, which is said.
    let said = fixture.succeed("bundle", &[]).stderr;
    assert!(said.contains("56 videos"), "{said}");
    assert!(files(&folder).keys().all(|name| name.ends_with(".gif")));
    assert!(files(&fixture.out().join("stimuli/web")).is_empty());
    // With another seed, names are those of other pairs: no video of before is left beside them.
    let output = fixture.command("pairs").arg("--mp4").env("PATH", path).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(files(&fixture.out().join("stimuli/pairs")).keys().any(|name| name.ends_with(".mp4")));
    fixture.edit("seed = 2026", "seed = 2027");
    fixture.succeed("pairs", &[]);
    assert!(files(&fixture.out().join("stimuli/pairs")).keys().all(|name| name.ends_with(".gif")));
}

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

/// Where pairs are too many bytes, each is made small enough, and said to be; without an ffmpeg too.
#[test]
fn a_bundle_for_the_web_keeps_to_what_a_participant_may_load() {
    let fixture = Fixture::balanced();
    fixture.edit("page_scale = 1", "page_scale = 1\nweb_mb = 1");
    fixture.edit("width = 96", "width = 160");
    fixture.edit("height = 96", "height = 160");
    let output = fixture.command("bundle").env("PATH", fixture.folder()).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    let shown = 33;
    let bundle = files(&fixture.out().join("bundle/stimuli"));
    let own = files(&fixture.out().join("stimuli/pairs"));
    let bytes = bundle.values().map(Vec::len).max().unwrap();
    assert!(own.values().any(|pair| pair.len() * shown > 1_000_000), "as they are they would be too much");
    assert!(bundle.len() == 56 && bytes * shown <= 1_000_000, "{bytes}");
    assert!(bundle.values().all(|pair| pair.len() == bytes), "sizes tell nothing");
    assert!(said.contains("forms.web_mb = 1") && said.contains("ffmpeg"), "{said}");
    assert!(said.contains(&format!(" {:.1} MB", (bytes * shown) as f64 / 1e6)), "{said}");
    assert!(!said.contains("warning: "), "{said}");
}
