//! Boxes of a larger lattice, extracted one by one and welded to the mesh of the whole.

mod chunk;
mod extractor;
mod weld;

pub use chunk::Chunk;
pub use extractor::{ChunkError, ChunkExtractor};
pub use weld::{WeldError, weld_chunks};
