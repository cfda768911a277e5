//! Dual contouring keeps corners, edges and tips, converges on smooth surfaces, and has the connections of surface nets.

use glam::{Mat3, Vec3};
use isostudy_extract::{
    BoxGrid, ChunkError, ChunkExtractor, ChunkSettings, DualContouring, Execution, Extractor, Method,
    MethodError, Source, SurfaceNets, weld_chunks,
};
use isostudy_field::StudyField;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};

const ONE: Execution = Execution { threads: 1 };

struct Formula<F>(F);

impl<F: Fn(Vec3) -> f32 + Sync> StudyField for Formula<F> {
    fn sample(&self, p: Vec3) -> f32 {
        (self.0)(p)
    }
}

/// The least of some smooth fields, each with its gradient: that of the sum is exact on either side of an edge.
struct Least<F>(F);

impl<const N: usize, F: Fn(Vec3) -> [(f32, Vec3); N] + Sync> Least<F> {
    fn at(&self, p: Vec3) -> (f32, Vec3) {
        (self.0)(p).into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    }
}

impl<const N: usize, F: Fn(Vec3) -> [(f32, Vec3); N] + Sync> StudyField for Least<F> {
    fn sample(&self, p: Vec3) -> f32 {
        self.at(p).0
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        Some(self.at(p).1)
    }
}

/// A box of so large half sides, turned.
fn boxed(half: Vec3, turn: Mat3) -> impl StudyField {
    Least(move |p: Vec3| {
        let q = turn.transpose() * p;
        [Vec3::X, Vec3::Y, Vec3::Z]
            .map(|axis| (half.dot(axis) - q.dot(axis).abs(), turn * axis * -q.dot(axis).signum()))
    })
}

/// From -1 to 1 along each axis, with so many cells.
fn grid(cells: u32) -> BoxGrid {
    BoxGrid { bounds: Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }, spacing: 2.0 / cells as f32 }
}

fn mesh(method: Method, field: &dyn StudyField, cells: u32) -> TriangleMesh {
    let source = Source::Study(field);
    method.extract(&mut Extractor::new(), source, &grid(cells), 0.0, &ONE).unwrap().mesh
}

fn every_setting() -> impl Iterator<Item = Method> {
    [false, true].into_iter().flat_map(|patches| {
        [false, true].map(|in_cell| {
            Method::DualContouring(DualContouring::default().with_patches(patches).with_in_cell(in_cell))
        })
    })
}

fn is_free(method: &Method) -> bool {
    matches!(method, Method::DualContouring(of) if !of.in_cell)
}

/// How far the nearest vertex is, in cells.
fn missed(mesh: &TriangleMesh, point: Vec3, cells: u32) -> f32 {
    let nearest = mesh.positions.iter().map(|p| p.distance(point)).fold(f32::INFINITY, f32::min);
    nearest * cells as f32 / 2.0
}

fn corners(half: Vec3) -> impl Iterator<Item = Vec3> {
    (0..8).map(move |c| {
        half * Vec3::from_array([0, 1, 2].map(|axis| if c >> axis & 1 != 0 { 1.0 } else { -1.0 }))
    })
}

#[test]
fn corners_of_boxes_are_hit() {
    let half = Vec3::new(0.6013, 0.5217, 0.7031);
    for turn in [Mat3::IDENTITY, Mat3::from_rotation_z(0.3) * Mat3::from_rotation_x(0.7)] {
        let field = boxed(half, turn);
        for cells in [32, 64] {
            // A corner that pokes into a cube without a crossing is for a vertex of the next cube, which must be free to go there.
            let is_turned = turn != Mat3::IDENTITY;
            for method in every_setting().filter(|method| !is_turned || is_free(method)) {
                let mesh = mesh(method, &field, cells);
                for corner in corners(half) {
                    let missed = missed(&mesh, turn * corner, cells);
                    assert!(missed < 0.005, "{method:?} {cells}: {missed} cells");
                }
            }
            let nets = mesh(Method::SurfaceNets(SurfaceNets::default()), &field, cells);
            let least = corners(half).map(|corner| missed(&nets, turn * corner, cells)).fold(9.0, f32::min);
            assert!(least > 0.1, "nets cut corners off: {least} cells");
        }
    }
}

/// Points all over the triangles of a turned box lie on the box: its edges are edges of the mesh.
#[test]
fn edges_of_boxes_are_kept() {
    let half = Vec3::new(0.6013, 0.5217, 0.7031);
    let turn = Mat3::from_rotation_z(0.3) * Mat3::from_rotation_x(0.7);
    let distance = move |p: Vec3| {
        let q = (turn.transpose() * p).abs() - half;
        q.max(Vec3::ZERO).length() + q.max_element().min(0.0)
    };
    let field = boxed(half, turn);
    let worst = |mesh: &TriangleMesh| {
        let points = mesh.triangles.iter().flat_map(|t| {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
            (0..=8).flat_map(move |i| {
                (0..=8 - i).map(move |j| a + (b - a) * (i as f32 / 8.0) + (c - a) * (j as f32 / 8.0))
            })
        });
        16.0 * points.map(|p| distance(p).abs()).fold(0.0, f32::max)
    };
    for method in every_setting().filter(is_free) {
        let mesh = mesh(method, &field, 32);
        assert!(topology(&mesh).is_closed_manifold());
        let worst = worst(&mesh);
        assert!(worst < 0.01, "{method:?}: {worst} cells");
    }
    let nets = worst(&mesh(Method::SurfaceNets(SurfaceNets::default()), &field, 32));
    assert!(nets > 0.2, "{nets}");
}

