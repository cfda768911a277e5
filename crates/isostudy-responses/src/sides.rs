//! How it is known on which side things stood.

/// Where the sides of answers come from.
///
/// The study's own table and the exports of survey tools have a cell for each question and no sides. Their cells are taken as
/// what was pressed, on the sides that the participant saw. Answers that were turned to the sides of a study file, as in
/// `tables/answers.csv`, are something else: nobody may have seen those sides, and such cells are never read as if somebody
/// had.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SidesSource {
    /// The file says what was on the left and what on the right.
    InFile,
    /// The file has the code name of each pair that was shown, and the study says what that shows on which side.
    FromCodeNames,
    /// The file has the number of each participant's form, and the study says what that form shows on which side.
    FromForms,
    /// The file has none of these, and everybody was shown the sides that the study lists.
    AsListed,
    /// There were none: surfaces were shown one at a time, or several at once.
    NoSides,
    /// Nobody knows.
    #[default]
    Unknown,
}

impl SidesSource {
    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::InFile => "in the file",
            Self::FromCodeNames => "from code names",
            Self::FromForms => "from form numbers",
            Self::AsListed => "as listed",
            Self::NoSides => "none",
            Self::Unknown => "unknown",
        }
    }

    /// What a report says of it.
    pub fn sentence(self) -> &'static str {
        match self {
            Self::InFile => "The file says which item was on which side.",
            Self::FromCodeNames => {
                "The file does not name sides. They are those of the code names in its column \u{201c}stimulus\u{201d}, as the study deals \
                 them; each answer is taken as what was pressed."
            }
            Self::FromForms => {
                "The file does not name sides. They are those of the forms in its column \u{201c}form\u{201d}, as the study deals them; each \
                 answer is taken as what was pressed."
            }
            Self::AsListed => {
                "The file does not name sides. They are taken as listed, because everybody was shown the listed sides."
            }
            Self::NoSides => {
                "Nobody compared a left side with a right one. Answers about two items follow from ratings, or from what was taken of several."
            }
            Self::Unknown => "The file does not say which item was on which side.",
        }
    }
}
