//! Continuation: the cubes it visits, the samples it takes and the mesh it makes, against brute force, against marching cubes, and against the
//! counts of Bloomenthal's program.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::survey::survey;
use glam::Vec3;
use isostudy_extract::{
    BoxGrid, Continuation, ContinuedCells, Execution, Extraction, Extractor, Method, MethodError, Seeds,
    SeedsError, Source, presets,
};
use isostudy_field::StudyField;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const ONE: Execution = Execution { threads: 1 };

/// A function in double precision that counts how often it is called.
struct Counting<F> {
    function: F,
    calls: AtomicU64,
}

impl<F: Fn([f64; 3]) -> f64> Counting<F> {
    fn new(function: F) -> Self {
        Self { function, calls: AtomicU64::new(0) }
    }

    fn calls(&self) -> u64 {
        self.calls.load(Ordering::Relaxed)
    }
}

impl<F: Fn([f64; 3]) -> f64 + Sync> StudyField for Counting<F> {
    fn sample(&self, p: Vec3) -> f32 {
        self.calls.fetch_add(1, Ordering::Relaxed);
        (self.function)(p.to_array().map(f64::from)) as f32
    }
}

fn extract(continuation: Continuation, field: &dyn StudyField, grid: &BoxGrid) -> Extraction {
    let method = Method::Continuation(continuation);
    method.extract(&mut Extractor::new(), Source::Study(field), grid, 0.0, &ONE).unwrap()
}

fn seeded(cells: ContinuedCells, points: &[[f32; 3]]) -> Continuation {
    Continuation::default().with_cells(cells).with_seeds(Seeds::try_new(points).unwrap()).with_search(8)
}

/// The generator that the GNU C library's `rand` is after `srand(1)`: additive, of 31 numbers, the first 310 left out.
struct GlibcRand {
    state: Vec<u32>,
}

impl GlibcRand {
    fn new() -> Self {
        let mut state = vec![1u32];
        for i in 1..31 {
            state.push((16_807 * u64::from(state[i - 1]) % 2_147_483_647) as u32);
        }
        for i in 31..34 {
            state.push(state[i - 31]);
        }
        let mut random = Self { state };
        for _ in 34..344 {
            random.step();
        }
        random
    }

    fn step(&mut self) -> u32 {
        let n = self.state.len();
        let next = self.state[n - 31].wrapping_add(self.state[n - 3]);
        self.state.push(next);
        next
    }

    /// From 0 to 1, with 15 bits.
    fn number(&mut self) -> f64 {
        f64::from(self.step() >> 1 & 32_767) / 32_767.0
    }
}

/// Where Bloomenthal's program begins: two points of either sign in boxes that grow, then ten halvings of the line between them. Also, how many
/// points it tried.
fn start(function: impl Fn([f64; 3]) -> f64, size: f64) -> ([f64; 3], u64) {
    let (mut random, mut tries) = (GlibcRand::new(), 0);
    let mut find = |wants_positive: bool| {
        let mut range = size;
        for _ in 0..10_000 {
            let p: [f64; 3] = std::array::from_fn(|_| range * (random.number() - 0.5));
            tries += 1;
            if (function(p) > 0.0) == wants_positive {
                return p;
            }
            range *= 1.0005;
        }
        panic!("no such point");
    };
    let (mut positive, mut negative) = (find(true), find(false));
    let middle = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
    for _ in 0..10 {
        let p = middle(positive, negative);
        if function(p) > 0.0 { positive = p } else { negative = p }
    }
    (middle(positive, negative), tries)
}

fn torus([x, y, z]: [f64; 3]) -> f64 {
    let a = x * x + y * y + z * z + 0.5 * 0.5 - 0.1 * 0.1;
    a * a - 4.0 * (0.5 * 0.5) * (y * y + z * z)
}

