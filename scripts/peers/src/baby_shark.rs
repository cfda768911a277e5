//! baby_shark: marching cubes 33 and dual contouring on its sparse grid, three vertices for each triangle.

use crate::{Extract, Extraction};
use baby_shark::exports::nalgebra::Vector3;
use baby_shark::voxel::prelude::{DualContouringMesher, MarchingCubesMesher, Volume};
use isostudy_mesh::TriangleMesh;
use std::time::Instant;

pub(crate) fn marching_cubes() -> Extract {
    extractor(|volume| Some(MarchingCubesMesher::default().with_voxel_size(1.0).mesh(volume)))
}

pub(crate) fn dual_contouring() -> Extract {
    extractor(|volume| DualContouringMesher::default().with_voxel_size(1.0).mesh(volume))
}

fn extractor(mesh: fn(&Volume) -> Option<Vec<Vector3<f32>>>) -> Extract {
    Box::new(move |request, samples| {
        let begin = Instant::now();
        let [x, y, z] = request.size.map(|n| n as usize);
        let last = Vector3::new(x - 1, y - 1, z - 1).cast::<f32>();
        // Inside is negative there. The band that it keeps is as wide as it can be: all samples.
        let volume = Volume::from_fn(1.0, Vector3::zeros(), last, usize::MAX - 1, |p| {
            let [i, j, k] = [p.x as usize, p.y as usize, p.z as usize];
            (request.isovalue - f64::from(samples[(k * y + j) * x + i])) as f32
        });
        let converted = begin.elapsed();
        let begin = Instant::now();
        let found = mesh(&volume).ok_or("no mesh")?;
        let extraction_s = begin.elapsed().as_secs_f64();
        let begin = Instant::now();
        let mesh = TriangleMesh {
            positions: found.iter().map(|p| request.place([p.x, p.y, p.z])).collect(),
            normals: Vec::new(),
            triangles: (0..found.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        };
        Ok(Extraction { extraction_s, callback_s: (converted + begin.elapsed()).as_secs_f64(), mesh })
    })
}
