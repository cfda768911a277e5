//! What fails by itself is left out by name, and the others go on: programs that crash, hang or answer with nonsense, and fronts.

use crate::any_method::Study;
use crate::command::{Folder, Run};
use isostudy_mesh::MeshFormat;
use isostudy_mesh::topology::topology;
use std::collections::BTreeSet;
use std::fs;

/// A front closes a ball, and its mesh, its record and its file say so; on a box whose edges it cannot follow it is left out by name, with
/// the place, and cubes go on.
#[test]
fn a_front_that_fails_is_left_out_by_name() {
    let folder = Folder::new();
    folder.write("cpu.toml", include_str!("../configs/cpu/x86-64-v3.toml"));
    folder.write("study.toml", include_str!("left_out/fronts.toml"));
    let ran = folder.run(&["study", "study.toml", "--out", "out"]);
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    for part in [
        "te_front failed and is left out",
        "the front could not be closed at (",
        "failed and left out: te_front",
    ] {
        assert!(ran.stderr.contains(part), "{part}: {}", ran.stderr);
    }
    let mesh = fs::read(folder.path("out/meshes/benchmark/ba_front.ply")).unwrap();
    let mesh = MeshFormat::Ply.read(&*mesh).unwrap();
    let report = topology(&mesh);
    assert!(report.is_closed_manifold() && report.euler_characteristic == 2, "{report:?}");
    let off = mesh.positions.iter().map(|p| (p.length() - 0.8).abs()).fold(0.0, f32::max);
    assert!(off < 1e-4, "{off}");
    let record: serde_json::Value =
        serde_json::from_str(&folder.read("out/meshes/benchmark/ba_front.json")).unwrap();
    assert_eq!(record["quality"]["triangles"], mesh.triangles.len());
    assert!(record["counts"]["evaluations"].as_u64().unwrap() > mesh.positions.len() as u64);
    let benchmark = folder.read("out/tables/benchmark.csv");
    assert!(benchmark.contains("\nba_front,") && !benchmark.contains("\nte_front,"), "{benchmark}");
    assert!(benchmark.contains("\nte_mc,"), "{benchmark}");
    assert!(folder.read("out/index.html").contains("Nothing is said about te_front, which failed."));
    assert!(folder.read("out/tables/left_out.csv").contains("te_front,"));
    assert!(!folder.path("out/meshes/benchmark/te_front.ply").exists());
}

