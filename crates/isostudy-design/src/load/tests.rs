use super::methods::with_method;
use super::*;
use crate::method::{Arrangement, Clustering, expand};

/// A study file of this project.
pub(crate) fn load(name: &str) -> Study {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs").join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    Study::parse(&text, &path).unwrap()
}

/// The paper's file with one passage replaced. Its mesh source need not be there.
pub(crate) fn paper_with(from: &str, to: &str) -> Result<Study, ConfigError> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/paper.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{from} is not in {}", path.display());
    Study::parse(&text.replacen(from, to, 1), &path)
}

/// Gives a study other factors, and the methods that follow; objects and questions stay.
pub(crate) fn cross(study: &mut Study, arrangements: &[Arrangement], clusterings: &[Clustering]) {
    let section = study.file.extraction.as_ref().expect("a study of the short form");
    (study.factors, study.methods) = {
        let (factors, methods) = expand(arrangements, clusterings, section);
        with_method(factors, methods)
    };
}

/// The key and the value that a file is refused for. How it is worded is in `tests/it/messages.txt`.
pub(crate) fn refused<T>(read: Result<T, ConfigError>) -> String {
    match read.map(|_| ()).unwrap_err() {
        ConfigError::Value { key, value, .. } => format!("{key} = {value}"),
        other => panic!("{other}"),
    }
}

/// What is said of a file that is not TOML, or has a key or word that there is not.
pub(crate) fn syntax<T>(read: Result<T, ConfigError>) -> String {
    match read.map(|_| ()).unwrap_err() {
        ConfigError::Syntax { message, .. } => message,
        other => panic!("{other}"),
    }
}

fn refused_with(from: &str, to: &str) -> String {
    refused(paper_with(from, to))
}

#[test]
fn the_papers_design_is_whole() {
    let study = paper_with("schema = 1", "schema = 1").unwrap();
    assert_eq!(study.configurations.len(), 18);
    let ids: Vec<String> = study.configurations.iter().map(|c| c.id.to_string()).collect();
    assert_eq!(ids[..6], ["ss_bu", "ss_bi", "ss_bp", "ss_su", "ss_si", "ss_sp"]);
    assert_eq!(ids[17], "bs_sp");
    assert_eq!(study.comparisons.len(), 27);
    let sizes: Vec<usize> = study.groups.iter().map(|g| g.comparisons.len()).collect();
    assert_eq!(sizes, [9, 9, 3, 3, 3]);
    assert_eq!(study.published.benchmark.len(), 18);
    assert_eq!(study.published.preferences.len(), 12 + 6 + 5);
    let (turntables, pairs) = study.code_names();
    assert_eq!((turntables.len(), pairs.len()), (18, 27));
}

#[test]
fn an_error_names_file_key_and_value() {
    let error = paper_with("isovalue = 0.0", "isovalue = nan").map(|_| ()).unwrap_err();
    assert!(matches!(&error, ConfigError::Value { file, .. } if file.ends_with("paper.toml")), "{error}");
    for (from, to, told) in [
        ("isovalue = 0.0", "isovalue = nan", "objects[0].isovalue = NaN"),
        ("benchmark_spacing = 0.04", "benchmark_spacing = -0.04", "objects[0].benchmark_spacing = -0.04"),
        ("supersampling = 2", "supersampling = 9", "turntable.supersampling = 9"),
        ("duration_s = 8.0", "duration_s = 2.3", "turntable.duration_s = 2.3"),
        ("max = [1.0, 1.0, 1.0]", "max = [1.0, -2.0, 1.0]", "objects[0].max[1] = -2"),
    ] {
        assert_eq!(refused_with(from, to), told);
    }
    assert!(paper_with("duration_s = 8.0", "duration_s = 2.4").is_ok());
}

