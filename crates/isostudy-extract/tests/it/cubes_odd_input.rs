//! Samples that nobody wants, to every method of cubes: a mesh with a meaning, or an error.

use std::collections::HashMap;

use glam::Vec3;
use isostudy_extract::{
    BoxGrid, Cubes, Diagonals, Execution, Extractor, Faces, Flat, Macet, Method, SnapCubes, Source, presets,
};
use isostudy_field::StudyField;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};

const ONE: Execution = Execution { threads: 1 };

/// Every choice of cubes, some distances to snap from, and turned edges.
fn methods() -> Vec<Method> {
    let mut all = Vec::new();
    for faces in [Faces::SeparateInside, Faces::JoinInside, Faces::Decider, Faces::Trilinear] {
        for diagonals in [Diagonals::Fan, Diagonals::EdgeGroups, Diagonals::Quality] {
            all.push(Method::Cubes(Cubes::default().with_faces(faces).with_diagonals(diagonals)));
            all.push(Method::Macet(Macet::default().with_faces(faces).with_diagonals(diagonals)));
        }
    }
    for gamma in [0.0, 0.3, 0.5] {
        all.extend(
            [Flat::Both, Flat::Neither]
                .map(|flat| Method::SnapCubes(SnapCubes::default().with_gamma(gamma).with_flat(flat))),
        );
    }
    all
}

/// Samples as a field at whole coordinates, trilinear nowhere: between samples it has the nearest one's value.
struct Given {
    counts: [usize; 3],
    values: Vec<f32>,
}

impl StudyField for Given {
    fn sample(&self, p: Vec3) -> f32 {
        let nearest = |axis: usize| (p[axis].round().max(0.0) as usize).min(self.counts[axis] - 1);
        self.values[(nearest(2) * self.counts[1] + nearest(1)) * self.counts[0] + nearest(0)]
    }
}

fn grid(counts: [usize; 3]) -> BoxGrid {
    let max = Vec3::from_array(counts.map(|n| (n - 1) as f32));
    BoxGrid { bounds: Bounds { min: Vec3::ZERO, max }, spacing: 1.0 }
}

fn mesh_of(method: &Method, counts: [usize; 3], values: &[f32], isovalue: f32) -> TriangleMesh {
    let field = Given { counts, values: values.to_vec() };
    let source = Source::Study(&field);
    let mesh = method.extract(&mut Extractor::new(), source, &grid(counts), isovalue, &ONE).unwrap().mesh;
    if method.promises().samples_suffice {
        let source = Source::Samples(values);
        let given =
            method.extract(&mut Extractor::new(), source, &grid(counts), isovalue, &ONE).unwrap().mesh;
        assert!(given.triangles == mesh.triangles && given.positions == mesh.positions, "{method:?}");
    }
    mesh
}

/// Vertices are finite and in the box; every side off the box is run as often both ways; manifolds where they are promised.
fn check(method: &Method, counts: [usize; 3], mesh: &TriangleMesh, what: &str) {
    let max = Vec3::from_array(counts.map(|n| (n - 1) as f32));
    let is_in = |p: &Vec3| p.is_finite() && p.cmpge(Vec3::ZERO).all() && p.cmple(max).all();
    assert!(mesh.positions.iter().all(is_in), "{what} {method:?}");
    assert!(mesh.normals.iter().all(|normal| normal.is_finite()), "{what} {method:?}");
    let mut sides: HashMap<[u32; 2], i64> = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *sides.entry([from.min(to), from.max(to)]).or_insert(0) += if from < to { 1 } else { -1 };
        }
    }
    let near_box = |v: u32| {
        let p = mesh.positions[v as usize];
        (0..3).any(|axis| p[axis] <= 0.5 || p[axis] >= max[axis] - 0.5)
    };
    let is_even = |(side, sum): (&[u32; 2], &i64)| *sum == 0 || side.iter().all(|&v| near_box(v));
    assert!(sides.iter().all(is_even), "{what} {method:?}");
    if method.promises().manifold {
        let report = topology(mesh);
        let faults = [
            report.non_manifold_edges,
            report.misoriented_edges,
            report.non_manifold_vertices,
            report.duplicate_faces,
            report.collapsed_triangles,
            report.unused_vertices,
        ];
        assert_eq!(faults, [0; 6], "{what} {method:?}");
    }
}

