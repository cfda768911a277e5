//! What is said on standard output and standard error.

use anyhow::Result;
use isostudy_foreign::shown;
use std::borrow::Cow;
use std::collections::HashSet;
use std::io::{ErrorKind, Write};
use std::sync::{Mutex, PoisonError};

/// As `eprintln!`, which panics where a line cannot be written: on a full disk, or to a reader that has gone. What a terminal would obey
/// is escaped, since words may come from any file.
macro_rules! tell {
    ($($words:tt)*) => {
        $crate::terminal::tell_shown(&format!($($words)*))
    };
}

// After the macro, which it uses.
pub(crate) mod progress;

/// The most characters of a line on standard error. A message may quote a line of somebody's file, which can be as long as the file.
const MOST_OF_A_LINE: usize = 2000;

/// What `tell!` says.
pub(crate) fn tell_shown(words: &str) {
    let words = shown(words);
    let lines: Vec<_> = words.split('\n').map(shortened).collect();
    let _ = writeln!(std::io::stderr(), "{}", lines.join("\n"));
}

fn shortened(line: &str) -> Cow<'_, str> {
    match line.char_indices().nth(MOST_OF_A_LINE) {
        None => line.into(),
        Some((end, _)) => {
            format!("{} ({} characters more)", &line[..end], grouped(line[end..].chars().count() as u64))
                .into()
        }
    }
}

/// Says a line as `tell!` does, unless this process or one that it measures with has said it before.
pub(crate) fn tell_once(line: &str) {
    static SAID: Mutex<Option<HashSet<String>>> = Mutex::new(None);
    let mut said = SAID.lock().unwrap_or_else(PoisonError::into_inner);
    if said.get_or_insert_default().insert(line.to_owned()) {
        tell!("{line}");
    }
}

/// Prints a line on standard output, what a terminal would obey escaped. A reader that has gone away is no error.
///
/// # Errors
/// If standard output cannot be written.
pub(crate) fn say(line: &str) -> Result<()> {
    match writeln!(std::io::stdout(), "{}", shown(line)) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

/// `1 answer`, `2 answers`.
pub(crate) fn counted(number: u64, word: &str) -> String {
    format!("{number} {word}{}", if number == 1 { "" } else { "s" })
}

/// `1,234,567`.
pub(crate) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let first = digits.len() % 3;
    let rest = digits.as_bytes()[first..].chunks(3).map(|group| String::from_utf8_lossy(group).into_owned());
    let groups: Vec<String> =
        Some(digits[..first].to_owned()).filter(|of| !of.is_empty()).into_iter().chain(rest).collect();
    groups.join(",")
}

/// A number with seven significant digits.
pub(crate) fn significant(value: f64) -> String {
    let size = value.abs();
    if value != 0.0 && !(1e-4..1e7).contains(&size) {
        return format!("{value:.6e}");
    }
    let decimals = if value == 0.0 { 0 } else { (6.0 - size.log10().floor()) as usize };
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_long_line_the_beginning_is_told() {
        assert_eq!(shortened("a line"), "a line");
        let most = "\u{e9}".repeat(MOST_OF_A_LINE);
        assert_eq!(shortened(&most), most);
        assert_eq!(
            shortened(&format!("{most}{}", "x".repeat(70_000))),
            format!("{most} (70,000 characters more)")
        );
    }

    #[test]
    fn digits_are_grouped_by_three() {
        let numbers = [0, 7, 999, 1000, 12_345, 1_234_567, 100_000];
        let want = ["0", "7", "999", "1,000", "12,345", "1,234,567", "100,000"];
        assert_eq!(numbers.map(grouped), want);
    }
}
