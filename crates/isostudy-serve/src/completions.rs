//! What people take back to whoever sent them.

/// A code or an `https://` address for each way to leave a study. Names in braces are filled in by the page from its own address.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Completions {
    /// For those who have finished: told to nobody else.
    pub finished: Option<String>,
    /// For those who were screened out: told to nobody else.
    pub screened: Option<String>,
    /// For those who withdrew or declined.
    pub withdrawn: Option<String>,
    /// For those who came when the study was full.
    pub full: Option<String>,
}
