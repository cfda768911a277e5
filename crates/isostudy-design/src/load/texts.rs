//! A study's own texts of the page, read and checked.

use crate::check::{Checker, ConfigError};
use crate::config::FormsSection;
use crate::forms::about_texts;
use crate::read::parse_toml;
use crate::texts::{DIRECTION, OF_STUDY, Texts, blanks, english};
use crate::wording::did_you_mean;
use std::collections::BTreeMap;

/// A study's own texts: those of its files, and over them those of `[forms.texts]`.
///
/// # Errors
/// The first language or key that the page does not have, the first file that is not there, and the first text that cannot be shown.
pub(super) fn own(c: &Checker<'_>, forms: &FormsSection) -> Result<BTreeMap<String, Texts>, ConfigError> {
    check_languages(c, forms)?;
    let mut own: BTreeMap<String, Texts> = BTreeMap::new();
    for (lang, written) in &forms.texts_files {
        let key = format!("forms.texts_files.{lang}");
        listed(c, forms, &key, lang)?;
        let path = c.existing(&key, written)?;
        let texts: Texts = parse_toml(&crate::read::text(&path)?, &path)?;
        // Errors name the file in which the text stands.
        check_texts(&Checker { file: &path }, forms, lang, &texts, "")?;
        own.insert(lang.clone(), texts);
    }
    for (lang, texts) in &forms.texts {
        let key = format!("forms.texts.{lang}");
        listed(c, forms, &key, lang)?;
        check_texts(c, forms, lang, texts, &format!("{key}."))?;
        own.entry(lang.clone()).or_default().extend(texts.clone());
    }
    // What the study asks about people is in its first language.
    let first = own.entry(forms.languages[0].clone()).or_default();
    forms.about.iter().for_each(|about| first.extend(about_texts(about)));
    own.retain(|_, texts| !texts.is_empty());
    Ok(own)
}

fn check_languages(c: &Checker<'_>, forms: &FormsSection) -> Result<(), ConfigError> {
    if forms.languages.is_empty() {
        return c.refuse("forms.languages", "[]", "must list at least one");
    }
    c.distinct(|i| format!("forms.languages[{i}]"), &forms.languages)?;
    let is_name = |lang: &String| {
        let mut parts = lang.split('-');
        let first = parts.next().unwrap_or_default();
        let plain =
            |part: &str| (2..=8).contains(&part.len()) && part.bytes().all(|b| b.is_ascii_alphanumeric());
        (2..=3).contains(&first.len()) && first.bytes().all(|b| b.is_ascii_lowercase()) && parts.all(plain)
    };
    match forms.languages.iter().position(|lang| !is_name(lang)) {
        None => Ok(()),
        Some(i) => {
            let limit = "must be a language as in `lang` of HTML, such as de or pt-BR";
            c.refuse(format!("forms.languages[{i}]"), &forms.languages[i], limit)
        }
    }
}

/// Whether texts are of a language that the study lists.
fn listed(c: &Checker<'_>, forms: &FormsSection, key: &str, lang: &String) -> Result<(), ConfigError> {
    if forms.languages.contains(lang) {
        return Ok(());
    }
    let known = forms.languages.join(", ");
    c.refuse(key, "{...}", format!("is not in forms.languages, which has: {known}"))
}

fn check_texts(
    c: &Checker<'_>,
    forms: &FormsSection,
    lang: &str,
    texts: &Texts,
    before: &str,
) -> Result<(), ConfigError> {
    let about: Texts = forms.about.iter().flat_map(about_texts).collect();
    let of_section = |key: &str| match key {
        "title" => Some("study.title"),
        "prompt" => Some("forms.prompt"),
        key if forms.way.answers().iter().any(|of| of.text == key) => Some("forms.choices"),
        key if about.contains_key(key) => Some("forms.about"),
        _ => None,
    };
    for (key, text) in texts {
        let place = format!("{before}{key}");
        let known = || english().keys().chain(about.keys()).map(String::as_str).chain(OF_STUDY);
        if known().all(|other| other != key) {
            let meant = did_you_mean(key, known());
            return c.refuse(place, short(text), format!("is no text of the page{meant}"));
        }
        // A file may be a whole language, and serve other studies too.
        let is_twice = forms.languages[0] == lang && !before.is_empty();
        if let Some(same) = of_section(key).filter(|_| is_twice) {
            let limit = format!("{same} has the text of the first language, {lang}");
            return c.refuse(place, short(text), limit);
        }
        c.text(&place, text, "must be a text")?;
        if key == DIRECTION && !["ltr", "rtl"].contains(&text.as_str()) {
            return c.refuse(place, text, "must be ltr or rtl");
        }
        let known = english().get(key).map_or_else(Vec::new, |text| blanks(text));
        if let Some(blank) = blanks(text).into_iter().find(|blank| !known.contains(blank)) {
            let limit = match &known[..] {
                [] => format!("has {{{blank}}}, and the page fills in nothing here"),
                known => format!("has {{{blank}}}, and the page fills in {{{}}} alone", known.join("}, {")),
            };
            return c.refuse(place, short(text), limit);
        }
    }
    Ok(())
}

