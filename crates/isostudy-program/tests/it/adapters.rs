//! The adapters in `scripts/methods/`, where their libraries are installed: `pip install -r scripts/methods/requirements.txt`.
//!
//! `METHODS_PYTHON` names the Python that has them; otherwise it is `python3`. `PEERS_WORKER` names the program of `scripts/peers`.
//! What is not there is skipped, and said.

use std::f64::consts::PI;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use isostudy_mesh::TriangleMesh;
use isostudy_mesh::topology::topology;
use isostudy_program::{Problem, Program, Request, Samples, Worker};

/// The samples of a sphere of radius 1, by the shape of the grid that `scripts/peers` has.
const REACH: f64 = 1.1;

struct Sphere {
    size: [u32; 3],
    origin: [f64; 3],
    spacing: [f64; 3],
    centre: [f64; 3],
    values: Vec<f32>,
}

impl Sphere {
    /// Cells along x, y and z in a box with the sphere in its middle.
    fn new(cells: [u32; 3], centre: [f64; 3]) -> Self {
        let size = cells.map(|n| n + 1);
        let spacing = cells.map(|n| 2.0 * REACH / f64::from(n));
        let mut values = Vec::new();
        for z in 0..size[2] {
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let at = |i: u32, a: usize| spacing[a] * f64::from(i) - REACH;
                    let square = at(x, 0).powi(2) + at(y, 1).powi(2) + at(z, 2).powi(2);
                    values.push((1.0 - square.sqrt()) as f32);
                }
            }
        }
        Self { size, origin: centre.map(|c| c - REACH), spacing, centre, values }
    }
}

/// A worker of the adapter, or none and a note if what it needs is not installed.
fn start(adapter: &str, package: &str) -> Option<Worker> {
    let python = std::env::var("METHODS_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let import = Command::new(&python).args(["-c", &format!("import numpy, {package}")]).output();
    if !import.is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED: {adapter}: {python} has no numpy or no {package}");
        return None;
    }
    Some(worker(vec![python, format!("./{adapter}.py")]))
}

/// A worker of another crate, or none and a note if nobody says where the program is.
fn start_crate(method: &str) -> Option<Worker> {
    let Ok(program) = std::env::var("PEERS_WORKER") else {
        eprintln!("SKIPPED: {method}: PEERS_WORKER does not name the program that scripts/peers builds");
        return None;
    };
    Some(worker(vec![program, "--method".to_owned(), method.to_owned()]))
}

fn worker(command: Vec<String>) -> Worker {
    let program = Program {
        command,
        base: Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/methods"),
        time_limit: Duration::from_secs(300),
        memory_limit_bytes: Some(4 << 30),
        sandbox: false,
    };
    Worker::start(&program).expect("the adapter starts")
}

fn request(sphere: &Sphere, isovalue: f64) -> Request<'_> {
    Request {
        samples: Samples::Values(&sphere.values),
        size: sphere.size,
        origin: sphere.origin,
        spacing: sphere.spacing,
        isovalue,
        mesh: Some("mesh.ply".as_ref()),
        may_be_empty: false,
    }
}

fn extract(worker: &mut Worker, sphere: &Sphere, isovalue: f64) -> TriangleMesh {
    let answer = worker.extract(&request(sphere, isovalue)).expect("an answer");
    assert!(answer.extraction_s.expect("it is told") > 0.0);
    answer.mesh.expect("a mesh")
}

/// Closed, in one piece, and where a sphere is.
fn assert_is_sphere(mesh: &TriangleMesh, sphere: &Sphere, radius: f64, error: f64) {
    let report = topology(mesh);
    assert!(
        report.is_closed_manifold() && report.components == 1 && report.euler_characteristic == 2,
        "{report:?}"
    );
    assert_lies_on_sphere(mesh, sphere, radius, error);
}

/// Facing outward, of the volume of a ball, and nowhere farther than `error` from its surface.
fn assert_lies_on_sphere(mesh: &TriangleMesh, sphere: &Sphere, radius: f64, error: f64) {
    let distance = |p: &isostudy_mesh::glam::Vec3| {
        let d = [0, 1, 2].map(|a| f64::from(p.to_array()[a]) - sphere.centre[a]);
        d.iter().map(|x| x * x).sum::<f64>().sqrt()
    };
    let worst = mesh.positions.iter().map(|p| (distance(p) - radius).abs()).fold(0.0, f64::max);
    assert!(worst < error, "a vertex is {worst} off");
    let ball = 4.0 / 3.0 * PI * radius.powi(3);
    // A layer of the sphere's area and that thickness is the most that the volume can be off.
    assert!(
        (mesh.volume() - ball).abs() < 4.0 * PI * radius.powi(2) * 1.5 * error,
        "{} and {ball}",
        mesh.volume()
    );
}

