//! A benchmark that needs no study: methods and fields in a few lines, of which a study is made.
//!
//! What is wrong is said all at once: each method is tried with a ball, and each object with one method, so that no fault hides another.

use crate::recipe::{finish, recipe};
use anyhow::{Result, bail};
use isostudy_design::Study;
use isostudy_design::machine::CpuProfile;
use isostudy_design::record::Purpose;
use isostudy_design::wording::{did_you_mean, line_of, plainly};
use isostudy_extract::presets;
use std::path::Path;
use toml::{Table, Value};

/// What may be said of the whole, what holds where nothing is said, and the least and the most.
const NUMBERS: [(&str, i64, i64, i64); 7] = [
    ("cells", 64, 2, 4096),
    ("rounds", 30, 1, 100_000),
    ("aa_rounds", 8, 0, 100_000),
    ("warmup", 1, 0, 10_000),
    ("threads", 1, 0, 1024),
    ("seed", 1, 0, i64::MAX),
    ("memory_gib", 4, 1, 1024),
];
/// What may be said of an object.
const OF_OBJECT: [&str; 5] = ["field", "min", "max", "isovalue", "cells"];
/// Half the side of the box where none is given: round a ball of radius 1.
const HALF_SIDE: f64 = 1.1;
/// What a study needs and no benchmark looks at.
const LOOKS: &str = r#"
[turntable]
width = 96
height = 96
frames = 12
duration_s = 0.8
elevation_rad = 0.5235988
near = 1e-4
far = 100.0
supersampling = 2

[shading]
light = [-0.6, 0.2, -0.8]
lit = [0.949, 0.553, 0.027]
shade = [0.212, 0.071, 0.310]
highlight = [1.0, 0.95, 0.8]
background = [0.004, 0.509, 0.506]

[stimuli]
pair_scale = 1
"#;

/// The study of a benchmark file; `None` of what is no such file. `more` may find faults in a study of one object or one method, too.
///
/// # Errors
/// All that is wrong, with the lines.
pub(super) fn study(path: &Path, text: &str, more: &dyn Fn(&Study) -> Result<()>) -> Result<Option<Study>> {
    let Ok(file) = toml::from_str::<Table>(text) else { return Ok(None) };
    if !is_benchmark(&file) {
        return Ok(None);
    }
    let mut reading = Reading { path, text, more, faults: Vec::new() };
    let made = reading.study(&file);
    match (made, &reading.faults[..]) {
        (Some(made), []) => Ok(Some(made)),
        (_, [fault]) => bail!("{}: {fault}", path.display()),
        (_, faults) => bail!("{}: {} faults\n  {}", path.display(), faults.len(), faults.join("\n  ")),
    }
}

/// A study says what it is, and lists its objects and methods as tables.
fn is_benchmark(file: &Table) -> bool {
    let has_table_of_objects = file.get("objects").is_some_and(Value::is_table);
    let first = file.get("methods").and_then(Value::as_array).and_then(|methods| methods.first());
    let has_names = first.is_some_and(|first| first.is_str() || first.get("kind").is_some());
    !file.contains_key("study") && !file.contains_key("schema") && (has_table_of_objects || has_names)
}

struct Reading<'a> {
    path: &'a Path,
    text: &'a str,
    more: &'a dyn Fn(&Study) -> Result<()>,
    faults: Vec<String>,
}

