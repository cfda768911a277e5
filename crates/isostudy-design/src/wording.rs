//! What helps somebody to mend a file: the line on which a key stands, and the known word that a wrong one is nearest to.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The line, counted from 1, on which a key such as `objects[1].field` stands in a TOML text; of a key that is not there, of the table
/// that lacks it. `None` where nothing of it is there, or the text is no TOML.
pub fn line_of(text: &str, key: &str) -> Option<usize> {
    let root = DeTable::parse(text).ok()?;
    let mut found = None;
    let mut table = Some(root.get_ref());
    for step in key.split('.') {
        let (name, places) = step.split_once('[').map_or((step, ""), |(name, rest)| (name, rest));
        let Some((key, value)) = table.and_then(|table| table.iter().find(|(key, _)| *key.get_ref() == name))
        else {
            break;
        };
        let mut value: &Spanned<DeValue<'_>> = value;
        found = Some(key.span().start);
        for place in places.split(['[', ']']).filter_map(|place| place.parse::<usize>().ok()) {
            let Some(item) = value.get_ref().as_array().and_then(|items| items.get(place)) else { break };
            value = item;
            found = Some(value.span().start);
        }
        table = value.get_ref().as_table();
    }
    // The span of a [[table]] may begin with the line before it.
    let start = found?;
    let blank = text[start..].len() - text[start..].trim_start().len();
    Some(1 + text[..start + blank].matches('\n').count())
}

/// The known word that is most like a wrong one: the same in other letters, else a third of its letters apart at most. `None` where
/// two are as near.
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let plain = |word: &str| word.to_lowercase().replace(['_', ' '], "-");
    let of = plain(word);
    let far = |other: &str| distance(&of, &plain(other));
    let mut near: Vec<(usize, &str)> = known.into_iter().map(|other| (far(other), other)).collect();
    near.sort();
    near.dedup();
    let &(apart, other) = near.first()?;
    let most = of.chars().count() / 3;
    let is_alone = near.get(1).is_none_or(|next| next.0 > apart);
    (is_alone && apart <= most).then_some(other)
}

/// `; did you mean X?` where a known word is near, else nothing: to be put at the end of a sentence.
pub fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(word, known).map_or_else(String::new, |other| format!("; did you mean {other}?"))
}

/// A message of serde in a reader's words: without names of types in the program, and with the nearest of the words that it expected.
pub fn plainly(message: &str) -> String {
    let mut said = Vec::new();
    for line in message.lines() {
        let line = without_types(line);
        let meant = unknown(&line).and_then(|(word, known)| nearest(word, known));
        said.push(match meant {
            Some(other) => line.replacen(", expected", &format!("; did you mean {other}? Expected"), 1),
            None if line.starts_with("unknown variant `") => line.replacen("`, expected", "`. Expected", 1),
            None => line,
        });
    }
    said.iter().map(|line| unknown_word(line)).collect::<Vec<_>>().join("\n")
}

/// ``unknown variant `x` `` is `` `x` is not known here ``.
fn unknown_word(line: &str) -> String {
    match line.strip_prefix("unknown variant `").and_then(|rest| rest.split_once('`')) {
        Some((word, rest)) => format!("`{word}` is not known here{rest}"),
        None => line.to_owned(),
    }
}

/// The word that was not expected, and those that were.
fn unknown(line: &str) -> Option<(&str, Vec<&str>)> {
    let rest = ["unknown variant `", "unknown field `"].iter().find_map(|start| line.strip_prefix(start))?;
    let (word, rest) = rest.split_once('`')?;
    let (_, expected) = rest.split_once("expected ")?;
    Some((word, expected.split('`').skip(1).step_by(2).collect()))
}

