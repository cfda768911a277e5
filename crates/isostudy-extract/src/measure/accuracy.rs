//! How far a mesh is from the isosurface it stands for, and how far its normals are from the field's.

use glam::{DVec3, Vec3};
use isostudy_mesh::distribution::{Bins, Distribution};
use isostudy_mesh::metro::{AreaSamples, Surface};
use isostudy_mesh::{Bounds, TriangleMesh};

use crate::execution::threads::{SHARE, mapped, on_threads};
use crate::extraction::ExtractError;
use crate::lattice::BoxGrid;
use crate::measure::isosurface::{Isosurface, REACH, foot};
use crate::sampling::level::Level;
use crate::settings::Execution;
use isostudy_field::{FieldCache, StudyField};

/// Points on a mesh.
const POINTS: u64 = 65_536;
/// Points on an isosurface: of a box of 40 cells, one in twelve is near an edge and tells what a mesh rounds. Of half as many, the mean
/// distance was off by 2 %, of a quarter by 4 %.
const CROSSINGS: u64 = 131_072;
/// Most points of sharp edges; of more, every second, third and so on.
const EDGE_POINTS: usize = 8_192;
/// Where they lie.
const SEED: u64 = 1;
/// Most vertices that are looked at; of more, every second, third and so on.
const VERTICES: usize = 8_192;
/// The histogram of distances, in spacings.
const FAR: f64 = 0.1;

/// The accuracy of a mesh. Lengths are in the unit of the coordinates.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Accuracy {
    /// Distance from the mesh to the isosurface, never negative. Over the mesh's area: each point stands for the same
    /// share of it. Root mean square and maximum are [`Distribution::rms`] and `max`.
    pub distance: Distribution,
    /// Distance from the isosurface to the mesh: what the mesh leaves out is far from it. Over the isosurface's area.
    pub distance_to_mesh: Distribution,
    /// Distance from points of the isosurface's sharp edges to the mesh: small where a mesh keeps them, and a good part of a spacing
    /// where it rounds them. Empty where the isosurface has none.
    pub sharp_edges: Distribution,
    /// Angle between a vertex's normal and the field's outward direction at the vertex's foot on the isosurface, in
    /// degrees, 0..=180. Over vertices.
    pub normal_error_deg: Distribution,
    /// Points of the mesh with no surface along the gradient within three spacings, or no gradient; they are in no
    /// distribution. None where the field knows its isosurface.
    pub lost_points: u64,
    /// Vertices of that kind, or without a normal.
    pub lost_vertices: u64,
}

impl Accuracy {
    /// The larger of both maxima: the Hausdorff distance, as far as the points tell. 0 if there were none.
    pub fn hausdorff(&self) -> f64 {
        self.distance.max.max(self.distance_to_mesh.max)
    }
}

/// Measures `mesh` against the isosurface of `field` in the box of the `grid` it was extracted on. The grid's
/// spacing sets the width of differences (1/32) and how far a surface is looked for (3).
///
/// Distances are taken at 65,536 points that share the area evenly, as [`AreaSamples`] places them. The density is that
/// number over the area.
///
/// To the isosurface, the distance is exact where the field knows it ([`StudyField::nearest_on_isosurface`]: a
/// sphere, a mesh). Otherwise it is that along the gradient at the point, to a root that is known to 1e-5 spacings. This
/// is never less than the distance to the nearest point; for a field with parallel isosurfaces they are equal, otherwise
/// they differ by the cube of the distance.
///
/// From the isosurface, points are those of its triangles, if it has any ([`StudyField::isosurface_triangles`]: a
/// mesh): 131,072 of them. Otherwise about as many are taken where straight lines cross it, which are spread evenly over
/// places and directions:
/// they cross each piece of a surface as often as its area says, sharp edges included (Cauchy & Crofton). No extraction is
/// asked. A line is followed in steps of a quarter of a spacing, and of down to a two-thousandth where the field could
/// reach the isovalue in between and turn back. Points outside the box are left out. The distance is that to the nearest triangle of
/// `mesh`.
///
/// A sharp edge is one where the isosurface's normal, of the field's own gradient if it has one, turns by more than 30
/// degrees within a sixteenth of a spacing; convex and concave ones count. It is found where an edge of an
/// extraction, on a body-centred lattice with three quarters of the spacing, passes from one of its sides to the other, in at most 32,768 places; its point is where the two tangent planes meet. Of a volume, which is
/// interpolated, kinks between cells count if they are as sharp. Of a mesh, sharp edges are those of its triangles. Of
/// more than 8,192 points, every second, third and so on is taken.
///
/// Vertices are taken as they come, or evenly from more than 8,192 of them.
///
/// The result does not depend on `execution`.
///
/// # Errors
/// As [`crate::by_lattice::extract`].
///
/// # Panics
/// If a triangle's index is out of range, or there are more normals than vertices.
pub fn accuracy(
    mesh: &TriangleMesh,
    field: &dyn StudyField,
    isovalue: f32,
    grid: &BoxGrid,
    execution: &Execution,
) -> Result<Accuracy, ExtractError> {
    let points = IsosurfacePoints::of(field, isovalue, grid, None, execution)?;
    accuracy_beside(&points, mesh, field, isovalue, grid.spacing, execution)
}

/// Points of an isosurface and of its sharp edges, in a box or a region of it: of any number of meshes from the same field, isovalue
/// and grid they are the same.
#[derive(Debug, Clone)]
pub struct IsosurfacePoints {
    /// Evenly in area.
    surface: Vec<DVec3>,
    sharp: Vec<DVec3>,
    region: Option<Bounds>,
}

