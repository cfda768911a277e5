//! The signed distance to a triangle mesh.

mod caps;
mod winding;

use glam::{DVec3, Vec3};
use mesh::metro::Foot;
use mesh::topology::topology;
use mesh::{Bounds, MeshError, NearestTriangles, TriangleMesh, is_sound, used_vertices};
use thiserror::Error;

use self::caps::Caps;
use self::winding::WindingColumns;
use super::{SAFE, ScalarField};

/// Why a mesh has no inside to measure from.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MeshFieldError {
    /// The mesh cannot be computed with.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The surface is open, branches, or changes its orientation.
    #[error(
        "the mesh is not a closed manifold: {boundary_edges} boundary, {non_manifold_edges} non-manifold and \
         {misoriented_edges} mis-oriented edges, {non_manifold_vertices} non-manifold vertices, \
         {duplicate_faces} duplicate and {collapsed_triangles} collapsed triangles"
    )]
    NotClosedManifold {
        /// Edges with one triangle.
        boundary_edges: u64,
        /// Edges with more than two.
        non_manifold_edges: u64,
        /// Edges whose two triangles face opposite ways.
        misoriented_edges: u64,
        /// Fans beyond one at a vertex.
        non_manifold_vertices: u64,
        /// Triangles on the same three vertices as an earlier one.
        duplicate_faces: u64,
        /// Triangles that repeat a vertex.
        collapsed_triangles: u64,
    },
    /// The surface has holes, edges that triangles run more often one way than the other.
    #[error(
        "the mesh is open: {edges} open edges in {rings} holes, the longest with {longest} edges round {centre} (within \
         {radius}); what is inside is not certain there"
    )]
    Open {
        /// Edges that are not run as often one way as the other.
        edges: usize,
        /// Rings of such edges.
        rings: usize,
        /// How many edges the ring with the most has.
        longest: usize,
        /// The middle of that ring.
        centre: Vec3,
        /// How far the ring reaches from there.
        radius: f32,
    },
    /// The triangles face inward, so that inside and outside would be swapped.
    #[error("the mesh encloses a volume of {volume}; it must be positive, with triangles that face outward")]
    InsideOut {
        /// The signed volume.
        volume: f64,
    },
}

/// The Euclidean distance to the surface of a solid: positive inside, negative outside, zero on it. Above an isovalue
/// `d` is what lies deeper than `d` inside; a negative isovalue makes the solid thicker.
///
/// The distance is that to the nearest triangle, in single precision (relative error of a few 1e-7 of the
/// distance and the size of the nearest triangles). The sign comes from a different computation altogether: the
/// winding number of the surface around the point, a whole number counted along a ray, inside where it is
/// positive. Normals at the nearest point, the usual shortcut, give a wrong sign where rounding picks the wrong one
/// of several nearest triangles, and a single wrong sign is a bubble in the isosurface. Where a solid overlaps
/// itself, the overlap is inside, and the distance there is still that to the nearest triangle.
///
/// A surface with holes has a sign as well, if it is asked for ([`Holes::Span`]): inside is where the generalised winding
/// number (Jacobson, Kavan & Sorkine-Hornung 2013), the share of all directions in which the surface is seen from
/// behind, is above one half. It is computed exactly, to rounding, and without a sum over all triangles: a cone over
/// each ring of open edges closes the surface, the whole number of that is counted along a ray, and the cones' solid
/// angles are taken away again. Across a hole there is no triangle, so there the value is not the distance
/// but goes continuously through zero where the winding number is one half: a smooth sheet spans the hole. Where
/// the winding number is within 1/4 of a whole number, everywhere but near holes, the value is the distance.
///
/// Every call computes from scratch: the value at a point is the same on any thread and after any other point.
///
/// Costen (2026) samples his bunny with an approximate search and the sign and size of a plane distance, which
/// differs from this field away from the surface.
#[derive(Debug, Clone)]
pub struct MeshDistance {
    nearest: NearestTriangles,
    winding: WindingColumns,
    caps: Caps,
}

/// What to do with a mesh that is not closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Holes {
    /// Refuse it, saying where the largest hole is.
    #[default]
    Refuse,
    /// Take what is seen from behind in most directions for inside.
    Span,
}

impl MeshDistance {
    /// Builds the search structures, O(n log n), about 250 bytes a triangle.
    ///
    /// # Errors
    /// If `mesh` is empty, has a bad index or coordinate, is not a closed oriented manifold, or faces inward.
    /// [`mesh::repair::closed_solid`] mends open and inward meshes.
    pub fn try_new(mesh: &TriangleMesh) -> Result<Self, MeshFieldError> {
        check(mesh)?;
        Ok(Self::of(mesh, Caps::default()))
    }

    /// The field of any mesh that encloses something, whatever its topology.
    ///
    /// Triangles that repeat a vertex are passed over. A mesh is closed if triangles run each edge as often one way as the
    /// other: then every point has a whole winding number, and non-manifold edges, touching and overlapping parts do
    /// no harm. Otherwise `holes` says what comes of it. Two triangles side by side that face opposite ways make a hole
    /// too: their common edge is run twice one way. Only the vertices' numbers say which triangles are neighbours;
    /// [`mesh::weld`] first joins those at one place. A part that faces inward is a cavity if another is round it, and
    /// nothing at all if not.
    ///
    /// # Errors
    /// If `mesh` has no proper triangle or a bad index or coordinate; [`MeshFieldError::Open`];
    /// [`MeshFieldError::InsideOut`] if all in all it faces inward, its holes closed by cones ([`mesh::repair::flip`] turns it).
    pub fn try_from_any(mesh: &TriangleMesh, holes: Holes) -> Result<Self, MeshFieldError> {
        used_vertices(mesh)?;
        let is_proper = |&&[a, b, c]: &&[u32; 3]| a != b && b != c && c != a;
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().filter(is_proper).copied().collect();
        let mesh = TriangleMesh { triangles, normals: Vec::new(), positions: mesh.positions.clone() };
        if mesh.triangles.is_empty() {
            return Err(MeshError::Empty.into());
        }
        let caps = Caps::of(&mesh);
        if let (Holes::Refuse, Some(open)) = (holes, caps.open()) {
            return Err(open);
        }
        let volume = mesh.volume() + caps.volume();
        if volume > 0.0 { Ok(Self::of(&mesh, caps)) } else { Err(MeshFieldError::InsideOut { volume }) }
    }

