//! A world without an end, in levels of detail, that can be dug.
//!
//! A thread makes chunks: fine near by, coarse far away. An engine says where its camera is, and takes [`Changes`]: which chunks are no
//! longer to be drawn, and which are. Each set of changes leaves a surface without cracks, so an engine applies all of a set in one frame.
//!
//! This is docs/engine.md in one file. Nothing here belongs to any engine.

mod ground;
mod view;

use std::collections::HashMap;
use std::error::Error;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use isostudy_extract::{Chunk, ChunkSettings, Control, Cubes, Grid, LevelExtractor, Method, Neighbours};

use crate::view::{CHUNK, LEVELS, View};

pub use crate::ground::{Ground, Hole};

/// A chunk: its level, and its place among those of the level.
pub type Id = view::Id;

/// What an engine draws: triangles of a chunk, counter-clockwise seen from outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ChunkMesh {
    /// Where the chunk's corner is, in metres.
    pub origin: [f32; 3],
    /// Vertices, from the corner on.
    pub positions: Vec<[f32; 3]>,
    /// Of unit length and outward, one for each vertex.
    pub normals: Vec<[f32; 3]>,
    /// Numbers of vertices, three for each triangle.
    pub indices: Vec<u32>,
}

/// What is to be done in one frame.
#[derive(Debug, Default, PartialEq)]
pub struct Changes {
    /// Chunks that are there and must go.
    pub gone: Vec<Id>,
    /// Chunks that are new, or take the place of those of the same id. Those without a triangle are left out.
    pub made: Vec<(Id, ChunkMesh)>,
}

/// The world, which a thread makes.
pub struct World {
    requests: Sender<Request>,
    changes: Receiver<Changes>,
}

enum Request {
    Go([f32; 3]),
    Dig(Hole),
}

impl World {
    /// Begins the thread. Nothing is made before a camera is somewhere.
    ///
    /// # Errors
    /// If the system starts no thread.
    pub fn new() -> Result<Self, Box<dyn Error>> {
        let mut scene = Scene::new()?;
        let (requests, asked) = channel();
        let (done, changes) = channel();
        thread::Builder::new().name("chunks".into()).spawn(move || {
            while let Ok(first) = asked.recv() {
                // The latest place counts, and every hole.
                for request in [first].into_iter().chain(asked.try_iter()) {
                    match request {
                        Request::Go(camera) => scene.camera = Some(camera),
                        Request::Dig(hole) => scene.dig(hole),
                    }
                }
                // The field and the grid are our own: nothing can fail but memory.
                let made = scene.update().expect("chunks of this world can be made");
                if done.send(made).is_err() {
                    return;
                }
            }
        })?;
        Ok(Self { requests, changes })
    }

    /// Says where the camera is. May be called in every frame.
    pub fn go(&self, camera: [f32; 3]) {
        // The thread ends with the world, so it is there.
        let _ = self.requests.send(Request::Go(camera));
    }

    /// Digs a hole.
    pub fn dig(&self, hole: Hole) {
        let _ = self.requests.send(Request::Dig(hole));
    }

    /// What has been made since the last call; there is an answer to every place and hole, or one to several.
    pub fn changes(&self) -> impl Iterator<Item = Changes> {
        self.changes.try_iter()
    }

    /// Waits for the next changes.
    pub fn wait(&self) -> Changes {
        self.changes.recv().unwrap_or_default()
    }
}

/// A chunk that is there, and the neighbours that it was made for.
struct Held {
    seen: Neighbours,
    chunk: Chunk,
    /// Whether the ground has changed since.
    is_stale: bool,
}

/// What the thread has.
struct Scene {
    grids: Vec<Grid>,
    extractor: LevelExtractor,
    ground: Ground,
    camera: Option<[f32; 3]>,
    held: HashMap<Id, Held>,
    /// Buffers that are free.
    free: Vec<Chunk>,
}

impl Scene {
    fn new() -> Result<Self, Box<dyn Error>> {
        let grid = Grid::try_new([0.0; 3], 1.0)?;
        let method = Method::Cubes(Cubes::default());
        let grids: Result<_, _> = (0..LEVELS).map(|level| grid.coarser(level)).collect();
        Ok(Self {
            grids: grids?,
            extractor: LevelExtractor::try_new(&grid, &method, &ChunkSettings::default())?,
            ground: Ground::default(),
            camera: None,
            held: HashMap::new(),
            free: Vec::new(),
        })
    }

    fn dig(&mut self, hole: Hole) {
        let reach = hole.reach();
        self.ground.holes.push(hole);
        for held in self.held.values_mut().filter(|held| held.chunk.is_touched_by(reach)) {
            held.is_stale = true;
        }
    }

