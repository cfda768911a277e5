//! polyscope-core: marching cubes, ported from the library MarchingCubeCpp.

use crate::{Extract, Extraction};
use isostudy_mesh::TriangleMesh;
use polyscope_core::marching_cubes::marching_cubes;
use std::time::Instant;

pub(crate) fn extractor() -> Extract {
    Box::new(|request, samples| {
        let [x, y, z] = request.size;
        let isovalue = request.isovalue as f32;
        let begin = Instant::now();
        // Its x is slowest, so x and z change places: a mirror, which turns its inward triangles outward.
        let found = marching_cubes(samples, isovalue, z, y, x);
        let extraction_s = begin.elapsed().as_secs_f64();
        let begin = Instant::now();
        let mesh = TriangleMesh {
            positions: found.vertices.iter().map(|p| request.place([p.z, p.y, p.x])).collect(),
            normals: Vec::new(),
            triangles: found.indices.as_chunks::<3>().0.to_vec(),
        };
        Ok(Extraction { extraction_s, callback_s: begin.elapsed().as_secs_f64(), mesh })
    })
}
