//! Codes of methods on a page: no line ends within one.

/// Elements whose text is not set in lines.
const UNSET: [&str; 4] = ["title", "style", "script", "svg"];

/// The page with every code that a line could break set whole. `html` has no `<` but those of its elements.
pub(super) fn set_whole(html: &str, codes: &[&str]) -> String {
    let codes: Vec<&str> = codes.iter().copied().filter(|code| code.contains('-')).collect();
    let mut page = String::with_capacity(html.len());
    let mut rest = html;
    while let Some(start) = rest.find('<') {
        push_text(&mut page, &rest[..start], &codes);
        rest = &rest[start..];
        let name: String = rest[1..].chars().take_while(char::is_ascii_alphanumeric).collect();
        let closing = if UNSET.contains(&name.as_str()) { format!("</{name}>") } else { ">".into() };
        let end = rest.find(&closing).map_or(rest.len(), |at| at + closing.len());
        page.push_str(&rest[..end]);
        rest = &rest[end..];
    }
    push_text(&mut page, rest, &codes);
    page
}

fn push_text(page: &mut String, text: &str, codes: &[&str]) {
    let is_part = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
    let mut rest = text;
    while !rest.is_empty() {
        let other = rest.find(is_part).unwrap_or(rest.len());
        page.push_str(&rest[..other]);
        rest = &rest[other..];
        let end = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        match codes.contains(&word) {
            true => page.extend(["<span class=\"code\">", word, "</span>"]),
            false => page.push_str(word),
        }
        rest = after;
    }
}

#[cfg(test)]
mod tests {
    use super::set_whole;

    #[test]
    fn codes_in_text_are_set_whole_and_nothing_else() {
        let whole = |html| set_whole(html, &["dc-in-cell", "mc"]);
        assert_eq!(
            whole("<p title=\"dc-in-cell\">mc, dc-in-cell: dual; dc-in-cells, \u{e9}-dc-in-cell</p>"),
            "<p title=\"dc-in-cell\">mc, <span class=\"code\">dc-in-cell</span>: dual; dc-in-cells, \u{e9}-dc-in-cell</p>"
        );
        for same in [
            "<title>dc-in-cell</title>",
            "<svg><text>dc-in-cell</text></svg>",
            "<script>let a = 'dc-in-cell' < 3;</script>",
            "a <b",
            "",
        ] {
            assert_eq!(whole(same), same);
        }
    }
}
