//! What can go wrong with a program, and when.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use isostudy_foreign::{End, shown_in_a_line};
use thiserror::Error;

/// What went wrong, with which program, and what it said on its standard error.
#[derive(Debug, Error)]
#[error("{program}: {problem}{}", quoted(.stderr))]
pub struct ProgramError {
    /// The command as the study has it, words separated by spaces.
    pub program: String,
    /// What went wrong. It is in the message, hence not a source of its own.
    pub problem: Box<Problem>,
    /// The end of its standard error, at most 4 KiB; empty if it said nothing.
    pub stderr: String,
}

fn quoted(stderr: &str) -> String {
    if stderr.is_empty() {
        return String::new();
    }
    // A bar before each line, so that none of them passes for one of ours.
    let lines: Vec<String> = stderr.lines().map(|line| format!("  | {}", shown_in_a_line(line))).collect();
    format!("; its standard error ends:\n{}", lines.join("\n"))
}

/// When it went wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Before the program was ready.
    Start,
    /// While it had this request.
    Request(u64),
    /// After its input had ended.
    Finish,
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start => f.write_str("before it was ready"),
            Self::Request(id) => write!(f, "at request {id}"),
            Self::Finish => f.write_str("after its input had ended"),
        }
    }
}

/// What went wrong.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Problem {
    /// A command without words.
    #[error("the command is empty: it needs a program, then its arguments")]
    NoCommand,
    /// No such program.
    #[error("`{name}` is not found {}", searched(.path))]
    NotFound {
        /// As the command has it.
        name: String,
        /// Where it should be; `None` if the folders of `PATH` were searched.
        path: Option<PathBuf>,
    },
    /// A file that cannot be executed.
    #[error("{} is not executable", .path.display())]
    NotExecutable {
        /// The file.
        path: PathBuf,
    },
    /// An argument that names a file which is not there.
    #[error("its argument `{argument}` is not found as {}", .path.display())]
    NoSuchFile {
        /// As the command has it.
        argument: String,
        /// Where it should be.
        path: PathBuf,
    },
    /// An argument that may be a word or a file.
    #[error(
        "its argument `{argument}` is also a file of the study's folder; if that is meant, say `./{argument}`"
    )]
    Ambiguous {
        /// As the command has it.
        argument: String,
    },
    /// A time limit of zero.
    #[error("its time limit is zero; it must be longer")]
    NoTime,
    /// A memory limit where memory cannot be watched.
    #[error("its memory limit cannot be kept: there is no /proc here to watch it by; leave the limit out")]
    NotWatched,
    /// There is no sandbox to run it in.
    #[error("cannot be run in a sandbox: {reason}")]
    NoSandbox {
        /// Why not.
        reason: String,
    },
    /// The request cannot be made.
    #[error("{key}: {reason}")]
    Request {
        /// Which field of it.
        key: &'static str,
        /// What is wrong, and what is allowed.
        reason: String,
    },
    /// A file or folder of ours cannot be made, written or read.
    #[error("{}: {source}", .path.display())]
    Io {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The system does not start it.
    #[error("cannot be started: {0}")]
    Start(io::Error),
    /// The program says that it cannot.
    #[error("failed {phase}: {words}")]
    Failed {
        /// When.
        phase: Phase,
        /// In its own words.
        words: String,
    },
    /// It ended before it answered, or badly.
    #[error("{end} {phase}{}", after(.rest))]
    Ended {
        /// When.
        phase: Phase,
        /// How.
        end: End,
        /// The beginning of a line that it did not finish.
        rest: String,
    },
    /// It took too long.
    #[error("{phase} it took longer than its time limit, {} s", .limit.as_secs_f64())]
    TimeLimit {
        /// When.
        phase: Phase,
        /// The limit.
        limit: Duration,
    },
    /// It took too much memory.
    #[error("{phase} it took {bytes} bytes of memory; its limit is {limit}")]
    MemoryLimit {
        /// When.
        phase: Phase,
        /// How much was seen.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// A line without end.
    #[error("{phase} it said a line of more than {limit} bytes: `{start}...`")]
    LineTooLong {
        /// When.
        phase: Phase,
        /// How long a line may be.
        limit: usize,
        /// How it begins.
        start: String,
    },
    /// A line that the protocol does not have.
    #[error("{phase} it said `{line}`: {reason}")]
    Line {
        /// When.
        phase: Phase,
        /// What it said, cut.
        line: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A line that nobody asked for.
    #[error("it said `{line}` without being asked: a request has one answer")]
    Unasked {
        /// What it said, cut.
        line: String,
    },
    /// An answer to something else.
    #[error("it answered request {got} {phase}")]
    WrongId {
        /// When.
        phase: Phase,
        /// The answer's number.
        got: u64,
    },
    /// Seconds that cannot be.
    #[error("{phase} it told {key} = {value}; from outside its answer took {wall_s} s")]
    Seconds {
        /// When.
        phase: Phase,
        /// Which seconds.
        key: &'static str,
        /// The value.
        value: f64,
        /// What the clock outside says.
        wall_s: f64,
    },
    /// There is no mesh, or it breaks its format.
    #[error("its mesh {}: {reason}", .path.display())]
    Mesh {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A mesh without triangles.
    #[error("its answer has no triangles at request {id}, and the surface should have some")]
    Empty {
        /// Which request.
        id: u64,
    },
    /// A mesh that reaches too far.
    #[error(
        "its vertex {vertex} lies at {position:?}, more than a cell beyond the samples, {min:?} to {max:?}: positions are in \
         the samples' space, not in cells"
    )]
    Outside {
        /// Which, from 0.
        vertex: usize,
        /// Where it is.
        position: [f32; 3],
        /// The first sample.
        min: [f64; 3],
        /// The last sample.
        max: [f64; 3],
    },
    /// Other numbers than those of the mesh.
    #[error("it told {told} {what}, and its mesh has {found}")]
    Counts {
        /// `vertices` or `triangles`.
        what: &'static str,
        /// What the answer says.
        told: u64,
        /// What the file has; polygons are cut into triangles.
        found: u64,
    },
    /// The worker was stopped by an earlier error.
    #[error("it was stopped after an earlier error; it must be started again")]
    Stopped,
    /// It outlives its input.
    #[error("it does not end at the end of its input; it was ended after {} s", .limit.as_secs_f64())]
    NotEnded {
        /// How long it was given.
        limit: Duration,
    },
}

fn searched(path: &Option<PathBuf>) -> String {
    path.as_deref()
        .map_or_else(|| "in the folders of PATH".to_owned(), |path| format!("as {}", path.display()))
}

fn after(rest: &str) -> String {
    if rest.is_empty() { String::new() } else { format!(", in the middle of the line `{rest}`") }
}

impl Problem {
    pub(crate) fn io(path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Io { path: path.to_owned(), source }
    }

    /// Whether the program still stands where both sides think it does.
    pub(crate) fn is_in_step(&self) -> bool {
        matches!(
            self,
            Self::Request { .. }
                | Self::Io { .. }
                | Self::Failed { phase: Phase::Request(_), .. }
                | Self::Mesh { .. }
                | Self::Empty { .. }
                | Self::Outside { .. }
                | Self::Counts { .. }
        )
    }
}

/// For messages: a line may be anything, and long.
pub(crate) fn shortened(bytes: &[u8]) -> String {
    const SHOWN: usize = 200;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * SHOWN)]);
    let shown: String = text.chars().take(SHOWN).flat_map(char::escape_debug).collect();
    let shown = shown.replace("\\\"", "\"").replace("\\'", "'");
    if text.chars().count() > SHOWN || bytes.len() > 4 * SHOWN { shown + "..." } else { shown }
}
