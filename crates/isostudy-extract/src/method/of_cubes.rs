//! What all families of cubes have in common: samples at the corners of the cubes, and one driver for all that is made of them.

use super::{ByWindow, Family, MethodError, Promises};
use crate::cubes::{Rule, cells_otherwise, table};
use crate::extraction::{Extraction, check};
use crate::extractor::Extractor;
use crate::extractor::Way;
use crate::lattice::BoxGrid;
use crate::lattice::{Arrangement, LatticeError};
use crate::settings::{Clustering, Execution, ExtractSettings, Topology};
use crate::source::Source;

const ARRANGEMENT: Arrangement = Arrangement::SimpleCubic;

/// A family of methods whose cubes are not cut any further. What has a default is so for most.
pub(super) trait OfCubes {
    /// What is made of the cubes.
    fn way(&self) -> Way;
    fn promises(&self) -> Promises;
    /// Whether the method's own settings are in their ranges.
    fn check_settings(&self) -> Result<(), MethodError> {
        Ok(())
    }
    fn settings(&self, isovalue: f32) -> ExtractSettings {
        let (clustering, topology) = (Clustering::None, Topology::Guarded);
        ExtractSettings { isovalue, clustering, topology, ..ExtractSettings::default() }
    }
    /// What decides the triangles of a cube, where signs and samples at its corners do.
    fn rule(&self) -> Option<Rule> {
        None
    }
    /// Whether the field is called between the samples whatever the settings are.
    fn calls_the_field(&self) -> bool {
        false
    }
    /// How many times the layers of marching cubes are in sight.
    fn layers(&self) -> u64 {
        1
    }
    /// As [`Family::halo`].
    fn halo(&self) -> Option<u32> {
        self.unmoved_halo()
    }
    /// The same before vertices are moved, as in [`ByWindow`], where there are chunks.
    fn unmoved_halo(&self) -> Option<u32> {
        None
    }
}

impl<T: OfCubes> Family for T {
    fn check_own(&self) -> Result<(), MethodError> {
        self.check_settings()
    }

    fn calls_the_field_always(&self) -> bool {
        self.calls_the_field()
    }

    fn check(&self, grid: &BoxGrid) -> Result<(), MethodError> {
        self.check_settings()?;
        check(&self.settings(0.0), ARRANGEMENT)?;
        grid.lattice(ARRANGEMENT)?;
        Ok(())
    }

    fn cells(&self, grid: &BoxGrid) -> Result<[u32; 3], LatticeError> {
        Ok(grid.lattice(ARRANGEMENT)?.cells())
    }

    fn memory_bytes(&self, grid: &BoxGrid, execution: &Execution) -> Result<u64, LatticeError> {
        Ok(self.layers() * grid.lattice(ARRANGEMENT)?.memory_bytes_for(&self.settings(0.0), execution))
    }

    fn promises(&self) -> Promises {
        OfCubes::promises(self)
    }

    fn is_of_cubes(&self) -> bool {
        !self.calls_the_field()
    }

    fn has_corners(&self) -> bool {
        true
    }

    fn cells_otherwise(&self, counts: [usize; 3], values: &[f32], isovalue: f32) -> Option<u64> {
        self.rule().map(|rule| cells_otherwise(rule, counts, values, isovalue))
    }

    fn tables(&self) -> Vec<isostudy_cells::Table> {
        self.rule().and_then(table).into_iter().collect()
    }

    fn halo(&self) -> Option<u32> {
        OfCubes::halo(self)
    }

    fn by_window(&self, isovalue: f32) -> Option<ByWindow> {
        let halo = self.unmoved_halo()?;
        let (settings, cubes) = (self.settings(isovalue), Some(self.way()));
        Some(ByWindow { arrangement: ARRANGEMENT, settings, cubes, halo })
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
        self.check_settings()?;
        if self.calls_the_field()
            && matches!(source, Source::Samples(_) | Source::Bricks(_) | Source::Window { .. })
        {
            return Err(MethodError::NeedsField);
        }
        let settings = self.settings(isovalue);
        // Before the lattice, as in `check`.
        check(&settings, ARRANGEMENT)?;
        let lattice = grid.lattice(ARRANGEMENT)?;
        let (way, control) = (self.way(), execution.into());
        Ok(extractor.extract_cubes_into(source, &lattice, &settings, way, control, extraction)?)
    }
}
