//! LaTeX without any package, except `longtable` for tables longer than a page.

use super::Table;

/// Rows beyond which a table is broken across pages.
const PAGE: usize = 45;

impl Table {
    /// A `table` with one `tabular` a part, or a `longtable` if there are more than 45 rows. Columns with text are set
    /// flush left, others flush right. Long reasons are set in a column of fixed width.
    pub fn to_latex(&self) -> String {
        let long = self.printed().iter().any(|part| part.rows.len() > PAGE);
        let (caption, label) = (escape(&self.caption), &self.name);
        let mut text = String::new();
        if long {
            text.push_str("% needs \\usepackage{longtable}\n");
            for (i, part) in self.printed().iter().enumerate() {
                let head = match i {
                    0 => format!("\\caption{{{caption}}}\\label{{tab:{label}}}\\\\\n"),
                    _ => String::new(),
                };
                let (columns, header) = (columns(part), header(part));
                text.push_str(&format!("\\begin{{longtable}}{{{columns}}}\n{head}{header}\\endhead\n"));
                text.push_str(&format!("{}\\hline\n\\end{{longtable}}\n", rows(part)));
            }
            text.push_str(&notes(self));
        } else {
            text.push_str(&format!(
                "\\begin{{table}}\n\\centering\n\\caption{{{caption}}}\\label{{tab:{label}}}\n"
            ));
            for part in self.printed() {
                if !self.parts.is_empty() && !part.caption.is_empty() {
                    text.push_str(&format!("\\par\\medskip {}\\par\\smallskip\n", escape(&part.caption)));
                }
                let (columns, header, rows) = (columns(part), header(part), rows(part));
                text.push_str(&format!(
                    "\\begin{{tabular}}{{{columns}}}\n{header}{rows}\\hline\n\\end{{tabular}}\n"
                ));
            }
            text.push_str(&format!("{}\\end{{table}}\n", notes(self)));
        }
        text
    }
}

fn columns(part: &Table) -> String {
    let column = |i: usize| {
        let longest = part.rows.iter().map(|row| row[i].shown().chars().count()).max().unwrap_or(0);
        match (part.is_text_column(i), longest) {
            (true, 41..) => "p{0.35\\linewidth}",
            (true, _) => "l",
            (false, _) => "r",
        }
    };
    (0..part.columns.len()).map(column).collect()
}

fn header(part: &Table) -> String {
    let headings: Vec<String> = part.headings().into_iter().map(escape).collect();
    format!("\\hline\n{} \\\\\n\\hline\n", headings.join(" & "))
}

fn rows(part: &Table) -> String {
    let row = |row: Vec<String>| {
        let cells: Vec<String> = row.iter().map(|cell| escape(cell)).collect();
        format!("{} \\\\\n", cells.join(" & "))
    };
    part.shown_rows().into_iter().map(row).collect()
}

fn notes(table: &Table) -> String {
    table.notes.iter().map(|note| format!("\\par\\smallskip {}\n", escape(note))).collect()
}

/// LaTeX's special characters, and those that the OT1 font encoding prints as something else.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => out.extend(['\\', letter]),
            '\\' => out.push_str("\\textbackslash{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '^' => out.push_str("\\textasciicircum{}"),
            '|' => out.push_str("\\textbar{}"),
            '<' => out.push_str("\\textless{}"),
            '>' => out.push_str("\\textgreater{}"),
            '\n' | '\r' => out.push(' '),
            _ => out.push(letter),
        }
    }
    out
}
