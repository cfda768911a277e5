//! The executor that measures in processes of its own.

use crate::allocations::AllocationCounts;
use crate::error::BenchError;
use crate::linux;
use crate::load::CpuTimes;
use crate::run::{Executor, Measurement, PeakBytes};
use crate::worker::{Reply, Request};
use isostudy_foreign::{Child, Heard, Limits, Stopped, Told, shown_in_a_line};
use std::process::Command;
use std::time::Duration;

/// Long enough for a share of the CPU time to be taken, short enough not to be noticed.
const IDLE: Duration = Duration::from_millis(500);
/// An answer is a few hundred bytes, or what a program said that failed.
const LINE_LIMIT_BYTES: usize = 1 << 20;
/// How long a process may take to end once it is no longer asked.
const PARTING: Duration = Duration::from_secs(10);
/// How much of a line is quoted.
const QUOTED: usize = 100;

/// What a measuring process may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Allowance {
    /// For each answer, and to be ready.
    pub time: Duration,
    /// Resident memory of the process and all that it starts; `None` for no limit.
    pub memory_bytes: Option<u64>,
}

impl Default for Allowance {
    /// A day for each answer. One's own program may measure something large.
    fn default() -> Self {
        Self { time: Duration::from_secs(86_400), memory_bytes: None }
    }
}

/// Starts a process for every invocation and every measurement of memory, and asks it. The process ends when it is no longer
/// asked, also if this one is killed. It is killed if it does not, or does not keep to its [`Allowance`].
pub struct ProcessExecutor<'a> {
    /// The command that ends up in [`serve`](crate::serve).
    command: &'a dyn Fn() -> Command,
    /// Whether a configuration may fail without ending the run.
    may_fail: &'a dyn Fn(usize) -> bool,
    /// Told what a process says on standard error; none leaves it this process's own.
    tell: Option<Told>,
    allowance: Allowance,
    worker: Option<Worker>,
    pinned: Option<Vec<u32>>,
}

impl<'a> ProcessExecutor<'a> {
    /// An executor that asks what this command starts. Any failure ends its run.
    pub fn new(command: &'a dyn Fn() -> Command) -> Self {
        Self {
            command,
            may_fail: &|_| false,
            tell: None,
            allowance: Allowance::default(),
            worker: None,
            pinned: None,
        }
    }

    /// The same, but configurations of which `may_fail` says so, by index, are left out once the measuring process answers that
    /// they cannot be made. If that process itself ends, so does the run.
    #[must_use]
    pub fn leaving_out(self, may_fail: &'a dyn Fn(usize) -> bool) -> Self {
        Self { may_fail, ..self }
    }

    /// The same, but a process may use no more than this.
    #[must_use]
    pub fn within(self, allowance: Allowance) -> Self {
        Self { allowance, ..self }
    }

    /// The same, but `tell` is given each line that a process says on standard error, by a thread that waits for it. All of a process's
    /// lines are told before the next one begins; of a process that says very many, the first.
    #[must_use]
    pub fn telling(self, tell: Told) -> Self {
        Self { tell: Some(tell), ..self }
    }

