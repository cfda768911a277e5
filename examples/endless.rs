//! A walk through a terrain without an end, as a game would have it: chunks are made round the player on threads of the
//! game's own, holes are dug, and a frame takes 16 ms. Prints what of that the frame's own thread needs, how long a hole
//! takes until it is seen, and what is allocated once the walk is under way.
//!
//! `cargo run --release -p isostudy-extract --example endless -- [frames] [threads] [metres per second]`

#[path = "browser/src/ground.rs"]
mod ground;

use std::alloc::System;
use std::collections::{HashMap, VecDeque};
use std::sync::{Condvar, Mutex};
use std::time::{Duration, Instant};

use ground::{Ground, Hole};
use isostudy_extract::{
    Aabb, Arrangement, Chunk, ChunkExtractor, ChunkSettings, Control, Grid, Method, Tetrahedra, check_field,
};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

const FRAME: Duration = Duration::from_millis(16);
/// Cells along a side of a chunk, each a metre.
const CHUNK: u32 = 32;
/// Chunks that are seen to every side, and up and down.
const SIGHT: [i32; 3] = [4, 4, 1];
/// Room of a chunk's buffers: the surface of a chunk of hills has about 2,000 vertices.
const ROOM: usize = 12_000;

/// What threads are asked to do.
struct Job {
    id: [i32; 3],
    /// How many were sent before it.
    number: usize,
    /// The frame in which it was asked for, and whether a hole is why.
    frame: usize,
    dug: bool,
    /// Where it goes.
    chunk: Chunk,
    time: Duration,
}

/// What the game's threads share: work to do, work done, the holes.
#[derive(Default)]
struct Shared {
    queue: Mutex<(VecDeque<Job>, bool)>,
    wake: Condvar,
    done: Mutex<Vec<Job>>,
    holes: Mutex<Vec<Hole>>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: usize| arguments.next().map_or(Ok(default), |text| text.parse());
    let (frames, threads, speed) = (number(900)?, number(1)?, number(12)?);
    let grid = Grid::try_new([0.0; 3], 1.0)?;
    let method = Method::Tetrahedra(Tetrahedra::new(Arrangement::BodyCentred));
    // What a game does once, in a test of its own.
    let somewhere = Ground { holes: vec![Hole { centre: [3.0, 4.0, 5.0], radius: 9.0 }] };
    check_field(&somewhere, Aabb { min: [-200.0; 3], max: [200.0; 3] }, 300)?;

    let shared = Shared::default();
    let world = World::new(&grid, &method, threads);
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            scope.spawn(|| work(&shared, &grid, &method));
        }
        let result = world.walk(&shared, frames, speed as f32);
        shared.queue.lock().expect("no thread panics").1 = true;
        shared.wake.notify_all();
        result
    })
}

/// A thread of the game: one extractor, one ground with the holes that matter to the chunk at hand.
fn work(shared: &Shared, grid: &Grid, method: &Method) {
    let mut extractor =
        ChunkExtractor::try_new(grid, method, &ChunkSettings::default()).expect("chunks go with the method");
    extractor.reserve(2 * ROOM).expect("there is memory");
    let mut ground = Ground { holes: Vec::with_capacity(256) };
    loop {
        let mut job = {
            let mut queue = shared.queue.lock().expect("no thread panics");
            loop {
                if queue.1 {
                    return;
                }
                if let Some(job) = queue.0.pop_front() {
                    break job;
                }
                queue = shared.wake.wait(queue).expect("no thread panics");
            }
        };
        let start = Instant::now();
        let cells = grid.chunk(job.id, CHUNK);
        let seen = method.window(cells).map(|window| grid.bounds(window)).expect("no edge is collapsed");
        ground.holes.clear();
        let holes = shared.holes.lock().expect("no thread panics");
        ground.holes.extend(holes.iter().filter(|hole| hole.reach().meets(&seen)));
        drop(holes);
        let made = extractor.extract_into(&ground, cells, Control::default(), &mut job.chunk);
        made.expect("a chunk of this world");
        job.time = start.elapsed();
        shared.done.lock().expect("no thread panics").push(job);
    }
}

/// What the thread of the frames has.
struct World<'a> {
    grid: &'a Grid,
    method: &'a Method,
    /// What is drawn, and the number of the job that made it; `None` while it is made for the first time.
    chunks: HashMap<[i32; 3], (usize, Option<Chunk>)>,
    sent: usize,
    /// Buffers that are free.
    free: Vec<Chunk>,
    /// Asked for, and not done.
    pending: usize,
    most_pending: usize,
    leaving: Vec<[i32; 3]>,
    arriving: Vec<([i32; 3], i32)>,
    arrived: Vec<Job>,
}

impl<'a> World<'a> {
    fn new(grid: &'a Grid, method: &'a Method, threads: usize) -> Self {
        let seen: usize = SIGHT.iter().map(|&n| 2 * n as usize + 3).product();
        let mut free = Vec::with_capacity(2 * seen);
        free.resize_with(2 * seen, || {
            let mut chunk = Chunk::default();
            chunk.reserve(ROOM);
            chunk
        });
        Self {
            grid,
            method,
            chunks: HashMap::with_capacity(4 * seen),
            free,
            sent: 0,
            pending: 0,
            most_pending: 4 * threads.max(1),
            leaving: Vec::with_capacity(seen),
            arriving: Vec::with_capacity(seen),
            arrived: Vec::with_capacity(2 * seen),
        }
    }

