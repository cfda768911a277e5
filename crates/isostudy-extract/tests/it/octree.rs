//! Dual contouring with a tolerance: few triangles where the surface is flat, none of its topology lost, and errors within bounds.

use glam::{Mat3, Vec3};
use isostudy_extract::{
    BoxGrid, ChunkError, ChunkExtractor, ChunkSettings, DualContouring, Execution, Extraction, Extractor,
    Method, MethodError, Source,
};
use isostudy_field::StudyField;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const ONE: Execution = Execution { threads: 1 };

/// A value with its gradient.
struct Known<F>(F);

impl<F: Fn(Vec3) -> (f32, Vec3) + Sync> StudyField for Known<F> {
    fn sample(&self, p: Vec3) -> f32 {
        (self.0)(p).0
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        Some((self.0)(p).1)
    }
}

/// Its gradient is not known.
struct Formula<F>(F);

impl<F: Fn(Vec3) -> f32 + Sync> StudyField for Formula<F> {
    fn sample(&self, p: Vec3) -> f32 {
        (self.0)(p)
    }
}

fn sphere(radius: f32) -> impl StudyField {
    Known(move |p: Vec3| (radius - p.length(), -p.normalize_or_zero()))
}

/// A box of so large half sides, turned.
fn boxed(half: Vec3, turn: Mat3) -> impl StudyField {
    Known(move |p: Vec3| {
        let q = turn.transpose() * p;
        let side = |axis: Vec3| (half.dot(axis) - q.dot(axis).abs(), turn * axis * -q.dot(axis).signum());
        [Vec3::X, Vec3::Y, Vec3::Z].map(side).into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    })
}

fn torus(p: Vec3) -> f32 {
    0.2013 - Vec3::new(p.truncate().length() - 0.5, p.z, 0.0).length()
}

/// From -1 to 1 along each axis, with so many cells.
fn grid(cells: u32) -> BoxGrid {
    BoxGrid { bounds: Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }, spacing: 2.0 / cells as f32 }
}

fn method(patches: bool, tolerance: f32) -> Method {
    Method::DualContouring(DualContouring::default().with_patches(patches).with_tolerance(tolerance))
}

fn extraction(method: Method, field: &dyn StudyField, cells: u32) -> Extraction {
    method.extract(&mut Extractor::new(), Source::Study(field), &grid(cells), 0.0, &ONE).unwrap()
}

fn mesh(method: Method, field: &dyn StudyField, cells: u32) -> TriangleMesh {
    extraction(method, field, cells).mesh
}

fn area(mesh: &TriangleMesh) -> f64 {
    let doubled = |t| {
        let [a, b, c] = mesh.corners(t).map(|p| p.as_dvec3());
        (b - a).cross(c - a).length()
    };
    (0..mesh.triangles.len()).map(doubled).sum::<f64>() / 2.0
}

/// The farthest of a grid of points in each triangle, by a distance; in cells.
fn farthest(mesh: &TriangleMesh, cells: u32, distance: impl Fn(Vec3) -> f32) -> f32 {
    let points = (0..mesh.triangles.len()).flat_map(|t| {
        let [a, b, c] = mesh.corners(t);
        (0..=6).flat_map(move |i| {
            (0..=6 - i).map(move |j| a + (b - a) * (i as f32 / 6.0) + (c - a) * (j as f32 / 6.0))
        })
    });
    points.map(|p| distance(p).abs()).fold(0.0, f32::max) * cells as f32 / 2.0
}

