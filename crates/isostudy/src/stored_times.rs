//! What a mesh costs where its object's samples are stored, as a game keeps voxels: from the samples to the mesh.

use crate::chunk_times::{Chunks, goes_in_chunks, places};
use crate::finishing;
use crate::prepare::Prepared;
use crate::recipe::Recipe;
use anyhow::{Context, Result};
use isostudy_design::record::StoredTimes;
use isostudy_extract::{Arrangement, Execution, Extraction, Extractor, Source};
use isostudy_field::{Beyond, VolumeField};
use isostudy_finish::Extent;
use isostudy_mesh::TriangleMesh;
use isostudy_program::{Program, Samples, Worker, write_samples};
use std::hint::black_box;
use std::time::Instant;

/// Times a configuration from the samples at the corners of its object's cubes: the whole mesh, then chunks of so many cells a side,
/// 0 for none, and edits as [`chunk_times`](crate::chunk_times::chunk_times) has them. Each number is of one extraction on one thread, after one that is not counted.
/// Every method is given the same samples. One that asks for values or gradients between them has them by trilinear interpolation, which
/// is in its time. `None` for meshes out of files, for
/// the cells of a grid, whose values are stored anyway, and for fronts, which ask for the field between samples.
///
/// # Errors
/// If anything cannot be extracted.
pub(crate) fn stored_times(prepared: &Prepared<'_>, cells: u32, rounds: u32) -> Result<Option<StoredTimes>> {
    match &prepared.recipe {
        Recipe::Extractor(_) => of_extractor(prepared, cells, rounds),
        Recipe::Program(program) => of_program(prepared, program, rounds).map(Some),
        Recipe::Meshes(_) | Recipe::GridCells | Recipe::Front(_) => Ok(None),
    }
}

fn of_extractor(prepared: &Prepared<'_>, cells: u32, rounds: u32) -> Result<Option<StoredTimes>> {
    let Some(of) = prepared.extractor() else { return Ok(None) };
    let counts = of.grid.lattice(Arrangement::SimpleCubic)?.cells();
    let samples = prepared.samples(counts);
    let is_between = !of.method.is_of_corners();
    let (spacing, along) = (f64::from(of.grid.spacing), counts.map(|cells| cells as usize + 1));
    let steps = [0, 1, 2].map(|axis| [0, 1, 2].map(|of| if of == axis { spacing } else { 0.0 }));
    let origin = of.grid.bounds.min.to_array().map(f64::from);
    let volume = VolumeField::try_new(along, samples.clone(), origin, steps, Beyond::Continued)?;
    let source = if is_between { Source::Study(&volume) } else { Source::Samples(&samples) };
    let whole = || -> Result<f64> {
        let execution = Execution { threads: 1 };
        let made = of.method.extract(&mut Extractor::new(), source, &of.grid, of.isovalue, &execution)?;
        let Extraction { times, mesh, .. } = black_box(made);
        Ok((times.total() - times.normals).as_secs_f64() + finishing_s(prepared, mesh)?)
    };
    whole()?;
    let whole_s = (0..rounds).map(|_| whole()).collect::<Result<_>>()?;
    let mut times = StoredTimes {
        id: prepared.id.clone(),
        is_between,
        whole_s,
        timed: 0,
        chunk_s: vec![],
        edit_s: vec![],
    };
    let chunks = if cells > 0 && goes_in_chunks(prepared) {
        Chunks::begin(&of, &prepared.finish, source, cells)?
    } else {
        None
    };
    if let Some(mut work) = chunks {
        times.timed = work.timed.len() as u64;
        times.chunk_s = work.each(rounds)?;
        (_, times.edit_s) = work.edits(&places(&of)?)?;
    }
    Ok(Some(times))
}

/// Seconds that the finishing steps take; 0 where there are none.
fn finishing_s(prepared: &Prepared<'_>, mut mesh: TriangleMesh) -> Result<f64> {
    if prepared.finish.is_empty() {
        return Ok(0.0);
    }
    mesh.normals = Vec::new();
    let began = Instant::now();
    black_box(finishing::finish(mesh, &prepared.finish, Extent::Whole)?);
    Ok(began.elapsed().as_secs_f64())
}

/// A program is given all samples in a file; its own word says how long it took from there.
fn of_program(prepared: &Prepared<'_>, program: &Program, rounds: u32) -> Result<StoredTimes> {
    let cells = prepared.cells()?;
    let mut worker = Worker::start(program).with_context(|| prepared.id.to_string())?;
    let [samples, mesh] = ["samples.f32", "mesh.ply"].map(|name| worker.folder().join(name));
    write_samples(&samples, &prepared.samples(cells))?;
    let mut whole = || -> Result<f64> {
        // The mesh is asked for only where there is something to be done with it.
        let path = Some(&*mesh).filter(|_| !prepared.finish.is_empty());
        let request = prepared.request(Samples::File(&samples), cells, path.map(AsRef::as_ref));
        let answer = worker.extract(&request).with_context(|| prepared.id.to_string())?;
        let finishing = answer.mesh.map_or(Ok(0.0), |mesh| finishing_s(prepared, mesh))?;
        Ok(answer.extraction_s.unwrap_or(answer.wall.as_secs_f64()) + finishing)
    };
    whole()?;
    let whole_s = (0..rounds).map(|_| whole()).collect::<Result<_>>()?;
    let id = prepared.id.clone();
    Ok(StoredTimes { id, is_between: false, whole_s, timed: 0, chunk_s: vec![], edit_s: vec![] })
}
