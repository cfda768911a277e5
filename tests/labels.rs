//! `isostudy extract --labels`, as a user runs it: what is written in each format, what is said, what is refused.

use crate::command::Folder;
use isostudy_mesh::MeshFormat;
use serde_json::json;

/// Two blocks of 3 x 4 x 4 samples side by side, labels 2 and 5, a step of 2 along x, in a volume of 10 x 8 x 8.
fn blocks(folder: &Folder) {
    let label = |i: usize| {
        let [x, y, z] = [i % 10, i / 10 % 8, i / 80];
        let is_in = (2..6).contains(&y) && (2..6).contains(&z);
        match x {
            2..5 if is_in => "2",
            5..8 if is_in => "5",
            _ => "0",
        }
    };
    let samples: Vec<&str> = (0..640).map(label).collect();
    let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 10 8 8\nspacings: 2 1 1\nencoding: text\n\n";
    folder.write("blocks.nrrd", header.to_owned() + &samples.join(" "));
}

#[test]
fn boundaries_are_written_with_their_labels() {
    let folder = Folder::of("extract");
    blocks(&folder);
    for name in ["blocks.ply", "blocks.obj", "blocks.glb"] {
        let said = folder.succeed(&["--labels", "blocks.nrrd", "-o", name, "--picture", "blocks.png"]);
        assert_eq!(said.stdout, format!("{name}\n"));
    }
    assert!(std::fs::read(folder.path("blocks.png")).unwrap().starts_with(b"\x89PNG"));
    let file = std::fs::read_to_string(folder.path("blocks.obj")).unwrap();
    let groups: Vec<&str> = file.lines().filter(|line| line.starts_with('g')).collect();
    assert_eq!(groups, ["g label_2_0", "g label_5_0", "g label_5_2"]);
    let ply = MeshFormat::Ply.read(&*std::fs::read(folder.path("blocks.ply")).unwrap()).unwrap();
    // A block has 2 * (3*4 + 3*4) + 4*4 faces of samples to the background, and 4*4 to the other.
    assert_eq!(ply.triangles.len(), 2 * (2 * (48 + 16) + 16));
    // Between the last samples of a block and those beyond, along x in steps of 2.
    let bounds = ply.bounds().unwrap();
    assert_eq!((bounds.min.to_array(), bounds.max.to_array()), ([3.0, 1.5, 1.5], [15.0, 5.5, 5.5]));
    let gltf = std::fs::read(folder.path("blocks.glb")).unwrap();
    let length = u32::from_le_bytes(gltf[12..16].try_into().unwrap()) as usize;
    let document: serde_json::Value = serde_json::from_slice(&gltf[20..20 + length]).unwrap();
    let primitives = document["meshes"][0]["primitives"].as_array().unwrap();
    let extras: Vec<_> = primitives.iter().map(|of| of["extras"].clone()).collect();
    let pair = |inside, outside| json!({ "inside": inside, "outside": outside });
    assert_eq!(extras, [pair(2, 0), pair(5, 0), pair(5, 2)]);
}

#[test]
fn the_report_counts_labels_and_boundaries() {
    let folder = Folder::of("extract");
    blocks(&folder);
    let of = ["--labels", "blocks.nrrd", "-o", "blocks.ply"];
    let said = folder.succeed(&[&of[..], &["--json"]].concat());
    let report: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(report["samples"], json!([10, 8, 8]));
    assert_eq!(report["boundaries"][2], json!({ "inside": 5, "outside": 2, "triangles": 32 }));
    let labels = report["labels"].as_array().unwrap();
    assert_eq!(labels.len(), 3);
    for (i, label, samples) in [(0, 0, 544), (1, 2, 48), (2, 5, 48)] {
        assert_eq!(
            (labels[i]["label"].clone(), labels[i]["samples"].clone()),
            (json!(label), json!(samples))
        );
    }
    // Rounded at its edges: less than 48 samples of volume 2.
    let volume = labels[1]["volume"].as_f64().unwrap();
    assert!((78.0..96.0).contains(&volume), "{volume}");
    assert_eq!(labels[0]["volume"], json!(null));
    let said = folder.succeed(&[&of[..], &["--quality"]].concat());
    assert!(
        said.stdout.contains("boundaries      inside/outside: triangles 2/0: 128, 5/0: 128, 5/2: 32\n"),
        "{}",
        said.stdout
    );
    // Smoothed and chosen.
    let recipe = "{ kind = \"surface-nets\", smoothing = 4 }";
    let said = folder.succeed(&[&of[..], &["--json", "--only", "5", "--recipe", recipe]].concat());
    let report: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!((report["smoothing"].clone(), report["triangles"].clone()), (json!(4), json!(160)));
    let smooth = report["labels"][1]["volume"].as_f64().unwrap();
    assert!(smooth < volume && smooth > 0.5 * volume, "{smooth} of {volume}");
}

