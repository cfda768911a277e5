//! Dual contouring without intersections: none by a counter that shares no code with ours, and edges and corners that are kept.

use std::collections::HashMap;
use std::io::Write;
use std::process::{Command, Stdio};

use glam::{DVec3, Mat3, Vec3};
use isostudy_extract::{
    BoxGrid, ChunkExtractor, ChunkSettings, Control, DualContouring, Execution, Extractor, Method, Source,
    presets,
};
use isostudy_field::StudyField;
use isostudy_mesh::metro::Surface;
use isostudy_mesh::{Bounds, TriangleMesh, self_intersections};

use crate::fields::Numbers;

/// The lesser of two sums of waves, some of them about as long as a cell: corners and creases in most cells.
struct Waves([[(Vec3, f32); 5]; 2]);

impl Waves {
    fn random(seed: u64) -> Self {
        let mut numbers = Numbers::new(seed);
        let mut of = |most: f32| (numbers.below(2_000_001) as f32 / 1e6 - 1.0) * most;
        Self([(); 2].map(|()| [(); 5].map(|()| (Vec3::new(of(2.0), of(2.0), of(2.0)), of(3.2)))))
    }
}

impl StudyField for Waves {
    fn sample(&self, p: Vec3) -> f32 {
        let sums =
            self.0.map(|waves| waves.iter().map(|(wave, phase)| (wave.dot(p) + phase).sin()).sum::<f32>());
        sums[0].min(sums[1] + 0.7)
    }
}

fn named(id: &str) -> Method {
    presets().iter().find(|preset| preset.id == id).expect("a method of that name").method
}

fn extracted(method: &Method, field: &dyn StudyField, grid: &BoxGrid) -> TriangleMesh {
    let (mut extractor, one) = (Extractor::new(), Execution { threads: 1 });
    method.extract(&mut extractor, Source::Study(field), grid, 0.0, &one).unwrap().mesh
}

/// By brute force and rational numbers, in Python; `None` where there is no Python.
fn counted_elsewhere(meshes: &[TriangleMesh]) -> Option<Vec<u64>> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/clean/brute_force.py");
    let mut python = Command::new("python3");
    let spawned = python.arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
    let Ok(mut running) = spawned else {
        eprintln!("SKIPPED: NO PYTHON - intersections were not counted elsewhere");
        return None;
    };
    let mut input = running.stdin.take().unwrap();
    let writer = std::thread::scope(|scope| {
        scope.spawn(move || {
            for mesh in meshes {
                let positions: Vec<_> = mesh.positions.iter().map(|p| p.as_dvec3().to_array()).collect();
                writeln!(input, "{{\"positions\": {positions:?}, \"triangles\": {:?}}}", mesh.triangles)
                    .unwrap();
            }
        });
        running.wait_with_output().unwrap()
    });
    assert!(writer.status.success());
    Some(String::from_utf8(writer.stdout).unwrap().lines().map(|line| line.parse().unwrap()).collect())
}

/// So many small meshes of noise by each of three methods.
fn a_counter_of_its_own_agrees(seeds: u64) {
    let methods = ["dc", "dc-in-cell", "dc-clean"].map(named);
    let bounds = Bounds { min: Vec3::ZERO, max: Vec3::splat(4.0) };
    let mut meshes = Vec::new();
    for seed in 0..seeds {
        let field = Waves::random(seed);
        for method in &methods {
            meshes.push(extracted(method, &field, &BoxGrid { bounds, spacing: 1.0 }));
        }
    }
    let Some(elsewhere) = counted_elsewhere(&meshes) else { return };
    assert_eq!(elsewhere.len(), meshes.len());
    let mut with_some = [0; 3];
    for (i, (mesh, elsewhere)) in meshes.iter().zip(elsewhere).enumerate() {
        let ours = if mesh.triangles.is_empty() { 0 } else { self_intersections(mesh).unwrap() };
        assert_eq!(ours, elsewhere, "{:?} of seed {}", methods[i % 3], i / 3);
        with_some[i % 3] += usize::from(elsewhere > 0);
    }
    assert_eq!(with_some[2], 0, "dc-clean");
    assert!(with_some[0] > 0 && with_some[1] > 0, "{with_some:?}: otherwise nothing was counted");
}

