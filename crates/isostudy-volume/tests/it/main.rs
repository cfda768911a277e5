//! Volumes, from outside. The test of memory needs the process for itself and lies beside this folder.

mod files;
mod formats;
mod mutated;
mod series;
mod stored;
