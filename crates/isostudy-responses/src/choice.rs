//! One answer's content.

/// What was chosen of the two that were shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Choice {
    /// What was on the left.
    Left,
    /// No preference.
    NoPreference,
    /// What was on the right.
    Right,
}

impl Choice {
    /// The three choices, left to right.
    pub const ALL: [Self; 3] = [Self::Left, Self::NoPreference, Self::Right];

    /// How a study's own table writes it: `L`, `NP`, `R`.
    pub fn code(self) -> &'static str {
        match self {
            Self::Left => "L",
            Self::NoPreference => "NP",
            Self::Right => "R",
        }
    }

    /// How the long format writes it: `left`, `none`, `right`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::NoPreference => "none",
            Self::Right => "right",
        }
    }

    /// The same answer, seen with the sides swapped.
    pub fn swapped(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::NoPreference => Self::NoPreference,
            Self::Right => Self::Left,
        }
    }
}

/// An answer in up to five steps: a choice, and whether what was chosen is much better.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Step {
    /// What was chosen.
    pub choice: Choice,
    /// Whether it is much better; never of no preference.
    pub much: bool,
}

impl Step {
    /// The five steps, left to right.
    pub const ALL: [Self; 5] = [
        Self { choice: Choice::Left, much: true },
        Self { choice: Choice::Left, much: false },
        Self { choice: Choice::NoPreference, much: false },
        Self { choice: Choice::Right, much: false },
        Self { choice: Choice::Right, much: true },
    ];

    /// How a study's own table writes it: `LL`, `L`, `NP`, `R`, `RR`.
    pub fn code(self) -> &'static str {
        match (self.choice, self.much) {
            (Choice::Left, true) => "LL",
            (Choice::Right, true) => "RR",
            (choice, _) => choice.code(),
        }
    }

    /// How the long format writes it: `much_left`, `left`, `none`, `right`, `much_right`.
    pub fn name(self) -> &'static str {
        match (self.choice, self.much) {
            (Choice::Left, true) => "much_left",
            (Choice::Right, true) => "much_right",
            (choice, _) => choice.name(),
        }
    }

    /// How far the left side is better, in steps: 2, 1, 0, -1 or -2.
    pub fn value(self) -> i8 {
        let size = if self.much { 2 } else { 1 };
        match self.choice {
            Choice::Left => size,
            Choice::NoPreference => 0,
            Choice::Right => -size,
        }
    }
}

impl From<Choice> for Step {
    fn from(choice: Choice) -> Self {
        Self { choice, much: false }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_steps_hold_the_three_choices() {
        assert_eq!(Step::ALL.map(Step::code), ["LL", "L", "NP", "R", "RR"]);
        assert_eq!(Step::ALL.map(Step::name), ["much_left", "left", "none", "right", "much_right"]);
        assert_eq!(Step::ALL.map(Step::value), [2, 1, 0, -1, -2]);
        for choice in Choice::ALL {
            assert_eq!(
                (Step::from(choice).code(), Step::from(choice).name()),
                (choice.code(), choice.name())
            );
        }
    }
}
