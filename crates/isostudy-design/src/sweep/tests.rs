use super::*;
use crate::config::RangeSection;
use crate::load::tests::refused;
use std::path::Path;

/// A study of two objects and two methods with this sweep.
fn with(sweep: &str) -> Result<Study, ConfigError> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/study.toml");
    Study::parse(&format!("{STUDY}\n{sweep}"), &path)
}

const STUDY: &str = r#"
schema = 1
study = { id = "swept", title = "Swept", seed = 1 }
limits = { memory_gib = 1.0 }
turntable = { width = 64, height = 64, frames = 2, duration_s = 1.0, elevation_rad = 0.5, near = 0.1, far = 10.0, supersampling = 1 }
shading = { light = [0.0, 1.0, 0.0], lit = [1.0, 1.0, 1.0], shade = [0.0, 0.0, 0.0], highlight = [1.0, 0.0, 0.0], background = [1.0, 1.0, 1.0], ambient = 0.1, error_scale = 1.0 }
stimuli = { pair_scale = 1 }
benchmark = { warmup = 0, iterations = 1, short_iterations = 1, threads = 1, target = "cpu/x86-64-v3.toml" }

[[objects]]
id = "ball"
name = "ball"
field = { kind = "sphere", radius = 0.7 }
isovalue = 0.0
min = [-1.0, -1.0, -1.0]
max = [1.0, 1.0, 1.0]
benchmark_spacing = 0.1
stimulus_spacing = 0.1
camera = { distance = 2.0, vertical_fov_rad = 1.0 }

[[objects]]
id = "hills"
name = "hills"
field = { kind = "terrain", character = "hills" }
isovalue = 0.0
min = [-1.0, -1.0, -0.5]
max = [1.0, 1.0, 0.5]
benchmark_spacing = 0.1
stimulus_spacing = 0.1
camera = { distance = 2.0, vertical_fov_rad = 1.0 }

[[methods]]
id = "bi"
label = "tetrahedra"
recipe = { kind = "tetrahedra", arrangement = "body-centred" }

[[methods]]
id = "mc"
label = "cubes"
recipe = { kind = "cubes" }

[[methods]]
id = "as-bi"
label = "cubes, as many triangles"
recipe = { kind = "cubes" }
match = { triangles_of = "bi" }
"#;

const TWO: &str = r#"
[[sweep.settings]]
objects = ["hills"]
key = "field.seed"
range = { from = 1, to = 5, steps = 5 }
[[sweep.settings]]
methods = ["bi"]
key = "edge_clamp"
values = [0.0, 0.1, 0.2]
"#;

fn said(sweep: &Sweep<'_>, pair: usize, number: u64) -> String {
    let case = sweep.case(&sweep.pairs[pair], number);
    let of = |chosen: &Chosen<'_>| format!(" {}={}", sweep.name(chosen.setting), chosen.value);
    format!("{}{}", case.cells, case.settings.iter().map(of).collect::<String>())
}

#[test]
fn crossed_cases_are_every_combination_once() {
    let study = with(&format!("[sweep]\ncells = [16, 32]\n{TWO}")).unwrap();
    let sweep = study.sweep().unwrap();
    let pairs: Vec<String> =
        sweep.pairs.iter().map(|pair| format!("{} {}", pair.configuration.id, pair.cases)).collect();
    assert_eq!(pairs, ["ball_bi 6", "ball_mc 2", "hills_bi 30", "hills_mc 10"]);
    assert_eq!(sweep.cases(), 48);
    // The method's setting is the fastest, the object's the slowest.
    assert_eq!(said(&sweep, 2, 0), "16 object.field.seed=1 method.edge_clamp=0.0");
    assert_eq!(said(&sweep, 2, 1), "16 object.field.seed=1 method.edge_clamp=0.1");
    assert_eq!(said(&sweep, 2, 3), "32 object.field.seed=1 method.edge_clamp=0.0");
    assert_eq!(said(&sweep, 2, 6), "16 object.field.seed=2 method.edge_clamp=0.0");
    for (pair, swept) in sweep.pairs.iter().enumerate() {
        let mut all: Vec<String> = (0..swept.cases).map(|number| said(&sweep, pair, number)).collect();
        all.sort();
        all.dedup();
        assert_eq!(all.len() as u64, swept.cases);
    }
}

#[test]
fn listed_cases_take_values_in_step() {
    let lists = TWO.replace("to = 5, steps = 5", "to = 5, steps = 3");
    let study = with(&format!("[sweep]\ncombine = \"listed\"\ncells = [16, 32, 24]\n{lists}")).unwrap();
    let sweep = study.sweep().unwrap();
    assert_eq!(sweep.pairs.iter().map(|pair| pair.cases).collect::<Vec<_>>(), [3; 4]);
    assert_eq!(said(&sweep, 2, 1), "32 object.field.seed=3 method.edge_clamp=0.1");
    assert_eq!(said(&sweep, 2, 2), "24 object.field.seed=5 method.edge_clamp=0.2");
    let one = with(&format!("[sweep]\ncombine = \"listed\"\ncells = [16]\n{lists}")).unwrap();
    assert_eq!(said(&one.sweep().unwrap(), 2, 2), "16 object.field.seed=5 method.edge_clamp=0.2");
    let uneven = with(&format!("[sweep]\ncombine = \"listed\"\ncells = [16, 32]\n{TWO}"));
    assert_eq!(refused(uneven), "sweep.settings[1] = 3 values");
}

