//! Files into records, with errors that name the file.

use crate::check::ConfigError;
use crate::wording::plainly;
use serde::de::DeserializeOwned;
use std::path::Path;

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
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).map_err(table_error)?;
    reader.deserialize().collect::<Result<_, _>>().map_err(table_error)
}
