//! A camera over a terrain without an end, which is there in four levels of detail: fine near by, coarse far away. As it moves, chunks
//! are divided and joined. Those whose neighbours changed are extracted again, and those that a hole reaches, which is dug every second.
//! Prints how many, what a frame needs, how many triangles there are, how many edges are open: none, and how many triangles of seams are
//! turned against the field's gradient. Beside it the cheap way: a skirt along every side of a chunk.
//!
//! With a file it leaves a turntable of the last frame, with levels as colours, and the seams between them.
//!
//! `cargo run --release -p isostudy-raster --example lod -- [frames] [metres per second] [cubes|nets|dc|dc-in-cell] [file.gif]`
//!
//! `--close-up FILE.png` walks no way and digs nothing. It draws one place of the
//! seam between levels 0 and 1, as it is after so many frames, by marching cubes and by surface nets.

#[path = "browser/src/ground.rs"]
mod ground;
#[path = "engines/world/src/view.rs"]
mod view;

use std::collections::HashMap;
use std::error::Error;
use std::fmt;
use std::fs::File;
use std::time::Instant;

use glam::Vec3;
use ground::{Ground, Hole};
use isostudy_extract::{
    Chunk, ChunkSettings, Control, Cubes, DualContouring, Grid, LevelExtractor, Method, Neighbours,
    ScalarField, SurfaceNets, weld_chunks,
};
use isostudy_mesh::TriangleMesh;
use isostudy_raster::tiny_skia::Pixmap;
use isostudy_raster::{
    Camera, Colouring, Look, Panel, Scale, Shading, Sheet, Turntable, Values, Viewport, panels,
    pixmap_to_png, render_coloured, turntable_coloured,
};
use view::{CHUNK, Id, LEVELS, SIGHT, View};

/// Surface nets with one vertex per cell, which alone have levels.
const NETS: Method = Method::SurfaceNets(SurfaceNets::new());

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut option = |name: &str| -> Result<Option<String>, String> {
        let Some(i) = arguments.iter().position(|argument| argument == name) else { return Ok(None) };
        arguments.remove(i);
        if i == arguments.len() {
            return Err(format!("{name}: a value must follow"));
        }
        Ok(Some(arguments.remove(i)))
    };
    let close_up = option("--close-up")?;
    if let Some(other) = arguments.iter().find(|argument| argument.starts_with("--")) {
        return Err(format!("{other}: there is no such option").into());
    }
    let number = |i: usize, default: u32| arguments.get(i).map_or(Ok(default), |text| text.parse());
    let (frames, speed) = (number(0, 900)?, number(1, 24)?);
    let method = match arguments.get(2).map_or("cubes", String::as_str) {
        "cubes" => Method::Cubes(Cubes::default()),
        "nets" => NETS,
        "dc" => Method::DualContouring(DualContouring::default()),
        "dc-in-cell" => Method::DualContouring(DualContouring::default().with_in_cell(true)),
        other => return Err(format!("{other}: must be cubes, nets, dc or dc-in-cell").into()),
    };
    let grid = Grid::try_new([0.0; 3], 1.0)?;
    if let Some(path) = close_up {
        let way = frames.saturating_sub(1) as f32 * speed as f32 / 60.0;
        std::fs::write(&path, draw_close_up(&grid, way)?)?;
        println!("{path}");
        return Ok(());
    }
    let walk = |between| World::new(&grid, &method, between)?.walk(frames, speed as f32);
    let world = walk(Between::Seams)?;
    // What duals have at a side reaches into the neighbour: it is no skirt.
    if matches!(method, Method::Cubes(_)) {
        walk(Between::Skirts)?;
    }
    if let Some(path) = arguments.get(3) {
        world.draw(path)?;
        println!("{path}");
    }
    Ok(())
}

/// What stands between chunks of two levels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Between {
    Seams,
    Skirts,
}

/// A chunk that is there, and the neighbours that it was made for.
struct Held {
    seen: Neighbours,
    chunk: Chunk,
    /// Triangles of skirts.
    skirts: usize,
    /// Whether the ground has changed since.
    is_stale: bool,
}

