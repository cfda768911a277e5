//! The other way in: marching tetrahedra on a [`Lattice`] that the caller makes.
//!
//! A [`Method`](crate::Method) makes the lattice that it needs of a [`BoxGrid`](crate::BoxGrid), for any family, and is what most should
//! call. A lattice of one's own is for what only it can do: to be asked for its sample points, counts and bytes before an extraction
//! ([`Lattice::stored_samples`], [`Lattice::memory_bytes_for`]), to be the part of a larger one, to give samples in its storage
//! order, and to hold the published evaluation against.
//!
//! ```
//! use glam::Vec3;
//! use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
//! use isostudy_extract::{Arrangement, Execution};
//! use isostudy_field::Sphere;
//! use isostudy_mesh::Bounds;
//!
//! let bounds = Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) };
//! let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.1)?;
//! let (settings, execution) = (ExtractSettings::default(), Execution::default());
//! let extraction = extract(&Sphere { radius: 1.0 }, &lattice, &settings, &execution)?;
//! assert!(extraction.counts.samples > lattice.cells().iter().map(|&n| u64::from(n)).product());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Extractor::extract_into`](crate::Extractor::extract_into) is the same with buffers that are kept.

#[cfg(feature = "tetrahedra")]
pub use crate::extractor::extract;
pub use crate::lattice::Lattice;
pub use crate::settings::ExtractSettings;
