//! Surface nets as a method.

use super::{ByWindow, Family, MethodError, Promises};
use crate::box_grid::BoxGrid;
use crate::cubes::Way;
use crate::extraction::{Extraction, check};
use crate::extractor::Extractor;
use crate::lattice::{Arrangement, LatticeError};
use crate::settings::{Clustering, Execution, ExtractSettings, Topology};
use crate::source::Source;

/// Surface nets, the dual of marching cubes: a vertex in each cube that the surface crosses, at the mean of the crossings of its edges,
/// and a quadrilateral round each crossed edge (Gibson 1998, without relaxation). Each is two triangles, on either side of its
/// shorter diagonal.
///
/// Where the surface leaves the box the mesh ends half a cell before it, since a vertex lies in a cell.
///
/// With the feature `serde` the keys are those of the fields, all with defaults.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct SurfaceNets {
    /// A vertex for each loop of surface round a cell rather than one in all (Nielson 2004), and where that would leave an edge with four
    /// quadrilaterals, inside corners joined on the face between (Wenger 2013): then the mesh is a manifold. Without, sheets of the
    /// surface that cross one cell share its vertex.
    pub patches: bool,
}

impl SurfaceNets {
    const ARRANGEMENT: Arrangement = Arrangement::SimpleCubic;

    fn settings(isovalue: f32) -> ExtractSettings {
        let (clustering, topology) = (Clustering::None, Topology::Guarded);
        ExtractSettings { isovalue, clustering, topology, ..ExtractSettings::default() }
    }

    fn way(&self) -> Way {
        Way::Nets { patches: self.patches, sharp: None }
    }

    /// A triangle has vertices of the next lower cells, whose triangles give them normals; how such a cell is cut may be for the
    /// next one to say.
    fn unmoved_halo(&self) -> u32 {
        if self.patches { 3 } else { 2 }
    }
}

impl Family for SurfaceNets {
    fn check(&self, grid: &BoxGrid) -> Result<(), MethodError> {
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
            chunks: true,
            samples_suffice: true,
        }
    }

    fn halo(&self) -> Option<u32> {
        Some(self.unmoved_halo())
    }

    fn by_window(&self, isovalue: f32) -> Option<ByWindow> {
        Some(ByWindow {
            arrangement: Self::ARRANGEMENT,
            settings: Self::settings(isovalue),
            cubes: Some(self.way()),
            halo: self.unmoved_halo(),
        })
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
        let settings = Self::settings(isovalue);
        check(&settings, Self::ARRANGEMENT)?;
        let lattice = grid.lattice(Self::ARRANGEMENT)?;
        Ok(extractor.extract_cubes_into(
            source,
            &lattice,
            &settings,
            self.way(),
            execution.into(),
            extraction,
        )?)
    }
}
