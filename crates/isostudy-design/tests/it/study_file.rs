//! `docs/study-file.md` against the types: every key of the study file is on the page and no other, ranges and names are those that
//! the program takes, and each example is part of a study.

use crate::page::{Row, Section, sections};
use isostudy_design::config::*;
use isostudy_design::machine::{CpuProfile, IsaLevel};
use isostudy_design::{Arrangement, Clustering, Recipe, Study};
use serde_json::Value as Json;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Table, kind, key.
type Key = (String, Option<String>, String);

/// What a recipe or a terrain says is opaque here; `cli` knows their keys.
fn is_opaque(section: &Section) -> bool {
    section.table == "methods.recipe" || section.kind.as_deref() == Some("terrain")
}

#[test]
fn every_key_is_on_the_page_and_no_other() {
    let mut on_the_page = BTreeSet::new();
    for section in sections().iter().filter(|section| !is_opaque(section)) {
        for row in &section.rows {
            let key = (section.table.clone(), section.kind.clone(), row.key.clone());
            assert!(on_the_page.insert(key.clone()), "{key:?} is there twice");
        }
    }
    let mut of_the_types = BTreeSet::new();
    walk("", &serde_json::to_value(full_study()).unwrap(), &mut of_the_types);
    walk("cpu", &serde_json::to_value(full_profile()).unwrap(), &mut of_the_types);
    let missing: Vec<_> = of_the_types.difference(&on_the_page).collect();
    let unknown: Vec<_> = on_the_page.difference(&of_the_types).collect();
    assert!(missing.is_empty() && unknown.is_empty(), "not on the page: {missing:?}; no key: {unknown:?}");
}

#[test]
fn keys_are_needed_where_the_page_says_so_and_not_elsewhere() {
    let mut tried = 0;
    for section in sections().iter().filter(|section| !is_opaque(section)) {
        for row in &section.rows {
            let mut table = with_example(section);
            let Some(at) = place(&mut table, section) else { panic!("{}: no example", section.table) };
            // One of three, none of which is needed by itself.
            if section.table == "methods.match" {
                continue;
            }
            at.remove(&row.key);
            let read = if section.table == "cpu" {
                table.try_into::<CpuProfile>().map(|_| ())
            } else {
                table.try_into::<StudyFile>().map(|_| ())
            };
            assert_eq!(read.is_err(), row.is_needed(), "[{}] {}: {read:?}", section.table, row.key);
            tried += 1;
        }
    }
    assert!(tried > 100, "{tried}");
}

#[test]
fn numbers_end_where_the_page_says() {
    let folder = Folder::new();
    let mut tried = 0;
    // What lies at an end of these is refused beside the other keys of an example.
    let meets_others = ["duration_s", "max"];
    for section in sections().iter().filter(|section| !is_opaque(section) && section.table != "cpu") {
        for (row, range) in section.rows.iter().filter_map(|row| Some((row, Range::of(row)?))) {
            let told = |number: f64| {
                let mut table = with_example(section);
                let at = place(&mut table, section).expect("an example has the table");
                set(at, row, number);
                folder.parse(&table).err()
            };
            let name = format!("[{}] {}", section.table, row.key);
            for outside in range.outside(row) {
                let error = told(outside).unwrap_or_else(|| panic!("{name} takes {outside}"));
                assert!(error.contains(&row.key), "{name} = {outside}: {error}");
            }
            for inside in range.inside() {
                if let Some(error) = told(inside).filter(|_| !meets_others.contains(&&*row.key)) {
                    // What is at odds with it may be refused; itself it is allowed.
                    let (_, told) = error.split_once("study.toml: ").expect("errors name the file");
                    let accused = told.split(" = ").next().unwrap().trim_end_matches("[0]");
                    assert!(!accused.ends_with(&format!(".{}", row.key)), "{name} = {inside}: {error}");
                }
            }
            tried += 1;
        }
    }
    assert!(tried >= 40, "{tried}");
}

