//! A part of a mesh that is judged by itself, and what is judged of a mesh.

use super::{Accuracy, MeshRecord, Quality};
use serde::{Deserialize, Serialize};

/// What a mesh is within the object's region. A triangle belongs to it by its centroid, a point by its position, and a pair of triangles
/// if both do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RegionMeasures {
    /// The region's name in the study.
    pub name: String,
    /// Triangles, degenerate ones included.
    pub triangles: u64,
    /// Their area over that of the whole mesh, 0 to 1.
    pub area_share: f64,
    /// Quality of the triangles.
    pub quality: Quality,
    /// How well that part stands for its isosurface.
    pub accuracy: Accuracy,
    /// Pairs of triangles that pass through each other.
    pub self_intersections: Option<u64>,
}

/// What is judged of a mesh: its region where it has one, else the whole.
#[derive(Debug, Clone, Copy)]
pub struct Judged<'a> {
    /// Name of the region.
    pub region: Option<&'a str>,
    /// Triangles.
    pub triangles: u64,
    /// Quality of the triangles.
    pub quality: &'a Quality,
    /// How well it stands for its isosurface.
    pub accuracy: &'a Accuracy,
    /// Pairs of triangles that pass through each other.
    pub self_intersections: Option<u64>,
}

impl MeshRecord {
    /// What decides: of the region alone, if there is one.
    pub fn judged(&self) -> Judged<'_> {
        match &self.region {
            Some(of) => Judged {
                region: Some(&of.name),
                triangles: of.triangles,
                quality: &of.quality,
                accuracy: &of.accuracy,
                self_intersections: of.self_intersections,
            },
            None => self.whole(),
        }
    }

    /// The whole mesh.
    pub fn whole(&self) -> Judged<'_> {
        Judged {
            region: None,
            triangles: self.counts.triangles,
            quality: &self.quality,
            accuracy: &self.accuracy,
            self_intersections: self.topology.self_intersections,
        }
    }
}
