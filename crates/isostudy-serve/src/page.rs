//! The questionnaire's page.

use isostudy_design::forms::{FormEntry, FormFile};
use serde::Serialize;

/// The files of the page but `forms.js` and the stimuli: name, MIME type, content.
pub const FILES: [(&str, &str, &str); 7] = [
    ("index.html", "text/html; charset=utf-8", include_str!("../page/index.html")),
    ("questionnaire.css", "text/css; charset=utf-8", include_str!("../page/questionnaire.css")),
    ("files.js", "text/javascript; charset=utf-8", include_str!("../page/files.js")),
    ("loading.js", "text/javascript; charset=utf-8", include_str!("../page/loading.js")),
    ("pair.js", "text/javascript; charset=utf-8", include_str!("../page/pair.js")),
    ("trial.js", "text/javascript; charset=utf-8", include_str!("../page/trial.js")),
    ("questionnaire.js", "text/javascript; charset=utf-8", include_str!("../page/questionnaire.js")),
];

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
}

impl MediaFormat {
    /// The ending of the files' names, without a dot.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Mp4 => "mp4",
            Self::WebM => "webm",
            Self::Gif => "gif",
        }
    }

    /// The MIME type.
    pub fn mime(self) -> &'static str {
        match self {
            Self::Mp4 => "video/mp4",
            Self::WebM => "video/webm",
            Self::Gif => "image/gif",
        }
    }

    /// What a browser is asked whether it plays; nobody asks about animations.
    fn asked(self) -> Option<&'static str> {
        match self {
            Self::Mp4 => Some("video/mp4; codecs=\"avc1.640028\""),
            Self::WebM => Some("video/webm; codecs=\"vp9\""),
            Self::Gif => None,
        }
    }
}

/// In what files the pairs are, and how they are shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Media {
    /// Every kind that there is a file of for every pair, with the bytes of each and its frames a turn; the page takes the first
    /// that the browser plays.
    pub kinds: Vec<(MediaFormat, u64, u32)>,
    /// Width and height of each surface as it was made, in pixels: shown no larger than that, times `page_scale`.
    pub surface: [u32; 2],
}

impl Media {
    /// Bytes that a participant loads, by kind: the longest form's pairs, each once.
    pub fn loaded(&self, file: &FormFile) -> Vec<(MediaFormat, u64)> {
        let pairs = file.forms.iter().map(|form| form.training.len() + form.questions.len()).max();
        self.kinds.iter().map(|&(kind, bytes, _)| (kind, bytes * pairs.unwrap_or(0) as u64)).collect()
    }
}

#[derive(Serialize)]
struct KnownKind {
    kind: MediaFormat,
    bytes: u64,
    frames: u32,
    #[serde(rename = "type", skip_serializing_if = "Option::is_none")]
    asked: Option<&'static str>,
}

/// What the page knows of the study.
#[derive(Serialize)]
struct Known<'a> {
    study: &'a str,
    digest: &'a str,
    title: &'a str,
    prompt: &'a str,
    choices: &'a [String; 3],
    choices_stacked: [String; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    min_surface_px: Option<u32>,
    consent: &'a str,
    instructions: &'a str,
    loop_ms: u32,
    page_scale: u32,
    surface: [u32; 2],
    media: Vec<KnownKind>,
    /// Pairs that every form shows first: fetched before anybody has a form.
    first: &'a [String],
    /// Whether a server deals forms and takes answers.
    server: bool,
    forms: &'a [FormEntry],
}

/// `forms.js`: a script and not JSON, since a page from a folder may load the one but not the other. With a server the page
/// is told no forms; it is dealt one. `digest` tells one version of the study from another.
pub fn forms_js(file: &FormFile, digest: &str, media: &Media, server: bool) -> String {
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
        title: &file.title,
        prompt: &file.prompt,
        choices: &file.choices,
        choices_stacked: file.stacked_choices(),
        min_surface_px: file.min_surface_px,
        consent: &file.consent,
        instructions: &file.instructions,
        loop_ms: file.loop_ms,
        page_scale: file.page_scale,
        surface: media.surface,
        media: media.kinds.iter().map(known_kind).collect(),
        first: if file.forms.iter().all(|form| form.training == first) { first } else { &[] },
        server,
        forms: if server { &[] } else { &file.forms },
    };
    let json = serde_json::to_string(&known).expect("names and numbers alone");
    format!("window.ISOSTUDY = {json};\n")
}
