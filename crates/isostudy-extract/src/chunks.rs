//! Boxes of a larger lattice, extracted one by one and welded to the mesh of the whole.

mod chunk;
mod error;
mod extractor;
mod labels;
mod layout;
mod part;
mod piece;
pub(crate) mod relative;
mod settings;
mod settled;
mod touched;
mod weld;
mod world;

pub use chunk::{Chunk, TooManyVertices};
pub use error::ChunkError;
pub use extractor::ChunkExtractor;
pub use labels::{LabelChunk, weld_label_chunks};
pub use layout::SampleLayout;
pub use settings::{ChunkSettings, Normals};
pub use weld::{Mismatch, WeldError, weld_chunks};
pub use world::World;
