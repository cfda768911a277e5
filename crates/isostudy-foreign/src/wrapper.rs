//! How children are started: through this program itself, which then becomes the child, so that the kernel ends it with us.
//!
//! What has to be done between the fork and the start of another program would be `unsafe` here. So this program is started again,
//! does it, and replaces itself. The kernel sends the signal when the thread that started the child ends. So a thread that never ends
//! starts all of them.

use std::env;
use std::ffi::OsString;
use std::io::{self, Error, ErrorKind, Write};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, ExitCode};
use std::sync::OnceLock;
use std::sync::mpsc::{Sender, channel, sync_channel};
use std::thread;

use rustix::fs::Access;
use rustix::process::{Pid, Resource, Rlimit, getppid, setrlimit, setsid};

use crate::processes::{Family, MARK, marked, new_mark};

/// The first argument of a program that is to become a child.
const VERB: &str = "__become-a-child";
/// What a shell ends with where a program cannot be started.
const NOT_STARTED: u8 = 127;

/// Where starts are asked for; there once [`wrapper`] was called.
static STARTER: OnceLock<Sender<Start>> = OnceLock::new();

struct Start {
    command: Command,
    #[cfg(target_os = "linux")]
    cpus: Option<rustix::thread::CpuSet>,
    started: std::sync::mpsc::SyncSender<io::Result<Child>>,
}

/// What a program must call first thing in `main`. If this process was started to become a child it does so, and ends with the code
/// that is returned if that fails. Otherwise there is nothing to return, and children are started through this program from now on.
pub fn wrapper() -> Option<ExitCode> {
    let mut arguments = env::args_os().skip(1);
    if arguments.next().is_some_and(|first| first == VERB) {
        let error = become_child(&arguments.collect::<Vec<_>>());
        let _ = writeln!(io::stderr(), "cannot be started: {error}");
        return Some(ExitCode::from(NOT_STARTED));
    }
    // What it would become could not be found elsewhere.
    if cfg!(target_os = "linux") {
        let (sender, starts) = channel::<Start>();
        let all = move || {
            for Start {
                mut command,
                started,
                #[cfg(target_os = "linux")]
                cpus,
            } in starts
            {
                #[cfg(target_os = "linux")]
                if let Some(cpus) = cpus {
                    let _ = rustix::thread::sched_setaffinity(None, &cpus);
                }
                let _ = started.send(command.spawn());
            }
        };
        if thread::Builder::new().name("starter of children".into()).spawn(all).is_ok() {
            let _ = STARTER.set(sender);
        }
    }
    None
}

/// Returns what went wrong; if nothing does, this process is another program.
fn become_child(arguments: &[OsString]) -> Error {
    let [parent, memory, program, rest @ ..] = arguments else { return ErrorKind::InvalidInput.into() };
    let number = |word: &OsString| word.to_str().and_then(|word| word.parse::<u64>().ok());
    // A session of its own has no terminal, into which a program could type. It is the leader of a group as well.
    let _ = setsid();
    #[cfg(target_os = "linux")]
    {
        if let Err(error) =
            rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::KILL))
        {
            return error.into();
        }
        // The parent may have gone before.
        if getppid().map(|pid| pid.as_raw_nonzero().get() as u64) != number(parent) {
            return ErrorKind::BrokenPipe.into();
        }
    }
    let limited =
        |resource, limit| setrlimit(resource, Rlimit { current: Some(limit), maximum: Some(limit) });
    let _ = limited(Resource::Core, 0);
    if let Some(bytes) = number(memory) {
        let _ = limited(Resource::Data, bytes);
    }
    Command::new(program).args(rest).exec()
}

/// The kernel's limit on the writable memory of one process, for a limit on what is resident. Libraries reserve what they never use,
/// and this only has to stop a leap.
fn reserve(memory_bytes: u64) -> u64 {
    memory_bytes.saturating_mul(2).saturating_add(1 << 30)
}

/// Starts a child with a mark, in a group of its own, on the CPUs of the calling thread.
pub(crate) fn spawn(command: &mut Command, memory_bytes: Option<u64>) -> io::Result<(Child, Family)> {
    let mark = new_mark();
    command.env(MARK, marked(&mark));
    let child = match STARTER.get() {
        Some(starter) => through(starter, command, memory_bytes)?,
        None => command.process_group(0).spawn()?,
    };
    let first = Pid::from_child(&child);
    Ok((child, Family { first, mark }))
}

fn through(starter: &Sender<Start>, command: &Command, memory_bytes: Option<u64>) -> io::Result<Child> {
    let program = command.get_program();
    // The wrapper would tell it too late.
    if program.to_string_lossy().contains('/') {
        rustix::fs::access(program, Access::EXEC_OK)?;
    }
    let mut wrapped = Command::new("/proc/self/exe");
    let memory = memory_bytes.map_or_else(|| "-".to_owned(), |bytes| reserve(bytes).to_string());
    wrapped.arg(VERB).arg(std::process::id().to_string()).arg(memory).arg(program).args(command.get_args());
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => wrapped.env(name, value),
            None => wrapped.env_remove(name),
        };
    }
    if let Some(folder) = command.get_current_dir() {
        wrapped.current_dir(folder);
    }
    let piped = std::process::Stdio::piped;
    wrapped.stdin(piped()).stdout(piped()).stderr(piped());
    let (sender, started) = sync_channel(1);
    let start = Start {
        command: wrapped,
        #[cfg(target_os = "linux")]
        cpus: rustix::thread::sched_getaffinity(None).ok(),
        started: sender,
    };
    let gone = |_| Error::other("the thread that starts children is gone");
    starter.send(start).map_err(|_| gone(()))?;
    started.recv().map_err(|_| gone(()))?
}