#[test]
fn names_are_those_that_are_taken() {
    let mut tried = 0;
    for section in sections().iter().filter(|section| !is_opaque(section)) {
        for row in section.rows.iter().filter(|row| ["name", "list of names"].contains(&&*row.holds)) {
            let mut table = with_example(section);
            let at = place(&mut table, section).expect("an example has the table");
            let none = Value::from("no-such-name");
            at.insert(row.key.clone(), if row.holds == "name" { none } else { vec![none].into() });
            let error = match section.table.as_str() {
                "cpu" => table.try_into::<CpuProfile>().unwrap_err(),
                _ => table.try_into::<StudyFile>().unwrap_err(),
            };
            let error = error.message();
            let (_, known) = error.split_once("expected").unwrap_or_else(|| panic!("{}: {error}", row.key));
            let known: Vec<&str> = known.split('`').skip(1).step_by(2).collect();
            assert_eq!(row.names(), known, "[{}] {}", section.table, row.key);
            tried += 1;
        }
    }
    assert_eq!(tried, 28);
}

#[test]
fn every_example_is_part_of_a_study() {
    let folder = Folder::new();
    for section in sections() {
        assert_eq!(section.examples.len(), 1, "[{}] {:?}", section.table, section.kind);
        let table = with_example(&section);
        match section.table.as_str() {
            "cpu" => drop(table.try_into::<CpuProfile>().unwrap()),
            // Of answers without a study, and of a study without meshes.
            "responses.pairs" | "stimuli.files" => drop(table.try_into::<StudyFile>().unwrap()),
            name => drop(folder.parse(&table).unwrap_or_else(|error| panic!("[{name}]: {error}"))),
        }
    }
}

/// The questionnaire's page has a whole study of files.
#[test]
fn the_study_of_files_is_whole() {
    let page = std::fs::read_to_string("../../docs/questionnaire.md").unwrap();
    let (_, section) = page.split_once("### Stimuli of your own").unwrap();
    let text = section.split("```").find_map(|block| block.strip_prefix("toml\n")).unwrap();
    let study = Study::parse(text, Path::new("study.toml")).unwrap();
    assert!(study.shows_films() && study.configurations.len() == 2);
}

/// The folder of a study, with what the examples name.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("cpu")).unwrap();
        for (from, to) in [
            ("configs/cpu/x86-64-v3.toml", "cpu/x86-64-v3.toml"),
            ("study/paper/responses.csv", "answers.csv"),
            ("study/paper/published_preferences.csv", "published_preferences.csv"),
        ] {
            std::fs::copy(root().join(from), folder.path().join(to)).unwrap();
        }
        Self(folder)
    }

    fn parse(&self, table: &Table) -> Result<Study, String> {
        let text = toml::to_string(table).unwrap();
        Study::parse(&text, &self.0.path().join("study.toml")).map_err(|error| error.to_string())
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// What `isostudy new` writes, with the example of a section in the place of its own.
fn with_example(section: &Section) -> Table {
    let text = std::fs::read_to_string(root().join("crates/isostudy/src/commands/new/study.toml")).unwrap();
    let mut study: Table = text.parse().unwrap();
    // Not every example has the names of the levels that it is made of.
    study["analysis"].as_table_mut().unwrap().remove("primary");
    let example: Table = section.examples.first().expect("an example").parse().unwrap();
    if section.table == "cpu" {
        return example;
    }
    if example.contains_key("arrangements") {
        for key in ["methods", "factors", "comparisons", "groups", "forms"] {
            study.remove(key);
        }
    }
    // An example that has no table of its own stands in the first object or method.
    let at = match section.table.split_once('.') {
        Some((of @ ("objects" | "methods"), _)) => study[of][0].as_table_mut().unwrap(),
        _ => &mut study,
    };
    at.extend(example);
    study
}

/// The table of a section, the first of a list.
fn place<'t>(study: &'t mut Table, section: &Section) -> Option<&'t mut Table> {
    let mut path = section.table.split('.').filter(|name| !name.is_empty() && *name != "cpu");
    path.try_fold(study, |table, name| match table.get_mut(name)? {
        Value::Table(table) => Some(table),
        Value::Array(list) => list.first_mut()?.as_table_mut(),
        _ => None,
    })
}

