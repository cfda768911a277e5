//! `isostudy extract` without a study, as a user runs it: formulas, volumes, meshes; what is written and what is refused.

use crate::command::{Folder, Run};
use isostudy_mesh::quality::quality;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{MeshFormat, TriangleMesh};
use std::path::Path;

/// A mesh that was written.
fn mesh_of(folder: &Folder, name: &str) -> TriangleMesh {
    let extension = Path::new(name).extension().unwrap().to_str().unwrap();
    let format = MeshFormat::from_extension(extension).unwrap();
    format.read(&*std::fs::read(folder.path(name)).unwrap()).unwrap()
}

const BALL: [&str; 6] = [
    "--field",
    "sqrt(x^2+y^2+z^2) - 1",
    "--bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2",
    "--spacing",
    "0.05",
    "--isovalue=0",
];
const BALL_VOLUME: f64 = 4.0 / 3.0 * std::f64::consts::PI;

fn ball(more: &[&'static str]) -> Vec<&'static str> {
    [&BALL, more].concat()
}

#[test]
fn a_formula_becomes_a_mesh_in_every_format_and_on_any_number_of_threads() {
    let folder = Folder::of("extract");
    let arrangement = ["--arrangement", "body-centred", "--clustering", "integrated", "-o"];
    for name in ["ball.ply", "ball.obj", "ball.stl", "ball.glb"] {
        let said = folder.succeed(&[&ball(&arrangement)[..], &[name]].concat());
        assert_eq!(said.stdout, format!("{name}\n"));
    }
    let ply = mesh_of(&folder, "ball.ply");
    assert!(topology(&ply).is_closed_manifold());
    // Triangles face outward, though the formula is negative inside.
    assert!((ply.volume() - BALL_VOLUME).abs() < 0.02, "{}", ply.volume());
    assert_eq!(mesh_of(&folder, "ball.obj"), ply);
    let stl = mesh_of(&folder, "ball.stl");
    assert_eq!(stl.triangles.len(), ply.triangles.len());
    assert!(topology(&stl).is_closed_manifold() && (stl.volume() - ply.volume()).abs() < 1e-6);
    assert!(std::fs::read(folder.path("ball.glb")).unwrap().starts_with(b"glTF\x02\0\0\0"));
    let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
    for threads in ["1", "2", "5"] {
        folder.succeed(&[&ball(&arrangement)[..], &["again.ply", "--threads", threads]].concat());
        assert_eq!(bytes("again.ply"), bytes("ball.ply"), "{threads} threads");
    }
}

#[test]
fn inside_is_the_side_that_is_asked_for() {
    let folder = Folder::of("extract");
    for (formula, side, isovalue) in [
        ("1 - length(x,y,z)", "above", "0"),
        ("length(x,y,z)", "below", "1"),
        ("-length(x,y,z)", "above", "-1"),
    ] {
        let arguments =
            ["--field", formula, BALL[2], "--cells", "40", "--inside", side, "--isovalue", isovalue];
        folder.succeed(&[&arguments[..], &["-o", "a.ply"]].concat());
        let volume = mesh_of(&folder, "a.ply").volume();
        assert!((volume - BALL_VOLUME).abs() < 0.05, "{formula} {side}: {volume}");
    }
}

#[test]
fn the_report_is_text_or_json() {
    let folder = Folder::of("extract");
    let said = folder.succeed(&ball(&["-o", "ball.ply", "--quality", "--picture", "ball.png"]));
    assert!(
        said.stdout.contains("closed manifold; 1 component, Euler characteristic 2, 0 boundary loops"),
        "{}",
        said.stdout
    );
    assert!(said.stdout.ends_with("ball.ply\n"));
    assert!(std::fs::read(folder.path("ball.png")).unwrap().starts_with(b"\x89PNG"));
    let said = folder.succeed(&ball(&["-o", "ball.ply", "--json"]));
    let report: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(report["schema"], 1);
    assert_eq!(report["source"], "sqrt(x^2+y^2+z^2) - 1");
    assert_eq!(report["topology"]["euler_characteristic"], 2);
    assert!((report["volume"].as_f64().unwrap() - BALL_VOLUME).abs() < 0.02);
    // Both ways: how far the mesh is from the sphere, and the sphere from the mesh.
    assert!(report["accuracy"]["distance_to_mesh"]["max"].as_f64().unwrap() < 0.005);
    assert_eq!(report["inside"], "below");
    assert_eq!(report["cells"], serde_json::json!([48, 48, 48]));
    let (farthest, area) =
        (report["accuracy"]["distance"]["max"].as_f64().unwrap(), report["area"].as_f64().unwrap());
    assert!(farthest < 0.005 && (area - 3.0 * BALL_VOLUME).abs() < 0.05, "{farthest} {area}");
}

/// 32 samples a side, a ball of radius 10 round the middle, brighter inside.
fn ball_volume(folder: &Folder, name: &str) {
    let at = |i: usize| (0..3).map(|k| ((i / 32usize.pow(k) % 32) as f32 - 15.5).powi(2)).sum::<f32>().sqrt();
    let values: Vec<u8> = (0..32768).map(|i| (100.0 - 5.0 * at(i)).max(0.0).round() as u8).collect();
    let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 32 32 32\nencoding: raw\nspace dimension: 3\n\
                  space directions: (-0.1,0,0) (0,0.1,0) (0,0,0.1)\nspace origin: (1.55,-1.55,-1.55)\n\n";
    folder.write(name, [header.as_bytes(), &values].concat());
}

#[test]
fn a_volume_becomes_a_mesh() {
    let folder = Folder::of("extract");
    ball_volume(&folder, "ball.nrrd");
    folder.succeed(&["--volume", "ball.nrrd", "--isovalue", "50", "-o", "ball.ply"]);
    let mesh = mesh_of(&folder, "ball.ply");
    assert!(topology(&mesh).is_closed_manifold());
    assert!((mesh.volume() - BALL_VOLUME).abs() < 0.1, "{}", mesh.volume());
    // Outside of the ball is solid as well, and ends where the volume ends, or is closed there.
    let around = ["--volume", "ball.nrrd", "--isovalue", "50", "--inside", "below"];
    folder.succeed(&[&around[..], &["-o", "open.ply"]].concat());
    let open = topology(&mesh_of(&folder, "open.ply"));
    folder.succeed(&[&around[..], &["-o", "closed.ply", "--close"]].concat());
    let closed = mesh_of(&folder, "closed.ply");
    assert!(topology(&closed).is_closed_manifold() && open.components == 1);
    // It ends less than a step of 0.1 beyond the last sample on each side.
    let whole = closed.volume() + BALL_VOLUME;
    assert!((3.1f64.powi(3)..3.3f64.powi(3)).contains(&whole), "{whole}");

    let said = folder.run(&["--volume", "ball.nrrd", "-o", "a.ply"]);
    assert!(said.code == Some(2) && said.stderr.contains("--isovalue"), "{}", said.stderr);
    let said = folder.run(&["--volume", "ball.nrrd", "--isovalue", "500", "-o", "a.ply"]);
    assert!(
        said.code == Some(2)
            && said.stderr.contains("every sample lies on one side; the volume's samples run from 0 to 96"),
        "{}",
        said.stderr
    );
    folder.write("short.nrrd", &std::fs::read(folder.path("ball.nrrd")).unwrap()[..20_000]);
    let said = folder.run(&["--volume", "short.nrrd", "--isovalue", "50", "-o", "a.ply"]);
    assert!(
        said.code == Some(2) && said.stderr.contains("short.nrrd: the data ends after 19"),
        "{}",
        said.stderr
    );
}

/// Text, so that a header of any steps can be written by hand.
fn text_volume(folder: &Folder, name: &str, sizes: [usize; 3], geometry: &str, value: impl Fn(usize) -> i32) {
    let samples: Vec<String> = (0..sizes.iter().product()).map(|i| value(i).to_string()).collect();
    let [x, y, z] = sizes;
    let header =
        format!("NRRD0004\ntype: short\ndimension: 3\nsizes: {x} {y} {z}\nencoding: text\n{geometry}\n\n");
    folder.write(name, header + &samples.join(" ") + "\n");
}

#[test]
fn close_closes_whatever_the_steps_the_box_and_the_lattice() {
    let folder = Folder::of("extract");
    // What `--quality` says of it, without distances, which take most of its time.
    let closed = |arguments: &[&str]| {
        let said = folder.succeed(&[arguments, &["-o", "a.ply"]].concat());
        let mesh = mesh_of(&folder, "a.ply");
        assert!(topology(&mesh).is_closed_manifold(), "{arguments:?}: {:?}", topology(&mesh));
        assert_eq!(quality(&mesh).degenerate, 0, "{arguments:?}");
        (mesh, said)
    };
    // A CT with thick slices.
    let dark_end = |i: usize| if i == 63 { -1000 } else { 1000 };
    text_volume(&folder, "ct.nrrd", [4; 3], "spacings: 0.7 0.7 5", dark_end);
    closed(&["--volume", "ct.nrrd", "--isovalue", "300.5", "--close"]);
    for z in [1, 2, 3, 5] {
        text_volume(&folder, "two.nrrd", [4; 3], &format!("spacings: 1 1 {z}"), |_| 2);
        closed(&["--volume", "two.nrrd", "--isovalue", "0.5", "--close"]);
    }
    let body = |i: usize| {
        let at = [i % 40, i / 40 % 40, i / 1600].map(|i| i as f64);
        let wave = (0.4 * at[0]).sin() * (0.3 * at[1]).cos() + (0.9 * at[2] + 0.2 * at[0]).sin();
        (700.0 * wave + 200.0) as i32
    };
    for spacings in ["1 1 3", "0.7 0.7 5"] {
        text_volume(&folder, "body.nrrd", [40, 40, 14], &format!("spacings: {spacings}"), body);
        for isovalue in ["300.5", "-200.5", "200"] {
            for side in ["above", "below"] {
                let isovalue = format!("--isovalue={isovalue}");
                closed(&["--volume", "body.nrrd", &isovalue, "--close", "--inside", side]);
            }
        }
    }
    // The box cuts the solid off.
    text_volume(&folder, "eight.nrrd", [8; 3], "spacings: 1 1 1", |_| 1);
    let cut = ["--volume", "eight.nrrd", "--isovalue", "0.5"];
    let bounds = "--bounds=0,0,0,7,7,7";
    // On a lattice finer than the samples, so that what closing cuts off the block's edges is little.
    let (block, _) = closed(&[&cut[..], &["--close", bounds, "--method", "bi"]].concat());
    assert!((block.volume() - 343.0).abs() < 10.0, "{}", block.volume());
    for arrangement in ["simple-cubic", "five-tetrahedra", "face-centred"] {
        closed(&[&cut[..], &["--close", "--bounds=1,2,0.5,5.3,6,9", "--arrangement", arrangement]].concat());
    }
    // A formula has no end, and a mesh is cut by a box: both are closed by its walls.
    for arrangement in ["body-centred", "simple-cubic", "five-tetrahedra", "face-centred"] {
        let (slab, _) = closed(&[
            "--field",
            "z",
            "--bounds=-1,-1,-1,1,1,1",
            "--cells",
            "20",
            "--close",
            "--arrangement",
            arrangement,
        ]);
        assert!((slab.volume() - 4.0).abs() < 0.5, "{arrangement}: {}", slab.volume());
    }
    folder.succeed(&ball(&["-o", "ball.ply"]));
    let (half, _) = closed(&["--mesh", "ball.ply", "--bounds=0,-2,-2,2,2,2", "--cells", "40", "--close"]);
    assert!((half.volume() - 2.0 * std::f64::consts::PI / 3.0).abs() < 0.1, "{}", half.volume());
    // One axis along the diagonal of space: closed without being asked, on fine and coarse lattices.
    let geometry = "space dimension: 3\nspace origin: (0,0,0)\nspace directions: (0.577350269,0.577350269,0.577350269) \
                    (0.707106781,-0.707106781,0) (0.408248290,0.408248290,-0.816496581)";
    text_volume(&folder, "turned.nrrd", [4; 3], geometry, |_| 1);
    for cells in ["20", "40", "80"] {
        let (_, said) = closed(&["--volume", "turned.nrrd", "--isovalue", "0.01", "--cells", cells]);
        assert!(said.stderr.contains("closed where it leaves it"), "{}", said.stderr);
        closed(&[
            "--volume",
            "turned.nrrd",
            "--isovalue",
            "0.01",
            "--cells",
            cells,
            "--close",
            "--bounds=0,0,0,1,1,1",
        ]);
    }
}

#[test]
fn a_terrain_has_no_scraps_at_the_border() {
    let folder = Folder::of("extract");
    let terrain =
        ["--field", "z - 2*sin(x*0.7)*cos(y*0.5)", "--bounds=-8,-8,-4,8,8,4", "-o", "a.ply", "--quality"];
    for lattice in [["--cells", "64"], ["--spacing", "0.3"]] {
        for arrangement in ["body-centred", "simple-cubic", "five-tetrahedra", "face-centred"] {
            let said = folder.succeed(&[&terrain[..], &lattice, &["--arrangement", arrangement]].concat());
            let one = "; 1 component, Euler characteristic 1, 1 boundary loop";
            assert!(said.stdout.contains(one), "{lattice:?} {arrangement}: {}", said.stdout);
        }
    }
}

#[test]
fn a_mesh_becomes_another() {
    let folder = Folder::of("extract");
    folder.succeed(&ball(&["-o", "ball.stl"]));
    folder.succeed(&["--mesh", "ball.stl", "--cells", "40", "-o", "again.ply"]);
    let again = mesh_of(&folder, "again.ply");
    assert!(topology(&again).is_closed_manifold());
    assert!((again.volume() - BALL_VOLUME).abs() < 0.06, "{}", again.volume());
    // Half a unit thicker.
    folder.succeed(&["--mesh", "ball.stl", "--cells", "40", "--isovalue", "-0.5", "-o", "thick.ply"]);
    let thick = mesh_of(&folder, "thick.ply").volume() / BALL_VOLUME;
    assert!((thick - 1.5f64.powi(3)).abs() < 0.1, "{thick}");

    let mut open = isostudy_mesh::weld(&mesh_of(&folder, "ball.stl"));
    let top = |t: &[u32; 3]| t.iter().any(|&v| open.positions[v as usize].z > 0.8);
    let kept = open.triangles.iter().copied().filter(|t| !top(t)).collect();
    open.triangles = kept;
    let write = |name: &str, mesh: &TriangleMesh| {
        let mut bytes = Vec::new();
        isostudy_mesh::write_ply(mesh, &mut bytes).unwrap();
        folder.write(name, bytes);
    };
    write("open.ply", &open);
    let said = folder.run(&["--mesh", "open.ply", "-o", "a.ply"]);
    assert_eq!(said.code, Some(2));
    assert!(
        said.stderr.contains("edges at holes") && said.stderr.contains("--allow-open"),
        "{}",
        said.stderr
    );
    folder.succeed(&["--mesh", "open.ply", "--allow-open", "--cells", "40", "-o", "a.ply"]);
    let spanned = mesh_of(&folder, "a.ply");
    assert!(topology(&spanned).is_closed_manifold() && spanned.volume() > 0.85 * BALL_VOLUME);

    write("inward.ply", &isostudy_mesh::repair::flip(&again));
    let said = folder.succeed(&["--mesh", "inward.ply", "--cells", "40", "-o", "a.ply"]);
    assert!(said.stderr.contains("inward.ply: its triangles face inward: turned round"), "{}", said.stderr);
    assert!(mesh_of(&folder, "a.ply").volume() > 4.0);
    // Of two balls, the second faces inward and is no cavity of the first.
    let apart = isostudy_mesh::repair::flip(&again.transformed(|p| p * 0.5 + glam::Vec3::new(3.0, 0.0, 0.0)));
    let moved = |t: &[u32; 3]| t.map(|v| v + again.positions.len() as u32);
    write(
        "two.ply",
        &TriangleMesh {
            positions: [&again.positions[..], &apart.positions].concat(),
            normals: Vec::new(),
            triangles: again.triangles.iter().copied().chain(apart.triangles.iter().map(moved)).collect(),
        },
    );
    let said = folder.succeed(&["--mesh", "two.ply", "--cells", "60", "-o", "a.ply"]);
    assert!(said.stderr.contains("two.ply: part 2 of 2, from ["), "{}", said.stderr);
    assert!((mesh_of(&folder, "a.ply").volume() - again.volume()).abs() < 0.1);
    folder.write("nan.obj", "v 0 0 0\nv 1 nan 0\n");
    let said = folder.run(&["--mesh", "nan.obj", "-o", "a.ply"]);
    assert!(
        said.code == Some(2) && said.stderr.contains("nan.obj: line 2: `nan` is not a finite"),
        "{}",
        said.stderr
    );
}

#[test]
fn every_arrangement_has_a_clustering_of_its_own() {
    let folder = Folder::of("extract");
    for (arrangement, clustering) in [
        ("body-centred", "integrated"),
        ("simple-cubic", "integrated"),
        ("five-tetrahedra", "edge-collapse"),
        ("face-centred", "edge-collapse"),
    ] {
        let said = folder.succeed(&ball(&["-o", "a.ply", "--json", "--arrangement", arrangement]));
        let report: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
        assert_eq!(report["clustering"], clustering, "{arrangement}");
        assert!((report["volume"].as_f64().unwrap() - BALL_VOLUME).abs() < 0.02, "{arrangement}");
    }
}

/// A vertex that no triangle uses may lie anywhere; scanners leave some.
#[test]
fn what_no_triangle_uses_does_not_count() {
    let folder = Folder::of("extract");
    folder.succeed(&ball(&["-o", "ball.obj"]));
    let mut text = std::fs::read_to_string(folder.path("ball.obj")).unwrap();
    text += "v 0 0 500\n";
    folder.write("far.obj", text);
    for (input, output) in [("ball.obj", "a.ply"), ("far.obj", "b.ply")] {
        folder.succeed(&["--mesh", input, "--cells", "30", "-o", output]);
    }
    assert_eq!(mesh_of(&folder, "a.ply"), mesh_of(&folder, "b.ply"));
}

#[test]
fn nothing_is_written_over_that_was_given() {
    let folder = Folder::of("extract");
    folder.succeed(&ball(&["-o", "ball.ply"]));
    let before = std::fs::read(folder.path("ball.ply")).unwrap();
    std::fs::create_dir(folder.path("below")).unwrap();
    for out in ["ball.ply", "./ball.ply", "below/../ball.ply"] {
        let said = folder.run(&["--mesh", "ball.ply", "-o", out]);
        assert!(said.code == Some(2) && said.stderr.contains("is the input"), "{out}: {}", said.stderr);
    }
    for picture in ["ball.ply", "ball.jpg", "ball"] {
        let said = folder.run(&ball(&["-o", "ball.ply", "--picture", picture]));
        assert!(
            said.code == Some(2) && said.stderr.contains("pictures are .png"),
            "{picture}: {}",
            said.stderr
        );
    }
    assert_eq!(std::fs::read(folder.path("ball.ply")).unwrap(), before);
}

/// A slab of four samples a side whose slices lie far apart would take a million cubes for each of them.
#[test]
fn a_lattice_far_finer_than_the_samples_is_asked_for_or_not_made() {
    let folder = Folder::of("extract");
    let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\nspacings: 1 1 1e6\n\n";
    let values: Vec<u8> = (0..64).map(|i| if i < 32 { 0 } else { 100 }).collect();
    folder.write("far.nrrd", [header.as_bytes(), &values].concat());
    let said = folder.run(&["--volume", "far.nrrd", "--isovalue", "50.5", "--method", "bi", "-o", "a.ply"]);
    assert!(
        said.code == Some(2) && said.stderr.contains("far.nrrd: cubes as small as its smallest step, 1.0"),
        "{}",
        said.stderr
    );
    folder.succeed(&["--volume", "far.nrrd", "--isovalue", "50.5", "--spacing", "100000", "-o", "a.ply"]);
}

#[test]
fn what_cannot_be_done_is_said_in_one_line() {
    let folder = Folder::of("extract");
    #[cfg(unix)]
    std::os::unix::fs::symlink("/dev/zero", folder.path("zeros.stl")).unwrap();
    for (arguments, want) in [
        (
            vec!["-o", "a.ply"],
            "<STUDY|--field <FORMULA>|--volume <FILE>|--mesh <FILE>|--points <FILE>|--soup <FILE>|--grid <FILE>|--frames <FILE,FILE,...>|--labels <FILE>>",
        ),
        (vec!["--field", "x", "-o", "a.ply"], "--bounds"),
        (ball(&[]), "--out"),
        (ball(&["-o", "a.xyz"]), "a.xyz: known endings are .obj, .ply, .stl, .glb"),
        (ball(&["-o", "a.ply", "--mesh", "b.ply"]), "cannot be used with"),
        (ball(&["-o", "a.ply", "--force"]), "cannot be used with"),
        (ball(&["-o", "a.ply", "--allow-open"]), "cannot be used with"),
        (ball(&["-o", "a.ply", "--arrangement", "hexagonal"]), "`hexagonal` is not known here"),
        (vec!["--field", "x +", BALL[2], "-o", "a.ply"], "--field 'x +': column 4: the end where a number"),
        (
            vec!["--field", "x^2 - 9", BALL[2], "-o", "a.ply"],
            "no surface at isovalue 0 from [-1.2, -1.2, -1.2]",
        ),
        (vec!["--field", "x", "--bounds=1,2,3", "-o", "a.ply"], "six numbers"),
        (
            vec!["--field", "x", "--bounds=0,0,0,1,1,0", "-o", "a.ply"],
            "bounds along z must be finite with min below max",
        ),
        (vec!["--field", "x", BALL[2], "--spacing", "1e-9", "-o", "a.ply"], "exceed the limit"),
        (vec!["--field", "x", BALL[2], "--spacing", "nan", "-o", "a.ply"], "spacing must be positive"),
        (vec!["--field", "x", BALL[2], "--isovalue", "inf", "-o", "a.ply"], "isovalue must be finite"),
        (vec!["--field", "x", BALL[2], "--spacing", "-1", "-o", "a.ply"], "spacing must be positive"),
        (
            vec!["--field", "x", "--bounds=1,1,1,0,0,0", "-o", "a.ply"],
            "bounds along x must be finite with min below max, not 1.0 to 0.0",
        ),
        (vec!["--field", "x", "--bounds=0,0,0,1,inf,1", "-o", "a.ply"], "bounds along y must be finite"),
        (
            ball(&["-o", "a.ply", "--arrangement", "face-centred", "--clustering", "integrated"]),
            "integrated clustering does not go with face-centred: none and edge-collapse do",
        ),
        (vec!["--mesh", "nowhere.ply", "-o", "a.ply"], "nowhere.ply: No such file"),
        (vec!["--mesh", "a.glb", "-o", "a.ply"], "a.glb: known endings are .obj, .ply, .stl"),
        (vec!["--mesh", ".", "-o", "a.ply"], "known endings are .obj, .ply, .stl"),
        #[cfg(unix)]
        (vec!["--mesh", "zeros.stl", "-o", "a.ply"], "zeros.stl: not a file"),
    ] {
        let said = folder.run(&arguments);
        assert_eq!(said.code, Some(2), "{arguments:?}: {}", said.stderr);
        assert!(said.stderr.contains(want), "{arguments:?}: {}", said.stderr);
        assert!(!said.stderr.contains("panicked") && said.stdout.is_empty(), "{}", said.stderr);
    }
    // Deep or endless input ends, and nothing is left behind.
    let deep = format!("{}x{}", "(".repeat(5000), ")".repeat(5000));
    let said = folder.run(&["--field", &deep, BALL[2], "-o", "a.ply"]);
    assert!(said.code == Some(2) && said.stderr.contains("nested deeper than 200 levels"));
    assert_eq!(std::fs::read_dir(folder.root()).unwrap().count(), usize::from(cfg!(unix)));
}

/// A header that claims so many bytes along each axis, as gzip.
fn claim(side: u32) -> Vec<u8> {
    format!("NRRD0004\ntype: uchar\ndimension: 3\nsizes: {side} {side} {side}\nencoding: gzip\n\n")
        .into_bytes()
}

#[test]
fn memory_has_a_limit_that_is_named() {
    let folder = Folder::of("extract");
    // Four bytes a sample: 27,000 samples of a ball in a cube need 108,000, and what is known of blocks of them.
    let n = 30u8;
    let distance = |i: u8| f64::from(i) - f64::from(n - 1) / 2.0;
    let value = |x: u8, y: u8, z: u8| {
        let from_centre = [x, y, z].map(|i| distance(i).powi(2)).iter().sum::<f64>().sqrt();
        if from_centre < 10.0 { b'1' } else { b'0' }
    };
    let mut text =
        format!("NRRD0004\ntype: uchar\ndimension: 3\nsizes: {n} {n} {n}\nencoding: text\n\n").into_bytes();
    for (z, y, x) in (0..n).flat_map(|z| (0..n).flat_map(move |y| (0..n).map(move |x| (z, y, x)))) {
        text.extend([value(x, y, z), b' ']);
    }
    folder.write("ball.nrrd", text);
    folder.write("large.nrrd", claim(1000));
    folder.write("default.nrrd", claim(1100));
    let of = |name: &'static str, more: &[&'static str]| {
        [&["--volume", name, "--isovalue", "0.5", "-o", "a.ply"][..], more].concat()
    };
    for (arguments, want) in [
        (
            of("large.nrrd", &["--memory", "1GiB"]),
            "large.nrrd: 4.0 GiB of memory are needed: 3.8 GiB for 1000 x 1000 x 1000 samples, four bytes each, 136.4 MiB for the \
             ranges of their bricks, ",
        ),
        (of("default.nrrd", &[]), "5.0 GiB for 1100 x 1100 x 1100 samples, four bytes each, "),
        (of("ball.nrrd", &["--memory", "100kB"]), "105.5 KiB for 30 x 30 x 30 samples, four bytes each, "),
        (of("ball.nrrd", &["--memory", "150kB"]), "for the grid; --memory allows 146.4 KiB"),
        (
            ball(&["-o", "a.ply", "--cells", "800", "--memory", "50MB", "--arrangement", "face-centred"])
                .into_iter()
                .filter(|&word| word != "--spacing" && word != "0.05")
                .collect(),
            "the face-centred lattice needs ",
        ),
        (
            ball(&["-o", "a.ply", "--memory", "lots"]),
            "`lots` is not an amount of memory such as 4GiB, 500MB or 4096",
        ),
        (vec!["study.toml", "--memory", "4GiB"], "cannot be used with"),
    ] {
        let said = folder.run(&arguments);
        assert!(said.code == Some(2) && said.stdout.is_empty(), "{arguments:?}: {}", said.stderr);
        assert!(said.stderr.contains(want), "{arguments:?}: {}", said.stderr);
    }
    assert!(!folder.path("a.ply").exists());
    folder.succeed(&of("ball.nrrd", &["--memory", "5MB", "--threads", "1"]));
}

/// Pipes that nobody writes to, devices that never end, and names that lead to them.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_not_read() {
    let folder = Folder::of("extract");
    for pipe in ["pipe.ply", "pipe.nrrd", "pipe.mha", "pipe.raw", "pipe.toml"] {
        assert!(std::process::Command::new("mkfifo").arg(folder.path(pipe)).status().unwrap().success());
    }
    for device in ["zero.obj", "zero.nhdr", "zero.raw"] {
        std::os::unix::fs::symlink("/dev/zero", folder.path(device)).unwrap();
    }
    folder.write("ball.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    let header = |data: &str| {
        format!("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: {data}\n")
    };
    folder.write("to-pipe.nhdr", header("pipe.raw"));
    folder.write("to-device.nhdr", header("zero.raw"));
    let volumes = ["pipe.nrrd", "pipe.mha", "pipe.toml", "zero.nhdr", "to-pipe.nhdr", "to-device.nhdr"];
    let of_volume = |name| (vec!["extract", "--volume", name, "--isovalue", "0.5", "-o", "a.ply"], name);
    let of_mesh = |name| (vec!["extract", "--mesh", name, "-o", "a.ply"], name);
    let meshes = ["pipe.ply", "zero.obj"];
    let distances = meshes.into_iter().flat_map(|name| {
        [
            (vec!["distance", name, "ball.obj"], name),
            (vec!["distance", "ball.obj", name], name),
            (vec!["distance", "ball.obj", "--mesh", name], name),
        ]
    });
    let of_volumes = volumes
        .into_iter()
        .map(|name| (vec!["distance", "ball.obj", "--volume", name, "--isovalue", "0.5"], name));
    let all =
        volumes.map(of_volume).into_iter().chain(meshes.map(of_mesh)).chain(distances).chain(of_volumes);
    for (words, name) in all {
        let said = Run::of(folder.isostudy().args(&words));
        let data = match name {
            "to-pipe.nhdr" => "pipe.raw",
            "to-device.nhdr" => "zero.raw",
            _ => name,
        };
        let begins = format!("isostudy: {data}: not a file");
        assert!(
            said.code == Some(2) && said.stderr.starts_with(&begins) && said.stderr.lines().count() == 1,
            "{words:?}: {}",
            said.stderr
        );
    }
}

