//! How far one surface is from another, measured at points sampled by area: the Metro distances (Cignoni, Rocchini &
//! Scopigno 1998).
//!
//! The distance of a point `p` to a surface `S` is `e(p, S) = min |p - q|` over the points `q` of `S`. From a surface
//! `A` to `S`, the [`Deviation`] has
//!
//! - the mean, `1/|A| ∫ e(p, S) dA`, and the RMS, `sqrt(1/|A| ∫ e(p, S)² dA)`, estimated from [`AreaSamples`] with a
//!   stated density, so that no triangle counts for more than its area;
//! - the one-sided Hausdorff distance, `max e(p, S)`, over the same points and the vertices of `A`.
//!
//! It has a direction: a surface that lies wholly on another is at distance 0 from it, and the other may be far from
//! it. [`metro`] goes both ways; the larger of both maxima is the Hausdorff distance.
//!
//! ```
//! use isostudy_mesh::metro::{Amount, Sampling, metro};
//! use isostudy_mesh::{TriangleMesh, glam::Vec3};
//!
//! let square = |side: f32, z: f32| TriangleMesh {
//!     positions: [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(x, y)| Vec3::new(x, y, z)).to_vec(),
//!     triangles: vec![[0, 1, 2], [0, 2, 3]],
//!     ..TriangleMesh::default()
//! };
//! let sampling = Sampling { amount: Amount::Density(10_000.0), ..Sampling::default() };
//! let distances = metro(&square(1.0, 0.0), &square(2.0, 0.5), &sampling)?;
//! assert_eq!((distances.forward.mean, distances.forward.max), (0.5, 0.5));
//! assert!((distances.backward.max - 1.5).abs() < 1e-12, "from (2, 2, 0.5) to (1, 1, 0)");
//! # Ok::<(), isostudy_mesh::metro::MetroError>(())
//! ```
//!
//! # Guaranteed
//!
//! - Every distance is one to the nearest triangle, in double precision (see [`NearestTriangles::nearest`] for what
//!   decides which that is); inside and outside do not matter, nor does topology.
//! - The same surfaces, amount and seed give the same bytes on any number of threads. With the feature `rayon`, work runs on
//!   the pool that the call is made in.
//! - `max` is a distance that occurs: the one-sided Hausdorff distance is not less.
//!
//! # Not guaranteed
//!
//! - The one-sided Hausdorff distance may exceed `max` between samples: by no more than the distance from any point of
//!   `A` to the next sample, since `e` changes no faster than `p` moves. Exact where the maximum is at a vertex of `A`.
//! - A triangle without area has no samples; its corners count towards the maximum. As part of the surface that is
//!   measured against, it is the segment or the point that it covers. A vertex that no triangle uses is no part of a
//!   surface.
//!
//! Like the published program, this samples faces in proportion to their area and looks for nearest points among all
//! triangles through a search structure. Unlike it, samples are not drawn independently but spread evenly, which
//! converges faster; vertices do not enter the mean; edges are not sampled apart, since faces have points as near to
//! them as anywhere; and distances have no sign.

mod samples;

use std::error::Error;
use std::fmt;
use std::ops::Range;

use glam::{DVec3, Vec3};
#[cfg(feature = "rayon")]
use rayon::prelude::*;

pub use self::samples::AreaSamples;
use crate::nearest::NearestTriangles;
use crate::numbers::{MeshError, used_vertices};
use crate::{Bounds, TriangleMesh};

/// The most samples of a surface: minutes of work.
pub const MOST_SAMPLES: u64 = 1_000_000_000;
/// Points that one thread takes at a time. Sums are made within and then over these shares, whoever takes them.
const SHARE: u64 = 4096;

/// Why a surface cannot be measured.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum MetroError {
    /// The mesh cannot be computed with.
    Mesh(MeshError),
    /// All triangles are degenerate: there is nothing to take a mean over.
    NoArea {
        /// How many there are.
        triangles: usize,
    },
    /// A density that is no positive number.
    Density {
        /// The density.
        density: f64,
    },
    /// No samples, or more than [`MOST_SAMPLES`].
    SampleCount {
        /// How many were asked for.
        samples: f64,
        /// The area they are for.
        area: f64,
    },
}

impl fmt::Display for MetroError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh(error) => error.fmt(f),
            Self::NoArea { triangles } => {
                write!(f, "the mesh has {triangles} triangles, and none has an area")
            }
            Self::Density { density } => {
                write!(f, "a density of {density} samples per unit of area; it must be a number above 0")
            }
            Self::SampleCount { samples, area } => {
                write!(f, "{samples:.0} samples on an area of {area}; allowed are 1 to {MOST_SAMPLES}")
            }
        }
    }
}

impl Error for MetroError {}

impl From<MeshError> for MetroError {
    fn from(error: MeshError) -> Self {
        Self::Mesh(error)
    }
}

/// How many points of a surface are measured, and which.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// How many, or how densely.
    pub amount: Amount,
    /// Seed of their places.
    pub seed: u64,
}

impl Default for Sampling {
    /// A million samples of each surface, seed 1.
    fn default() -> Self {
        Self { amount: Amount::Samples(1_000_000), seed: 1 }
    }
}

