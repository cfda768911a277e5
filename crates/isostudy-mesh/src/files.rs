//! Meshes in files: readers, writers, and which format is which.

/// Makes a type an error that may hold another's, whose source is then its own, and makes it of each of those.
macro_rules! error_of {
    ($error:ident { $($variant:ident($inner:ty)),+ }) => {
        impl std::error::Error for $error {
            fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
                match self {
                    $(Self::$variant(error) => error.source(),)+
                    _ => None,
                }
            }
        }

        $(impl From<$inner> for $error {
            fn from(error: $inner) -> Self {
                Self::$variant(error)
            }
        })+
    };
}

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