#[test]
fn what_leaves_the_volume_is_open_or_closed() {
    let folder = Folder::of("extract");
    let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: text\n\n";
    let samples: Vec<&str> = (0..64).map(|i| if i % 4 < 2 { "1" } else { "3" }).collect();
    folder.write("halves.nrrd", header.to_owned() + &samples.join(" "));
    let of = ["--labels", "halves.nrrd", "-o", "halves.ply"];
    let said = folder.succeed(&[&of[..], &["--quality"]].concat());
    assert!(
        said.stdout.contains("label 1         32 samples, 8 triangles, area 4.000000, open at 8 edges"),
        "{}",
        said.stdout
    );
    let said = folder.succeed(&[&of[..], &["--quality", "--close"]].concat());
    // A layer of background half a step beyond 2 x 4 x 4 samples.
    assert_eq!(said.stdout.matches(", volume ").count(), 2, "{}", said.stdout);
    assert!(!said.stdout.contains("open at"), "{}", said.stdout);
}

#[test]
fn what_is_wrong_is_said() {
    let folder = Folder::of("extract");
    blocks(&folder);
    let header = "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nencoding: text\n\n";
    folder.write("half.nrrd", header.to_owned() + "0 0 1 1 0 0 0.5 1");
    folder.write("minus.nrrd", header.to_owned() + "0 0 1 1 0 0 -3 1");
    folder.write("one.nrrd", header.to_owned() + "7 7 7 7 7 7 7 7");
    let blocks = ["--labels", "blocks.nrrd"];
    let clamped = "{ kind = \"surface-nets\", edge_clamp = 0.25 }";
    let refused: &[(&[&str], &str)] = &[
        (
            &["--labels", "half.nrrd", "-o", "a.ply"],
            "half.nrrd: the sample [0, 1, 1] is 0.5; labels are whole numbers",
        ),
        (&["--labels", "minus.nrrd", "-o", "a.ply"], "the sample [0, 1, 1] is -3"),
        (&["--labels", "one.nrrd", "-o", "a.ply"], "every sample has the label 7: there is no boundary"),
        (
            &[&blocks[..], &["-o", "a.stl"]].concat(),
            "a.stl: .stl has no place for labels; .ply, .obj and .glb have",
        ),
        (
            &[&blocks[..], &["-o", "a.ply", "--only", "2,3"]].concat(),
            "no sample has the label 3; labels are 0, 2, 5",
        ),
        (
            &[&blocks[..], &["-o", "a.ply", "--only", "two"]].concat(),
            "--only two: labels are whole numbers from 1",
        ),
        (&[&blocks[..], &["-o", "a.ply", "--only", "0"]].concat(), "label 0 is the background"),
        (&[&blocks[..], &["-o", "a.ply", "--method", "mc"]].concat(), "--method nets"),
        (
            &[&blocks[..], &["-o", "a.ply", "--method", "nets-manifold"]].concat(),
            "patches = true is refused, since boundaries of labels have a vertex per cell",
        ),
        (
            &[&blocks[..], &["-o", "a.ply", "--recipe", clamped]].concat(),
            "edge_clamp = 0.25 is refused, since crossings of labels are in the middles of edges",
        ),
        (&[&blocks[..], &["-o", "blocks.nrrd"]].concat(), "known endings are"),
        (&[&blocks[..], &["-o", "a.ply", "--isovalue", "1"]].concat(), "cannot be used with"),
        (&["--labels", "none.nrrd", "-o", "a.ply"], "none.nrrd"),
    ];
    for (arguments, words) in refused {
        let run = folder.run(arguments);
        assert_eq!(run.code, Some(2), "{arguments:?}: {}", run.stderr);
        assert!(run.stderr.contains(words), "{arguments:?}: {}", run.stderr);
        assert!(!folder.path("a.ply").exists(), "{arguments:?}");
    }
}
