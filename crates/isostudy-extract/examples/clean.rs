//! What `dc-clean` takes and gives, beside the other ways of dual contouring and cubical marching squares: intersecting pairs, triangles,
//! distances of sharp edges from the mesh, and times in turns.
//!
//! `cargo run --release -p isostudy-extract --example clean [ROUNDS]`

use std::time::Instant;

use glam::{Mat3, Vec3};
use isostudy_extract::{
    BoxGrid, Chunk, ChunkExtractor, ChunkSettings, Control, Execution, Extraction, Extractor,
    IsosurfacePoints, Method, Source, StudyField, accuracy_beside, presets,
};
use isostudy_field::{Terrain, TerrainCharacter};
use isostudy_mesh::distribution::Distribution;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, self_intersections};

const METHODS: [&str; 5] = ["dc", "dc-manifold", "dc-in-cell", "dc-clean", "cms"];
const ONE: Execution = Execution { threads: 1 };
const TWO: Execution = Execution { threads: 2 };

/// A solid: a signed distance or a bound of one, positive inside, and its gradient.
type Solid = Box<dyn Fn(Vec3) -> (f32, Vec3) + Sync>;

struct Solids(Solid);

impl StudyField for Solids {
    fn sample(&self, p: Vec3) -> f32 {
        (self.0)(p).0
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        Some((self.0)(p).1)
    }
}

fn boxed(centre: Vec3, half: Vec3, turn: Mat3) -> Solid {
    Box::new(move |p| {
        let q = turn.transpose() * (p - centre);
        let side = |axis: Vec3| (half.dot(axis) - q.dot(axis).abs(), turn * axis * -q.dot(axis).signum());
        Vec3::AXES.into_iter().map(side).min_by(|a, b| a.0.total_cmp(&b.0)).expect("three sides")
    })
}

fn cone(apex: Vec3, slope: f32, floor: f32) -> Solid {
    Box::new(move |p| {
        let q = p - apex;
        let across = Vec3::new(q.x, q.y, 0.0);
        let side = (-q.z * slope - across.length(), -(across.normalize_or_zero() + slope * Vec3::Z));
        let base = (p.z - floor, Vec3::Z);
        if side.0 < base.0 { side } else { base }
    })
}

fn ball(centre: Vec3, radius: f32) -> Solid {
    Box::new(move |p| (radius - p.distance(centre), -(p - centre).normalize_or_zero()))
}

fn union(a: Solid, b: Solid) -> Solid {
    Box::new(move |p| {
        let (a, b) = (a(p), b(p));
        if a.0 > b.0 { a } else { b }
    })
}

fn without(a: Solid, b: Solid) -> Solid {
    Box::new(move |p| {
        let (a, b) = (a(p), b(p));
        if a.0 < -b.0 { a } else { (-b.0, -b.1) }
    })
}

/// Twenty boxes and balls, added and taken away in turns.
fn twenty() -> Solid {
    let mut state = 7u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    let mut all = boxed(Vec3::ZERO, Vec3::new(0.61, 0.53, 0.47), turned(0.3));
    for i in 0..19 {
        let mut point = || Vec3::new(random(), random(), random()) * 1.4 - 0.7;
        let (centre, angle) = (point(), point().x * 3.0);
        let size = 0.12 + 0.16 * random();
        let one = if i % 3 == 0 {
            ball(centre, size)
        } else {
            boxed(centre, Vec3::new(size, 0.7 * size, 1.3 * size), turned(angle))
        };
        all = if i % 2 == 0 { without(all, one) } else { union(all, one) };
    }
    all
}

fn turned(angle: f32) -> Mat3 {
    Mat3::from_rotation_z(angle) * Mat3::from_rotation_x(0.7 * angle + 0.2) * Mat3::from_rotation_y(0.4)
}

/// A house with a room, a door and a window in it, on flat ground.
fn house() -> Solid {
    let turn = Mat3::from_rotation_z(0.45);
    let at = |x: f32, y: f32, z: f32| turn * Vec3::new(x, y, 0.0) + Vec3::Z * z;
    let walls = boxed(at(0.0, 0.0, -0.1), Vec3::new(0.5, 0.35, 0.28), turn);
    let room = boxed(at(0.0, 0.0, -0.1), Vec3::new(0.44, 0.29, 0.22), turn);
    let door = boxed(at(0.2, -0.3, -0.18), Vec3::new(0.07, 0.2, 0.14), turn);
    let window = boxed(at(-0.2, -0.3, -0.05), Vec3::new(0.1, 0.2, 0.07), turn);
    let ground = boxed(Vec3::new(0.0, 0.0, -0.7), Vec3::new(0.93, 0.93, 0.37), Mat3::IDENTITY);
    union(ground, without(without(without(walls, room), door), window))
}

