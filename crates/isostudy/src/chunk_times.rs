//! What a mesh costs chunk by chunk, as a game extracts it, and whether its chunks fit.

use crate::prepare::Prepared;
use anyhow::{Context, Result};
use glam::Vec3;
use isostudy_design::record::ChunkTimes;
use isostudy_extract::{
    Aabb, CellBox, Chunk, ChunkError, ChunkExtractor, ChunkSettings, Control, Execution, Source, presets,
    weld_chunks,
};
use isostudy_field::FieldCache;
use std::time::Instant;

/// How far an edit reaches from a point of the surface, in cube edges: a ball of three, and two more in which its distance counts.
const REACH: f32 = 5.0;
/// Edits, at places spread over the surface, and how often each is timed.
const EDITS: usize = 10;
const EDIT_ROUNDS: usize = 3;

/// Times every chunk of so many cells a side that has triangles, round by round, then edits: the chunks round a point of the surface,
/// extracted again. The points are vertices of marching cubes whatever the method, so that all are asked the same. All on the calling
/// thread. `None` for what makes no chunks.
///
/// # Errors
/// If the chunks cannot be extracted, or do not fit together.
pub(crate) fn chunk_times(prepared: &Prepared<'_>, cells: u32, rounds: u32) -> Result<Option<ChunkTimes>> {
    let Some(of) = prepared.extractor() else { return Ok(None) };
    let settings = ChunkSettings::default().with_isovalue(of.isovalue);
    let mut extractor = match ChunkExtractor::in_box(&of.grid, &of.method, &settings) {
        Ok(extractor) => extractor,
        Err(ChunkError::Method | ChunkError::Accumulated | ChunkError::Placement { .. }) => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let mut kept = FieldCache::default();
    let field = of.field.prepared(&mut kept).unwrap_or(of.field);
    let boxes: Vec<CellBox> = extractor.grid(cells).collect();
    let mut again = |chunk: &mut Chunk, cells: CellBox| -> Result<f64> {
        let start = Instant::now();
        extractor.extract_into(Source::Study(field), cells, Control::default(), chunk)?;
        Ok(start.elapsed().as_secs_f64())
    };
    let mut chunks: Vec<Chunk> = boxes.iter().map(|_| Chunk::default()).collect();
    // The first time makes the buffers.
    for (chunk, &cells) in chunks.iter_mut().zip(&boxes) {
        again(chunk, cells)?;
    }
    let is_whole = |of: &CellBox| (0..3).all(|axis| of.end[axis] - of.start[axis] == cells as i32);
    let timed: Vec<usize> =
        (0..boxes.len()).filter(|&i| is_whole(&boxes[i]) && !chunks[i].triangles.is_empty()).collect();
    let mut chunk_s = Vec::new();
    for _ in 0..rounds {
        for &i in &timed {
            chunk_s.push(again(&mut chunks[i], boxes[i])?);
        }
    }
    let whole = of.extract(&Execution { threads: 1 })?.mesh;
    let (mut edit_chunks, mut edit_s) = (Vec::new(), Vec::new());
    for at in places(&of)? {
        let changed = Aabb::around(at.to_array(), REACH * of.grid.spacing);
        let touched: Vec<usize> = (0..boxes.len()).filter(|&i| chunks[i].is_touched_by(changed)).collect();
        let mut rounds = [0.0; EDIT_ROUNDS];
        for seconds in &mut rounds {
            for &i in &touched {
                *seconds += again(&mut chunks[i], boxes[i])?;
            }
        }
        rounds.sort_unstable_by(f64::total_cmp);
        edit_chunks.push(touched.len() as u64);
        edit_s.push(rounds[EDIT_ROUNDS / 2]);
    }
    let welded = weld_chunks(&chunks).with_context(|| format!("{}: its chunks", prepared.id))?;
    let [open, of_whole] =
        [&welded, &whole].map(|mesh| isostudy_mesh::topology::topology(mesh).boundary_edges as i64);
    Ok(Some(ChunkTimes {
        id: prepared.id.clone(),
        cells,
        chunks: boxes.len() as u64,
        timed: timed.len() as u64,
        chunk_s,
        edit_chunks,
        edit_s,
        open_seam_edges: open - of_whole,
        is_whole: welded.positions == whole.positions && welded.triangles == whole.triangles,
    }))
}

/// Where edits are: the same for every method with these cubes.
fn places(of: &isostudy_bench::Prepared<'_>) -> Result<Vec<Vec3>> {
    let preset = presets().iter().find(|preset| preset.id == "mc").context("marching cubes are a preset")?;
    let cubes = isostudy_bench::Prepared {
        field: of.field,
        method: preset.method,
        grid: of.grid,
        isovalue: of.isovalue,
    };
    let surface = cubes.extract(&Execution { threads: 1 })?.mesh.positions;
    let places = surface.len().min(EDITS);
    Ok((0..places).map(|edit| surface[edit * surface.len() / places]).collect())
}
