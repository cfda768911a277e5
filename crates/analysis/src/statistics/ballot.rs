//! One answer, freed of objects, files and pictures: who compared which two items, and how it came out.

/// How a comparison came out, seen from the left item.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Outcome {
    /// The left item was chosen.
    Left,
    /// No preference.
    Tie,
    /// The right item was chosen.
    Right,
}

impl Outcome {
    /// The three outcomes, left to right.
    pub const ALL: [Self; 3] = [Self::Left, Self::Tie, Self::Right];

    /// +1 for left, 0 for a tie, -1 for right.
    pub fn sign(self) -> i64 {
        match self {
            Self::Left => 1,
            Self::Tie => 0,
            Self::Right => -1,
        }
    }

    /// Place in [`Outcome::ALL`].
    pub fn index(self) -> usize {
        match self {
            Self::Left => 0,
            Self::Tie => 1,
            Self::Right => 2,
        }
    }

    /// The same answer with the sides swapped.
    pub fn swapped(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Tie => Self::Tie,
            Self::Right => Self::Left,
        }
    }
}

/// One answer of one participant. A question that was not answered has no ballot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Ballot {
    /// The participant, from 0.
    pub participant: usize,
    /// The question, from 0.
    pub question: usize,
    /// The item on the left, from 0.
    pub left: usize,
    /// The item on the right, from 0.
    pub right: usize,
    /// What was chosen.
    pub outcome: Outcome,
}
