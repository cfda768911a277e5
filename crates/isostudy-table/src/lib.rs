//! A table that prints itself as CSV, Markdown, LaTeX and HTML.

mod columns;
pub mod digits;
pub mod formula;
mod html;
mod latex;
pub mod markdown;

pub use crate::columns::Columns;

use crate::digits::{number, signed};

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Nothing there; prints as nothing.
    Missing,
    /// Text.
    Text(String),
    /// A whole number.
    Count(i64),
    /// A number: in full in CSV, to so many decimals elsewhere.
    Number(f64, usize),
    /// A p value: in full in CSV, elsewhere to so many decimals, or as smaller than the last of them: never as zero.
    P(f64, usize),
}

/// A column's name in CSV, its heading elsewhere, and its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name in CSV: stable, for scripts.
    pub name: String,
    /// Heading in Markdown, LaTeX and HTML: for people.
    pub heading: String,
    /// Unit of its numbers, said by the heading or not; empty where there is none.
    pub unit: String,
}

/// A table: columns, rows, and how it is printed for people.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// File name without extension.
    pub name: String,
    /// Caption; may be empty for a part of another table.
    pub caption: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows, as long as `columns` each.
    pub rows: Vec<Vec<Cell>>,
    /// Printed under the table, one paragraph each.
    pub notes: Vec<String>,
    /// What Markdown, LaTeX and HTML print instead of one wide table: blocks of columns, or another arrangement of the
    /// same numbers. Empty prints the table itself. CSV is always the table itself.
    pub parts: Vec<Table>,
}

impl Cell {
    /// Text, whatever it is printed from.
    pub fn text(text: impl ToString) -> Self {
        Self::Text(text.to_string())
    }

    /// A whole number that was counted.
    ///
    /// # Panics
    /// If the count is above 2^63.
    pub fn count(count: u64) -> Self {
        Self::Count(i64::try_from(count).expect("counts fit 63 bits"))
    }

    /// A number with so many decimals for people, or nothing.
    pub fn number(value: Option<f64>, decimals: usize) -> Self {
        value.map_or(Self::Missing, |value| Self::Number(value, decimals))
    }

    /// A p value with so many decimals for people, or nothing.
    pub fn p(value: Option<f64>, decimals: usize) -> Self {
        value.map_or(Self::Missing, |value| Self::P(value, decimals))
    }

    /// A sum of terms about as large as 1, or their mean: what is left of them below 1e-12 is their rounding, and zero.
    pub fn of_sum(value: Option<f64>, decimals: usize) -> Self {
        Self::number(value.map(|value| if value.abs() < 1e-12 { 0.0 } else { value }), decimals)
    }

    /// In full, as in CSV: the shortest text that reads back as the same number. A p too small for a double is no zero
    /// either: it is the least double that there is, 5e-324.
    pub fn in_full(&self) -> String {
        match self {
            Self::Missing => String::new(),
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::Number(value, _) => shortest(*value),
            Self::P(value, _) => shortest(value.max(f64::from_bits(1))),
        }
    }

    /// In full, and no formula to a spreadsheet: names come from files of answers.
    fn in_csv(&self) -> String {
        match self {
            Self::Text(text) => formula::escape(text).into_owned(),
            other => other.in_full(),
        }
    }

    /// For people: numbers to the column's decimals, with a true minus sign.
    pub fn shown(&self) -> String {
        match self {
            Self::Number(value, decimals) => number(*value, *decimals),
            Self::Count(count) => signed(&count.to_string()),
            Self::P(value, decimals) => {
                let least = 10.0_f64.powi(-i32::try_from(*decimals).expect("a few decimals"));
                if *value < least { format!("< {least:.decimals$}") } else { format!("{value:.decimals$}") }
            }
            other => other.in_full(),
        }
    }

    fn is_text(&self) -> bool {
        matches!(self, Self::Text(_))
    }
}

/// The shortest text that reads back as the same number; 1e-300 has no need of three hundred zeros, nor zero of a sign.
fn shortest(value: f64) -> String {
    match value {
        0.0 => "0".into(),
        value if value.abs() < 1e-5 => format!("{value:e}"),
        value => value.to_string(),
    }
}