/// Sides of a box become few triangles that fill them without a fold, its edges and corners stay.
#[test]
fn boxes_become_few_triangles() {
    let half = Vec3::new(0.6013, 0.5217, 0.7031);
    let wanted_area = 8.0 * f64::from(half.x * half.y + half.y * half.z + half.z * half.x);
    for turn in [Mat3::IDENTITY, Mat3::from_rotation_z(0.3) * Mat3::from_rotation_x(0.7)] {
        let field = boxed(half, turn);
        let distance = |p: Vec3| {
            let q = (turn.transpose() * p).abs() - half;
            q.max(Vec3::ZERO).length() + q.max_element().min(0.0)
        };
        let uniform = mesh(method(true, 0.0), &field, 64);
        let made = mesh(method(true, 0.01), &field, 64);
        let found = topology(&made);
        assert!(found.is_closed_manifold() && found.euler_characteristic == 2 && found.unused_vertices == 0);
        let share = made.triangles.len() as f64 / uniform.triangles.len() as f64;
        assert!(
            share < if turn == Mat3::IDENTITY { 0.001 } else { 0.1 },
            "{} of {}",
            made.triangles.len(),
            uniform.triangles.len()
        );
        let off = farthest(&made, 64, distance);
        assert!(off < 0.02, "{off} cells");
        assert!((area(&made) / wanted_area - 1.0).abs() < 1e-6, "{} {wanted_area}", area(&made));
        for c in 0..8 {
            let side = |axis: usize| if c >> axis & 1 != 0 { half[axis] } else { -half[axis] };
            let corner = turn * Vec3::new(side(0), side(1), side(2));
            let missed = made.positions.iter().map(|p| p.distance(corner)).fold(9.0, f32::min) * 32.0;
            assert!(missed < 0.005, "{corner}: {missed} cells");
        }
    }
}

/// The bound is on vertices and tangent planes, and the triangles between them keep to it but for a little.
#[test]
fn spheres_stay_within_the_tolerance() {
    let field = sphere(0.8013);
    let mut before = mesh(method(true, 0.0), &field, 64).triangles.len();
    for tolerance in [0.05, 0.15] {
        let made = mesh(method(true, tolerance), &field, 64);
        let found = topology(&made);
        assert!(found.is_closed_manifold() && found.euler_characteristic == 2);
        let off = farthest(&made, 64, |p| p.length() - 0.8013);
        assert!(off < 1.5 * tolerance, "{tolerance}: {off} cells");
        assert!((made.triangles.len() as f64) < 0.4 * before as f64, "{} {before}", made.triangles.len());
        before = made.triangles.len();
    }
}

/// Without any bound on the error only topology stops cells from becoming one: it is that of the uniform net, component by component.
#[test]
fn topology_is_that_of_the_uniform_net() {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let mut waves = || -> Vec<(Vec3, f32)> {
        let mut number = || random.random::<f32>() * 2.0 - 1.0;
        (0..12).map(|_| (Vec3::new(number(), number(), number()) * 9.0, number() * 3.0)).collect()
    };
    let mut fields: Vec<(String, Box<dyn StudyField>, u32)> = vec![
        ("torus".into(), Box::new(Formula(torus)), 48),
        ("two sheets".into(), Box::new(Formula(|p: Vec3| 0.031 - (p.length() - 0.7).abs())), 48),
    ];
    for number in 0..12 {
        let waves = waves();
        let sum = move |p: Vec3| {
            let all: f32 = waves.iter().map(|(k, phase)| (k.dot(p) + phase).sin()).sum();
            (0.3 * all).min(0.9017 - p.length())
        };
        fields.push((format!("waves {number}"), Box::new(Formula(sum)), 24 + number));
    }
    for seed in 0..6 {
        // White noise on the points of the grid, blended between.
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let samples: Vec<f32> =
            (0..17 * 17 * 17).map(|_| random.random::<f32>() - 0.5 - 0.03 * seed as f32).collect();
        let noise = move |p: Vec3| {
            let q = ((p + 1.0) * 8.0).clamp(Vec3::ZERO, Vec3::splat(16.0));
            let low = q.floor().min(Vec3::splat(15.0));
            let t = q - low;
            let mut sum = 0.0;
            for c in 0..8 {
                let side = [c & 1, c >> 1 & 1, c >> 2];
                let at = [0, 1, 2].map(|axis| low[axis] as usize + side[axis]);
                let is_off = at.iter().all(|i| (1..16).contains(i));
                let value = if is_off { samples[(at[2] * 17 + at[1]) * 17 + at[0]] } else { -1.0 };
                let share = |axis: usize| if side[axis] == 1 { t[axis] } else { 1.0 - t[axis] };
                sum += value * share(0) * share(1) * share(2);
            }
            sum
        };
        fields.push((format!("noise {seed}"), Box::new(Formula(noise)), 16));
    }
    let mut merged = 0;
    for (name, field, cells) in &fields {
        for patches in [false, true] {
            let uniform = mesh(method(patches, 0.0), field, *cells);
            let made = extraction(method(patches, f32::INFINITY), field, *cells);
            let [uniform, found] = [&uniform, &made.mesh].map(topology);
            assert_eq!(found.boundary_edges, 0, "{name}");
            assert_eq!(
                (
                    found.euler_characteristic,
                    found.components,
                    found.non_manifold_edges,
                    found.non_manifold_vertices
                ),
                (
                    uniform.euler_characteristic,
                    uniform.components,
                    uniform.non_manifold_edges,
                    uniform.non_manifold_vertices
                ),
                "{name} {patches}"
            );
            assert!(!patches || found.is_closed_manifold(), "{name}: {found:?}");
            assert_eq!(
                (found.misoriented_edges, found.duplicate_faces, found.unused_vertices),
                (0, 0, 0),
                "{name}"
            );
            let counts = made.counts;
            assert_eq!(counts.triangles + counts.discarded_triangles, uniform.triangles);
            assert_eq!(counts.triangles, made.mesh.triangles.len() as u64);
            merged += usize::from(counts.discarded_triangles * 3 > uniform.triangles);
        }
    }
    assert!(merged > fields.len(), "{merged}");
}

