//! The oracle, from outside.

mod known;
mod verify;
