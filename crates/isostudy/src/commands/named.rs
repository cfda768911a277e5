//! Values of the command line that have the names that they have in a study file.

use isostudy_design::wording::plainly;
use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::{Error as NameError, StrDeserializer};

/// What a study calls it; to be a value parser of clap.
///
/// # Errors
/// If no value has the name, with those that there are.
pub(super) fn named<T: for<'de> Deserialize<'de>>(text: &str) -> Result<T, String> {
    let name: StrDeserializer<'_, NameError> = text.into_deserializer();
    T::deserialize(name).map_err(|error| plainly(&error.to_string()))
}