struct World {
    grids: Vec<Grid>,
    between: Between,
    extractor: LevelExtractor,
    ground: Ground,
    camera: Vec3,
    view: View,
    held: HashMap<Id, Held>,
    /// Buffers that are free.
    free: Vec<Chunk>,
}

impl World {
    fn new(grid: &Grid, method: &Method, between: Between) -> Result<Self, Box<dyn Error>> {
        let grids: Result<_, _> = (0..LEVELS).map(|level| grid.coarser(level)).collect();
        Ok(Self {
            grids: grids?,
            between,
            extractor: LevelExtractor::try_new(grid, method, &ChunkSettings::default())?,
            ground: Ground::default(),
            camera: Vec3::ZERO,
            view: View::default(),
            held: HashMap::new(),
            free: Vec::new(),
        })
    }

    /// Goes so many frames, and prints what came of it.
    fn walk(mut self, frames: u32, speed: f32) -> Result<Self, Box<dyn Error>> {
        // Of all frames, and of those in which chunks were made.
        let mut times = [Vec::new(), Vec::new()];
        let (mut new, mut again, mut dug, mut most_open) = (0, 0, 0, 0);
        let (mut of_seams, mut most_turned) = (Turned::default(), 0);
        for frame in 0..frames {
            self.go_to(frame as f32 * speed / 60.0);
            let start = Instant::now();
            let reached = if frame % 60 == 30 { self.dig() } else { 0 };
            let made = self.frame()?;
            let time = start.elapsed().as_secs_f64() * 1e3;
            // All is new in the first frame.
            if frame > 0 {
                times[0].push(time);
                times[1].extend((made != [0; 2]).then_some(time));
                (new, again, dug) = (new + made[0], again + made[1] - reached, dug + reached);
            }
            if frame % 10 == 0 {
                most_open = most_open.max(self.open_edges()?);
                let turned = self.turned(true);
                most_turned = most_turned.max(turned.turned);
                of_seams.add(turned);
            }
        }
        let chunks = |level| self.held.keys().filter(|id| id.0 == level).count();
        let total = |of: &dyn Fn(&Held) -> usize| self.held.values().map(of).sum::<usize>();
        let triangles = total(&|held| held.chunk.triangles.len());
        let seams = total(&|held| held.chunk.seam as usize + held.skirts);
        println!("{:?}: {frames} frames at {speed} m/s", self.between);
        println!("  chunks of levels 0 to 3: {:?}", [0, 1, 2, 3].map(chunks));
        println!(
            "  extracted: {new} new chunks, {again} again since neighbours changed, {dug} since a hole was dug"
        );
        for (what, mut times) in ["a frame's work", "that of frames which make chunks"].into_iter().zip(times)
        {
            times.sort_unstable_by(f64::total_cmp);
            if let (Some(median), Some(longest)) = (times.get(times.len() / 2), times.last()) {
                println!("  {what}: median {median:.2} ms, longest {longest:.2} ms, {} frames", times.len());
            }
        }
        println!("  triangles: {}, {seams} of them between levels", triangles + total(&|held| held.skirts));
        println!("  open edges: {most_open}");
        let of_chunks = self.turned(false);
        println!(
            "  turned against the gradient, of seams in every tenth frame: {of_seams}; {most_turned} in one at most"
        );
        println!("  turned against the gradient, of the chunks' own in the last frame: {of_chunks}");
        Ok(self)
    }

    /// Puts the camera where it is so many metres from the beginning: west by south-west, so that numbers become negative.
    fn go_to(&mut self, way: f32) {
        let (x, y) = (-way, -0.4 * way);
        self.camera = Vec3::new(x, y, self.ground.height(x, y) + 10.0);
    }

