//! What each finishing step gives for its cost, beside the clusterings of the paper: the table of `docs/finishing.md`.
//!
//! `cargo test --release --locked -p isostudy-finish --test prices -- --ignored --nocapture` prints it, in about a minute.

use isostudy_extract::{
    Arrangement, BoxGrid, Clustering, Execution, Extractor, IsosurfacePoints, Method, Tetrahedra,
    accuracy_beside, presets,
};
use isostudy_field::{Asteroid, Sphere, StudyField, Terrain, TerrainCharacter, TerrainSettings};
use isostudy_finish::{Density, Extent, Step};
use isostudy_mesh::glam::Vec3;
use isostudy_mesh::topology::{TopologyReport, topology};
use isostudy_mesh::{Bounds, TriangleMesh, quality::quality, self_intersections};
use rustix::time::{ClockId, clock_gettime};

/// Times are medians of so many runs, and of CPU time on the one thread: others may use the machine meanwhile.
const RUNS: usize = 3;

struct Object {
    name: &'static str,
    field: Box<dyn StudyField>,
    grid: BoxGrid,
}

fn objects() -> Vec<Object> {
    let cube = Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) };
    let ground = Bounds { min: Vec3::new(-1.0, -1.0, -0.5), max: Vec3::new(1.0, 1.0, 0.5) };
    // As in configs/terrain.toml.
    let cliffs = TerrainSettings { margin: 0.013, ..TerrainCharacter::Cliffs.settings(3) };
    vec![
        Object {
            name: "sphere",
            field: Box::new(Sphere { radius: 1.0 }),
            grid: BoxGrid { bounds: cube, spacing: 0.04 },
        },
        Object {
            name: "asteroid",
            field: Box::new(Asteroid::default()),
            grid: BoxGrid { bounds: cube, spacing: 0.04 },
        },
        Object {
            name: "cliffs",
            field: Box::new(Terrain::try_new(cliffs, ground).expect("a terrain")),
            grid: BoxGrid { bounds: ground, spacing: 0.02 },
        },
    ]
}

/// CPU time of this thread, in milliseconds.
fn now() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    1e3 * time.tv_sec as f64 + 1e-6 * time.tv_nsec as f64
}

/// What is made, and the median time of making it in milliseconds.
fn timed<T>(make: impl Fn() -> T) -> (T, f64) {
    let run = |_| {
        let began = now();
        let made = make();
        (made, now() - began)
    };
    let mut runs: Vec<(T, f64)> = (0..RUNS).map(run).collect();
    let mut times: Vec<f64> = runs.iter().map(|run| run.1).collect();
    times.sort_by(f64::total_cmp);
    (runs.swap_remove(0).0, times[RUNS / 2])
}

impl Object {
    /// Normals are made and timed as well: an extraction has them.
    fn extract(&self, method: &Method) -> (TriangleMesh, f64) {
        let one = Execution { threads: 1 };
        let (mut mesh, ms) = timed(|| {
            let found = method.extract(&mut Extractor::new(), (&*self.field).into(), &self.grid, 0.0, &one);
            found.expect("a method that goes with every grid").mesh
        });
        mesh.normals = Vec::new();
        (mesh, ms)
    }

    fn points(&self) -> IsosurfacePoints {
        IsosurfacePoints::of(&*self.field, 0.0, &self.grid, None, &Execution { threads: 0 })
            .expect("a surface")
    }

    fn row(
        &self,
        points: &IsosurfacePoints,
        label: &str,
        extraction_ms: f64,
        finishing_ms: Option<f64>,
        mesh: &TriangleMesh,
    ) {
        let (edge, all) = (f64::from(self.grid.spacing), Execution { threads: 0 });
        let of = accuracy_beside(points, mesh, &*self.field, 0.0, self.grid.spacing, &all).expect("threads");
        let (shapes, counts) = (quality(mesh), topology(mesh));
        let pairs = self_intersections(mesh).map_or_else(|_| "-".to_owned(), |pairs| pairs.to_string());
        let finishing = finishing_ms.map_or_else(String::new, |ms| format!("{ms:.1}"));
        println!(
            "| {} | {label} | {extraction_ms:.1} | {finishing} | {} | {:.3} | {:.2} | {:.4} | {:.3} | {:.3} | {} | {} | {pairs} |",
            self.name,
            mesh.triangles.len(),
            shapes.radius_ratio.mean,
            shapes.min_angle_deg.min,
            of.distance.mean / edge,
            of.distance.max / edge,
            of.distance_to_mesh.max / edge,
            counts.euler_characteristic,
            counts.non_manifold_edges + counts.non_manifold_vertices,
        );
    }
}

