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

fn error_with(from: &str, to: &str) -> String {
    paper_with(from, to).map(|_| ()).unwrap_err().to_string()
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
fn an_error_names_file_key_and_limit() {
    let error = error_with("isovalue = 0.0", "isovalue = nan");
    assert!(error.contains("paper.toml: objects[0].isovalue = NaN: must be a finite number"), "{error}");
    let error = error_with("benchmark_spacing = 0.04", "benchmark_spacing = -0.04");
    assert!(error.contains("objects[0].benchmark_spacing = -0.04: must be above 0"), "{error}");
    let error = error_with("supersampling = 2", "supersampling = 9");
    assert!(error.contains("turntable.supersampling = 9: must lie between 1 and 4"), "{error}");
    let error = error_with("duration_s = 8.0", "duration_s = 2.3");
    let told = "turntable.duration_s = 2.3: gives each of 120 frames 1 cs;";
    assert!(error.contains(told) && error.ends_with("at least 2.4 s, or fewer frames"), "{error}");
    assert!(paper_with("duration_s = 8.0", "duration_s = 2.4").is_ok());
    let error = error_with("max = [1.0, 1.0, 1.0]", "max = [1.0, -2.0, 1.0]");
    assert!(error.contains("objects[0].max[1] = -2: must be above objects[0].min = -1"), "{error}");
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
    let error = with(&[others]).map(|_| ()).unwrap_err().to_string();
    let expected = "two-methods.toml: arrangements[0] = five tetrahedra: has no clustering \"integrated\"";
    assert!(error.contains(expected), "{error}");
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
    let error = with(&[fitting.as_slice(), &[accumulated]].concat()).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("arrangements[0] = five tetrahedra: needs extraction.positions"), "{error}");
}

#[test]
fn extreme_numbers_are_told_in_few_letters() {
    let key = "benchmark_spacing = 0.04";
    let error = error_with(key, "benchmark_spacing = 1e300");
    assert!(error.contains("benchmark_spacing = 1e300: must be above 0 and at most 1000000"), "{error}");
    let error = error_with(key, "benchmark_spacing = 1e-300");
    assert!(error.contains("benchmark_spacing = 1e-300: is 0 in single precision"), "{error}");
    let error = error_with("radius = 1.0", "radius = 1e-60");
    assert!(error.contains("field.radius = 1e-60: is 0 in single precision"), "{error}");
    let error = error_with("isovalue = 0.0", "isovalue = -1e300");
    assert!(error.contains("isovalue = -1e300: must lie between -1000000000 and"), "{error}");
    let error = error_with("max = [1.0, 1.0, 1.0]", "max = [1.0, 1.0, -0.99999999999]");
    let told = "max[2] = -0.99999999999: must be above objects[0].min = -1 by more than single precision";
    assert!(error.contains(told), "{error}");
}

#[test]
fn unknown_keys_and_missing_files_are_named() {
    let error = error_with("memory_gib = 8.0", "memory_gib = 8.0\nmemory_gb = 1");
    assert!(error.contains("memory_gb") && error.contains("paper.toml"), "{error}");
    let error = error_with("radius = 1.0", "radius = 1.0, diameter = 2.0");
    assert!(error.contains("diameter"), "{error}");
    let error = error_with("../study/paper/responses.csv", "../study/paper/nobody.csv");
    assert!(error.contains("responses.file") && error.contains("nobody.csv"), "{error}");
    let path = Path::new("/nowhere/study.toml");
    assert!(Study::load(path).unwrap_err().to_string().contains("/nowhere/study.toml"));
}

#[test]
fn looks_and_light_are_as_published_unless_said_otherwise() {
    use crate::config::{LightFollows, Look, StimulusLook};
    let file = paper_with("schema = 1", "schema = 1").unwrap().file;
    assert_eq!(
        (file.turntable.look, file.shading.light_follows),
        (StimulusLook::Smooth, LightFollows::Scene)
    );
    assert_eq!((file.shading.ambient, file.shading.error_scale), (0.0, 0.1));
    // What the digests of stages are made of has not changed for a study that does not set them.
    let written = serde_json::to_string(&(&file.turntable, &file.shading, &file.stills)).unwrap();
    for key in ["look\"", "light_follows", "ambient", "error_scale", "turntable"] {
        assert!(!written.contains(key), "{key} in {written}");
    }

    let set = "supersampling = 2\nlook = \"flat\"\n";
    let light = "[shading]\nlight_follows = \"camera\"\nambient = 0.25\nerror_scale = 0.5\n";
    let file = paper_with("supersampling = 2\n\n[shading]\n", &format!("{set}{light}")).unwrap().file;
    assert_eq!((file.turntable.look, file.shading.light_follows), (StimulusLook::Flat, LightFollows::Camera));
    let written = serde_json::to_string(&(&file.turntable, &file.shading)).unwrap();
    for said in
        ["\"look\":\"flat\"", "\"light_follows\":\"camera\"", "\"ambient\":0.25", "\"error_scale\":0.5"]
    {
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
        |key: &str| error_with("supersampling = 2\n\n[shading]\n", &format!("supersampling = 2\n{key}\n"));
    let says = |error: String, parts: &[&str]| {
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    };
    let allowed = ["paper.toml", "expected one of `smooth`, `flat`, `smooth-wireframe`"];
    says(with("look = \"wireframe\"\n[shading]"), &allowed);
    says(with("look = \"quality\"\n[shading]"), &allowed);
    says(with("[shading]\nlight_follows = \"eye\""), &["light_follows", "`scene` or `camera`"]);
    says(with("[shading]\nambient = 1.5"), &["shading.ambient = 1.5: must lie between 0 and 1"]);
    says(with("[shading]\nambient = nan"), &["shading.ambient = NaN: must be a finite number"]);
    says(with("[shading]\nerror_scale = 0.0"), &["shading.error_scale = 0: must be above 0 and at most 10"]);
    let error = error_with("looks = [\"smooth\",", "looks = [\"shape\",");
    says(error, &["shape", "`quality`, `error`"]);
}

/// A look's name is the word that the study file has for it.
#[test]
fn looks_are_named_as_in_the_file() {
    use crate::config::Look::{Error, Flat, Quality, Smooth, SmoothWireframe, Wireframe};
    for look in [Smooth, Flat, Wireframe, SmoothWireframe, Quality, Error] {
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
    let error = Study::parse(&text, &path).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("two-methods.toml: comparisons = []: [forms] needs something to ask"), "{error}");
    let (asks_nobody, _) = text.split_once("[forms]").unwrap();
    assert!(Study::parse(asks_nobody, &path).is_ok());
}

#[test]
fn comparisons_must_make_sense() {
    let error = error_with("left = \"ss_bu\", right = \"ss_bi\"", "left = \"ss_bu\", right = \"as_bi\"");
    assert!(error.contains("comparisons[0].right = as_bi: must show the same object"), "{error}");
    let error = error_with("left = \"ss_bu\", right = \"ss_bi\"", "left = \"ss_bu\", right = \"ss_si\"");
    assert!(error.contains("no group has bu against si"), "{error}");
    let error = error_with("question = \"Q2\"", "question = \"Q1\"");
    assert!(
        error.contains("comparisons[1].question = Q1: already used by comparisons[0].question"),
        "{error}"
    );
    let error = error_with("members = [\"si\", \"bi\"]", "members = [\"su\", \"bu\"]");
    assert!(error.contains("is in groups U and I"), "{error}");
}
