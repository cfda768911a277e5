//! Programs as extractors: real ones, and such with planted defects.

mod adapters;
mod cgal;
mod commands;
mod example;
mod planted;
mod programs;