    /// Makes what the camera's place asks for.
    fn update(&mut self) -> Result<Changes, Box<dyn Error>> {
        let Some(camera) = self.camera else { return Ok(Changes::default()) };
        let view = View::from(&self.grids, camera);
        let mut old = std::mem::take(&mut self.held);
        let mut changes = Changes::default();
        for &id in &view.wanted {
            let neighbours = Neighbours::try_new(id.0, |direction| view.level_at(id, direction))?;
            let seen = self.extractor.seen(&neighbours);
            let held = match old.remove(&id) {
                Some(held) if held.seen == seen && !held.is_stale => held,
                before => {
                    let had_triangles = before.as_ref().is_some_and(|held| !held.chunk.triangles.is_empty());
                    let mut chunk =
                        before.map(|held| held.chunk).or_else(|| self.free.pop()).unwrap_or_default();
                    let cells = self.grids[id.0 as usize].chunk(id.1, CHUNK);
                    self.extractor.extract_into(
                        &self.ground,
                        id.0,
                        cells,
                        &seen,
                        Control::default(),
                        &mut chunk,
                    )?;
                    if !chunk.triangles.is_empty() {
                        changes.made.push((id, mesh(&chunk)));
                    } else if had_triangles {
                        changes.gone.push(id);
                    }
                    Held { seen, chunk, is_stale: false }
                }
            };
            self.held.insert(id, held);
        }
        for (id, held) in old {
            if !held.chunk.triangles.is_empty() {
                changes.gone.push(id);
            }
            self.free.push(held.chunk);
        }
        Ok(changes)
    }
}

fn mesh(chunk: &Chunk) -> ChunkMesh {
    let mut positions = Vec::new();
    chunk.relative_positions(&mut positions);
    ChunkMesh {
        origin: chunk.origin().map(|at| at as f32),
        positions,
        normals: chunk.normals.clone(),
        indices: chunk.triangles.as_flattened().to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::SIGHT;
    use isostudy_extract::weld_chunks;

    /// Edges with one triangle, but for those where sight ends.
    fn open_edges(scene: &Scene) -> usize {
        let mesh = weld_chunks(scene.held.values().map(|held| &held.chunk)).unwrap();
        let mut runs: HashMap<[u32; 2], i32> = HashMap::new();
        for [a, b, c] in &mesh.triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *runs.entry([*from.min(to), *from.max(to)]).or_default() += if from < to { 1 } else { -1 };
            }
        }
        let root = View::from(&scene.grids, scene.camera.unwrap()).root;
        let side = 8.0 * CHUNK as f32;
        let is_at_end = |v: u32| {
            let p = mesh.positions[v as usize].to_array();
            (0..2).any(|axis| {
                let [low, high] = [-SIGHT[axis], SIGHT[axis] + 1].map(|of| (root[axis] + of) as f32 * side);
                p[axis] <= low || p[axis] >= high
            })
        };
        runs.iter().filter(|(edge, run)| **run != 0 && !edge.iter().all(|&v| is_at_end(v))).count()
    }

    /// What an engine has after all changes is what the thread has.
    #[test]
    fn changes_add_up_to_a_surface_without_cracks() {
        let mut scene = Scene::new().unwrap();
        let mut drawn: HashMap<Id, ChunkMesh> = HashMap::new();
        for step in 0..12 {
            let (x, y) = (-9.0 * step as f32, 4.0 * step as f32);
            let z = scene.ground.height(x, y);
            scene.camera = Some([x, y, z + 8.0]);
            if step % 3 == 1 {
                scene.dig(Hole { centre: [x, y, z], radius: 3.0 });
            }
            let changes = scene.update().unwrap();
            assert!(step > 0 || changes.gone.is_empty() && changes.made.len() > 20);
            assert!(step % 3 != 1 || !changes.made.is_empty(), "a hole changes something");
            for id in changes.gone {
                assert!(drawn.remove(&id).is_some(), "{id:?} was drawn");
            }
            drawn.extend(changes.made);
            let expected = scene.held.iter().filter(|(_, held)| !held.chunk.triangles.is_empty());
            let expected: HashMap<Id, ChunkMesh> =
                expected.map(|(&id, held)| (id, mesh(&held.chunk))).collect();
            assert_eq!(drawn, expected, "step {step}");
            assert_eq!(open_edges(&scene), 0, "step {step}");
        }
        // The same again changes nothing.
        assert_eq!(scene.update().unwrap(), Changes::default());
    }

    #[test]
    fn the_thread_answers() {
        let world = World::new().unwrap();
        world.go([0.0, 0.0, 30.0]);
        let first = world.wait();
        assert!(first.made.len() > 20 && first.gone.is_empty());
        let ground = Ground::default();
        world.dig(Hole { centre: [0.0, 0.0, ground.height(0.0, 0.0)], radius: 3.0 });
        assert!(!world.wait().made.is_empty());
        assert_eq!(world.changes().count(), 0);
    }
}
