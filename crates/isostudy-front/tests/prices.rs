//! What a front gives for its cost, beside lattice methods with as many triangles: the table of `docs/front.md`.
//!
//! `cargo test --release --locked -p isostudy-front --test prices -- --ignored --nocapture` prints it, in a minute or two.

use isostudy_extract::{BoxGrid, Execution, Extractor, IsosurfacePoints, Method, accuracy_beside, presets};
use isostudy_field::{
    Asteroid, Counted, FieldCache, Gyroid, Plain, Sphere, StudyField, Terrain, TerrainCharacter,
    TerrainSettings, from_fn,
};
use isostudy_front::{Front, Sizing, grow};
use isostudy_mesh::glam::Vec3;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh, quality::quality, self_intersections};
use rustix::time::{ClockId, clock_gettime};

/// Times are medians of so many runs, and of CPU time on the one thread: others may use the machine meanwhile.
const RUNS: usize = 5;
/// Lattices have so many spacings tried until their triangles are as many.
const TRIES: usize = 8;

struct Object<'a> {
    name: &'static str,
    field: &'a dyn StudyField,
    bounds: Bounds,
    edge: f64,
}

/// CPU time of this thread, in milliseconds.
fn now() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    1e3 * time.tv_sec as f64 + 1e-6 * time.tv_nsec as f64
}

/// The median time of making something, in milliseconds.
fn timed(make: impl Fn() -> TriangleMesh) -> f64 {
    let run = |_| {
        let began = now();
        std::hint::black_box(make());
        now() - began
    };
    let mut times: Vec<f64> = (0..RUNS).map(run).collect();
    times.sort_by(f64::total_cmp);
    times[RUNS / 2]
}

impl Object<'_> {
    fn front(&self, field: &dyn StudyField, sizing: Sizing, longest: f64) -> TriangleMesh {
        let settings = Front { sizing, ..Front::of_edge(longest) };
        grow(field, self.bounds, 0.0, &settings).unwrap_or_else(|error| panic!("{}: {error}", self.name)).mesh
    }

    fn lattice(&self, field: &dyn StudyField, method: &Method, spacing: f32) -> TriangleMesh {
        let grid = BoxGrid { bounds: self.bounds, spacing };
        let one = Execution { threads: 1 };
        let made = method.extract(&mut Extractor::new(), field.into(), &grid, 0.0, &one);
        made.expect("a method that goes with every grid").mesh
    }

    /// The spacing at which a method has about so many triangles.
    fn spacing(&self, method: &Method, triangles: usize) -> f32 {
        let mut spacing = self.edge as f32;
        for _ in 0..TRIES {
            let found = self.lattice(self.field, method, spacing).triangles.len();
            spacing *= (found as f32 / triangles as f32).sqrt();
        }
        spacing
    }

    fn row(
        &self,
        points: &IsosurfacePoints,
        label: &str,
        make: impl Fn(&dyn StudyField) -> TriangleMesh,
    ) -> usize {
        let mut kept = FieldCache::default();
        let counted = Counted::new(self.field, &mut kept);
        let mesh = make(&counted);
        let ms = timed(|| make(self.field));
        let all = Execution { threads: 0 };
        let of = accuracy_beside(points, &mesh, self.field, 0.0, self.edge as f32, &all).expect("threads");
        let (shapes, counts) = (quality(&mesh), topology(&mesh));
        let pairs = self_intersections(&mesh).map_or_else(|_| "-".to_owned(), |pairs| pairs.to_string());
        let per_vertex = |calls: u64| calls as f64 / counts.vertices as f64;
        println!(
            "| {} | {label} | {} | {:.2} | {:.1} | {:.2} | {:.2} | {:.1} | {:.1} | {:.1} | {} | {pairs} |",
            self.name,
            mesh.triangles.len(),
            shapes.min_angle_deg.min,
            shapes.min_angle_deg.mean,
            100.0 * of.distance.max / self.edge,
            100.0 * of.distance_to_mesh.max / self.edge,
            per_vertex(counted.evaluations()),
            per_vertex(counted.gradients()),
            ms,
            counts.euler_characteristic,
        );
        mesh.triangles.len()
    }
}

#[test]
#[ignore = "prints times for docs/front.md: the command is on top; takes a minute or two"]
fn what_a_front_gives_for_its_cost() {
    let cube = |half: f32| Bounds { min: Vec3::splat(-half), max: Vec3::splat(half) };
    let ground = Bounds { min: Vec3::new(-1.0, -1.0, -0.5), max: Vec3::new(1.0, 1.0, 0.5) };
    let torus = from_fn(|[x, y, z]| 0.25 - (((x * x + y * y).sqrt() - 0.7).powi(2) + z * z).sqrt());
    let double = from_fn(|[x, y, z]| 0.01 - (x * x - x * x * x * x - y * y).powi(2) - z * z);
    let hills = TerrainSettings { closed: false, ..TerrainCharacter::Hills.settings(3) };
    let hills = Terrain::try_new(hills, ground).expect("a terrain");
    let (sphere, asteroid, gyroid) = (Sphere { radius: 1.0 }, Asteroid::default(), Gyroid::default());
    let object = |name, field, bounds, edge| Object { name, field, bounds, edge };
    let (torus, double) = (Plain(&torus), Plain(&double));
    let objects = [
        object("sphere", &sphere, cube(1.1), 0.04),
        object("torus", &torus, cube(1.1), 0.04),
        object("double torus", &double, cube(1.3), 0.03),
        object("asteroid", &asteroid, cube(1.1), 0.04),
        object("gyroid", &gyroid, cube(0.93), 0.04),
        object("hills", &hills, ground, 0.03),
    ];
    println!(
        "| object | method | triangles | least angle, deg | mean least angle | to the surface, % of an edge | to the mesh, % | values per \
         vertex | gradients per vertex | ms | Euler characteristic | intersecting pairs |"
    );
    println!("|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|");
    for object in &objects {
        let grid = BoxGrid { bounds: object.bounds, spacing: object.edge as f32 };
        let points = IsosurfacePoints::of(object.field, 0.0, &grid, None, &Execution { threads: 0 });
        let points = points.expect("a surface");
        let triangles =
            object.row(&points, "front", |field| object.front(field, Sizing::Constant, object.edge));
        let sizing = Sizing::Curvature { smallest: 0.5 * object.edge, angle: 0.15 };
        object.row(&points, "front by curvature", |field| object.front(field, sizing, 2.0 * object.edge));
        for id in ["mc", "nets", "bi", "snapmc"] {
            let method = presets().iter().find(|preset| preset.id == id).expect("a preset").method;
            let spacing = object.spacing(&method, triangles);
            object.row(&points, &format!("`{id}`"), |field| object.lattice(field, &method, spacing));
        }
    }
}