/// Sets a number, or the first of a list.
fn set(table: &mut Table, row: &Row, number: f64) {
    let number = if row.holds.contains("whole") { (number as i64).into() } else { Value::from(number) };
    match table.get_mut(&row.key) {
        Some(Value::Array(list)) => list[0] = number,
        _ => drop(table.insert(row.key.clone(), number)),
    }
}

/// A range of numbers, as the page writes it.
struct Range {
    ends: [f64; 2],
    are_allowed: [bool; 2],
}

impl Range {
    fn of(row: &Row) -> Option<Self> {
        let (from, to, are_allowed) = if let Some(rest) = row.range.strip_prefix("above ") {
            let at_most = rest.split_once(", at most ").map(|(from, to)| (from, to, [false, true]));
            at_most.or_else(|| rest.split_once(", below ").map(|(from, to)| (from, to, [false, false])))?
        } else {
            row.range.split_once(" to ").map(|(from, to)| (from, to, [true, true]))?
        };
        let ends = [from.parse().ok()?, to.parse().ok()?];
        Some(Self { ends, are_allowed })
    }

    /// What is allowed, at the ends or just within them.
    fn inside(&self) -> Vec<f64> {
        let [from, to] = self.ends;
        let within = [from + 1e-9 * (to - from), to - 1e-9 * (to - from)];
        (0..2).map(|end| if self.are_allowed[end] { self.ends[end] } else { within[end] }).collect()
    }

    /// What is not, at the ends or just beyond them.
    fn outside(&self, row: &Row) -> Vec<f64> {
        let beyond = |end: usize| {
            let sign = [-1.0, 1.0][end];
            let step = if row.holds.contains("whole") { 1.0 } else { 1e-9 * self.ends[end].abs().max(1e-3) };
            if self.are_allowed[end] { self.ends[end] + sign * step } else { self.ends[end] }
        };
        // TOML has no larger whole number than 2^63 - 1.
        (0..2).filter(|&end| self.ends[end] < 9e18).map(beyond).collect()
    }
}

/// Adds the keys of a table and of those in it.
fn walk(table: &str, value: &Json, keys: &mut BTreeSet<Key>) {
    match value {
        Json::Array(list) => list.iter().for_each(|value| walk(table, value, keys)),
        Json::Object(entries) => {
            let is_field = table == "objects.field";
            let kind = entries.get("kind").and_then(Json::as_str).filter(|_| is_field).map(str::to_owned);
            for (key, value) in entries.iter().filter(|(key, _)| !(is_field && *key == "kind")) {
                let path = if table.is_empty() { key.clone() } else { format!("{table}.{key}") };
                keys.insert((table.to_owned(), kind.clone(), key.clone()));
                // Keys of these are the study's own, or another crate's.
                if !["extraction", "methods.levels", "methods.recipe", "forms.texts", "forms.texts_files"]
                    .contains(&path.as_str())
                {
                    walk(&path, value, keys);
                }
            }
        }
        _ => {}
    }
}

