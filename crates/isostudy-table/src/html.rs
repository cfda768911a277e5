//! HTML fragments.

use crate::{Cell, Table};

impl Table {
    /// One `<table>` a part, class `number` on cells of number columns, then the notes as paragraphs of class `note`.
    /// Text is escaped; nothing else is put round it. A p below 0.001 is `< 0.001`: CSV has its digits.
    pub fn to_html(&self) -> String {
        self.html(false)
    }

    /// The same with its heading on each cell, as `data-label`: a style can set rows as cards on a narrow screen. The first
    /// cell of a row has the class `verdict`, and its text, with hyphens for spaces, as another one.
    pub fn to_html_cards(&self) -> String {
        self.html(true)
    }

    fn html(&self, cards: bool) -> String {
        let mut text = String::new();
        for (i, part) in self.printed().iter().enumerate() {
            let caption = match (self.parts.len(), i) {
                (0, _) => self.caption.clone(),
                (1, _) => part.caption.clone(),
                (_, 0) => format!("{}. {}", self.caption.trim_end_matches('.'), part.caption),
                (_, _) => part.caption.clone(),
            };
            text.push_str(&format!("<table>\n<caption>{}</caption>\n<thead><tr>", escape(&caption)));
            for (column, heading) in part.headings().into_iter().enumerate() {
                let class = if part.is_text_column(column) { "" } else { " class=\"number\"" };
                text.push_str(&format!("<th scope=\"col\"{class}>{}</th>", escape(heading)));
            }
            text.push_str("</tr></thead>\n<tbody>\n");
            for row in &part.rows {
                text.push_str("<tr>");
                for (column, cell) in row.iter().enumerate() {
                    text.push_str(&format!(
                        "<td{}>{}</td>",
                        attributes(part, column, cell, cards),
                        escape(&on_page(cell))
                    ));
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

fn on_page(cell: &Cell) -> String {
    match cell {
        Cell::P(value, decimals) if *value < 1e-3 && *decimals >= 3 => "< 0.001".into(),
        other => other.shown(),
    }
}

fn attributes(part: &Table, column: usize, cell: &Cell, cards: bool) -> String {
    let mut classes = Vec::new();
    if !part.is_text_column(column) {
        classes.push("number".to_owned());
    }
    if cards && column == 0 {
        classes.push("verdict".into());
        classes.push(cell.shown().replace(' ', "-"));
    }
    let class =
        if classes.is_empty() { String::new() } else { format!(" class=\"{}\"", escape(&classes.join(" "))) };
    match cards {
        true => format!("{class} data-label=\"{}\"", escape(&part.columns[column].heading)),
        false => class,
    }
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