fn blob([x, y, z]: [f64; 3]) -> f64 {
    let pole = |x: f64, y: f64, z: f64| 1.0 / (x * x + y * y + z * z).max(1e-5);
    4.0 - pole(x + 1.0, y, z) - pole(x, y + 1.0, z) - pole(x, y, z + 1.0)
}

fn sphere([x, y, z]: [f64; 3]) -> f64 {
    x * x + y * y + z * z - 1.0
}

/// A row: field, size, bounds, then cubes, corners, tries, vertices and triangles of cubes, vertices and triangles of tetrahedra.
type Row = (fn([f64; 3]) -> f64, f64, i32, [u64; 3], [u64; 2], [u64; 2]);

/// Counts of `implicit.c` (Graphics Gems IV, 1994), compiled with the GNU C library.
const ROWS: [Row; 7] = [
    (torus, 0.05, 20, [1100, 2131, 4977], [1110, 2220], [3388, 6776]),
    (torus, 0.025, 40, [4570, 9084, 6716], [4570, 9140], [14_038, 28_076]),
    (torus, 0.0125, 80, [18_248, 36_486, 7917], [18_248, 36_496], [56_122, 112_244]),
    (blob, 0.1, 40, [1807, 3615, 2918], [1806, 3608], [5084, 10_164]),
    (sphere, 0.1, 20, [1882, 3772, 5167], [1880, 3756], [5636, 11_268]),
    (sphere, 0.05, 40, [7524, 15_056, 6624], [7522, 15_040], [22_536, 45_068]),
    (sphere, 0.025, 80, [30_162, 60_330, 8025], [30_160, 60_316], [90_218, 180_432]),
];

/// The first cube has the start in its middle. What is positive is inside here and outside there, so that a zero is on the same side.
#[test]
fn counts_are_those_of_bloomenthals_program() {
    for (function, size, bounds, [cubes, corners, tries], of_cubes, of_tetrahedra) in ROWS {
        let (start, found) = start(function, size);
        assert_eq!(found, tries, "the same random numbers");
        let start = Vec3::from_array(start.map(|c| c as f32));
        let reach = Vec3::splat((f64::from(bounds) + 0.5) as f32 * size as f32);
        let grid =
            BoxGrid { bounds: Bounds { min: start - reach, max: start + reach }, spacing: size as f32 };
        for (cells, [vertices, triangles]) in
            [(ContinuedCells::Cubes, of_cubes), (ContinuedCells::Tetrahedra, of_tetrahedra)]
        {
            let field = Counting::new(function);
            let found = extract(seeded(cells, &[start.to_array()]), &field, &grid);
            let what = format!("size {size} {cells:?}");
            assert_eq!(
                (found.counts.cells_visited, field.calls()),
                (cubes, corners),
                "{what}: cubes and corners"
            );
            let counts = found.counts;
            assert_eq!(
                (counts.vertices, counts.triangles, counts.crossings),
                (vertices, triangles, vertices),
                "{what}"
            );
            assert!(topology(&found.mesh).is_closed_manifold(), "{what}");
        }
    }
}

/// Random samples at whole coordinates, some of them on the level, as a field that counts.
struct Noise {
    counts: [usize; 3],
    values: Vec<f32>,
}

