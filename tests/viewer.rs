//! The viewer of meshes, from study file to page, with a library that only looks like three.js: nothing is fetched.

use crate::fixture::{Fixture, files};
use base64::Engine;
use std::fs;
use std::io::Read;
use std::path::PathBuf;

/// Files with the imports of the real ones, so that names can be put in the place of paths.
const STANDS_FOR_THREE: [(&str, &str); 7] = [
    ("LICENSE", "The licence <of> the library\n"),
    ("three.core.min.js", "export const core = 1;\n"),
    (
        "three.module.min.js",
        "export{core as a}from\"./three.core.min.js\";import{core}from\"./three.core.min.js\";\n",
    ),
    ("OrbitControls.js", "import { a } from 'three';\n"),
    (
        "GLTFLoader.js",
        "import { b } from '../utils/BufferGeometryUtils.js';\nimport { c } from '../utils/SkeletonUtils.js';\n",
    ),
    ("BufferGeometryUtils.js", "export const b = 2;\n"),
    ("SkeletonUtils.js", "export const c = 3;\n"),
];

/// The quick study with a viewer. The library is where the study looks for it once it is put there.
fn with_viewer(resolutions: &str) -> Fixture {
    let fixture = Fixture::new();
    let section = format!("[viewer]\nthree = \"three\"\nresolutions = {resolutions}\n\n[benchmark]");
    fixture.edit("[benchmark]", &section);
    fixture
}

fn library(fixture: &Fixture) -> PathBuf {
    let folder = fixture.folder().join("three");
    fs::create_dir_all(&folder).unwrap();
    for (name, text) in STANDS_FOR_THREE {
        fs::write(folder.join(name), text).unwrap();
    }
    folder
}

fn page(fixture: &Fixture, name: &str) -> String {
    fs::read_to_string(fixture.out().join(name)).unwrap()
}

/// What stands between two texts, as often as it does.
fn all_between<'a>(text: &'a str, before: &str, after: &str) -> Vec<&'a str> {
    text.split(before).skip(1).map(|rest| rest.split(after).next().unwrap()).collect()
}

fn unpacked(base64: &str) -> Vec<u8> {
    let bytes = base64::engine::general_purpose::STANDARD.decode(base64).unwrap();
    let mut plain = Vec::new();
    flate2::read::GzDecoder::new(bytes.as_slice()).read_to_end(&mut plain).unwrap();
    plain
}

fn catalogue(page: &str) -> serde_json::Value {
    let json = all_between(page, "id=\"catalogue\">", "</script>");
    serde_json::from_str(json[0]).unwrap()
}

#[test]
fn the_page_holds_every_mesh_at_every_resolution() {
    let fixture = with_viewer("[2, 1, 0.5]");
    library(&fixture);
    fixture.succeed("study", &["--threads", "1"]);
    let made = files(fixture.out());
    let viewer = page(&fixture, "viewer.html");
    let catalogue = catalogue(&viewer);

    assert_eq!(catalogue["factors"], serde_json::json!([0.5, 1.0, 2.0]));
    let meshes = catalogue["meshes"].as_array().unwrap();
    assert_eq!(meshes.len(), 18);
    for mesh in meshes {
        let id = mesh["id"].as_str().unwrap();
        let levels = mesh["levels"].as_array().unwrap();
        let triangles: Vec<u64> =
            levels.iter().map(|l| l["numbers"]["triangles"].as_u64().unwrap()).collect();
        assert!(triangles[0] > triangles[1] && triangles[1] > triangles[2], "{id}: {triangles:?}");
        for (level, factor) in levels.iter().zip(["0.5", "1", "2"]) {
            // What the page holds is the file beside it.
            let number = level["file"].as_u64().unwrap();
            let text = all_between(&viewer, &format!("id=\"mesh-{number}\">"), "</script>");
            assert_eq!(text.len(), 1, "{id}");
            assert!(unpacked(text[0]) == made[&format!("viewer/{id}_{factor}.glb")], "{id} at {factor}");
        }
        // At the spacing of the animations, the record is that of the animations' mesh.
        let record: serde_json::Value =
            serde_json::from_slice(&made[&format!("meshes/stimulus/{id}.json")]).unwrap();
        for (name, of) in [
            ("triangles", &record["counts"]["triangles"]),
            ("radius_ratio_mean", &record["quality"]["radius_ratio"]["mean"]),
            ("distance_max", &record["accuracy"]["distance"]["max"]),
            ("euler_characteristic", &record["topology"]["euler_characteristic"]),
        ] {
            assert_eq!(&levels[1]["numbers"][name], of, "{id}: {name}");
        }
        assert_eq!(levels[1]["spacing"], record["spacing"]);
        assert_eq!(levels[0]["spacing"].as_f64().unwrap() * 2.0, record["spacing"].as_f64().unwrap());
    }
    // It opens on the mesh that lies nearest to its isosurface and the one that lies farthest from it, of the object where they are
    // farthest apart in spacings.
    let study: toml::Table = fs::read_to_string(fixture.config()).unwrap().parse().unwrap();
    let mut widest = (0.0, None);
    for object in study["objects"].as_array().unwrap() {
        let id = object["id"].as_str().unwrap();
        let mut own: Vec<(f64, &str)> = meshes
            .iter()
            .filter(|mesh| mesh["object"] == id)
            .map(|mesh| {
                let mean = mesh["levels"][1]["numbers"]["distance_mean"].as_f64().unwrap();
                (mean / object["stimulus_spacing"].as_float().unwrap(), mesh["id"].as_str().unwrap())
            })
            .collect();
        own.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (near, far) = (own[0], own[own.len() - 1]);
        if far.0 - near.0 > widest.0 {
            widest = (far.0 - near.0, Some((id, near.1, far.1)));
        }
    }
    let (object, near, far) = widest.1.unwrap();
    assert_eq!(catalogue["opening"], serde_json::json!([near, far]));
    assert_eq!(catalogue["first"], object);
    assert!(page(&fixture, "index.html").contains("href=\"viewer.html\""));
    assert!(viewer.contains("The licence &lt;of&gt; the library"));
    for forbidden in ["<link", "<script src", "@import", "http-equiv"] {
        assert!(!viewer.contains(forbidden), "{forbidden}");
    }

    // Modules find each other by names: a page has no paths.
    let modules: Vec<String> = all_between(&viewer, "data-packed>", "</script>")
        .into_iter()
        .map(|text| String::from_utf8(unpacked(text)).unwrap())
        .collect();
    assert_eq!(modules.len(), 6);
    assert!(modules.iter().all(|text| !text.contains("\"./") && !text.contains("'../")), "{modules:?}");
    assert_eq!(modules.concat().matches("three/core").count(), 2);

    // Done once, and the same with any number of threads.
    let again = fixture.succeed("study", &[]);
    assert!(!again.stderr.contains(" made, "), "{}", again.stderr);
    let other = with_viewer("[0.5, 1, 2]");
    library(&other);
    other.succeed("study", &["--threads", "3"]);
    assert!(page(&other, "viewer.html") == viewer);
}