    /// Counts the triangles of seams, or all others, that face the inside.
    fn turned(&self, is_seam: bool) -> Turned {
        let mut found = Turned::default();
        for chunk in self.held.values().map(|held| &held.chunk) {
            let (own, seam) = chunk.triangles.split_at(chunk.triangles.len() - chunk.seam as usize);
            for &triangle in if is_seam { seam } else { own } {
                found.count(triangle.map(|v| Vec3::from(chunk.positions[v as usize])), &self.ground);
            }
        }
        found
    }

    /// Makes the chunks that the camera's place asks for. Returns how many are new, and how many were made again.
    fn frame(&mut self) -> Result<[usize; 2], Box<dyn Error>> {
        let view = View::from(&self.grids, self.camera.to_array());
        let before = std::mem::replace(&mut self.view, view).wanted;
        if self.view.wanted == before && !self.held.values().any(|held| held.is_stale) {
            return Ok([0; 2]);
        }
        let mut old = std::mem::take(&mut self.held);
        let mut made = [0, 0];
        for &id in &self.view.wanted {
            let neighbours = Neighbours::try_new(id.0, |direction| self.view.level_at(id, direction))?;
            let seen = match self.between {
                Between::Seams => self.extractor.seen(&neighbours),
                Between::Skirts => Neighbours::SAME,
            };
            let before = old.remove(&id);
            let held = match before {
                Some(held) if held.seen == seen && !held.is_stale => held,
                before => {
                    made[usize::from(before.is_some())] += 1;
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
                    let skirts = match self.between {
                        Between::Seams => 0,
                        Between::Skirts => skirts(&chunk, &self.grids[id.0 as usize]).len(),
                    };
                    Held { seen, chunk, skirts, is_stale: false }
                }
            };
            self.held.insert(id, held);
        }
        self.free.extend(old.into_values().map(|held| held.chunk));
        Ok(made)
    }

    /// Digs a hole ahead of the camera. Returns how many chunks are to be made again.
    fn dig(&mut self) -> usize {
        let [x, y] = [self.camera.x - 9.0, self.camera.y];
        let hole = Hole { centre: [x, y, self.ground.height(x, y)], radius: 3.0 };
        self.ground.holes.push(hole);
        let reached = |held: &&mut Held| held.chunk.is_touched_by(hole.reach());
        let touched = self.held.values_mut().filter(reached);
        touched.map(|held| held.is_stale = true).count()
    }

