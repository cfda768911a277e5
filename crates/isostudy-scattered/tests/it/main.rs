//! Tests of the crate's public face.

mod clouds;
mod mutated;
mod scans;
mod soups;
mod splines;
