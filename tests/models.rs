//! Pairs as models that participants turn.

use crate::command::{Run, isostudy};
use crate::fixture::{Fixture, files};
use std::collections::BTreeSet;

/// A study that shows models, and the library's files as a page needs them; what is in them nobody runs here.
fn turned() -> Fixture {
    let fixture = Fixture::balanced();
    fixture.edit("[forms]", "[forms]\nstimulus = \"model\"\nthree = \"three\"");
    let folder = fixture.folder().join("three");
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(folder.join("three.core.min.js"), "export const a = 1;").unwrap();
    std::fs::write(folder.join("three.module.min.js"), "import{a}from\"./three.core.min.js\";export{a};")
        .unwrap();
    std::fs::write(folder.join("LICENSE"), "MIT").unwrap();
    fixture
}

/// The chunks of a binary glTF file: type, content.
fn chunks(glb: &[u8]) -> Vec<([u8; 4], &[u8])> {
    let number = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&glb[..4], number(4), number(8)), (&b"glTF"[..], 2, glb.len()));
    let (mut at, mut found) = (12, Vec::new());
    while at < glb.len() {
        let length = number(at);
        assert_eq!(length % 4, 0);
        found.push((glb[at + 4..at + 8].try_into().unwrap(), &glb[at + 8..at + 8 + length]));
        at += 8 + length;
    }
    found
}

/// A model file beside each animation, all of one size and as old as their names say; none says what it shows.
#[test]
fn a_bundle_of_models_tells_nothing_of_the_key() {
    let fixture = turned();
    let said = fixture.succeed("bundle", &[]).stderr;
    assert!(said.contains("MB as glb, or, where the browser does not play that, "), "{said}");
    let bundle = fixture.out().join("bundle");
    let made = files(&bundle);
    let own = ["model.js", "turning.js", "three.core.min.js", "three.module.min.js", "three-licence.txt"];
    assert!(own.iter().all(|name| made.contains_key(*name)), "{:?}", made.keys());
    let models: Vec<&String> = made.keys().filter(|path| path.ends_with(".glb")).collect();
    assert_eq!(models.len(), 2 * 27 + 2);
    assert!(models.iter().all(|path| made.contains_key(&path.replace(".glb", ".gif"))));
    let sizes: BTreeSet<usize> = models.iter().map(|path| made[*path].len()).collect();
    assert!(sizes.len() == 1 && sizes.iter().all(|size| *size < 2_000_000), "{sizes:?}");
    let mut by_age = models.clone();
    by_age.sort_by_key(|path| std::fs::metadata(bundle.join(path)).unwrap().modified().unwrap());
    assert_eq!(by_age, models);
    let key = std::fs::read_to_string(fixture.out().join("key/stimuli.csv")).unwrap();
    let ids: BTreeSet<&str> =
        key.lines().skip(1).flat_map(|line| line.split(',').skip(2)).filter(|id| !id.is_empty()).collect();
    for path in &models {
        let found = chunks(&made[*path]);
        let kinds: Vec<[u8; 4]> = found.iter().map(|(kind, _)| *kind).collect();
        assert_eq!(kinds, [*b"JSON", *b"BIN\0", *b"FREE"], "{path}");
        assert!(found[2].1.len() >= 56, "{path}: {}", found[2].1.len());
        let text = std::str::from_utf8(found[0].1).unwrap();
        assert!(!ids.iter().any(|id| text.contains(id)) && !text.contains("name"), "{path}");
    }
    // The file itself is no larger than the meshes that it holds.
    let line = key.lines().find(|line| line.contains(",Q1,ss_bu,ss_bi")).unwrap();
    let code = line.split(['/', '.']).nth(2).unwrap();
    let whole = std::fs::read(fixture.out().join(format!("stimuli/models/{code}.glb"))).unwrap();
    let json: serde_json::Value = serde_json::from_slice(chunks(&whole)[0].1).unwrap();
    let record = |id: &str| -> serde_json::Value {
        serde_json::from_slice(
            &std::fs::read(fixture.out().join(format!("meshes/stimulus/{id}.json"))).unwrap(),
        )
        .unwrap()
    };
    for (mesh, id) in ["ss_bu", "ss_bi"].into_iter().enumerate() {
        let indices = json["meshes"][mesh]["primitives"][0]["indices"].as_u64().unwrap() as usize;
        let triangles = json["accessors"][indices]["count"].as_u64().unwrap() / 3;
        assert!(record(id).to_string().contains(&format!(":{triangles},")), "{id}: {triangles}");
    }
    assert_eq!(json["scenes"][0]["nodes"], serde_json::json!([0, 1]));

    fixture.succeed("bundle", &[]);
    assert_eq!(files(&bundle), made);
    // A study that shows turntables again has no model.
    fixture.edit("stimulus = \"model\"\n", "");
    fixture.succeed("bundle", &[]);
    assert!(!files(fixture.out()).keys().any(|path| path.ends_with(".glb") || path.ends_with("model.js")));
}

/// A pair that is too large is a fault with a remedy, and nothing is made smaller; a study without the library is told where it is from.
#[test]
fn large_models_and_a_missing_library_are_said() {
    let fixture = turned();
    fixture.succeed("bundle", &[]);
    let models = fixture.out().join("stimuli/models");
    let first = std::fs::read_dir(&models).unwrap().next().unwrap().unwrap().path();
    let mut bytes = std::fs::read(&first).unwrap();
    bytes.resize(2_000_001, 0);
    std::fs::write(&first, &bytes).unwrap();
    let (config, out) = (fixture.config(), fixture.out().to_owned());
    let check = || Run::of(isostudy().args(["design", "check"]).arg(&config).arg("--results").arg(&out));
    let Run { code, stdout, .. } = check();
    assert!(
        code == Some(1) && stdout.contains("models-too-large") && stdout.contains("take 2.0 MB"),
        "{stdout}"
    );
    assert!(stdout.contains("remedy: fewer triangles"), "{stdout}");
    bytes.truncate(2_000_000);
    std::fs::write(&first, &bytes).unwrap();
    assert_eq!(check().code, Some(0));

    std::fs::remove_file(fixture.folder().join("three/three.core.min.js")).unwrap();
    let Run { code, stderr, .. } = fixture.run("bundle", &[]);
    assert!(code == Some(2) && stderr.contains("`make three` fetches it"), "{stderr}");
    fixture.edit("three = \"three\"\n", "");
    let Run { code, stderr, .. } = fixture.run("bundle", &[]);
    assert!(
        code == Some(2) && stderr.contains("forms.stimulus") && stderr.contains("forms.three"),
        "{stderr}"
    );
}
