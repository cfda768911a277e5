//! Families of methods that have crates of their own, beside the extractor. A family is a file in `families/`, and a line in
//! [`FAMILIES`]: nothing else of a study asks which it is.

mod front;
mod grid_cells;

use anyhow::Result;
use isostudy_design::Study;
use isostudy_design::wording::plainly;
use isostudy_extract::BoxGrid;
use isostudy_field::StudyField;
use isostudy_grid::Grid;
use isostudy_mesh::TriangleMesh;
use std::fmt::{Debug, Display, Formatter};
use std::sync::Arc;

/// An object, at one resolution.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    /// Counts its calls where they are counted.
    pub(crate) field: &'a dyn StudyField,
    pub(crate) grid: BoxGrid,
    pub(crate) isovalue: f32,
    /// The cells of an object that is a grid.
    pub(crate) own_cells: Option<&'a Grid>,
}

/// A method of a family, by its keys.
pub(crate) trait Family: Debug + Send + Sync {
    /// The mesh of an object.
    ///
    /// # Errors
    /// [`CannotMake`] where this object alone is at fault: then the other methods go on.
    fn mesh(&self, of: &Asked<'_>) -> Result<TriangleMesh>;

    /// What it works on where that has one resolution, in the plural; `None` where a spacing is chosen.
    fn has_one_resolution(&self) -> Option<&'static str> {
        None
    }

    /// Whether it asks the field for values.
    fn asks_the_field(&self) -> bool {
        true
    }
}

/// What a family could not do on one object.
#[derive(Debug)]
pub(crate) struct CannotMake(pub(crate) String);

impl Display for CannotMake {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for CannotMake {}

/// A method of the family with these keys, checked against the study.
type Read = fn(toml::Table, &Study) -> Result<Arc<dyn Family>>;

/// What is known of a family before its keys are read.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FamilyKind {
    /// What `kind = ...` calls it.
    pub(crate) name: &'static str,
    pub(crate) read: Read,
    /// Why studies alone have it.
    pub(crate) why_in_studies: &'static str,
}

/// All families.
pub(crate) const FAMILIES: [FamilyKind; 2] = [grid_cells::KIND, front::KIND];

/// The keys of a table.
///
/// # Errors
/// The first that is unknown, missing or of another type, with those that are known.
pub(crate) fn keys_of<T: serde::de::DeserializeOwned>(keys: toml::Table) -> Result<T> {
    let keys = toml::Value::Table(keys).try_into();
    keys.map_err(|error: toml::de::Error| anyhow::Error::msg(plainly(error.to_string().trim_end())))
}
