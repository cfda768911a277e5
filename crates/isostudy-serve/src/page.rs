//! The questionnaire's page.

use crate::completions::Completions;
use isostudy_design::config::{Panel, Way};
use isostudy_design::forms::{AboutEntry, FormEntry, FormFile, Language};
use serde::Serialize;

/// The files of the page that are the same for all studies: name, MIME type, content.
pub const FILES: [(&str, &str, &str); 10] = [
    ("questionnaire.css", "text/css; charset=utf-8", include_str!("../page/questionnaire.css")),
    ("texts.js", "text/javascript; charset=utf-8", include_str!("../page/texts.js")),
    ("files.js", "text/javascript; charset=utf-8", include_str!("../page/files.js")),
    ("loading.js", "text/javascript; charset=utf-8", include_str!("../page/loading.js")),
    ("pair.js", "text/javascript; charset=utf-8", include_str!("../page/pair.js")),
    ("about.js", "text/javascript; charset=utf-8", include_str!("../page/about.js")),
    ("rights.js", "text/javascript; charset=utf-8", include_str!("../page/rights.js")),
    ("kiosk.js", "text/javascript; charset=utf-8", include_str!("../page/kiosk.js")),
    ("trial.js", "text/javascript; charset=utf-8", include_str!("../page/trial.js")),
    ("questionnaire.js", "text/javascript; charset=utf-8", include_str!("../page/questionnaire.js")),
];

/// The one file that is not: `index.html`, in the study's first language; without scripts it speaks all of them.
pub fn index(file: &FormFile) -> String {
    let spoken = file.spoken();
    let escape = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    let line = |one: &Language| {
        let (lang, direction) = (&one.lang, one.direction());
        format!("<p lang=\"{lang}\" dir=\"{direction}\">{}</p>", escape(&one.texts["no_script"]))
    };
    let no_script: String = spoken.iter().map(line).collect();
    let Some(first) = spoken.first() else { return String::new() };
    // The title last: nothing in it is filled in.
    include_str!("../page/index.html")
        .replace("{lang}", &first.lang)
        .replace("{direction}", first.direction())
        .replace("{no_script}", &no_script)
        .replace("{title}", &escape(&first.texts["title"]))
}

/// How a pair is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum MediaFormat {
    /// H.264.
    Mp4,
    /// VP9.
    WebM,
    /// The animation, which every browser shows.
    Gif,
    /// A still picture.
    Png,
    /// Both surfaces as models, in one binary glTF: `model` to the page.
    Model,
}

impl MediaFormat {
    /// The ending of the files' names, without a dot.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Mp4 => "mp4",
            Self::WebM => "webm",
            Self::Gif => "gif",
            Self::Png => "png",
            Self::Model => "glb",
        }
    }

    /// The MIME type.
    pub fn mime(self) -> &'static str {
        match self {
            Self::Mp4 => "video/mp4",
            Self::WebM => "video/webm",
            Self::Gif => "image/gif",
            Self::Png => "image/png",
            Self::Model => "model/gltf-binary",
        }
    }

    /// What a browser is asked whether it plays; nobody asks about animations, and about models otherwise.
    fn asked(self) -> Option<&'static str> {
        match self {
            Self::Mp4 => Some("video/mp4; codecs=\"avc1.640028\""),
            Self::WebM => Some("video/webm; codecs=\"vp9\""),
            Self::Gif | Self::Png | Self::Model => None,
        }
    }
}

/// Light and colours of models, as of the animations: see the study's `[shading]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelShading {
    /// The direction in which light travels; not normalised.
    pub light: [f64; 3],
    /// Whether the light goes with the camera, and else stands still.
    pub follows: bool,
    /// Share of the light that comes from all sides.
    pub ambient: f64,
    /// Colour towards the light.
    pub lit: [f64; 3],
    /// Colour at the terminator.
    pub shade: [f64; 3],
    /// Colour of the highlight.
    pub highlight: [f64; 3],
    /// Colour where there is no surface.
    pub background: [f64; 3],
    /// Colour of triangle edges over a surface.
    pub wire: [f64; 3],
    /// Width of triangle edges as a share of the height of a surface.
    pub wire_width: f64,
}

/// A file that the page needs to draw models.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LibraryFile {
    /// Its name beside the page.
    pub name: &'static str,
    /// The MIME type.
    pub mime: &'static str,
    /// What is in it.
    pub content: String,
}

