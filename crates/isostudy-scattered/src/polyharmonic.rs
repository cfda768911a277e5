//! Polyharmonic splines: radial basis functions with a linear polynomial.

mod cholesky;
mod fit;
mod greedy;
mod reduced;
mod system;

use glam::DVec3;
use thiserror::Error;

/// The most centres that a spline may have: their matrix takes 400 MB, and minutes.
pub const MOST_CENTRES: usize = 10_000;

/// How a centre acts at a distance `r`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kernel {
    /// `-r`: the spline of least bending in space. Its gradient jumps at the centres.
    #[default]
    Biharmonic,
    /// `r^3`: smoother, and worse to solve where centres lie close together.
    Triharmonic,
}

impl Kernel {
    /// What it is at a squared distance. Positive definite where weights sum to zero against linear functions.
    fn at(self, squared: f64) -> f64 {
        match self {
            Self::Biharmonic => -squared.sqrt(),
            Self::Triharmonic => squared * squared.sqrt(),
        }
    }
}

/// How a spline is fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitSettings {
    /// How a centre acts.
    pub kernel: Kernel,
    /// Added to the matrix's diagonal, 0 or more: above 0 the spline passes by the values and is smoother. In the unit of the
    /// kernel, as SciPy's `smoothing`.
    pub smoothing: f64,
    /// Points beyond this many are chosen from, 4 to [`MOST_CENTRES`].
    pub most_centres: usize,
}

impl Default for FitSettings {
    fn default() -> Self {
        Self { kernel: Kernel::default(), smoothing: 0.0, most_centres: 3000 }
    }
}

/// Why there is no spline.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FitError {
    /// A linear function takes four points.
    #[error("{points} points; at least 4 are needed")]
    Few {
        /// How many there are.
        points: usize,
    },
    /// All points lie in one plane, so that linear functions are not told apart.
    #[error("all points lie in one plane")]
    Flat,
    /// A coordinate or a value is not finite, or a coordinate is beyond 1e18.
    #[error("point {point} (from 0) has a coordinate or a value that is not finite, or is above 1e18")]
    NotFinite {
        /// Which point.
        point: usize,
    },
    /// A setting is out of its range.
    #[error("{name} must be {allowed}, not {value}")]
    Setting {
        /// Which.
        name: &'static str,
        /// The range.
        allowed: &'static str,
        /// What it is.
        value: f64,
    },
}

/// How good a fit is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitReport {
    /// Points that were given.
    pub points: usize,
    /// Points that are centres.
    pub centres: usize,
    /// The largest difference to a given value, at a point that is a centre or not.
    pub largest: f64,
    /// The root of the mean square of all of them.
    pub root_mean_square: f64,
}

/// `s(x) = p(x) + sum of w_i phi(|x - c_i|)`, with a linear `p` and weights that sum to zero against every linear function.
///
/// Linear functions are reproduced, up to rounding. The spline turns, moves and scales with its data.
///
/// Source: Duchon (1977) for the splines; Carr et al. (2001), "Reconstruction and representation of 3D objects with radial basis
/// functions", for surfaces and for choosing centres by where the error is largest. Values are those of SciPy's `RBFInterpolator`
/// with `degree=1` and the kernels `linear` and `cubic`.
#[derive(Debug, Clone)]
pub struct Polyharmonic {
    kernel: Kernel,
    /// Coordinates and weight of each centre; the kernel's sign is in the weight.
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    weights: Vec<f64>,
    /// The polynomial is `constant + slope . (p - about)`.
    about: DVec3,
    constant: f64,
    slope: DVec3,
}

impl Polyharmonic {
    /// The value at `p`.
    pub fn value(&self, p: DVec3) -> f64 {
        let distance = |i: usize| {
            let (dx, dy, dz) = (p.x - self.x[i], p.y - self.y[i], p.z - self.z[i]);
            dx * dx + (dy * dy + dz * dz)
        };
        let centres = 0..self.weights.len();
        let sum = match self.kernel {
            Kernel::Biharmonic => centres.fold(0.0, |sum, i| sum + self.weights[i] * distance(i).sqrt()),
            Kernel::Triharmonic => centres.fold(0.0, |sum, i| {
                let squared = distance(i);
                sum + self.weights[i] * (squared * squared.sqrt())
            }),
        };
        self.linear(p) + sum
    }

    /// The values at `(x[i], y, z)`, to the bit those of [`value`](Self::value): centre by centre, so that the points of a row are
    /// worked on at once.
    pub fn row(&self, x: &[f64], y: f64, z: f64, values: &mut [f64]) {
        values.fill(0.0);
        for (i, &weight) in self.weights.iter().enumerate() {
            let (dy, dz, at) = (y - self.y[i], z - self.z[i], self.x[i]);
            let aside = dy * dy + dz * dz;
            let row = values.iter_mut().zip(x);
            match self.kernel {
                Kernel::Biharmonic => row.for_each(|(value, x)| {
                    let dx = x - at;
                    *value += weight * (dx * dx + aside).sqrt();
                }),
                Kernel::Triharmonic => row.for_each(|(value, x)| {
                    let dx = x - at;
                    let squared = dx * dx + aside;
                    *value += weight * (squared * squared.sqrt());
                }),
            }
        }
        for (value, &x) in values.iter_mut().zip(x) {
            *value += self.linear(DVec3::new(x, y, z));
        }
    }

    /// How the value changes along x, y and z. A biharmonic centre counts for nothing at its own place, where it has no gradient.
    pub fn gradient(&self, p: DVec3) -> DVec3 {
        (0..self.weights.len()).fold(self.slope, |sum, i| {
            let d = p - DVec3::new(self.x[i], self.y[i], self.z[i]);
            let r = d.length();
            let factor = match self.kernel {
                Kernel::Biharmonic if r == 0.0 => 0.0,
                Kernel::Biharmonic => 1.0 / r,
                Kernel::Triharmonic => 3.0 * r,
            };
            sum + d * (self.weights[i] * factor)
        })
    }

    /// How many centres there are.
    pub fn centres(&self) -> usize {
        self.weights.len()
    }

    fn linear(&self, p: DVec3) -> f64 {
        self.constant + self.slope.dot(p - self.about)
    }
}
