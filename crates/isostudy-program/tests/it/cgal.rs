//! The adapter of CGAL's surface mesher: with a program in CGAL's place, and with CGAL itself where `CGAL_SURFACE_MESHER` names what
//! `make cgal` builds.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use isostudy_mesh::TriangleMesh;
use isostudy_mesh::topology::topology;
use isostudy_program::{Answer, Problem, Program, ProgramError, Request, Samples, Worker};

/// Says that it is CGAL, keeps the words it was given beside itself, and makes one triangle.
const IN_ITS_PLACE: &str = r#"#!/bin/sh
if [ "$1" = version ]; then echo 5.5.1; exit; fi
shift 2
for mesh in "$@"; do :; done
echo "$@" | sed 's/ [^ ]*$//' >> "$0.words"
if [ "${10}" = 7.0 ]; then echo "no room" >&2; exit 1; fi
cat > "$mesh" <<PLY
ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar uint vertex_indices
end_header
10 -20 30
10.5 -20 30
10 -19 30
3 0 1 2
PLY
echo '{"vertices": 3, "triangles": 1, "extraction_s": 0.000001, "evaluations": 9, "smallest_angle": 26.6, "largest_angle": 90.0}'
"#;

/// The adapter, given a program and further words.
fn start(program: &Path, words: &[&str]) -> Result<Worker, ProgramError> {
    let given = ["python3", "./cgal_surface_mesher.py", program.to_str().expect("a path in Unicode")];
    Worker::start(&Program {
        command: given.iter().chain(words).map(|&word| word.to_owned()).collect(),
        base: Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/methods"),
        time_limit: Duration::from_secs(300),
        memory_limit_bytes: Some(1 << 30),
        sandbox: false,
    })
}

fn in_its_place(folder: &Path) -> PathBuf {
    let program = folder.join("cgal");
    fs::write(&program, IN_ITS_PLACE).expect("a file");
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).expect("rights");
    program
}

/// A grid of which no two axes are alike, at an isovalue.
fn ask(worker: &mut Worker, isovalue: f64) -> Result<Answer, ProgramError> {
    worker.extract(&Request {
        samples: Samples::Values(&[1.0; 24]),
        size: [2, 3, 4],
        origin: [10.0, -20.0, 30.0],
        spacing: [0.5, 1.0, 2.0],
        isovalue,
        mesh: Some("mesh.ply".as_ref()),
        may_be_empty: false,
    })
}

#[test]
fn bounds_are_the_smallest_spacing_unless_they_are_given() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = in_its_place(folder.path());
    for words in [&[][..], &["--angle", "25", "--radius", "0.125", "--distance", "0.0625"]] {
        let mut worker = start(&program, words).expect("it starts");
        let answer = ask(&mut worker, 0.25).expect("an answer");
        assert_eq!(answer.mesh.expect("a mesh").triangles.len(), 1);
        assert_eq!(answer.extraction_s, Some(0.000_001));
        worker.finish().expect("it ends with its input");
    }
    let grid = "2 3 4 10.0 -20.0 30.0 0.5 1.0 2.0 0.25";
    let said = fs::read_to_string(folder.path().join("cgal.words")).expect("words");
    assert_eq!(said, format!("{grid} 30.0 0.5 0.5\n{grid} 25.0 0.125 0.0625\n"));
}

#[test]
fn what_the_program_says_is_why_it_failed_and_it_may_be_asked_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = in_its_place(folder.path());
    let mut worker = start(&program, &[]).expect("it starts");
    let refused = ask(&mut worker, 7.0).expect_err("there is no room");
    assert!(matches!(*refused.problem, Problem::Failed { .. }), "{refused}");
    assert!(refused.to_string().contains("no room"), "{refused}");
    ask(&mut worker, 0.25).expect("an answer");
    worker.finish().expect("it ends with its input");
}