/// The beginning of a text, for an error.
fn short(text: &str) -> String {
    const SHOWN: usize = 40;
    let begin: String = text.chars().take(SHOWN).collect();
    if begin.len() < text.len() { format!("\"{begin}...\"") } else { format!("\"{text}\"") }
}

#[cfg(test)]
mod tests {
    use crate::ConfigError;
    use crate::Study;
    use crate::load::tests::{refused, syntax};
    use std::path::Path;

    /// The balanced study with more in its forms, from a folder in which `nl.toml` is.
    fn with(more: &str, dutch: &str) -> Result<Study, ConfigError> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("nl.toml"), dutch).unwrap();
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs");
        let text = std::fs::read_to_string(root.join("balanced.toml")).unwrap();
        let text = text.replace("\"cpu/", &format!("\"{}/cpu/", root.display())).replacen(
            "[forms]",
            &format!("[forms]\n{more}"),
            1,
        );
        Study::parse(&text, &folder.path().join("study.toml"))
    }

    #[test]
    fn files_come_first_and_the_study_file_over_them() {
        let more = "languages = [\"nl\", \"de\"]\ntexts_files = { nl = \"nl.toml\" }\n\
                    texts = { nl = { go_on = \"Verder\" }, de = { title = \"Titel\" } }";
        let study =
            with(more, "go_on = \"Door\"\npractice = \"Oefening {number}\"\nleft = \"Links\"").unwrap();
        let texts =
            |lang: &str| study.texts[lang].iter().map(|(k, v)| (k.as_str(), v.as_str())).collect::<Vec<_>>();
        assert_eq!(texts("nl"), [("go_on", "Verder"), ("left", "Links"), ("practice", "Oefening {number}")]);
        assert_eq!(texts("de"), [("title", "Titel")]);
    }

    #[test]
    fn what_the_page_cannot_say_is_refused_where_it_stands() {
        for (more, told) in [
            ("languages = []", "forms.languages = []"),
            ("languages = [\"de\", \"de\"]", "forms.languages[1] = de"),
            ("languages = [\"German\"]", "forms.languages[0] = German"),
            ("languages = [\"de\", \"d\\\"e\"]", "forms.languages[1] = d\"e"),
            ("texts = { de = { go_on = \"Weiter\" } }", "forms.texts.de = {...}"),
            ("texts_files = { de = \"nl.toml\" }", "forms.texts_files.de = {...}"),
            ("texts = { en = { go = \"Go\" } }", "forms.texts.en.go = \"Go\""),
            ("texts = { en = { prompt = \"Which?\" } }", "forms.texts.en.prompt = \"Which?\""),
            ("texts = { en = { go_on = \" \" } }", "forms.texts.en.go_on = \"\""),
            ("texts = { en = { direction = \"up\" } }", "forms.texts.en.direction = up"),
            ("texts = { en = { practice = \"{nmber}\" } }", "forms.texts.en.practice = \"{nmber}\""),
            ("texts = { en = { go_on = \"{number}\" } }", "forms.texts.en.go_on = \"{number}\""),
        ] {
            assert_eq!(refused(with(more, "")), told);
        }
        let of_file = |text: &str| with("languages = [\"nl\"]\ntexts_files = { nl = \"nl.toml\" }", text);
        match of_file("go_an = \"Door\"").unwrap_err() {
            ConfigError::Value { file, key, limit, .. } => {
                assert!(file.ends_with("nl.toml") && key == "go_an", "{} {key}", file.display());
                assert_eq!(limit, "is no text of the page; did you mean go_on?");
            }
            other => panic!("{other}"),
        }
        assert!(syntax(of_file("go_on = 3")).contains("go_on = 3"));
        let missing = with("languages = [\"nl\"]\ntexts_files = { nl = \"fr.toml\" }", "").unwrap_err();
        assert!(matches!(missing, ConfigError::MissingFile { ref key, .. } if key == "forms.texts_files.nl"));
    }
}
