//! LaTeX for the `article` class or anything wider: the first layout, from plain to small to turned, that a table fits.

use crate::Table;
use crate::digits::MINUS;

/// Rows beyond which a table is broken across pages.
const PAGE: usize = 35;
/// Text longer than this many characters may be broken into lines.
const LINE: usize = 24;
/// The narrowest column of broken text, in em.
const NARROWEST: f64 = 8.0;

/// How a table is set. Widths are of the narrowest page to be expected: `article` at 10 pt, in points.
#[derive(Debug, Clone, Copy)]
struct Layout {
    /// Printed before the table, braces round both.
    set: &'static str,
    /// Points an em.
    em: f64,
    /// Points on either side of a column.
    gap: f64,
    turned: bool,
}

const LAYOUTS: [Layout; 6] = [
    Layout { set: "", em: 10.0, gap: 6.0, turned: false },
    Layout { set: "\\small\\setlength{\\tabcolsep}{3pt}", em: 9.25, gap: 3.0, turned: false },
    Layout { set: "\\footnotesize\\setlength{\\tabcolsep}{3pt}", em: 8.5, gap: 3.0, turned: false },
    Layout { set: "\\small\\setlength{\\tabcolsep}{3pt}", em: 9.25, gap: 3.0, turned: true },
    Layout { set: "\\footnotesize\\setlength{\\tabcolsep}{3pt}", em: 8.5, gap: 3.0, turned: true },
    Layout { set: "\\scriptsize\\setlength{\\tabcolsep}{2pt}", em: 8.0, gap: 2.0, turned: true },
];
/// Columns beyond which the plain layout is not tried.
const MANY: usize = 7;

impl Layout {
    fn width(self) -> f64 {
        if self.turned { 550.0 } else { 345.0 }
    }

    /// What a column may take of the line, gaps left out: its whole text, or as much as there is. `None` if there is not
    /// enough, unless it must do: broken text is then as narrow as it may be.
    fn columns(self, part: &Table, must: bool) -> Option<String> {
        let gaps = 2.0 * self.gap * part.columns.len() as f64;
        let columns: Vec<Column> = (0..part.columns.len()).map(|i| Column::of(part, i)).collect();
        let rigid: f64 = columns.iter().filter(|c| !c.breaks).map(|c| c.em).sum();
        let broken = columns.iter().filter(|c| c.breaks);
        let wanted: f64 = broken.clone().map(|c| c.em).sum();
        // Broken text shares what is left as it needs it, and asks for no more than would print it whole.
        let left = (self.width() - gaps) / self.em - rigid;
        let least = |c: &Column| NARROWEST.min(c.em);
        let share = |c: &Column| (left * c.em / wanted).min(c.em);
        let fits = left >= 0.0 && broken.clone().all(|c| share(c) >= least(c));
        if !fits && !must {
            return None;
        }
        let letter = |c: &Column| match (c.breaks, c.text) {
            (true, _) => {
                let em = if fits { share(c) } else { least(c) };
                let of_line = em * self.em / self.width();
                format!(">{{\\raggedright\\arraybackslash}}p{{{of_line:.3}\\linewidth}}")
            }
            (false, true) => "l".into(),
            (false, false) => "r".into(),
        };
        Some(columns.iter().map(letter).collect())
    }
}

/// What a column needs.
struct Column {
    /// Set flush left.
    text: bool,
    /// Has text that may be broken into lines.
    breaks: bool,
    /// Its longest cell or heading word, in em.
    em: f64,
}

impl Column {
    fn of(part: &Table, i: usize) -> Self {
        let cells: Vec<String> = part.rows.iter().map(|row| row[i].shown()).collect();
        let text = part.is_text_column(i);
        let breaks = text && cells.iter().any(|cell| cell.chars().count() > LINE && cell.contains(' '));
        let widest = |texts: &[String]| texts.iter().map(|text| em(text)).fold(0.0, f64::max);
        let em = widest(&cells).max(widest(&heading_lines(part, i)));
        Self { text, breaks, em }
    }
}

/// Width in em in Computer Modern Roman, rounded up by kind of letter.
fn em(text: &str) -> f64 {
    let letter = |c: char| match c {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' => 0.31,
        ' ' | '-' | 'f' | 'I' => 0.37,
        '(' | ')' | 't' | 'r' | 's' => 0.4,
        'a' | 'c' | 'e' | 'g' | 'o' | 'q' | 'v' | 'z' | '/' | '_' => 0.53,
        c if c.is_ascii_digit() => 0.51,
        'm' | 'w' | 'K' | 'O' | 'Q' | '%' | '<' | '>' | '=' | '+' | MINUS => 0.84,
        'M' | 'W' => 1.03,
        c if c.is_ascii_uppercase() => 0.79,
        _ => 0.57,
    };
    text.chars().map(letter).sum()
}

