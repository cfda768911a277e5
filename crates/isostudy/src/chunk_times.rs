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
/// extracted again. The points are vertices of marching cubes whatever the method, so that all configurations, which are of one object
/// with the same cubes, are asked the same. They work in turn, all on the calling thread. Not in the result are those that make no
/// chunks, and those with a finishing step that needs the whole mesh, which is said. What finishes a chunk leaves its borders as they
/// are, and is in its times. `progress` is told how much of how much is done.
///
/// # Errors
/// If the chunks cannot be extracted, or do not fit together.
pub(crate) fn chunk_times(
    all: &[Prepared<'_>],
    cells: u32,
    rounds: u32,
    progress: &dyn Fn(usize, usize),
) -> Result<Vec<ChunkTimes>> {
    let mut kept: Vec<FieldCache> = all.iter().map(|_| FieldCache::default()).collect();
    let mut works = Vec::new();
    for (prepared, kept) in all.iter().zip(&mut kept) {
        let Some(of) = prepared.extractor().filter(|_| goes_in_chunks(prepared)) else { continue };
        let field = of.field.prepared(kept).unwrap_or(of.field);
        let source = Source::Study(field);
        let begun =
            Chunks::begin(&of, &prepared.finish, source, cells).with_context(|| prepared.id.to_string())?;
        works.extend(begun.map(|work| (prepared, of, work)));
    }
    let Some((_, of, _)) = works.first() else { return Ok(Vec::new()) };
    let places = places(of)?;
    let mut chunks: Vec<&mut Chunks<'_>> = works.iter_mut().map(|(_, _, work)| work).collect();
    time_in_turn(&mut chunks, rounds, &places, progress)?;
    works.iter().map(|(prepared, of, work)| record(prepared, of, work, cells)).collect()
}

fn record(
    prepared: &Prepared<'_>,
    of: &isostudy_bench::Prepared<'_>,
    work: &Chunks<'_>,
    cells: u32,
) -> Result<ChunkTimes> {
    let whole = of.extract(&Execution { threads: 1 })?.mesh;
    let welded = work.welded().with_context(|| format!("{}: its chunks", prepared.id))?;
    let [open, of_whole] =
        [&welded, &whole].map(|mesh| isostudy_mesh::topology::topology(mesh).boundary_edges as i64);
    Ok(ChunkTimes {
        id: prepared.id.clone(),
        cells,
        chunks: work.boxes.len() as u64,
        timed: work.timed.len() as u64,
        chunk_s: work.chunk_s.clone(),
        edit_chunks: work.edits.iter().map(|edit| edit.touched.len() as u64).collect(),
        edit_s: work.edit_s(),
        open_seam_edges: open - of_whole,
        is_whole: welded.positions == whole.positions && welded.triangles == whole.triangles,
    })
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
    /// Seconds for each of these, round by round.
    pub(crate) chunk_s: Vec<f64>,
    edits: Vec<Edit>,
}

/// The chunks that an edit touches, and the seconds to extract them again, round by round.
struct Edit {
    touched: Vec<usize>,
    rounds_s: Vec<f64>,
}

/// Lets works of one object take turns, round by round, and another begin each round: what slows the machine for a while, and what
/// the one before leaves in its caches, is shared by all alike.
///
/// # Errors
/// The first of a turn.
pub(crate) fn in_turn<W>(
    works: &mut [W],
    rounds: usize,
    mut turn: impl FnMut(&mut W) -> Result<()>,
) -> Result<()> {
    let count = works.len();
    for round in 0..rounds {
        for place in 0..count {
            turn(&mut works[(place + round) % count])?;
        }
    }
    Ok(())
}

/// Times the chunks and then the edits of several methods in turn.
///
/// # Errors
/// If a chunk cannot be extracted.
pub(crate) fn time_in_turn(
    works: &mut [&mut Chunks<'_>],
    rounds: u32,
    places: &[Vec3],
    progress: &dyn Fn(usize, usize),
) -> Result<()> {
    let turns = works.len() * (rounds as usize + places.len() * EDIT_ROUNDS);
    let mut done = 0;
    let mut tell = || {
        done += 1;
        progress(done, turns);
    };
    in_turn(works, rounds as usize, |work| {
        tell();
        work.time_each()
    })?;
    for &at in places {
        works.iter_mut().for_each(|work| work.begin_edit(at));
        in_turn(works, EDIT_ROUNDS, |work| {
            tell();
            work.time_edit()
        })?;
    }
    Ok(())
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
        let mut work = Self {
            finish,
            finished,
            extractor,
            source,
            spacing,
            boxes,
            chunks,
            timed: Vec::new(),
            chunk_s: Vec::new(),
            edits: Vec::new(),
        };
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

    /// Times each chunk once more.
    fn time_each(&mut self) -> Result<()> {
        for place in 0..self.timed.len() {
            let seconds = self.again(self.timed[place])?;
            self.chunk_s.push(seconds);
        }
        Ok(())
    }

    /// Begins an edit at a place.
    fn begin_edit(&mut self, at: Vec3) {
        let changed = Aabb::around(at.to_array(), REACH * self.spacing);
        let touched = (0..self.boxes.len()).filter(|&i| self.chunks[i].is_touched_by(changed)).collect();
        self.edits.push(Edit { touched, rounds_s: Vec::new() });
    }

    /// Times the edit that was begun last once more.
    fn time_edit(&mut self) -> Result<()> {
        let Some(mut edit) = self.edits.pop() else { return Ok(()) };
        let seconds = edit.touched.iter().map(|&i| self.again(i)).sum::<Result<f64>>()?;
        edit.rounds_s.push(seconds);
        self.edits.push(edit);
        Ok(())
    }

    /// Of each edit the median of its rounds.
    pub(crate) fn edit_s(&self) -> Vec<f64> {
        let median = |edit: &Edit| {
            let mut rounds_s = edit.rounds_s.clone();
            rounds_s.sort_unstable_by(f64::total_cmp);
            rounds_s[rounds_s.len() / 2]
        };
        self.edits.iter().map(median).collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::bail;
    use std::cell::RefCell;

    /// Each has one turn per round, and each begins as often as the others.
    #[test]
    fn works_take_turns_and_another_begins_each_round() {
        let order = RefCell::new(String::new());
        let mut works = ['a', 'b', 'c'];
        in_turn(&mut works, 4, |work| {
            order.borrow_mut().push(*work);
            Ok(())
        })
        .unwrap();
        assert_eq!(order.into_inner(), "abcbcacababc");
        in_turn(&mut [0; 0], 4, |_| bail!("nobody works")).unwrap();
        let mut turns = 0;
        let ended = in_turn(&mut works, 4, |_| {
            turns += 1;
            if turns == 5 { bail!("tired") } else { Ok(()) }
        });
        assert!(ended.is_err() && turns == 5, "the first that fails ends it");
    }
}
