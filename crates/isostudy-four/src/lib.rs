//! tmp
mod cube;
mod hull;
mod pulling;
mod table;
pub use cube::{Cube, Edge};
pub use table::Table;
