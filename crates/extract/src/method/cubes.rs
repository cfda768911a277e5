//! Marching cubes as a method.

use super::{ByWindow, Family, MethodError, Promises};
use crate::box_grid::BoxGrid;
use crate::cubes::{Diagonals, Faces, Rule, Way};
use crate::extraction::{Extraction, check};
use crate::extractor::Extractor;
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
    const ARRANGEMENT: Arrangement = Arrangement::SimpleCubic;

    const UNMOVED_HALO: u32 = 1;

    fn rule(&self) -> Rule {
        Rule { faces: self.faces, diagonals: self.diagonals }
    }

    fn settings(&self, isovalue: f32) -> ExtractSettings {
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
    fn check(&self, grid: &BoxGrid) -> Result<(), MethodError> {
        check(&self.settings(0.0), Self::ARRANGEMENT)?;
        grid.lattice(Self::ARRANGEMENT)?;
        Ok(())
    }

    fn cells(&self, grid: &BoxGrid) -> Result<[u32; 3], LatticeError> {
        Ok(grid.lattice(Self::ARRANGEMENT)?.cells())
    }

    fn memory_bytes(&self, grid: &BoxGrid, execution: &Execution) -> Result<u64, LatticeError> {
        Ok(grid.lattice(Self::ARRANGEMENT)?.memory_bytes_for(&self.settings(0.0), execution))
    }

    fn promises(&self) -> Promises {
        Promises {
            manifold: true,
            closed_off_the_box: true,
            same_triangles_for_all_placements: true,
            chunks: self.halo().is_some() && !self.refine_crossings,
            samples_suffice: !self.refine_crossings && !self.placement.calls_the_field(),
        }
    }

    /// A vertex of a cell is one of its neighbours' too, and their other vertices give it its normal; no vertex depends on
    /// samples beyond its own cells. One that is moved looks at its triangles, and one that is relaxed at its neighbours first.
    fn halo(&self) -> Option<u32> {
        match self.placement {
            Placement::MeanOfCrossings => Some(Self::UNMOVED_HALO),
            Placement::Projected => Some(Self::UNMOVED_HALO + 1),
            Placement::Relaxed => Some(Self::UNMOVED_HALO + 2),
            Placement::CurvatureWeighted => None,
        }
    }

    fn by_window(&self, isovalue: f32) -> Option<ByWindow> {
        Some(ByWindow {
            arrangement: Self::ARRANGEMENT,
            settings: self.settings(isovalue),
            cubes: Some(Way::Patches(self.rule())),
            halo: Self::UNMOVED_HALO,
        })
    }

    fn cells_otherwise(&self, counts: [usize; 3], values: &[f32], isovalue: f32) -> Option<u64> {
        Some(crate::cubes::cells_otherwise(self.rule(), counts, values, isovalue))
    }

    fn tables(&self) -> Vec<cells::Table> {
        crate::cubes::table(self.rule()).into_iter().collect()
    }

    fn extract_into(
        &self,
        extractor: &mut Extractor,
        source: Source,
        grid: &BoxGrid,
        isovalue: f32,
        execution: &Execution,
        extraction: &mut Extraction,
    ) -> Result<(), MethodError> {
        let settings = self.settings(isovalue);
        // Before the lattice, as in `check`.
        check(&settings, Self::ARRANGEMENT)?;
        let lattice = grid.lattice(Self::ARRANGEMENT)?;
        Ok(extractor.extract_cubes_into(
            source,
            &lattice,
            &settings,
            Way::Patches(self.rule()),
            execution.into(),
            extraction,
        )?)
    }
}
