//! The endless terrain for a browser: functions that a page calls by name, and buffers that it reads.
//!
//! `examples/browser/index.html` is the page. A page has one thread: it asks for chunks one by one, as long as there is time
//! in a frame ([`make_next`]), and copies their buffers to the GPU.
//!
//! The attribute that gives a function its name for the page is the only `unsafe` thing here: two functions of one
//! program must not have one name. Nothing else is.

mod ground;

use std::cell::RefCell;
use std::collections::BTreeMap;

use ground::{Ground, Hole};
use isostudy_extract::{
    Arrangement, Chunk, ChunkExtractor, ChunkSettings, Control, Grid, Method, Tetrahedra,
};

/// Cells along a side of a chunk.
const CHUNK: u32 = 32;
/// Chunks that are seen to every side, and up and down.
const SIGHT: [i32; 3] = [3, 3, 1];
/// Room for a chunk's vertices.
const ROOM: usize = 12_000;

struct World {
    grid: Grid,
    method: Method,
    extractor: ChunkExtractor,
    ground: Ground,
    here: [i32; 3],
    /// Chunks round the player, and whether they are as they should be.
    chunks: BTreeMap<[i32; 3], bool>,
    /// The last one that was made.
    id: [i32; 3],
    chunk: Chunk,
}

impl World {
    fn new() -> Option<Self> {
        let grid = Grid::try_new([0.0; 3], 1.0).ok()?;
        let method = Method::Tetrahedra(Tetrahedra::new(Arrangement::BodyCentred));
        let mut extractor = ChunkExtractor::try_new(&grid, &method, &ChunkSettings::default()).ok()?;
        extractor.reserve(2 * ROOM).ok()?;
        let mut chunk = Chunk::default();
        chunk.reserve(ROOM);
        let (ground, chunks) = (Ground::default(), BTreeMap::new());
        Some(Self { grid, method, extractor, ground, here: [0; 3], chunks, id: [0; 3], chunk })
    }

    fn walk(&mut self, p: [f32; 3]) {
        self.here = self.grid.chunk_at(p, CHUNK);
        let here = self.here;
        self.chunks.retain(|id, _| (0..3).all(|axis| (id[axis] - here[axis]).abs() <= SIGHT[axis] + 1));
        for z in -SIGHT[2]..=SIGHT[2] {
            for y in -SIGHT[1]..=SIGHT[1] {
                for x in -SIGHT[0]..=SIGHT[0] {
                    self.chunks.entry([here[0] + x, here[1] + y, here[2] + z]).or_insert(false);
                }
            }
        }
    }

    fn make_next(&mut self) -> bool {
        let far = |id: &[i32; 3]| (0..3).map(|axis| (id[axis] - self.here[axis]).pow(2)).sum::<i32>();
        let missing = self.chunks.iter().filter(|(_, is_made)| !**is_made).map(|(id, _)| *id);
        let Some(id) = missing.min_by_key(far) else { return false };
        let cells = self.grid.chunk(id, CHUNK);
        if self.extractor.extract_into(&self.ground, cells, Control::default(), &mut self.chunk).is_err() {
            return false;
        }
        self.id = id;
        self.chunks.insert(id, true);
        true
    }

    fn dig(&mut self, hole: Hole) -> u32 {
        self.ground.holes.push(hole);
        let Ok(touched) = self.grid.touched(hole.reach(), CHUNK, &self.method) else { return 0 };
        let mut count = 0;
        for id in touched {
            if let Some(is_made) = self.chunks.get_mut(&id) {
                *is_made = false;
                count += 1;
            }
        }
        count
    }
}

thread_local! {
    static WORLD: RefCell<Option<World>> = RefCell::new(World::new());
}

/// `otherwise` if there is no world, which cannot be.
fn with_world<R>(otherwise: R, of: impl FnOnce(&mut World) -> R) -> R {
    WORLD.with_borrow_mut(|world| match world {
        Some(world) => of(world),
        None => otherwise,
    })
}

/// The player is here: chunks around are wanted from now on, and those far away are not.
#[unsafe(no_mangle)]
pub extern "C" fn walk(x: f32, y: f32, z: f32) {
    with_world((), |world| world.walk([x, y, z]));
}

/// Makes the nearest chunk that is missing or has changed. 0 if there is none, else 1.
#[unsafe(no_mangle)]
pub extern "C" fn make_next() -> u32 {
    with_world(0, |world| world.make_next().into())
}

/// Digs a ball out of the ground. How many chunks must be made anew.
#[unsafe(no_mangle)]
pub extern "C" fn dig(x: f32, y: f32, z: f32, radius: f32) -> u32 {
    with_world(0, |world| world.dig(Hole { centre: [x, y, z], radius }))
}

/// Where the ground begins, from above.
#[unsafe(no_mangle)]
pub extern "C" fn height(x: f32, y: f32) -> f32 {
    with_world(0.0, |world| world.ground.height(x, y))
}

/// The number of the last chunk along an axis.
#[unsafe(no_mangle)]
pub extern "C" fn chunk_id(axis: u32) -> i32 {
    with_world(0, |world| world.id.get(axis as usize).copied().unwrap_or(0))
}

/// The last chunk's vertices, three `f32` each, until the next one is made.
#[unsafe(no_mangle)]
pub extern "C" fn positions() -> *const [f32; 3] {
    with_world(std::ptr::null(), |world| world.chunk.positions.as_ptr())
}

/// Its normals, as many.
#[unsafe(no_mangle)]
pub extern "C" fn normals() -> *const [f32; 3] {
    with_world(std::ptr::null(), |world| world.chunk.normals.as_ptr())
}

/// Its triangles, three `u32` each.
#[unsafe(no_mangle)]
pub extern "C" fn triangles() -> *const [u32; 3] {
    with_world(std::ptr::null(), |world| world.chunk.triangles.as_ptr())
}

/// How many vertices it has.
#[unsafe(no_mangle)]
pub extern "C" fn vertex_count() -> usize {
    with_world(0, |world| world.chunk.positions.len())
}

/// How many triangles it has.
#[unsafe(no_mangle)]
pub extern "C" fn triangle_count() -> usize {
    with_world(0, |world| world.chunk.triangles.len())
}
