//! The tests of the crate.

mod table;
