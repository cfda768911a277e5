//! The signed distance to a triangle mesh.

mod caps;
mod parts;
mod solid_angles;
mod winding;

use std::error::Error;
use std::fmt;

use glam::{DVec3, Vec3};
use isostudy_mesh::metro::Foot;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, MeshError, NearestTriangles, TriangleMesh, is_sound, used_vertices};

pub use self::parts::InwardPart;

use self::caps::Caps;
use self::parts::Enclosed;
use self::winding::WindingColumns;
use super::{SAFE, StudyField};

/// As near to the surface as this, in sizes of coordinates and triangles, which triangle is the nearest is a matter of rounding; the
/// way to one that is not may lead anywhere.
const ON_SURFACE: f64 = 1e-6;
/// A triangle that is so flat, in squared lengths of its longest side, faces where the rounding of its corners says.
const THINNEST: f64 = 1e-5;

/// Why a mesh has no inside to measure from.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum MeshFieldError {
    /// The mesh cannot be computed with.
    Mesh(MeshError),
    /// The surface is open, branches, or changes its orientation.
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
    /// The surface is as good as flat, so that neither side is inside.
    Flat {
        /// The signed volume.
        volume: f64,
        /// The area of all triangles.
        area: f64,
    },
    /// The triangles face inward, so that inside and outside would be swapped.
    InsideOut {
        /// The signed volume.
        volume: f64,
    },
}

impl fmt::Display for MeshFieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh(error) => error.fmt(f),
            Self::NotClosedManifold {
                boundary_edges,
                non_manifold_edges,
                misoriented_edges,
                non_manifold_vertices,
                duplicate_faces,
                collapsed_triangles,
            } => write!(
                f,
                "the mesh is not a closed manifold: {boundary_edges} boundary, {non_manifold_edges} non-manifold and \
                 {misoriented_edges} mis-oriented edges, {non_manifold_vertices} non-manifold vertices, \
                 {duplicate_faces} duplicate and {collapsed_triangles} collapsed triangles"
            ),
            Self::Open { edges, rings, longest, centre, radius } => write!(
                f,
                "the mesh is open: {edges} edges at holes, or between triangles that face opposite ways; in rings of them: {rings}; \
                 the longest has {longest} round {centre} (within {radius})"
            ),
            Self::Flat { volume, area } => write!(
                f,
                "the mesh encloses a volume of {volume} with an area of {area}: as good as nothing, so that no side is inside"
            ),
            Self::InsideOut { volume } => write!(
                f,
                "the mesh encloses a volume of {volume}; it must be positive, with triangles that face outward"
            ),
        }
    }
}

impl Error for MeshFieldError {}

impl From<MeshError> for MeshFieldError {
    fn from(error: MeshError) -> Self {
        Self::Mesh(error)
    }
}

