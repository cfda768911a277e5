//! What a mesh costs chunk by chunk, as a game extracts it, and whether its chunks fit.

use crate::finishing;
use crate::prepare::Prepared;
use crate::terminal::tell_once;
use anyhow::{Context, Result};
use glam::Vec3;
use isostudy_design::record::ChunkTimes;
use isostudy_extract::{
    Aabb, CellBox, Chunk, ChunkError, ChunkExtractor, ChunkSettings, Control, Execution, Source, presets,
    weld_chunks,
};
use isostudy_field::FieldCache;
use isostudy_finish::{Extent, Step};
use isostudy_mesh::TriangleMesh;
use std::time::Instant;

/// How far an edit reaches from a point of the surface, in cube edges: a ball of three, and two more in which its distance counts.
const REACH: f32 = 5.0;
/// Edits, at places spread over the surface, and how often each is timed.
const EDITS: usize = 10;
const EDIT_ROUNDS: usize = 3;

/// Times every chunk of so many cells a side that has triangles, round by round, then edits: the chunks round a point of the surface,
/// extracted again. The points are vertices of marching cubes whatever the method, so that all are asked the same. All on the calling
/// thread. `None` for what makes no chunks, and where a finishing step needs the whole mesh, which is said. What finishes a chunk leaves
/// its borders as they are, and is in its times.
///
/// # Errors
/// If the chunks cannot be extracted, or do not fit together.
pub(crate) fn chunk_times(prepared: &Prepared<'_>, cells: u32, rounds: u32) -> Result<Option<ChunkTimes>> {
    let Some(of) = prepared.extractor() else { return Ok(None) };
    if !goes_in_chunks(prepared) {
        return Ok(None);
    }
    let mut kept = FieldCache::default();
    let field = of.field.prepared(&mut kept).unwrap_or(of.field);
    let Some(mut work) = Chunks::begin(&of, &prepared.finish, Source::Study(field), cells)? else {
        return Ok(None);
    };
    let chunk_s = work.each(rounds)?;
    let whole = of.extract(&Execution { threads: 1 })?.mesh;
    let (edit_chunks, edit_s) = work.edits(&places(&of)?)?;
    let welded = work.welded().with_context(|| format!("{}: its chunks", prepared.id))?;
    let [open, of_whole] =
        [&welded, &whole].map(|mesh| isostudy_mesh::topology::topology(mesh).boundary_edges as i64);
    Ok(Some(ChunkTimes {
        id: prepared.id.clone(),
        cells,
        chunks: work.boxes.len() as u64,
        timed: work.timed.len() as u64,
        chunk_s,
        edit_chunks,
        edit_s,
        open_seam_edges: open - of_whole,
        is_whole: welded.positions == whole.positions && welded.triangles == whole.triangles,
    }))
}

/// Whether a configuration's finishing steps can be applied to chunks; it is said why not.
pub(crate) fn goes_in_chunks(prepared: &Prepared<'_>) -> bool {
    let why = finishing::why_not_in_chunks(&prepared.finish);
    if let Some(why) = &why {
        tell_once(&format!("{}: no times of chunks: {why}", prepared.id));
    }
    why.is_none()
}

/// The chunks of a configuration, extracted once, to be timed.
pub(crate) struct Chunks<'a> {
    finish: &'a [Step],
    /// The chunks after their finishing steps; none where there are no steps.
    finished: Vec<TriangleMesh>,
    extractor: ChunkExtractor,
    source: Source<'a>,
    spacing: f32,
    boxes: Vec<CellBox>,
    chunks: Vec<Chunk>,
    /// Those of all cells that have triangles.
    pub(crate) timed: Vec<usize>,
}