/// A study with every key. Each field is written out, so that a new one does not compile before it is here.
fn full_study() -> StudyFile {
    let text = String::new;
    let id = || "torus_bi".parse().unwrap();
    let method = |budget| MethodSection {
        id: "bi".parse().unwrap(),
        label: text(),
        recipe: Recipe { kind: text(), settings: Table::new() },
        levels: [(text(), text())].into(),
        budget: Some(budget),
        look: Some(StimulusLook::Flat),
        apart: Some(text()),
    };
    let bi = "bi".parse().unwrap();
    StudyFile {
        schema: 1,
        study: StudySection { id: text(), title: text(), seed: 1 },
        limits: LimitsSection { memory_gib: 1.0, hours: Some(1.0) },
        extraction: Some(Table::new()),
        objects: fields().map(object).into(),
        arrangements: vec![Arrangement::BodyCentred],
        clusterings: vec![Clustering::None],
        methods: [Quantity::Triangles, Quantity::Samples, Quantity::Time]
            .map(|quantity| method(BudgetSection { quantity, of: bi, within: 0.02 }))
            .into(),
        factors: vec![FactorSection {
            name: text(),
            levels: vec![LevelSection::Spelt(SpeltLevel {
                name: text(),
                code: Some(text()),
                phrase: Some(text()),
                within: Some(text()),
            })],
        }],
        turntable: TurntableSection {
            width: 1,
            height: 1,
            frames: 1,
            duration_s: 1.0,
            elevation_rad: 1.0,
            near: 1.0,
            far: 1.0,
            supersampling: 1,
            look: StimulusLook::Flat,
        },
        shading: ShadingSection {
            light: [0.0; 3],
            lit: [0.0; 3],
            shade: [0.0; 3],
            highlight: [0.0; 3],
            background: [0.0; 3],
            light_follows: LightFollows::Camera,
            ambient: 1.0,
            error_scale: 1.0,
            crease_deg: 1.0,
        },
        stimuli: StimuliSection {
            pair_scale: 1,
            files: vec![ShownFile { configuration: "ss_bi".parse().unwrap(), file: text() }],
            duration_s: 1.0,
        },
        stills: vec![StillSection {
            id: text(),
            caption: text(),
            configuration: id(),
            spacing: 1.0,
            looks: vec![Look::Smooth],
            turntable: true,
        }],
        viewer: Some(ViewerSection { three: text(), resolutions: vec![1.0] }),
        benchmark: BenchmarkSection {
            warmup: 1,
            iterations: 1,
            short_iterations: 1,
            aa_iterations: 1,
            pin: true,
            threads: 1,
            chunks: 1,
            stored: true,
            memory: true,
            target: text(),
            machines: vec![text()],
            sweep: Some(ThreadSweepSection {
                objects: vec![text()],
                cells: vec![1],
                threads: vec![1],
                iterations: 1,
            }),
        },
        sweep: Some(SweepSection {
            objects: vec![text()],
            methods: vec![bi],
            cells: vec![1],
            combine: Combine::Listed,
            limit: 1,
            cases_per_job: 1,
            times: 1,
            pictures: true,
            settings: vec![SettingSection {
                objects: vec![text()],
                methods: vec![bi],
                key: text(),
                values: vec![1.into()],
                range: Some(RangeSection {
                    from: 1.into(),
                    to: 2.into(),
                    steps: 2,
                    scale: Scale::Logarithmic,
                }),
            }],
        }),
        comparisons: vec![ComparisonSection { question: text(), left: id(), right: id() }],
        groups: vec![GroupSection { id: text(), label: text(), members: vec![bi] }],
        forms: Some(FormsSection {
            prompt: text(),
            way: Way::Graded,
            choices: vec![text(), text(), text()],
            choices_stacked: Some(vec![text(), text(), text()]),
            steps: 5,
            ends: Some([text(), text()]),
            none: true,
            min_surface_px: Some(16),
            participants: 1,
            sides: SideRule::Balanced,
            order: OrderRule::Shuffled,
            names: ShownNames::CodeNames,
            controls: 1,
            repeats: 1,
            max_questions: 1,
            training: vec![TrainingSection { left: id(), right: id() }],
            consent: text(),
            instructions: text(),
            page_scale: 1,
            web_mb: 41,
            completion: Some(text()),
            languages: vec!["de".into()],
            texts: [(text(), [(text(), text())].into())].into(),
            texts_files: [(text(), text())].into(),
            about: vec![AboutSection {
                id: text(),
                kind: AboutKind::Scale,
                ask: Some(text()),
                options: vec![text()],
                from: Some(1.0),
                to: Some(2.0),
                ends: Some([text(), text()]),
                when: AboutTime::After,
                optional: true,
                expects: Some(1),
                screens_out: vec![1],
                most: vec![1],
            }],
            free_text: true,
            comment: true,
            contact: Some(text()),
            ethics: Some(text()),
            least_age: Some(18),
            retention_days: Some(30),
            panel: Panel::Sona,
            completion_withdrawn: Some(text()),
            completion_screened: Some(text()),
            completion_full: Some(text()),
            per_form: Some(1),
            go_back: true,
            adaptive: true,
            stimulus: Presentation::Model,
            three: Some("cache/three".into()),
        }),
        responses: Some(ResponsesSection {
            file: Some(text()),
            format: Some(text()),
            separator: Some(text()),
            questions: Some(vec![text()]),
            question_columns: Some(vec![1]),
            first_question_column: Some(1),
            participant_column: Some(1),
            synonyms: Some(SynonymsSection { left: vec![text()], none: vec![text()], right: vec![text()] }),
            unknown: Some(text()),
            duplicates: Some(text()),
            asked: Some(text()),
            reference: Some(text()),
            shown_s: Some(1.0),
            pairs: vec![PairSection {
                question: text(),
                left: text(),
                right: text(),
                object: text(),
                group: text(),
            }],
        }),
        analysis: AnalysisSection {
            declared: Some("2026-11-22".parse().unwrap()),
            first_answer: Some("2026-11-22".parse().unwrap()),
            answers_known: true,
            level: 0.05,
            margin: 0.2,
            families: FamilyRule::One,
            primary: vec![text()],
            stopping: Some(StoppingSection {
                looks: vec![8, 24],
                boundary: StoppingBoundary::Pocock,
                when: StopWhen::Any,
            }),
            reference: Some(text()),
            exclude: vec![Exclusion::Outlying],
            people: Some(text()),
            subgroups: vec![text()],
            covariates: vec![text()],
        },
        published: Some(PublishedSection {
            source: text(),
            benchmark: Some(text()),
            preferences: Some(text()),
            claims: Some(text()),
        }),
    }
}

