//! The solid between two isovalues.

use std::io::{self, Write};

use glam::DVec3;
use isostudy_mesh::TriangleMesh;

use crate::cells::{count_tetrahedra, tetrahedra};
use crate::crossings::{Crossings, Level};
use crate::error::FourError;
use crate::placement::{Placement, check_isovalue};
use crate::space_time::place;
use crate::surface::sort;
use crate::vtk::write_tetrahedra;

/// A solid of tetrahedra in three dimensions.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Solid {
    /// In the unit of the placement.
    pub positions: Vec<DVec3>,
    /// The value at each vertex: one of the isovalues, or that of the sample in whose place it is.
    pub values: Vec<f32>,
    /// Four indices into `positions` each: `det(b - a, c - a, d - a)` is the volume of six, and positive but for what
    /// [`interval_volume`] says.
    pub tetrahedra: Vec<[u32; 4]>,
}

/// The solid where values are above `low` and not above `high`, of samples on a lattice (Bhaniramka, Wenger & Crawfis 2004, section 6).
///
/// It is a surface in four dimensions, seen along the fourth axis: that of two frames, of which the first has `low` as its isovalue and
/// the second has `high`. So it has a vertex where each of the two isosurfaces crosses a lattice edge, and one on each sample between.
///
/// # Guaranteed
/// - Tetrahedra fit together. Their rim is [`surface`](crate::surface()) at `low`, and that at `high` turned round, with the same
///   vertices and triangles, but for what lies in the sides of the lattice.
/// - Where nothing above `low` is at the sides, the sum of volumes is the difference of those inside of the two surfaces.
///
/// # Not guaranteed
/// - Tetrahedra with a positive volume. The table is right for middles of edges. Where vertices lie far from these, a few tetrahedra
///   are flat or inside out; [`Solid::inverted`] counts them. The sum is right all the same.
///
/// # Errors
/// [`FourError::Order`] unless `low` is below `high`; [`FourError::Flat`], [`FourError::Samples`], [`FourError::NotFinite`],
/// [`FourError::Isovalue`], [`FourError::TooMany`].
pub fn interval_volume(
    placement: &Placement,
    samples: &[f32],
    low: f32,
    high: f32,
) -> Result<Solid, FourError> {
    let levels = levels(placement, samples, low, high)?;
    let counts = placement.counts;
    let (mut positions, mut values) = (Vec::new(), Vec::new());
    let mut within = |level: Level| {
        let from = positions.len();
        let made = Crossings::within(counts, level, from, |at| positions.push(placement.at(at)))?;
        values.resize(positions.len(), level.isovalue);
        Ok(made)
    };
    let ends = [within(levels[0])?, within(levels[1])?];
    let from = positions.len();
    let push = |sample: usize, _| {
        positions.push(placement.at(place(counts, sample)));
        values.push(samples[sample]);
    };
    let between = Crossings::between(levels, from, push)?;
    let mut tetrahedra = tetrahedra(counts, levels, [&ends[0], &ends[1]], &between);
    // Outside is after inside along the fourth axis. The normal comes first and its axis last, which is an odd order.
    if !placement.is_mirrored() {
        tetrahedra.iter_mut().for_each(|tetrahedron| tetrahedron.swap(2, 3));
    }
    Ok(Solid { positions, values, tetrahedra })
}

/// Bytes that [`interval_volume`] takes at most, beside the samples.
///
/// # Errors
/// As [`interval_volume`].
pub fn interval_bytes(placement: &Placement, samples: &[f32], low: f32, high: f32) -> Result<u64, FourError> {
    let levels = levels(placement, samples, low, high)?;
    let tetrahedra = count_tetrahedra(placement.counts, levels);
    Ok(OF_A_TETRAHEDRON * tetrahedra + 3 * OF_A_SAMPLE * samples.len() as u64)
}

/// Four numbers of vertices, twice while layers are put together, and room to grow; and its share of vertices.
const OF_A_TETRAHEDRON: u64 = 3 * 16 + 2 * 28;
/// The numbers of vertices, and the vertex on the sample itself.
const OF_A_SAMPLE: u64 = 5 + 28;

fn levels<'a>(
    placement: &Placement,
    samples: &'a [f32],
    low: f32,
    high: f32,
) -> Result<[Level<'a>; 2], FourError> {
    placement.check(0, samples)?;
    check_isovalue(low)?;
    check_isovalue(high)?;
    if low >= high {
        return Err(FourError::Order { low, high });
    }
    Ok([low, high].map(|isovalue| Level { samples, isovalue }))
}

impl Solid {
    /// The sum of the volumes. Those of tetrahedra that are inside out are negative.
    pub fn volume(&self) -> f64 {
        (0..self.tetrahedra.len()).map(|t| self.volume_of(t)).sum()
    }

    /// How many tetrahedra are inside out.
    pub fn inverted(&self) -> usize {
        (0..self.tetrahedra.len()).filter(|&t| self.volume_of(t) < 0.0).count()
    }

    fn volume_of(&self, t: usize) -> f64 {
        let [a, b, c, d] = self.tetrahedra[t].map(|v| self.positions[v as usize]);
        (b - a).dot((c - a).cross(d - a)) / 6.0
    }

    /// The triangles of one tetrahedron alone, counter-clockwise seen from outside, sorted. Vertices are those of the solid that they
    /// have, in its order.
    pub fn rim(&self) -> TriangleMesh {
        let sides = |&[a, b, c, d]: &[u32; 4]| [[b, c, d], [a, d, c], [a, b, d], [a, c, b]];
        let mut faces: Vec<([u32; 3], [u32; 3])> = self
            .tetrahedra
            .iter()
            .flat_map(sides)
            .map(|face| {
                let mut key = face;
                key.sort_unstable();
                (key, face)
            })
            .collect();
        faces.sort_unstable();
        let mut triangles: Vec<[u32; 3]> = faces
            .chunk_by(|one, other| one.0 == other.0)
            .filter_map(|same| if let [(_, face)] = same { Some(*face) } else { None })
            .collect();
        let mut number = vec![u32::MAX; self.positions.len()];
        triangles.iter().flatten().for_each(|&v| number[v as usize] = 0);
        let mut positions = Vec::new();
        for (v, number) in number.iter_mut().enumerate().filter(|(_, number)| **number == 0) {
            *number = positions.len() as u32;
            positions.push(self.positions[v].as_vec3());
        }
        triangles.iter_mut().flatten().for_each(|v| *v = number[*v as usize]);
        sort(&mut triangles);
        TriangleMesh { positions, triangles, normals: Vec::new() }
    }

    /// Writes an unstructured grid as a legacy file of VTK in ASCII, with the values at the vertices as the array `value`.
    ///
    /// # Errors
    /// Those of `output`.
    pub fn write_vtk(&self, output: impl Write) -> io::Result<()> {
        let places =
            self.positions.iter().zip(&self.values).map(|(p, value)| (p.to_array(), f64::from(*value)));
        write_tetrahedra(output, "solid between two isovalues", places, &self.tetrahedra, "value")
    }
}
