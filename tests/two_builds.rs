//! `isostudy bench ab` and `bench count`: two builds, by time, by CPU time and by instructions.

use crate::command;
use crate::command::Run;
use crate::fixture::Fixture;
use serde_json::Value;

fn isostudy(arguments: &[&str]) -> Run {
    Run::of(command::isostudy().args(arguments).current_dir(std::env::temp_dir()))
}

/// Both programs are this one, the new one with a slowdown of four times its time planted: that is found on any machine.
#[cfg(unix)]
#[test]
fn a_planted_slowdown_is_found_between_two_programs() {
    use std::os::unix::fs::PermissionsExt;
    let fixture = Fixture::new();
    let this = env!("CARGO_BIN_EXE_isostudy");
    let slow = fixture.folder().join("slow");
    std::fs::write(&slow, format!("#!/bin/sh\nISOSTUDY_PLANTED_SLOWDOWN=4 exec '{this}' \"$@\"\n")).unwrap();
    std::fs::set_permissions(&slow, std::fs::Permissions::from_mode(0o755)).unwrap();
    let (config, out) = (fixture.config(), fixture.out().to_owned());
    let ab = |programs: [&str; 2], more: &[&str]| {
        let start = [
            "bench",
            "ab",
            programs[0],
            programs[1],
            config.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
        ];
        let short = ["--only", "ss_bi", "--only", "as_bi", "--seconds", "2", "--processes", "8"];
        isostudy(&[&start[..], &short, more].concat())
    };
    let slow = slow.to_str().unwrap();
    let found = ab([this, slow], &[]);
    assert_eq!(found.code, Some(1), "{}{}", found.stdout, found.stderr);
    assert!(found.stdout.lines().count() <= 10, "{}", found.stdout);
    let run: Value = serde_json::from_slice(&std::fs::read(out.join("bench/ab/ab.json")).unwrap()).unwrap();
    assert_eq!((&run["schema"], &run["processes"]), (&1.into(), &8.into()));
    for pair in run["pairs"].as_array().unwrap() {
        assert_eq!(
            (&pair["old"]["id"], &pair["old"]["iteration"]),
            (&pair["new"]["id"], &pair["new"]["iteration"])
        );
    }
    let again = ab([this, slow], &["--format", "json"]);
    assert!(again.stderr.contains("up to date"), "{}", again.stderr);
    let json: Value = serde_json::from_str(&again.stdout).unwrap();
    assert_eq!((&json["exit_status"], &json["same_program"]), (&1.into(), &false.into()));
    let all = &json["rows"][0];
    assert_eq!(
        (&all["quantity"], &all["id"], &all["verdict"]),
        (&"time".into(), &Value::Null, &"slower".into())
    );
    let ratio = all["ratio"].as_f64().unwrap();
    assert!((3.0..8.0).contains(&ratio), "five times as long was planted: {ratio}");
    assert_eq!(ab([slow, this], &[]).code, Some(0), "the other way round it is faster");
    let by_cpu = ab([this, slow], &["--by", "cpu-time"]);
    if cfg!(target_os = "linux") {
        assert_eq!(by_cpu.code, Some(1), "{}", by_cpu.stderr);
        assert!(by_cpu.stdout.contains("CPU time"), "{}", by_cpu.stdout);
    }
    // Nothing tells a millionth.
    assert_eq!(ab([slow, this], &["--must-tell", "0.0001%"]).code, Some(3));
    let missing = ab(["/nowhere/isostudy", this], &[]);
    assert!(missing.code == Some(2) && missing.stderr.contains("/nowhere/isostudy"), "{}", missing.stderr);
}

