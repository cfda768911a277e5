//! The exact topology of trilinear level sets, and meshes checked against it.
//!
//! Between the samples of a volume the trilinear interpolant is the field that marching cubes and its followers approximate.
//! Where its level set is torn, joined or pierced by a tunnel follows from the samples, and [`topology`] says it without making a
//! mesh: components, Euler characteristic, boundary loops and tunnels. [`verify`] holds a mesh against that, whichever program
//! made it.
//!
//! ```
//! use isostudy_trilinear::{Samples, Ties, topology};
//!
//! // A ball in the middle of 5 x 5 x 5 samples.
//! let at = |i: usize| [i % 5, i / 5 % 5, i / 25].map(|x| x as f32 - 2.0);
//! let values: Vec<f32> = (0..125).map(|i| 2.0 - at(i).iter().map(|x| x * x).sum::<f32>()).collect();
//! let surface = topology(&Samples::try_new([5; 3], &values)?, 0.5, Ties::Outside)?;
//! assert_eq!(surface.components.len(), 1);
//! assert_eq!(surface.euler_characteristic(), 2);
//! # Ok::<(), isostudy_trilinear::SamplesError>(())
//! ```
//!
//! # How
//!
//! A slice of a cell at height `z` is bilinear: its corners `a, b, c, d` move linearly with `z`, and `a` and `c`, where both are
//! inside, are one region of the slice as soon as `ac > bd` (Nielson & Hamann 1991). That is a quadratic in `z`. Regions of
//! slices go on along the cell's upright edges, since a region of a bilinear slice always has a corner. So which corners of a
//! cell are joined through its inside is a matter of signs of polynomials at fractions, and no root is ever computed.
//!
//! With `E` edges between samples that the surface crosses, `A` arcs in faces, and for each cell `s` regions on its surface and
//! `r` in its inside, the Euler characteristic is `E - A + sum of (2r - s - 1)`: each piece of surface in a cell is a sphere
//! with a hole for each loop.
//!
//! # Guaranteed
//!
//! - All decisions are exact. A sample is a whole number times a power of two; where 128 bits do not hold the products, whole
//!   numbers of any length do.
//! - A level that meets a saddle or a sample is none that has a surface of its own: it is raised (or lowered, [`Ties`]) by less
//!   than any number, so that every set of samples has an answer, which is that of a level nearby.
//! - No code is shared with the extractors.
//!
//! # Not guaranteed
//!
//! - Nothing is said about where the surface is. A mesh with the right topology can lie elsewhere.
//!
//! # Sources
//!
//! - G. M. Nielson, B. Hamann: The asymptotic decider: resolving the ambiguity in marching cubes. IEEE Visualization (1991).
//! - T. Etiene, L. G. Nonato, C. Scheidegger, J. Tierny, T. J. Peters, V. Pascucci, R. M. Kirby, C. T. Silva: Topology verification
//!   for isosurface extraction. IEEE TVCG 18 (2012). That extractors should be tested so.
//! - The count of regions is derived here.

mod cell;
mod grid;
mod mesh_components;
mod number;
mod samples;
mod sets;
mod verify;

pub use cell::{CellTopology, cell_topology};
pub use grid::{Component, Surface, topology};
pub use samples::{Samples, SamplesError, Ties};
pub use verify::{Fault, Finding, Summary, Verdict, verify};
