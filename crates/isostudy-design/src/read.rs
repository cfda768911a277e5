//! Files into records, with errors that name the file.

use crate::check::ConfigError;
use crate::wording::plainly;
use serde::de::DeserializeOwned;
use std::path::Path;

/// The largest file of TOML or of a table. The paper's study has 40 kB.
const LIMIT_BYTES: u64 = 64 << 20;

/// What is in a file.
pub(crate) fn text(path: &Path) -> Result<String, ConfigError> {
    isostudy_foreign::text(path, LIMIT_BYTES)
        .map_err(|error| ConfigError::Read { file: path.into(), source: error.into() })
}

/// A TOML file's text.
pub(crate) fn parse_toml<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T, ConfigError> {
    toml::from_str(text).map_err(|error| ConfigError::Syntax {
        file: path.into(),
        message: plainly(error.to_string().trim_end()),
    })
}

/// A table of comma-separated values; lines that begin with `#` are comments.
pub(crate) fn read_table<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, ConfigError> {
    let table_error =
        |error: csv::Error| ConfigError::Table { file: path.into(), message: error.to_string() };
    let text = text(path)?;
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    reader.deserialize().collect::<Result<_, _>>().map_err(table_error)
}
