//! The tests of the crate.

mod errors;
mod interval;
mod manifold;
mod series;
mod slices;
mod table;
mod topology;
mod vtk;
