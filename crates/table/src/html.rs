//! HTML fragments.

use crate::Table;

impl Table {
    /// One `<table>` a part, class `number` on cells of number columns, then the notes as paragraphs of class `note`.
    /// Text is escaped; nothing else is put round it.
    pub fn to_html(&self) -> String {
        let mut text = String::new();
        for (i, part) in self.printed().iter().enumerate() {
            let caption = match (self.parts.is_empty(), i) {
                (true, _) => self.caption.clone(),
                (false, 0) => format!("{}. {}", self.caption.trim_end_matches('.'), part.caption),
                (false, _) => part.caption.clone(),
            };
            text.push_str(&format!("<table>\n<caption>{}</caption>\n<thead><tr>", escape(&caption)));
            for (column, heading) in part.headings().into_iter().enumerate() {
                text.push_str(&format!("<th{}>{}</th>", class(part, column), escape(heading)));
            }
            text.push_str("</tr></thead>\n<tbody>\n");
            for row in part.shown_rows() {
                text.push_str("<tr>");
                for (column, cell) in row.iter().enumerate() {
                    text.push_str(&format!("<td{}>{}</td>", class(part, column), escape(cell)));
                }
                text.push_str("</tr>\n");
            }
            text.push_str("</tbody>\n</table>\n");
        }
        for note in &self.notes {
            text.push_str(&format!("<p class=\"note\">{}</p>\n", escape(note)));
        }
        text
    }
}

fn class(part: &Table, column: usize) -> &'static str {
    if part.is_text_column(column) { "" } else { " class=\"number\"" }
}

fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            _ => out.push(letter),
        }
    }
    out
}