impl Reading<'_> {
    /// `None` if there are faults.
    fn study(&mut self, file: &Table) -> Option<Study> {
        let known = || NUMBERS.iter().map(|(key, ..)| *key).chain(["methods", "objects"]);
        for key in file.keys().filter(|key| known().all(|of| of != *key)) {
            self.fault(key, &format!("there is no such key{}", did_you_mean(key, known())));
        }
        let numbers = NUMBERS.map(|(key, default, low, high)| match file.get(key) {
            None => default,
            Some(Value::Integer(number)) if (low..=high).contains(number) => *number,
            Some(other) => {
                self.fault(key, &format!("{other} must be a whole number from {low} to {high}"));
                default
            }
        });
        let methods = self.methods(file.get("methods"));
        let objects = self.objects(file.get("objects"), numbers[0]);
        let ball = object("ball", ball(), [-HALF_SIDE, HALF_SIDE].map(|at| [at; 3]), 0.0, 8);
        let one = method("mc", "marching cubes", Value::from(Table::from_iter([kind("cubes")])));
        // Each by itself.
        for (place, of) in &methods {
            if let Err(error) = self.made(&numbers, &[of], &[&ball]) {
                self.found(place, "methods[0]", &error);
            }
        }
        for (place, of) in &objects {
            if let Err(error) = self.made(&numbers, &[&one], &[of]) {
                self.found(place, "objects[0]", &error);
            }
        }
        if !self.faults.is_empty() {
            return None;
        }
        let methods: Vec<&Table> = methods.iter().map(|(_, of)| of).collect();
        let objects: Vec<&Table> = objects.iter().map(|(_, of)| of).collect();
        match self.made(&numbers, &methods, &objects) {
            Ok(study) => Some(study),
            Err(error) => {
                self.found("methods", "methods", &error);
                None
            }
        }
    }

    /// Names of presets, or tables of a kind with an id.
    fn methods(&mut self, given: Option<&Value>) -> Vec<(String, Table)> {
        let Some(list) = given.and_then(Value::as_array).filter(|list| !list.is_empty()) else {
            self.fault("methods", "a list of methods is needed, such as [\"mc\", \"nets\"]");
            return Vec::new();
        };
        let mut methods: Vec<(String, Table)> = Vec::new();
        for (i, entry) in list.iter().enumerate() {
            let place = format!("methods[{i}]");
            let made = match entry {
                Value::String(id) => match presets().iter().find(|of| of.id == id) {
                    Some(preset) => Value::try_from(preset.method)
                        .map(|recipe| method(preset.id, preset.label, recipe))
                        .map_err(|error| error.to_string()),
                    None => {
                        let near = did_you_mean(id, presets().iter().map(|of| of.id));
                        Err(format!("{id:?} is no method; `isostudy methods` lists them{near}"))
                    }
                },
                Value::Table(keys) => match keys.get("id").and_then(Value::as_str) {
                    Some(id) => {
                        let mut recipe = keys.clone();
                        recipe.remove("id");
                        Ok(method(id, id, recipe.into()))
                    }
                    None => Err("a method with keys of its own needs an id".into()),
                },
                other => Err(format!("{other} is neither a name nor a table")),
            };
            match made {
                Ok(made) if methods.iter().any(|(_, other)| other["id"] == made["id"]) => {
                    self.fault(&place, &format!("{} is there twice", made["id"]));
                }
                Ok(made) => methods.push((place, made)),
                Err(fault) => self.fault(&place, &fault),
            }
        }
        methods
    }

    fn objects(&mut self, given: Option<&Value>, cells: i64) -> Vec<(String, Table)> {
        let Some(tables) = given.and_then(Value::as_table).filter(|tables| !tables.is_empty()) else {
            self.fault("objects", "an object is needed, such as [objects.ball] with its field");
            return Vec::new();
        };
        let mut objects = Vec::new();
        for (id, keys) in tables {
            let place = format!("objects.{id}");
            let Some(keys) = keys.as_table() else {
                self.fault(&place, "must be a table with a field");
                continue;
            };
            let before = self.faults.len();
            for key in keys.keys().filter(|key| OF_OBJECT.iter().all(|of| of != key)) {
                let near = did_you_mean(key, OF_OBJECT);
                self.fault(&format!("{place}.{key}"), &format!("there is no such key{near}"));
            }
            let ends = [("min", -HALF_SIDE), ("max", HALF_SIDE)].map(|(key, default)| match keys.get(key) {
                None => [default; 3],
                Some(given) => corner(given).unwrap_or_else(|| {
                    self.fault(&format!("{place}.{key}"), &format!("{given} must be three numbers"));
                    [default; 3]
                }),
            });
            let isovalue = match keys.get("isovalue") {
                None => 0.0,
                Some(given) => number(given).unwrap_or_else(|| {
                    self.fault(&format!("{place}.isovalue"), &format!("{given} must be a number"));
                    0.0
                }),
            };
            let cells = match keys.get("cells") {
                None => cells,
                Some(Value::Integer(cells)) if (2..=4096).contains(cells) => *cells,
                Some(other) => {
                    let fault = format!("{other} must be a whole number from 2 to 4096");
                    self.fault(&format!("{place}.cells"), &fault);
                    cells
                }
            };
            if (0..3).any(|axis| ends[0][axis].partial_cmp(&ends[1][axis]) != Some(std::cmp::Ordering::Less))
            {
                self.fault(&format!("{place}.max"), "must be above min on every axis");
            }
            match keys.get("field") {
                Some(field) if self.faults.len() == before => {
                    objects.push((place, object(id, field.clone(), ends, isovalue, cells)));
                }
                Some(_) => {}
                None => {
                    self.fault(&place, "has no field, such as field = { kind = \"sphere\", radius = 1.0 }")
                }
            }
        }
        objects
    }

    /// The study of some methods and some objects.
    fn made(&self, numbers: &[i64; 7], methods: &[&Table], objects: &[&Table]) -> Result<Study> {
        let [_, rounds, aa_rounds, warmup, threads, seed, memory_gib] = *numbers;
        let stem =
            self.path.file_stem().map(|stem| stem.to_string_lossy().to_lowercase()).unwrap_or_default();
        let id: String =
            stem.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).take(64).collect();
        let mut study: Table = toml::from_str(LOOKS)?;
        let tables = |of: &[&Table]| Value::Array(of.iter().map(|&of| of.clone().into()).collect());
        study.insert("schema".into(), 1.into());
        study.insert("methods".into(), tables(methods));
        study.insert("objects".into(), tables(objects));
        let table = |keys: Vec<(&str, Value)>| -> Value {
            Table::from_iter(keys.into_iter().map(|(key, value)| (key.to_owned(), value))).into()
        };
        let title = format!("Benchmark {stem}");
        let about = vec![("id", id.into()), ("title", title.into()), ("seed", seed.into())];
        study.insert("study".into(), table(about));
        study.insert("limits".into(), table(vec![("memory_gib", (memory_gib as f64).into())]));
        let plan = vec![
            ("warmup", warmup.into()),
            ("iterations", rounds.into()),
            ("short_iterations", rounds.min(3).into()),
            ("aa_iterations", aa_rounds.into()),
            ("threads", threads.into()),
            ("target", "any".into()),
        ];
        study.insert("benchmark".into(), table(plan));
        let any = CpuProfile::parse("name = \"any\"\nmodel = \"\"", self.path)?;
        let made = Study::for_cpu(&toml::to_string(&study)?, self.path, any)?;
        for method in &made.methods {
            recipe(&made, method.id, Purpose::Benchmark)?;
            finish(&made, method.id)?;
        }
        (self.more)(&made)?;
        Ok(made)
    }

    /// Notes what is wrong with a key, and on which line.
    fn fault(&mut self, key: &str, what: &str) {
        let line = line_of(self.text, key).map_or_else(String::new, |line| format!("line {line}: "));
        self.faults.push(format!("{line}{key}: {what}"));
    }

    /// Notes what is wrong with a study of which one entry, called `made` there, stands at a place here.
    fn found(&mut self, place: &str, made: &str, error: &anyhow::Error) {
        let said = format!("{error:#}");
        let said = said.strip_prefix(&format!("{}: ", self.path.display())).unwrap_or(&said);
        // Lines are those of a text that nobody sees.
        let said = match said.strip_prefix("line ").and_then(|rest| rest.split_once(": ")) {
            Some((number, rest)) if number.bytes().all(|b| b.is_ascii_digit()) => rest,
            _ => said,
        };
        // Of a message about syntax the last line says what is wrong.
        let last = said.lines().rfind(|line| !line.trim().is_empty()).unwrap_or(said);
        let plain = plainly(last).replace(&format!("{made}.recipe"), place).replace(made, place);
        match plain.strip_prefix(place).map(|rest| rest.split([' ', ':']).next().unwrap_or_default()) {
            Some(rest) => {
                let key = format!("{place}{rest}");
                let line = line_of(self.text, &key).map_or_else(String::new, |line| format!("line {line}: "));
                self.faults.push(format!("{line}{plain}"));
            }
            None => self.fault(place, &plain),
        }
    }
}

