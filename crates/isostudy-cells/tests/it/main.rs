//! The tables of patches, from outside.

mod census;
mod divided;
