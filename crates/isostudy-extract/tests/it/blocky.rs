//! Blocks: squares and rectangles against brute force over the samples.

use glam::Vec3;
use isostudy_extract::{Blocky, BoxGrid, Execution, Extractor, Method, Source, presets};
use isostudy_field::{Gyroid, StudyField};
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::collections::{BTreeMap, BTreeSet};

const SINGLE: Method = Method::Blocky(Blocky::new().with_merged(false));
const MERGED: Method = Method::Blocky(Blocky::new().with_merged(true));

/// A square: its axis, the way it faces, its plane, row and place in the row.
type Square = (usize, bool, usize, usize, usize);

/// Samples with steps of 1, x fastest; those at the box are outside.
struct Samples {
    size: [usize; 3],
    values: Vec<f32>,
}

impl Samples {
    fn of(size: [usize; 3], mut value: impl FnMut([usize; 3]) -> f32) -> Self {
        let count = size.iter().product();
        let place = |i: usize| [i % size[0], i / size[0] % size[1], i / size[0] / size[1]];
        let at_box = |p: [usize; 3]| (0..3).any(|axis| p[axis] == 0 || p[axis] + 1 == size[axis]);
        let values = (0..count).map(place).map(|p| if at_box(p) { -1.0 } else { value(p) }).collect();
        Self { size, values }
    }

    fn noise(size: [usize; 3], share: f32, seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        Self::of(size, |_| share - random.random::<f32>())
    }

    fn is_inside(&self, [x, y, z]: [usize; 3]) -> bool {
        self.values[(z * self.size[1] + y) * self.size[0] + x] > 0.0
    }

    fn mesh(&self, method: &Method) -> TriangleMesh {
        let max = Vec3::from_array(self.size.map(|n| (n - 1) as f32));
        let grid = BoxGrid { bounds: Bounds { min: Vec3::ZERO, max }, spacing: 1.0 };
        let source = Source::Samples(&self.values);
        let (mut extractor, execution) = (Extractor::new(), Execution { threads: 1 });
        method.extract(&mut extractor, source, &grid, 0.0, &execution).unwrap().mesh
    }

    /// Between which neighbours there is a square, by brute force.
    fn squares(&self) -> BTreeSet<Square> {
        let [nx, ny, nz] = self.size;
        let mut found = BTreeSet::new();
        for (x, y, z) in (0..nx * ny * nz).map(|i| (i % nx, i / nx % ny, i / nx / ny)) {
            let from = [x, y, z];
            for axis in 0..3 {
                let mut to = from;
                to[axis] += 1;
                if to[axis] < self.size[axis] && self.is_inside(from) != self.is_inside(to) {
                    let [u, v] = [from[(axis + 1) % 3], from[(axis + 2) % 3]];
                    found.insert((axis, self.is_inside(from), from[axis], v, u));
                }
            }
        }
        found
    }
}

/// The squares that the triangles of a mesh cover, each how often; in pairs, as rectangles along the lattice.
fn covered(mesh: &TriangleMesh) -> BTreeMap<Square, u32> {
    let mut found = BTreeMap::new();
    for pair in mesh.triangles.chunks(2) {
        let corners = pair.iter().flatten().map(|&v| mesh.positions[v as usize]);
        let low = corners.clone().reduce(Vec3::min).unwrap().to_array();
        let high = corners.reduce(Vec3::max).unwrap().to_array();
        let axis = (0..3).find(|&axis| low[axis] == high[axis]).expect("squares lie across an axis");
        let normals = pair.iter().map(|t| {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
            (b - a).cross(c - a)
        });
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let area: f32 = normals.clone().map(|normal| normal.length() / 2.0).sum();
        assert_eq!(area, (high[u] - low[u]) * (high[v] - low[v]), "two halves of a rectangle");
        let ways: BTreeSet<bool> = normals.map(|normal| normal[axis] > 0.0).collect();
        assert_eq!(ways.len(), 1);
        let leads_out = ways.contains(&true);
        // Corners are half way between samples.
        let range = |axis: usize| (low[axis] + 0.5) as usize..(high[axis] + 0.5) as usize;
        for row in range(v) {
            for place in range(u) {
                let plane = (low[axis] - 0.5) as usize;
                *found.entry((axis, leads_out, plane, row, place)).or_insert(0) += 1;
            }
        }
    }
    found
}

