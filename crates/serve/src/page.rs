//! The questionnaire's page.

use design::forms::{FormEntry, FormFile};
use serde::Serialize;

/// The files of the page but `forms.js` and the stimuli: name, MIME type, content.
pub const FILES: [(&str, &str, &str); 4] = [
    ("index.html", "text/html; charset=utf-8", include_str!("../page/index.html")),
    ("questionnaire.css", "text/css; charset=utf-8", include_str!("../page/questionnaire.css")),
    ("files.js", "text/javascript; charset=utf-8", include_str!("../page/files.js")),
    ("questionnaire.js", "text/javascript; charset=utf-8", include_str!("../page/questionnaire.js")),
];

/// What the page knows of the study.
#[derive(Serialize)]
struct Known<'a> {
    study: &'a str,
    digest: &'a str,
    title: &'a str,
    prompt: &'a str,
    choices: &'a [String; 3],
    consent: &'a str,
    instructions: &'a str,
    loop_ms: u32,
    page_scale: u32,
    /// Whether a server deals forms and takes answers.
    server: bool,
    forms: &'a [FormEntry],
}

/// `forms.js`: a script and not JSON, since a page from a folder may load the one but not the other. With a server the page
/// is told no forms; it is dealt one. `digest` tells one version of the study from another.
pub fn forms_js(file: &FormFile, digest: &str, server: bool) -> String {
    let known = Known {
        study: &file.study,
        digest,
        title: &file.title,
        prompt: &file.prompt,
        choices: &file.choices,
        consent: &file.consent,
        instructions: &file.instructions,
        loop_ms: file.loop_ms,
        page_scale: file.page_scale,
        server,
        forms: if server { &[] } else { &file.forms },
    };
    let json = serde_json::to_string(&known).expect("names and numbers alone");
    format!("window.ISOSTUDY = {json};\n")
}
