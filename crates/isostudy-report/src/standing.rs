//! What a statement is worth.

use isostudy_inference::conclusions::{Conclusion, Verdict, Why};

/// What a statement is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// It holds at the stated level.
    Holds,
    /// The opposite of what was stated is there.
    Fails,
    /// What is there is smaller than the declared margin.
    Equal,
    /// Neither a difference nor equality was shown.
    Open,
    /// No outcome of so few people could have shown anything.
    TooFew,
    /// The design does not allow an answer.
    NotAnswerable,
    /// A description, which no test judges.
    Noted,
}

impl Standing {
    /// That of a conclusion.
    pub fn of(conclusion: &Conclusion) -> Self {
        match conclusion.verdict {
            Verdict::Holds { .. } => Self::Holds,
            Verdict::Equal => Self::Equal,
            Verdict::Undecided | Verdict::NotJudged(Why::NobodyLeans) => Self::Open,
            Verdict::NotJudged(Why::TooFew) => Self::TooFew,
            Verdict::NotJudged(_) => Self::NotAnswerable,
            Verdict::Best { .. } => Self::Noted,
        }
    }

    /// In a word or two.
    pub fn label(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Fails => "does not hold",
            Self::Equal => "equal",
            Self::Open => "open",
            Self::TooFew => "too few",
            Self::NotAnswerable => "not answerable",
            Self::Noted => "noted",
        }
    }
}
