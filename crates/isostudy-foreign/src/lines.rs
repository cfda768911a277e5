//! A program's output, line by line, read by a thread so that nobody has to wait for it.

use std::io::{BufRead, BufReader, Read};
use std::process::ChildStdout;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;
use std::time::Instant;

/// What was heard.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Heard {
    /// A line without its end, and when that came.
    Line(Vec<u8>, Instant),
    /// The beginning of a line that is too long; nothing comes after it.
    TooLong(Vec<u8>),
    /// The output's end, with what stood after the last line.
    End(Vec<u8>),
}

/// Lines as they come, none longer than `limit` bytes. Few are kept: a program that floods has to wait.
///
/// The thread ends with the output or with the receiver.
pub(crate) fn lines(output: ChildStdout, limit: usize) -> Receiver<Heard> {
    let (sender, receiver) = sync_channel(4);
    thread::spawn(move || read(output, limit, &sender));
    receiver
}

fn read(output: impl Read, limit: usize, heard: &SyncSender<Heard>) {
    let mut output = BufReader::new(output);
    loop {
        let mut line = Vec::new();
        let read = output.by_ref().take(limit as u64 + 1).read_until(b'\n', &mut line);
        let what = match (read, line.pop()) {
            (Ok(_), Some(b'\n')) => Heard::Line(line, Instant::now()),
            (read, last) => {
                line.extend(last);
                if read.is_ok() && line.len() > limit { Heard::TooLong(line) } else { Heard::End(line) }
            }
        };
        let is_last = !matches!(what, Heard::Line(..));
        if heard.send(what).is_err() || is_last {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(bytes: &[u8], limit: usize) -> Vec<Heard> {
        let (sender, receiver) = sync_channel(100);
        read(bytes, limit, &sender);
        drop(sender);
        receiver.into_iter().collect()
    }

    #[test]
    fn a_line_of_the_limit_is_heard_and_one_byte_more_is_not() {
        // The limit is without the line's end.
        let [Heard::Line(line, _), Heard::End(rest)] = &heard(b"12345\n", 5)[..] else {
            panic!("a line, the end")
        };
        assert_eq!((&line[..], &rest[..]), (&b"12345"[..], &b""[..]));
        let [Heard::TooLong(start)] = &heard(b"123456\nafter\n", 5)[..] else {
            panic!("nothing after a long line")
        };
        assert_eq!(start, b"123456");
    }

    #[test]
    fn what_stands_after_the_last_line_comes_with_the_end() {
        let [Heard::Line(one, _), Heard::Line(none, _), Heard::End(rest)] = &heard(b"one\n\ntw", 9)[..]
        else {
            panic!("two lines, the end")
        };
        assert_eq!((&one[..], &none[..], &rest[..]), (&b"one"[..], &b""[..], &b"tw"[..]));
    }
}
