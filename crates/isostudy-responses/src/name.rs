//! Names of participants, questions and items: how long they may be.

/// Most characters of a name. Names go into tables and figures, which a cell of megabytes would never leave.
pub const LONGEST_NAME: usize = 200;

/// Whether a name is longer than [`LONGEST_NAME`].
pub(crate) fn is_too_long(name: &str) -> bool {
    name.len() > LONGEST_NAME && name.chars().count() > LONGEST_NAME
}

/// What is said of one that is.
pub(crate) fn limit() -> String {
    format!("must have at most {LONGEST_NAME} characters")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_are_counted_and_not_bytes() {
        assert!(!is_too_long(&"ü".repeat(LONGEST_NAME)));
        assert!(is_too_long(&"u".repeat(LONGEST_NAME + 1)));
    }
}