    fn walk(mut self, shared: &Shared, frames: usize, speed: f32) -> Result<(), Box<dyn std::error::Error>> {
        shared.queue.lock().expect("no thread panics").0.reserve(4096);
        shared.done.lock().expect("no thread panics").reserve(4096);
        shared.holes.lock().expect("no thread panics").reserve(4096);
        let (mut of_frame, mut of_chunk, mut of_hole) =
            (Vec::with_capacity(frames), Vec::with_capacity(1 << 16), Vec::with_capacity(1 << 12));
        let (mut made, mut dug) = (0, 0);
        let mut region = Region::new(ALLOCATOR);
        for frame in 0..frames {
            let start = Instant::now();
            if frame == frames / 2 {
                region = Region::new(ALLOCATOR);
            }
            // West by south-west, so that numbers become negative.
            let way = frame as f32 * speed / 60.0;
            let (x, y) = (-way, -0.4 * way);
            let here = self.grid.chunk_at([x, y, 0.0], CHUNK);
            for job in self.receive(shared) {
                of_chunk.push(job.0);
                if let Some(asked) = job.1 {
                    of_hole.push(frame - asked);
                }
                made += 1;
            }
            self.forget(here);
            self.ask(shared, here, frame);
            if frame % 20 == 10 {
                let ground = Ground::default();
                let hole = Hole { centre: [x - 9.0, y, ground.height(x - 9.0, y)], radius: 3.0 };
                dug += self.dig(shared, hole, frame)?;
            }
            of_frame.push(start.elapsed().as_secs_f64() * 1e3);
            std::thread::sleep(FRAME.saturating_sub(start.elapsed()));
        }
        let change = region.change();
        println!(
            "{frames} frames of {} ms, {} chunks of {CHUNK}³ cells made, {dug} of them for holes",
            FRAME.as_millis(),
            made
        );
        for (what, times) in
            [("frame's own thread", &mut of_frame), ("chunk, on a thread of its own", &mut of_chunk)]
        {
            times.sort_unstable_by(f64::total_cmp);
            if let (Some(median), Some(longest)) = (times.get(times.len() / 2), times.last()) {
                println!("{what}: median {median:.2} ms, longest {longest:.2} ms");
            }
        }
        of_hole.sort_unstable();
        if let (Some(median), Some(longest)) = (of_hole.get(of_hole.len() / 2), of_hole.last()) {
            println!("a hole is seen after {median} frames, at the latest {longest}");
        }
        println!(
            "second half of the walk: {} allocations, {} reallocations",
            change.allocations, change.reallocations
        );
        Ok(())
    }

    /// Takes what is done. Times of the chunks, and when those were asked for that holes are the reason of.
    fn receive(&mut self, shared: &Shared) -> impl Iterator<Item = (f64, Option<usize>)> + use<'_, 'a> {
        std::mem::swap(&mut self.arrived, &mut *shared.done.lock().expect("no thread panics"));
        let Self { arrived, chunks, free, pending, .. } = self;
        arrived.drain(..).map(|job| {
            *pending -= 1;
            // A renderer copies `positions`, `normals` and `triangles` to the GPU here.
            let old = match chunks.get_mut(&job.id) {
                // A job that was sent earlier, and took longer, may not know of a hole.
                Some((number, drawn)) if *number <= job.number => {
                    *number = job.number;
                    drawn.replace(job.chunk)
                }
                _ => Some(job.chunk),
            };
            free.extend(old);
            (job.time.as_secs_f64() * 1e3, job.dug.then_some(job.frame))
        })
    }

    fn forget(&mut self, here: [i32; 3]) {
        let is_far = |id: &[i32; 3]| (0..3).any(|axis| (id[axis] - here[axis]).abs() > SIGHT[axis] + 1);
        self.leaving.clear();
        self.leaving.extend(self.chunks.keys().filter(|id| is_far(id)));
        for id in self.leaving.drain(..) {
            self.free.extend(self.chunks.remove(&id).and_then(|(_, chunk)| chunk));
        }
    }

    /// Asks for the nearest chunks that are not there, some at a time, so that holes need not wait.
    fn ask(&mut self, shared: &Shared, here: [i32; 3], frame: usize) {
        self.arriving.clear();
        for z in -SIGHT[2]..=SIGHT[2] {
            for y in -SIGHT[1]..=SIGHT[1] {
                for x in -SIGHT[0]..=SIGHT[0] {
                    let id = [here[0] + x, here[1] + y, here[2] + z];
                    if !self.chunks.contains_key(&id) {
                        self.arriving.push((id, x * x + y * y + z * z));
                    }
                }
            }
        }
        self.arriving.sort_unstable_by_key(|&(id, far)| (far, id));
        for i in 0..self.arriving.len() {
            if self.pending >= self.most_pending {
                break;
            }
            let id = self.arriving[i].0;
            self.chunks.insert(id, (0, None));
            self.send(shared, id, frame, false);
        }
    }

    /// Digs, and asks for the chunks anew that the hole reaches. Returns how many.
    fn dig(
        &mut self,
        shared: &Shared,
        hole: Hole,
        frame: usize,
    ) -> Result<usize, isostudy_extract::GridError> {
        shared.holes.lock().expect("no thread panics").push(hole);
        let mut touched = 0;
        for id in self.grid.touched(hole.reach(), CHUNK, self.method)? {
            if self.chunks.contains_key(&id) {
                self.send(shared, id, frame, true);
                touched += 1;
            }
        }
        Ok(touched)
    }

    fn send(&mut self, shared: &Shared, id: [i32; 3], frame: usize, dug: bool) {
        let chunk = self.free.pop().unwrap_or_default();
        let job = Job { id, number: self.sent, frame, dug, chunk, time: Duration::ZERO };
        self.pending += 1;
        self.sent += 1;
        let queue = &mut shared.queue.lock().expect("no thread panics").0;
        if job.dug {
            queue.push_front(job)
        } else {
            queue.push_back(job)
        }
        shared.wake.notify_one();
    }
}