/// How many samples a surface has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Amount {
    /// So many on each surface.
    Samples(u64),
    /// So many per unit of area, rounded up to a whole number for a surface.
    Density(f64),
}

impl Amount {
    /// The number of samples on a surface with some area.
    ///
    /// # Errors
    /// [`MetroError::Density`], [`MetroError::SampleCount`].
    pub fn on(self, area: f64) -> Result<u64, MetroError> {
        let samples = match self {
            Self::Samples(samples) => samples as f64,
            Self::Density(density) if density > 0.0 && density.is_finite() => (density * area).ceil(),
            Self::Density(density) => return Err(MetroError::Density { density }),
        };
        let allowed = (1.0..=MOST_SAMPLES as f64).contains(&samples);
        if allowed { Ok(samples as u64) } else { Err(MetroError::SampleCount { samples, area }) }
    }
}

/// A mesh made ready to be measured, and to be measured against.
#[derive(Debug, Clone)]
pub struct Surface {
    triangles: Vec<[Vec3; 3]>,
    /// Those that a triangle uses.
    vertices: Vec<Vec3>,
    bounds: Bounds,
    area: f64,
    nearest: NearestTriangles,
}

impl Surface {
    /// Checks a mesh and builds the search structure, O(n log n) and about 250 bytes a triangle.
    ///
    /// # Errors
    /// [`MetroError::Mesh`], [`MetroError::NoArea`].
    pub fn try_new(mesh: &TriangleMesh) -> Result<Self, MetroError> {
        let is_used = used_vertices(mesh)?;
        let used = mesh.positions.iter().zip(is_used).filter(|(_, used)| *used);
        let vertices: Vec<Vec3> = used.map(|(p, _)| *p).collect();
        let (min, max) = vertices
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), &p| (min.min(p), max.max(p)));
        let area = mesh.area();
        if area <= 0.0 {
            return Err(MetroError::NoArea { triangles: mesh.triangles.len() });
        }
        let triangles: Vec<[Vec3; 3]> = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect();
        let nearest = NearestTriangles::new(&triangles);
        Ok(Self { triangles, vertices, bounds: Bounds { min, max }, area, nearest })
    }

    /// The smallest box that holds all triangles.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The length of the box's diagonal.
    pub fn diagonal(&self) -> f64 {
        self.bounds.max.as_dvec3().distance(self.bounds.min.as_dvec3())
    }

    /// The area of all triangles.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// The nearest point of the surface to `p`, which must be finite; sooner found where its distance is known to be
    /// below `limit`.
    pub fn nearest(&self, p: DVec3, limit: f64) -> Foot {
        let found = self.nearest.nearest(p, limit, |t| self.triangles[t]);
        Foot { position: found.position, distance: found.distance }
    }

    /// Points spread over the surface by area.
    ///
    /// # Errors
    /// Where `sampling` asks for what cannot be.
    pub fn samples(&self, sampling: &Sampling) -> Result<AreaSamples<'_>, MetroError> {
        Ok(AreaSamples::new(&self.triangles, sampling.amount.on(self.area)?, sampling.seed))
    }

    /// How far this surface is from whatever `nearest` gives the distance to: from a point of this surface, and from
    /// the one that was asked for before it in the same share of the work, with its answer. The answer must not depend
    /// on the latter. `None` says that it cannot be known.
    ///
    /// # Errors
    /// Where `sampling` asks for what cannot be.
    pub fn deviation_by(
        &self,
        sampling: &Sampling,
        nearest: impl Fn(DVec3, Option<(DVec3, f64)>) -> Option<Foot> + Sync,
    ) -> Result<Deviation, MetroError> {
        let samples = self.samples(sampling)?;
        let count = samples.count();
        let faces = in_shares(count, |range| Sums::over(samples.points(range), &nearest));
        let vertices = in_shares(self.vertices.len() as u64, |range| {
            let points = &self.vertices[range.start as usize..range.end as usize];
            Sums::over(points.iter().map(|p| p.as_dvec3()), &nearest)
        });
        let asked = [count, self.vertices.len() as u64];
        Ok(Deviation::of([faces, vertices], asked, count as f64 / self.area))
    }

    /// How far this surface is from another.
    ///
    /// # Errors
    /// Where `sampling` asks for what cannot be.
    pub fn deviation_from(&self, other: &Surface, sampling: &Sampling) -> Result<Deviation, MetroError> {
        self.deviation_by(sampling, |p, before| {
            // Distances change no faster than one goes; a little more for rounding, which a limit may take or not.
            let limit =
                before.map_or(f64::INFINITY, |(q, distance)| (distance + p.distance(q)) * (1.0 + 1e-5));
            Some(other.nearest(p, limit))
        })
    }
}

/// A point and how far it is to go there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Where it is.
    pub position: DVec3,
    /// How far, never negative.
    pub distance: f64,
}