#[cfg(target_os = "linux")]
#[test]
fn what_cannot_be_said_ends_nothing() {
    let folder = Folder::of("extract");
    let turned =
        "space dimension: 3\nspace origin: (0,0,0)\nspace directions: (0.6,0.8,0) (-0.8,0.6,0) (0,0,1)";
    text_volume(&folder, "turned.nrrd", [4; 3], turned, |_| 1);
    let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
    let words = ["extract", "--volume", "turned.nrrd", "--isovalue", "0.5", "--method", "bi", "-o", "a.ply"];
    let ended = folder.isostudy().args(words).stderr(full).status().unwrap();
    assert!(ended.success(), "{ended}");
    assert!(folder.path("a.ply").is_file());
}

#[test]
fn an_open_surface_on_turned_cells_is_told_and_close_closes_it() {
    let folder = Folder::of("extract");
    let directions = |of: &str| format!("space dimension: 3\nspace origin: (0,0,0)\nspace directions: {of}");
    text_volume(&folder, "turned.nrrd", [4; 3], &directions("(0.6,0.8,0) (-0.8,0.6,0) (0,0,1)"), |i| {
        i as i32 % 4
    });
    text_volume(&folder, "straight.nrrd", [4; 3], &directions("(1,0,0) (0,1,0) (0,0,1)"), |i| i as i32 % 4);
    let extract = |file: &str, more: &[&str]| {
        let words = ["--volume", file, "--isovalue", "1.5", "--method", "mc", "-o", "a.ply"];
        folder.succeed(&[&words[..], more].concat()).stderr
    };
    let told = extract("turned.nrrd", &[]);
    assert!(told.contains("turned.nrrd: the grid is turned against the axes, and this method"), "{told}");
    assert!(told.contains("12 boundary edges, one from ") && told.contains("--close closes it"), "{told}");
    assert!(!extract("turned.nrrd", &["--close"]).contains("open"));
    assert!(!extract("straight.nrrd", &[]).contains("open"), "its end is the box's");
}

