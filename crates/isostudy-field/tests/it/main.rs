//! Fields, from outside.

mod gradients;
mod terrain;
