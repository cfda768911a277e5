//! `isostudy methods`, `extract --method` and `--recipe`, and `isostudy new`, as a user runs them; and the keys of
//! `docs/study-file.md` that crates other than `design` read.

use crate::command::Folder;
use crate::study_page::{Row, Section, sections};
use isostudy_extract::{Method, kinds, presets};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::PathBuf;
use toml::Table;

/// A ball of 10 cells, by a method; what is told of it.
fn ball(folder: &Folder, method: &[&str]) -> Value {
    let ball = ["extract", "--field", "sqrt(x^2+y^2+z^2) - 1", "--bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2"];
    let said = folder.succeed(&[&ball[..], &["--cells", "10", "-o", "ball.ply", "--json"], method].concat());
    serde_json::from_str(&said.stdout).unwrap()
}

/// What is said of a recipe that is refused; nothing is written then.
fn refused(folder: &Folder, recipe: &str) -> String {
    let ball = ["extract", "--field", "x", "--bounds=-1,-1,-1,1,1,1", "-o", "a.ply", "--recipe", recipe];
    let said = folder.run(&ball);
    assert!(said.code == Some(2) && !folder.path("a.ply").exists(), "{recipe}: {}", said.stderr);
    said.stderr
}

#[test]
fn every_method_of_the_list_makes_a_ball() {
    let folder = Folder::new();
    let list: Value = serde_json::from_str(&folder.succeed(&["methods", "--json"]).stdout).unwrap();
    let methods = list["methods"].as_array().unwrap();
    let ids: Vec<&str> = methods.iter().map(|method| method["id"].as_str().unwrap()).collect();
    assert_eq!(ids, presets().iter().map(|preset| preset.id).collect::<Vec<_>>());
    let text = folder.succeed(&["methods", "--all"]).stdout;
    for method in methods {
        let id = method["id"].as_str().unwrap();
        let label = method["label"].as_str().unwrap();
        let lines =
            text.lines().filter(|line| line.split_whitespace().next() == Some(id) && line.ends_with(label));
        assert_eq!(lines.count(), 1, "{id} in the text");
        let report = ball(&folder, &["--method", id]);
        assert_eq!(report["method"]["id"], id);
        assert_eq!(report["method"]["recipe"], method["recipe"]);
        assert_eq!(report["arrangement"], method["recipe"]["arrangement"]);
        // A ball of 10 cells is seen by all of them; what is promised is kept.
        let volume = report["volume"].as_f64();
        let is_closed = report["topology"]["boundary_edges"] == 0;
        let is_manifold =
            ["non_manifold_edges", "misoriented_edges", "non_manifold_vertices", "duplicate_faces"]
                .iter()
                .all(|fault| report["topology"][fault] == 0);
        assert!(is_closed || method["promises"]["closed_off_the_box"] == false, "{id}");
        assert!(is_manifold || method["promises"]["manifold"] == false, "{id}");
        // What is open has no volume.
        assert_eq!(volume.is_some(), is_closed, "{id}");
        let share = volume.map_or(1.0, |volume| volume / (4.0 / 3.0 * std::f64::consts::PI));
        assert!((0.9..1.02).contains(&share), "{id}: {share}");
    }
}

#[test]
fn a_recipe_is_the_method_that_it_spells() {
    let folder = Folder::new();
    let bytes = || std::fs::read(folder.path("ball.ply")).unwrap();
    let relaxed = "{ kind = \"tetrahedra\", arrangement = \"body-centred\", placement = \"relaxed\" }";
    let report = ball(&folder, &["--recipe", relaxed]);
    assert_eq!(report["method"]["label"], "body-centred, integrated, relaxed");
    let spelt = bytes();
    ball(&folder, &["--method", "bi-relaxed"]);
    assert_eq!(bytes(), spelt);
    // Another mesh; and the older words name the method as well.
    let report = ball(&folder, &["--arrangement", "simple-cubic", "--clustering", "none"]);
    assert_eq!((&report["method"]["id"], &report["clustering"]), (&"su".into(), &"none".into()));
    assert_ne!(bytes(), spelt);
    // A method without a name is told by its recipe.
    let own = "{ kind = \"tetrahedra\", arrangement = \"simple-cubic\", refine_crossings = true }";
    let report = ball(&folder, &["--recipe", own]);
    assert!(report["method"]["id"].is_null() && report["method"]["recipe"]["refine_crossings"] == true);
    let said = folder.succeed(&[
        "extract",
        "--field",
        "x^2+y^2+z^2-1",
        "--bounds=-2,-2,-2,2,2,2",
        "--cells=9",
        "-o=a.ply",
        "--quality",
        "--recipe",
        own,
    ]);
    let line = said.stdout.lines().find(|line| line.starts_with("method ")).unwrap();
    assert!(line.contains("refine_crossings = true") && line.contains("simple-cubic"), "{line}");
}