/// How far a surface is from another, in the unit of the coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// Points on the triangles.
    pub samples: u64,
    /// The same per unit of area.
    pub density: f64,
    /// Of these, points without a known distance, which are in no number here; none between meshes.
    pub lost_samples: u64,
    /// Vertices, each of them looked at for the maximum.
    pub vertices: u64,
    /// Vertices without a known distance.
    pub lost_vertices: u64,
    /// Mean over the area; 0 if no point has a distance, like the two others.
    pub mean: f64,
    /// Root of the mean square over the area.
    pub rms: f64,
    /// The largest distance of a sample or a vertex.
    pub max: f64,
    /// Where that is; the first of equals, samples before vertices.
    pub farthest: Option<Farthest>,
}

/// Where a surface is farthest from another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Farthest {
    /// The point of the surface.
    pub from: DVec3,
    /// The nearest point of the other.
    pub to: DVec3,
    /// Whether `from` is a vertex.
    pub at_vertex: bool,
}

impl Deviation {
    /// Of sums over samples and over vertices, and of how many were asked for.
    fn of([faces, vertices]: [Sums; 2], [samples, all_vertices]: [u64; 2], density: f64) -> Self {
        let mean = |sum: f64| if faces.count > 0 { sum / faces.count as f64 } else { 0.0 };
        let at_vertex =
            vertices.farthest.is_some_and(|v| faces.farthest.is_none_or(|f| v.1.distance > f.1.distance));
        let farthest = if at_vertex { vertices.farthest } else { faces.farthest };
        Self {
            samples,
            density,
            lost_samples: samples - faces.count,
            vertices: all_vertices,
            lost_vertices: all_vertices - vertices.count,
            mean: mean(faces.sum),
            rms: mean(faces.squares).sqrt(),
            max: farthest.map_or(0.0, |(_, foot)| foot.distance),
            farthest: farthest.map(|(from, foot)| Farthest { from, to: foot.position, at_vertex }),
        }
    }
}

/// How far a surface is from whatever `nearest` gives the distance to, at points of it that each stand for the same area: as
/// [`Surface::deviation_by`] for a surface that is no mesh. It has no vertices.
pub fn deviation_at(
    points: &[DVec3],
    area_each: f64,
    nearest: impl Fn(DVec3, Option<(DVec3, f64)>) -> Option<Foot> + Sync,
) -> Deviation {
    let count = points.len() as u64;
    let sums = in_shares(count, |range| {
        Sums::over(points[range.start as usize..range.end as usize].iter().copied(), &nearest)
    });
    let density = if area_each > 0.0 { area_each.recip() } else { 0.0 };
    Deviation::of([sums, Sums::default()], [count, 0], density)
}

/// The distances between two surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metro {
    /// From the first to the second.
    pub forward: Deviation,
    /// From the second to the first.
    pub backward: Deviation,
    /// The length of the diagonal of the second one's bounding box, to state the others in.
    pub diagonal: f64,
}

impl Metro {
    /// The Hausdorff distance: the larger of both maxima.
    pub fn hausdorff(&self) -> f64 {
        self.forward.max.max(self.backward.max)
    }
}

/// Measures two meshes against each other, both ways.
///
/// # Errors
/// [`MetroError`]; [`Surface::try_new`] tells which of the meshes is at fault.
pub fn metro(first: &TriangleMesh, second: &TriangleMesh, sampling: &Sampling) -> Result<Metro, MetroError> {
    let (first, second) = (Surface::try_new(first)?, Surface::try_new(second)?);
    Ok(Metro {
        forward: first.deviation_from(&second, sampling)?,
        backward: second.deviation_from(&first, sampling)?,
        diagonal: second.diagonal(),
    })
}

/// What is known of some points.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    count: u64,
    sum: f64,
    squares: f64,
    farthest: Option<(DVec3, Foot)>,
}

impl Sums {
    fn over(
        points: impl Iterator<Item = DVec3>,
        nearest: impl Fn(DVec3, Option<(DVec3, f64)>) -> Option<Foot>,
    ) -> Self {
        let (mut sums, mut before) = (Self::default(), None);
        for p in points {
            let found = nearest(p, before);
            before = found.map(|foot| (p, foot.distance));
            if let Some(foot) = found {
                let distance = foot.distance;
                let one =
                    Self { count: 1, sum: distance, squares: distance * distance, farthest: Some((p, foot)) };
                sums = sums.and(one);
            }
        }
        sums
    }

    /// The first of equally far points stays.
    fn and(self, next: Self) -> Self {
        let farthest = match (self.farthest, next.farthest) {
            (Some(a), Some(b)) if b.1.distance > a.1.distance => Some(b),
            (a, b) => a.or(b),
        };
        Self {
            count: self.count + next.count,
            sum: self.sum + next.sum,
            squares: self.squares + next.squares,
            farthest,
        }
    }
}

/// The sums of all shares, added up in their order.
fn in_shares(count: u64, sums: impl Fn(Range<u64>) -> Sums + Sync) -> Sums {
    let shares = 0..count.div_ceil(SHARE);
    #[cfg(feature = "rayon")]
    let shares = shares.into_par_iter();
    let shares: Vec<Sums> =
        shares.map(|share| sums(share * SHARE..((share + 1) * SHARE).min(count))).collect();
    shares.into_iter().fold(Sums::default(), Sums::and)
}
