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
///
/// Kept in 20 bytes, since there may be millions. Ordered by participant, question, items and outcome.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Ballot {
    participant: u32,
    question: u32,
    items: [u32; 2],
    outcome: Outcome,
}

impl Ballot {
    /// An answer to a question that shows `items` left and right; all are numbered from 0.
    ///
    /// # Panics
    /// If a number does not fit in 32 bits.
    pub fn new(participant: usize, question: usize, items: [usize; 2], outcome: Outcome) -> Self {
        let narrow = |number: usize| u32::try_from(number).expect("four thousand million are not answered");
        Self {
            participant: narrow(participant),
            question: narrow(question),
            items: items.map(narrow),
            outcome,
        }
    }

    /// The participant, from 0.
    pub fn participant(&self) -> usize {
        self.participant as usize
    }

    /// The question, from 0.
    pub fn question(&self) -> usize {
        self.question as usize
    }

    /// The item on the left, from 0.
    pub fn left(&self) -> usize {
        self.items[0] as usize
    }

    /// The item on the right, from 0.
    pub fn right(&self) -> usize {
        self.items[1] as usize
    }

    /// What was chosen.
    pub fn outcome(&self) -> Outcome {
        self.outcome
    }

    /// The same answer of another participant.
    pub fn with_participant(&self, participant: usize) -> Self {
        Self::new(participant, self.question(), [self.left(), self.right()], self.outcome)
    }

    /// The same with other items.
    pub fn with_items(&self, items: [usize; 2]) -> Self {
        Self::new(self.participant(), self.question(), items, self.outcome)
    }

    /// The same with another outcome.
    pub fn with_outcome(&self, outcome: Outcome) -> Self {
        Self { outcome, ..*self }
    }

    /// The same with items and outcome exchanged between the sides.
    pub fn turned(&self) -> Self {
        let [left, right] = self.items;
        Self { items: [right, left], outcome: self.outcome.swapped(), ..*self }
    }
}
