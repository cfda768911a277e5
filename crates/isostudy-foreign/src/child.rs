//! A process that answers by lines, within limits.

use std::io::{self, Write};
use std::process::{ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use crate::group::{End, Group, Memory};
use crate::lines::{Heard, lines};
use crate::tail::{Tail, Told};

/// How often memory and life are looked at while a line is awaited.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// How long a child that closed its output may take to end.
const PARTING: Duration = Duration::from_secs(1);
/// How many lines to a child may wait until it reads them.
const WAITING_LINES: usize = 16;

/// What a child may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// The longest line on its standard output, without its end.
    pub line_bytes: usize,
    /// Resident memory of it and all that it starts; `None` for no limit.
    pub memory_bytes: Option<u64>,
}

/// Why there is no line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stopped {
    /// It took too long.
    TimeLimit,
    /// It has more memory than it may.
    MemoryLimit {
        /// How much was seen.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// It said a line that is too long; how that begins.
    TooLong(Vec<u8>),
    /// Its output ended; what stood after the last line.
    Ended(End, Vec<u8>),
}

/// A child. Dropped, it is killed with all that it started.
#[derive(Debug)]
pub struct Child {
    group: Group,
    input: Option<ChildStdin>,
    waiting: Option<SyncSender<Vec<u8>>>,
    replies: Receiver<Heard>,
    stderr: Tail,
    limits: Limits,
}

impl Child {
    /// Starts a command. Its standard streams become pipes, whatever was said of them. It runs on the CPUs of the calling thread.
    ///
    /// # Errors
    /// If the system does not start it.
    ///
    /// # Panics
    /// Never: all three streams are pipes.
    pub fn start(command: &mut Command, limits: Limits, told: Option<Told>) -> io::Result<Self> {
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut group = Group::spawn(command, limits.memory_bytes)?;
        let child = group.child();
        let (Some(input), Some(output), Some(errors)) =
            (child.stdin.take(), child.stdout.take(), child.stderr.take())
        else {
            unreachable!("all three are pipes")
        };
        Ok(Self {
            group,
            input: Some(input),
            waiting: None,
            replies: lines(output, limits.line_bytes),
            stderr: Tail::of(errors, told),
            limits,
        })
    }

    /// The number of its first process.
    pub fn id(&self) -> u32 {
        self.group.id()
    }

    /// Its standard input, to be written to by the caller, who may have to wait; `None` once it was taken or something was sent.
    pub fn take_input(&mut self) -> Option<ChildStdin> {
        self.input.take()
    }

    /// Sends bytes without waiting for them to be read. If the child is gone, or reads nothing, listening will tell.
    pub fn send(&mut self, bytes: Vec<u8>) {
        if let Some(input) = self.input.take() {
            self.waiting = Some(writer(input));
        }
        match self.waiting.as_ref().map(|waiting| waiting.try_send(bytes)) {
            // It gets no more: its next answer does not come.
            Some(Err(TrySendError::Full(_) | TrySendError::Disconnected(_))) => self.waiting = None,
            Some(Ok(())) | None => {}
        }
    }

    /// Ends its input.
    pub fn close_input(&mut self) {
        self.input = None;
        self.waiting = None;
    }

    /// What it has said and nobody asked for.
    pub fn unasked(&mut self) -> Option<Heard> {
        self.replies.try_recv().ok()
    }

    /// The next line, and when it came.
    ///
    /// # Errors
    /// If none comes within the time, or within the other limits. The child is still there, unless it ended.
    pub fn listen(&mut self, time_limit: Duration) -> Result<(Vec<u8>, Instant), Stopped> {
        let begin = Instant::now();
        let mut had_ended = false;
        loop {
            let left = time_limit.saturating_sub(begin.elapsed());
            match self.replies.recv_timeout(left.min(LOOK_EVERY)) {
                Ok(Heard::Line(line, at)) => return Ok((line, at)),
                Ok(Heard::TooLong(start)) => return Err(Stopped::TooLong(start)),
                Ok(Heard::End(rest)) => return Err(self.ended(rest)),
                Err(RecvTimeoutError::Disconnected) => return Err(self.ended(Vec::new())),
                // It ended, and something that it started holds its output open.
                Err(RecvTimeoutError::Timeout) if had_ended => return Err(self.ended(Vec::new())),
                Err(RecvTimeoutError::Timeout) => {}
            }
            had_ended = self.group.has_ended();
            if !had_ended && self.limits.memory_bytes.is_some() {
                let memory = self.memory(false);
                self.check_memory(memory)?;
            }
            // One that has just ended is given one more look, for its last line and its code.
            let extra = if had_ended { LOOK_EVERY } else { Duration::ZERO };
            if begin.elapsed().saturating_sub(extra) >= time_limit {
                return Err(Stopped::TimeLimit);
            }
        }
    }

    /// Ends its input, and waits until it has ended, whatever it says. Tells how.
    ///
    /// # Errors
    /// As [`listen`](Self::listen); a line that is too long is none.
    pub fn wait(&mut self, time_limit: Duration) -> Result<End, Stopped> {
        self.close_input();
        let begin = Instant::now();
        loop {
            match self.listen(time_limit.saturating_sub(begin.elapsed())) {
                Ok(_) | Err(Stopped::TooLong(_)) => {}
                Err(Stopped::Ended(end, _)) => return Ok(end),
                Err(stopped) => return Err(stopped),
            }
        }
    }

    /// The memory of it and all that it started; `None` where it cannot be seen. With `search_now` what it started is looked up at once.
    pub fn memory(&mut self, search_now: bool) -> Option<Memory> {
        self.group.memory(search_now)
    }

    /// CPU time of it and all that it started, since it began; `None` where it cannot be seen. What ended without being waited for is
    /// not in it.
    pub fn cpu(&mut self) -> Option<Duration> {
        self.group.cpu()
    }

    /// Whether that is within the limit.
    ///
    /// # Errors
    /// [`Stopped::MemoryLimit`].
    pub fn check_memory(&self, memory: Option<Memory>) -> Result<(), Stopped> {
        match (memory, self.limits.memory_bytes) {
            (Some(Memory { peak_bytes: bytes, .. }), Some(limit)) if bytes > limit => {
                Err(Stopped::MemoryLimit { bytes, limit })
            }
            _ => Ok(()),
        }
    }

    /// Kills what is left. Tells how the first process ended, if it had ended by itself.
    pub fn kill(&mut self) -> End {
        self.close_input();
        self.group.kill()
    }

    /// The end of its standard error, at most 4 KiB.
    pub fn words(&self) -> String {
        self.stderr.words()
    }

    /// The same of a child that has ended.
    pub fn last_words(&self) -> String {
        self.stderr.last_words()
    }

    fn ended(&mut self, rest: Vec<u8>) -> Stopped {
        self.group.ends_within(PARTING);
        Stopped::Ended(self.group.kill(), rest)
    }
}

/// Writes as it comes: a child that does not read its input must not keep us waiting. The pipe is closed when the sender is dropped
/// or the child is gone.
fn writer(mut input: ChildStdin) -> SyncSender<Vec<u8>> {
    let (sender, lines) = sync_channel::<Vec<u8>>(WAITING_LINES);
    thread::spawn(move || {
        for line in lines {
            if input.write_all(&line).is_err() {
                return;
            }
        }
    });
    sender
}
