//! The surface of a series in space-time.

use std::io::{self, Write};
use std::ops::Range;

use glam::{DVec3, DVec4};
use isostudy_mesh::TriangleMesh;

use crate::cells::tetrahedra;
use crate::crossings::{Crossings, Level};
use crate::error::FourError;
use crate::placement::Placement;
use crate::slicing;
use crate::vtk::write_tetrahedra;

/// A surface in space-time: tetrahedra in four dimensions, of which each time has a slice.
///
/// A vertex is on each lattice edge between an inside and an outside sample. It is along x, y or z in a frame, or along time at the
/// place of a sample. Tetrahedra come by the table of four dimensions, cell by cell.
///
/// # Guaranteed
/// - It is a 3-manifold, closed but for the sides of the lattice and the first and the last frame: each triangle is in two tetrahedra,
///   and the tetrahedra at a vertex are a ball.
/// - For a tetrahedron `a b c d`, `det(n, b - a, c - a, d - a) > 0` in coordinates x, y, z, t, where `n` points away from the inside.
///   This is the order of vertices alone, and also said of tetrahedra that are flat.
/// - In each whole frame it has the triangles of [`surface`](crate::surface()).
///
/// # Not guaranteed
/// - Tetrahedra with volume. Vertices on a sample that equals the isovalue lie on each other.
/// - That tetrahedra do not pass through each other within a cell: the table is right for middles of edges, and vertices are moved along
///   them.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceTime {
    /// x, y, z in the unit of the placement, and time in frames.
    pub positions: Vec<DVec4>,
    /// Four indices into `positions` each.
    pub tetrahedra: Vec<[u32; 4]>,
    /// The number of the first frame.
    first: usize,
    /// The vertices of each frame; after them come those between it and the next.
    frames: Vec<Range<u32>>,
    /// Of each frame but the last, the tetrahedra between it and the next.
    layers: Vec<Range<usize>>,
}

impl SpaceTime {
    pub(crate) fn of(placement: &Placement, levels: &[Level], first: usize) -> Result<Self, FourError> {
        let counts = placement.counts;
        let (mut positions, mut tetrahedra_of_all) = (Vec::new(), Vec::new());
        let (mut frames, mut layers) = (Vec::new(), Vec::new());
        let within = |number: usize, positions: &mut Vec<DVec4>| {
            let from = positions.len();
            let time = (first + number) as f64;
            let push = |at| positions.push(placement.at(at).extend(time));
            let made = Crossings::within(counts, levels[number], from, push)?;
            Ok::<_, FourError>((made, from as u32..positions.len() as u32))
        };
        let (mut here, range) = within(0, &mut positions)?;
        frames.push(range);
        for number in 0..levels.len() - 1 {
            let pair = [levels[number], levels[number + 1]];
            let from = positions.len();
            let push = |sample: usize, share: f64| {
                let time = (first + number) as f64 + share;
                positions.push(placement.at(place(counts, sample)).extend(time));
            };
            let between = Crossings::between(pair, from, push)?;
            let (there, range) = within(number + 1, &mut positions)?;
            let start = tetrahedra_of_all.len();
            tetrahedra_of_all.extend(tetrahedra(counts, pair, [&here, &there], &between));
            frames.push(range);
            layers.push(start..tetrahedra_of_all.len());
            here = there;
        }
        if placement.is_mirrored() {
            tetrahedra_of_all.iter_mut().for_each(|tetrahedron| tetrahedron.swap(2, 3));
        }
        Ok(Self { positions, tetrahedra: tetrahedra_of_all, first, frames, layers })
    }

    /// The surface at one time, as triangles that run counter-clockwise seen from outside, without normals. Time is in frames.
    ///
    /// At a whole frame it is the mesh of [`surface`](crate::surface()) on that frame, to the bit: the same vertices, triangles and
    /// order. Between frames each tetrahedron that has vertices on both sides of the time gives a triangle or two, whose vertices are
    /// where its sides are at that time. A vertex at just that time counts as before it.
    ///
    /// # Guaranteed
    /// - The slice is a manifold, closed but for the sides of the lattice.
    ///
    /// # Not guaranteed
    /// - Triangles with area, close to a whole frame and elsewhere.
    /// - That slices close to a whole frame have the same number of components as that frame: it may be where the surface splits.
    ///
    /// # Errors
    /// [`FourError::Time`].
    pub fn slice(&self, time: f64) -> Result<TriangleMesh, FourError> {
        let last = self.first + self.layers.len();
        if !(self.first as f64..=last as f64).contains(&time) {
            return Err(FourError::Time { time, last });
        }
        let frame = time as usize - self.first;
        if time.fract() != 0.0 {
            let tetrahedra = &self.tetrahedra[self.layers[frame].clone()];
            return Ok(slicing::between_frames(&self.positions, tetrahedra, time));
        }
        let layer = frame.min(self.layers.len() - 1);
        let tetrahedra = &self.tetrahedra[self.layers[layer].clone()];
        Ok(slicing::in_frame(&self.positions, tetrahedra, self.frames[frame].clone(), layer < frame))
    }

    /// Writes the tetrahedra at their places in space as a legacy file of VTK in ASCII, with the array `time` at the vertices: a contour of
    /// it is a slice. In space tetrahedra lie on each other.
    ///
    /// # Errors
    /// Those of `output`.
    pub fn write_vtk(&self, output: impl Write) -> io::Result<()> {
        let places = self.positions.iter().map(|p| (p.truncate().to_array(), p.w));
        write_tetrahedra(output, "surface in space-time", places, &self.tetrahedra, "time")
    }

    /// The three-dimensional content, where a frame lasts `frame_length` in the unit of space.
    pub fn content(&self, frame_length: f64) -> f64 {
        let scale = DVec4::new(1.0, 1.0, 1.0, frame_length);
        let content = |tetrahedron: &[u32; 4]| {
            let [a, b, c, d] = tetrahedron.map(|v| self.positions[v as usize] * scale);
            let [u, v, w] = [b - a, c - a, d - a];
            // Gram's determinant: the square of six times the content.
            let gram = glam::DMat3::from_cols(
                DVec3::new(u.dot(u), u.dot(v), u.dot(w)),
                DVec3::new(v.dot(u), v.dot(v), v.dot(w)),
                DVec3::new(w.dot(u), w.dot(v), w.dot(w)),
            );
            gram.determinant().max(0.0).sqrt() / 6.0
        };
        self.tetrahedra.iter().map(content).sum()
    }
}

pub(crate) fn place(counts: [usize; 3], sample: usize) -> [f64; 3] {
    [sample % counts[0], sample / counts[0] % counts[1], sample / counts[0] / counts[1]].map(|i| i as f64)
}
