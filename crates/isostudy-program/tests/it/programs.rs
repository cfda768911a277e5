//! Programs with a planted defect, and requests to put to them.

use std::path::PathBuf;
use std::time::Duration;

use isostudy_program::{Answer, Problem, Program, ProgramError, Request, Samples, Worker};

/// Eight samples round the origin, one of them inside.
const SAMPLES: [f32; 8] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];

/// The program that does what `plan` says, with time for a loaded machine.
pub(crate) fn planted(plan: &str) -> Program {
    Program {
        command: ["python3", "./planted.py", plan].map(str::to_owned).to_vec(),
        base: PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/planted"),
        time_limit: Duration::from_secs(120),
        memory_limit_bytes: Some(200 << 20),
        sandbox: false,
    }
}

/// The same, where it is meant to run out of time.
pub(crate) fn hurried(plan: &str) -> Program {
    Program { time_limit: Duration::from_secs(2), ..planted(plan) }
}

pub(crate) fn ask(worker: &mut Worker) -> Result<Answer, ProgramError> {
    let mesh = worker.folder().join("mesh.ply");
    worker.extract(&Request { mesh: Some(&mesh), ..request() })
}

pub(crate) fn request() -> Request<'static> {
    Request {
        samples: Samples::Values(&SAMPLES),
        size: [2; 3],
        origin: [0.0; 3],
        spacing: [1.0; 3],
        isovalue: 0.5,
        mesh: None,
        may_be_empty: false,
    }
}

/// What the first answer of a program comes to, which must be an error that names it.
pub(crate) fn first_error(program: &Program) -> (ProgramError, Worker) {
    let mut worker = Worker::start(program).expect("it is ready");
    let error = ask(&mut worker).expect_err("an answer was accepted");
    let (said, plan) = (error.to_string(), &program.command[2]);
    assert!(said.starts_with(&format!("python3 ./planted.py {plan}: ")), "it is named: {said}");
    (error, worker)
}

/// That nothing is left of a program which did something unforgivable, and that another can be started.
pub(crate) fn assert_gone(mut worker: Worker) {
    assert!(!worker.is_running());
    assert!(!is_alive(worker.process()), "the process is gone");
    let again = ask(&mut worker).expect_err("a stopped worker answered");
    assert!(matches!(*again.problem, Problem::Stopped), "{again}");
    let mut another = Worker::start(&planted("good")).expect("another starts");
    ask(&mut another).expect("and answers");
}

/// A process that has ended and that nobody waited for is not alive.
pub(crate) fn is_alive(process: u32) -> bool {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    stat.rsplit_once(')').is_some_and(|(_, rest)| !rest.trim_start().starts_with(['Z', 'X']))
}
