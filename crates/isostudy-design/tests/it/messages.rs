//! How what is wrong with a study or a run is worded. Other tests assert variants, keys and numbers; words stand in `messages.txt`
//! alone, which is compared as a whole. `ISOSTUDY_BLESS=1` writes it anew; its difference is then read before it is committed.

use isostudy_design::record::{InvalidPair, InvalidRun, InvalidSample};
use isostudy_design::{ConfigurationId, Date, MethodId, Study};
use std::collections::HashSet;
use std::fmt::{Display, Write};
use std::mem::discriminant;
use std::path::Path;

/// Passages of the paper's study file and what each is made, one a refusal.
const REFUSED: [(&str, &str); 36] = [
    ("isovalue = 0.0", "isovalue = nan"),
    ("isovalue = 0.0", "isovalue = -1e300"),
    ("benchmark_spacing = 0.04", "benchmark_spacing = -0.04"),
    ("benchmark_spacing = 0.04", "benchmark_spacing = 1e300"),
    ("benchmark_spacing = 0.04", "benchmark_spacing = 1e-300"),
    ("supersampling = 2", "supersampling = 9"),
    ("supersampling = 2", "supersampling = 2\nlook = \"wireframe\""),
    ("duration_s = 8.0", "duration_s = 2.3"),
    ("max = [1.0, 1.0, 1.0]", "max = [1.0, -2.0, 1.0]"),
    ("max = [1.0, 1.0, 1.0]", "max = [1.0, 1.0, -0.99999999999]"),
    ("memory_gib = 8.0", "memory_gib = 8.0\nmemory_gb = 1"),
    ("../study/paper/responses.csv", "../study/paper/nobody.csv"),
    ("left = \"ss_bu\", right = \"ss_bi\"", "left = \"ss_bu\", right = \"as_bi\""),
    ("left = \"ss_bu\", right = \"ss_bi\"", "left = \"ss_bu\", right = \"ss_si\""),
    ("question = \"Q2\"", "question = \"Q1\""),
    ("members = [\"si\", \"bi\"]", "members = [\"su\", \"bu\"]"),
    ("level = 0.05", "level = 0.51"),
    ("margin = 0.2", "margin = 1.0"),
    ("primary = []", "primary = [\" B-S\"]"),
    ("primary = []", "primary = [\"I-U\"]"),
    ("exclude = []", "exclude = [\"outlying\", \"outlying\"]"),
    ("[analysis]", "[analysis]\nfirst_answer = 2026-02-30"),
    ("[analysis]", "[analysis]\nreference = \"xx\""),
    ("schema = 1", "schema = 0"),
    ("left = \"ss_bu\", right = \"ss_bi\"", "left = \"ss_bu\", right = \"ss_ib\""),
    ("left = \"ss_bu\", right = \"ss_bi\"", "left = \"ss_bu\", right = \"sphere_bi\""),
    ("left = \"ss_bu\", right = \"ss_bi\"", "left = \"ss_bu\", right = \"torus_mc\""),
    ("left = \"ss_bu\", right = \"ss_bi\"", "left = \"ss_bu\", rigth = \"ss_bi\""),
    ("left = \"ss_bu\", right = \"ss_bi\"", "left = \"ss_bu\""),
    ("members = [\"si\", \"bi\"]", "members = [\"si\", \"by\"]"),
    ("primary = []", "primary = [\"B-S wihtin U\"]"),
    ("families = \"by-kind\"", "families = \"by_kind\""),
    ("field = { kind = \"sphere\"", "field = { kind = \"spere\""),
    ("arrangements = [\"body-centred\"", "arrangements = [\"body-centered\""),
    ("memory_gib = 8.0", "memory_gib = \"8 GiB\""),
    ("[limits]", "[[limits]]"),
];

fn runs() -> Vec<InvalidRun> {
    let id = || -> ConfigurationId { "ss_bi".parse().unwrap() };
    let sample = |reason| InvalidRun::Sample { list: "samples", place: 3, id: id(), reason };
    vec![
        sample(InvalidSample::NotADuration { what: "vertex", seconds: -0.5 }),
        sample(InvalidSample::Counter { what: "cpu_s", value: -1.0 }),
        sample(InvalidSample::Reference(f64::INFINITY)),
        sample(InvalidSample::Sum { total: 2.0, sum: 1.5 }),
        sample(InvalidSample::Round { iteration: 3, rounds: 3 }),
        InvalidRun::Twice { list: "samples", id: id(), round: 0 },
        InvalidRun::Rounds { list: "aa_samples", id: id(), found: 1, asked: 2 },
        InvalidRun::OneList { id: id() },
        InvalidRun::SharedInvocation(0),
        InvalidRun::NothingTimed,
        InvalidRun::Load { place: 0, others: 0.25, steal: 0.8 },
        InvalidRun::Memory { place: 0, id: id(), bytes: [2, 3, 1] },
        InvalidRun::MemoryTwice(id()),
    ]
}

#[test]
fn messages_are_worded_as_in_their_file() {
    let mut said = String::from("# Study files that are refused\n");
    let line = |said: &mut String, what: &dyn Display| writeln!(said, "{what}").unwrap();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/paper.toml");
    let paper = std::fs::read_to_string(&path).unwrap();
    for (from, to) in REFUSED {
        assert!(paper.contains(from), "{from}");
        let refused = Study::parse(&paper.replacen(from, to, 1), &path).map(|_| to).unwrap_err().to_string();
        line(&mut said, &refused.replace(path.parent().unwrap().to_str().unwrap(), "configs"));
    }

    said += "\n# Runs that cannot have been measured\n";
    let runs = runs();
    runs.iter().for_each(|fault| line(&mut said, fault));
    let listed: HashSet<_> = runs.iter().map(discriminant).collect();
    let reasons = runs.iter().filter_map(|fault| match fault {
        InvalidRun::Sample { reason, .. } => Some(discriminant(reason)),
        _ => None,
    });
    let declared = include_str!("../../src/record/validate.rs").matches("#[error(").count();
    assert_eq!(listed.len() + reasons.collect::<HashSet<_>>().len(), declared, "one is not listed here");
    let [old, new] = ["ss_bi", "ss_su"].map(|id| id.parse::<ConfigurationId>().unwrap());
    line(&mut said, &InvalidPair::Sample { id: old.clone(), reason: InvalidSample::Reference(0.0) });
    line(&mut said, &InvalidPair::Apart { old, new });

    said += "\n# Texts that are none\n";
    line(&mut said, &"B".parse::<MethodId>().unwrap_err());
    line(&mut said, &"bi".parse::<ConfigurationId>().unwrap_err());
    line(&mut said, &"21.11.2026".parse::<Date>().unwrap_err());

    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/messages.txt");
    if std::env::var_os("ISOSTUDY_BLESS").is_some_and(|value| value == "1") {
        std::fs::write(&golden, &said).unwrap();
    }
    let expected = std::fs::read_to_string(&golden).unwrap();
    for (expected, said) in expected.lines().zip(said.lines()) {
        assert_eq!(said, expected, "messages.txt; ISOSTUDY_BLESS=1 writes it anew");
    }
    assert_eq!(said, expected, "messages.txt; ISOSTUDY_BLESS=1 writes it anew");
}