#[test]
fn the_tip_of_a_cone_is_hit() {
    let tip = Vec3::new(0.013, -0.021, 0.517);
    let cone = Least(move |p: Vec3| {
        let q = tip - p;
        let out = q.truncate().normalize_or_zero();
        let mantle = (0.6 * q.z - 0.8 * q.truncate().length(), Vec3::new(0.8 * out.x, 0.8 * out.y, -0.6));
        [mantle, (p.z + 0.63, Vec3::Z)]
    });
    for cells in [32, 64] {
        for method in every_setting().filter(is_free) {
            let missed = missed(&mesh(method, &cone, cells), tip, cells);
            assert!(missed < 0.005, "{method:?} {cells}: {missed} cells");
        }
    }
}

/// The error on a sphere falls to a quarter with half the spacing: that of vertices smoothly, that of the middles of triangles, which
/// depends on diagonals, roughly.
#[test]
fn smooth_surfaces_converge_by_squares() {
    let field = Formula(|p: Vec3| 0.8013 - p.length());
    let away = |p: Vec3| (p.as_dvec3().length() - 0.8013).abs();
    for method in every_setting() {
        let errors = [16, 32, 64, 128].map(|cells| {
            let mesh = mesh(method, &field, cells);
            let middle = |t: &[u32; 3]| t.iter().map(|&v| mesh.positions[v as usize]).sum::<Vec3>() / 3.0;
            let of_middles = mesh.triangles.iter().map(|t| away(middle(t))).sum::<f64>();
            let of_vertices = mesh.positions.iter().map(|&p| away(p)).sum::<f64>();
            [of_middles / mesh.triangles.len() as f64, of_vertices / mesh.positions.len() as f64]
        });
        for pair in errors.windows(2) {
            let [of_middles, of_vertices] = [0, 1].map(|i| pair[0][i] / pair[1][i]);
            assert!((3.8..4.2).contains(&of_vertices), "{method:?} {errors:?}");
            assert!((3.5..5.0).contains(&of_middles), "{method:?} {errors:?}");
        }
    }
}

/// As many vertices and triangles as surface nets, which have the same four cells round each edge; the same on any number of threads.
#[test]
fn connections_are_those_of_surface_nets() {
    let field = Formula(|p: Vec3| {
        (9.0 * p.x).sin() * (9.0 * p.y).cos()
            + (9.0 * p.y).sin() * (9.0 * p.z).cos()
            + (9.0 * p.z).sin() * (9.0 * p.x).cos()
    });
    for patches in [false, true] {
        let nets = mesh(Method::SurfaceNets(SurfaceNets::default().with_patches(patches)), &field, 40);
        let method = Method::DualContouring(DualContouring::default().with_patches(patches));
        let planes = mesh(method, &field, 40);
        assert_eq!(planes.positions.len(), nets.positions.len());
        let quads = |mesh: &TriangleMesh| -> Vec<Vec<u32>> {
            let of = |pair: &[[u32; 3]]| {
                let mut all = pair.concat();
                all.sort_unstable();
                all.dedup();
                all
            };
            mesh.triangles.chunks(2).map(of).collect()
        };
        assert_eq!(quads(&planes), quads(&nets));
        // Each vertex is in its cube, like that of the nets.
        for (a, b) in planes.positions.iter().zip(&nets.positions) {
            assert!((*a - *b).abs().max_element() <= 2.0 / 40.0 + 1e-5);
        }
        for threads in [2, 3] {
            let source = Source::Study(&field);
            let other = method.extract(&mut Extractor::new(), source, &grid(40), 0.0, &Execution { threads });
            assert_eq!(other.unwrap().mesh, planes, "{threads}");
        }
    }
}

#[test]
fn what_has_no_normals_and_no_sense_is_refused() {
    let method = Method::DualContouring(DualContouring::default());
    let samples = vec![0.0; 9 * 9 * 9];
    let given = method.extract(&mut Extractor::new(), Source::Samples(&samples), &grid(8), 0.0, &ONE);
    assert_eq!(given.unwrap_err(), MethodError::NeedsField);
    for truncation in [-0.1, 1.5, f32::NAN] {
        let method = Method::DualContouring(DualContouring::default().with_truncation(truncation));
        let text = method.check(&grid(8)).unwrap_err().to_string();
        assert!(text.contains("must be from 0 to 1"), "{text}");
    }
    // A field without numbers has vertices at the means.
    let broken = Formula(|p: Vec3| if p.x > 0.3 { f32::NAN } else { 0.6 - p.length() });
    let mesh = mesh(method, &broken, 16);
    assert!(mesh.positions.iter().all(|p| p.is_finite()) && !mesh.triangles.is_empty());
}

/// Chunks of any size weld to the whole, byte for byte, and take no samples.
#[test]
fn chunks_are_those_of_the_whole() {
    let turned = boxed(Vec3::new(0.61, 0.43, 0.72), Mat3::from_rotation_z(0.4) * Mat3::from_rotation_x(0.7));
    for method in every_setting() {
        let whole = mesh(method, &turned, 23);
        let mut extractor = ChunkExtractor::in_box(&grid(23), &method, &ChunkSettings::default()).unwrap();
        for side in [5, 16] {
            let boxes: Vec<_> = extractor.grid(side).collect();
            let parts: Vec<_> = boxes
                .into_iter()
                .map(|cells| extractor.extract(Source::Study(&turned), cells, &ONE).unwrap())
                .collect();
            assert_eq!(weld_chunks(&parts).unwrap(), whole, "{method:?} {side}");
        }
        let cells = extractor.grid(5).next().unwrap();
        let error = extractor.extract(Source::Samples(&[0.0; 24 * 24 * 24]), cells, &ONE).unwrap_err();
        assert_eq!(error, ChunkError::Settings(MethodError::NeedsField));
    }
}
