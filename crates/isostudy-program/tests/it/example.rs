//! The example that `docs/programs.md` prints: that page's text runs, and its meshes are what they should be.

use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use isostudy_mesh::topology::topology;
use isostudy_program::{Answer, Program, Request, Samples, Worker};

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn example() -> Worker {
    let program = Program {
        command: ["python3", "./example.py"].map(str::to_owned).to_vec(),
        base: repository().join("scripts/methods"),
        time_limit: Duration::from_secs(300),
        memory_limit_bytes: Some(1 << 30),
        sandbox: false,
    };
    Worker::start(&program).expect("Python starts")
}

/// Samples of a function at the places that a request gives them, x fastest.
fn samples(size: [u32; 3], place: impl Fn([u32; 3]) -> f32) -> Vec<f32> {
    let [nx, ny, nz] = size;
    let rows = (0..nz).flat_map(|z| (0..ny).map(move |y| (y, z)));
    rows.flat_map(|(y, z)| (0..nx).map(move |x| [x, y, z])).map(place).collect()
}

fn extract(request: Request<'_>) -> Answer {
    let mut worker = example();
    let answer = worker.extract(&request).expect("an answer");
    worker.finish().expect("it ends with its input");
    answer
}

#[test]
fn the_page_prints_the_file() {
    let page = fs::read_to_string(repository().join("docs/programs.md")).expect("the page");
    let file = fs::read_to_string(repository().join("scripts/methods/example.py")).expect("the file");
    let (_, rest) = page.split_once("```python\n").expect("a block of Python");
    let (printed, after) = rest.split_once("```").expect("which ends");
    assert_eq!(printed, file);
    assert!(!after.contains("```python"), "there is one");
}

#[test]
fn one_sample_inside_is_one_box_in_its_place() {
    // No two axes have the same size, spacing or place, so that none can stand for another.
    let (size, origin, spacing) = ([5, 6, 7], [10.0, -20.0, 30.0], [0.5, 1.0, 2.0]);
    let values = samples(size, |place| if place == [1, 2, 4] { 3.0 } else { -1.0 });
    let mesh = Some("mesh.ply".as_ref());
    let answer = extract(Request {
        samples: Samples::Values(&values),
        size,
        origin,
        spacing,
        isovalue: 0.0,
        mesh,
        may_be_empty: false,
    });
    let mesh = answer.mesh.expect("a mesh");
    assert_eq!((answer.vertices, answer.triangles), (8, 12));
    assert!(topology(&mesh).is_closed_manifold());
    let bounds = mesh.bounds().expect("eight vertices");
    assert_eq!(bounds.min.to_array(), [10.25, -18.5, 37.0]);
    assert_eq!(bounds.max.to_array(), [10.75, -17.5, 39.0]);
    // Positive: its triangles face outward.
    assert!((mesh.volume() - 1.0).abs() < 1e-5, "{}", mesh.volume());
}

#[test]
fn a_sphere_is_closed_and_has_a_box_for_each_sample_inside() {
    let (n, spacing) = (31, 0.08);
    let origin = -0.5 * spacing * f64::from(n - 1);
    let at = |i: u32| origin + spacing * f64::from(i);
    let values = samples([n; 3], |p| (1.0 - p.map(|i| at(i).powi(2)).iter().sum::<f64>()) as f32);
    let answer = extract(Request {
        samples: Samples::Values(&values),
        size: [n; 3],
        origin: [origin; 3],
        spacing: [spacing; 3],
        isovalue: 0.0,
        mesh: Some("mesh.ply".as_ref()),
        may_be_empty: false,
    });
    let mesh = answer.mesh.expect("a mesh");
    let report = topology(&mesh);
    assert!(
        report.is_closed_manifold() && report.components == 1 && report.euler_characteristic == 2,
        "{report:?}"
    );
    let inside = values.iter().filter(|&&value| value > 0.0).count();
    let boxes = inside as f64 * spacing.powi(3);
    assert!((mesh.volume() - boxes).abs() < 1e-5 * boxes, "{} and {boxes}", mesh.volume());
    // Samples inside are as many as the volume has cells, but for a part of those at the surface: of 4 pi / h^2 cells about,
    // with an error that averages out to far less than 2 % here.
    assert!((mesh.volume() / (4.0 / 3.0 * PI) - 1.0).abs() < 0.02);
    // Squares facing six ways: half as much again as the sphere's own area.
    assert!((mesh.area() / (4.0 * PI) - 1.5).abs() < 0.05, "{}", mesh.area());
    assert!(answer.extraction_s.expect("it is told") <= answer.wall.as_secs_f64());
}

#[test]
fn a_sample_equal_to_the_isovalue_is_outside() {
    let worker = |isovalue| {
        let values = samples([3; 3], |place| if place == [1; 3] { 2.0 } else { 0.0 });
        extract(Request {
            samples: Samples::Values(&values),
            size: [3; 3],
            origin: [0.0; 3],
            spacing: [1.0; 3],
            isovalue,
            mesh: Some("mesh.ply".as_ref()),
            may_be_empty: true,
        })
        .triangles
    };
    assert_eq!([worker(1.0), worker(2.0), worker(0.0)], [12, 0, 12]);
}