/// `expected struct StudySection` is `expected a table`.
fn without_types(line: &str) -> String {
    let mut line = line.to_owned();
    for (start, plain) in [
        ("invalid type: map", "invalid type: a table"),
        ("invalid type: sequence", "invalid type: a list"),
        ("expected f64", "expected a number"),
        ("expected u32", "expected a whole number"),
        ("expected u64", "expected a whole number"),
        ("expected a sequence", "expected a list"),
        ("expected struct ", "expected a table"),
        ("expected internally tagged enum ", "expected a table with a kind"),
        ("expected enum ", "expected a word"),
        ("variant of enum ", "one of its words"),
    ] {
        if let Some(place) = line.find(start) {
            let rest = &line[place + start.len()..];
            let name = rest.chars().take_while(|letter| {
                start.ends_with(' ') && (letter.is_alphanumeric() || ":<>_".contains(*letter))
            });
            let end = place + start.len() + name.map(char::len_utf8).sum::<usize>();
            line.replace_range(place..end, plain);
        }
    }
    line
}

/// The number of letters to add, drop, replace or exchange with the next (Damerau 1964, each place once).
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows = vec![(0..=b.len()).collect::<Vec<usize>>()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let above = &rows[i - 1];
            let mut least =
                (above[j] + 1).min(row[j - 1] + 1).min(above[j - 1] + usize::from(a[i - 1] != b[j - 1]));
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "schema = 1\ncomparisons = [\n  { left = \"a\" },\n  { left = \"b\",\n right = \"c\" },\n]\n\n[study]\nid = \"x\"\n\n\
                        [[objects]]\nid = \"o\"\n\n[[objects]]\nid = \"p\"\nfield = { kind = \"sphere\" }\nmax = [1.0,\n 2.0]\n";

    #[test]
    fn a_key_is_on_its_line() {
        for (key, line) in [
            ("schema", Some(1)),
            ("comparisons", Some(2)),
            ("comparisons[0].left", Some(3)),
            ("comparisons[1].left", Some(4)),
            ("comparisons[1].right", Some(5)),
            ("study.id", Some(9)),
            ("study.title", Some(8)),
            ("objects[0].id", Some(12)),
            ("objects[1]", Some(14)),
            ("objects[1].name", Some(14)),
            ("objects[1].field.kind", Some(16)),
            ("objects[1].max[1]", Some(18)),
            ("objects[7].id", Some(11)),
            ("limits.memory_gib", None),
        ] {
            assert_eq!(line_of(TEXT, key), line, "{key}");
        }
        assert_eq!(line_of("a = ", "a"), None);
    }

    #[test]
    fn the_nearest_word_is_meant() {
        let known = ["cubes", "tetrahedra", "surface-nets", "dual-contouring", "mc", "mc33"];
        for (word, meant) in [
            ("MC", Some("mc")),
            ("cube", Some("cubes")),
            ("Surface_Nets", Some("surface-nets")),
            ("tetrahedar", Some("tetrahedra")),
            ("dualcontouring", Some("dual-contouring")),
            ("mc34", Some("mc33")),
            ("mb", None),
            ("poisson", None),
            ("x", None),
            ("", None),
        ] {
            assert_eq!(nearest(word, known), meant, "{word}");
        }
        assert_eq!(nearest("ss_bp", ["ss_bi", "ss_bu"]), None);
        assert_eq!(did_you_mean("cubse", known), "; did you mean cubes?");
        assert_eq!(did_you_mean("poisson", known), "");
        assert_eq!(["ab", "ba", "abc", "a", ""].map(|other| distance("ab", other)), [0, 1, 1, 1, 2]);
    }

    #[test]
    fn messages_have_no_types_of_the_program() {
        let said = plainly("3 | x\nunknown variant `flatt`, expected one of `smooth`, `flat`");
        assert_eq!(
            said,
            "3 | x\n`flatt` is not known here; did you mean flat? Expected one of `smooth`, `flat`"
        );
        let said = plainly("unknown field `memory_gb`, expected `memory_gib`");
        assert!(said.ends_with("; did you mean memory_gib? Expected `memory_gib`"), "{said}");
        let said = plainly("invalid type: string \"mc\", expected struct Recipe");
        assert_eq!(said, "invalid type: string \"mc\", expected a table");
        let said = plainly("invalid type: map, expected f64");
        assert_eq!(said, "invalid type: a table, expected a number");
        assert_eq!(plainly("missing field `id`"), "missing field `id`");
    }
}