/// The page's own files that draw and turn models; they import `three.module.min.js` beside them.
pub fn model_scripts() -> [LibraryFile; 2] {
    let of = |name, content: &str| LibraryFile {
        name,
        mime: "text/javascript; charset=utf-8",
        content: content.to_owned(),
    };
    [of("model.js", include_str!("../page/model.js")), of("turning.js", include_str!("../page/turning.js"))]
}

/// In what files the pairs are, and how they are shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Media {
    /// Every kind that there is a file of for every pair, with the bytes of each and its frames a turn; the page takes the first
    /// that the browser plays.
    pub kinds: Vec<(MediaFormat, u64, u32)>,
    /// Width and height of each surface as it was made, in pixels: shown no larger than that, times `page_scale`.
    pub surface: [u32; 2],
    /// How models are drawn, where there are any.
    pub shading: Option<ModelShading>,
}

impl Media {
    /// Bytes that a participant loads, by kind: the longest form's pairs, each once.
    pub fn loaded(&self, file: &FormFile) -> Vec<(MediaFormat, u64)> {
        let pairs = file.forms.iter().map(|form| form.training.len() + form.questions.len()).max();
        self.kinds.iter().map(|&(kind, bytes, _)| (kind, bytes * pairs.unwrap_or(0) as u64)).collect()
    }
}

/// What a page of a server knows besides.
#[derive(Debug, Clone, Copy)]
pub struct Served<'a> {
    /// Who sends people.
    pub panel: Panel,
    /// What people get who leave; what those get who have finished or were screened out they are told then.
    pub completions: &'a Completions,
}

#[derive(Serialize)]
struct KnownKind {
    kind: MediaFormat,
    bytes: u64,
    frames: u32,
    #[serde(rename = "type", skip_serializing_if = "Option::is_none")]
    asked: Option<&'static str>,
}

fn is_pairs(way: &Way) -> bool {
    *way == Way::Pairs
}

/// What the page knows of the study.
#[derive(Serialize)]
struct Known<'a> {
    study: &'a str,
    digest: &'a str,
    #[serde(skip_serializing_if = "is_pairs")]
    way: Way,
    /// Steps of a scale.
    #[serde(skip_serializing_if = "Option::is_none")]
    steps: Option<u32>,
    /// Whether none of several may be taken.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    none: bool,
    languages: Vec<Language>,
    #[serde(skip_serializing_if = "Option::is_none")]
    min_surface_px: Option<u32>,
    loop_ms: u32,
    page_scale: u32,
    surface: [u32; 2],
    media: Vec<KnownKind>,
    /// How models are drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    shading: Option<&'a ModelShading>,
    /// Pairs that every form shows first: fetched before anybody has a form.
    first: &'a [String],
    about: &'a [AboutEntry],
    #[serde(skip_serializing_if = "Option::is_none")]
    contact: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ethics: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    least_age: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    retention_days: Option<u32>,
    /// Whether the last answer may be changed.
    revises: bool,
    /// Whether a server deals forms and takes answers.
    server: bool,
    /// What the address calls the person, the study and the session of a panel.
    panel: [Option<&'static str>; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    completion_withdrawn: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    completion_full: Option<&'a str>,
    forms: &'a [FormEntry],
}