/// The sphere of `scripts/peers` at 100 cells, whose counts are published with the table of other libraries; then one whose
/// axes differ in every way, cut at another value.
fn check(worker: Option<Worker>, triangles: usize, error_of_spacing: f64) {
    let Some(mut worker) = worker else { return };
    let sphere = Sphere::new([100; 3], [0.0; 3]);
    let mesh = extract(&mut worker, &sphere, 0.0);
    assert_is_sphere(&mesh, &sphere, 1.0, error_of_spacing * sphere.spacing[0]);
    assert_eq!(mesh.triangles.len(), triangles);

    let sphere = Sphere::new([60, 50, 40], [3.0, -5.0, 7.0]);
    let mesh = extract(&mut worker, &sphere, 0.25);
    assert_is_sphere(&mesh, &sphere, 0.75, error_of_spacing * sphere.spacing[2]);
    worker.finish().expect("it ends with its input");
}

/// Linear interpolation along an edge of length h errs by h^2 / 8 over the radius, at most, where the field is a distance.
const INTERPOLATED: f64 = 0.02;

#[test]
fn flying_edges_of_vtk_make_a_sphere() {
    check(start("vtk_flying_edges", "vtkmodules"), 78_008, INTERPOLATED);
}

#[test]
fn marching_cubes_of_scikit_image_make_a_sphere() {
    check(start("skimage_lewiner", "skimage"), 78_008, INTERPOLATED);
}

#[test]
fn marching_cubes_of_pymcubes_make_a_sphere() {
    check(start("pymcubes", "mcubes"), 78_008, INTERPOLATED);
}

#[test]
fn surface_nets_of_vtk_make_a_sphere_though_they_see_labels_only() {
    // fast-surface-nets, which has a square for each edge that is crossed as well, has this many.
    check(start("vtk_surface_nets", "vtkmodules"), 78_012, 0.5);
}

#[test]
fn fast_surface_nets_make_a_sphere() {
    check(start_crate("fast-surface-nets"), 78_012, 0.5);
}

#[test]
fn crates_that_know_cubes_alone_make_a_sphere_and_refuse_other_grids() {
    for method in ["isosurface", "transvoxel"] {
        let Some(mut worker) = start_crate(method) else { return };
        for (cells, isovalue, centre) in [(100, 0.0, [0.0; 3]), (50, 0.25, [3.0, -5.0, 7.0])] {
            let sphere = Sphere::new([cells; 3], centre);
            let mesh = extract(&mut worker, &sphere, isovalue);
            let error = INTERPOLATED * sphere.spacing[0];
            match method {
                // It does not join its vertices, and those that belong together differ in their last digits.
                "isosurface" => assert_lies_on_sphere(&mesh, &sphere, 1.0 - isovalue, error),
                _ => assert_is_sphere(&mesh, &sphere, 1.0 - isovalue, error),
            }
            assert!(cells != 100 || mesh.triangles.len() == 78_008, "{method}: {}", mesh.triangles.len());
        }
        let sphere = Sphere::new([60, 50, 40], [0.0; 3]);
        let refused = worker.extract(&request(&sphere, 0.0)).expect_err("it knows cubes alone");
        assert!(matches!(*refused.problem, Problem::Failed { .. }), "{refused}");
        worker.finish().expect("it ends with its input");
    }
}

#[test]
fn level_set_of_manifold_makes_a_sphere_of_interpolated_samples() {
    let Some(mut worker) = start("manifold_level_set", "manifold3d") else { return };
    let sphere = Sphere::new([24; 3], [3.0, -5.0, 7.0]);
    let mesh = extract(&mut worker, &sphere, 0.25);
    // Twice interpolated: between samples, and along the edges of its own lattice.
    assert_is_sphere(&mesh, &sphere, 0.75, 0.1 * sphere.spacing[0]);
    worker.finish().expect("it ends with its input");
}