    /// Edges with one triangle, but for those where sight ends.
    fn open_edges(&self) -> Result<usize, Box<dyn Error>> {
        let mesh = weld_chunks(self.held.values().map(|held| &held.chunk))?;
        let mut runs: HashMap<[u32; 2], i32> = HashMap::new();
        for [a, b, c] in &mesh.triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *runs.entry([*from.min(to), *from.max(to)]).or_default() += if from < to { 1 } else { -1 };
            }
        }
        let (top, here) = (&self.grids[LEVELS as usize - 1], self.view.root);
        let ends = [-1, 1].map(|side| {
            let root = [0, 1].map(|axis| here[axis] + side * SIGHT[axis] + i32::from(side > 0));
            top.position([root[0] * CHUNK as i32, root[1] * CHUNK as i32, 0])
        });
        // Duals end half a cell before. A vertex that may leave its cell does so by up to a cell more.
        let slack = top.spacing()
            * match self.held.values().next().and_then(|held| held.chunk.world()).map(|world| world.method())
            {
                None | Some(Method::Cubes(_)) => 0.0,
                Some(Method::DualContouring(dual)) if !dual.in_cell => 2.0,
                Some(_) => 1.0,
            };
        let is_at_end = |v: u32, axis: usize, end: usize| {
            (f64::from(mesh.positions[v as usize][axis]) - ends[end][axis]).abs() <= slack
        };
        let is_rim = |[a, b]: &[u32; 2]| {
            [0, 1].into_iter().any(|axis| {
                [0, 1].into_iter().any(|end| is_at_end(*a, axis, end) && is_at_end(*b, axis, end))
            })
        };
        Ok(runs.iter().filter(|(edge, run)| **run != 0 && !is_rim(edge)).count())
    }

    /// Draws the seam between levels 0 and 1 where it turns, with edges of triangles and levels as colours.
    fn picture_of_corner(&self) -> Result<Pixmap, Box<dyn Error>> {
        let ends = self.held.keys().filter(|id| id.0 == 0).map(|&(_, id)| [id[0] + 1, id[1] + 1]);
        let corner = ends.reduce(|a, b| [a[0].max(b[0]), a[1].max(b[1])]).unwrap_or_default();
        let [x, y] = corner.map(|i| (i * CHUNK as i32) as f32);
        let target = Vec3::new(x - 1.0, y - 1.0, self.ground.height(x, y));
        // Every triangle has corners of its own, so that it is lit by its own normal.
        let mut mesh = TriangleMesh::default();
        let mut colours = Vec::new();
        for chunk in self.held.values().map(|held| &held.chunk) {
            let own = chunk.triangles.len() - chunk.seam as usize;
            for (t, triangle) in chunk.triangles.iter().enumerate() {
                let corners = triangle.map(|v| Vec3::from(chunk.positions[v as usize]));
                if corners.iter().all(|p| p.distance(target) > 120.0) {
                    continue;
                }
                let [a, b, c] = corners;
                let first = mesh.positions.len() as u32;
                mesh.positions.extend(corners);
                mesh.normals.extend([(b - a).cross(c - a).normalize_or_zero(); 3]);
                mesh.triangles.push([first, first + 1, first + 2]);
                colours.push(match t {
                    _ if is_turned(corners, &self.ground) => 0.0,
                    t if t >= own => 0.65,
                    _ if chunk.level == 0 => 1.0,
                    _ => 0.35,
                });
            }
        }
        let scale = Scale { title: String::new(), dark: 0.0, bright: 1.0, marks: Vec::new() };
        let colouring = Colouring { values: Values::PerTriangle(colours), scale };
        let camera = Camera {
            eye: target + Vec3::new(-3.0, -6.0, 22.0),
            target,
            up: Vec3::Z,
            vertical_fov_rad: 0.75,
            near: 0.1,
            far: 1000.0,
        };
        let viewport = Viewport { width: 560, height: 480, supersampling: 3 };
        Ok(render_coloured(&mesh, &colouring, &camera, viewport, &Shading::default(), Look::SmoothWireframe)?)
    }

    /// Draws a turn round what there is, with levels as colours.
    fn draw(&self, path: &str) -> Result<(), Box<dyn Error>> {
        let mut mesh = TriangleMesh::default();
        let mut colours = Vec::new();
        let radius = (SIGHT[0] as f32 + 0.5) * (CHUNK << (LEVELS - 1)) as f32;
        let top = &self.grids[LEVELS as usize - 1];
        let bounds = top.bounds(top.chunk(self.view.root, CHUNK));
        let middle = Vec3::from(bounds.min).midpoint(Vec3::from(bounds.max)).with_z(0.0);
        for Held { chunk, .. } in self.held.values() {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(chunk.positions.iter().map(|&p| (Vec3::from(p) - middle) / radius));
            mesh.normals.extend(chunk.normals.iter().copied().map(Vec3::from));
            mesh.triangles.extend(chunk.triangles.iter().map(|t| t.map(|v| v + first)));
            let own = chunk.triangles.len() - chunk.seam as usize;
            let colour = |t| if t < own { chunk.level as f32 } else { LEVELS as f32 };
            colours.extend((0..chunk.triangles.len()).map(colour));
        }
        let marks = (0..LEVELS).map(|level| (level as f32, format!("level {level}")));
        let scale = Scale {
            title: "levels of detail".into(),
            dark: LEVELS as f32,
            bright: 0.0,
            marks: marks.chain([(LEVELS as f32, "seams".into())]).collect(),
        };
        let colouring = Colouring { values: Values::PerTriangle(colours), scale };
        let turn = Turntable { elevation_rad: 0.9, ..Turntable::around(1.5) };
        let animation =
            turntable_coloured(&mesh, &colouring, &turn, &Shading::default(), Look::Flat, &|| ())?;
        animation.write_gif(File::create(path)?)?;
        Ok(())
    }
}

