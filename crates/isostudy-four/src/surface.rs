//! The surface of one frame.

use isostudy_mesh::TriangleMesh;

use crate::cells::triangles;
use crate::crossings::{Crossings, Level};
use crate::error::FourError;
use crate::placement::{Placement, check_isovalue};

/// The isosurface of samples by the table of three dimensions, [`Table<3>`](crate::Table): marching cubes by the hull rule.
///
/// Inside is above the isovalue, and what equals it is outside. Triangles run counter-clockwise seen from outside, also where the
/// placement is mirrored. Vertices are where the values interpolated along lattice edges are the isovalue. They are in the order of the
/// samples that their edges begin at, then of axes. Triangles begin with their lowest vertex and are sorted. There are no normals.
///
/// # Guaranteed
/// - The surface is a manifold, and closed but for the sides of the lattice.
/// - The same mesh with any number of threads.
///
/// # Not guaranteed
/// - Triangles with area. Where a sample equals the isovalue, up to six vertices lie on it.
/// - The topology of the trilinear interpolant: the hull joins inside samples that lie opposite in a cell.
///
/// # Errors
/// [`FourError::Flat`], [`FourError::Samples`], [`FourError::NotFinite`], [`FourError::Isovalue`], [`FourError::TooMany`].
pub fn surface(placement: &Placement, samples: &[f32], isovalue: f32) -> Result<TriangleMesh, FourError> {
    placement.check(0, samples)?;
    check_isovalue(isovalue)?;
    let level = Level { samples, isovalue };
    let mut positions = Vec::new();
    let push = |at| positions.push(placement.at(at).as_vec3());
    let vertices = Crossings::within(placement.counts, level, 0, push)?;
    let mut triangles = triangles(placement.counts, level, &vertices);
    if placement.is_mirrored() {
        triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    sort(&mut triangles);
    Ok(TriangleMesh { positions, triangles, normals: Vec::new() })
}

/// Each triangle from its lowest vertex on, and all in order: one order for meshes that were made in different ways.
pub(crate) fn sort(triangles: &mut [[u32; 3]]) {
    for triangle in triangles.iter_mut() {
        let [a, b, c] = *triangle;
        *triangle = if a < b && a < c {
            [a, b, c]
        } else if b < c {
            [b, c, a]
        } else {
            [c, a, b]
        };
    }
    triangles.sort_unstable();
}
