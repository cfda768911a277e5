//! Numbers as people read them: in sentences, in the cells of printed tables, on axes. Files for machines have the plain ones.

/// The sign that goes before a number; a hyphen is none.
pub const MINUS: char = '\u{2212}';

/// A number with so many decimals and a true minus sign; never minus zero.
pub fn number(value: f64, decimals: usize) -> String {
    signed(&format!("{value:.decimals$}"))
}

/// Printed digits with a true minus sign for a hyphen; none for zero.
pub fn signed(digits: &str) -> String {
    match digits.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| c == '0' || c == '.') => rest.into(),
        Some(rest) => format!("{MINUS}{rest}"),
        None => digits.into(),
    }
}

/// `1 answer`, `2 answers`.
pub fn counted(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minus_is_no_hyphen_and_zero_has_no_sign() {
        assert_eq!(
            [(-0.25, 2), (-0.001, 2), (-0.0, 0), (3.0, 1), (-12.5, 0)].map(|(x, d)| number(x, d)),
            ["\u{2212}0.25", "0.00", "0", "3.0", "\u{2212}12"]
        );
        assert_eq!((counted(1, "answer"), counted(0, "answer")), ("1 answer".into(), "0 answers".into()));
        assert_eq!((signed("-7"), signed("7")), ("\u{2212}7".into(), "7".into()));
    }
}
