//! fast-surface-nets: naive surface nets.

use crate::{Extract, Extraction};
use fast_surface_nets::ndshape::RuntimeShape;
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use isostudy_mesh::TriangleMesh;
use std::time::Instant;

pub(crate) fn extractor() -> Extract {
    // Kept from one request to the next, as its documentation advises.
    let (mut buffer, mut negated) = (SurfaceNetsBuffer::default(), Vec::new());
    Box::new(move |request, samples| {
        let begin = Instant::now();
        // Inside is negative there.
        request.negate(samples, &mut negated);
        let converted = begin.elapsed();
        let shape = RuntimeShape::<u32, 3>::new(request.size);
        let begin = Instant::now();
        surface_nets(&negated, &shape, [0; 3], request.size.map(|n| n - 1), &mut buffer);
        let extraction_s = begin.elapsed().as_secs_f64();
        let begin = Instant::now();
        let mesh = TriangleMesh {
            positions: buffer.positions.iter().map(|&p| request.place(p)).collect(),
            normals: Vec::new(),
            triangles: buffer.indices.as_chunks::<3>().0.to_vec(),
        };
        Ok(Extraction { extraction_s, callback_s: (converted + begin.elapsed()).as_secs_f64(), mesh })
    })
}
