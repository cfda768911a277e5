//! Lines for whoever runs the server. A log that cannot be written, or that nobody reads, holds up nothing and ends nothing:
//! lines go through a thread of their own, and what does not fit is left out.

use std::io::Write;
use std::sync::OnceLock;
use std::sync::mpsc::{SyncSender, sync_channel};

/// Most lines that wait to be written.
const WAITING: usize = 64;

struct Log {
    lines: SyncSender<String>,
}

impl Log {
    fn to(mut writer: impl Write + Send + 'static) -> Self {
        let (lines, waiting) = sync_channel::<String>(WAITING);
        std::thread::spawn(move || {
            for line in waiting {
                // A full disk, or a reader that has gone.
                drop(writeln!(writer, "{line}"));
            }
        });
        Self { lines }
    }

    fn note(&self, line: String) {
        drop(self.lines.try_send(line));
    }
}

/// Writes a line on standard error, now or soon or never.
pub(crate) fn note(line: impl Into<String>) {
    static LOG: OnceLock<Log> = OnceLock::new();
    LOG.get_or_init(|| Log::to(std::io::stderr())).note(line.into());
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Error, Result};
    use std::sync::mpsc::{Receiver, channel};
    use std::time::Duration;

    /// Waits for a word before each write, and then fails.
    struct Full(Receiver<()>, std::sync::mpsc::Sender<()>);

    impl Write for Full {
        fn write(&mut self, _: &[u8]) -> Result<usize> {
            let _ = self.0.recv();
            let _ = self.1.send(());
            Err(Error::other("full"))
        }

        fn flush(&mut self) -> Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_log_that_is_stuck_or_full_holds_up_nobody() {
        let (go, wait) = channel();
        let (tried, tries) = channel();
        let log = Log::to(Full(wait, tried));
        // Far more than fit, while nothing can be written.
        (0..10 * WAITING).for_each(|n| log.note(n.to_string()));
        drop(go);
        // Every line that was kept is tried, although each fails.
        let tried =
            (0..).map_while(|_| tries.recv_timeout(Duration::from_secs(5)).ok()).take(WAITING).count();
        assert_eq!(tried, WAITING);
    }
}
