//! How people are asked.

use serde::{Deserialize, Serialize};

/// How people are asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// Left, no preference or right.
    #[default]
    Pairs,
    /// Left or right.
    Forced,
    /// In five steps, from much better on the left to much better on the right.
    Graded,
    /// One surface at a time, on a scale.
    Ratings,
    /// The best of three.
    #[serde(rename = "best-of-3")]
    BestOfThree,
    /// The best of four.
    #[serde(rename = "best-of-4")]
    BestOfFour,
}

/// Most steps of a scale.
pub(crate) const MOST_STEPS: u32 = 9;

/// One answer that people can give: its code in files, and the keys of its text on the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AnswerKind {
    /// What stands in files.
    pub code: &'static str,
    /// The key of its text where the surfaces are beside each other; empty of a step of a scale, which is a number.
    pub text: &'static str,
    /// The key of its text where one is over the other.
    pub stacked: &'static str,
}

const fn kind(code: &'static str, text: &'static str, stacked: &'static str) -> AnswerKind {
    AnswerKind { code, text, stacked }
}

const fn one(code: &'static str, text: &'static str) -> AnswerKind {
    kind(code, text, text)
}

/// The code of no preference, and of none of several.
const NONE: &str = "NP";

const LEFT: AnswerKind = kind("L", "left", "upper");
const RIGHT: AnswerKind = kind("R", "right", "lower");
const PAIRS: [AnswerKind; 3] = [LEFT, kind(NONE, "none", "none_stacked"), RIGHT];
const FORCED: [AnswerKind; 2] = [LEFT, RIGHT];
const GRADED: [AnswerKind; 5] = [
    kind("LL", "left_much", "upper_much"),
    kind("L", "left_better", "upper_better"),
    kind(NONE, "equal", "equal_stacked"),
    kind("R", "right_better", "lower_better"),
    kind("RR", "right_much", "lower_much"),
];
const RATINGS: [AnswerKind; MOST_STEPS as usize] = [
    one("1", ""),
    one("2", ""),
    one("3", ""),
    one("4", ""),
    one("5", ""),
    one("6", ""),
    one("7", ""),
    one("8", ""),
    one("9", ""),
];
const NONE_OF_THEM: AnswerKind = one(NONE, "none_of_them");
const BEST_OF_THREE: [AnswerKind; 4] =
    [one("1", "first"), one("2", "second"), one("3", "third"), NONE_OF_THEM];
const BEST_OF_FOUR: [AnswerKind; 5] =
    [one("1", "first"), one("2", "second"), one("3", "third"), one("4", "fourth"), NONE_OF_THEM];

/// Texts of the page that speak of pairs, and what stands in their place where people are asked otherwise.
const FORCED_TEXTS: [(&str, &str); 1] = [("how_keys", "how_keys_forced")];
const GRADED_TEXTS: [(&str, &str); 1] = [("how_keys", "how_keys_graded")];
const RATINGS_TEXTS: [(&str, &str); 6] = [
    ("how_keys", "how_keys_ratings"),
    ("instructions", "instructions_ratings"),
    ("consent", "consent_any"),
    ("screen_note", "screen_note_any"),
    ("wait_loading", "wait_loading_any"),
    ("load_again", "load_again_any"),
];
const BEST_TEXTS: [(&str, &str); 6] = [
    ("how_keys", "how_keys_best"),
    ("instructions", "instructions_best"),
    ("consent", "consent_any"),
    ("screen_note", "screen_note_any"),
    ("wait_loading", "wait_loading_any"),
    ("load_again", "load_again_any"),
];

/// What the ends of a scale mean.
pub(crate) const ENDS: [&str; 2] = ["scale_low", "scale_high"];
/// What surfaces are called that are not left and right.
const NUMBERED: [&str; 3] = ["number_turning", "number_stopped", "number_surface"];