impl Noise {
    fn new(counts: [usize; 3], seed: u64, levels: i32) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut coarse = || random.random_range(-levels..=levels) as f32;
        // Two out of three samples are like the one before, so that pieces are larger than a few cells.
        let mut before = 0.0;
        let mut values = Vec::new();
        for i in 0..counts.iter().product() {
            let value = coarse();
            before = if i % 3 == 0 { value } else { before };
            values.push(before);
        }
        Self { counts, values }
    }

    fn at(&self, [x, y, z]: [usize; 3]) -> f32 {
        self.values[x + self.counts[0] * (y + self.counts[1] * z)]
    }

    fn field(&self) -> Counting<impl Fn([f64; 3]) -> f64 + Sync + '_> {
        Counting::new(|p: [f64; 3]| f64::from(self.at(p.map(|c| c.round() as usize))))
    }

    fn grid(&self) -> BoxGrid {
        let max = Vec3::from_array(self.counts.map(|n| (n - 1) as f32));
        BoxGrid { bounds: Bounds { min: Vec3::ZERO, max }, spacing: 1.0 }
    }

    fn corners([x, y, z]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
        (0..8).map(move |c| [x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)])
    }

    /// Sets of mixed cells that hang together by faces with corners on both sides: by joining, face after face.
    fn pieces(&self) -> Vec<BTreeSet<[usize; 3]>> {
        let cells = self.counts.map(|n| n - 1);
        let is_mixed = |corners: &[[usize; 3]]| {
            let inside = corners.iter().filter(|&&corner| self.at(corner) > 0.0).count();
            inside != 0 && inside != corners.len()
        };
        let mut piece_of: BTreeMap<[usize; 3], usize> = BTreeMap::new();
        for z in 0..cells[2] {
            for y in 0..cells[1] {
                for x in 0..cells[0] {
                    if is_mixed(&Self::corners([x, y, z]).collect::<Vec<_>>()) {
                        piece_of.insert([x, y, z], piece_of.len());
                    }
                }
            }
        }
        for cell in piece_of.keys().copied().collect::<Vec<_>>() {
            for axis in 0..3 {
                let mut next = cell;
                next[axis] += 1;
                let face: Vec<_> = Self::corners(cell).filter(|corner| corner[axis] == next[axis]).collect();
                if next[axis] < cells[axis] && is_mixed(&face) {
                    let (one, other) = (piece_of[&cell], piece_of[&next]);
                    piece_of.values_mut().filter(|piece| **piece == other).for_each(|piece| *piece = one);
                }
            }
        }
        let mut pieces: BTreeMap<usize, BTreeSet<[usize; 3]>> = BTreeMap::new();
        for (cell, piece) in piece_of {
            pieces.entry(piece).or_default().insert(cell);
        }
        pieces.into_values().collect()
    }
}

fn bits(points: &[Vec3]) -> Vec<[u32; 3]> {
    points.iter().map(|p| p.to_array().map(f32::to_bits)).collect()
}

/// Triangles by their places, each from its least corner on.
fn triangles(mesh: &TriangleMesh) -> Vec<[[u32; 3]; 3]> {
    let mut all: Vec<_> = mesh
        .triangles
        .iter()
        .map(|triangle| {
            let mut places = triangle.map(|v| mesh.positions[v as usize].to_array().map(f32::to_bits));
            let least = (0..3).min_by_key(|&k| places[k]).unwrap();
            places.rotate_left(least);
            places
        })
        .collect();
    all.sort_unstable();
    all
}

fn mc() -> Method {
    presets().iter().find(|preset| preset.id == "mc").unwrap().method
}

#[test]
fn a_seed_reaches_its_piece_and_no_more() {
    for (seed, counts) in [[7, 6, 5], [2, 2, 9], [9, 8, 7], [12, 3, 4]].into_iter().enumerate() {
        for levels in [1, 5] {
            let noise = Noise::new(counts, seed as u64, levels);
            let mut parts = Vec::new();
            for piece in noise.pieces() {
                let corners: BTreeSet<_> = piece.iter().flat_map(|&cell| Noise::corners(cell)).collect();
                for cell in [piece.first().unwrap(), piece.last().unwrap()] {
                    let field = noise.field();
                    let middle = cell.map(|c| c as f32 + 0.5);
                    let found = extract(seeded(ContinuedCells::Cubes, &[middle]), &field, &noise.grid());
                    let what = format!("{counts:?} {levels}");
                    assert_eq!(found.counts.cells_visited, piece.len() as u64, "{what}");
                    assert_eq!(field.calls(), corners.len() as u64, "{what}: each corner once and no other");
                    let lies_in = |p: &Vec3| {
                        piece.iter().any(|cell| {
                            (0..3).all(|k| (cell[k] as f32..=cell[k] as f32 + 1.0).contains(&p[k]))
                        })
                    };
                    assert!(found.mesh.positions.iter().all(lies_in), "{what}");
                    if cell == piece.first().unwrap() {
                        parts.extend(triangles(&found.mesh));
                    }
                }
            }
            // Together they are the whole.
            parts.sort_unstable();
            let whole =
                mc().extract(&mut Extractor::new(), Source::Study(&noise.field()), &noise.grid(), 0.0, &ONE);
            assert_eq!(parts, triangles(&whole.unwrap().mesh), "{counts:?} {levels}");
        }
    }
}

