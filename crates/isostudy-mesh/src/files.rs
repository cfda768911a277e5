//! Meshes in files: readers, writers, and which format is which.

mod format;
mod glb;
mod labelled;
mod obj;
mod ply;
mod stl;

pub use format::{MeshFormat, ReadError};
pub use glb::{CompactNumbers, Per, write_compact_glb, write_glb};
pub use obj::{ObjError, read_obj, write_obj};
pub use ply::{PlyError, read_ply, write_ply};
pub use stl::{StlError, read_stl, write_stl};