/// On standard error, so that standard output stays the file's name; the report of --json has it.
#[test]
fn a_surface_says_how_large_it_is_and_how_long_it_took() {
    let folder = Folder::of("extract");
    let ball =
        ["--field", "sqrt(x^2+y^2+z^2) - 1", "--bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2", "--spacing", "0.05"];
    let run = folder.succeed(&[&ball[..], &["--out", "ball.ply", "--method", "mc"]].concat());
    assert_eq!(run.stdout, "ball.ply\n");
    let line = run.stderr.lines().find(|line| line.starts_with("ball.ply: ")).unwrap_or(&run.stderr);
    let words: Vec<&str> = line.split(' ').collect();
    let [_, triangles, "triangles,", vertices, "vertices,", "extracted", "in", time, "ms" | "s"] = words[..]
    else {
        panic!("{line}")
    };
    let number = |text: &str| text.replace(',', "").parse::<u64>().unwrap();
    let header =
        String::from_utf8_lossy(&std::fs::read(folder.path("ball.ply")).unwrap()[..400]).into_owned();
    assert!(header.contains(&format!("element vertex {}\n", number(vertices))), "{header}");
    assert!(header.contains(&format!("element face {}\n", number(triangles))), "{header}");
    assert!(
        triangles.contains(',') && number(triangles) > 1000 && time.parse::<f64>().unwrap() > 0.0,
        "{line}"
    );
    let run = folder.succeed(&[&ball[..], &["--out", "ball.ply", "--json"]].concat());
    assert_eq!(run.stderr, "");
}