/// A program that crashes, hangs or answers with nonsense fails by name; the others go on, and the exit code says so.
#[test]
fn a_program_that_fails_is_left_out_by_name() {
    for (program, told) in [
        (
            "import time\nprint('{\"ready\": {\"name\": \"x\", \"version\": \"1\"}}', flush=True)\ntime.sleep(60)\n",
            "5 s",
        ),
        ("print('hello', flush=True)\ninput()\n", "`hello`"),
    ] {
        left_out(program, told, "extract");
    }
    let told = "ended with code 3";
    let folder = left_out("import sys\nsys.exit(3)\n", told, "study");
    let benchmark = folder.table("out/tables/benchmark.csv");
    let ids: BTreeSet<&str> = benchmark[1..].iter().map(|row| row[0].as_str()).collect();
    assert!(ids.contains("fo_bi") && !ids.contains("fo_program"), "{ids:?}");
    let left_out = folder.table("out/tables/left_out.csv");
    let ids: Vec<&str> = left_out[1..].iter().map(|row| row[0].as_str()).collect();
    assert_eq!(ids, ["fo_program", "te_program", "vo_program"]);
    assert!(left_out[1][1].contains(told), "{left_out:?}");
    let page = std::fs::read_to_string(folder.path("out/index.html")).unwrap();
    assert!(
        page.contains("Nothing is said about fo_program, te_program and vo_program, which failed."),
        "{told}"
    );
    // Every picture that the page names is there.
    let page = page.replace("&#x2f;", "/");
    let sources = page.split("src=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    let missing: Vec<&str> = sources.filter(|file| !folder.path(&format!("out/{file}")).exists()).collect();
    assert_eq!(missing, [""; 0], "{told}");
    let bundle = folder.run(&["bundle", "study.toml", "--out", "out", "--allow-programs"]);
    assert_eq!(bundle.code, Some(2), "{}", bundle.stderr);
}

/// Runs the study's meshes, or all of it, with a program that fails; others are made, and the exit code and the words say who is not.
fn left_out(program: &str, told: &str, command: &str) -> Study {
    let folder = Study::new();
    folder.write("example.py", program);
    // Enough to start Python beside other work.
    folder.edit("time_limit_s = 60", "time_limit_s = 5");
    // Of meshes alone, the program's and one that goes on: measuring the others takes most of the time.
    let only = ["fo_program", "te_program", "vo_program", "fo_bi"].map(|id| ["--only", id]).concat();
    let only = if command == "extract" { &only[..] } else { &[] };
    let ran = folder.run(&[&[command, "study.toml", "--out", "out", "--allow-programs"], only].concat());
    assert_eq!(ran.code, Some(1), "{program}: {}", ran.stderr);
    assert!(ran.stderr.contains("fo_program failed") && ran.stderr.contains(told), "{told}: {}", ran.stderr);
    assert!(ran.stderr.contains("failed and left out: fo_program, te_program, vo_program"), "{}", ran.stderr);
    assert!(folder.path("out/meshes/benchmark/fo_bi.json").exists());
    assert!(!folder.path("out/meshes/benchmark/fo_program.json").exists());
    folder
}

/// A program that crashes in the middle of the benchmark loses its own times and nobody else's; and one is inspected and swept like an
/// extractor of ours.
#[test]
fn a_program_that_fails_while_it_is_timed_is_left_out_of_the_times() {
    let number = |text: &str| text.parse::<f64>().unwrap();
    let folder = Study::new();
    let example = fs::read_to_string(folder.path("example.py")).unwrap();
    let from = "    request = json.loads(line)\n";
    assert!(example.contains(from));
    // A process of the meshes is asked once; one of the benchmark more often.
    let crash = format!("{from}    if request[\"id\"] == 2 and request[\"size\"][2] < 13: sys.exit(3)\n");
    folder.write("example.py", example.replacen(from, &crash, 1));
    let line = ["study", "study.toml", "--out", "out", "--allow-programs"];
    for time in 0..2 {
        let ran = folder.run(&line);
        assert_eq!(ran.code, Some(1), "{}", ran.stderr);
        assert!(ran.stderr.contains("failed and left out: fo_program, te_program"), "{time}: {}", ran.stderr);
        assert!(ran.stderr.contains("ended with code 3"), "{time}: {}", ran.stderr);
        let samples = folder.table("out/bench/short/samples.csv");
        let times = |id: &str| samples.iter().filter(|row| row[0] == id).count();
        assert_eq!((times("fo_bi"), times("vo_program"), times("fo_program")), (2, 2, 0), "{samples:?}");
        // A program's own time (the eighth column) lies within the time from outside (the last), which others have not.
        for row in &samples[1..] {
            match row[0] == "vo_program" {
                true => assert!(number(&row[19]) >= number(&row[7]) && number(&row[7]) > 0.0, "{row:?}"),
                false if !row[0].ends_with("_program") => assert_eq!(row[19], "", "{row:?}"),
                false => {}
            }
        }
    }
    assert!(folder.path("out/meshes/stimulus/fo_program.ply").exists());

    let inspect = ["inspect", "vo_program", "--study", "study.toml", "--iterations", "2", "--json"];
    // Somebody else has allowed nothing yet.
    let mut other = folder.isostudy();
    let refused = Run::of(other.args(inspect).env("XDG_STATE_HOME", folder.path("of-another")));
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("--allow-programs"), "{}", refused.stderr);
    let panel: serde_json::Value =
        serde_json::from_str(&folder.succeed(&[&inspect[..], &["--allow-programs"]].concat()).stdout)
            .unwrap();
    let record: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path("out/meshes/benchmark/vo_program.json")).unwrap())
            .unwrap();
    assert_eq!(panel["mesh"]["counts"], record["counts"]);
    assert_eq!(panel["iterations"], 2);
    assert!(panel["times"][6]["median"].as_f64().unwrap() > 0.0);
    // One with a budget has the spacing that the study found for it.
    let budget = ["inspect", "fo_fp", "--study", "study.toml", "--iterations", "1", "--json"];
    let panel: serde_json::Value = serde_json::from_str(&folder.succeed(&budget).stdout).unwrap();
    let record: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path("out/meshes/benchmark/fo_fp.json")).unwrap()).unwrap();
    assert_eq!(panel["mesh"]["spacing"], record["spacing"]);
    assert_ne!(panel["mesh"]["spacing"], 0.1);
    // A mesh that was made by hand is measured, and has no time.
    let artist = folder.succeed(&["inspect", "vo_artist", "--study", "study.toml"]).stdout;
    assert!(artist.contains("timing: none, the mesh was read from a file"), "{artist}");
}

