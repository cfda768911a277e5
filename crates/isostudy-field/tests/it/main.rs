//! Fields, from outside.

mod gradients;
mod stored;
mod terrain;
mod volume;
