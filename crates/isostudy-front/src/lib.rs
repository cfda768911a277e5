//! Isosurfaces by an advancing front.

mod border;
mod error;
mod grow;
mod holes;
mod near;
mod patch;
mod probe;
mod samples;
mod settings;
mod sizes;
mod step;

pub use error::FrontError;
pub use grow::{Grown, grow};
pub use settings::{Counts, Front, Seeds, Sizing};
