//! mcubes: marching cubes, three vertices for each triangle.

use crate::{Extract, Extraction};
use isostudy_mesh::TriangleMesh;
use lin_alg::f32::Vec3;
use mcubes::{MarchingCubes, MeshSide};
use std::time::Instant;

pub(crate) fn extractor() -> Extract {
    Box::new(|request, samples| {
        let begin = Instant::now();
        let [x, y, z] = request.size.map(|n| n as usize);
        let (unit, values, isovalue) = ((1.0, 1.0, 1.0), samples.to_vec(), request.isovalue as f32);
        let cubes = MarchingCubes::new((x, y, z), unit, unit, Vec3::new_zero(), values, isovalue)
            .map_err(|error| error.to_string())?;
        let converted = begin.elapsed();
        let begin = Instant::now();
        let found = cubes.generate(MeshSide::OutsideOnly);
        let extraction_s = begin.elapsed().as_secs_f64();
        let begin = Instant::now();
        let mesh = TriangleMesh {
            positions: found
                .vertices
                .iter()
                .map(|v| request.place([v.posit.x, v.posit.y, v.posit.z]))
                .collect(),
            normals: Vec::new(),
            // They face inward there.
            triangles: (0..found.indices.len() as u32 / 3).map(|t| [3 * t, 3 * t + 2, 3 * t + 1]).collect(),
        };
        Ok(Extraction { extraction_s, callback_s: (converted + begin.elapsed()).as_secs_f64(), mesh })
    })
}
