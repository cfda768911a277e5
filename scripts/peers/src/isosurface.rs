//! isosurface: marching cubes from a function.

use crate::{Extract, Extraction};
use isosurface::marching_cubes::MarchingCubes;
use isosurface::source::Source;
use isostudy_mesh::TriangleMesh;
use std::time::Instant;

/// Looks samples up in a cube of edge 1. Inside is negative there.
struct Lookup<'a> {
    samples: &'a [f32],
    isovalue: f32,
    cells: usize,
}

impl Source for Lookup<'_> {
    fn sample(&self, x: f32, y: f32, z: f32) -> f32 {
        let at = |v: f32| ((v * self.cells as f32).round() as usize).min(self.cells);
        self.isovalue - self.samples[(at(z) * (self.cells + 1) + at(y)) * (self.cells + 1) + at(x)]
    }
}

pub(crate) fn extractor() -> Extract {
    Box::new(|request, samples| {
        let cells = request.cells_of_a_cube()? as usize;
        let source = Lookup { samples, isovalue: request.isovalue as f32, cells };
        let begin = Instant::now();
        let (mut vertices, mut indices) = (Vec::new(), Vec::new());
        MarchingCubes::new(cells + 1).extract(&source, &mut vertices, &mut indices);
        let extraction_s = begin.elapsed().as_secs_f64();
        let begin = Instant::now();
        let positions =
            vertices.as_chunks::<3>().0.iter().map(|p| request.place(p.map(|x| x * cells as f32)));
        let mesh = TriangleMesh {
            positions: positions.collect(),
            normals: Vec::new(),
            // They face inward there.
            triangles: indices.as_chunks::<3>().0.iter().map(|&[a, b, c]| [a, c, b]).collect(),
        };
        Ok(Extraction { extraction_s, callback_s: begin.elapsed().as_secs_f64(), mesh })
    })
}