#[test]
fn no_sample_is_on_both_sides() {
    for method in methods() {
        for value in [0.0, -0.0, 1.0, -1.0, f32::MAX, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for counts in [[2, 2, 2], [4, 3, 5]] {
                let values = vec![value; counts.iter().product()];
                let mesh = mesh_of(&method, counts, &values, 0.0);
                assert!(mesh.triangles.is_empty() && mesh.positions.is_empty(), "{method:?} {value}");
            }
        }
    }
}

/// A block with odd samples in its middle: those that are no number, or below all numbers, are bubbles; infinite ones are inside.
#[test]
fn samples_that_are_no_numbers() {
    let counts = [7, 7, 7];
    let block = |odd: f32| -> Vec<f32> {
        let place = |i: usize| [i % 7, i / 7 % 7, i / 49];
        let value = |p: [usize; 3]| match p {
            [3, 3, 3] => odd,
            _ if p.iter().all(|x| (1..6).contains(x)) => 1.0,
            _ => -1.0,
        };
        (0..343).map(|i| value(place(i))).collect()
    };
    for method in methods() {
        let pieces = |odd: f32| {
            let mesh = mesh_of(&method, counts, &block(odd), 0.0);
            check(&method, counts, &mesh, &odd.to_string());
            topology(&mesh).components
        };
        assert_eq!([1.0, f32::INFINITY, f32::MAX].map(pieces), [1; 3], "{method:?}");
        let bubbles = [f32::NAN, f32::NEG_INFINITY, f32::MIN].map(pieces);
        // A bubble round a sample that others are drawn to has no room.
        let is_snapped = matches!(method, Method::SnapCubes(_));
        assert!(is_snapped || bubbles == [2; 3], "{method:?}: {bubbles:?}");
    }
}

/// Cells whose saddles lie on the level: of a face, of all faces, of the cell; and samples that do.
#[test]
fn singular_cells() {
    let saddles: [[f32; 8]; 6] = [
        [1.0, -1.0, -1.0, 1.0, -1.0, -1.0, -1.0, -1.0],
        [1.0, -1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0],
        [2.0, -1.0, -1.0, 0.5, -1.0, 3.0, 3.0, -9.0],
        [1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0],
        [3.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, 3.0],
    ];
    for method in methods() {
        for cell in saddles {
            for sign in [1.0, -1.0] {
                // Alone, and beside its mirror images, so that every face has a neighbour.
                let alone = cell.map(|value| sign * value);
                check(&method, [2; 3], &mesh_of(&method, [2; 3], &alone, 0.0), "alone");
                let counts = [5, 5, 5];
                let fold = |x: usize| x % 2;
                let all: Vec<f32> =
                    (0..125).map(|i| alone[fold(i % 5) + 2 * fold(i / 5 % 5) + 4 * fold(i / 25)]).collect();
                check(&method, counts, &mesh_of(&method, counts, &all, 0.0), "mirrored");
            }
        }
    }
}

/// A plateau at the level between inside and outside, and samples of the whole range of numbers.
#[test]
fn plateaus_and_the_ends_of_the_numbers() {
    let counts = [5, 6, 6];
    let slab = |levels: [f32; 6]| -> Vec<f32> { (0..180).map(|i| levels[i / 30]).collect() };
    let tiny = f32::from_bits(1);
    for method in methods() {
        for levels in [
            [-1.0, -1.0, 0.0, 0.0, 1.0, 1.0],
            [-1.0, 0.0, -1.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            [f32::MIN, f32::MAX, f32::MIN, tiny, -tiny, tiny],
            [f32::NEG_INFINITY, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 1.0, -1.0],
        ] {
            let mesh = mesh_of(&method, counts, &slab(levels), 0.0);
            check(&method, counts, &mesh, &format!("{levels:?}"));
            assert!(!mesh.triangles.is_empty(), "{levels:?} {method:?}");
        }
    }
}

/// What is too large is refused by all alike, before anything is reserved.
#[test]
fn more_cells_than_there_can_be() {
    for side in [1291.0, 1e5, 1e9, 1e30] {
        let grid = BoxGrid { bounds: Bounds { min: Vec3::ZERO, max: Vec3::splat(side) }, spacing: 1.0 };
        let simple = presets().iter().find(|preset| preset.id == "su").expect("a preset");
        for method in methods() {
            assert_eq!(method.check(&grid), simple.method.check(&grid), "{side} {method:?}");
            assert_eq!(method.memory_bytes(&grid, &ONE).is_ok(), method.check(&grid).is_ok());
        }
    }
}