fn kind(of: &str) -> (String, Value) {
    ("kind".to_owned(), of.into())
}

fn ball() -> Value {
    Table::from_iter([kind("sphere"), ("radius".to_owned(), 1.0.into())]).into()
}

fn method(id: &str, label: &str, recipe: Value) -> Table {
    let keys = [("id", id.into()), ("label", label.into()), ("recipe", recipe)];
    Table::from_iter(keys.map(|(key, value)| (key.to_owned(), value)))
}

/// An object of a study, with so many cells along its longest side.
fn object(id: &str, field: Value, [min, max]: [[f64; 3]; 2], isovalue: f64, cells: i64) -> Table {
    let longest = (0..3).map(|axis| max[axis] - min[axis]).fold(f64::MIN_POSITIVE, f64::max);
    let spacing = longest / cells as f64;
    let camera = [("distance", 2.0), ("vertical_fov_rad", 1.0)];
    let camera = Table::from_iter(camera.map(|(key, value)| (key.to_owned(), value.into())));
    let point = |at: [f64; 3]| Value::Array(at.map(Value::from).to_vec());
    let keys: [(&str, Value); 9] = [
        ("id", id.into()),
        ("name", id.into()),
        ("field", field),
        ("isovalue", isovalue.into()),
        ("min", point(min)),
        ("max", point(max)),
        ("benchmark_spacing", spacing.into()),
        ("stimulus_spacing", spacing.into()),
        ("camera", camera.into()),
    ];
    Table::from_iter(keys.map(|(key, value)| (key.to_owned(), value)))
}

