//! ferreus_rmt: regularised marching tetrahedra from a function, which is the trilinear interpolant.

use crate::trilinear::Trilinear;
use crate::{Extract, Extraction};
use faer::{Mat, MatRef};
use ferreus_rmt::{BoundaryClosure, ClusterMethod, build_isosurface};
use isostudy_mesh::TriangleMesh;
use std::time::{Duration, Instant};

pub(crate) fn extractor() -> Extract {
    Box::new(|request, samples| {
        let begin = Instant::now();
        let field = Trilinear::new(request, samples);
        // It follows the surface from these points, and finds no piece that has none.
        let seeds = field.crossings();
        let seeds = Mat::from_fn(seeds.len(), 3, |i, a| seeds[i][a]);
        let [x, y, z] = request.size.map(|n| f64::from(n - 1));
        let (extents, converted, mut called) = ([0.0, 0.0, 0.0, x, y, z], begin.elapsed(), Duration::ZERO);
        let mut f = |at: MatRef<f64>| {
            let begin = Instant::now();
            let found = Mat::from_fn(at.nrows(), 1, |i, _| field.value([0, 1, 2].map(|a| at[(i, a)])));
            called += begin.elapsed();
            found
        };
        let (cluster, open) = (ClusterMethod::CurvatureWeighted, BoundaryClosure::None);
        let begin = Instant::now();
        let found = build_isosurface(seeds.as_ref(), &extents, 1.0, 0.0, &mut f, None, cluster, open, None);
        let extraction_s = (begin.elapsed() - called).as_secs_f64();
        let begin = Instant::now();
        let positions = found.vertices.row_iter().map(|p| request.place([0, 1, 2].map(|a| p[a] as f32)));
        let mesh = TriangleMesh {
            positions: positions.collect(),
            normals: Vec::new(),
            triangles: found.facets.row_iter().map(|t| [0, 1, 2].map(|a| t[a] as u32)).collect(),
        };
        let callback_s = (converted + called + begin.elapsed()).as_secs_f64();
        Ok(Extraction { extraction_s, callback_s, mesh })
    })
}
