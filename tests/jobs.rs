//! A study by jobs: `isostudy plan` and `isostudy job`, as a scheduler runs them.

use crate::command::{Folder, Run};
use crate::fixture::{Fixture, files};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::Duration;

/// How many jobs run at a time.
const AT_ONCE: usize = 3;
/// One job in so many is killed at some moment of its work.
const KILLED: u64 = 4;

struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }
}

fn plan(fixture: &Fixture) -> Vec<Value> {
    let plan: Value = serde_json::from_str(&fixture.succeed("plan", &["--json"]).stdout).unwrap();
    assert_eq!(plan["schema"], 1);
    plan["jobs"].as_array().unwrap().clone()
}

fn id(job: &Value) -> &str {
    job["id"].as_str().unwrap()
}

fn needs(job: &Value) -> Vec<&str> {
    job["needs"].as_array().unwrap().iter().map(|of| of.as_str().unwrap()).collect()
}

/// The stages that have stamps, by name.
fn stages(out: &Path) -> BTreeSet<String> {
    let mut stages = BTreeSet::new();
    for entry in fs::read_dir(out.join(".stages")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "json") {
            let stamp: Value = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
            stages.insert(stamp["stage"].as_str().unwrap().to_owned());
        }
    }
    stages
}

/// What was timed in one run is taken over, for no two runs take the same time.
fn take_times_over(from: &Path, to: &Path) {
    fs::create_dir_all(to.join("bench/short")).unwrap();
    fs::create_dir_all(to.join(".stages")).unwrap();
    for entry in fs::read_dir(from.join("bench/short")).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, to.join("bench/short").join(path.file_name().unwrap())).unwrap();
    }
    fs::copy(from.join(".stages/bench.short.json"), to.join(".stages/bench.short.json")).unwrap();
}

/// Jobs in any order that their needs allow, some at a time; some are killed and done again.
fn by_jobs(fixture: &Fixture, jobs: &[Value], random: &mut Random) -> u64 {
    let mut waiting: Vec<&Value> = jobs.iter().filter(|job| id(job) != "report").collect();
    let mut done: BTreeSet<&str> = BTreeSet::new();
    let mut running: Vec<(&Value, Child)> = Vec::new();
    let mut killed = 0;
    while !waiting.is_empty() || !running.is_empty() {
        let ready: Vec<usize> = (0..waiting.len())
            .filter(|&i| needs(waiting[i]).iter().all(|need| done.contains(need)))
            .collect();
        if running.len() < AT_ONCE && !ready.is_empty() {
            let job = waiting.swap_remove(ready[random.below(ready.len() as u64) as usize]);
            let mut command = fixture.command("job");
            command.arg(id(job)).args(["--threads", "1", "--digests", job["digest"].as_str().unwrap()]);
            command.stdout(Stdio::null()).stderr(Stdio::piped());
            running.push((job, command.spawn().unwrap()));
            continue;
        }
        let (job, mut child) = running.swap_remove(random.below(running.len() as u64) as usize);
        if random.below(KILLED) == 0 {
            std::thread::sleep(Duration::from_millis(random.below(60)));
            // It may have ended before.
            killed += u64::from(child.kill().is_ok());
        }
        let output = child.wait_with_output().unwrap();
        match output.status.code() {
            Some(0) => {
                done.insert(id(job));
            }
            None => waiting.push(job),
            other => panic!("{}: {other:?}: {}", id(job), String::from_utf8_lossy(&output.stderr)),
        }
    }
    killed
}

