//! Marching tetrahedra on the cells of an object that is a grid.

use super::{Asked, Family, FamilyKind, keys_of};
use anyhow::{Context, Result, bail};
use isostudy_design::Study;
use isostudy_design::config::{FieldSection, ObjectSection};
use isostudy_mesh::TriangleMesh;
use serde::Deserialize;
use std::sync::Arc;

pub(super) const KIND: FamilyKind = FamilyKind {
    name: "grid-cells",
    read,
    why_in_studies: "the cells of a grid are extracted on with --grid, without a method",
};

/// The keys of `kind = "grid-cells"`: none.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct GridCells {}

fn read(keys: toml::Table, study: &Study) -> Result<Arc<dyn Family>> {
    let of: GridCells = keys_of(keys)?;
    let is_grid = |object: &&ObjectSection| matches!(object.field, FieldSection::Grid { .. });
    if let Some(other) = study.file.objects.iter().find(|object| !is_grid(object)) {
        bail!(
            "kind = \"grid-cells\": object {} has no cells of its own; each object must be a field of kind = \"grid\"",
            other.id
        );
    }
    Ok(Arc::new(of))
}

impl Family for GridCells {
    fn mesh(&self, of: &Asked<'_>) -> Result<TriangleMesh> {
        let cells = of.own_cells.context("checked when the study was read")?;
        Ok(cells.extract(f64::from(of.isovalue)).mesh)
    }

    fn has_one_resolution(&self) -> Option<&'static str> {
        Some("the cells of a grid")
    }

    /// The values are the grid's.
    fn asks_the_field(&self) -> bool {
        false
    }
}