/// Of some triangles, how many there are and how many are turned against the field's gradient.
#[derive(Debug, Clone, Copy, Default)]
struct Turned {
    triangles: usize,
    turned: usize,
    /// Those of `turned` with a shortest height of a hundredth of the longest edge or more: the others are slivers.
    with_area: usize,
    /// Of all, the slivers.
    slivers: usize,
}

impl Turned {
    fn count(&mut self, corners: [Vec3; 3], ground: &Ground) {
        let is_turned = is_turned(corners, ground);
        let is_sliver = is_sliver(corners);
        self.triangles += 1;
        self.turned += usize::from(is_turned);
        self.with_area += usize::from(is_turned && !is_sliver);
        self.slivers += usize::from(is_sliver);
    }

    fn add(&mut self, other: Self) {
        self.triangles += other.triangles;
        self.turned += other.turned;
        self.with_area += other.with_area;
        self.slivers += other.slivers;
    }
}

impl fmt::Display for Turned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { triangles, turned, with_area, slivers } = self;
        write!(f, "{turned} of {triangles}, {with_area} of them no slivers; {slivers} slivers in all")
    }
}

/// Whether a triangle faces the inside, as the gradient at its middle has it. A triangle without area faces nowhere.
fn is_turned([a, b, c]: [Vec3; 3], ground: &Ground) -> bool {
    let slope = |p: Vec3| {
        Vec3::from_array(Vec3::AXES.map(|axis| {
            let value = |way: f32| ground.sample((p + axis * way).to_array());
            value(1e-2) - value(-1e-2)
        }))
    };
    // Far from the surface the ground's values are cut off; its slope there is that at the corners.
    let at_middle = slope((a + b + c) / 3.0);
    let slope = if at_middle == Vec3::ZERO { slope(a) + slope(b) + slope(c) } else { at_middle };
    (b - a).cross(c - a).dot(slope) > 1e-9
}

/// Whether a triangle's least height is below a hundredth of its longest edge.
fn is_sliver([a, b, c]: [Vec3; 3]) -> bool {
    let longest = [a - b, b - c, c - a].map(Vec3::length_squared).into_iter().fold(0.0, f32::max);
    (b - a).cross(c - a).length() < 0.01 * longest
}

/// A PNG of the place where the finest level has its north-eastern corner, by marching cubes and by surface nets, when the camera has gone
/// so many metres.
fn draw_close_up(grid: &Grid, way: f32) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut pictures = Vec::new();
    for method in [Method::Cubes(Cubes::default()), NETS] {
        let mut world = World::new(grid, &method, Between::Seams)?;
        world.go_to(way);
        world.frame()?;
        pictures.push(world.picture_of_corner()?);
    }
    let labels = ["marching cubes: stitched coarse cells", "surface nets: polygons round minimal edges"];
    let row: Vec<Panel> =
        pictures.iter().zip(labels).map(|(picture, label)| Panel { picture, label }).collect();
    Ok(pixmap_to_png(&panels(&row, &Sheet { columns: 2, ..Sheet::default() })?))
}

/// The triangles of a band that hangs from every edge in which a chunk ends, a cell down into the ground.
fn skirts(chunk: &Chunk, grid: &Grid) -> Vec<[Vec3; 3]> {
    let mut runs: HashMap<[u32; 2], i32> = HashMap::new();
    for [a, b, c] in &chunk.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *runs.entry([*from.min(to), *from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    let at = |v: u32| Vec3::from(chunk.positions[v as usize]);
    let below = |v: u32| at(v) - Vec3::from(chunk.normals[v as usize]) * grid.spacing() as f32;
    let band = |([low, high], run): ([u32; 2], i32)| {
        let [from, to] = if run > 0 { [high, low] } else { [low, high] };
        [[at(from), at(to), below(to)], [at(from), below(to), below(from)]]
    };
    runs.into_iter().filter(|(_, run)| *run != 0).flat_map(band).collect()
}
