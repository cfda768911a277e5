//! Text that came out of a file or a process, as people may see it.

use std::borrow::Cow;
use std::fmt::Write;

/// Whether a character moves what stands around it, or a terminal obeys it.
///
/// Control characters are those of Unicode (category Cc). The marks that turn the direction of text are those of its annex 9,
/// section 2; the separators of lines and paragraphs begin a line without being a line feed.
fn is_forging(c: char) -> bool {
    let is_mark =
        matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || is_mark || matches!(c, '\u{2028}' | '\u{2029}')
}

/// The text with control characters and marks of direction as `\u001b`. Line feeds, tabs and the ends of lines of Windows stay.
///
/// In a text of JSON the escapes mean the same characters, so that it is still the same JSON.
pub fn shown(text: &str) -> Cow<'_, str> {
    let stays = |c: char, next: Option<char>| matches!(c, '\n' | '\t') || (c == '\r' && next == Some('\n'));
    escaped(text, stays)
}

/// The same of what has to stay in one line: line feeds and tabs are escaped too.
pub fn shown_in_a_line(text: &str) -> Cow<'_, str> {
    escaped(text, |_, _| false)
}

fn escaped(text: &str, stays: impl Fn(char, Option<char>) -> bool) -> Cow<'_, str> {
    let mut out: Option<String> = None;
    let mut characters = text.char_indices().peekable();
    while let Some((at, c)) = characters.next() {
        let next = characters.peek().map(|&(_, next)| next);
        if is_forging(c) && !stays(c, next) {
            let out = out.get_or_insert_with(|| text[..at].to_owned());
            _ = write!(out, "\\u{:04x}", u32::from(c));
        } else if let Some(out) = &mut out {
            out.push(c);
        }
    }
    out.map_or(Cow::Borrowed(text), Cow::Owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_forges_is_escaped_and_all_else_stays() {
        assert!(matches!(shown("plain, größer, 中文, עברית, e\u{301}\n\tnext\r\n"), Cow::Borrowed(_)));
        assert_eq!(shown("a\r\u{1b}[2Kb"), "a\\u000d\\u001b[2Kb");
        assert_eq!(
            shown("\u{7f}\u{9b}31m \u{202e}txt\u{2066}\u{200f}\u{2028}"),
            "\\u007f\\u009b31m \\u202etxt\\u2066\\u200f\\u2028"
        );
        assert_eq!(shown_in_a_line("a\nb\tc\r\n"), "a\\u000ab\\u0009c\\u000d\\u000a");
    }

    #[test]
    fn every_control_character_is_escaped() {
        for c in ('\0'..='\u{ffff}').filter(|c| c.is_control()) {
            let text = format!("x{c}y");
            let line = shown_in_a_line(&text);
            assert!(!line.chars().any(char::is_control), "{c:?}");
            assert_eq!(shown(&text) == text, c == '\n' || c == '\t', "{c:?}");
        }
    }
}
