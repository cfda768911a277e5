//! One answer, freed of objects, files and pictures: who compared which two items, and how it came out.
//!
//! There are two orientations of an answer, and two types of a [`Ballot`], so that one cannot be taken for the other. A [`ShownBallot`]
//! speaks of the sides that the participant saw: `left`, `right`. A [`DeclaredBallot`] speaks of items: `first`, `second`,
//! in the order in which somebody names them, whichever side they stood on. What is about sides (side models, probes,
//! screening) takes the first; what is about items (contrasts, agreement, prediction) takes the second. The one way
//! across is [`ShownBallot::declared`], which has to be told which item comes first.

/// What was chosen of two sides.
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
        (1 - self.sign()) as usize
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

/// What was chosen of two items.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Preference {
    /// The item named first was chosen.
    First,
    /// Neither.
    Neither,
    /// The item named second was chosen.
    Second,
}

impl Preference {
    /// +1 for the first, 0 for neither, -1 for the second.
    pub fn sign(self) -> i64 {
        match self {
            Self::First => 1,
            Self::Neither => 0,
            Self::Second => -1,
        }
    }

    /// Place among first, neither, second.
    pub fn index(self) -> usize {
        (1 - self.sign()) as usize
    }

    /// The same answer with the items named the other way round.
    pub fn reversed(self) -> Self {
        match self {
            Self::First => Self::Second,
            Self::Neither => Self::Neither,
            Self::Second => Self::First,
        }
    }
}

/// One answer of one participant about two items. A question that was not answered has no ballot.
///
/// Kept in 20 bytes, since there may be millions. Ordered by participant, question, items and what was chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Ballot<Chosen> {
    participant: u32,
    question: u32,
    items: [u32; 2],
    chosen: Chosen,
    /// Whether what was chosen is much better, where people answered in steps.
    much: bool,
}

/// An answer as it was shown: its items are those on the left and on the right.
pub type ShownBallot = Ballot<Outcome>;

/// An answer about items, whichever side they stood on: the one that is named first, and the second.
pub type DeclaredBallot = Ballot<Preference>;

/// What both orientations have.
pub trait Answer: Copy {
    /// The participant, from 0.
    fn participant(&self) -> usize;
    /// The question, from 0.
    fn question(&self) -> usize;
    /// What was chosen: 0 the left or first item, 1 none, 2 the right or second item.
    fn place(&self) -> usize;
}

/// # Panics
/// If a number does not fit in 32 bits.
fn narrow(number: usize) -> u32 {
    u32::try_from(number).expect("four thousand million are not answered")
}

impl<Chosen> Ballot<Chosen> {
    /// An answer to a question about `items`, left and right or first and second; all are numbered from 0.
    ///
    /// # Panics
    /// If a number does not fit in 32 bits.
    pub fn new(participant: usize, question: usize, items: [usize; 2], chosen: Chosen) -> Self {
        Self {
            participant: narrow(participant),
            question: narrow(question),
            items: items.map(narrow),
            chosen,
            much: false,
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
}

impl ShownBallot {
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
        self.chosen
    }

    /// The same answer about items, `first` named first.
    ///
    /// # Panics
    /// If `first` is neither of the two items.
    pub fn declared(&self, first: usize) -> DeclaredBallot {
        let [left, right] = self.items;
        assert!(first == self.left() || first == self.right(), "item {first} was not shown in {self:?}");
        let preference = match self.chosen {
            Outcome::Left => Preference::First,
            Outcome::Tie => Preference::Neither,
            Outcome::Right => Preference::Second,
        };
        let (items, chosen) = match first == self.left() {
            true => ([left, right], preference),
            false => ([right, left], preference.reversed()),
        };
        let Self { participant, question, much, .. } = *self;
        DeclaredBallot { participant, question, items, chosen, much }
    }

    /// The same answer about items, the one with the lower number named first.
    pub fn by_item(&self) -> DeclaredBallot {
        self.declared(self.left().min(self.right()))
    }

    /// The same answer of another participant.
    pub fn with_participant(&self, participant: usize) -> Self {
        Self { participant: narrow(participant), ..*self }
    }

    /// The same with other items.
    pub fn with_items(&self, items: [usize; 2]) -> Self {
        Self { items: items.map(narrow), ..*self }
    }

    /// The same with another outcome, which is not much better.
    pub fn with_outcome(&self, outcome: Outcome) -> Self {
        Self { chosen: outcome, much: false, ..*self }
    }

    /// The same, what was chosen being much better or not.
    pub fn by_much(&self, much: bool) -> Self {
        Self { much, ..*self }
    }

    /// How far the left item is better, in steps: 2 if much, 1, 0, and below 0 where the right one is.
    pub fn step(&self) -> i8 {
        self.chosen.sign() as i8 * if self.much { 2 } else { 1 }
    }

    /// The same with items and outcome exchanged between the sides.
    pub fn turned(&self) -> Self {
        let [left, right] = self.items;
        Self { items: [right, left], chosen: self.chosen.swapped(), ..*self }
    }
}

impl DeclaredBallot {
    /// The item named first, from 0.
    pub fn first(&self) -> usize {
        self.items[0] as usize
    }

    /// The item named second, from 0.
    pub fn second(&self) -> usize {
        self.items[1] as usize
    }

    /// What was chosen.
    pub fn preference(&self) -> Preference {
        self.chosen
    }
}

impl<Chosen: Copy> Answer for Ballot<Chosen>
where
    usize: From<Chosen>,
{
    fn participant(&self) -> usize {
        self.participant()
    }

    fn question(&self) -> usize {
        self.question()
    }

    fn place(&self) -> usize {
        self.chosen.into()
    }
}

impl From<Outcome> for usize {
    fn from(outcome: Outcome) -> Self {
        outcome.index()
    }
}

impl From<Preference> for usize {
    fn from(preference: Preference) -> Self {
        preference.index()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_about_items_does_not_depend_on_sides() {
        let shown = ShownBallot::new(3, 7, [4, 1], Outcome::Left);
        for ballot in [shown, shown.turned()] {
            assert_eq!(ballot.declared(4), DeclaredBallot::new(3, 7, [4, 1], Preference::First));
            assert_eq!(ballot.by_item(), DeclaredBallot::new(3, 7, [1, 4], Preference::Second));
        }
        let control = ShownBallot::new(0, 0, [2, 2], Outcome::Right).by_item();
        assert_eq!((control.first(), control.second(), control.preference()), (2, 2, Preference::Second));
        assert_eq!(Preference::Neither.reversed().index(), 1);
    }

    #[test]
    fn steps_turn_with_their_sides() {
        let shown = ShownBallot::new(0, 0, [0, 1], Outcome::Left).by_much(true);
        assert_eq!((shown.step(), shown.turned().step()), (2, -2));
        assert_eq!(shown.with_items([3, 4]).with_participant(2).step(), 2);
        assert_eq!(shown.with_outcome(Outcome::Right).step(), -1);
        assert_eq!(shown.with_outcome(Outcome::Tie).by_much(true).step(), 0);
        assert_eq!(size_of::<ShownBallot>(), 20);
    }

    #[test]
    #[should_panic(expected = "was not shown")]
    fn an_item_that_was_not_shown_cannot_come_first() {
        ShownBallot::new(0, 0, [1, 2], Outcome::Tie).declared(0);
    }
}
