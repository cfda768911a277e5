//! How far a mesh is from the isosurface it stands for, and how far its normals are from the field's.

use glam::Vec3;
use mesh::TriangleMesh;
use mesh::distribution::{Bins, Distribution};
use rayon::prelude::*;

use crate::ExtractError;
use crate::field::{Kept, ScalarField};
use crate::level::Level;
use crate::sampling::{SHARE, on_threads};
use crate::settings::Execution;

/// Points on a mesh.
const POINTS: usize = 8_192;
/// Most vertices that are looked at; of more, every second, third and so on.
const VERTICES: usize = 8_192;
/// How far a surface is looked for, in spacings.
const REACH: f32 = 3.0;
/// The histogram of distances, in spacings.
const FAR: f64 = 0.1;

/// The accuracy of a mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Accuracy {
    /// Distance from the mesh to the isosurface, in the unit of the coordinates, never negative. Over the area: each
    /// point stands for the same share of it.
    pub distance: Distribution,
    /// Angle between a vertex's normal and the field's outward direction at the vertex's foot on the isosurface, in
    /// degrees, 0..=180. Over vertices.
    pub normal_error_deg: Distribution,
    /// Points with no surface along the gradient within three spacings, or no gradient; they are in no distribution.
    pub lost_points: u64,
    /// Vertices of that kind, or without a normal.
    pub lost_vertices: u64,
}

/// Measures `mesh` against the isosurface of `field`. `spacing` is that of the lattice it was extracted on: it sets the
/// width of differences (1/32) and how far a surface is looked for (3).
///
/// Distances are taken at 8,192 points that share the area evenly: point `i` lies `(i + 1/2) / 8192` of the way
/// through the area, triangle after triangle, at a place in its triangle that follows a low-discrepancy sequence
/// (Roberts 2018). The distance is that along the gradient at the point. It is never less than the distance to the
/// nearest point of the isosurface; for a distance field they are equal, otherwise they differ by the cube of the
/// distance. Vertices are taken as they come, or evenly from more than 8,192 of them.
///
/// The result does not depend on `execution`.
///
/// # Errors
/// [`ExtractError::Threads`] if threads cannot be started.
///
/// # Panics
/// If a triangle's index is out of range.
pub fn accuracy(
    mesh: &TriangleMesh,
    field: &dyn ScalarField,
    isovalue: f32,
    spacing: f32,
    execution: &Execution,
) -> Result<Accuracy, ExtractError> {
    let mut kept = Kept::default();
    let level = Level { field: field.prepared(&mut kept).unwrap_or(field), isovalue, spacing };
    let points = points_by_area(mesh, POINTS);
    let every = mesh.normals.len().div_ceil(VERTICES).max(1);
    let vertices: Vec<usize> = (0..mesh.normals.len()).step_by(every).collect();
    let (distances, angles): (Vec<Option<f64>>, Vec<Option<f64>>) =
        on_threads(execution, POINTS.max(VERTICES) / SHARE, || {
            let distance = |&p: &Vec3| level.foot(p, REACH * spacing).map(|foot| foot.distance);
            let angle = |&v: &usize| normal_error_deg(&level, mesh.positions[v], mesh.normals[v]);
            (points.par_iter().map(distance).collect(), vertices.par_iter().map(angle).collect())
        })?;
    let lost = |of: &[Option<f64>]| of.iter().filter(|value| value.is_none()).count() as u64;
    let (lost_points, lost_vertices) = (lost(&distances), lost(&angles));
    let distances = distances.into_iter().flatten().collect();
    let angles = angles.into_iter().flatten().collect();
    Ok(Accuracy {
        distance: Distribution::of(distances, Bins { low: 0.0, high: FAR * f64::from(spacing), count: 50 }),
        normal_error_deg: Distribution::of(angles, Bins { low: 0.0, high: 30.0, count: 60 }),
        lost_points,
        lost_vertices,
    })
}

/// The angle between `normal` and the outward direction at the foot of `p`.
fn normal_error_deg(level: &Level, p: Vec3, normal: Vec3) -> Option<f64> {
    let normal = normal.as_dvec3().try_normalize()?;
    let outward = level.outward(level.foot(p, REACH * level.spacing)?.position)?;
    // Accurate near 0 and 180 degrees.
    Some(normal.cross(outward).length().atan2(normal.dot(outward)).to_degrees())
}

/// `count` points on the triangles, evenly over the area; none on a mesh without area.
fn points_by_area(mesh: &TriangleMesh, count: usize) -> Vec<Vec3> {
    let corners = |t: usize| mesh.corners(t).map(|p| p.as_dvec3());
    let area = |t: usize| {
        let [a, b, c] = corners(t);
        0.5 * (b - a).cross(c - a).length()
    };
    // The end of each triangle's share.
    let ends: Vec<f64> = (0..mesh.triangles.len())
        .scan(0.0, |sum, t| {
            *sum += area(t);
            Some(*sum)
        })
        .collect();
    let Some(&total) = ends.last().filter(|total| total.is_finite() && **total > 0.0) else {
        return Vec::new();
    };
    // The fractional parts of multiples of 1/g and 1/g^2, where g^3 = g + 1.
    const SEQUENCE: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    (0..count)
        .map(|i| {
            let place = (i as f64 + 0.5) / count as f64 * total;
            let t = ends.partition_point(|&end| end <= place).min(ends.len() - 1);
            let [a, b, c] = corners(t);
            let [mut u, mut v] = SEQUENCE.map(|step| (0.5 + i as f64 * step).fract());
            // The far half of the parallelogram is the triangle mirrored.
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            (a + (b - a) * u + (c - a) * v).as_vec3()
        })
        .collect()
}
