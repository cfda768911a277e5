//! Cubical marching squares keep creases, stay in their cubes, and never pass through themselves.

use glam::{Mat3, Vec3};
use isostudy_extract::{
    BoxGrid, CubicalMarchingSquares, DualContouring, Execution, Extractor, Method, MethodError, Source,
    presets,
};
use isostudy_field::{Beyond, Gyroid, Sphere, StudyField, VolumeField};
use isostudy_mesh::self_intersections;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const CMS: Method = Method::CubicalMarchingSquares(CubicalMarchingSquares::new().with_crease_deg(20.0));

/// The least, or with `most` the largest, of distances to planes, each its normal's and at its distance from the origin.
struct Planes {
    planes: Vec<(Vec3, f32)>,
    most: bool,
}

impl Planes {
    fn at(&self, p: Vec3) -> (f32, Vec3) {
        let all = self.planes.iter().map(|(normal, way)| (way - normal.dot(p), -*normal));
        let order = |a: &(f32, Vec3), b: &(f32, Vec3)| a.0.total_cmp(&b.0);
        if self.most { all.max_by(order).unwrap() } else { all.min_by(order).unwrap() }
    }

    /// A box of so large half sides, turned and off the middle.
    fn cuboid(half: Vec3, turn: Mat3, middle: Vec3) -> Self {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z];
        let plane =
            |axis: Vec3, way: f32| (turn * axis * way, half.dot(axis) + (turn * axis * way).dot(middle));
        Self {
            planes: axes.into_iter().flat_map(|axis| [1.0, -1.0].map(|way| plane(axis, way))).collect(),
            most: false,
        }
    }
}

impl StudyField for Planes {
    fn sample(&self, p: Vec3) -> f32 {
        self.at(p).0
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        Some(self.at(p).1)
    }
}

/// Balls of random places and sizes.
struct Balls(Vec<(Vec3, f32)>);

impl Balls {
    fn of(seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut number = || random.random::<f32>() - 0.5;
        Self(
            (0..12).map(|_| (Vec3::new(number(), number(), number()), 0.25 + 0.3 * number().abs())).collect(),
        )
    }
}

impl StudyField for Balls {
    fn sample(&self, p: Vec3) -> f32 {
        self.0.iter().map(|(middle, radius)| radius - p.distance(*middle)).fold(f32::NEG_INFINITY, f32::max)
    }
}

/// White noise on nine samples a side, closed off, and its trilinear interpolant.
fn noise(seed: u64) -> VolumeField {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let at_box = |i: usize| [i % 9, i / 9 % 9, i / 81].iter().any(|&at| at == 0 || at == 8);
    let values = (0..729).map(|i| if at_box(i) { -1.0 } else { random.random::<f32>() - 0.5 }).collect();
    let steps = [[0.25, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.25]];
    VolumeField::try_new([9; 3], values, [-1.0; 3], steps, Beyond::Continued).unwrap()
}

fn grid(cells: u32) -> BoxGrid {
    BoxGrid { bounds: Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }, spacing: 2.0 / cells as f32 }
}

fn mesh_of(method: Method, field: &dyn StudyField, cells: u32, threads: usize) -> TriangleMesh {
    let (source, execution) = (Source::Study(field), Execution { threads });
    method.extract(&mut Extractor::new(), source, &grid(cells), 0.0, &execution).unwrap().mesh
}

fn mesh(field: &dyn StudyField, cells: u32) -> TriangleMesh {
    mesh_of(CMS, field, cells, 1)
}

fn turns() -> impl Iterator<Item = Mat3> {
    [[0.0, 0.0], [0.3, 0.7], [0.05, -0.02], [1.1, 0.4]]
        .into_iter()
        .map(|[z, x]| Mat3::from_rotation_z(z) * Mat3::from_rotation_x(x))
}

/// Along the axes nothing is cut off: edges cross faces, and corners lie within cubes.
#[test]
fn a_box_along_the_axes_is_exact() {
    let (half, middle) = (Vec3::new(0.6013, 0.5217, 0.7031), Vec3::new(0.013, -0.021, 0.007));
    for cells in [7, 20, 33] {
        let mesh = mesh(&Planes::cuboid(half, Mat3::IDENTITY, middle), cells);
        assert!(topology(&mesh).is_closed_manifold());
        let volume = f64::from(8.0 * half.element_product());
        assert!((mesh.volume() - volume).abs() < 1e-6 * volume, "{cells}: {} for {volume}", mesh.volume());
        for corner in 0..8 {
            let sign =
                Vec3::from_array([0, 1, 2].map(|axis| if corner >> axis & 1 != 0 { 1.0 } else { -1.0 }));
            let corner = middle + half * sign;
            let nearest = mesh.positions.iter().map(|p| p.distance(corner)).fold(f32::INFINITY, f32::min);
            assert!(nearest < 1e-5, "{cells}: {nearest}");
        }
    }
}