#[test]
fn a_counter_that_shares_no_code_agrees_on_small_meshes() {
    a_counter_of_its_own_agrees(5);
}

#[test]
#[ignore = "minutes: run by make test-long"]
fn a_counter_that_shares_no_code_agrees_on_more_than_500_meshes() {
    a_counter_of_its_own_agrees(170);
}

/// A box, turned, with the gradient of its nearest side.
struct Turned {
    half: Vec3,
    turn: Mat3,
}

impl StudyField for Turned {
    fn sample(&self, p: Vec3) -> f32 {
        (self.half - (self.turn.transpose() * p).abs()).min_element()
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        let q = self.turn.transpose() * p;
        let depth = self.half - q.abs();
        let axis = Vec3::AXES.into_iter().min_by(|a, b| depth.dot(*a).total_cmp(&depth.dot(*b)))?;
        Some(self.turn * axis * -q.dot(axis).signum())
    }
}

impl Turned {
    fn numbered(i: u32) -> Self {
        let angle = |k: u32| (i * 7 + k * 3) as f32 * 0.61;
        let turn = Mat3::from_rotation_z(angle(1))
            * Mat3::from_rotation_x(angle(2))
            * Mat3::from_rotation_y(angle(3));
        Self { half: Vec3::new(0.6013, 0.5217, 0.7031), turn }
    }

    fn corner(&self, c: u32) -> DVec3 {
        let of = |axis: usize| if c >> axis & 1 == 1 { 1.0 } else { -1.0 };
        (self.turn * (self.half * Vec3::new(of(0), of(1), of(2)))).as_dvec3()
    }

    /// Ends of its twelve edges.
    fn edges(&self) -> impl Iterator<Item = [DVec3; 2]> {
        let ends = |c: u32| (0..3).filter(move |axis| c >> axis & 1 == 0).map(move |axis| [c, c | 1 << axis]);
        (0..8).flat_map(ends).map(|ends| ends.map(|c| self.corner(c)))
    }
}

const CELLS: u32 = 40;

fn grid() -> BoxGrid {
    BoxGrid { bounds: Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }, spacing: 2.0 / CELLS as f32 }
}

/// The vertex of dual contouring in each cell, in cells.
fn vertices(field: &dyn StudyField) -> HashMap<[i32; 3], Option<DVec3>> {
    let settings = ChunkSettings::default();
    let mut extractor = ChunkExtractor::in_box(&grid(), &named("dc-manifold"), &settings).unwrap();
    let whole = extractor.grid(CELLS).next().unwrap();
    let chunk = extractor.extract(Source::Study(field), whole, Control::default()).unwrap();
    let mut all = HashMap::new();
    for (key, position) in chunk.keys.iter().zip(&chunk.positions) {
        let place = in_cells(Vec3::from(*position).as_dvec3());
        // A cell with several has none that counts.
        all.entry(key.cell()).and_modify(|of| *of = None).or_insert(Some(place));
    }
    all
}

fn in_cells(p: DVec3) -> DVec3 {
    (p + 1.0) / f64::from(grid().spacing)
}