/// A field of each kind but terrains, which are opaque.
fn fields() -> [FieldSection; 9] {
    let inside = Some(Inside::Above);
    let text = String::new;
    let source = MeshSourceSection {
        file: text(),
        sha256: Some(text()),
        axes: [text(), text(), text()],
        scale: 1.0,
        offset: [0.0; 3],
    };
    let fields = [
        FieldSection::Sphere { radius: 1.0 },
        FieldSection::Asteroid {},
        FieldSection::Mesh { file: Some(text()), sources: vec![source], allow_open: true },
        FieldSection::Formula { text: text(), inside, close: true },
        FieldSection::Volume { file: text(), inside, close: true },
        FieldSection::Grid { file: text(), array: Some(text()), inside },
        FieldSection::Points {
            file: text(),
            normals: PointNormals::Estimated,
            kernel: PointKernel::Triharmonic,
            offset: Some(1.0),
            smoothing: 1.0,
            centres: 4,
            inside,
            close: true,
        },
        FieldSection::Soup { file: text(), epsilon: Some(1.0), inside, close: true },
        FieldSection::Terrain(Table::new()),
    ];
    for field in &fields {
        // A kind that is added here belongs above as well.
        match field {
            FieldSection::Sphere { .. } | FieldSection::Asteroid {} | FieldSection::Mesh { .. } => {}
            FieldSection::Formula { .. } | FieldSection::Volume { .. } | FieldSection::Grid { .. } => {}
            FieldSection::Terrain(_) | FieldSection::Points { .. } | FieldSection::Soup { .. } => {}
            // Nobody writes it.
            FieldSection::Files {} => {}
        }
    }
    fields
}

fn object(field: FieldSection) -> ObjectSection {
    ObjectSection {
        id: String::new(),
        name: String::new(),
        field,
        isovalue: 0.0,
        min: [0.0; 3],
        max: [0.0; 3],
        benchmark_spacing: 1.0,
        stimulus_spacing: 1.0,
        camera: CameraSection { distance: 1.0, vertical_fov_rad: 1.0, middle_z: 1.0 },
        region: Some(RegionSection { name: String::new(), min: [0.0; 3], max: [0.0; 3] }),
    }
}

fn full_profile() -> CpuProfile {
    CpuProfile {
        name: String::new(),
        model: String::new(),
        cores: Some(1),
        threads: Some(1),
        base_mhz: Some(1),
        boost_mhz: Some(1),
        l1d_kib: Some(1),
        l2_kib: Some(1),
        l3_kib: Some(1),
        memory_gib: Some(1),
        os: Some(String::new()),
        isa: Some(IsaLevel::V1),
        target_cpu: Some(String::new()),
        features: vec![String::new()],
    }
}
