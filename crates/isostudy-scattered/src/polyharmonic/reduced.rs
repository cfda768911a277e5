//! The kernel without its polynomials: what is left of it is positive definite.

use glam::{DMat3, DVec3};

use super::{FitError, Kernel};

/// Four points that span space: a linear function is known by its values there.
///
/// With `l_j` linear, 1 at the anchor `j` and 0 at the others, the kernel
/// `K(x, y) - sum l_j(x) K(a_j, y) - sum l_j(y) K(x, a_j) + sum l_i(x) l_j(y) K(a_i, a_j)`
/// is positive definite on all points but the anchors, and its rows can be appended one by one.
pub(super) struct Anchors {
    pub(super) points: [usize; 4],
    places: [DVec3; 4],
    /// Gives the last three of the linear functions at `p - places[0]`.
    inverse: DMat3,
    /// The kernel between anchors, with the smoothing.
    kernel: [[f64; 4]; 4],
}

/// What the reduced kernel takes of a point.
#[derive(Clone, Copy)]
pub(super) struct Reduced {
    place: DVec3,
    pub(super) shares: [f64; 4],
    crossed: [f64; 4],
}

/// Four points whose tetrahedron is flatter than this, in its edges, lie in one plane.
const FLATTEST: f64 = 1e-9;

impl Anchors {
    /// Chosen far from each other: the farthest point from the middle, then from that point, from the line of both and from the plane
    /// of three.
    ///
    /// # Errors
    /// [`FitError::Flat`].
    pub(super) fn choose(points: &[DVec3], kernel: Kernel, smoothing: f64) -> Result<Self, FitError> {
        let middle = points.iter().fold(DVec3::ZERO, |sum, p| sum + p / points.len() as f64);
        let farthest = |distance: &dyn Fn(DVec3) -> f64| {
            let best = points.iter().map(|&p| distance(p)).enumerate();
            best.fold((0, -1.0), |best, (i, d)| if d > best.1 { (i, d) } else { best })
        };
        let (a, _) = farthest(&|p| p.distance(middle));
        let (b, length) = farthest(&|p| p.distance(points[a]));
        let along = (points[b] - points[a]).normalize_or_zero();
        let (c, width) = farthest(&|p| (p - points[a]).cross(along).length());
        let normal = (points[c] - points[a]).cross(along).normalize_or_zero();
        let (d, height) = farthest(&|p| (p - points[a]).dot(normal).abs());
        // Also if they are no numbers.
        if !(width > FLATTEST * length && height > FLATTEST * length) {
            return Err(FitError::Flat);
        }
        let chosen = [a, b, c, d];
        let places = chosen.map(|i| points[i]);
        let inverse =
            DMat3::from_cols(places[1] - places[0], places[2] - places[0], places[3] - places[0]).inverse();
        let mut between = [[0.0; 4]; 4];
        for (i, row) in between.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry =
                    kernel.at(places[i].distance_squared(places[j])) + if i == j { smoothing } else { 0.0 };
            }
        }
        Ok(Self { points: chosen, places, inverse, kernel: between })
    }

    /// A point's shares of the anchors: its place is their mean by them.
    pub(super) fn shares(&self, p: DVec3) -> [f64; 4] {
        let last = self.inverse * (p - self.places[0]);
        [1.0 - (last.x + last.y + last.z), last.x, last.y, last.z]
    }

    pub(super) fn reduce(&self, place: DVec3, kernel: Kernel) -> Reduced {
        let shares = self.shares(place);
        let crossed = std::array::from_fn(|j| {
            let between: f64 = (0..4).map(|m| self.kernel[j][m] * shares[m]).sum();
            kernel.at(place.distance_squared(self.places[j])) - 0.5 * between
        });
        Reduced { place, shares, crossed }
    }

    /// A linear function with values at the anchors: its value at the first, and its slope.
    pub(super) fn linear(&self, values: [f64; 4]) -> (DVec3, f64, DVec3) {
        let rise = DVec3::new(values[1] - values[0], values[2] - values[0], values[3] - values[0]);
        (self.places[0], values[0], self.inverse.transpose() * rise)
    }
}

impl Reduced {
    /// The reduced kernel between two points, without smoothing.
    pub(super) fn with(&self, other: &Self, kernel: Kernel) -> f64 {
        let crossed: f64 =
            (0..4).map(|j| self.shares[j] * other.crossed[j] + other.shares[j] * self.crossed[j]).sum();
        kernel.at(self.place.distance_squared(other.place)) - crossed
    }
}