fn bodies() -> Vec<(&'static str, Box<dyn StudyField>, Bounds)> {
    let cube = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    let flat = Bounds { min: Vec3::new(-1.0, -1.0, -0.5), max: Vec3::new(1.0, 1.0, 0.5) };
    let mut all: Vec<(&'static str, Box<dyn StudyField>, Bounds)> = vec![
        (
            "turned box",
            Box::new(Solids(boxed(Vec3::ZERO, Vec3::new(0.6013, 0.5217, 0.7031), turned(0.5)))),
            cube,
        ),
        ("cone", Box::new(Solids(cone(Vec3::new(0.013, 0.021, 0.71), 0.4, -0.63))), cube),
        ("20 solids", Box::new(Solids(twenty())), cube),
        ("house", Box::new(Solids(house())), flat),
    ];
    for character in TerrainCharacter::ALL {
        let name = ["hills", "cliffs", "caves"][all.len() - 4];
        let settings = isostudy_field::TerrainSettings { margin: 0.013, ..character.settings(3) };
        let terrain = Terrain::try_new(settings, flat).expect("a terrain of the study");
        all.push((name, Box::new(terrain), flat));
    }
    all
}

/// Medians over chunks of 32³ cells that have a surface, and over rounds, of what each takes.
fn in_chunks(
    name: &str,
    field: &dyn StudyField,
    grid: &BoxGrid,
    rounds: usize,
) -> Result<(), Box<dyn std::error::Error>> {
    let ids = ["dc-in-cell", "dc-clean"];
    let mut extractors = Vec::new();
    for id in ids {
        let method = presets().iter().find(|preset| preset.id == id).expect("a method of that name").method;
        extractors.push(ChunkExtractor::in_box(grid, &method, &ChunkSettings::default())?);
    }
    let mut chunk = Chunk::default();
    let (mut times, mut ratios) = ([Vec::new(), Vec::new()], Vec::new());
    for cells in extractors[0].grid(32).collect::<Vec<_>>() {
        let mut best = [f64::INFINITY; 2];
        for _ in 0..rounds.max(1) {
            for (extractor, best) in extractors.iter_mut().zip(&mut best) {
                let start = Instant::now();
                extractor.extract_into(Source::Study(field), cells, Control::default(), &mut chunk)?;
                *best = best.min(start.elapsed().as_secs_f64() * 1e3);
            }
        }
        if !chunk.triangles.is_empty() {
            ratios.push(best[1] / best[0]);
            times.iter_mut().zip(best).for_each(|(all, best)| all.push(best));
        }
    }
    let median = |of: &mut Vec<f64>| {
        of.sort_by(f64::total_cmp);
        of[of.len() / 2]
    };
    let [one, other] = &mut times;
    println!(
        "{name}, chunks of 32³: dc-in-cell {:.2} ms, dc-clean {:.2} ms, ratio {:.2}, at most {:.2}",
        median(one),
        median(other),
        median(&mut ratios),
        ratios.iter().copied().fold(0.0, f64::max)
    );
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rounds: usize = std::env::args().nth(1).map_or(Ok(5), |text| text.parse())?;
    for (name, field, bounds) in bodies() {
        let grid = BoxGrid { bounds, spacing: 0.02 };
        let field = &*field;
        let methods: Vec<Method> = METHODS
            .iter()
            .map(|id| presets().iter().find(|preset| preset.id == *id).expect("a method of that name").method)
            .collect();
        let points = IsosurfacePoints::of(field, 0.0, &grid, None, &TWO)?;
        let mut times = vec![Vec::new(); methods.len()];
        let mut extractors: Vec<Extractor> = methods.iter().map(|_| Extractor::new()).collect();
        let mut extraction = Extraction::default();
        for round in 0..=rounds {
            for (m, method) in methods.iter().enumerate() {
                let start = Instant::now();
                method.extract_into(
                    &mut extractors[m],
                    Source::Study(field),
                    &grid,
                    0.0,
                    &ONE,
                    &mut extraction,
                )?;
                if round > 0 {
                    times[m].push(start.elapsed().as_secs_f64() * 1e3);
                }
            }
        }
        in_chunks(name, field, &grid, rounds)?;
        println!("{name}, {} cells", methods[0].cells(&grid)?.iter().map(|n| u64::from(*n)).product::<u64>());
        for (m, method) in methods.iter().enumerate() {
            let mesh = method.extract(&mut extractors[m], Source::Study(field), &grid, 0.0, &TWO)?.mesh;
            let found = accuracy_beside(&points, &mesh, field, 0.0, grid.spacing, &TWO)?;
            let cells =
                |d: &Distribution| (d.mean / f64::from(grid.spacing), d.max / f64::from(grid.spacing));
            let (sharp, most_sharp) = cells(&found.sharp_edges);
            let (mean, _) = cells(&found.distance);
            let topology = topology(&mesh);
            times[m].sort_by(f64::total_cmp);
            println!(
                "  {:<12}{:>8} triangles{:>6} intersecting{:>5} non-manifold  sharp edges {sharp:.4} mean {most_sharp:.3} most  \
                 surface {mean:.4}  {:>7.1} ms",
                METHODS[m],
                mesh.triangles.len(),
                self_intersections(&mesh)?,
                topology.non_manifold_edges + topology.non_manifold_vertices,
                times[m][times[m].len() / 2],
            );
        }
    }
    Ok(())
}