#[test]
fn with_a_seed_in_every_piece_it_is_marching_cubes_to_the_byte() {
    let all = Continuation::default().with_search(1);
    for (seed, counts) in [[7, 6, 5], [2, 2, 2], [9, 8, 7], [30, 3, 4]].into_iter().enumerate() {
        for levels in [1, 2, 9] {
            let noise = Noise::new(counts, 100 + seed as u64, levels);
            let found = extract(all, &noise.field(), &noise.grid());
            let (method, execution) = (mc(), Execution { threads: 3 });
            let whole = method
                .extract(&mut Extractor::new(), Source::Study(&noise.field()), &noise.grid(), 0.0, &execution)
                .unwrap();
            let what = format!("{counts:?} {levels}");
            assert_eq!(found.counts, whole.counts, "{what}");
            assert_eq!(found.mesh.triangles, whole.mesh.triangles, "{what}");
            assert_eq!(bits(&found.mesh.positions), bits(&whole.mesh.positions), "{what}");
            assert_eq!(bits(&found.mesh.normals), bits(&whole.mesh.normals), "{what}");
            // The same of given samples.
            let given = Method::Continuation(all)
                .extract(
                    &mut Extractor::new(),
                    Source::Samples(&noise.values),
                    &noise.grid(),
                    0.0,
                    &execution,
                )
                .unwrap();
            assert_eq!(given.mesh, found.mesh, "{what}");
        }
    }
}

/// A vertex for each crossed edge of the lattice and each crossed diagonal, and a manifold, whatever the samples.
#[test]
fn tetrahedra_have_a_vertex_on_every_crossed_edge() {
    let all = Continuation::default().with_cells(ContinuedCells::Tetrahedra).with_search(1);
    // From the corner that an edge begins at to the other.
    let edges: [[i32; 3]; 7] =
        [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 1, 0], [-1, 0, 1], [0, -1, 1], [-1, -1, 1]];
    for (seed, counts) in [[7, 6, 5], [2, 2, 2], [9, 8, 7], [30, 3, 4]].into_iter().enumerate() {
        let noise = Noise::new(counts, 200 + seed as u64, 2);
        let found = extract(all, &noise.field(), &noise.grid());
        let mut crossed = 0;
        for i in 0..counts.iter().product::<usize>() {
            let place = [i % counts[0], i / counts[0] % counts[1], i / counts[0] / counts[1]];
            for edge in edges {
                let there = [0, 1, 2].map(|k| place[k] as i32 + edge[k]);
                if (0..3).all(|k| (0..counts[k] as i32).contains(&there[k])) {
                    let there = there.map(|c| c as usize);
                    crossed += u64::from((noise.at(place) > 0.0) != (noise.at(there) > 0.0));
                }
            }
        }
        assert_eq!((found.counts.vertices, found.counts.crossings), (crossed, crossed), "{counts:?}");
        survey(found.mesh.positions.len(), &found.mesh.triangles)
            .unwrap_or_else(|fault| panic!("{counts:?}: {fault}"));
    }
}

fn ball(centre: [f64; 3], radius: f64) -> impl Fn([f64; 3]) -> f64 {
    move |p| radius - (0..3).map(|k| (p[k] - centre[k]).powi(2)).sum::<f64>().sqrt()
}

const GRID: BoxGrid = BoxGrid { bounds: Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }, spacing: 2.0 / 64.0 };

