//! SnapMC as a method.

use super::{Family, MethodError, Promises};
use crate::box_grid::BoxGrid;
use crate::cubes::{Flat, Way};
use crate::extraction::{Extraction, check};
use crate::extractor::Extractor;
use crate::lattice::{Arrangement, LatticeError};
use crate::settings::{Clustering, Execution, ExtractSettings, Topology};
use crate::source::Source;

/// Marching cubes whose crossings near a point of the lattice are drawn to it, so that triangles have bounded angles (Raman & Wenger
/// 2008): from 12.7 to 144.2 degrees with the default, whatever the samples (`tests/snap.rs` tries every triangle of the table).
///
/// A sample that equals the isovalue is on the surface where one of the cells at it has a corner inside, otherwise outside. On the box
/// it is outside too, unless a neighbour there is inside: so a solid that ends at the box has walls. The bounds of angles do not hold
/// for the triangles of such walls. Sides of
/// triangles have an even number of triangles off the box, two or more: where sheets of the surface are less than a cell apart,
/// they meet along edges and at points. Pieces thinner than that can be lost. Edges are at least `gamma` times the root of two long.
///
/// With the feature `serde` the keys are those of the fields, all with defaults.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct SnapCubes {
    /// How near to a point a crossing must be, in lengths of its edge: from 0, where crossings stay where they are, to 0.5.
    pub gamma: f32,
    /// What a face between two cells gets in which both have a piece of surface.
    pub flat: Flat,
}

impl Default for SnapCubes {
    /// As published.
    fn default() -> Self {
        Self { gamma: 0.3, flat: Flat::Both }
    }
}

impl SnapCubes {
    const ARRANGEMENT: Arrangement = Arrangement::SimpleCubic;
    /// More layers are in sight than where nothing is snapped.
    const MORE_MEMORY: u64 = 2;

    fn settings(isovalue: f32) -> ExtractSettings {
        let (clustering, topology) = (Clustering::None, Topology::Guarded);
        ExtractSettings { isovalue, clustering, topology, ..ExtractSettings::default() }
    }

    fn check_gamma(&self) -> Result<(), MethodError> {
        let gamma = self.gamma;
        if (0.0..=0.5).contains(&gamma) { Ok(()) } else { Err(MethodError::Gamma { gamma }) }
    }
}

impl Family for SnapCubes {
    fn check(&self, grid: &BoxGrid) -> Result<(), MethodError> {
        self.check_gamma()?;
        grid.lattice(Self::ARRANGEMENT)?;
        Ok(())
    }

    fn cells(&self, grid: &BoxGrid) -> Result<[u32; 3], LatticeError> {
        Ok(grid.lattice(Self::ARRANGEMENT)?.cells())
    }

    fn memory_bytes(&self, grid: &BoxGrid, execution: &Execution) -> Result<u64, LatticeError> {
        let lattice = grid.lattice(Self::ARRANGEMENT)?;
        Ok(Self::MORE_MEMORY * lattice.memory_bytes_for(&Self::settings(0.0), execution))
    }

    /// Where several sheets meet in one cell, snapping joins them along edges and at points.
    fn promises(&self) -> Promises {
        Promises {
            manifold: false,
            closed_off_the_box: true,
            same_triangles_for_all_placements: false,
            chunks: false,
            samples_suffice: true,
        }
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
        self.check_gamma()?;
        let settings = Self::settings(isovalue);
        check(&settings, Self::ARRANGEMENT)?;
        let lattice = grid.lattice(Self::ARRANGEMENT)?;
        let way = Way::Snapped { gamma: self.gamma, flat: self.flat };
        Ok(extractor.extract_cubes_into(source, &lattice, &settings, way, execution.into(), extraction)?)
    }
}
