//! Where a key of a study file stands.

use isostudy_design::Study;
use isostudy_design::wording::line_of;

/// The file, the line and the key: what an error begins with.
pub(crate) fn place(study: &Study, key: &str) -> String {
    let line = std::fs::read_to_string(&study.path).ok().and_then(|text| line_of(&text, key));
    let line = line.map_or_else(String::new, |line| format!("line {line}: "));
    format!("{}: {line}{key}", study.path.display())
}
