//! Pictures, from outside.

mod animation;
mod camera;
mod colour_map;
mod fill;
mod golden;
mod looks;
mod palette;
mod panels;
mod shapes;
mod sheets;
