//! The field of triangles that need not hang together.

mod patch;
mod real;
#[cfg(test)]
mod tests;
mod tree;

use glam::{DVec3, Vec3};
use isostudy_field::StudyField;
use isostudy_mesh::{Bounds, MeshError, TriangleMesh, is_sound, used_vertices};
use thiserror::Error;

use self::patch::Patch;
use self::real::{Point, Real};
use self::tree::{Sums, Tree};

/// The least distance that the weight is rounded off by, as a share of the size of the box: coordinates are in single precision.
const LEAST: f64 = 1e-6;
/// The distance that it is rounded off by unless one is given, as a share of the diagonal of the box.
const USUAL: f64 = 0.01;

/// Why there is no field of triangles.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SoupError {
    /// The triangles cannot be computed with.
    #[error("{0}")]
    Mesh(#[from] MeshError),
    /// No triangle has a plane.
    #[error("all {triangles} triangles are flat: they repeat a corner, or their corners lie on a line")]
    Flat {
        /// How many there are.
        triangles: usize,
    },
    /// The distance is none.
    #[error("epsilon must be 0 or more and finite, not {0}")]
    Epsilon(f64),
}

/// Triangles that were left out: they repeat a corner, or their corners lie on a line up to rounding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FlatTriangles {
    /// How many.
    pub many: usize,
    /// The first of them, from 0.
    pub first: usize,
}

/// The field of polygon soup: the mean of the signed distances to the planes of all triangles, each point of a triangle weighted by
/// `1 / (r^2 + epsilon^2)^2` with its distance `r`. Positive inside, behind the triangles; counter-clockwise seen from outside.
///
/// With `epsilon` 0 the surface goes through the triangles, and across holes and gaps smoothly. It is smoother, and farther from
/// edges and corners, the larger `epsilon` is. Triangles of one plane give that plane, whatever `epsilon`. Each triangle faces its
/// own way: where neighbours face opposite ways, the surface passes between them.
///
/// Integrals are closed forms. Groups of triangles that are four times as far away as they are large are summed by their moments
/// to second order.
///
/// Source: Shen, O'Brien & Shewchuk (2004), "Interpolating and approximating implicit surfaces from polygon soup", with their
/// constant basis and normal constraints; they integrate by numbers where this uses a closed form.
#[derive(Debug, Clone)]
pub struct SoupField {
    tree: Tree,
    squared: f64,
    epsilon: f64,
    bounds: Bounds,
    flat: Option<FlatTriangles>,
}

impl SoupField {
    /// Builds the tree, O(n log n), about 700 bytes a triangle. Without an `epsilon`, in the unit of coordinates, it is 1 % of the
    /// diagonal of the box of all triangles. Less than a millionth of the box's size is taken as that.
    ///
    /// # Errors
    /// If there is no triangle, an index has no vertex, a coordinate is not finite or above 1e18, or all triangles are flat; if
    /// `epsilon` is negative or not finite.
    pub fn try_new(mesh: &TriangleMesh, epsilon: Option<f64>) -> Result<Self, SoupError> {
        if let Some(odd) = epsilon.filter(|epsilon| !(*epsilon >= 0.0 && epsilon.is_finite())) {
            return Err(SoupError::Epsilon(odd));
        }
        used_vertices(mesh)?;
        let triangles = mesh.triangles.len();
        let patch = |t: usize| Patch::of(mesh.corners(t).map(|corner| corner.as_dvec3()));
        let found: Vec<Option<Patch>> = (0..triangles).map(patch).collect();
        let many = found.iter().filter(|patch| patch.is_none()).count();
        let first = found.iter().position(Option::is_none);
        let flat = first.map(|first| FlatTriangles { many, first });
        if many == triangles {
            return Err(SoupError::Flat { triangles });
        }
        let bounds = mesh.surface_bounds().expect("it has triangles");
        let size = bounds.size().as_dvec3();
        let epsilon = epsilon.unwrap_or(USUAL * size.length());
        let least = LEAST * size.max_element();
        let tree = Tree::new(found.into_iter().flatten().collect());
        Ok(Self { tree, squared: epsilon.max(least).powi(2), epsilon, bounds, flat })
    }

    /// The smallest box that holds every triangle.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The distance that the weight is rounded off by.
    pub fn epsilon(&self) -> f64 {
        self.epsilon
    }

    /// Triangles without a plane, which count for nothing.
    pub fn flat(&self) -> Option<FlatTriangles> {
        self.flat
    }

    fn value<R: Real>(&self, x: Point<R>) -> R {
        let Sums { weights, distances } = self.tree.sums(x, self.squared);
        R::of(0.0) - distances * weights.inverse()
    }
}

impl StudyField for SoupField {
    /// `NaN`, which counts as outside, where `p` is beyond the limit for coordinates or no point at all.
    fn sample(&self, p: Vec3) -> f32 {
        if is_sound(p) { self.value(Point::plain(p.as_dvec3())) as f32 } else { f32::NAN }
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        if !is_sound(p) {
            return None;
        }
        let gradient: DVec3 = self.value(Point::with_gradient(p.as_dvec3())).gradient;
        let gradient = gradient.as_vec3();
        (gradient.is_finite() && gradient != Vec3::ZERO).then_some(gradient)
    }
}
