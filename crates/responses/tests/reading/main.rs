//! Files of answers as people have them, whole and damaged.

mod exports;
mod mutated;
mod people;
mod refusals;
mod study;
mod written;