/// What is left out of a turned box is where edges poke into cubes without a crossing: far less than marching cubes cut off.
#[test]
fn turned_boxes_lose_little() {
    let half = Vec3::new(0.6013, 0.5217, 0.5031);
    let volume = f64::from(8.0 * half.element_product());
    let cubes = presets().iter().find(|preset| preset.id == "mc").unwrap().method;
    for turn in turns() {
        let field = Planes::cuboid(half, turn, Vec3::splat(0.004));
        let lost = |method| (mesh_of(method, &field, 32, 1).volume() - volume).abs();
        assert!(lost(CMS) < 0.15 * lost(cubes), "{} for {}", lost(CMS), lost(cubes));
    }
}

/// No pair of triangles passes through another, and the mesh is a closed manifold: of boxes outside and inside, of balls that meet, and of
/// smooth surfaces. Dual contouring has pairs on the same surfaces.
#[test]
fn no_triangle_passes_through_another() {
    let mut of_planes = 0;
    let mut check = |field: &dyn StudyField, cells: u32, is_closed: bool| {
        let mesh = mesh(field, cells);
        let found = topology(&mesh);
        assert_eq!(found.non_manifold_edges + found.non_manifold_vertices, 0);
        assert!(!is_closed || found.boundary_edges == 0);
        assert_eq!(self_intersections(&mesh), Ok(0));
        let dual = Method::DualContouring(DualContouring::default().with_patches(true));
        of_planes += self_intersections(&mesh_of(dual, field, cells, 1)).unwrap();
    };
    for turn in turns() {
        for cells in [9, 16, 25] {
            let mut solid = Planes::cuboid(Vec3::new(0.6, 0.5, 0.4), turn, Vec3::splat(0.01));
            check(&solid, cells, true);
            // The room that is left of a block.
            solid.planes.iter_mut().for_each(|(normal, way)| (*normal, *way) = (-*normal, -*way));
            solid.most = true;
            check(&solid, cells, false);
        }
    }
    for seed in 0..20 {
        check(&Balls::of(seed), 14 + seed as u32, true);
    }
    // White noise has every pattern of cubes, with sheets that cross a cube together.
    for seed in 0..20 {
        check(&noise(seed), 9 + seed as u32, true);
    }
    check(&Sphere { radius: 0.8 }, 20, true);
    check(&Gyroid::default(), 24, false);
    assert!(of_planes > 100, "{of_planes}");
}

/// Every triangle lies in a cube, a face of two cubes counting for both.
#[test]
fn no_triangle_leaves_its_cube() {
    for seed in 0..8 {
        let mesh = mesh(&Balls::of(seed), 20);
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| (mesh.positions[v as usize] + 1.0) * 10.0);
            let low = corners.into_iter().reduce(Vec3::min).unwrap();
            let high = corners.into_iter().reduce(Vec3::max).unwrap();
            let cube = (0.5 * (low + high)).floor();
            assert!(low.cmpge(cube - 1e-4).all() && high.cmple(cube + 1.0 + 1e-4).all(), "{low} {high}");
        }
    }
}

#[test]
fn a_smooth_surface_has_the_triangles_of_marching_cubes() {
    let cubes = presets().iter().find(|preset| preset.id == "mc").unwrap().method;
    let sphere = Sphere { radius: 0.8 };
    let [cubes, creased] = [cubes, CMS].map(|method| mesh_of(method, &sphere, 40, 1));
    assert_eq!(cubes.triangles, creased.triangles);
    let off = creased.positions.iter().map(|p| (p.length() - 0.8).abs()).fold(0.0, f32::max);
    assert!(off < 1e-6, "crossings are roots: {off}");
}

#[test]
fn any_number_of_threads_gives_the_same_mesh() {
    let field = Balls::of(3);
    let one = mesh(&field, 30);
    for threads in [2, 3] {
        let more = mesh_of(CMS, &field, 30, threads);
        assert_eq!((&one.positions, &one.triangles), (&more.positions, &more.triangles));
    }
}

#[test]
fn what_is_no_angle_is_refused() {
    for crease_deg in [0.0, -1.0, 180.5, f32::NAN] {
        let method =
            Method::CubicalMarchingSquares(CubicalMarchingSquares::default().with_crease_deg(crease_deg));
        let error = method.check(&grid(8)).unwrap_err();
        assert!(matches!(error, MethodError::Setting { key: "crease_deg", .. }), "{error}");
    }
}

/// A field without numbers, or without a gradient, gives what marching cubes give, and no panic.
#[test]
fn odd_fields_are_no_trouble() {
    struct Odd(u32);
    impl StudyField for Odd {
        fn sample(&self, p: Vec3) -> f32 {
            let number = (p * 57.3).round().element_sum() as i32;
            match self.0 {
                0 => f32::NAN,
                1 if number % 7 == 0 => f32::NAN,
                2 if number % 5 == 0 => f32::INFINITY,
                3 => p.x.signum(),
                4 => (number % 3 - 1) as f32,
                _ => 0.5 - p.length(),
            }
        }

        fn gradient(&self, _: Vec3) -> Option<Vec3> {
            Some(Vec3::NAN)
        }
    }
    for odd in 0..6 {
        let mesh = mesh(&Odd(odd), 12);
        assert!(mesh.positions.iter().all(|p| p.is_finite()), "{odd}");
        assert_eq!(topology(&mesh).non_manifold_edges, 0, "{odd}");
    }
}
