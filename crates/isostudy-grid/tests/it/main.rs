//! Grids, from outside.

mod errors;
mod field;
mod files;
mod mutated;
mod surfaces;