/// The same files as of one run, whatever order the jobs ran in and whoever was killed; and the plan lists what one run does.
#[test]
fn a_study_by_jobs_is_the_study_in_one_run() {
    let whole = Fixture::new();
    let run = whole.run("study", &[]);
    assert!(run.code.is_some_and(|code| code < 2), "{}", run.stderr);
    let in_parts = Fixture::new();
    let jobs = plan(&in_parts);
    // What follows from the others is one job.
    let follows = ["key", "forms", "tables", "page", "answers", "viewer"];
    let planned: BTreeSet<String> =
        jobs.iter().map(|job| id(job).to_owned()).filter(|id| id != "report").collect();
    let mut made = stages(whole.out());
    made.retain(|stage| !follows.contains(&stage.as_str()) && !stage.starts_with("method_picture/"));
    assert_eq!(planned, made);
    take_times_over(whole.out(), in_parts.out());
    let killed = by_jobs(&in_parts, &jobs, &mut Random(7));
    assert!(killed > 0, "none was killed");
    for job in &jobs {
        for output in job["outputs"].as_array().unwrap() {
            assert!(in_parts.out().join(output.as_str().unwrap()).is_file(), "{}: {output}", id(job));
        }
    }
    let report = in_parts.run("job", &["report"]);
    assert_eq!(report.code, run.code, "{}", report.stderr);
    let [one, other] = [&whole, &in_parts].map(|fixture| files(fixture.out()));
    assert_eq!(one.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>());
    for (path, bytes) in &one {
        assert!(other[path] == *bytes, "{path} differs");
    }
    assert_eq!(stages(whole.out()), stages(in_parts.out()));
    // Nothing is left of those that were killed.
    assert!(other.keys().all(|path| !path.ends_with(".partial")));
}

#[test]
fn what_a_job_may_not_is_refused() {
    let fixture = Fixture::new();
    let jobs = plan(&fixture);
    let refused = |arguments: &[&str], parts: &[&str]| {
        let run = fixture.run("job", arguments);
        assert_eq!(run.code, Some(2), "{arguments:?}: {}", run.stderr);
        for part in parts {
            assert!(run.stderr.contains(part), "{arguments:?}: {part} is not in {}", run.stderr);
        }
    };
    refused(
        &["mesh/benchmrak/ss_bi"],
        &["is no job of", "did you mean mesh/benchmark/ss_bi", "`isostudy plan` lists them"],
    );
    let turntable = jobs.iter().find(|job| job["kind"] == "turntable").unwrap();
    let [mesh] = needs(turntable)[..] else { panic!("one mesh") };
    refused(&[id(turntable)], &[&format!("{mesh} is not up to date, and job {} needs it", id(turntable))]);
    refused(&["report"], &["is not up to date: run `isostudy study` first"]);
    // A change of the study is seen by the jobs that depend on it, and by no others.
    let digest_of =
        |id_: &str| jobs.iter().find(|job| id(job) == id_).unwrap()["digest"].as_str().unwrap().to_owned();
    let digest = digest_of(mesh);
    fixture.edit("supersampling = 2", "supersampling = 1");
    fixture.succeed("job", &[mesh, "--digests", &digest]);
    refused(
        &[id(turntable), "--digests", &digest_of(id(turntable))],
        &["has changed since the plan was made", "Make the plan again"],
    );
    assert!(fixture.succeed("job", &[mesh]).stderr.contains("1 up to date"));
}

/// What fails as a job is left out of the report, as in one run.
#[test]
fn what_fails_as_a_job_is_left_out_of_the_report() {
    let folders = [Folder::new(), Folder::new()];
    for folder in &folders {
        folder.write("cpu.toml", include_str!("../configs/cpu/x86-64-v3.toml"));
        folder.write("study.toml", include_str!("left_out/fronts.toml"));
    }
    let [whole, in_parts] = &folders;
    let run = whole.run(&["study", "study.toml", "--out", "out"]);
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    take_times_over(&whole.path("out"), &in_parts.path("out"));
    let plan: Value =
        serde_json::from_str(&in_parts.succeed(&["plan", "study.toml", "--out", "out", "--json"]).stdout)
            .unwrap();
    let job = |id: &str| -> Run { in_parts.run(&["job", "study.toml", "--out", "out", id]) };
    for of in plan["jobs"].as_array().unwrap() {
        let run = job(id(of));
        let want = if id(of) == "report" { 1 } else { 0 };
        assert_eq!(run.code, Some(want), "{}: {}", id(of), run.stderr);
        if id(of) == "mesh/benchmark/te_front" {
            assert!(run.stderr.contains("left out: te_front: "), "{}", run.stderr);
            // It is not tried again.
            assert!(job(id(of)).stderr.contains("left out: te_front: "));
        }
    }
    assert!(job("turntable/te_front").stderr.contains("left out: te_front: "), "after the report too");
    let [one, mut other] = [whole, in_parts].map(|folder| files(&folder.path("out")));
    // A job says why it failed where others find it.
    for purpose in ["benchmark", "stimulus"] {
        assert!(other.remove(&format!("failed/mesh.{purpose}.te_front.json")).is_some(), "{purpose}");
    }
    let differ: Vec<&String> =
        one.keys().chain(other.keys()).filter(|path| one.get(*path) != other.get(*path)).collect();
    assert_eq!(differ, ["manifest.json"; 2], "it lists those files as well");
}