/// What no step but merging may change.
fn kept(of: &TopologyReport) -> [i64; 5] {
    let faults = [of.non_manifold_edges, of.non_manifold_vertices, of.boundary_edges];
    let [edges, vertices, border] = faults.map(|count| count as i64);
    [of.euler_characteristic, of.components as i64, edges, vertices, border]
}

#[test]
#[ignore = "a minute: run by make test-long; prints times"]
fn what_each_step_gives_for_its_cost() {
    println!(
        "| object | mesh | extraction, ms | finishing, ms | triangles | radius ratio | least angle, deg | mean distance | largest | largest \
         back | Euler characteristic | faults | intersecting pairs |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    let tetrahedra = |clustering| {
        Method::Tetrahedra(Tetrahedra::new(Arrangement::BodyCentred).with_clustering(clustering))
    };
    let preset = |id: &str| presets().iter().find(|preset| preset.id == id).expect("a preset").method;
    for object in objects() {
        let (points, edge) = (object.points(), f64::from(object.grid.spacing));
        let (none, none_ms) = object.extract(&tetrahedra(Clustering::None));
        let (integrated, integrated_ms) = object.extract(&tetrahedra(Clustering::Integrated));
        let (collapse, collapse_ms) = object.extract(&tetrahedra(Clustering::EdgeCollapse));
        object.row(&points, "`bu`, no clustering", none_ms, None, &none);
        object.row(&points, "`bi`, integrated", integrated_ms, None, &integrated);
        object.row(&points, "`bp`, edge collapse", collapse_ms, None, &collapse);
        let budget = integrated.triangles.len() as u64;
        let decimate = |triangles| Step::Decimate {
            triangles: Some(triangles),
            ratio: None,
            error: None,
            lock_borders: false,
        };
        let (cubes, cubes_ms) = object.extract(&preset("mc"));
        let (nets, nets_ms) = object.extract(&preset("nets"));
        let used = topology(&integrated).vertices;
        let of_none = [
            ("`bu` + merge 0.3", Step::MergeByDistance { tolerance: 0.3 * edge }),
            ("`bu` + coplanar 0.02", Step::Coplanar { tolerance: 0.02 * edge }),
            ("`bu` + decimate", decimate(budget)),
            ("`bu` + re-tile", Step::ReTile { points: used, by: Density::Area, seed: 1 }),
            ("`bu` + re-tile by curvature", Step::ReTile { points: used, by: Density::Curvature, seed: 1 }),
        ];
        let of_others = [
            ("`bi` + decimate to half", &integrated, integrated_ms, decimate(budget / 2)),
            ("`mc` + decimate to half", &cubes, cubes_ms, decimate(cubes.triangles.len() as u64 / 2)),
            ("`nets` + decimate to half", &nets, nets_ms, decimate(nets.triangles.len() as u64 / 2)),
        ];
        object.row(&points, "`mc`", cubes_ms, None, &cubes);
        object.row(&points, "`nets`", nets_ms, None, &nets);
        let of_none = of_none.map(|(label, step)| (label, &none, none_ms, step));
        for (label, mesh, extraction_ms, step) in of_none.into_iter().chain(of_others) {
            let whole = Extent::Whole;
            let (found, ms) = timed(|| step.apply(mesh, whole).expect("a step that goes with every mesh"));
            object.row(&points, label, extraction_ms, Some(ms), &found.mesh);
            if !matches!(step, Step::MergeByDistance { .. }) {
                assert_eq!(kept(&topology(&found.mesh)), kept(&topology(mesh)), "{label}");
            }
            if let Step::Decimate { triangles: Some(budget), .. } = step {
                assert!(found.mesh.triangles.len() as u64 <= budget, "{label}: {:?}", found.stopped);
            }
            if let Step::ReTile { points, .. } = step {
                let left = found.stopped.first().map_or(0, |stopped| stopped.left);
                assert_eq!(topology(&found.mesh).vertices, points + left, "{label}");
                found.stopped.iter().for_each(|stopped| println!("<!-- {label}: {stopped} -->"));
            }
        }
    }
}