impl Table {
    /// With one more note.
    #[must_use]
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }

    /// The table, or nothing if it has no row.
    pub fn unless_empty(self) -> Option<Self> {
        (!self.rows.is_empty()).then_some(self)
    }

    /// Some of the columns, by name, as a table without notes; names that are not there are skipped.
    pub fn block(&self, caption: &str, columns: &[&str]) -> Self {
        let index = |name: &&str| self.columns.iter().position(|column| column.name == *name);
        self.picked(caption, &columns.iter().filter_map(index).collect::<Vec<_>>())
    }

    /// Some of the columns, by place.
    fn picked(&self, caption: &str, picked: &[usize]) -> Self {
        Self {
            name: self.name.clone(),
            caption: caption.into(),
            columns: picked.iter().map(|&i| self.columns[i].clone()).collect(),
            rows: self.rows.iter().map(|row| picked.iter().map(|&i| row[i].clone()).collect()).collect(),
            notes: Vec::new(),
            parts: Vec::new(),
        }
    }

    /// Headings, for people.
    pub fn headings(&self) -> Vec<&str> {
        self.columns.iter().map(|column| column.heading.as_str()).collect()
    }

    /// Rows as text, for people.
    pub fn shown_rows(&self) -> Vec<Vec<String>> {
        self.rows.iter().map(|row| row.iter().map(Cell::shown).collect()).collect()
    }

    /// The table itself, if it has no parts, or its parts.
    pub fn printed(&self) -> &[Table] {
        if self.parts.is_empty() { std::slice::from_ref(self) } else { &self.parts }
    }

    /// Whether a column holds text (and is set flush left) rather than numbers.
    pub fn is_text_column(&self, column: usize) -> bool {
        self.rows.iter().any(|row| row[column].is_text())
    }

    /// Comma-separated values: a header of column names, then every row, numbers in full; LF line ends, quotes where
    /// needed. Captions and notes are left out.
    pub fn to_csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let into_memory = "writing to memory cannot fail";
        writer.write_record(self.columns.iter().map(|column| &column.name)).expect(into_memory);
        for row in &self.rows {
            writer.write_record(row.iter().map(Cell::in_csv)).expect(into_memory);
        }
        String::from_utf8(writer.into_inner().expect(into_memory)).expect("made of strings")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Its cells in rows, by place.
    fn table(name: &str, caption: &str, columns: &[(&str, &str)], rows: &[Vec<Cell>]) -> Table {
        let places = columns.iter().enumerate();
        Columns::over(rows)
            .columns_of(places, |all, (i, &(name, heading))| {
                all.column(name, heading, move |row| row[i].clone())
            })
            .into_table(name, caption)
    }

    #[test]
    fn a_name_is_no_formula() {
        let row = vec![Cell::text("=HYPERLINK(1)"), Cell::Count(-3)];
        let table = table("t", "", &[("item", "Item"), ("net", "Net")], &[row]);
        assert_eq!(table.to_csv(), "item,net\n'=HYPERLINK(1),-3\n");
    }

    fn awkward() -> Table {
        let columns = [("id", "The id"), ("n_|x|", "|x|"), ("m", "mean")];
        let rows = [
            vec![Cell::text("ss_bi, \"q\""), Cell::Count(-3), Cell::Number(1.0 / 3.0, 2)],
            vec![Cell::text("a|b\\c\n*d* <e> ~^{}"), Cell::Missing, Cell::Number(2.0, 2)],
        ];
        table("awkward", "50 % of a_b & c", &columns, &rows).with_note("100 % & more")
    }

    #[test]
    fn csv_quotes_and_keeps_digits() {
        let want = "id,n_|x|,m\n\"ss_bi, \"\"q\"\"\",-3,0.3333333333333333\n\"a|b\\c\n*d* <e> ~^{}\",,2\n";
        assert_eq!(awkward().to_csv(), want);
    }

    #[test]
    fn markdown_escapes() {
        let want = "\
**50 % of a\\_b &amp; c**

| The id | \\|x\\| | mean |
|:---|---:|---:|
| ss\\_bi, \"q\" | \u{2212}3 | 0.33 |
| a\\|b\\\\c \\*d\\* &lt;e> ~^{} |  | 2.00 |

100 % &amp; more
";
        assert_eq!(awkward().to_markdown(), want);
    }

    #[test]
    fn latex_escapes() {
        let latex = awkward().to_latex();
        assert!(latex.contains("\\caption{50 \\% of a\\_b \\& c}"), "{latex}");
        assert!(latex.contains("ss\\_bi, \"q\" & $-$3 & 0.33 \\\\"), "{latex}");
        let row = "a\\textbar{}b\\textbackslash{}c *d* \\textless{}e\\textgreater{} \\textasciitilde{}\\textasciicircum{}\\{\\}";
        assert!(latex.contains(row), "{latex}");
        assert!(latex.contains("\\begin{tabular}{lrr}"), "{latex}");
        assert!(latex.contains("\\label{tab:awkward}"), "{latex}");
    }

    #[test]
    fn latex_breaks_text_before_it_turns_the_page() {
        let columns = [("id", "Id"), ("why", "Why"), ("n", "Of all cases")];
        let why =
            "a reason that takes more than a line of the page to tell, and then goes on for a while more";
        let mut rows = vec![vec![Cell::text("a"), Cell::text(why), Cell::Count(1)]];
        let latex = table("wide", "", &columns, &rows).to_latex();
        assert!(latex.starts_with("% needs \\usepackage{array}\n\\begin{table}"), "{latex}");
        assert!(latex.contains("{l>{\\raggedright\\arraybackslash}p{0."), "{latex}");
        assert!(latex.contains("Why & \\shortstack[r]{Of\\\\all\\\\cases} \\\\"), "{latex}");
        for _ in 0..35 {
            rows.push(vec![Cell::text("unbroken".repeat(12)), Cell::text(why), Cell::Count(1)]);
        }
        let latex = table("wide", "", &columns, &rows).to_latex();
        assert!(
            latex.starts_with("% needs \\usepackage{array,longtable,lscape}\n\\begin{landscape}"),
            "{latex}"
        );
        assert!(latex.contains("\\endfirsthead") && latex.ends_with("\\end{landscape}\n"), "{latex}");
    }

    #[test]
    fn what_fits_no_page_keeps_its_numbers_flush_right() {
        let columns: Vec<String> = (0..60).map(|i| format!("n{i}")).collect();
        let mut headings = vec![("id", "Id"), ("why", "Why")];
        headings.extend(columns.iter().map(|name| (name.as_str(), name.as_str())));
        let mut row = vec![Cell::text("a"), Cell::text("words that may be broken into lines")];
        row.extend((0..60).map(|_| Cell::Number(-1234.5, 2)));
        let latex = table("wide", "", &headings, &[row]).to_latex();
        assert!(latex.contains("{l>{\\raggedright\\arraybackslash}p{0."), "{latex}");
        assert!(latex.contains(&format!("\\linewidth}}{}}}\n", "r".repeat(60))), "{latex}");
        assert!(latex.contains("& $-$1234.50 &"), "{latex}");
    }

    #[test]
    fn html_escapes() {
        let html = awkward().to_html();
        assert!(html.contains("<caption>50 % of a_b &amp; c</caption>"), "{html}");
        assert!(html.contains("<td>ss_bi, &quot;q&quot;</td><td class=\"number\">\u{2212}3</td>"), "{html}");
        assert!(html.contains("&lt;e&gt;"), "{html}");
    }

    #[test]
    fn small_p_values_are_not_zero() {
        let shown = |p: f64, decimals| Cell::P(p, decimals).shown();
        assert_eq!((shown(0.00004, 4), shown(0.00006, 4)), ("< 0.0001".into(), "< 0.0001".into()));
        assert_eq!(
            (shown(0.0, 5), shown(7.17e-6, 5), shown(1.0, 4)),
            ("< 0.00001".into(), "< 0.00001".into(), "1.0000".into())
        );
        let full = [0.04, 2e-5, 7.17e-6, 1e-300, 0.0].map(|p| Cell::P(p, 4).in_full());
        assert_eq!(full, ["0.04", "0.00002", "7.17e-6", "1e-300", "5e-324"]);
        let table = table("p", "", &[("p", "p")], &[vec![Cell::P(1e-9, 4)]]);
        assert!(table.to_markdown().contains("| &lt; 0.0001 |"), "{}", table.to_markdown());
        assert!(table.to_latex().contains("\\textless{} 0.0001"), "{}", table.to_latex());
        assert!(table.to_html().contains("<td class=\"number\">&lt; 0.001</td>"), "{}", table.to_html());
    }

    #[test]
    fn what_sums_leave_of_zero_is_zero() {
        // In doubles 0.1 + 0.2 - 0.3 is 5.6e-17.
        let full = |x: f64| Cell::of_sum(Some(x), 3).in_full();
        assert_eq!([0.1 + 0.2 - 0.3, -0.0, 1.0 / 27.0 - 0.5].map(full), ["0", "0", "-0.46296296296296297"]);
        let full = [-2.5e-7, 0.0, 1e5].map(|x| Cell::Number(x, 3).in_full());
        assert_eq!(full, ["-2.5e-7", "0", "100000"]);
    }

    #[test]
    fn blocks_print_apart_but_csv_stays_whole() {
        let mut table = awkward();
        table.parts =
            vec![table.block("First", &["id", "m"]), table.block("Second", &["id", "n_|x|", "absent"])];
        assert_eq!(table.to_csv(), awkward().to_csv());
        assert_eq!(table.printed()[1].headings(), ["The id", "|x|"]);
        let markdown = table.to_markdown();
        assert!(markdown.contains("| The id | mean |") && markdown.contains("**Second**"), "{markdown}");
        let latex = table.to_latex();
        assert!(latex.matches("\\begin{tabular}").count() == 2 && latex.matches("\\caption").count() == 1);
    }
}
