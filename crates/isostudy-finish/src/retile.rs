//! Points spread over a surface, which become its vertices.
//!
//! Turk, *Re-Tiling Polygonal Surfaces*, SIGGRAPH 1992: points are thrown onto the surface and push each other apart on it. They are put
//! into the triangles they lie in, and then the old vertices are taken out one by one, where the topology stays. The paper
//! triangulates the hole of a vertex in a plane. Here a vertex moves into the neighbour that leaves the best triangles, and
//! edges are flipped afterwards.

mod density;
mod insertion;
mod removal;
mod spread;

use crate::error::FinishError;
use crate::outcome::{Finished, Stopped};
use crate::surface::{Surface, VertexKind};
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::Vec3;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;

/// How points are spread over a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Density {
    /// Evenly.
    #[default]
    Area,
    /// Closer where the surface bends more: up to three times in length.
    Curvature,
}

/// What is asked of the points.
pub(crate) struct Retile {
    /// Vertices that the mesh shall have.
    pub(crate) points: usize,
    /// Where they lie closer.
    pub(crate) by: Density,
    /// Seed of their first places.
    pub(crate) seed: u64,
}

impl Retile {
    /// The mesh with so many vertices, which lie on the surface. Topology stays. Vertices of borders and of faults stay, and count among
    /// the points. Edges of the surface are not kept sharp.
    ///
    /// # Errors
    /// If more vertices stay than there shall be, no triangle has an area, or points are so close that they are at one place.
    pub(crate) fn run(&self, mesh: &TriangleMesh) -> Result<Finished, FinishError> {
        let mut surface = Surface::of(mesh);
        let kinds = surface.kinds();
        let stays = |kind: &&VertexKind| matches!(kind, VertexKind::Border | VertexKind::Singular);
        let staying = kinds.iter().filter(stays).count();
        if self.points <= staying {
            let [points, staying] = [self.points, staying].map(|count| count as u64);
            return Err(FinishError::StayingVertices { points, staying });
        }
        let density = density::of_triangles(&surface, self.by);
        let places = spread::spread(&surface, &density, self.points - staying, self.seed)
            .ok_or(FinishError::NoArea)?;
        let at: Vec<Vec3> = places.iter().map(|place| place.position.as_vec3()).collect();
        self.check_apart(&at, &surface, &kinds)?;
        let old = surface.positions.len() as u32;
        let normals = insertion::insert(&mut surface, &places, &at);
        let left = removal::remove(&mut surface, kinds, old, &normals);
        let stopped = left.first().map(|&v| Stopped {
            step: "re-tile",
            left: left.len() as u64,
            what: "old vertices",
            at: surface.positions[v as usize],
        });
        Ok(Finished { mesh: surface.into_mesh(), stopped: stopped.into_iter().collect() })
    }

    /// Checks that all vertices that the mesh will have are at places of their own.
    fn check_apart(&self, at: &[Vec3], surface: &Surface, kinds: &[VertexKind]) -> Result<(), FinishError> {
        let key = |p: &Vec3| (*p + Vec3::ZERO).to_array().map(f32::to_bits);
        let used = (0..kinds.len()).filter(|&v| kinds[v] != VertexKind::Unused);
        let mut taken: HashSet<[u32; 3]> = used.map(|v| key(&surface.positions[v])).collect();
        match at.iter().find(|p| !taken.insert(key(p))) {
            Some(&at) => Err(FinishError::TooClose { points: self.points as u64, at }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests;