#[test]
fn a_program_that_was_not_built_and_bounds_that_do_not_end_are_refused_at_the_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = start(&folder.path().join("cgal"), &[]).expect_err("there is none").to_string();
    assert!(said.contains("make cgal"), "{said}");
    let program = in_its_place(folder.path());
    for (words, reason) in [
        (["--angle", "31"], "from 0 to 30 degrees"),
        (["--radius", "0"], "--radius must be a length above 0"),
        (["--distance", "nan"], "--distance must be a length above 0"),
    ] {
        let said = start(&program, &words).expect_err("it is out of range").to_string();
        assert!(said.contains(reason), "{said}");
    }
}

/// The smallest angle, in degrees.
fn smallest_angle(mesh: &TriangleMesh) -> f32 {
    let corners = mesh.triangles.iter().map(|t| t.map(|v| mesh.positions[v as usize]));
    let angles = corners.flat_map(|[a, b, c]| [(a, b, c), (b, c, a), (c, a, b)]);
    angles.map(|(a, b, c)| (b - a).angle_between(c - a)).fold(f32::INFINITY, f32::min).to_degrees()
}

#[test]
fn cgal_keeps_its_bound_on_closed_surfaces_of_several_pieces_and_closes_them_at_the_box() {
    let Ok(program) = std::env::var("CGAL_SURFACE_MESHER") else {
        eprintln!("SKIPPED: CGAL_SURFACE_MESHER does not name the program that `make cgal` builds");
        return;
    };
    let (n, spacing) = (41_u32, 0.055_f32);
    let distance = |[x, y, z]: [f32; 3], centre: f32| ((x - centre).powi(2) + y * y + z * z).sqrt();
    let ball = |p: [f32; 3]| 1.0 - distance(p, 0.0);
    let shell = |p: [f32; 3]| 0.2 - (0.8 - distance(p, 0.0)).abs();
    let two = |p: [f32; 3]| (0.5 - distance(p, 0.5)).max(0.08 - distance(p, -0.7));
    let half = |p: [f32; 3]| 0.3 - p[0] + 0.3 * p[1];
    type Shape<'a> = &'a dyn Fn([f32; 3]) -> f32;
    // By name, pieces, and volume; trilinear interpolation takes off less than 0.01 of any, and chords of triangles the rest.
    let shapes: [(&str, Shape<'_>, u64, f64, f64); 4] = [
        ("ball", &ball, 1, 4.1888, 0.05),
        ("shell", &shell, 2, 3.2840, 0.05),
        ("two", &two, 2, 0.5257, 0.02),
        ("half", &half, 1, 1.4 * 2.2 * 2.2, 0.1),
    ];
    let mut worker = start(Path::new(&program), &[]).expect("it starts");
    for (name, shape, pieces, volume, error) in shapes {
        let at = |i: u32| i as f32 * spacing - 1.1;
        let places = (0..n.pow(3)).map(|i| [at(i % n), at(i / n % n), at(i / n / n)]);
        let values: Vec<f32> = places.map(shape).collect();
        let mesh = |worker: &mut Worker| {
            let request = Request {
                samples: Samples::Values(&values),
                size: [n; 3],
                origin: [-1.1; 3],
                spacing: [f64::from(spacing); 3],
                isovalue: 0.0,
                mesh: Some("mesh.ply".as_ref()),
                may_be_empty: false,
            };
            worker.extract(&request).expect("an answer").mesh.expect("a mesh")
        };
        let found = mesh(&mut worker);
        let report = topology(&found);
        assert!(report.is_closed_manifold() && report.components == pieces, "{name}: {report:?}");
        assert_eq!(report.euler_characteristic, 2 * pieces as i64, "{name}");
        assert!((found.volume() - volume).abs() < error, "{name}: {}", found.volume());
        // The proof is of positions in double precision.
        assert!(smallest_angle(&found) > 29.99, "{name}: {}", smallest_angle(&found));
        assert_eq!(mesh(&mut worker), found, "{name}: the same again");
    }
    worker.finish().expect("it ends with its input");
}