/// How many rectangles greedy meshing makes of squares, plane by plane over masks.
fn greedy(squares: &BTreeSet<Square>) -> usize {
    let mut left = squares.clone();
    let mut count = 0;
    while let Some((axis, way, plane, row, place)) = left.pop_first() {
        count += 1;
        let mut end = place + 1;
        while left.remove(&(axis, way, plane, row, end)) {
            end += 1;
        }
        let mut above = row + 1;
        while (place..end).all(|place| left.contains(&(axis, way, plane, above, place))) {
            (place..end).for_each(|place| assert!(left.remove(&(axis, way, plane, above, place))));
            above += 1;
        }
    }
    count
}

/// White noise and larger shapes, of unequal sides.
fn many() -> Vec<Samples> {
    let mut all: Vec<Samples> =
        (0..40).map(|seed| Samples::noise([9, 7, 11], 0.1 + 0.02 * seed as f32, seed)).collect();
    all.push(Samples::of([20, 21, 22], |p| 64.0 - p.map(|i| (i as f32 - 10.0).powi(2)).iter().sum::<f32>()));
    all.push(Samples::of([70, 9, 8], |[x, ..]| if x % 3 == 0 { -1.0 } else { 1.0 }));
    all
}

#[test]
fn there_is_a_square_between_every_two_neighbours_on_different_sides() {
    for samples in many() {
        let mesh = samples.mesh(&SINGLE);
        let squares = samples.squares();
        assert_eq!(mesh.triangles.len(), 2 * squares.len());
        assert_eq!(covered(&mesh), squares.iter().map(|&square| (square, 1)).collect());
        assert_eq!(topology(&mesh).boundary_edges, 0);
    }
}

#[test]
fn rectangles_cover_the_same_squares_once() {
    for samples in many() {
        let (mesh, squares) = (samples.mesh(&MERGED), samples.squares());
        assert_eq!(covered(&mesh), squares.iter().map(|&square| (square, 1)).collect());
        assert_eq!(mesh.triangles.len(), 2 * greedy(&squares));
        let used: BTreeSet<u32> = mesh.triangles.iter().flatten().copied().collect();
        assert_eq!(used.len(), mesh.positions.len());
        assert_eq!(mesh.normals.len(), mesh.positions.len());
    }
}

#[test]
fn the_volume_is_that_of_the_blocks() {
    for samples in many() {
        let blocks = samples.values.iter().filter(|&&value| value > 0.0).count() as f64;
        for method in [SINGLE, MERGED] {
            assert!((samples.mesh(&method).volume() - blocks).abs() < 1e-6 * blocks.max(1.0));
        }
    }
}

/// Of any size, a box is twelve triangles.
#[test]
fn a_box_is_six_rectangles() {
    for size in [3, 5, 40] {
        let mesh = Samples::of([size; 3], |_| 1.0).mesh(&MERGED);
        assert_eq!((mesh.triangles.len(), mesh.positions.len()), (12, 8));
        assert_eq!(topology(&mesh).boundary_edges, 0);
    }
}

#[test]
fn the_field_and_any_number_of_threads_give_the_same_mesh() {
    let gyroid: &dyn StudyField = &Gyroid::default();
    let grid = BoxGrid { bounds: Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) }, spacing: 0.05 };
    for preset in presets().iter().filter(|preset| preset.id.starts_with("blocky")) {
        let mesh = |threads| {
            let execution = Execution { threads };
            preset.method.extract(&mut Extractor::new(), gyroid.into(), &grid, 0.0, &execution).unwrap().mesh
        };
        let one = mesh(1);
        assert!(one.triangles.len() > 1000);
        for threads in [2, 3] {
            let more = mesh(threads);
            assert_eq!((&one.positions, &one.triangles), (&more.positions, &more.triangles), "{}", preset.id);
        }
    }
}