    fn of(mesh: &TriangleMesh, caps: Caps) -> Self {
        let mut triangles: Vec<[Vec3; 3]> = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect();
        let nearest = NearestTriangles::new(&triangles);
        triangles.extend(caps.triangles());
        Self { nearest, winding: WindingColumns::new(triangles), caps }
    }

    /// The winding number of the surface around `p`: 0 outside, 1 inside, 2 where the solid overlaps itself, and
    /// anything between where there are holes. On the surface, or a millionth of the holes' size from it, it is that of
    /// one of the sides; 0 where `p` is not a number and there are no holes.
    pub fn winding_number(&self, p: Vec3) -> f64 {
        if self.caps.is_empty() {
            return f64::from(self.winding.at(p));
        }
        let beside = self.caps.beside(p);
        f64::from(self.winding.at(beside)) - self.caps.share(beside)
    }

    /// The value at `p`, whose distance is known.
    fn signed(&self, p: Vec3, distance: f32) -> f32 {
        if self.caps.cannot_tell(p) {
            return if self.winding.at(p) > 0 { distance } else { -distance };
        }
        let over = (self.winding_number(p) - 0.5) as f32;
        // Zero where the surface spans a hole, and no limit where the winding number is as good as whole.
        let certainty = over.abs() / (0.25 - over.abs()).max(0.0);
        distance.min(certainty * self.caps.size).copysign(over)
    }
}

impl MeshDistance {
    /// The value at `p`. The search starts where another ended, from the distance that the nearby value leaves possible,
    /// and the side is known where no surface can be between.
    fn sample_from(&self, p: Vec3, before: Option<(Vec3, f32)>, from: &mut u32) -> f32 {
        // Near a hole a value is less than a distance.
        if !is_sound(p) || !self.caps.is_empty() {
            return self.sample(p);
        }
        let before = before.filter(|(_, value)| value.is_finite());
        let limit = before.map_or(f32::INFINITY, |(q, value)| {
            (value.abs() + p.distance(q)) * SAFE + 1e-6 * p.abs().max_element()
        });
        let distance = self.nearest.distance_from(p, limit, from);
        let is_inside = match before {
            Some((q, value)) if p.distance(q) * SAFE < value.abs() => value > 0.0,
            _ => self.winding.at(p) > 0,
        };
        if is_inside { distance } else { -distance }
    }
}

impl ScalarField for MeshDistance {
    /// `NaN`, which counts as outside, where `p` is beyond the limit for coordinates or no point at all.
    fn sample(&self, p: Vec3) -> f32 {
        if !is_sound(p) {
            return f32::NAN;
        }
        self.signed(p, self.nearest.distance(p))
    }

    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        self.sample_row_after(x, y, z, values, None);
    }

    /// Each search starts where the one before ended.
    fn sample_row_after(
        &self,
        x: &[f32],
        y: f32,
        z: f32,
        values: &mut [f32],
        mut before: Option<(Vec3, f32)>,
    ) {
        let mut from = 0;
        for (value, &x) in values.iter_mut().zip(x) {
            let p = Vec3::new(x, y, z);
            *value = self.sample_from(p, before, &mut from);
            before = Some((p, *value));
        }
    }

    fn sample_after(&self, p: Vec3, before: Option<(Vec3, f32)>) -> f32 {
        self.sample_from(p, before, &mut 0)
    }

    /// A distance changes no faster than one goes; nothing is known near a hole.
    fn slope(&self, bounds: Bounds) -> Option<f32> {
        let is_far = || self.caps.cannot_tell_in(bounds);
        (is_sound(bounds.min) && is_sound(bounds.max) && is_far()).then_some(1.0)
    }

    /// Known for the isovalue 0 and a mesh without holes: the nearest point of its triangles.
    fn nearest_on_isosurface(&self, p: DVec3, isovalue: f32) -> Option<Foot> {
        let triangles = self.isosurface_triangles(isovalue).filter(|_| is_sound(p.as_vec3()))?;
        let found = self.nearest.nearest(p, f64::INFINITY, |t| triangles[t]);
        Some(Foot { position: found.position, distance: found.distance })
    }

    fn isosurface_triangles(&self, isovalue: f32) -> Option<&[[Vec3; 3]]> {
        (isovalue == 0.0 && self.caps.is_empty()).then(|| self.winding.triangles())
    }
}

fn check(mesh: &TriangleMesh) -> Result<(), MeshFieldError> {
    used_vertices(mesh)?;
    let report = topology(mesh);
    if !report.is_closed_manifold() {
        return Err(MeshFieldError::NotClosedManifold {
            boundary_edges: report.boundary_edges,
            non_manifold_edges: report.non_manifold_edges,
            misoriented_edges: report.misoriented_edges,
            non_manifold_vertices: report.non_manifold_vertices,
            duplicate_faces: report.duplicate_faces,
            collapsed_triangles: report.collapsed_triangles,
        });
    }
    let volume = mesh.volume();
    if volume > 0.0 { Ok(()) } else { Err(MeshFieldError::InsideOut { volume }) }
}
