//! Points of sharp edges lie on them, and a mesh's distance from them is what geometry says.

use glam::{Mat3, Vec3};
use isostudy_extract::{
    Accuracy, BoxGrid, Cubes, DualContouring, Execution, Extractor, Method, Source, SurfaceNets, accuracy,
};
use isostudy_field::{MeshDistance, Sphere, StudyField};
use isostudy_mesh::{Bounds, TriangleMesh};

const THREADS: Execution = Execution { threads: 2 };
const HALF: Vec3 = Vec3::new(0.6013, 0.5217, 0.7031);

struct Formula<F>(F);

impl<F: Fn(Vec3) -> f32 + Sync> StudyField for Formula<F> {
    fn sample(&self, p: Vec3) -> f32 {
        (self.0)(p)
    }
}

/// A box, turned; `is_room` if it is cut out of rock.
#[derive(Clone, Copy)]
struct Turned {
    turn: Mat3,
    is_room: bool,
    has_gradient: bool,
}

impl Turned {
    fn sign(&self) -> f32 {
        if self.is_room { -1.0 } else { 1.0 }
    }
}

impl StudyField for Turned {
    fn sample(&self, p: Vec3) -> f32 {
        self.sign() * (HALF - (self.turn.transpose() * p).abs()).min_element()
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        let q = self.turn.transpose() * p;
        let depth = HALF - q.abs();
        let axis = Vec3::AXES.into_iter().min_by(|a, b| depth.dot(*a).total_cmp(&depth.dot(*b)))?;
        self.has_gradient.then(|| self.sign() * (self.turn * axis * -q.dot(axis).signum()))
    }
}

/// The mesh of a box with so large half sides.
fn box_mesh(half: Vec3, turn: Mat3) -> TriangleMesh {
    let corner = |c: u32| Vec3::from_array([0, 1, 2].map(|axis| if c >> axis & 1 == 1 { 1.0 } else { -1.0 }));
    let squares = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    TriangleMesh {
        positions: (0..8).map(|c| turn * (half * corner(c))).collect(),
        normals: Vec::new(),
        triangles: squares.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    }
}

fn grid(spacing: f32) -> BoxGrid {
    BoxGrid { bounds: Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }, spacing }
}

fn measure(mesh: &TriangleMesh, field: &dyn StudyField, spacing: f32) -> Accuracy {
    let found = accuracy(mesh, field, 0.0, &grid(spacing), &THREADS).unwrap();
    assert_eq!(found, accuracy(mesh, field, 0.0, &grid(spacing), &Execution { threads: 1 }).unwrap());
    found
}

/// From a box to a smaller one within: `inset` to the side along two axes, and three beyond the smaller one's corners.
fn mean_distance(inset: f64) -> f64 {
    let beside = inset * 2f64.sqrt();
    let steps = 1_000;
    let beyond = |i: i32| beside.hypot(inset * (f64::from(i) + 0.5) / f64::from(steps));
    let beyond = (0..steps).map(beyond).sum::<f64>() / f64::from(steps);
    let [x, y, z] = HALF.as_dvec3().to_array();
    ((x + y + z - 3.0 * inset) * beside + 3.0 * inset * beyond) / (x + y + z)
}

#[test]
fn edges_of_a_box_and_of_a_room_are_where_they_are() {
    let turn = Mat3::from_rotation_z(0.3) * Mat3::from_rotation_x(0.7);
    let inset = 0.02f32;
    let [same, inner] = [0.0, inset].map(|inset| box_mesh(HALF - inset, turn));
    for (is_room, has_gradient) in [(false, false), (false, true), (true, false), (true, true)] {
        let field = Turned { turn, is_room, has_gradient };
        for spacing in [0.05, 0.03] {
            let what = format!("room {is_room}, gradient {has_gradient}, spacing {spacing}");
            let found = measure(&same, &field, spacing).sharp_edges;
            let length = 8.0 * (HALF.x + HALF.y + HALF.z) / spacing;
            assert!(found.count as f32 > 2.0 * length, "{what}: {} points", found.count);
            // Where one sixteenth of a spacing has a corner in it, three planes meet.
            assert!(found.q95 < 1e-3 * f64::from(spacing), "{what}: {}", found.q95);
            assert!(found.max < 0.04 * f64::from(spacing), "{what}: {}", found.max);
            let found = measure(&inner, &field, spacing).sharp_edges;
            let want = mean_distance(inset.into());
            assert!((found.mean / want - 1.0).abs() < 0.01, "{what}: {} is not {want}", found.mean);
            assert!((found.median / (f64::from(inset) * 2f64.sqrt()) - 1.0).abs() < 1e-3, "{what}");
        }
    }
}

#[test]
fn a_mesh_has_the_sharp_edges_of_its_triangles() {
    let inset = 0.02f32;
    let [outer, inner] = [0.0, inset].map(|inset| box_mesh(HALF - inset, Mat3::IDENTITY));
    let field = MeshDistance::try_new(&outer).unwrap();
    let found = measure(&inner, &field, 0.05).sharp_edges;
    // Twelve edges, and not the diagonals of its sides.
    let want = 8.0 * f64::from(HALF.x + HALF.y + HALF.z) / 0.025;
    assert!((found.count as f64 - want).abs() <= 1.0, "{} points, not {want}", found.count);
    let want = mean_distance(inset.into());
    assert!((found.mean / want - 1.0).abs() < 0.005, "{} is not {want}", found.mean);
}