fn number(value: &Value) -> Option<f64> {
    let number = value.as_float().or_else(|| value.as_integer().map(|number| number as f64));
    number.filter(|number| number.is_finite())
}

fn corner(value: &Value) -> Option<[f64; 3]> {
    let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(number).collect();
    numbers?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Option<Study>> {
        study(Path::new("a folder/Two Blobs.toml"), text, &|_| Ok(()))
    }

    const FILE: &str = "\
methods = [\"mc\", \"nets\", { id = \"smooth\", kind = \"surface-nets\", smoothing = 4 }]
cells = 20
rounds = 5

[objects.ball]
field = { kind = \"sphere\", radius = 1.0 }

[objects.waves]
field = { kind = \"formula\", text = \"sin(3*x)*sin(3*y) - 2*z\" }
min = [-1, -1, -0.5]
max = [1, 1, 0.5]
cells = 40
";

    #[test]
    fn a_few_lines_are_a_study() {
        let made = read(FILE).unwrap().unwrap();
        let ids: Vec<String> = made.configurations.iter().map(|of| of.id.to_string()).collect();
        assert_eq!(ids.len(), 6, "{ids:?}");
        assert_eq!((made.file.study.id.as_str(), made.file.benchmark.iterations), ("two-blobs", 5));
        let [ball, waves] = &made.file.objects[..] else { panic!() };
        assert_eq!((ball.min, ball.isovalue), ([-1.1; 3], 0.0));
        assert!((ball.benchmark_spacing - 2.2 / 20.0).abs() < 1e-12 && waves.benchmark_spacing == 0.05);
        assert!(recipe(&made, made.methods[0].id, Purpose::Benchmark).is_ok());
    }

    #[test]
    fn what_is_a_study_is_none() {
        assert!(read("schema = 1\nmethods = [\"mc\"]\n").unwrap().is_none());
        assert!(read("[[methods]]\nid = \"a\"\n[[objects]]\nid = \"b\"\n").unwrap().is_none());
        assert!(read("").unwrap().is_none() && read("no toml").unwrap().is_none());
    }

    #[test]
    fn all_faults_are_said_at_once_with_their_lines() {
        let broken = FILE
            .replace("\"nets\"", "\"nest\"")
            .replace("smoothing = 4", "smoothin = 4")
            .replace("rounds = 5", "rouns = 5")
            .replace("cells = 20", "cells = 1")
            .replace("radius = 1.0", "radius = -1.0")
            .replace("max = [1, 1, 0.5]", "max = [1, 1, -0.5]");
        let said = format!("{:#}", read(&broken).unwrap_err());
        let expected = [
            "6 faults",
            "line 3: rouns: there is no such key; did you mean rounds?",
            "line 2: cells: 1 must be a whole number from 2 to 4096",
            "did you mean nets?",
            "did you mean smoothing?",
            "line 6: objects.ball.field.radius",
            "line 11: objects.waves.max: must be above min on every axis",
        ];
        for part in expected {
            assert!(said.contains(part), "{part} in {said}");
        }
        assert!(!said.contains("[0]") || said.contains("methods[0]"), "{said}");
    }

    #[test]
    fn one_fault_has_a_line_of_its_own() {
        let said = format!(
            "{:#}",
            read("methods = []\n[objects.a]\nfield = { kind = \"asteroid\" }\n").unwrap_err()
        );
        assert!(
            said.ends_with("line 1: methods: a list of methods is needed, such as [\"mc\", \"nets\"]"),
            "{said}"
        );
    }
}