impl Table {
    /// One `tabular` a part in a `table`, or one `longtable` a part if there are more than 35 rows or the page has to be
    /// turned. Columns with text are set flush left, others flush right; long text is broken into lines, and headings
    /// are stacked. The first line, a comment, names the packages needed, all of them of every LaTeX.
    ///
    /// Fits a text block of 345 pt by 550 pt (`article`) if the smallest layout does; overfull beyond that.
    pub fn to_latex(&self) -> String {
        let parts = self.printed();
        let many = parts.iter().any(|part| part.columns.len() > MANY);
        let fits = |layout: &&Layout| parts.iter().all(|part| layout.columns(part, false).is_some());
        let layout = LAYOUTS[usize::from(many)..].iter().find(fits).unwrap_or(&LAYOUTS[LAYOUTS.len() - 1]);
        let long = layout.turned || parts.iter().map(|part| part.rows.len()).sum::<usize>() > PAGE;
        let columns = |part: &Self| layout.columns(part, true).expect("it must do");
        let body = if long { self.pages(&columns) } else { self.float(layout, &columns) };
        let body = match (long, layout.set) {
            (true, set) if !set.is_empty() => format!("{{{set}\n{body}}}\n"),
            _ => body,
        };
        let body = match layout.turned {
            true => format!("\\begin{{landscape}}\n{body}\\end{{landscape}}\n"),
            false => body,
        };
        let needs =
            [("array", body.contains("arraybackslash")), ("longtable", long), ("lscape", layout.turned)];
        let needs: Vec<&str> = needs.iter().filter(|(_, needed)| *needed).map(|(name, _)| *name).collect();
        match needs.is_empty() {
            true => format!("% needs no package\n{body}"),
            false => format!("% needs \\usepackage{{{}}}\n{body}", needs.join(",")),
        }
    }

    /// A float of one page.
    fn float(&self, layout: &Layout, columns: &dyn Fn(&Self) -> String) -> String {
        let caption = format!("\\caption{{{}}}\\label{{tab:{}}}", escape(&self.caption), self.name);
        let mut text = format!("\\begin{{table}}\n\\centering\n{caption}\n");
        if !layout.set.is_empty() {
            text.push_str(&format!("{}\n", layout.set));
        }
        for part in self.printed() {
            if !self.parts.is_empty() && !part.caption.is_empty() {
                text.push_str(&format!("\\par\\medskip {}\\par\\smallskip\n", escape(&part.caption)));
            }
            let (columns, header, rows) = (columns(part), header(part), rows(part));
            text.push_str(&format!(
                "\\begin{{tabular}}{{{columns}}}\n{header}{rows}\\hline\n\\end{{tabular}}\n"
            ));
        }
        text + &notes(self) + "\\end{table}\n"
    }

    /// As many pages as it takes.
    fn pages(&self, columns: &dyn Fn(&Self) -> String) -> String {
        let mut text = String::new();
        for (i, part) in self.printed().iter().enumerate() {
            let caption = match i {
                0 => format!("\\caption{{{}}}\\label{{tab:{}}}\\\\\n", escape(&self.caption), self.name),
                _ => String::new(),
            };
            let part_caption = match part.caption.as_str() {
                own if self.parts.is_empty() || own.is_empty() => String::new(),
                own => format!("\\multicolumn{{{}}}{{l}}{{{}}}\\\\\n", part.columns.len(), escape(own)),
            };
            let (columns, header, rows) = (columns(part), header(part), rows(part));
            text.push_str(&format!("\\begin{{longtable}}{{{columns}}}\n{caption}{part_caption}{header}"));
            text.push_str(&format!("\\endfirsthead\n{part_caption}{header}\\endhead\n"));
            text.push_str(&format!("{rows}\\hline\n\\end{{longtable}}\n"));
        }
        text + &notes(self)
    }
}

/// A heading in lines no wider than they must be: as its longest word or, for narrow words, the column's cells.
fn heading_lines(part: &Table, column: usize) -> Vec<String> {
    let words: Vec<&str> = part.columns[column].heading.split(' ').collect();
    let cells = part.rows.iter().map(|row| em(&row[column].shown())).fold(0.0, f64::max);
    let room = words.iter().map(|word| em(word)).fold(cells, f64::max);
    let mut lines: Vec<String> = Vec::new();
    for word in words {
        match lines.last_mut().filter(|line| em(line) + em(" ") + em(word) <= room) {
            Some(line) => *line = format!("{line} {word}"),
            None => lines.push(word.into()),
        }
    }
    lines
}

fn header(part: &Table) -> String {
    let heading = |i: usize| {
        let lines: Vec<String> = heading_lines(part, i).iter().map(|line| escape(line)).collect();
        match (lines.len(), part.is_text_column(i)) {
            (..=1, _) => lines.concat(),
            (_, true) => format!("\\shortstack[l]{{{}}}", lines.join("\\\\")),
            (_, false) => format!("\\shortstack[r]{{{}}}", lines.join("\\\\")),
        }
    };
    let headings: Vec<String> = (0..part.columns.len()).map(heading).collect();
    format!("\\hline\n{} \\\\\n\\hline\n", headings.join(" & "))
}

fn rows(part: &Table) -> String {
    let row = |row: Vec<String>| {
        let cells: Vec<String> = row.iter().map(|cell| escape(cell)).collect();
        format!("{} \\\\\n", cells.join(" & "))
    };
    part.shown_rows().into_iter().map(row).collect()
}

/// Flush left: a note may hold words that cannot be divided.
fn notes(table: &Table) -> String {
    let note = |note: &String| format!("\\par\\smallskip{{\\raggedright {}\\par}}\n", escape(note));
    table.notes.iter().map(note).collect()
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
            MINUS => out.push_str("$-$"),
            '\n' | '\r' => out.push(' '),
            _ => out.push(letter),
        }
    }
    out
}