impl Way {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Pairs, Self::Forced, Self::Graded, Self::Ratings, Self::BestOfThree, Self::BestOfFour];

    /// The name in files.
    pub fn code(self) -> &'static str {
        match self {
            Self::Pairs => "pairs",
            Self::Forced => "forced",
            Self::Graded => "graded",
            Self::Ratings => "ratings",
            Self::BestOfThree => "best-of-3",
            Self::BestOfFour => "best-of-4",
        }
    }

    /// How many surfaces are shown at once.
    pub fn shown(self) -> usize {
        match self {
            Self::Ratings => 1,
            Self::Pairs | Self::Forced | Self::Graded => 2,
            Self::BestOfThree => 3,
            Self::BestOfFour => 4,
        }
    }

    /// Whether people compare two surfaces, left and right.
    pub fn is_of_pairs(self) -> bool {
        self.shown() == 2
    }

    /// Whether people take the best of several.
    pub fn is_best(self) -> bool {
        self.shown() > 2
    }

    /// Every answer that a study may take, left to right: a study's scale may have fewer steps, and it may not take none of several.
    pub fn answers(self) -> &'static [AnswerKind] {
        match self {
            Self::Pairs => &PAIRS,
            Self::Forced => &FORCED,
            Self::Graded => &GRADED,
            Self::Ratings => &RATINGS,
            Self::BestOfThree => &BEST_OF_THREE,
            Self::BestOfFour => &BEST_OF_FOUR,
        }
    }

    /// The answers of a study with a scale of so many steps, which takes none of several or not.
    pub fn answers_of(self, steps: u32, none: bool) -> Vec<AnswerKind> {
        let all = self.answers().iter().copied();
        match self {
            Self::Ratings => all.take(steps as usize).collect(),
            _ if self.is_best() => all.filter(|of| none || of.code != NONE).collect(),
            _ => all.collect(),
        }
    }

    /// Whether people may have no preference between two.
    pub fn has_ties(self) -> bool {
        self != Self::Forced
    }

    pub(crate) fn is_pairs(&self) -> bool {
        *self == Self::Pairs
    }

    /// Texts of the page, and those that stand in their place.
    pub fn texts(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Pairs => &[],
            Self::Forced => &FORCED_TEXTS,
            Self::Graded => &GRADED_TEXTS,
            Self::Ratings => &RATINGS_TEXTS,
            Self::BestOfThree | Self::BestOfFour => &BEST_TEXTS,
        }
    }

    /// The key of the text that stands in the place of another, or that one itself.
    pub(crate) fn instead(self, key: &str) -> &str {
        self.texts().iter().find(|(of, _)| *of == key).map_or(key, |(_, own)| own)
    }

    /// The keys that one way has and another has not.
    fn own_keys(self) -> impl Iterator<Item = &'static str> {
        let answers = self.answers().iter().flat_map(|of| [of.text, of.stacked]);
        let ends = ENDS.into_iter().filter(move |_| self == Self::Ratings);
        // Two surfaces may stand one over the other.
        let sides = ["upper", "lower"].into_iter().filter(move |_| self.is_of_pairs());
        let numbered = NUMBERED.into_iter().filter(move |_| !self.is_of_pairs());
        answers.chain(self.texts().iter().map(|(_, own)| *own)).chain(ends).chain(sides).chain(numbered)
    }

    /// Whether a page of this way has no use for the text of a key, which is of another way alone.
    pub(crate) fn does_without(self, key: &str) -> bool {
        Self::ALL.into_iter().flat_map(Self::own_keys).any(|of| of == key)
            && self.own_keys().all(|of| of != key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_way_has_codes_and_texts_of_its_own() {
        for way in Way::ALL {
            let named = serde_json::to_string(&way).unwrap();
            assert_eq!(named, format!("\"{}\"", way.code()));
            for of in way.answers() {
                assert!(!way.does_without(of.text) && !way.does_without(of.stacked), "{of:?}");
            }
            for (key, own) in way.texts() {
                assert!(!way.does_without(own) && way.instead(key) == *own);
            }
            assert!(!way.does_without("go_on") && way.instead("go_on") == "go_on");
        }
        assert!(Way::Forced.does_without("none") && Way::Pairs.does_without("left_much"));
        assert!(Way::Graded.does_without("left") && Way::Ratings.does_without("how_keys_graded"));
    }

    #[test]
    fn a_study_takes_as_many_answers_as_it_says() {
        let codes = |way: Way, steps, none| -> Vec<&str> {
            way.answers_of(steps, none).iter().map(|of| of.code).collect()
        };
        assert_eq!(codes(Way::Pairs, 7, false), ["L", "NP", "R"]);
        assert_eq!(codes(Way::Forced, 7, true), ["L", "R"]);
        assert_eq!(codes(Way::Ratings, 3, false), ["1", "2", "3"]);
        assert_eq!(codes(Way::BestOfThree, 7, false), ["1", "2", "3"]);
        assert_eq!(codes(Way::BestOfFour, 7, true), ["1", "2", "3", "4", "NP"]);
    }
}
