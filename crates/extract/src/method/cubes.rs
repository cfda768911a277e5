//! Marching cubes as a method.

use super::{Family, MethodError, Promises};
use crate::cubes::{Diagonals, Faces, Rule};
use crate::extraction::{Extraction, check};
use crate::extractor::Extractor;
use crate::grid::Grid;
use crate::lattice::{Arrangement, LatticeError};
use crate::settings::{Clustering, Execution, ExtractSettings, Placement, Positions, Topology};
use crate::source::Source;

/// Marching cubes: cubes that are not cut any further, a polygon for each loop of surface round one (Lorensen & Cline 1987), and
/// what others made of them.
///
/// With the feature `serde` the keys are those of the fields, all with defaults.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Cubes {
    /// What ambiguous faces and cells get.
    pub faces: Faces,
    /// How polygons become triangles.
    pub diagonals: Diagonals,
    /// Where a vertex goes.
    pub placement: Placement,
    /// Whether crossings are roots of the field rather than interpolated between samples.
    pub refine_crossings: bool,
}

impl Cubes {
    /// The lattice has the corners of the cubes; nothing is merged.
    pub(crate) const ARRANGEMENT: Arrangement = Arrangement::SimpleCubic;

    pub(crate) fn rule(&self) -> Rule {
        Rule { faces: self.faces, diagonals: self.diagonals }
    }

    pub(crate) fn settings(&self, isovalue: f32) -> ExtractSettings {
        ExtractSettings {
            isovalue,
            clustering: Clustering::None,
            topology: Topology::Guarded,
            positions: Positions::Indexed,
            placement: self.placement,
            refine_crossings: self.refine_crossings,
        }
    }
}

impl Family for Cubes {
    fn check(&self, grid: &Grid) -> Result<(), MethodError> {
        check(&self.settings(0.0), Self::ARRANGEMENT)?;
        grid.lattice(Self::ARRANGEMENT)?;
        Ok(())
    }

    fn cells(&self, grid: &Grid) -> Result<[u32; 3], LatticeError> {
        Ok(grid.lattice(Self::ARRANGEMENT)?.cells())
    }

    fn memory_bytes(&self, grid: &Grid, execution: &Execution) -> Result<u64, LatticeError> {
        Ok(grid.lattice(Self::ARRANGEMENT)?.memory_bytes_for(&self.settings(0.0), execution))
    }

    fn promises(&self) -> Promises {
        let moves = self.placement != Placement::MeanOfCrossings || self.refine_crossings;
        Promises {
            manifold: true,
            closed_off_the_box: true,
            same_triangles_for_all_placements: true,
            chunks: !moves,
            samples_suffice: !self.refine_crossings && !self.placement.calls_the_field(),
        }
    }

    fn extract_into(
        &self,
        extractor: &mut Extractor,
        source: Source,
        grid: &Grid,
        isovalue: f32,
        execution: &Execution,
        extraction: &mut Extraction,
    ) -> Result<(), MethodError> {
        let settings = self.settings(isovalue);
        // Before the lattice, as in `check`.
        check(&settings, Self::ARRANGEMENT)?;
        let lattice = grid.lattice(Self::ARRANGEMENT)?;
        Ok(extractor.extract_cubes_into(source, &lattice, &settings, self.rule(), execution, extraction)?)
    }
}