#[test]
fn smooth_surfaces_have_none() {
    let ball = |p: Vec3| 0.8 - p.length();
    let waves = |p: Vec3| 0.2 * (5.0 * p.x).sin() * (6.0 * p.y).cos() - p.z;
    // As tight a bend as cubes of this size can show.
    let tube = |p: Vec3| 0.06 - p.truncate().length();
    let any = box_mesh(HALF, Mat3::IDENTITY);
    let fields: [&dyn StudyField; 4] =
        [&Sphere { radius: 0.8 }, &Formula(ball), &Formula(waves), &Formula(tube)];
    for field in fields {
        assert_eq!(measure(&any, field, 0.05).sharp_edges.count, 0);
    }
}

/// The edge of a wedge with so many degrees between its faces, along the y axis of a turned box.
#[test]
fn edges_of_thin_wedges_are_at_their_tips() {
    let turn = Mat3::from_rotation_z(0.4) * Mat3::from_rotation_x(0.3);
    // Two triangles that meet in the edge: nothing else of them is near it.
    let edge = TriangleMesh {
        positions: [[0.0, -3.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 3.0], [0.0, 0.1, 3.0]]
            .map(|p| turn.transpose() * Vec3::from_array(p))
            .to_vec(),
        normals: Vec::new(),
        triangles: vec![[0, 1, 2], [1, 0, 3]],
    };
    for (degrees, has_gradient) in
        [90f32, 60.0, 40.0, 30.0, 20.0, 10.0].into_iter().flat_map(|of| [(of, true), (of, false)])
    {
        let wedge = Wedge { turn, half: (0.5 * degrees).to_radians(), has_gradient };
        let found = measure(&edge, &wedge, 0.05).sharp_edges;
        assert!(found.count > 40, "{degrees}: {} points", found.count);
        // Differences see both faces nearer to the edge than they are wide.
        let most = if has_gradient { 1e-3 } else { 0.1 };
        assert!(found.max < most * 0.05, "{degrees}: {} of {} points", found.max, found.count);
    }
}

/// The space between two planes that meet.
struct Wedge {
    turn: Mat3,
    /// Half the angle between them.
    half: f32,
    has_gradient: bool,
}

impl StudyField for Wedge {
    fn sample(&self, p: Vec3) -> f32 {
        let q = self.turn * p;
        q.z * self.half.sin() - q.x.abs() * self.half.cos()
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        let q = self.turn * p;
        let outward = Vec3::new(-q.x.signum() * self.half.cos(), 0.0, self.half.sin());
        self.has_gradient.then(|| self.turn.transpose() * outward)
    }
}

/// A sheet has two sides and no edge, however thin it is.
#[test]
fn a_sheet_has_no_sharp_edge() {
    let any = box_mesh(HALF, Mat3::IDENTITY);
    for thickness in [0.01f32, 0.04, 0.1] {
        let sheet = Formula(move |p: Vec3| thickness - (0.6 * p.x + 0.8 * p.z + 0.01).abs());
        let found = measure(&any, &sheet, 0.05).sharp_edges;
        assert_eq!(found.count, 0, "{thickness}");
    }
}

/// Edges of a mesh far larger than the box are cut off at the box before points are made.
#[test]
fn edges_beyond_the_box_cost_nothing() {
    let huge =
        box_mesh(Vec3::new(1e6, 1e6, 0.5), Mat3::IDENTITY).transformed(|p| p + Vec3::new(1e6, 1e6, 0.0));
    let field = MeshDistance::try_new(&huge).unwrap();
    let found = measure(&huge, &field, 0.05).sharp_edges;
    // Two edges along x and y each, from 0 to 1, and one along z.
    let want = (4.0 * 1.0 + 1.0) / 0.025;
    assert!((found.count as f64 - want).abs() <= 2.0, "{} points", found.count);
    assert!(found.max < 1e-6, "{}", found.max);
}

/// A roof is sharp if its sides differ by more than 30 degrees.
#[test]
fn thirty_degrees_are_sharp() {
    let any = box_mesh(HALF, Mat3::IDENTITY);
    for (degrees, is_sharp) in [(20f32, false), (29.0, false), (31.0, true), (90.0, true), (150.0, true)] {
        let half = (0.5 * degrees).to_radians();
        let turn = Mat3::from_rotation_z(0.4) * Mat3::from_rotation_x(0.3);
        let roof = Formula(move |p: Vec3| {
            let q = turn * p;
            -q.z * half.cos() - q.x.abs() * half.sin()
        });
        let found = measure(&any, &roof, 0.05).sharp_edges;
        assert_eq!(found.count > 20, is_sharp, "{degrees}: {} points", found.count);
        assert_eq!(found.count > 0, is_sharp, "{degrees}: {} points", found.count);
    }
}

#[test]
fn dual_contouring_keeps_what_others_round() {
    let field = Turned {
        turn: Mat3::from_rotation_z(0.3) * Mat3::from_rotation_x(0.7),
        is_room: false,
        has_gradient: true,
    };
    let spacing = 0.04f32;
    let of = |method: Method| {
        let source = Source::Study(&field);
        let mesh = method.extract(&mut Extractor::new(), source, &grid(spacing), 0.0, &THREADS).unwrap().mesh;
        measure(&mesh, &field, spacing).sharp_edges.mean / f64::from(spacing)
    };
    let kept = of(Method::DualContouring(DualContouring::default()));
    assert!(kept < 0.005, "{kept}");
    for method in [Method::Cubes(Cubes::default()), Method::SurfaceNets(SurfaceNets::default())] {
        let rounded = of(method);
        assert!((0.1..0.5).contains(&rounded), "{method:?}: {rounded}");
    }
}
