//! Dual contouring as a method.

use super::{Family, MethodError, Promises};
use crate::box_grid::BoxGrid;
use crate::cubes::{Sharp, Way};
use crate::extraction::{Extraction, check};
use crate::extractor::Extractor;
use crate::lattice::{Arrangement, LatticeError};
use crate::settings::{Clustering, Execution, ExtractSettings, Topology};
use crate::source::Source;

/// Dual contouring on a uniform grid (Ju, Losasso, Schaefer & Warren 2002): the connections of [surface nets](super::SurfaceNets), with
/// each vertex where the field's tangent planes at the crossings of its cube meet, so that edges and corners are kept.
///
/// Crossings are roots of the field on their edges. Normals are the field's own gradients where it has some, else central differences.
/// The vertex has the least sum of squared distances to the planes; where they leave a choice it is the point nearest to the mean of
/// the crossings. Triangles may pass through each other.
///
/// With the feature `serde` the keys are those of the fields, all with defaults.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct DualContouring {
    /// As for [surface nets](super::SurfaceNets::patches).
    pub patches: bool,
    /// Eigenvalues of the sum of the normals' outer products that are smaller than this share of the largest count as none, so that
    /// nearly parallel planes do not send a vertex away: 0 to 1.
    pub truncation: f32,
    /// Whether a vertex stays in its cube, at the best point there.
    pub in_cell: bool,
}

impl Default for DualContouring {
    fn default() -> Self {
        Self { patches: false, truncation: 1e-3, in_cell: true }
    }
}

impl DualContouring {
    const ARRANGEMENT: Arrangement = Arrangement::SimpleCubic;

    fn settings(isovalue: f32) -> ExtractSettings {
        let (clustering, topology) = (Clustering::None, Topology::Guarded);
        ExtractSettings { isovalue, clustering, topology, ..ExtractSettings::default() }
    }

    fn check_truncation(&self) -> Result<(), MethodError> {
        let truncation = self.truncation;
        if (0.0..=1.0).contains(&truncation) { Ok(()) } else { Err(MethodError::Truncation { truncation }) }
    }
}

impl Family for DualContouring {
    fn check(&self, grid: &BoxGrid) -> Result<(), MethodError> {
        self.check_truncation()?;
        grid.lattice(Self::ARRANGEMENT)?;
        Ok(())
    }

    fn cells(&self, grid: &BoxGrid) -> Result<[u32; 3], LatticeError> {
        Ok(grid.lattice(Self::ARRANGEMENT)?.cells())
    }

    fn memory_bytes(&self, grid: &BoxGrid, execution: &Execution) -> Result<u64, LatticeError> {
        Ok(grid.lattice(Self::ARRANGEMENT)?.memory_bytes_for(&Self::settings(0.0), execution))
    }

    fn promises(&self) -> Promises {
        Promises {
            manifold: self.patches,
            closed_off_the_box: true,
            same_triangles_for_all_placements: false,
            chunks: false,
            samples_suffice: false,
        }
    }

    fn is_of_cubes(&self) -> bool {
        false
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
        self.check_truncation()?;
        if let Source::Samples(_) | Source::Window { .. } = source {
            return Err(MethodError::NeedsField);
        }
        let settings = Self::settings(isovalue);
        check(&settings, Self::ARRANGEMENT)?;
        let lattice = grid.lattice(Self::ARRANGEMENT)?;
        let sharp = Sharp { truncation: self.truncation, in_cell: self.in_cell };
        let way = Way::Nets { patches: self.patches, sharp: Some(sharp) };
        Ok(extractor.extract_cubes_into(source, &lattice, &settings, way, execution.into(), extraction)?)
    }
}