#[test]
fn arrangements_beside_the_papers_have_what_they_have() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/two-methods.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let with = |changes: &[(&str, &str)]| {
        let change = |text: String, (from, to): &(&str, &str)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        };
        Study::parse(&changes.iter().fold(text.clone(), change), &path)
    };
    let others = (r#"["body-centred"]"#, r#"["five-tetrahedra", "face-centred"]"#);
    assert_eq!(refused(with(&[others])), "arrangements[0] = five tetrahedra");
    let fitting = [
        others,
        (r#"["none", "integrated"]"#, r#"["none", "edge-collapse"]"#),
        ("_bu", "_mu"),
        ("_bi", "_fu"),
        (r#""bu""#, r#""mu""#),
        (r#""bi""#, r#""fu""#),
    ];
    let study = with(&fitting).unwrap();
    let ids: Vec<String> = study.configurations.iter().map(|c| c.id.to_string()).collect();
    assert_eq!(ids[..4], ["ss_mu", "ss_mp", "ss_fu", "ss_fp"]);
    let accumulated = (r#"positions = "indexed""#, r#"positions = "accumulated""#);
    let error = with(&[fitting.as_slice(), &[accumulated]].concat()).map(|_| ()).unwrap_err();
    let ConfigError::Value { key, limit, .. } = error else { panic!("{error}") };
    assert!(key == "arrangements[0]" && limit.contains("extraction.positions"), "{limit}");
}

#[test]
fn extreme_numbers_are_told_in_few_letters() {
    for (from, to, told) in [
        ("benchmark_spacing = 0.04", "benchmark_spacing = 1e300", "objects[0].benchmark_spacing = 1e300"),
        ("benchmark_spacing = 0.04", "benchmark_spacing = 1e-300", "objects[0].benchmark_spacing = 1e-300"),
        ("radius = 1.0", "radius = 1e-60", "objects[0].field.radius = 1e-60"),
        ("isovalue = 0.0", "isovalue = -1e300", "objects[0].isovalue = -1e300"),
        ("max = [1.0, 1.0, 1.0]", "max = [1.0, 1.0, -0.99999999999]", "objects[0].max[2] = -0.99999999999"),
    ] {
        assert_eq!(refused_with(from, to), told);
    }
}

#[test]
fn unknown_keys_and_missing_files_are_named() {
    let error = syntax(paper_with("memory_gib = 8.0", "memory_gib = 8.0\nmemory_gb = 1"));
    assert!(error.contains("`memory_gb`"), "{error}");
    let error = syntax(paper_with("radius = 1.0", "radius = 1.0, diameter = 2.0"));
    assert!(error.contains("`diameter`"), "{error}");
    let missing = paper_with("../study/paper/responses.csv", "../study/paper/nobody.csv");
    let Err(ConfigError::MissingFile { key, path, .. }) = missing else { panic!("nobody.csv is not missed") };
    assert!(key == "responses.file" && path.ends_with("nobody.csv"));
    let nowhere = Path::new("/nowhere/study.toml");
    assert!(matches!(Study::load(nowhere), Err(ConfigError::Read { file, .. }) if file == nowhere));
}

#[test]
fn looks_and_light_are_as_published_unless_said_otherwise() {
    use crate::config::{LightFollows, Look, StimulusLook};
    let file = paper_with("schema = 1", "schema = 1").unwrap().file;
    assert_eq!(
        (file.turntable.look, file.shading.light_follows),
        (StimulusLook::Smooth, LightFollows::Scene)
    );
    assert_eq!((file.shading.ambient, file.shading.error_scale, file.shading.crease_deg), (0.0, 0.1, 40.0));
    // What the digests of stages are made of has not changed for a study that does not set them.
    let written = serde_json::to_string(&(&file.turntable, &file.shading, &file.stills)).unwrap();
    for key in ["look\"", "light_follows", "ambient", "error_scale", "crease_deg", "turntable"] {
        assert!(!written.contains(key), "{key} in {written}");
    }

    let set = "supersampling = 2\nlook = \"flat\"\n";
    let light = "[shading]\nlight_follows = \"camera\"\nambient = 0.25\nerror_scale = 0.5\ncrease_deg = 30\n";
    let file = paper_with("supersampling = 2\n\n[shading]\n", &format!("{set}{light}")).unwrap().file;
    assert_eq!((file.turntable.look, file.shading.light_follows), (StimulusLook::Flat, LightFollows::Camera));
    let written = serde_json::to_string(&(&file.turntable, &file.shading)).unwrap();
    for said in [
        "\"look\":\"flat\"",
        "\"light_follows\":\"camera\"",
        "\"ambient\":0.25",
        "\"error_scale\":0.5",
        "\"crease_deg\":30.0",
    ] {
        assert!(written.contains(said), "{said} not in {written}");
    }
    let looks = "looks = [\"quality\", \"error\"]\nturntable = true";
    let file = paper_with("looks = [\"smooth\", \"smooth-wireframe\"]", looks).unwrap().file;
    assert_eq!(
        (&file.stills[0].looks[..], file.stills[0].turntable),
        (&[Look::Quality, Look::Error][..], true)
    );
    assert!(serde_json::to_string(&file.stills[0]).unwrap().contains("\"turntable\":true"));
}

#[test]
fn unknown_looks_and_lights_are_told_what_there_is() {
    let with =
        |key: &str| paper_with("supersampling = 2\n\n[shading]\n", &format!("supersampling = 2\n{key}\n"));
    let says = |error: String, parts: &[&str]| {
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    };
    let allowed = ["`smooth`, `flat`, `smooth-wireframe`, `creased`"];
    says(syntax(with("look = \"wireframe\"\n[shading]")), &allowed);
    says(syntax(with("look = \"quality\"\n[shading]")), &allowed);
    says(syntax(with("[shading]\nlight_follows = \"eye\"")), &["light_follows", "`scene` or `camera`"]);
    let error = syntax(paper_with("looks = [\"smooth\",", "looks = [\"shape\","));
    says(error, &["shape", "`quality`, `error`, `creased`"]);
    assert_eq!(refused(with("[shading]\nambient = 1.5")), "shading.ambient = 1.5");
    assert_eq!(refused(with("[shading]\nambient = nan")), "shading.ambient = NaN");
    assert_eq!(refused(with("[shading]\nerror_scale = 0.0")), "shading.error_scale = 0");
    assert_eq!(refused(with("[shading]\ncrease_deg = 181")), "shading.crease_deg = 181");
    assert_eq!(refused(with("[shading]\ncrease_deg = -1")), "shading.crease_deg = -1");
}

/// A look's name is the word that the study file has for it.
#[test]
fn looks_are_named_as_in_the_file() {
    use crate::config::Look::{Creased, Error, Flat, Quality, Smooth, SmoothWireframe, Wireframe};
    for look in [Smooth, Flat, Wireframe, SmoothWireframe, Quality, Error, Creased] {
        assert_eq!(serde_json::to_value(look).unwrap(), look.name());
    }
}

#[test]
fn forms_need_something_to_ask() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/two-methods.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = text.split_once("comparisons = [").unwrap();
    let (_, after) = rest.split_once("\n]\n").unwrap();
    let text = format!("{before}comparisons = []\n{after}");
    assert_eq!(refused(Study::parse(&text, &path)), "comparisons = []");
    let (asks_nobody, _) = text.split_once("[forms]").unwrap();
    assert!(Study::parse(asks_nobody, &path).is_ok());
}

#[test]
fn comparisons_must_make_sense() {
    let first = "left = \"ss_bu\", right = \"ss_bi\"";
    let said = |right: &str| refused_with(first, &format!("left = \"ss_bu\", right = \"{right}\""));
    assert_eq!(said("as_bi"), "comparisons[0].right = as_bi");
    assert_eq!(said("ss_si"), "comparisons[0].question = Q1");
    assert_eq!(refused_with("question = \"Q2\"", "question = \"Q1\""), "comparisons[1].question = Q1");
    let members = refused_with("members = [\"si\", \"bi\"]", "members = [\"su\", \"bu\"]");
    assert_eq!(members, "comparisons[6].question = Q7");
}
