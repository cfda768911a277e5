//! Files of answers as people have them, whole and damaged.

mod counted;
mod exports;
mod messages;
mod mutated;
mod open;
mod people;
mod refusals;
mod sides;
mod study;
mod written;