/// Where the surface runs into the box, cells there stay as they are, and so does the rim of the mesh.
#[test]
fn the_rim_at_the_box_stays() {
    let field = Known(|p: Vec3| (0.0137 - p.z + 0.11 * p.x, Vec3::new(0.11, 0.0, -1.0)));
    let rim = |mesh: &TriangleMesh| {
        let is_at_rim = |p: &&Vec3| p.x.abs().max(p.y.abs()) > 1.0 - 2.0 / 64.0;
        let mut rim: Vec<[u32; 3]> =
            mesh.positions.iter().filter(is_at_rim).map(|p| p.to_array().map(f32::to_bits)).collect();
        rim.sort_unstable();
        rim
    };
    let [uniform, made] = [0.0, 0.01].map(|tolerance| mesh(method(true, tolerance), &field, 64));
    assert_eq!(rim(&made), rim(&uniform));
    assert!(made.triangles.len() * 5 < uniform.triangles.len(), "{}", made.triangles.len());
    let [a, b] = [&uniform, &made].map(topology);
    assert_eq!((a.euler_characteristic, a.boundary_edges), (b.euler_characteristic, b.boundary_edges));
    assert!((area(&made) / area(&uniform) - 1.0).abs() < 1e-4);
}

#[test]
fn threads_do_not_show_and_chunks_are_refused() {
    for tolerance in [0.0, 0.05] {
        let method = method(false, tolerance);
        let whole = mesh(method, &Formula(torus), 50);
        for threads in [2, 3, 5] {
            let field = Formula(torus);
            let source = Source::Study(&field);
            let other = method.extract(&mut Extractor::new(), source, &grid(50), 0.0, &Execution { threads });
            assert_eq!(other.unwrap().mesh, whole, "{threads}");
        }
        let chunks = ChunkExtractor::in_box(&grid(50), &method, &ChunkSettings::default());
        assert_eq!(chunks.err(), (tolerance > 0.0).then_some(ChunkError::Method), "{tolerance}");
    }
    for tolerance in [-0.1, f32::NAN] {
        let error = method(false, tolerance).check(&grid(8)).unwrap_err();
        assert!(matches!(error, MethodError::Setting { key: "tolerance", .. }));
        assert!(error.to_string().contains("must be 0 or more"), "{error}");
    }
}