#[test]
fn what_is_no_recipe_is_refused_with_its_place_and_what_is_allowed() {
    let folder = Folder::new();
    let body = "kind = \"tetrahedra\", arrangement = \"body-centred\"";
    for (recipe, parts) in [
        (format!("{{ {body}, placment = \"relaxed\" }}"), &["placment = \"relaxed\"", "`placement`"][..]),
        (format!("{{ {body}, command = [\"a\"] }}"), &["command = [\"a\"]", "`refine_crossings`"]),
        (format!("{{ {body}, files = {{ a = \"a.ply\" }} }}"), &["unknown field `files`", "`clustering`"]),
        (format!("{{ {body}, placement = \"near\" }}"), &["placement = \"near\"", "`projected`, `relaxed`"]),
        (format!("{{ {body}, refine_crossings = 4 }}"), &["refine_crossings = 4", "boolean"]),
        (format!("{{ {body}"), &["line 1, column", "unclosed inline table"]),
        (format!("{{ {body} }} x"), &["line 1, column"]),
        ("7".into(), &["must be a table"]),
        ("{ arrangement = \"body-centred\" }".into(), &["kind is missing", "\"tetrahedra\""]),
        ("{ kind = \"tetrahedra\" }".into(), &["missing field `arrangement`"]),
        ("{ kind = \"cones\" }".into(), &["\"cones\"", "\"tetrahedra\"", "\"cubes\""]),
        ("{ kind = \"program\", command = [\"a\"] }".into(), &["kind = \"program\"", "of a study"]),
        ("{ kind = \"meshes\", files = {} }".into(), &["kind = \"meshes\"", "of a study"]),
        ("{ kind = \"grid-cells\" }".into(), &["kind = \"grid-cells\"", "--grid"]),
        ("{ kind = \"advancing-front\" }".into(), &["kind = \"advancing-front\"", "of a study"]),
    ] {
        let error = refused(&folder, &recipe);
        assert!(
            error.contains("--recipe") && parts.iter().all(|part| error.contains(part)),
            "{recipe}: {error}"
        );
    }
    for other in [["--method", "bi"], ["--clustering", "none"], ["--arrangement", "simple-cubic"]] {
        let recipe = format!("{{ {body} }}");
        let said =
            folder.run(
                &[
                    &[
                        "extract",
                        "--field",
                        "x",
                        "--bounds=-1,-1,-1,1,1,1",
                        "-o",
                        "a.ply",
                        "--recipe",
                        &recipe,
                    ][..],
                    &other,
                ]
                .concat(),
            );
        assert!(
            said.code == Some(2) && said.stderr.contains("cannot be used with"),
            "{other:?}: {}",
            said.stderr
        );
    }
    let said =
        folder.run(&["extract", "--field", "x", "--bounds=-1,-1,-1,1,1,1", "-o", "a.ply", "--method", "no"]);
    assert!(
        said.code == Some(2)
            && said.stderr.contains("bi-relaxed")
            && said.stderr.contains("isostudy methods")
    );
}

#[test]
fn a_new_study_passes_every_check() {
    let folder = Folder::new();
    let said = folder.succeed(&["new", "my terrain"]);
    assert_eq!(said.stdout, "my terrain/study.toml\n");
    for next in ["design check", "study", "serve"] {
        assert!(
            said.stderr.contains(&format!("isostudy {next} 'my terrain/study.toml'\n")),
            "{}",
            said.stderr
        );
    }
    let check = folder.succeed(&["design", "check", "my terrain/study.toml"]);
    assert_eq!(check.stdout, "my terrain/study.toml: no faults\n");
    let valid = folder.succeed(&["validate", "my terrain/study.toml"]);
    assert!(
        valid.stdout.ends_with("study.toml: valid; 2 questions in 1 group, no answers\n"),
        "{}",
        valid.stdout
    );
    // It needs nothing but its folder, and has surfaces in the middle of their boxes.
    std::fs::rename(folder.path("my terrain"), folder.path("moved")).unwrap();
    folder.succeed(&["validate", "moved/study.toml"]);
    for id in ["torus_bi", "torus_bi-relaxed", "cliffs_bi", "cliffs_bi-relaxed"] {
        let panel =
            folder.succeed(&["inspect", id, "--study", "moved/study.toml", "--iterations", "1", "--json"]);
        assert!(panel.stdout.contains("\"boundary_edges\": 0"), "{id}: {}", panel.stdout);
    }
    let id = |name: &str| folder.read(name).parse::<Table>().unwrap()["study"]["id"].clone();
    assert_eq!(id("moved/study.toml").as_str(), Some("my-terrain"));
}

