//! Surface nets as a method.

use super::Promises;
use super::of_cubes::OfCubes;
use crate::cubes::Way;

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

impl OfCubes for SurfaceNets {
    fn way(&self) -> Way {
        Way::Nets { patches: self.patches, sharp: None }
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

    /// A triangle has vertices of the next lower cells, whose triangles give them normals; how such a cell is cut may be for the
    /// next one to say.
    fn unmoved_halo(&self) -> Option<u32> {
        Some(if self.patches { 3 } else { 2 })
    }
}
