//! GitHub-flavoured Markdown.

use crate::Table;

impl Table {
    /// A bold caption, a pipe table (or one a part, under bold captions of their own), and the notes.
    pub fn to_markdown(&self) -> String {
        let mut text = format!("**{}**\n", escape(&self.caption));
        for part in self.printed() {
            text.push('\n');
            if !self.parts.is_empty() && !part.caption.is_empty() {
                text.push_str(&format!("**{}**\n\n", escape(&part.caption)));
            }
            let headings: Vec<String> = part.headings().into_iter().map(escape).collect();
            text.push_str(&format!("| {} |\n|", headings.join(" | ")));
            for column in 0..part.columns.len() {
                text.push_str(if part.is_text_column(column) { ":---|" } else { "---:|" });
            }
            text.push('\n');
            for row in part.shown_rows() {
                let cells: Vec<String> = row.iter().map(|cell| escape(cell)).collect();
                text.push_str(&format!("| {} |\n", cells.join(" | ")));
            }
        }
        for note in &self.notes {
            text.push_str(&format!("\n{}\n", escape(note)));
        }
        text
    }
}

/// What Markdown would read as mark-up, and line breaks, which end a row.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '\\' | '|' | '_' | '*' | '`' | '[' | ']' => out.extend(['\\', letter]),
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '\n' | '\r' => out.push(' '),
            _ => out.push(letter),
        }
    }
    out
}