#[test]
fn without_the_library_all_else_is_made_and_the_page_says_what_is_missing() {
    let fixture = with_viewer("[1]");
    let missing = "since three.js is missing: run <code>make three</code>";
    let run = fixture.succeed("study", &[]);
    assert!(run.stderr.contains("left out: three lacks three.js"), "{}", run.stderr);
    let index = page(&fixture, "index.html");
    assert!(index.contains(missing) && !index.contains("viewer.html"));
    assert!(!fixture.out().join("viewer").exists() && !fixture.out().join("viewer.html").exists());

    let folder = library(&fixture);
    fixture.succeed("study", &[]);
    let index = page(&fixture, "index.html");
    assert!(index.contains("href=\"viewer.html\"") && !index.contains(missing));
    assert!(fixture.out().join("viewer.html").exists());

    // A file that is gone is as good as none, and the page goes too.
    fs::remove_file(folder.join("SkeletonUtils.js")).unwrap();
    fixture.succeed("study", &[]);
    assert!(page(&fixture, "index.html").contains(missing));
    assert!(!fixture.out().join("viewer.html").exists());
}

#[test]
fn a_library_of_another_version_is_refused() {
    let fixture = with_viewer("[1]");
    let folder = library(&fixture);
    fs::write(folder.join("GLTFLoader.js"), "import { b } from './other.js';\n").unwrap();
    let run = fixture.run("study", &[]);
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    for part in ["GLTFLoader.js", "'../utils/BufferGeometryUtils.js'", "make three"] {
        assert!(run.stderr.contains(part), "{part}: {}", run.stderr);
    }
}

/// Sixteen times the spacing of the animations is more than the box of an object: the page says so, and has the rest.
#[test]
fn a_resolution_without_a_mesh_is_named() {
    let fixture = with_viewer("[1, 16]");
    library(&fixture);
    fixture.succeed("study", &[]);
    let catalogue = catalogue(&page(&fixture, "viewer.html"));
    let mut missing = 0;
    for mesh in catalogue["meshes"].as_array().unwrap() {
        assert!(mesh["levels"][0]["file"].is_u64());
        let coarse = &mesh["levels"][1];
        assert_eq!(coarse["file"].is_null(), coarse["missing"].is_string(), "{coarse}");
        assert_eq!(coarse["numbers"].is_null(), coarse["missing"].is_string(), "{coarse}");
        missing += usize::from(coarse["missing"].is_string());
    }
    assert!(missing > 0);
}

#[test]
fn resolutions_are_checked() {
    for (resolutions, memory_gib, why) in [
        ("[]", "8.0", "at least one"),
        ("[1, 0.1]", "8.0", "viewer.resolutions[1] = 0.1"),
        ("[2, 2]", "8.0", "already used by viewer.resolutions[0]"),
        // Finer meshes must fit into memory like any other.
        ("[0.125]", "0.002", "viewer.resolutions[0] = 0.125"),
    ] {
        let fixture = with_viewer(resolutions);
        fixture.edit("memory_gib = 8.0", &format!("memory_gib = {memory_gib}"));
        let run = fixture.run("study", &[]);
        assert_eq!(run.code, Some(2), "{resolutions}: {}", run.stderr);
        assert!(run.stderr.contains(why), "{resolutions}: {}", run.stderr);
    }
}
