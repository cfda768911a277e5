//! Programs with planted defects: each is an error that says what it was, and leaves nothing behind.

mod defects;
mod meshes;
mod processes;
