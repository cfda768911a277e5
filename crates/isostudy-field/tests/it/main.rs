//! Fields, from outside.

mod gradients;
mod terrain;
mod volume;