/// Corners of the box whose cell has one vertex of dual contouring, there, are within a hundredth of a cell of a vertex; and where the cell
/// of an edge's point and all round it have their vertices within, the edge is as near to the mesh as it is to that of dual contouring.
#[test]
fn corners_and_edges_of_turned_boxes_are_kept_where_cells_hold_them() {
    let (mut corners, mut points) = (0, 0);
    let mut sums = [0.0; 2];
    for i in 0..12 {
        let field = Turned::numbered(i);
        let known = vertices(&field);
        let [sharp, clean] = ["dc-manifold", "dc-clean"].map(|id| extracted(&named(id), &field, &grid()));
        assert_eq!(self_intersections(&clean).unwrap(), 0, "{i}");
        let is_within = |cell: [i32; 3]| {
            let low = DVec3::from_array(cell.map(f64::from));
            known
                .get(&cell)
                .is_none_or(|of| of.is_some_and(|v| v.cmpgt(low).all() && v.cmplt(low + 1.0).all()))
        };
        for c in 0..8 {
            let corner = in_cells(field.corner(c));
            let cell = corner.floor().to_array().map(|i| i as i32);
            if known.get(&cell).is_some_and(|of| of.is_some_and(|v| v.distance(corner) < 1e-3)) {
                corners += 1;
                let nearest = clean.positions.iter().map(|p| in_cells(p.as_dvec3()).distance(corner));
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                assert!(nearest < 0.01, "{i} {c}: {nearest} cells");
            }
        }
        let surfaces = [&sharp, &clean].map(|mesh| Surface::try_new(mesh).unwrap());
        for [from, to] in field.edges() {
            for k in 0..400 {
                let p = from.lerp(to, (f64::from(k) + 0.5) / 400.0);
                let cell = in_cells(p).floor().to_array().map(|i| i as i32);
                let round = (0..27).map(|n| [n % 3, n / 3 % 3, n / 9]);
                let mut round = round.map(|way| [0, 1, 2].map(|axis| cell[axis] + way[axis] - 1));
                if known.contains_key(&cell) && round.all(is_within) {
                    points += 1;
                    for (sum, surface) in sums.iter_mut().zip(&surfaces) {
                        *sum += surface.nearest(p, f64::INFINITY).distance / f64::from(grid().spacing);
                    }
                }
            }
        }
    }
    let [sharp, clean] = sums.map(|sum| sum / f64::from(points));
    println!("{corners} corners, {points} points: {sharp} and {clean} cells");
    assert!(corners > 20 && points > 5_000, "{corners} {points}");
    // Vertices stay a thousandth of a cell off the sides of their cells.
    assert!(clean < 1.2 * sharp + 2e-3, "{clean} is more than 1.2 times {sharp}");
}

/// Where a cell is a few steps of `f32` long, and where it is less than one.
#[test]
fn far_from_the_origin_nothing_panics_and_little_is_lost() {
    let clean = named("dc-clean");
    for (far, steps) in [(1e3, 164.0), (5e3, 20.5), (1e5, 1.28)] {
        struct Far(f32);
        impl StudyField for Far {
            fn sample(&self, p: Vec3) -> f32 {
                let q = (p - self.0).abs();
                0.05 - q.max_element() - 0.3 * q.min_element()
            }
        }
        let bounds = Bounds { min: Vec3::splat(far - 0.1), max: Vec3::splat(far + 0.1) };
        let mesh = extracted(&clean, &Far(far), &BoxGrid { bounds, spacing: 0.01 });
        if steps > 16.0 {
            assert!(!mesh.triangles.is_empty());
            assert_eq!(self_intersections(&mesh).unwrap(), 0);
        }
    }
}

/// Where no quadrilateral leaves the envelope of its edge, triangles are those of cells alone.
#[test]
fn a_ball_has_the_triangles_of_dual_contouring_in_cells() {
    struct Ball;
    impl StudyField for Ball {
        fn sample(&self, p: Vec3) -> f32 {
            0.7 - p.length()
        }
    }
    let [clean, in_cell] = ["dc-clean", "dc-in-cell"].map(|id| extracted(&named(id), &Ball, &grid()));
    assert_eq!(clean.triangles, in_cell.triangles);
}

#[test]
fn what_does_not_go_together_is_refused() {
    for method in [
        DualContouring::new().with_clean(true),
        DualContouring::new().with_clean(true).with_patches(true),
        DualContouring::new().with_clean(true).with_in_cell(true),
    ] {
        let error = Method::DualContouring(method).check(&grid()).unwrap_err().to_string();
        assert_eq!(error, "clean = true: needs patches = true and in_cell = true");
    }
}