/// Of two links of the new build one takes five times as long: what one link of two does is no slowdown of the build.
#[cfg(target_os = "linux")]
#[test]
fn what_one_link_does_is_no_slowdown_of_a_build() {
    use std::os::unix::fs::PermissionsExt;
    let fixture = Fixture::new();
    let this = env!("CARGO_BIN_EXE_isostudy");
    let link = |folder: &str, name: &str, slowdown: u32| {
        let folder = fixture.folder().join(folder);
        std::fs::create_dir_all(&folder).unwrap();
        let text = format!(
            "#!/bin/sh\nISOSTUDY_PLANTED_SLOWDOWN={slowdown} exec '{this}' \"$@\"\n# {folder:?} {name}\n"
        );
        std::fs::write(folder.join(name), text).unwrap();
        std::fs::set_permissions(folder.join(name), std::fs::Permissions::from_mode(0o755)).unwrap();
        folder.to_str().unwrap().to_owned()
    };
    let (old, new) = (link("old", "a", 0), link("new", "a", 0));
    link("old", "b", 0);
    link("new", "b", 4);
    let (config, out) = (fixture.config(), fixture.out().to_owned());
    let [config, out] = [&config, &out].map(|path| path.to_str().unwrap());
    let ab = |old: &str, new: &str| {
        let line = ["bench", "ab", old, new, config, "--out", out, "--only", "ss_bi"];
        isostudy(
            &[&line[..], &["--seconds", "1", "--processes", "6", "--by", "cpu-time", "--format", "json"]]
                .concat(),
        )
    };
    let found = ab(&old, &new);
    assert_eq!(found.code, Some(0), "{}{}", found.stdout, found.stderr);
    let json: Value = serde_json::from_str(&found.stdout).unwrap();
    assert_eq!(
        (&json["schema"], &json["links"], &json["same_program"]),
        (&3.into(), &serde_json::json!([2, 2]), &false.into())
    );
    let rows = json["rows"].as_array().unwrap();
    assert!(rows.iter().all(|row| row["verdict"] == "cannot-say"), "{}", found.stdout);
    // CPU time, which other work on the machine adds nothing to: the mean of logarithms of once and of five times.
    let all = rows.iter().find(|row| row["quantity"] == "cpu-time").unwrap();
    let ratio = all["ratio"].as_f64().unwrap();
    assert!((1.8..2.8).contains(&ratio), "the square root of 5: {ratio}");
    // The slow link alone is slow.
    let slow = format!("{new}/b");
    let found = ab(this, &slow);
    assert_eq!(found.code, Some(1), "{}{}", found.stdout, found.stderr);
    link("new", "c", 0);
    let uneven = ab(&old, &new);
    assert!(uneven.code == Some(2) && uneven.stderr.contains("has 2 links and"), "{}", uneven.stderr);
    let empty = fixture.folder().join("empty");
    std::fs::create_dir(&empty).unwrap();
    let empty = ab(this, empty.to_str().unwrap());
    assert!(empty.code == Some(2) && empty.stderr.contains("it is empty"), "{}", empty.stderr);
}

/// Instructions of one program hardly differ from its own; a method that does more takes more.
#[test]
fn instructions_are_counted_by_valgrind() {
    if std::process::Command::new("valgrind").arg("--version").output().is_err() {
        return eprintln!("SKIPPED: NO VALGRIND - no instructions were counted");
    }
    let fixture = Fixture::new();
    let this = env!("CARGO_BIN_EXE_isostudy");
    let (config, out) = (fixture.config(), fixture.out().to_owned());
    let line = ["bench", "count", this, this, config.to_str().unwrap(), "--out", out.to_str().unwrap()];
    let counted = isostudy(&[&line[..], &["--only", "ss_su", "--only", "ss_bi", "--all"]].concat());
    assert_eq!(counted.code, Some(0), "{}{}", counted.stdout, counted.stderr);
    assert!(counted.stdout.contains("No configuration takes +1.0 % more."), "{}", counted.stdout);
    let run: Value =
        serde_json::from_slice(&std::fs::read(out.join("bench/count/count.json")).unwrap()).unwrap();
    let count = |row: usize, of: &str| run["rows"][row][of].as_f64().unwrap();
    for row in 0..2 {
        let ratio = count(row, "new") / count(row, "old");
        assert!((ratio - 1.0).abs() < 0.002, "{ratio}");
    }
    // Two lattices, one of which has twice the points.
    let of =
        |id: &str| (0..2).find(|&row| run["rows"][row]["id"] == id).map(|row| count(row, "old")).unwrap();
    assert!(of("ss_bi") > of("ss_su"), "{run}");
}