/// A program that somebody killed may do better another time: the job fails, and nothing is left out. One that ends badly by itself does
/// so again.
#[test]
fn a_program_that_was_killed_is_tried_again_and_one_that_fails_is_left_out() {
    let folder = Folder::new();
    folder.write("cpu.toml", include_str!("../configs/cpu/x86-64-v3.toml"));
    let program = "{ kind = \"program\", command = [\"python3\", \"./p.py\"] }";
    let study = include_str!("left_out/fronts.toml").replace("{ kind = \"advancing-front\" }", program);
    assert!(study.contains(program));
    folder.write("study.toml", study);
    let job = || {
        let id = "mesh/benchmark/ba_front";
        folder.run(&["job", "study.toml", "--out", "out", "--allow-programs", id])
    };
    let why = folder.path("out/failed/mesh.benchmark.ba_front.json");
    folder.write("p.py", "import os\nos.kill(os.getpid(), 9)\n");
    for _ in 0..2 {
        let killed = job();
        assert!(killed.code == Some(2) && killed.stderr.contains("signal 9"), "{}", killed.stderr);
        assert!(!why.exists());
    }
    folder.write("p.py", "raise SystemExit(3)\n");
    let failed = job();
    assert!(failed.code == Some(0) && failed.stderr.contains("left out: ba_front: "), "{}", failed.stderr);
    assert!(fs::read_to_string(&why).unwrap().contains("ended with code 3"));
}

/// A file that is no longer what its stamp says is not read as if it were.
#[test]
fn what_is_changed_behind_a_jobs_back_is_done_again() {
    let fixture = Fixture::new();
    let (mesh, turntable) = ("mesh/stimulus/ss_bi", "turntable/ss_bi");
    fixture.succeed("job", &[mesh, turntable]);
    let gif = || {
        let all = files(fixture.out());
        let (_, bytes) = all.into_iter().find(|(path, _)| path.ends_with(".gif")).unwrap();
        bytes
    };
    let before = gif();
    // Another mesh in its place, as a straggler of an older plan would leave it.
    let ply = fixture.out().join("meshes/stimulus/ss_bi.ply");
    fixture.succeed("job", &["mesh/stimulus/ss_bu"]);
    fs::copy(fixture.out().join("meshes/stimulus/ss_bu.ply"), &ply).unwrap();
    let run = fixture.run("job", &[turntable]);
    assert!(
        run.code == Some(2) && run.stderr.contains(&format!("{mesh} is not up to date")),
        "{}",
        run.stderr
    );
    fixture.succeed("job", &[mesh, turntable]);
    assert!(gif() == before);
}

