//! Cells that a spreadsheet would run as a formula.

use std::borrow::Cow;

/// What a formula may begin with, and the mark that says it is none.
const ACTIVE: [char; 7] = ['=', '+', '-', '@', '\t', '\r', '\''];

/// A cell with an apostrophe in front if a spreadsheet would take it for a formula; [`unescape`] gives the cell back.
pub fn escape(cell: &str) -> Cow<'_, str> {
    if cell.starts_with(ACTIVE) { Cow::Owned(format!("'{cell}")) } else { Cow::Borrowed(cell) }
}

/// A cell as it was before [`escape`].
pub fn unescape(cell: &str) -> &str {
    match cell.strip_prefix('\'') {
        Some(rest) if rest.starts_with(ACTIVE) => rest,
        _ => cell,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_disarmed_and_come_back() {
        assert_eq!(escape("=HYPERLINK(\"x\")"), "'=HYPERLINK(\"x\")");
        for cell in ["=1+1", "+1", "-1", "@SUM(A1)", "\tx", "'quoted'", "''", "'=", "plain", "", "5-3", "'a"]
        {
            assert_eq!(unescape(&escape(cell)), cell);
            assert!(!escape(cell).starts_with(['=', '+', '-', '@', '\t', '\r']), "{cell}");
        }
        assert_eq!(unescape("'a"), "'a");
    }
}
