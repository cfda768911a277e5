//! How an extraction is run. None of it changes the mesh.

pub(crate) mod control;
pub(crate) mod threads;

pub use control::{Control, Jobs, Threads};