/// The Euclidean distance to the surface of a solid: positive inside, negative outside, zero on it. Above an isovalue
/// `d` is what lies deeper than `d` inside; a negative isovalue makes the solid thicker.
///
/// The distance is that to the nearest triangle, in single precision (relative error of a few 1e-7 of the
/// distance and the size of the nearest triangles). The sign comes from a different computation altogether: the
/// winding number of the surface around the point, a whole number counted along a ray, inside where it is
/// positive. Normals at the nearest point, the usual shortcut, give a wrong sign where rounding picks the wrong one
/// of several nearest triangles, and a single wrong sign is a bubble in the isosurface.
///
/// Where a solid overlaps itself, the overlap is inside, and the distance there is still that to the nearest triangle,
/// which may be an inner wall. On such a wall, with inside all round, the value is not zero but the smallest normal
/// number, so that the isovalue 0 gives the union of all parts, walls or not, and so does a negative isovalue, made thicker.
/// An isovalue `d > 0` takes what lies within `d` of an inner wall away too: it gives each part and each overlap made
/// thinner, apart from one another.
///
/// A surface with holes has a sign as well, if it is asked for ([`Holes::Span`]): inside is where the generalised winding
/// number (Jacobson, Kavan & Sorkine-Hornung 2013), the share of all directions in which the surface is seen from
/// behind, is above one half. It is computed without a sum over all triangles: a cap on each loop of open edges closes the
/// surface, the whole number of that is counted along a ray, and the caps' solid angles are taken away again. Those are
/// exact where the caps have up to 64 triangles; where they have more, what is far away is expanded (Barill et al. 2018),
/// and the winding number is less than 1e-3 off. Across a hole there is no triangle, so there the value is not the
/// distance but goes through zero where the winding number is one half: a smooth sheet spans the hole. Where the
/// winding number is within 1/4 of a whole number, everywhere but near holes, the value is the distance.
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
    /// How far beside a point on the surface its sides are looked for.
    aside: f32,
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
    /// [`isostudy_mesh::repair::closed_solid`] mends open and inward meshes.
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
    /// [`isostudy_mesh::weld`] first joins those at one place. A part that faces inward is a cavity if another is round it, and
    /// nothing at all if not ([`inward_parts`](Self::inward_parts) finds those).
    ///
    /// The mesh as a whole has to face outward: the signed volume between its triangles and their common centre, the mean
    /// of their area, must be positive. That is the enclosed volume if the mesh is closed, wherever the centre is, and still
    /// has its sign if there are holes, even if no two triangles hang together.
    ///
    /// # Errors
    /// If `mesh` has no proper triangle or a bad index or coordinate; [`MeshFieldError::Open`];
    /// [`MeshFieldError::InsideOut`] if that volume is negative ([`isostudy_mesh::repair::flip`] turns the mesh);
    /// [`MeshFieldError::Flat`] if it is less, either way, than the area to the power 3/2 times 1e-12, or 1e-6 where there
    /// are holes.
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
            return Err(open.clone());
        }
        let enclosed = Enclosed::by((0..mesh.triangles.len()).map(|t| mesh.corners(t)));
        let Enclosed { volume, area } = enclosed;
        if enclosed.is_flat(if caps.is_empty() { 1e-12 } else { 1e-6 }) {
            return Err(MeshFieldError::Flat { volume, area });
        }
        if volume > 0.0 { Ok(Self::of(&mesh, caps)) } else { Err(MeshFieldError::InsideOut { volume }) }
    }

    fn of(mesh: &TriangleMesh, caps: Caps) -> Self {
        let mut triangles: Vec<[Vec3; 3]> = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect();
        let nearest = NearestTriangles::new(&triangles);
        let farthest = triangles.iter().flatten().map(|p| p.abs().max_element()).fold(0.0, f32::max);
        // Well beyond what a point is moved by where there are holes.
        let aside = (1e-6 * farthest).max(if caps.is_empty() { 0.0 } else { 2e-5 * caps.size });
        triangles.extend(caps.triangles());
        Self { nearest, winding: WindingColumns::new(triangles), caps, aside }
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

    /// Whether `p`, which is on the surface, is inside on all sides: on an inner wall. Looks at the eight octants, in which
    /// walls along the axes meet, and along the axes.
    fn is_within(&self, p: Vec3) -> bool {
        let is_inside = |q: Vec3| match self.caps.cannot_tell(q) {
            true => self.winding.at(q) > 0,
            false => self.winding_number(q) > 0.5,
        };
        let sides = (0..27).map(|i| Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32) - 1.0);
        sides
            .filter(|side| [1.0, 3.0].contains(&side.length_squared()))
            .all(|side| is_inside(p + side * self.aside))
    }

    /// The value at `p`, on which side of the nearest triangle it is.
    fn on_side(&self, p: Vec3, distance: f32, is_inside: impl FnOnce() -> bool) -> f32 {
        if distance == 0.0 {
            return if self.is_within(p) { f32::MIN_POSITIVE } else { 0.0 };
        }
        if is_inside() { distance } else { -distance }
    }

    /// The value at `p`, whose distance is known.
    fn signed(&self, p: Vec3, distance: f32) -> f32 {
        if distance == 0.0 || self.caps.cannot_tell(p) {
            return self.on_side(p, distance, || self.winding.at(p) > 0);
        }
        let over = (self.winding_number(p) - 0.5) as f32;
        // Zero where the surface spans a hole, and no limit where the winding number is as good as whole.
        let certainty = over.abs() / (0.25 - over.abs()).max(0.0);
        distance.min(certainty * self.caps.size).copysign(over)
    }

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
        self.on_side(p, distance, || match before {
            Some((q, value)) if p.distance(q) * SAFE < value.abs() => value > 0.0,
            _ => self.winding.at(p) > 0,
        })
    }
}

impl StudyField for MeshDistance {
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

    /// Towards the inside, of length 1: away from the nearest point of the surface or towards it. On the surface it is against the
    /// normal of a nearest triangle. Nothing is known near a hole, and where the nearest triangle is as good as a line.
    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        if !is_sound(p) || !self.caps.cannot_tell(p) {
            return None;
        }
        let q = p.as_dvec3();
        let triangles = self.winding.triangles();
        let found = self.nearest.nearest(q, f64::INFINITY, |t| triangles[t]);
        let corners = triangles[found.triangle].map(|corner| corner.as_dvec3());
        let [ab, ac, bc] = [corners[1] - corners[0], corners[2] - corners[0], corners[2] - corners[1]];
        let longest = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
        if found.distance > ON_SURFACE * (q.abs().max_element() + longest.sqrt()) {
            let away = (q - found.position) / found.distance;
            return Some((if self.winding.at(p) > 0 { away } else { -away }).as_vec3());
        }
        let normal = ab.cross(ac);
        (normal.length() > THINNEST * longest).then(|| -normal.normalize().as_vec3())
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