impl IsosurfacePoints {
    /// Finds them, as [`accuracy`] says: in the whole box of the grid, or in a `region` of it alone. Those of a region do not depend
    /// on what the field is elsewhere, but for a few spacings.
    ///
    /// # Errors
    /// As [`accuracy`].
    pub fn of(
        field: &dyn StudyField,
        isovalue: f32,
        grid: &BoxGrid,
        region: Option<Bounds>,
        execution: &Execution,
    ) -> Result<Self, ExtractError> {
        let mut kept = FieldCache::default();
        let sampled = field.prepared(&mut kept).unwrap_or(field);
        let level = Level { field: sampled, isovalue, spacing: grid.spacing };
        let Bounds { min, max } = region.unwrap_or(grid.bounds);
        let within = Bounds { min: min.max(grid.bounds.min), max: max.min(grid.bounds.max) };
        let isosurface = Isosurface::new(field, level, grid, &within, execution)?;
        on_threads(execution, POINTS as usize / SHARE, || {
            let sharp = isosurface.sharp_edges();
            let every = sharp.len().div_ceil(EDGE_POINTS).max(1);
            let surface = isosurface.points(|_| CROSSINGS as f64, SEED).points;
            Self { surface, sharp: sharp.into_iter().step_by(every).collect(), region }
        })
    }
}

/// As [`accuracy`], with the isosurface's points at hand: those of this field and isovalue on a grid of this spacing.
///
/// Of points in a region, that part of the mesh alone is measured: points on it and vertices that lie in the region. The distance from
/// the isosurface is that to the whole mesh.
///
/// # Errors
/// If threads cannot be started.
///
/// # Panics
/// As [`accuracy`].
pub fn accuracy_beside(
    points: &IsosurfacePoints,
    mesh: &TriangleMesh,
    field: &dyn StudyField,
    isovalue: f32,
    spacing: f32,
    execution: &Execution,
) -> Result<Accuracy, ExtractError> {
    let IsosurfacePoints { surface: beyond, sharp, region } = points;
    let points: Vec<DVec3> = points_of(mesh, region.as_ref());
    // Without an area there is nothing to be far from.
    let surface = Surface::try_new(mesh).ok();

    let mut kept = FieldCache::default();
    let level = Level { field: field.prepared(&mut kept).unwrap_or(field), isovalue, spacing };
    let is_within = |&v: &usize| region.is_none_or(|region| has(&region, mesh.positions[v].as_dvec3()));
    let vertices: Vec<usize> = (0..mesh.normals.len()).filter(is_within).collect();
    let every = vertices.len().div_ceil(VERTICES).max(1);
    let vertices: Vec<usize> = vertices.into_iter().step_by(every).collect();
    let to_surface = |p: DVec3| Some(surface.as_ref()?.nearest(p, f64::INFINITY).distance);
    let most = (POINTS as usize).max(VERTICES) / SHARE;
    let (there, back, sharp, angles): (Vec<_>, Vec<_>, Vec<_>, Vec<_>) = on_threads(execution, most, || {
        let distance = |&p: &DVec3| foot(field, &level, p).map(|foot| foot.distance);
        let to_mesh = |p: &DVec3| to_surface(*p);
        let angle = |&v: &usize| normal_error_deg(&level, mesh.positions[v], mesh.normals[v]);
        let sharp = mapped(sharp, |&p| to_surface(p));
        (mapped(&points, distance), mapped(beyond, to_mesh), sharp, mapped(&vertices, angle))
    })?;
    let lost = |of: &[Option<f64>]| of.iter().filter(|value| value.is_none()).count() as u64;
    let (lost_points, lost_vertices) = (lost(&there), lost(&angles));
    let known = |of: Vec<Option<f64>>, bins| Distribution::of(of.into_iter().flatten().collect(), bins);
    let near = Bins { low: 0.0, high: FAR * f64::from(spacing), count: 50 };
    Ok(Accuracy {
        distance: known(there, near),
        distance_to_mesh: known(back, near),
        sharp_edges: known(sharp, Bins { high: f64::from(spacing), ..near }),
        normal_error_deg: known(angles, Bins { low: 0.0, high: 30.0, count: 60 }),
        lost_points,
        lost_vertices,
    })
}

/// Points of a mesh, evenly in area: of the whole, or those that lie in a region.
fn points_of(mesh: &TriangleMesh, region: Option<&Bounds>) -> Vec<DVec3> {
    let touches = |corners: &[Vec3; 3]| {
        let [a, b, c] = *corners;
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        region.is_none_or(|of| max.cmpge(of.min).all() && min.cmple(of.max).all())
    };
    let all = (0..mesh.triangles.len()).map(|t| mesh.corners(t));
    let triangles: Vec<[Vec3; 3]> = all.filter(touches).collect();
    let samples = AreaSamples::new(&triangles, POINTS, SEED);
    samples.points(0..samples.count()).filter(|p| region.is_none_or(|region| has(region, *p))).collect()
}

fn has(region: &Bounds, p: DVec3) -> bool {
    p.cmpge(region.min.as_dvec3()).all() && p.cmple(region.max.as_dvec3()).all()
}

/// The angle between `normal` and the outward direction at the foot of `p`.
pub(crate) fn normal_error_deg(level: &Level, p: Vec3, normal: Vec3) -> Option<f64> {
    let normal = normal.as_dvec3().try_normalize()?;
    let outward = level.outward(level.foot(p, REACH * level.spacing)?.position)?;
    // Accurate near 0 and 180 degrees.
    Some(normal.cross(outward).length().atan2(normal.dot(outward)).to_degrees())
}
