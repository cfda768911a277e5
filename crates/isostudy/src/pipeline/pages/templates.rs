//! The templates of both pages, and what they share: style, script, and pieces of a page.

use anyhow::Result;
use minijinja::Environment;
use minijinja::syntax::SyntaxConfig;
use serde::Serialize;

/// Tables that fit any page, their rows cards on a narrow screen: who reads no other reads these.
const FITTING: [&str; 5] = ["choices", "decision", "contrasts", "claims", "methods"];

/// The pages by name: `index.html`, `report.html` and `viewer.html`.
pub(super) fn environment() -> Result<Environment<'static>> {
    let mut environment = Environment::new();
    environment.set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?);
    for (name, text) in [
        ("style.css", include_str!("style.css")),
        ("script.js", include_str!("script.js")),
        ("shared.html", include_str!("shared.html")),
        ("index.html", include_str!("index.html")),
        ("report.html", include_str!("report.html")),
        ("viewer.html", include_str!("viewer/viewer.html")),
        ("viewer.css", include_str!("viewer/viewer.css")),
        ("viewer_start.js", include_str!("viewer/start.js")),
    ] {
        environment.add_template(name, text)?;
    }
    Ok(environment)
}

/// Whether a table of this name is set to fit.
pub(in crate::pipeline) fn fits(name: &str) -> bool {
    FITTING.contains(&name)
}

/// A picture of one method, as a page sees it.
#[derive(Serialize)]
pub(super) struct Picture {
    /// A file beside the page, or the picture itself.
    pub(super) source: String,
    /// What tables call the method.
    pub(super) id: String,
    pub(super) label: String,
    pub(super) alt: String,
    pub(super) width: u32,
    pub(super) height: u32,
}

/// What stands under the pictures of the methods. `left_out` is how many have none for want of room.
pub(in crate::pipeline) fn caption(object: &str, is_telling: bool, left_out: usize) -> String {
    let which = if is_telling { "the object on which their meshes differ most" } else { "one object" };
    let left_out = match left_out {
        0 => String::new(),
        1 => " 1 more method has no picture here.".into(),
        n => format!(" {n} more methods have no picture here."),
    };
    format!("The methods on {which}, the {object}: the first frame of each turntable.{left_out}")
}
