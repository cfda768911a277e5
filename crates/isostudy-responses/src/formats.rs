//! What rows of cells mean, format by format: how each is known, and how its rows become answers.

pub(crate) mod arenakit;
pub(crate) mod columns;
pub(crate) mod detect;
pub(crate) mod layout;
pub(crate) mod long;
pub(crate) mod people;
pub(crate) mod pwcmp;
pub(crate) mod surveys;
pub(crate) mod trials;
pub(crate) mod webmushra;
pub(crate) mod wide;