/// A mesh with a hole is told of once, by whichever process reads it first; and a program that fails at its third call is left out of a
/// benchmark by name, while the others' rounds go on to the end.
#[test]
fn a_program_that_fails_at_its_third_call_is_left_out_of_a_benchmark() {
    let folder = Study::new();
    folder.edit(
        "{ kind = \"formula\", text = \"sqrt((sqrt(x^2 + y^2) - 0.6)^2 + z^2) - 0.25\" }",
        "{ kind = \"mesh\", file = \"open.obj\" }",
    );
    // An octahedron without one of its sides.
    folder.write(
        "open.obj",
        "v 0.6 0 0\nv -0.6 0 0\nv 0 0.3 0\nv 0 -0.3 0\nv 0 0 0.4\nv 0 0 -0.4\n\
         f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\n",
    );
    let example = fs::read_to_string(folder.path("example.py")).unwrap();
    let from = "    request = json.loads(line)\n";
    let words = "no third time";
    let crash =
        format!("{from}    if request[\"id\"] == 3 and request[\"size\"][2] < 13: sys.exit(\"{words}\")\n");
    folder.write("example.py", example.replacen(from, &crash, 1));
    folder.edit("iterations = 2", "iterations = 4");
    let only = ["fo_bi", "fo_fp", "fo_program", "vo_bi", "vo_program"];
    let only: Vec<&str> = only.iter().flat_map(|id| ["--only", id]).collect();
    let times = |text: &str, hole: &str| text.matches(hole).count();
    let closed = "open.obj: 1 hole was closed";

    let this = env!("CARGO_BIN_EXE_isostudy");
    let short = ["--seconds", "1", "--processes", "3", "--allow-programs"];
    let ab = [&["bench", "ab", this, this, "study.toml", "--out", "out"][..], &only, &short].concat();
    for time in 0..2 {
        let ran = folder.run(&ab);
        assert_eq!(ran.code, Some(1), "{}{}", ran.stdout, ran.stderr);
        assert!(ran.stderr.contains(words), "{time}: what it said: {}", ran.stderr);
        assert!(ran.stderr.contains("failed and left out: fo_program\n"), "{time}: {}", ran.stderr);
        assert!(ran.stdout.contains("Failed and left out: fo_program."), "{time}: {}", ran.stdout);
        assert!(ran.stdout.contains("4 configurations in 3 pairs of processes"), "{time}: {}", ran.stdout);
        // The second run finds everything up to date and reads no mesh.
        assert!(times(&ran.stderr, closed) <= 1, "{}", ran.stderr);
        assert!(time == 1 || times(&ran.stderr, closed) == 1, "{}", ran.stderr);
    }
    let run: serde_json::Value = serde_json::from_str(&folder.read("out/bench/ab/ab.json")).unwrap();
    let pairs = run["pairs"].as_array().unwrap();
    let of = |id: &str| pairs.iter().filter(|pair| pair["old"]["id"] == id).count();
    assert!(of("fo_program") == 0 && of("vo_program") >= 3 * 3, "{run}");
    assert_eq!(of("fo_bi"), of("vo_program"));
    assert_eq!(run["failed"][0]["id"], "fo_program");
    assert!(run["failed"][0]["reason"].as_str().unwrap().contains(words));
    let table = folder.read("out/bench/ab/bench_ab.md");
    assert!(table.contains("failed and is left out: asked by ") && table.contains(words), "{table}");
    let json = folder.run(&[&ab[..], &["--format", "json"]].concat());
    let json: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!((&json["exit_status"], &json["failed"][0]["id"]), (&1.into(), &"fo_program".into()));

    let ran = folder.run(&[&["bench", "study.toml", "--out", "out", "--allow-programs"][..], &only].concat());
    assert_eq!(ran.code, Some(1), "{}{}", ran.stdout, ran.stderr);
    assert_eq!(times(&ran.stderr, closed), 1, "{}", ran.stderr);
    assert!(ran.stderr.contains("failed and left out: fo_program\n"), "{}", ran.stderr);
    let run: serde_json::Value = serde_json::from_str(&folder.read("out/bench/selected/run.json")).unwrap();
    let of = |id: &str| run["samples"].as_array().unwrap().iter().filter(|sample| sample["id"] == id).count();
    assert_eq!((of("fo_program"), of("vo_program"), of("fo_bi")), (0, 4, 4), "{}", run["failed"]);
    let told = ran.stdout.replace('\\', "");
    assert!(told.contains("| vo_program |") && !told.contains("| fo_program |"), "{told}");
}