#[test]
fn a_case_is_the_study_with_its_settings() {
    let study = with(&format!("[sweep]\ncells = [16, 32]\n{TWO}")).unwrap();
    let sweep = study.sweep().unwrap();
    let pair = &sweep.pairs[2];
    let own = sweep.study_of(pair, &sweep.case(pair, 29).settings).unwrap();
    let field = toml::Table::try_from(&own.file.objects[1].field).unwrap();
    assert_eq!(field["seed"], toml::Value::Integer(5));
    assert_eq!(
        own.method(pair.configuration.id.method).recipe.settings["edge_clamp"],
        toml::Value::Float(0.2)
    );
    // Other objects and methods are as they were.
    assert_eq!(own.file.objects[0].field, study.file.objects[0].field);
    assert_eq!(own.methods[1], study.methods[1]);
}

#[test]
fn ranges_meet_their_ends() {
    let range = |text: &str| toml::from_str::<RangeSection>(text).unwrap().all_as_text();
    assert_eq!(range("from = 0.0\nto = 0.4\nsteps = 5"), "0.0 0.1 0.2 0.3 0.4");
    assert_eq!(range("from = 1\nto = 100\nsteps = 3\nscale = \"logarithmic\""), "1 10 100");
    assert_eq!(range("from = 0.001\nto = 1\nsteps = 4\nscale = \"logarithmic\""), "0.001 0.01 0.1 1.0");
}

#[test]
fn what_cannot_be_is_refused_with_its_key() {
    let refusal = |sweep: &str| refused(with(&format!("[sweep]\n{sweep}")));
    let setting = |text: &str| refusal(&format!("cells = [16]\n[[sweep.settings]]\n{text}"));
    assert_eq!(refusal("cells = []"), "sweep.cells = []");
    assert_eq!(refusal("cells = [16, 16]"), "sweep.cells[1] = 16");
    assert_eq!(refusal("cells = [16]\nobjects = [\"bull\"]"), "sweep.objects[0] = bull");
    assert_eq!(refusal("cells = [16]\nmethods = [\"as-bi\"]"), "sweep.methods[0] = as-bi");
    assert_eq!(refusal("cells = [16, 32]\nlimit = 7"), "sweep = 8 cases");
    assert_eq!(setting("key = \"isovalue\"\nvalues = [0.0]"), "sweep.settings[0].key = isovalue");
    assert_eq!(setting("objects = [\"ball\"]\nkey = \"id\"\nvalues = [\"a\"]"), "sweep.settings[0].key = id");
    assert_eq!(setting("objects = [\"ball\"]\nkey = \"isovalue\""), "sweep.settings[0].values = []");
    assert_eq!(
        setting("objects = [\"ball\"]\nkey = \"isovalue\"\nvalues = [0.0, \"a\"]"),
        "sweep.settings[0].values[1] = \"a\""
    );
    // An object cannot be with these.
    assert_eq!(
        setting("objects = [\"ball\"]\nkey = \"field.radius\"\nvalues = [0.5, -1.0]"),
        "sweep.settings[0].values[1] = -1.0"
    );
    assert_eq!(
        setting("objects = [\"ball\"]\nkey = \"field.radios\"\nvalues = [0.5]"),
        "sweep.settings[0].values[0] = 0.5"
    );
    assert_eq!(
        setting("objects = [\"ball\"]\nkey = \"isovalue.x\"\nvalues = [0.5]"),
        "sweep.settings[0].values[0] = 0.5"
    );
    assert_eq!(
        setting("objects = [\"ball\"]\nkey = \"isovalue\"\nrange = { from = 1, to = 3, steps = 4 }"),
        "sweep.settings[0].range.steps = 4"
    );
    let twice = "methods = [\"bi\"]\nkey = \"edge_clamp\"\nvalues = [0.1]\n[[sweep.settings]]\nmethods = [\"bi\", \"mc\"]\nkey = \
                 \"edge_clamp\"\nvalues = [0.2]";
    assert_eq!(setting(twice), "sweep.settings[1].key = edge_clamp");
    assert_eq!(
        refusal(
            "cells = [16]\nobjects = [\"ball\"]\n[[sweep.settings]]\nobjects = [\"hills\"]\nkey = \"isovalue\"\nvalues = [0.1]"
        ),
        "sweep.settings[0].key = isovalue"
    );
}

#[test]
fn a_million_cases_are_counted_and_not_listed() {
    let sweep = "[sweep]\nlimit = 5000000\ncells = [16]\n[[sweep.settings]]\nobjects = [\"hills\"]\nkey = \"field.seed\"\nrange = { from = 1, \
                 to = 1000, steps = 1000 }\n[[sweep.settings]]\nmethods = [\"bi\"]\nkey = \"edge_clamp\"\nrange = { from = 0.0, to = 0.4, \
                 steps = 1000 }\n";
    let study = with(sweep).unwrap();
    let sweep = study.sweep().unwrap();
    assert_eq!(sweep.cases(), 1_000_000 + 1000 + 1000 + 1);
    assert_eq!(said(&sweep, 2, 999_999), "16 object.field.seed=1000 method.edge_clamp=0.4");
}

impl RangeSection {
    fn all_as_text(&self) -> String {
        let setting = SettingSection {
            objects: Vec::new(),
            methods: Vec::new(),
            key: String::new(),
            values: Vec::new(),
            range: Some(self.clone()),
        };
        setting.all().iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
    }
}
