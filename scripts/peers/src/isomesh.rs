//! isomesh: five of its extractors, each on the trilinear interpolant of the samples that the crate itself has.

use crate::{Extract, Extraction};
use isomesh::construct::SampledField;
use isomesh::extractor::Extractor;
use isomesh::{MeshBuffer, RuntimeShape3};
use isostudy_mesh::TriangleMesh;
use std::time::Instant;

pub(crate) fn extractor<E: Extractor<f32> + Default + 'static>() -> Extract {
    // Kept from one request to the next, as its documentation advises.
    let (mut extractor, mut negated, mut found) = (E::default(), Vec::new(), MeshBuffer::new());
    Box::new(move |request, samples| {
        let begin = Instant::now();
        // Inside is negative there.
        request.negate(samples, &mut negated);
        found.reset();
        let converted = begin.elapsed();
        let shape = RuntimeShape3::new(request.size).map_err(|error| error.to_string())?;
        let field = SampledField::new(&negated, &shape, [0.0; 3], 1.0).map_err(|error| error.to_string())?;
        let begin = Instant::now();
        let done = extractor.extract_into(&field, &shape, [0.0; 3], 1.0, &mut found);
        let extraction_s = begin.elapsed().as_secs_f64();
        done.map_err(|error| error.to_string())?;
        // Its dual contouring does so where the gradient is zero at a crossing.
        if found.indices.iter().any(|&v| v as usize >= found.positions.len()) {
            return Err("a triangle names a vertex that is not there".into());
        }
        let begin = Instant::now();
        let mesh = TriangleMesh {
            positions: found.positions.iter().map(|&p| request.place(p)).collect(),
            normals: Vec::new(),
            triangles: found.indices.as_chunks::<3>().0.to_vec(),
        };
        Ok(Extraction { extraction_s, callback_s: (converted + begin.elapsed()).as_secs_f64(), mesh })
    })
}