#[test]
fn nothing_is_written_over() {
    let folder = Folder::new();
    folder.succeed(&["new", "a/b"]);
    std::fs::write(folder.path("a/b/study.toml"), "mine").unwrap();
    let listing = || {
        let mut found: Vec<PathBuf> = ["", "a", "a/b", "a/b/cpu"]
            .iter()
            .flat_map(|name| std::fs::read_dir(folder.path(name)).unwrap().map(|entry| entry.unwrap().path()))
            .collect();
        found.sort();
        found
    };
    let before = listing();
    let said = folder.run(&["new", "a/b"]);
    assert!(
        said.code == Some(2) && said.stderr.contains("a/b/study.toml: is there already"),
        "{}",
        said.stderr
    );
    // The profile alone is in the way as well; and the study is not written then.
    std::fs::remove_file(folder.path("a/b/study.toml")).unwrap();
    let said = folder.run(&["new", "a/b"]);
    assert!(
        said.code == Some(2) && said.stderr.contains("x86-64-v3.toml: is there already"),
        "{}",
        said.stderr
    );
    std::fs::write(folder.path("a/b/study.toml"), "mine").unwrap();
    assert_eq!((listing(), folder.read("a/b/study.toml").as_str()), (before, "mine"));
    for (file, name) in [("file", "file"), ("c/cpu", "c")] {
        std::fs::create_dir_all(folder.path(file).parent().unwrap()).unwrap();
        std::fs::write(folder.path(file), "mine").unwrap();
        let said = folder.run(&["new", name]);
        assert!(
            said.code == Some(2) && said.stderr.contains(&format!("{file}: is not a folder")),
            "{}",
            said.stderr
        );
        assert_eq!(folder.read(file), "mine");
        assert!(!folder.path("c/study.toml").exists());
    }
    // A folder with other files will do.
    std::fs::create_dir(folder.path("d")).unwrap();
    std::fs::write(folder.path("d/notes"), "mine").unwrap();
    folder.succeed(&["new", "d"]);
    assert_eq!(folder.read("d/notes"), "mine");
}

fn section(table: &str, kind: &str) -> Section {
    let mut found = sections().into_iter();
    found
        .find(|section| section.table == table && section.kind.as_deref() == Some(kind))
        .expect("a section of the page")
}

fn keys(section: &Section) -> BTreeSet<String> {
    section.rows.iter().map(|row| row.key.clone()).collect()
}

