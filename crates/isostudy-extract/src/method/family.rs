//! What a family of methods says of itself; all else about a method follows from it.

use super::{MethodError, Promises};
use crate::cubes::{Rule, table};
use crate::extractor::Way;
use crate::lattice::Arrangement;
use crate::settings::{Clustering, ExtractSettings, Topology};

/// What a family of methods implements. What has a default is so for most of those whose samples are the corners of cubes.
pub(crate) trait Family {
    /// What is made of the cubes, where they are not cut any further.
    fn way(&self) -> Option<Way>;
    /// As [`Method::promises`](super::Method::promises).
    fn promises(&self) -> Promises;
    /// How sample points fill the box.
    fn arrangement(&self) -> Arrangement {
        Arrangement::SimpleCubic
    }
    fn settings(&self, isovalue: f32) -> ExtractSettings {
        let (clustering, topology) = (Clustering::None, Topology::Guarded);
        ExtractSettings { isovalue, clustering, topology, ..ExtractSettings::default() }
    }
    /// Whether the settings that only the family has are in their ranges.
    fn check_own(&self) -> Result<(), MethodError> {
        Ok(())
    }
    /// Whether the field is called between the samples whatever the settings are.
    fn calls_the_field_always(&self) -> bool {
        false
    }
    /// As [`Method::is_for_comparison`](super::Method::is_for_comparison).
    fn is_for_comparison(&self) -> bool {
        false
    }
    /// Whether the sample points are the corners of the grid's cells.
    fn has_corners(&self) -> bool {
        true
    }
    /// What decides the triangles of a cube, where signs and samples at its corners do.
    fn rule(&self) -> Option<Rule> {
        None
    }
    /// As [`Method::tables`](super::Method::tables).
    fn tables(&self) -> Vec<isostudy_cells::Table> {
        self.rule().and_then(table).into_iter().collect()
    }
    /// Whether vertices are keyed by the lattice edges whose crossings they are.
    fn has_vertices_on_edges(&self) -> bool {
        false
    }
    /// How many times the layers of marching cubes are in sight.
    fn layers(&self) -> u64 {
        1
    }
    /// How many cells beyond a box's own samples can matter to its chunk; `None` where there is no such number, or there
    /// are no chunks.
    fn halo(&self) -> Option<u32> {
        self.unmoved_halo()
    }
    /// The same where a chunk has no normals, which look at triangles beyond its own.
    fn halo_without_normals(&self) -> Option<u32> {
        self.halo()
    }
    /// The same where normals are of samples; `None` where there are no such normals.
    fn halo_with_normals_of_samples(&self) -> Option<u32> {
        None
    }
    /// Whether the mesh of the cells that are wanted is that of their own vertices and triangles, whatever else is in the window. Then
    /// nothing has to say which are theirs, but where normals are of more triangles.
    fn makes_wanted_alone(&self) -> bool {
        false
    }
    /// As [`halo`](Self::halo) before vertices are moved or edges collapsed; `None` only where there are no chunks.
    fn unmoved_halo(&self) -> Option<u32> {
        None
    }
}
