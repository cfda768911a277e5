//! Triangles of a surface that lie in one plane.

use crate::surface::Surface;
use isostudy_mesh::glam::DVec3;

/// Connected regions of triangles in one plane each.
pub(crate) struct Regions {
    of_triangle: Vec<u32>,
    triangles: Vec<Vec<u32>>,
    normals: Vec<DVec3>,
}

const NONE: u32 = u32::MAX;

impl Regions {
    /// Grows regions from the largest triangles. A neighbour joins if its corners lie within the tolerance of the region's plane, and it
    /// faces the same way or is so thin that it faces nowhere. Triangles without area that join nothing are regions of their own.
    pub(crate) fn of(surface: &Surface, tolerance: f64) -> Self {
        let count = surface.triangles.len();
        let areas: Vec<f64> = (0..count as u32).map(|t| surface.area_vector(t).length()).collect();
        let mut seeds: Vec<u32> = (0..count as u32).collect();
        seeds.sort_by(|&a, &b| areas[b as usize].total_cmp(&areas[a as usize]).then(a.cmp(&b)));
        let mut regions = Self { of_triangle: vec![NONE; count], triangles: Vec::new(), normals: Vec::new() };
        for seed in seeds {
            if regions.of_triangle[seed as usize] == NONE {
                regions.grow(surface, seed, tolerance);
            }
        }
        regions
    }

    /// Grows one region. The plane of a small triangle is not known well far away from it. So once nothing joins, the plane is
    /// taken from all that have joined, as long as these lie in it.
    fn grow(&mut self, surface: &Surface, seed: u32, tolerance: f64) {
        let r = self.triangles.len() as u32;
        let mut members = vec![seed];
        self.of_triangle[seed as usize] = r;
        let mut plane = Plane::of(surface, &members);
        loop {
            let before = members.len();
            if plane.normal == DVec3::ZERO {
                break;
            }
            self.join_neighbours(surface, &mut members, |t| plane.has(surface, t, tolerance));
            if members.len() == before {
                break;
            }
            let next = Plane::of(surface, &members);
            if !members.iter().all(|&t| next.has(surface, t, tolerance)) {
                break;
            }
            plane = next;
        }
        members.sort_unstable();
        self.triangles.push(members);
        self.normals.push(plane.normal);
    }

    /// Adds what joins over edges of two triangles that face the same way.
    fn join_neighbours(&mut self, surface: &Surface, members: &mut Vec<u32>, joins: impl Fn(u32) -> bool) {
        let r = self.of_triangle[members[0] as usize];
        let mut at = 0;
        while at < members.len() {
            let corners = surface.triangles[members[at] as usize];
            for k in 0..3 {
                let Some(other) = across(surface, corners[k], corners[(k + 1) % 3]) else { continue };
                if self.of_triangle[other as usize] == NONE && joins(other) {
                    self.of_triangle[other as usize] = r;
                    members.push(other);
                }
            }
            at += 1;
        }
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.triangles.len()
    }

    /// The triangles of a region, in rising order.
    pub(crate) fn triangles(&self, r: usize) -> &[u32] {
        &self.triangles[r]
    }

    /// The normal of its plane, of unit length; zero if it is a triangle without area.
    pub(crate) fn normal(&self, r: usize) -> DVec3 {
        self.normals[r]
    }

    /// The region of a triangle.
    pub(crate) fn of_triangle(&self, t: u32) -> u32 {
        self.of_triangle[t as usize]
    }
}

struct Plane {
    normal: DVec3,
    through: DVec3,
}

impl Plane {
    /// The plane of triangles: through their middle, with the sum of their areas for its normal.
    fn of(surface: &Surface, triangles: &[u32]) -> Self {
        let (mut sum, mut middle, mut area) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for &t in triangles {
            let (of, [a, b, c]) = (surface.area_vector(t), surface.corners(t));
            sum += of;
            middle += (a + b + c) * (of.length() / 3.0);
            area += of.length();
        }
        Self { normal: sum.normalize_or_zero(), through: middle / area }
    }

    fn has(&self, surface: &Surface, t: u32, tolerance: f64) -> bool {
        let corners = surface.corners(t);
        let is_flat = corners.iter().all(|p| (*p - self.through).dot(self.normal).abs() <= tolerance);
        let lengths = [0, 1, 2].map(|k| corners[k].distance(corners[(k + 1) % 3]));
        let area_vector = surface.area_vector(t);
        let is_thin = area_vector.length() <= 2.0 * tolerance * lengths.into_iter().fold(0.0, f64::max);
        is_flat && (is_thin || area_vector.dot(self.normal) > 0.5 * area_vector.length())
    }
}

/// The triangle beyond the edge that one runs from `u` to `v`; `None` at a border or a fault.
pub(crate) fn across(surface: &Surface, u: u32, v: u32) -> Option<u32> {
    let (other, _) = surface.triangle_along(v, u)?;
    (surface.triangles_of_edge(u, v).count() == 2).then_some(other)
}
