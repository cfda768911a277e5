//! What the participant's page says, by language and key.
//!
//! Six languages are shipped, a file each in `texts/`; their keys are those of `texts/en.toml`. A study adds what only it knows, such
//! as its prompt, and may replace any text, or bring a language of its own.

use std::collections::BTreeMap;
use std::sync::LazyLock;

/// The texts of one language by their keys.
pub type Texts = BTreeMap<String, String>;

/// Texts that no file can ship: a study writes them in each of its languages.
pub const OF_STUDY: [&str; 2] = ["title", "prompt"];

/// The key that says where lines of a language begin.
pub(crate) const DIRECTION: &str = "direction";

/// The language by whose keys every other is measured.
pub(crate) const ENGLISH: &str = "en";

static SHIPPED: LazyLock<BTreeMap<&str, Texts>> = LazyLock::new(|| {
    let files = [
        (ENGLISH, include_str!("texts/en.toml")),
        ("de", include_str!("texts/de.toml")),
        ("fr", include_str!("texts/fr.toml")),
        ("es", include_str!("texts/es.toml")),
        ("ja", include_str!("texts/ja.toml")),
        ("ar", include_str!("texts/ar.toml")),
    ];
    files.map(|(lang, text)| (lang, toml::from_str(text).expect("shipped texts are TOML"))).into()
});

/// The shipped texts of a language, named as in `lang` of HTML, such as `de`; `None` where none are shipped.
pub fn shipped(lang: &str) -> Option<&'static Texts> {
    SHIPPED.get(lang)
}

/// The languages that are shipped, in the order of their names.
pub fn shipped_languages() -> impl Iterator<Item = &'static str> {
    SHIPPED.keys().copied()
}

/// The shipped English texts, which have every key but those of [`OF_STUDY`].
pub(crate) fn english() -> &'static Texts {
    &SHIPPED[ENGLISH]
}

/// The names between braces, which the page fills in.
pub(crate) fn blanks(text: &str) -> Vec<&str> {
    text.split('{').skip(1).filter_map(|rest| rest.split_once('}').map(|(name, _)| name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_language_says_what_english_says_and_fills_in_the_same() {
        for lang in shipped_languages() {
            let texts = shipped(lang).unwrap();
            let keys = |texts: &Texts| texts.keys().cloned().collect::<Vec<_>>();
            assert_eq!(keys(texts), keys(english()), "{lang}");
            for (key, text) in texts {
                let sorted = |text| {
                    let mut blanks = blanks(text);
                    blanks.sort_unstable();
                    blanks
                };
                assert_eq!(sorted(text), sorted(&english()[key]), "{lang}: {key}");
                assert!(!text.is_empty() && text.trim() == text, "{lang}: {key}");
                // A text that was copied and never translated.
                assert!(lang == "en" || key == DIRECTION || *text != english()[key], "{lang}: {key}");
            }
            assert_eq!(texts[DIRECTION], if lang == "ar" { "rtl" } else { "ltr" }, "{lang}");
            let [left, none, right] = ["left", "none", "right"].map(|key| &texts[key]);
            assert!(left != none && none != right && left != right, "{lang}");
        }
        assert_eq!(shipped_languages().count(), 6);
    }
}
