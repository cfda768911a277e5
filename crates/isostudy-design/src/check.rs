//! What may be wrong with a study file, and the checks that say so.

use crate::wording::line_of;
use std::path::{Path, PathBuf};

/// Why a study file is refused. Every variant names the file, and the key where there is one.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// The file cannot be read.
    #[error("{}: cannot be read", file.display())]
    Read {
        /// The study file.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Not TOML, a key that does not exist or is missing, or a value of the wrong kind.
    #[error("{}: {message}", file.display())]
    Syntax {
        /// The study file.
        file: PathBuf,
        /// Line, column and key.
        message: String,
    },
    /// A value outside its range, or at odds with another.
    #[error("{}: {}{key} = {value}: {limit}", file.display(), on(*line))]
    Value {
        /// The study file.
        file: PathBuf,
        /// The line on which the key stands, or the table that lacks it; `None` where the file has neither.
        line: Option<usize>,
        /// The key, as in `objects[1].isovalue`.
        key: String,
        /// What it says.
        value: String,
        /// What it may say.
        limit: String,
    },
    /// A file that the study names is not there.
    #[error("{}: {}{key} names {}: no such file", file.display(), on(*line), path.display())]
    MissingFile {
        /// The study file.
        file: PathBuf,
        /// The line on which the key stands.
        line: Option<usize>,
        /// The key.
        key: String,
        /// The path, resolved against the study file's folder.
        path: PathBuf,
    },
    /// A table of published numbers does not parse.
    #[error("{}: {message}", file.display())]
    Table {
        /// The table.
        file: PathBuf,
        /// Row and column.
        message: String,
    },
}

impl ConfigError {
    /// With the line on which the key stands in the file's text.
    pub(crate) fn placed(mut self, text: &str) -> Self {
        if let Self::Value { line, key, .. } | Self::MissingFile { line, key, .. } = &mut self {
            *line = line_of(text, key);
        }
        self
    }
}

fn on(line: Option<usize>) -> String {
    line.map_or_else(String::new, |line| format!("line {line}: "))
}

/// A number in few letters: `0.04`, `-2`, `1e-300`.
pub(crate) fn short(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or_else(|| text.clone(), str::to_owned)
}

/// Checks values of one file and builds errors that name it.
pub(crate) struct Checker<'a> {
    pub(crate) file: &'a Path,
}

impl Checker<'_> {
    pub(crate) fn refuse<T>(
        &self,
        key: impl Into<String>,
        value: impl ToString,
        limit: impl Into<String>,
    ) -> Result<T, ConfigError> {
        Err(ConfigError::Value {
            file: self.file.into(),
            line: None,
            key: key.into(),
            value: value.to_string(),
            limit: limit.into(),
        })
    }

    /// A finite number in `low..=high`.
    pub(crate) fn number(&self, key: &str, value: f64, low: f64, high: f64) -> Result<(), ConfigError> {
        if !value.is_finite() {
            return self.refuse(key, short(value), "must be a finite number");
        }
        if value < low || value > high {
            let limit = format!("must lie between {} and {}", short(low), short(high));
            return self.refuse(key, short(value), limit);
        }
        Ok(())
    }

    /// A finite number above zero, up to `high`.
    pub(crate) fn positive(&self, key: &str, value: f64, high: f64) -> Result<(), ConfigError> {
        if !value.is_finite() {
            return self.refuse(key, short(value), "must be a finite number");
        }
        if value <= 0.0 || value > high {
            let limit = format!("must be above 0 and at most {}", short(high));
            return self.refuse(key, short(value), limit);
        }
        Ok(())
    }

    /// [`positive`](Self::positive) in single precision too, in which lattices are made.
    pub(crate) fn length(&self, key: &str, value: f64, high: f64) -> Result<(), ConfigError> {
        self.positive(key, value, high)?;
        if value as f32 == 0.0 {
            return self.refuse(
                key,
                short(value),
                "is 0 in single precision, in which surfaces are extracted",
            );
        }
        Ok(())
    }

    pub(crate) fn numbers(&self, key: &str, values: &[f64], low: f64, high: f64) -> Result<(), ConfigError> {
        values
            .iter()
            .enumerate()
            .try_for_each(|(i, &value)| self.number(&format!("{key}[{i}]"), value, low, high))
    }

    /// A whole number in `low..=high`.
    pub(crate) fn count(&self, key: &str, value: u32, low: u32, high: u32) -> Result<(), ConfigError> {
        if value < low || value > high {
            return self.refuse(key, value, format!("must lie between {low} and {high}"));
        }
        Ok(())
    }

    /// A text with something in it.
    pub(crate) fn text(&self, key: &str, value: &str, limit: &str) -> Result<(), ConfigError> {
        if value.trim().is_empty() { self.refuse(key, "\"\"", limit) } else { Ok(()) }
    }

    /// Texts with something in each, all different.
    pub(crate) fn texts(&self, key: &str, values: &[String]) -> Result<(), ConfigError> {
        let key = |i: usize| format!("{key}[{i}]");
        values.iter().enumerate().try_for_each(|(i, value)| self.text(&key(i), value, "must be a text"))?;
        self.distinct(key, values)
    }

    /// No two of the values are the same.
    pub(crate) fn distinct(
        &self,
        key: impl Fn(usize) -> String,
        values: &[String],
    ) -> Result<(), ConfigError> {
        for (i, value) in values.iter().enumerate() {
            if let Some(j) = values[..i].iter().position(|earlier| earlier == value) {
                return self.refuse(key(i), value, format!("already used by {}", key(j)));
            }
        }
        Ok(())
    }

    /// A path as written, resolved against the study file's folder; the file must be there.
    pub(crate) fn existing(&self, key: &str, written: &str) -> Result<PathBuf, ConfigError> {
        let path = self.resolve(written);
        if path.is_file() {
            Ok(path)
        } else {
            Err(ConfigError::MissingFile { file: self.file.into(), line: None, key: key.into(), path })
        }
    }

    pub(crate) fn resolve(&self, written: &str) -> PathBuf {
        self.file.parent().unwrap_or(Path::new("")).join(written)
    }
}
