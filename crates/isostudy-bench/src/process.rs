//! The executor that measures in processes of its own.

use crate::allocations::AllocationCounts;
use crate::error::BenchError;
use crate::linux;
use crate::load::CpuTimes;
use crate::run::{Executor, Measurement, PeakBytes};
use crate::worker::{Reply, Request};
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::thread::JoinHandle;
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
    /// Told what a process says on standard error; none leaves it this process's own.
    tell: Option<fn(&str)>,
    worker: Option<Worker>,
    pinned: Option<Vec<u32>>,
}

impl<'a> ProcessExecutor<'a> {
    /// An executor that asks what this command starts. Any failure ends its run.
    pub fn new(command: &'a dyn Fn() -> Command) -> Self {
        Self { command, may_fail: &|_| false, tell: None, worker: None, pinned: None }
    }

    /// The same, but configurations of which `may_fail` says so, by index, are left out once the measuring process answers that
    /// they cannot be made. If that process itself ends, so does the run.
    #[must_use]
    pub fn leaving_out(self, may_fail: &'a dyn Fn(usize) -> bool) -> Self {
        Self { may_fail, ..self }
    }

    /// The same, but `tell` is given each line that a process says on standard error, by a thread that waits for it. All of a process's
    /// lines are told before the next one begins.
    #[must_use]
    pub fn telling(self, tell: fn(&str)) -> Self {
        Self { tell: Some(tell), ..self }
    }

    fn start(&self) -> Result<(Worker, Option<Vec<u32>>), BenchError> {
        Worker::start((self.command)(), self.tell)
    }
}

impl Executor for ProcessExecutor<'_> {
    fn begin(&mut self) -> Result<Option<Vec<u32>>, BenchError> {
        self.worker = None;
        let (worker, pinned) = self.start()?;
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
        let (mut worker, _) = self.start()?;
        let peak = worker.ask(Request::Memory(subject))?.memory();
        self.worker = Some(worker);
        peak
    }

    /// In the process that measured memory last, if there is one.
    fn allocations(&mut self, subject: usize) -> Result<Option<AllocationCounts>, BenchError> {
        let mut worker = match self.worker.take() {
            Some(worker) => worker,
            None => self.start()?.0,
        };
        worker.ask(Request::Allocations(subject))?.allocations()
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
    listener: Option<JoinHandle<()>>,
}

impl Worker {
    fn start(mut command: Command, tell: Option<fn(&str)>) -> Result<(Self, Option<Vec<u32>>), BenchError> {
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        if tell.is_some() {
            command.stderr(Stdio::piped());
        }
        let mut child =
            command.spawn().map_err(|error| BenchError::Process(format!("cannot be started: {error}")))?;
        let requests = child.stdin.take();
        let replies = BufReader::new(child.stdout.take().expect("its output is a pipe"));
        let listener = tell
            .zip(child.stderr.take())
            .map(|(tell, errors)| std::thread::spawn(move || pass_on(errors, tell)));
        let mut worker = Self { child, requests, replies, listener };
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
        let _ = self.listener.take().map(JoinHandle::join);
    }
}

/// Tells each line until there are no more. What is no text is told as far as it is.
fn pass_on(errors: impl Read, tell: fn(&str)) {
    let mut errors = BufReader::new(errors);
    let mut line = Vec::new();
    while let Ok(1..) = errors.read_until(b'\n', &mut line) {
        tell(String::from_utf8_lossy(&line).trim_end_matches(['\n', '\r']));
        line.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    #[cfg(unix)]
    use std::sync::Mutex;

    #[test]
    fn a_process_that_cannot_be_asked_is_an_error() {
        let missing = || Command::new("/nowhere/isostudy");
        let error = ProcessExecutor::new(&missing).begin().unwrap_err();
        assert!(error.to_string().starts_with("the measuring process: cannot be started: "), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn what_a_process_says_on_standard_error_is_told_before_the_next_begins() {
        static SAID: Mutex<Vec<String>> = Mutex::new(Vec::new());
        let tell = |line: &str| SAID.lock().unwrap().push(line.to_owned());
        let command = || {
            let mut command = Command::new("sh");
            command.args(["-c", "echo '{\"ready\":null}'; read line; echo first >&2; printf 'l\\303st' >&2"]);
            command
        };
        let mut executor = ProcessExecutor::new(&command).telling(tell);
        for times in 0..3 {
            executor.begin().unwrap();
            assert_eq!(*SAID.lock().unwrap(), ["first", "l\u{fffd}st"].repeat(times));
        }
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
