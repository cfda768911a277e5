//! The end of a program's standard error.

use std::io::Read;
use std::process::ChildStderr;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

const KEPT_BYTES: usize = 4096;
/// A process that left the group may hold the pipe open for ever.
const PATIENCE: Duration = Duration::from_millis(300);

/// What was said last, kept by a thread that reads until the pipe is closed.
#[derive(Debug)]
pub(crate) struct Tail {
    bytes: Arc<Mutex<Vec<u8>>>,
    /// Closed when the pipe is.
    closed: Receiver<()>,
}

impl Tail {
    pub(crate) fn of(mut stderr: ChildStderr) -> Self {
        let bytes = Arc::new(Mutex::new(Vec::new()));
        let (open, closed) = channel();
        let kept = Arc::clone(&bytes);
        thread::spawn(move || {
            let _open = open;
            let mut buffer = [0; KEPT_BYTES];
            while let Ok(read @ 1..) = stderr.read(&mut buffer) {
                let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
                kept.extend(&buffer[..read]);
                let excess = kept.len().saturating_sub(KEPT_BYTES);
                kept.drain(..excess);
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

    /// The same once the program has ended and all that it said was read.
    pub(crate) fn last_words(&self) -> String {
        // Nothing is ever sent: either the thread ends or patience does.
        let _: Result<(), RecvTimeoutError> = self.closed.recv_timeout(PATIENCE);
        self.words()
    }
}