    fn start(&self) -> Result<(Worker, Option<Vec<u32>>), BenchError> {
        Worker::start((self.command)(), self.tell, self.allowance)
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

/// A process that measures what it is asked to.
pub(crate) struct Worker {
    child: Child,
    allowance: Allowance,
}

impl Worker {
    pub(crate) fn start(
        mut command: Command,
        tell: Option<Told>,
        allowance: Allowance,
    ) -> Result<(Self, Option<Vec<u32>>), BenchError> {
        let limits = Limits { line_bytes: LINE_LIMIT_BYTES, memory_bytes: allowance.memory_bytes };
        let program = shown_in_a_line(&command.get_program().to_string_lossy()).into_owned();
        let child = Child::start(&mut command, limits, tell)
            .map_err(|error| BenchError::Process(format!("cannot be started: {program}: {error}")))?;
        let mut worker = Self { child, allowance };
        let pinned = worker.reply()?.ready()?;
        Ok((worker, pinned))
    }

    /// Lets it end, and returns the end of what it said on standard error, if nobody was told.
    pub(crate) fn finish(mut self) -> String {
        let _ = self.child.wait(PARTING);
        self.child.kill();
        self.child.last_words()
    }

    pub(crate) fn ask(&mut self, request: Request) -> Result<Reply, BenchError> {
        if let Some(Heard::Line(line, _) | Heard::TooLong(line)) = self.child.unasked() {
            self.child.kill();
            let said = format!("said `{}` without being asked", quoted(&line));
            return Err(BenchError::Process(said));
        }
        let line = serde_json::to_string(&request).expect("plain data serialises") + "\n";
        // A process that has ended says more by how it ended than by the pipe that broke.
        self.child.send(line.into_bytes());
        self.reply()
    }

    fn reply(&mut self) -> Result<Reply, BenchError> {
        let Allowance { time, .. } = self.allowance;
        let said = match self.child.listen(time) {
            Ok((line, _)) => match serde_json::from_slice(&line) {
                Ok(reply) => return Ok(reply),
                Err(error) => format!("said `{}`: {error}", quoted(&line)),
            },
            Err(Stopped::Ended(end, _)) => format!("ended before it answered: it {end}"),
            Err(Stopped::TimeLimit) => {
                format!("took longer than {} s to answer, its time limit", time.as_secs_f64())
            }
            Err(Stopped::MemoryLimit { bytes, limit }) => {
                format!("took {bytes} bytes of memory; its limit is {limit}")
            }
            Err(Stopped::TooLong(start)) => {
                format!("said a line of more than {LINE_LIMIT_BYTES} bytes: `{}`", quoted(&start))
            }
        };
        self.child.kill();
        Err(BenchError::Process(said))
    }
}

fn quoted(line: &[u8]) -> String {
    let start = String::from_utf8_lossy(&line[..line.len().min(QUOTED)]);
    format!("{}{}", shown_in_a_line(&start), if line.len() > QUOTED { "..." } else { "" })
}

impl Drop for Worker {
    /// Lets it end and waits for it, so that it is not at work while the next one measures, and for its last words. One that does not
    /// end is killed.
    fn drop(&mut self) {
        let _ = self.child.wait(PARTING);
        self.child.kill();
        self.child.last_words();
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
        assert!(
            error.to_string().starts_with("the measuring process: cannot be started: /nowhere/isostudy: "),
            "{error}"
        );
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

    /// What other programs than ours may do: each is told by name within the limit, and nothing of it stays.
    #[cfg(unix)]
    #[test]
    fn a_process_that_does_not_keep_to_its_limits_is_ended() {
        let ready = "echo '{\"ready\":null}'; ";
        let timed = "{\"failed\":\"no\"}";
        for (script, words) in [
            ("sleep 1000".to_owned(), "took longer than 1 s"),
            (format!("trap '' TERM INT; {ready} read line; sleep 1000"), "took longer than 1 s"),
            (format!("{ready} read line; echo '{timed}'; sleep 1000"), "took longer than 1 s"),
            (format!("{ready} exec >&-; sleep 1000"), "closed its output without ending"),
            ("yes | tr -d '\\n'".to_owned(), "a line of more than 1048576 bytes"),
            ("cat /dev/zero".to_owned(), "a line of more than 1048576 bytes"),
            ("yes".to_owned(), "said `y`"),
            (format!("{ready} while :; do echo '{timed}'; done"), "without being asked"),
            ("yes >&2".to_owned(), "took longer than 1 s"),
            ("cat /dev/zero >&2".to_owned(), "took longer than 1 s"),
            ("printf '\\033[2K\\r{}'".to_owned(), "ended before it answered"),
            ("printf '\\033[2Kforged\\n'".to_owned(), "said `\\u001b[2Kforged`"),
            (format!("{ready} kill -9 $$"), "signal 9"),
            (
                format!("{ready} head -c 300000000 /dev/zero | tail; sleep 1000"),
                "bytes of memory; its limit is",
            ),
        ] {
            let command = || {
                let mut command = Command::new("sh");
                command.args(["-c", &script]);
                command
            };
            let allowance = Allowance { time: Duration::from_secs(1), memory_bytes: Some(100 << 20) };
            let mut executor = ProcessExecutor::new(&command).within(allowance).telling(|_| ());
            let mut said: Vec<String> = executor.begin().err().iter().map(ToString::to_string).collect();
            let has_begun = said.is_empty();
            let is_told = |said: &[String]| said.iter().any(|error| error.contains(words));
            // Who says more than it is asked is found out by a later question, as soon as it is ahead.
            for _ in 0..200 {
                if has_begun && !is_told(&said) {
                    said.extend(executor.execute(0).err().map(|error| error.to_string()));
                }
            }
            assert!(is_told(&said), "{script}: {said:?}");
        }
    }
}
