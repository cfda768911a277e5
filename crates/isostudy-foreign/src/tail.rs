//! What a child says on standard error: its end is kept, and lines are told as they come.

use std::io::Read;
use std::process::ChildStderr;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

const KEPT_BYTES: usize = 4096;
/// A process that left the group may hold the pipe open for ever.
const PATIENCE: Duration = Duration::from_millis(300);
/// How many lines of a child are told.
const TOLD_LINES: usize = 1000;
/// How much of a line is told.
const TOLD_BYTES: usize = 4096;

/// Who is told each line that a child says on standard error.
pub type Told = fn(&str);

/// What was said last, kept by a thread that reads until the pipe is closed.
#[derive(Debug)]
pub(crate) struct Tail {
    bytes: Arc<Mutex<Vec<u8>>>,
    /// Closed when the pipe is.
    closed: Receiver<()>,
}

impl Tail {
    pub(crate) fn of(mut stderr: ChildStderr, told: Option<Told>) -> Self {
        let bytes = Arc::new(Mutex::new(Vec::new()));
        let (open, closed) = channel();
        let kept = Arc::clone(&bytes);
        thread::spawn(move || {
            let _open = open;
            let mut buffer = [0; KEPT_BYTES];
            let mut lines = told.map(Lines::of);
            while let Ok(read @ 1..) = stderr.read(&mut buffer) {
                if let Some(lines) = &mut lines {
                    lines.take(&buffer[..read]);
                }
                let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
                kept.extend(&buffer[..read]);
                let excess = kept.len().saturating_sub(KEPT_BYTES);
                kept.drain(..excess);
            }
            if let Some(lines) = &mut lines {
                lines.end();
            }
        });
        Self { bytes, closed }
    }

    /// What there is by now, whole lines if there are any.
    pub(crate) fn words(&self) -> String {
        let bytes = self.bytes.lock().unwrap_or_else(PoisonError::into_inner);
        let text = String::from_utf8_lossy(&bytes);
        let whole = if bytes.len() < KEPT_BYTES { None } else { text.split_once('\n').map(|(_, rest)| rest) };
        whole.filter(|rest| !rest.is_empty()).unwrap_or(&text).trim_end().to_owned()
    }

    /// The same once the child has ended and all that it said was read.
    pub(crate) fn last_words(&self) -> String {
        // Nothing is ever sent: either the thread ends or patience does.
        let _: Result<(), RecvTimeoutError> = self.closed.recv_timeout(PATIENCE);
        self.words()
    }
}

/// Lines on their way to whoever is told them: so many, and so much of each.
struct Lines {
    told: Told,
    line: Vec<u8>,
    count: usize,
}

impl Lines {
    fn of(told: Told) -> Self {
        Self { told, line: Vec::new(), count: 0 }
    }

    fn take(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            if byte == b'\n' {
                self.tell();
            } else if self.line.len() < TOLD_BYTES {
                self.line.push(byte);
            }
        }
    }

    fn end(&mut self) {
        if !self.line.is_empty() {
            self.tell();
        }
    }

    fn tell(&mut self) {
        self.count += 1;
        match self.count {
            ..=TOLD_LINES => (self.told)(String::from_utf8_lossy(&self.line).trim_end_matches('\r')),
            count if count == TOLD_LINES + 1 => {
                (self.told)("it says more on standard error, which is not shown")
            }
            _ => {}
        }
        self.line.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_told_up_to_a_limit_of_each_and_of_all() {
        static SAID: Mutex<Vec<String>> = Mutex::new(Vec::new());
        let mut lines = Lines::of(|line| SAID.lock().unwrap().push(line.to_owned()));
        lines.take(b"first\r\nl\xc3");
        lines.take(b"st\n");
        lines.take(&[b'x'; 3 * TOLD_BYTES]);
        lines.take("\ny".repeat(TOLD_LINES + 100).as_bytes());
        lines.end();
        let said = SAID.lock().unwrap();
        assert_eq!(said[..2], ["first", "l\u{fffd}st"]);
        assert_eq!(said[2].len(), TOLD_BYTES);
        assert_eq!(said.len(), TOLD_LINES + 1);
        assert!(said[TOLD_LINES].contains("more"), "{}", said[TOLD_LINES]);
    }
}
