//! splashsurf_lib: its marching cubes on a grid of densities, without what it makes densities from.

use crate::{Extract, Extraction};
use isostudy_mesh::TriangleMesh;
use splashsurf_lib::marching_cubes::triangulate_density_map;
use splashsurf_lib::nalgebra::Vector3;
use splashsurf_lib::{DensityMap, UniformGrid};
use std::error::Error;
use std::iter::successors;
use std::time::Instant;

pub(crate) fn extractor() -> Extract {
    Box::new(|request, samples| {
        let [x, y, z] = request.size.map(|n| i64::from(n) - 1);
        let isovalue = request.isovalue as f32;
        // Its cells are cubes. Its x is slowest, so x and z change places: a mirror, which turns triangles over.
        let grid =
            UniformGrid::new(&Vector3::zeros(), &[z, y, x], 1.0).map_err(|error| format!("{error:?}"))?;
        let densities = DensityMap::from(samples);
        let begin = Instant::now();
        let found = triangulate_density_map::<i64, f32>(&grid, &densities, isovalue);
        let extraction_s = begin.elapsed().as_secs_f64();
        let found = found.map_err(|error| {
            let causes = successors(Some(&error as &dyn Error), |&error| error.source());
            causes.map(ToString::to_string).collect::<Vec<_>>().join(": ")
        })?;
        let begin = Instant::now();
        let mesh = TriangleMesh {
            positions: found.vertices.iter().map(|p| request.place([p.z, p.y, p.x])).collect(),
            normals: Vec::new(),
            triangles: found.triangles.iter().map(|&[a, b, c]| [a as u32, c as u32, b as u32]).collect(),
        };
        Ok(Extraction { extraction_s, callback_s: begin.elapsed().as_secs_f64(), mesh })
    })
}