#[test]
fn triangles_face_outward_and_enclose_the_ball() {
    for cells in [ContinuedCells::Cubes, ContinuedCells::Tetrahedra] {
        let field = Counting::new(ball([0.05, -0.1, 0.02], 0.7));
        let found = extract(Continuation::default().with_cells(cells), &field, &GRID);
        assert!(topology(&found.mesh).is_closed_manifold());
        let expected = 4.0 / 3.0 * std::f64::consts::PI * 0.7f64.powi(3);
        assert!((found.mesh.volume() / expected - 1.0).abs() < 2e-3, "{cells:?}: {}", found.mesh.volume());
        let outward = found.mesh.positions.iter().zip(&found.mesh.normals);
        assert!(
            outward.into_iter().all(|(p, n)| (*p - Vec3::new(0.05, -0.1, 0.02)).normalize().dot(*n) > 0.99)
        );
        // Few samples: all would be 65^3.
        let each = field.calls() as f64 / found.counts.vertices as f64;
        assert!(each < 2.5, "{cells:?}: {each} samples for each vertex");
    }
}

/// What continuation is known for: a piece without a seed is missing.
#[test]
fn a_second_piece_needs_a_seed_of_its_own() {
    let both = |p: [f64; 3]| ball([-0.5, 0.0, 0.0], 0.3)(p).max(ball([0.5, 0.1, 0.0], 0.3)(p));
    let field = Counting::new(both);
    let pieces = |continuation| topology(&extract(continuation, &field, &GRID).mesh).components;
    let cubes = ContinuedCells::Cubes;
    // The first is in a ball, the second outside both and near one.
    assert_eq!(pieces(seeded(cubes, &[[-0.5, 0.0, 0.0]])), 1);
    assert_eq!(pieces(seeded(cubes, &[[0.9, 0.1, 0.0]])), 1);
    assert_eq!(pieces(seeded(cubes, &[[-0.5, 0.0, 0.0], [0.5, 0.1, 0.0]])), 2);
    assert_eq!(pieces(seeded(cubes, &[[-0.5, 0.0, 0.0], [-0.4, 0.1, 0.0], [9.0, 0.0, 0.0]])), 2);
    assert_eq!(pieces(Continuation::default()), 2);
    // From a corner of the box no line meets a ball.
    assert_eq!(pieces(seeded(cubes, &[[-1.0; 3]])), 0);
}

/// No line of the first search goes through a ball as small as a cell; half as far apart, one does.
#[test]
fn a_search_goes_on_until_it_finds_something() {
    for centre in [[0.3, -0.4, 0.1], [0.99, 0.98, -0.97], [-0.61, 0.47, 0.83]] {
        let field = Counting::new(ball(centre, 0.03));
        let found = extract(Continuation::default().with_search(32), &field, &GRID);
        assert!(found.counts.triangles > 0, "{centre:?}");
    }
    let nothing = extract(Continuation::default().with_search(32), &Counting::new(|_| -1.0), &GRID);
    assert_eq!((nothing.counts.vertices, nothing.counts.cells_visited), (0, 0));
}

#[test]
fn what_cannot_be_is_refused() {
    assert_eq!(Seeds::try_new(&[[0.0; 3]; 9]), Err(SeedsError { count: 9, is_finite: true }));
    let error = Seeds::try_new(&[[0.0, f32::NAN, 0.0]]).unwrap_err();
    assert!(
        error.to_string().contains("not all finite") && error.to_string().contains("at most 8"),
        "{error}"
    );
    let method = Method::Continuation(Continuation::default().with_search(0));
    let error = method.check(&GRID).unwrap_err();
    assert!(matches!(error, MethodError::Setting { key: "search", .. }));
    assert_eq!(error.to_string(), "search = 0: must be 1 or more, cells");
    assert_eq!(Seeds::try_new(&[[1.0; 3], [2.0; 3]]).unwrap().points(), [[1.0; 3], [2.0; 3]]);
}