/// `forms.js`: a script and not JSON, since a page from a folder may load the one but not the other. With a server the page
/// is told no forms; it is dealt one. `digest` tells one version of the study from another.
pub fn forms_js(file: &FormFile, digest: &str, media: &Media, served: Option<Served<'_>>) -> String {
    let known_kind = |&(kind, bytes, frames): &(MediaFormat, u64, u32)| KnownKind {
        kind,
        bytes,
        frames,
        asked: kind.asked(),
    };
    // Practice is the same in every form, and tells nothing of who is dealt which.
    let first = file.forms.first().map_or(&[][..], |form| &form.training);
    let known = Known {
        study: &file.study,
        digest,
        way: file.way,
        steps: (file.way == Way::Ratings).then_some(file.steps),
        none: file.way.is_best() && file.none,
        languages: file.spoken(),
        min_surface_px: file.min_surface_px,
        loop_ms: file.loop_ms,
        page_scale: file.page_scale,
        surface: media.surface,
        media: media.kinds.iter().map(known_kind).collect(),
        shading: media.shading.as_ref(),
        first: if file.forms.iter().all(|form| form.training == first) { first } else { &[] },
        about: &file.about,
        contact: file.contact.as_deref(),
        ethics: file.ethics.as_deref(),
        least_age: file.least_age,
        retention_days: file.retention_days,
        revises: file.go_back,
        server: served.is_some(),
        panel: served.map_or([None; 3], |served| served.panel.names()),
        completion_withdrawn: served.and_then(|served| served.completions.withdrawn.as_deref()),
        completion_full: served.and_then(|served| served.completions.full.as_deref()),
        forms: if served.is_some() { &[] } else { &file.forms },
    };
    let json = serde_json::to_string(&known).expect("names and numbers alone");
    format!("window.ISOSTUDY = {json};\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_design::texts::shipped;

    fn scripts() -> String {
        FILES.iter().map(|(_, _, content)| *content).collect()
    }

    /// Words that a script asks for in this way: `text('go_on'` gives `go_on`.
    fn asked<'a>(script: &'a str, how: &str) -> Vec<&'a str> {
        script.split(how).skip(1).filter_map(|rest| rest.split_once('\'').map(|(key, _)| key)).collect()
    }

    #[test]
    fn the_scripts_ask_for_texts_that_there_are_and_for_all_of_them() {
        let (english, scripts) = (shipped("en").unwrap(), scripts());
        // `getContext('2d')` is no text.
        let calls = ["(", " ", "[", "!", "`", "{"].map(|before| format!("{before}text('"));
        let keys: Vec<&str> = calls.iter().flat_map(|call| asked(&scripts, call)).collect();
        assert!(keys.len() > 40, "{keys:?}");
        for key in keys {
            assert!(english.contains_key(key) || ["title", "prompt"].contains(&key), "{key}");
        }
        let of_the_file = ["language", "direction", "no_script"];
        // Questions about the person name their words themselves.
        let of_questions = ["colour_vision", "screen_size", "comment"];
        // Those that stand in the place of others.
        let replaced: Vec<&str> =
            Way::ALL.into_iter().flat_map(Way::texts).map(|(_, instead)| *instead).collect();
        let is_named = |key: &&String| {
            replaced.contains(&key.as_str())
                || of_the_file.contains(&key.as_str())
                || of_questions.iter().any(|start| key.starts_with(start))
        };
        for key in english.keys().filter(|key| !is_named(key)) {
            // Both sides of a pair are asked for by one line.
            let end = ["left_", "right_"].iter().find_map(|side| key.strip_prefix(side));
            let is_asked = scripts.contains(&format!("'{key}'"))
                || end.is_some_and(|end| scripts.contains(&format!("${{side}}_{end}")));
            assert!(is_asked, "nothing says {key}");
        }
    }

    /// What a participant could read stands in the texts: a script has no sentence of its own.
    #[test]
    fn the_scripts_say_nothing_themselves() {
        let (scripts, english) = (scripts(), shipped("en").unwrap());
        for (key, text) in english.iter().filter(|(_, text)| text.contains(' ')) {
            assert!(!scripts.contains(text.as_str()), "{key}");
        }
        for line in
            scripts.lines().filter(|line| !line.trim_start().starts_with("//") && !line.contains("* "))
        {
            for quoted in asked(line, " '").into_iter().chain(asked(line, "('")) {
                let is_sentence =
                    quoted.split(' ').count() > 2 && quoted.starts_with(|c: char| c.is_uppercase());
                assert!(!is_sentence, "{quoted}");
            }
        }
    }

    #[test]
    fn the_first_file_is_in_the_first_language_and_no_text_is_mark_up() {
        let file = FormFile {
            title: "{no_script} <b>&\"".into(),
            languages: vec!["ar".into(), "de".into()],
            ..crate::export::tests::empty_file()
        };
        let page = index(&file);
        assert!(page.contains("<html lang=\"ar\" dir=\"rtl\">"), "{page}");
        assert!(page.contains("<title>{no_script} &lt;b>&amp;&quot;</title>"), "{page}");
        for lang in ["ar", "de"] {
            let said = &shipped(lang).unwrap()["no_script"];
            assert!(
                page.contains(&format!(">{said}</p>")) && page.contains(&format!("<p lang=\"{lang}\"")),
                "{lang}"
            );
        }
        assert!(!page.contains("needs JavaScript"), "{page}");
    }
}
