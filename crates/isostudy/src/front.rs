//! An advancing front as a study's method: its keys, and what grows of them.

use anyhow::{Result, bail};
use glam::Vec3;
use isostudy_extract::BoxGrid;
use isostudy_field::StudyField;
use isostudy_front::{Front, FrontError, Grown, Seeds, Sizing, grow};
use serde::Deserialize;

/// The keys of `kind = "advancing-front"`. Lengths are in spacings of the study, so that budgets hold.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct FrontKeys {
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
    pub(crate) fn check(&self) -> Result<()> {
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

    /// The front over an object's box.
    ///
    /// # Errors
    /// [`FrontError`], with the place.
    pub(crate) fn grow(
        &self,
        field: &dyn StudyField,
        grid: &BoxGrid,
        isovalue: f32,
    ) -> Result<Grown, FrontError> {
        let spacing = f64::from(grid.spacing);
        let mut settings = Front::of_edge(self.edge * spacing);
        if self.sizing == Lengths::Curvature {
            let (smallest, angle) = (self.smallest * spacing, self.angle_deg.to_radians());
            settings.sizing = Sizing::Curvature { smallest, angle };
        }
        if !self.seeds.is_empty() {
            settings.seeds = Seeds::Points(self.seeds.iter().copied().map(Vec3::from_array).collect());
        }
        grow(field, grid.bounds, isovalue, &settings)
    }
}
