//! A study's page in each of its languages: shipped texts, and over them the study's own.

use super::FormFile;
use crate::config::ENDS;
use crate::texts::{DIRECTION, ENGLISH, OF_STUDY, Texts, english, shipped};
use serde::Serialize;
use std::collections::BTreeSet;

/// A language of a study's page with everything that the page says in it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Language {
    /// Its name as in `lang` of HTML.
    pub lang: String,
    /// Every text: a key without one in this language has the English one.
    pub texts: Texts,
}

impl Language {
    /// `ltr` or `rtl`.
    pub fn direction(&self) -> &str {
        &self.texts[DIRECTION]
    }
}

impl FormFile {
    /// What the study itself says in one of its languages.
    fn own_texts(&self, lang: &str) -> Texts {
        let mut own = self.texts.get(lang).cloned().unwrap_or_default();
        if self.languages.first().is_some_and(|first| first != lang) {
            return own;
        }
        // The keys of [study] and [forms] are in the first language.
        let mut add = |key: &str, text: &str| drop(own.insert(key.into(), text.into()));
        add("title", &self.title);
        add("prompt", &self.prompt);
        // A text that nobody wrote is the shipped one, in whatever language.
        for (key, text) in [("consent", &self.consent), ("instructions", &self.instructions)] {
            if *text != english()[self.way.instead(key)] {
                add(key, text);
            }
        }
        for (answer, text) in self.answers().iter().zip(&self.choices) {
            add(answer.text, text);
        }
        for (answer, text) in self.answers().iter().zip(self.choices_stacked.iter().flatten()) {
            add(answer.stacked, text);
        }
        for (key, text) in ENDS.into_iter().zip(self.ends.iter().flatten()) {
            add(key, text);
        }
        own
    }

    /// The languages of the page, the first one first.
    pub fn spoken(&self) -> Vec<Language> {
        self.languages
            .iter()
            .map(|lang| Language { lang: lang.clone(), texts: self.spoken_in(lang) })
            .collect()
    }

    fn spoken_in(&self, lang: &str) -> Texts {
        let own = self.own_texts(lang);
        let mut texts = english().clone();
        for key in OF_STUDY {
            // Better the words of another language than none: that this one lacks them is a fault of its own.
            texts.insert(key.into(), if key == "title" { &self.title } else { &self.prompt }.clone());
        }
        texts.extend(shipped(lang).cloned().unwrap_or_default());
        // What a study says of its own way stands where pairs have another text.
        for (key, of_way) in self.way.texts() {
            let text = own.get(*of_way).unwrap_or(&texts[*of_way]).clone();
            texts.insert((*key).into(), text);
        }
        for answer in self.answers().iter().filter(|of| of.text != of.stacked) {
            // Words of a study's own stay where the surfaces stand.
            let is_own = own.get(answer.text).is_some_and(|text| *text != texts[answer.text]);
            if is_own && !own.contains_key(answer.stacked) {
                texts.insert(answer.stacked.into(), own[answer.text].clone());
            }
        }
        texts.extend(own);
        texts.retain(|key, _| !self.way.does_without(key));
        texts
    }

    /// Keys without a text, by language, the languages in the study's order. Whatever the study itself says in its first language it
    /// has to say in the others.
    pub fn missing_texts(&self) -> Vec<(&str, Vec<String>)> {
        let first = self.languages.first().map_or(ENGLISH, String::as_str);
        let usual = shipped(first);
        let said = self.own_texts(first);
        let is_usual = |key: &str, text: &String| usual.and_then(|usual| usual.get(key)) == Some(text);
        let needed = |lang: &str| {
            let replaced = said.iter().filter(move |(key, text)| lang != first && !is_usual(key, text));
            let of_study = replaced.map(|(key, _)| key.as_str()).collect::<Vec<_>>();
            let (own, usual) = (self.own_texts(lang), shipped(lang));
            let all = english().keys().map(String::as_str).chain(OF_STUDY);
            let all: BTreeSet<&str> = all.chain(of_study.iter().copied()).collect();
            let lacks = |key: &&str| {
                !own.contains_key(*key)
                    && (of_study.contains(key) || usual.is_none_or(|usual| !usual.contains_key(*key)))
            };
            let used = all.into_iter().filter(|key| !self.way.does_without(key));
            used.filter(lacks).map(str::to_owned).collect::<Vec<_>>()
        };
        let languages = self.languages.iter().map(|lang| (lang.as_str(), needed(lang)));
        languages.filter(|(_, keys)| !keys.is_empty()).collect()
    }
}

#[cfg(test)]
mod tests;
