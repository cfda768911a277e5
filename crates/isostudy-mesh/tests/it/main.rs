//! Meshes, from outside.

mod compact_glb;
mod glb;
mod labelled;
mod metro;
mod mutated;
mod obj;
mod ply;
mod repair;
mod self_intersections;
mod shapes;
mod stl;
mod topology;
