//! The executor that measures in processes of its own.

use crate::error::BenchError;
use crate::linux;
use crate::load::CpuTimes;
use crate::run::{Executor, Measurement, PeakBytes};
use crate::worker::{Reply, Request};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

/// Long enough for a share of the CPU time to be taken, short enough not to be noticed.
const IDLE: Duration = Duration::from_millis(500);

/// Starts a process for every invocation and every measurement of memory, and asks it. The process ends when it is no longer
/// asked, also if this one is killed.
pub struct ProcessExecutor<'a> {
    /// The command that ends up in [`serve`](crate::serve).
    command: &'a dyn Fn() -> Command,
    /// Whether a configuration may fail without ending the run.
    may_fail: &'a dyn Fn(usize) -> bool,
    worker: Option<Worker>,
    pinned: Option<Vec<u32>>,
}

impl<'a> ProcessExecutor<'a> {
    /// An executor that asks what this command starts. Any failure ends its run.
    pub fn new(command: &'a dyn Fn() -> Command) -> Self {
        Self { command, may_fail: &|_| false, worker: None, pinned: None }
    }

    /// The same, but configurations of which `may_fail` says so, by index, are left out once the measuring process answers that
    /// they cannot be made. If that process itself ends, so does the run.
    #[must_use]
    pub fn leaving_out(self, may_fail: &'a dyn Fn(usize) -> bool) -> Self {
        Self { may_fail, ..self }
    }
}

impl Executor for ProcessExecutor<'_> {
    fn begin(&mut self) -> Result<Option<Vec<u32>>, BenchError> {
        self.worker = None;
        let (worker, pinned) = Worker::start((self.command)())?;
        self.worker = Some(worker);
        self.pinned.clone_from(&pinned);
        Ok(pinned)
    }

    /// # Panics
    /// If no invocation has begun.
    fn execute(&mut self, subject: usize) -> Result<Measurement, BenchError> {
        self.worker.as_mut().expect("an invocation has begun").ask(Request::Time(subject))?.measurement()
    }

    fn peak_memory(&mut self, subject: usize) -> Result<Option<PeakBytes>, BenchError> {
        self.worker = None;
        let (mut worker, _) = Worker::start((self.command)())?;
        worker.ask(Request::Memory(subject))?.memory()
    }

    fn leave_out(&mut self, subject: usize, error: BenchError) -> Result<String, BenchError> {
        match error {
            BenchError::Execution(reason) if (self.may_fail)(subject) => Ok(reason.to_string()),
            other => Err(other),
        }
    }

    /// This process counts as ours as well as the one that measures.
    fn cpu_times(&mut self) -> Option<CpuTimes> {
        let ours: Vec<u32> = [std::process::id()]
            .into_iter()
            .chain(self.worker.as_ref().map(|worker| worker.child.id()))
            .collect();
        CpuTimes::read(&ours, self.pinned.as_deref())
    }

    fn load_average(&mut self) -> Option<f64> {
        linux::load()
    }

    fn wait(&mut self) {
        std::thread::sleep(IDLE);
    }
}

struct Worker {
    child: Child,
    requests: Option<ChildStdin>,
    replies: BufReader<ChildStdout>,
}

impl Worker {
    fn start(mut command: Command) -> Result<(Self, Option<Vec<u32>>), BenchError> {
        let mut child = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| BenchError::Process(format!("cannot be started: {error}")))?;
        let requests = child.stdin.take();
        let replies = BufReader::new(child.stdout.take().expect("its output is a pipe"));
        let mut worker = Self { child, requests, replies };
        let pinned = worker.reply()?.ready()?;
        Ok((worker, pinned))
    }

    fn ask(&mut self, request: Request) -> Result<Reply, BenchError> {
        let line = serde_json::to_string(&request).expect("plain data serialises") + "\n";
        let requests = self.requests.as_mut().expect("open until the worker is dropped");
        // A process that has ended says more by how it ended than by the pipe that broke.
        let _ = requests.write_all(line.as_bytes()).and_then(|()| requests.flush());
        self.reply()
    }

    fn reply(&mut self) -> Result<Reply, BenchError> {
        let mut line = String::new();
        match self.replies.read_line(&mut line) {
            Ok(0) => {
                let status =
                    self.child.wait().map_or_else(|error| error.to_string(), |status| status.to_string());
                Err(BenchError::Process(format!("ended before it answered ({status})")))
            }
            Ok(_) => serde_json::from_str(&line).map_err(|error| BenchError::Process(error.to_string())),
            Err(error) => Err(BenchError::Process(error.to_string())),
        }
    }
}

impl Drop for Worker {
    /// Lets it end and waits for it, so that it is not at work while the next one measures.
    fn drop(&mut self) {
        self.requests = None;
        let _ = self.child.wait();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_that_cannot_be_asked_is_an_error() {
        let missing = || Command::new("/nowhere/isostudy");
        let error = ProcessExecutor::new(&missing).begin().unwrap_err();
        assert!(error.to_string().starts_with("the measuring process: cannot be started: "), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_process_that_ends_too_soon_or_babbles_is_an_error() {
        let shell = |script: &'static str| {
            move || {
                let mut command = Command::new("sh");
                command.args(["-c", script]);
                command
            }
        };
        let silent = shell("exit 3");
        let error = ProcessExecutor::new(&silent).begin().unwrap_err().to_string();
        assert!(error.contains("ended before it answered") && error.contains('3'), "{error}");
        let babbling = shell("echo hello");
        assert!(matches!(ProcessExecutor::new(&babbling).begin(), Err(BenchError::Process(_))));
        let dying = shell("echo '{\"ready\":[1]}'; read line");
        let mut executor = ProcessExecutor::new(&dying);
        assert_eq!(executor.begin().unwrap(), Some(vec![1]));
        assert!(executor.execute(0).unwrap_err().to_string().contains("ended before it answered"));
        let answering = shell("echo '{\"ready\":null}'; read line; echo '{\"failed\":\"no\"}'");
        let mut executor = ProcessExecutor::new(&answering);
        executor.begin().unwrap();
        assert_eq!(executor.execute(0).unwrap_err().to_string(), "no");
    }
}
