//! The level of tests is a study's own: what judges answers compares with no number of its own.

use std::fs;
use std::path::{Path, PathBuf};

/// Numbers that levels of tests and intervals are written as.
const LEVELS: [&str; 7] = ["0.01", "0.025", "0.05", "0.95", "0.975", "1.645", "1.96"];

/// Crates that judge answers or say what was judged.
const CRATES: [&str; 5] =
    ["isostudy-inference", "isostudy-paper", "isostudy-report", "isostudy-responses", "isostudy-statistics"];

/// Where such a number stands and is no level of a study: the file, how the line begins, and why.
const OTHERS: &[(&str, &str, &str)] = &[
    ("isostudy-inference/src/hypotheses.rs", "pub const ALPHA", "the level of a study that says none"),
    ("isostudy-statistics/src/interval.rs", "pub const LEVEL", "intervals are at 95 % whatever the level is"),
    ("isostudy-inference/src/audit.rs", "pub const ALARM", "probes for defects have a level of their own"),
    ("isostudy-inference/src/audit/turned.rs", "const DOUBT", "a pair kept from another probe, no verdict"),
    ("isostudy-inference/src/audit/side.rs", "const SMALLEST", "a size of a pull"),
    ("isostudy-inference/src/self_test.rs", "pub const OWN_AT_LEAST", "a share of simulated studies"),
    ("isostudy-inference/src/self_test/rates.rs", "const LEVEL", "of simulated tests, not of a study"),
    ("isostudy-inference/src/self_test/rates.rs", "Counted::Coverage", "of simulated intervals"),
    ("isostudy-inference/src/self_test/rates.rs", "let half", "of simulated intervals"),
    ("isostudy-paper/src/benchmark.rs", "const COUNTED_TWICE", "a share of triangles"),
    ("isostudy-report/src/figures/edge_groups.rs", "Panel {", "whiskers of a box"),
    ("isostudy-report/src/figures/fronts.rs", "Axes::TrianglesError", "room beside an axis"),
    ("isostudy-report/src/figures/sweep.rs", "const ASIDE", "a distance of marks"),
    ("isostudy-statistics/src/adaptive/known.rs", "const SPREADS", "widths of priors that are compared"),
    ("isostudy-statistics/src/heterogeneity.rs", "const CLOSE", "a step of an iteration"),
    ("isostudy-statistics/src/heterogeneity.rs", "if part <", "a step of an iteration"),
    ("isostudy-statistics/src/screening.rs", "Flag::Outlying", "rules of screening are fixed and printed"),
];

/// Files that are compiled for tests alone.
const FOR_TESTS: [&str; 4] = ["coverage.rs", "fixture.rs", "golden.rs", "tests.rs"];

fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if path.is_dir() && name != "tests" {
            sources(&path, into);
        } else if name.ends_with(".rs") && !FOR_TESTS.contains(&name.as_str()) {
            into.push(path);
        }
    }
}

/// The code alone: comments and texts are left out, lines stay.
fn code_of(text: &str) -> String {
    let (mut code, mut rest) = (String::new(), text.chars().peekable());
    while let Some(c) = rest.next() {
        match c {
            '/' if rest.peek() == Some(&'/') => while rest.next_if(|&c| c != '\n').is_some() {},
            '\'' if rest.peek() == Some(&'"') => {
                rest.next();
            }
            '"' => {
                while let Some(inner) = rest.next_if(|&c| c != '"') {
                    match inner {
                        '\n' => code.push('\n'),
                        '\\' if rest.next() == Some('\n') => code.push('\n'),
                        _ => {}
                    }
                }
                rest.next();
            }
            c => code.push(c),
        }
    }
    code
}

/// The numbers of a line of code.
fn numbers(line: &str) -> impl Iterator<Item = &str> {
    line.split(|c: char| !(c.is_ascii_alphanumeric() || c == '.' || c == '_'))
        .filter(|word| word.starts_with(|c: char| c.is_ascii_digit()))
        .map(|word| word.trim_end_matches("f64").trim_end_matches('_'))
}

#[test]
fn nothing_is_judged_at_a_level_that_stands_in_the_source() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the folder of crates");
    let mut files = Vec::new();
    CRATES.iter().for_each(|name| sources(&crates.join(name).join("src"), &mut files));
    files.sort();
    let (mut unknown, mut met) = (Vec::new(), vec![false; OTHERS.len()]);
    for path in &files {
        let text = fs::read_to_string(path).expect("a text");
        let file = path.strip_prefix(crates).expect("within").to_string_lossy().into_owned();
        // Tests at the end of a file plant numbers.
        let code = code_of(&text);
        let code = code.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        for (number, line) in code.lines().enumerate() {
            if !numbers(line).any(|of| LEVELS.contains(&of)) {
                continue;
            }
            let known =
                OTHERS.iter().position(|(of, begins, _)| *of == file && line.trim().starts_with(begins));
            match known {
                Some(place) => met[place] = true,
                None => unknown.push(format!("{file}:{}: {}", number + 1, line.trim())),
            }
        }
    }
    assert!(unknown.is_empty(), "the level is the study's; say why these are none:\n{}", unknown.join("\n"));
    for ((file, begins, _), met) in OTHERS.iter().zip(met) {
        assert!(met, "{file} has no line that begins with {begins}");
    }
}