/// The quick study on engines that clusters have, on this machine; told where their packages cannot be had.
#[test]
#[ignore = "minutes, and packages by pip; scripts/test-cluster.sh has Snakemake each time"]
fn snakemake_and_hyperqueue_make_the_same_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
    let found = Run::of(&mut std::process::Command::new(root.join("scripts/workflow/python.sh")));
    if found.code != Some(0) {
        eprintln!("not run: {}", found.stderr.trim_end());
        return;
    }
    let python = Path::new(found.stdout.trim_end());
    let whole = Fixture::new();
    let run = whole.run("study", &[]);
    let engines: [(&str, &[&str]); 2] = [
        (
            "snakemake",
            &["--snakefile", "scripts/workflow/Snakefile", "--profile", "scripts/workflow/profiles/local"],
        ),
        ("python", &["scripts/workflow/submit_hyperqueue.py"]),
    ];
    for (engine, arguments) in engines {
        let fixture = Fixture::new();
        take_times_over(whole.out(), fixture.out());
        let plan = fixture.folder().join("plan.json");
        fs::write(&plan, fixture.succeed("plan", &["--json"]).stdout).unwrap();
        let mut command = std::process::Command::new(python.join(engine));
        command.current_dir(&root).args(arguments).env("XDG_STATE_HOME", env!("CARGO_TARGET_TMPDIR"));
        let (plan, program) = (plan.display(), env!("CARGO_BIN_EXE_isostudy"));
        if engine == "snakemake" {
            // Snakemake keeps what it knows in the folder it runs in.
            command.arg("--directory").arg(fixture.folder());
            command.args(["--config", &format!("plan={plan}"), &format!("isostudy={program}"), "seconds=1"]);
        } else {
            command.arg(plan.to_string()).args(["--isostudy", program, "--seconds", "1"]);
        }
        Run::succeed(&mut command);
        let [one, mut other] = [&whole, &fixture].map(|of| files(of.out()));
        other.retain(|path, _| !path.starts_with(".workflow/"));
        let differ: Vec<&String> =
            one.keys().chain(other.keys()).filter(|path| one.get(*path) != other.get(*path)).collect();
        assert_eq!(differ, [] as [&String; 0], "{engine}");
    }
    assert!(run.code.is_some_and(|code| code < 2));
}

/// The job of a machine that the study names goes there, or nowhere: elsewhere its times would have a wrong name.
#[test]
fn a_machines_job_is_placed_by_its_name_or_left() {
    let fixture = Fixture::new();
    fixture.edit("aa_iterations = 4", "aa_iterations = 4\nmachines = [\"desk\", \"rack\"]");
    let plan = fixture.folder().join("plan.json");
    fs::write(&plan, fixture.succeed("plan", &["--json"]).stdout).unwrap();
    let program = "import sys, batches\n\
                   all = batches.read(sys.argv[1], 60)\n\
                   placed = batches.reachable(all, {'desk'})\n\
                   print(*[batch.jobs[0]['id'] for batch in placed if batch.machine])\n\
                   print(len(all) - len(placed), all[-1] is placed[-1], len(placed[-1].needs) == len(placed) - 1)";
    let mut command = std::process::Command::new("python3");
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/workflow");
    command.args(["-c", program]).arg(&plan).env("PYTHONPATH", scripts);
    let run = Run::succeed(&mut command);
    assert_eq!(run.stdout.lines().collect::<Vec<_>>(), ["bench/machine/desk", "1 True True"]);
    assert_eq!(run.stderr.trim_end(), "bench/machine/rack: left to machine rack");
}

/// Of the whole folder one run is in charge, beside which no job works.
#[test]
fn a_job_and_a_whole_run_do_not_work_on_one_folder() {
    let fixture = Fixture::new();
    fs::create_dir_all(fixture.out().join(".stages")).unwrap();
    let lock = fs::File::create(fixture.out().join(".stages/lock")).unwrap();
    lock.lock().unwrap();
    let run = fixture.run("job", &["mesh/benchmark/ss_bi"]);
    assert!(run.code == Some(2) && run.stderr.contains("another run is at work there"), "{}", run.stderr);
    lock.unlock().unwrap();
    lock.lock_shared().unwrap();
    fixture.succeed("job", &["mesh/benchmark/ss_bi"]);
    let run = fixture.run("study", &[]);
    assert!(run.code == Some(2) && run.stderr.contains("another run is at work there"), "{}", run.stderr);
}