/// The keys that a message lists as allowed.
fn quoted(message: &str) -> Vec<String> {
    let (_, known) = message.split_once("expected").expect("what is allowed is said");
    known.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// The kinds that a study's recipes can have, as the refusal of another lists them.
fn kinds_of_a_study() -> BTreeSet<String> {
    let folder = Folder::new();
    folder.succeed(&["new", "a"]);
    let text = folder.read("a/study.toml").replacen("kind = \"tetrahedra\"", "kind = \"none\"", 1);
    std::fs::write(folder.path("a/study.toml"), text).unwrap();
    let said = folder.run(&["validate", "a/study.toml"]).stderr;
    let (_, allowed) = said.split_once("Allowed: ").expect("what is allowed is said");
    allowed.split('"').skip(1).step_by(2).map(str::to_owned).collect()
}

#[test]
fn the_page_has_the_keys_and_names_of_every_kind_of_method() {
    let on_the_page = sections().into_iter().filter(|section| section.table == "methods.recipe");
    let on_the_page: BTreeSet<String> = on_the_page.filter_map(|section| section.kind).collect();
    assert_eq!(on_the_page, kinds_of_a_study());
    for kind in kinds() {
        assert!(on_the_page.contains(kind.name), "{}", kind.name);
        has_the_keys_and_names_of(kind.name);
    }
}

fn has_the_keys_and_names_of(kind: &str) {
    let section = section("methods.recipe", kind);
    let read = |keys: Table| toml::Value::Table(keys).try_into::<Method>();
    let example: Table = section.examples[0].parse().unwrap();
    let recipe = example["recipe"].as_table().unwrap().clone();
    assert!(read(recipe.clone()).is_ok(), "{kind}");
    let refused = |key: &str, value: toml::Value| {
        let mut recipe = recipe.clone();
        recipe.insert(key.into(), value);
        read(recipe).unwrap_err().message().to_owned()
    };
    let known = quoted(&refused("no_such_key", 1.into()));
    assert_eq!(keys(&section), known.into_iter().collect(), "{kind}");
    for row in &section.rows {
        let error = refused(&row.key, "no-such-name".into());
        let takes_a_name = error.starts_with("unknown variant");
        assert_eq!(row.holds == "name", takes_a_name, "{kind}: {}: {error}", row.key);
        if takes_a_name {
            assert_eq!(row.names(), quoted(&error), "{kind}: {}", row.key);
        }
    }
    // What is left out is what the page says, and what is needed cannot be.
    let mut least = Table::from_iter([("kind".to_owned(), kind.into())]);
    for Row { key, .. } in section.rows.iter().filter(|row| row.is_needed()) {
        let error = read(least.clone()).unwrap_err();
        assert!(error.message().contains(key.as_str()), "{kind}: {key}: {error}");
        least.insert(key.clone(), recipe[key].clone());
    }
    let left_out = read(least.clone()).unwrap();
    for row in section.rows.iter().filter(|row| !row.is_needed()) {
        least.insert(row.key.clone(), row.default.trim_matches('`').parse().unwrap());
    }
    assert_eq!(read(least).unwrap(), left_out, "{kind}");
}

#[test]
fn the_page_has_the_keys_of_what_the_study_hands_on() {
    let folder = Folder::new();
    folder.succeed(&["new", "a"]);
    let study = folder.read("a/study.toml");
    let recipe =
        "recipe = { kind = \"tetrahedra\", arrangement = \"body-centred\", clustering = \"integrated\" }";
    let field = "field = { kind = \"terrain\", character = \"cliffs\", seed = 2 }";
    assert!(study.contains(recipe) && study.contains(field));
    for (table, kind, from, to) in [
        (
            "objects.field",
            "terrain",
            field,
            "field = { kind = \"terrain\", character = \"hills\", no_such_key = 1 }",
        ),
        (
            "methods.recipe",
            "program",
            recipe,
            "recipe = { kind = \"program\", command = [\"true\"], no_such_key = 1 }",
        ),
        ("methods.recipe", "meshes", recipe, "recipe = { kind = \"meshes\", files = {}, no_such_key = 1 }"),
    ] {
        std::fs::write(folder.path("a/other.toml"), study.replacen(from, to, 1)).unwrap();
        let said = folder.run(&["validate", "a/other.toml"]);
        assert_eq!(said.code, Some(2));
        assert_eq!(
            keys(&section(table, kind)),
            quoted(&said.stderr).into_iter().collect(),
            "{kind}: {}",
            said.stderr
        );
    }
}

#[test]
fn the_page_has_the_defaults_of_terrains() {
    let section = section("objects.field", "terrain");
    use isostudy_field::TerrainCharacter::{Caves, Cliffs, Hills};
    for (place, character) in [Hills, Cliffs, Caves].into_iter().enumerate() {
        // Written out, so that a setting that is added does not compile before it is here.
        let isostudy_field::TerrainSettings {
            seed,
            ground,
            relief,
            period,
            octaves,
            gain,
            ridged,
            billowed,
            terrace,
            overhang,
            overhang_period,
            caves,
            cave_period,
            closed,
            margin,
        } = character.settings(1);
        let defaults = [
            ("seed", seed.to_string()),
            ("ground", ground.to_string()),
            ("relief", relief.to_string()),
            ("period", period.to_string()),
            ("octaves", octaves.to_string()),
            ("gain", gain.to_string()),
            ("ridged", ridged.to_string()),
            ("billowed", billowed.to_string()),
            ("terrace", terrace.to_string()),
            ("overhang", overhang.to_string()),
            ("overhang_period", overhang_period.to_string()),
            ("caves", caves.to_string()),
            ("cave_period", cave_period.to_string()),
            ("closed", closed.to_string()),
            ("margin", margin.to_string()),
        ];
        assert_eq!(section.rows.len(), defaults.len() + 1, "and the character");
        for (key, default) in defaults {
            let row = section.rows.iter().find(|row| row.key == key).expect("a row of the page");
            let on_the_page: Vec<&str> = row.default.split(", ").collect();
            assert_eq!(on_the_page[place % on_the_page.len()], default, "{key} of {character}");
        }
    }
}
