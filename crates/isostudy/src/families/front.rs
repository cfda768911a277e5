//! An advancing front as a study's method: its keys, and what grows of them.

use super::{Asked, CannotMake, Family, FamilyKind, keys_of};
use anyhow::{Result, bail};
use glam::Vec3;
use isostudy_design::Study;
use isostudy_front::{Front, Seeds, Sizing, grow};
use isostudy_mesh::TriangleMesh;
use serde::Deserialize;
use std::sync::Arc;

pub(super) const KIND: FamilyKind = FamilyKind {
    name: "advancing-front",
    read,
    why_in_studies: "fronts are methods of a study, which says how long edges are; see `isostudy study`",
};

/// The keys of `kind = "advancing-front"`. Lengths are in spacings of the study, so that budgets hold.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct FrontKeys {
    /// The length of an edge; with `sizing = "curvature"` the greatest.
    edge: f64,
    sizing: Lengths,
    /// The least length of an edge with `sizing = "curvature"`.
    smallest: f64,
    /// By how much an edge turns the normal there.
    angle_deg: f64,
    /// Points in space; none are sampled ones.
    seeds: Vec<[f32; 3]>,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Lengths {
    Constant,
    Curvature,
}

impl Default for FrontKeys {
    fn default() -> Self {
        Self { edge: 1.0, sizing: Lengths::Constant, smallest: 0.25, angle_deg: 20.0, seeds: Vec::new() }
    }
}

impl FrontKeys {
    /// Checks what can be checked without a box.
    ///
    /// # Errors
    /// The first key that is out of its range, with what is allowed.
    fn check(&self) -> Result<()> {
        for (name, value, most) in [
            ("edge", self.edge, 100.0),
            ("smallest", self.smallest, self.edge),
            ("angle_deg", self.angle_deg, 57.0),
        ] {
            // The last two say something only where lengths vary.
            let is_used = name == "edge" || self.sizing == Lengths::Curvature;
            if is_used && !(value > 0.0 && value <= most) {
                bail!("{name} = {value:?}: must be above 0 and at most {most}");
            }
        }
        Ok(())
    }
}

fn read(keys: toml::Table, _: &Study) -> Result<Arc<dyn Family>> {
    let of: FrontKeys = keys_of(keys)?;
    of.check()?;
    Ok(Arc::new(of))
}

impl Family for FrontKeys {
    fn mesh(&self, of: &Asked<'_>) -> Result<TriangleMesh> {
        let spacing = f64::from(of.grid.spacing);
        let mut settings = Front::of_edge(self.edge * spacing);
        if self.sizing == Lengths::Curvature {
            let (smallest, angle) = (self.smallest * spacing, self.angle_deg.to_radians());
            settings.sizing = Sizing::Curvature { smallest, angle };
        }
        if !self.seeds.is_empty() {
            settings.seeds = Seeds::Points(self.seeds.iter().copied().map(Vec3::from_array).collect());
        }
        let grown = grow(of.field, of.grid.bounds, of.isovalue, &settings);
        Ok(grown.map_err(|error| CannotMake(error.to_string()))?.mesh)
    }
}