impl<'a> Chunks<'a> {
    /// Extracts every chunk of so many cells a side, which makes the buffers. `None` for a method that makes no chunks.
    ///
    /// # Errors
    /// If a chunk cannot be extracted.
    pub(crate) fn begin(
        of: &isostudy_bench::Prepared<'_>,
        finish: &'a [Step],
        source: Source<'a>,
        cells: u32,
    ) -> Result<Option<Self>> {
        let settings = ChunkSettings::default().with_isovalue(of.isovalue);
        let extractor = match ChunkExtractor::in_box(&of.grid, &of.method, &settings) {
            Ok(extractor) => extractor,
            Err(ChunkError::Method | ChunkError::Accumulated | ChunkError::Placement { .. }) => {
                return Ok(None);
            }
            Err(error) => return Err(error.into()),
        };
        let boxes: Vec<CellBox> = extractor.grid(cells).collect();
        let chunks = boxes.iter().map(|_| Chunk::default()).collect();
        let spacing = of.grid.spacing;
        let finished =
            if finish.is_empty() { Vec::new() } else { vec![TriangleMesh::default(); boxes.len()] };
        let mut work =
            Self { finish, finished, extractor, source, spacing, boxes, chunks, timed: Vec::new() };
        for i in 0..work.boxes.len() {
            work.again(i)?;
        }
        let is_whole = |of: &CellBox| (0..3).all(|axis| of.end[axis] - of.start[axis] == cells as i32);
        let timed = |&i: &usize| is_whole(&work.boxes[i]) && !work.chunks[i].triangles.is_empty();
        work.timed = (0..work.boxes.len()).filter(timed).collect();
        Ok(Some(work))
    }

    /// Seconds to extract a chunk again.
    fn again(&mut self, i: usize) -> Result<f64> {
        let start = Instant::now();
        self.extractor.extract_into(self.source, self.boxes[i], Control::default(), &mut self.chunks[i])?;
        if !self.finish.is_empty() {
            let Chunk { positions, triangles, .. } = &self.chunks[i];
            let positions = positions.iter().copied().map(Vec3::from).collect();
            let mesh = TriangleMesh { positions, normals: Vec::new(), triangles: triangles.clone() };
            self.finished[i] = finishing::finish(mesh, self.finish, Extent::Chunk)?.mesh;
        }
        Ok(start.elapsed().as_secs_f64())
    }

    /// All chunks as one mesh: by the keys of vertices, or after finishing steps by their places, which do not move at borders.
    fn welded(&self) -> Result<TriangleMesh> {
        if self.finish.is_empty() {
            return Ok(weld_chunks(&self.chunks)?);
        }
        let mut all = TriangleMesh::default();
        for mesh in &self.finished {
            let first = all.positions.len() as u32;
            all.positions.extend(&mesh.positions);
            all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| first + v)));
        }
        Ok(isostudy_mesh::weld(&all))
    }

    /// Seconds for each chunk that is timed, round by round.
    ///
    /// # Errors
    /// If a chunk cannot be extracted.
    pub(crate) fn each(&mut self, rounds: u32) -> Result<Vec<f64>> {
        let all = (0..rounds).flat_map(|_| self.timed.clone()).collect::<Vec<_>>();
        all.into_iter().map(|i| self.again(i)).collect()
    }

    /// For an edit at each of the places, how many chunks it touches, and the seconds to extract these again.
    ///
    /// # Errors
    /// If a chunk cannot be extracted.
    pub(crate) fn edits(&mut self, places: &[Vec3]) -> Result<(Vec<u64>, Vec<f64>)> {
        let (mut edit_chunks, mut edit_s) = (Vec::new(), Vec::new());
        for at in places {
            let changed = Aabb::around(at.to_array(), REACH * self.spacing);
            let touched: Vec<usize> =
                (0..self.boxes.len()).filter(|&i| self.chunks[i].is_touched_by(changed)).collect();
            let mut rounds = [0.0; EDIT_ROUNDS];
            for seconds in &mut rounds {
                for &i in &touched {
                    *seconds += self.again(i)?;
                }
            }
            rounds.sort_unstable_by(f64::total_cmp);
            edit_chunks.push(touched.len() as u64);
            edit_s.push(rounds[EDIT_ROUNDS / 2]);
        }
        Ok((edit_chunks, edit_s))
    }
}

/// Where edits are: the same for every method with these cubes.
pub(crate) fn places(of: &isostudy_bench::Prepared<'_>) -> Result<Vec<Vec3>> {
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
