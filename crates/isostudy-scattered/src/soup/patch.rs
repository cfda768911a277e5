//! The integral of the weight over a triangle, in closed form.

use glam::DVec3;

use super::real::{Point, Real};

/// A triangle as the integral takes it.
#[derive(Debug, Clone)]
pub(super) struct Patch {
    pub(super) corners: [DVec3; 3],
    pub(super) normal: DVec3,
    pub(super) area: f64,
    /// Along each edge, of length 1, and its length; and out of the triangle across the edge.
    along: [DVec3; 3],
    lengths: [f64; 3],
    outward: [DVec3; 3],
}

/// A triangle with less than this of the square of its longest edge, as twice its area, has no plane: so coarse is the rounding of its
/// corners.
const FLATTEST: f64 = 1e-6;
/// Where a point beside the triangle is so many times as far from it as from its plane, terms of the closed form cancel.
const BESIDE: f64 = 30.0;

impl Patch {
    /// `None` where the triangle has no plane.
    pub(super) fn of(corners: [DVec3; 3]) -> Option<Self> {
        let edges: [DVec3; 3] = std::array::from_fn(|k| corners[(k + 1) % 3] - corners[k]);
        let double = edges[0].cross(edges[1]);
        let longest = edges.map(|edge| edge.length_squared()).into_iter().fold(0.0, f64::max);
        let is_flat = double.length() <= FLATTEST * longest;
        if is_flat {
            return None;
        }
        let normal = double.normalize();
        let along = edges.map(|edge| edge.normalize());
        let outward = along.map(|along| along.cross(normal));
        let lengths = edges.map(|edge| edge.length());
        Some(Self { corners, normal, area: 0.5 * double.length(), along, lengths, outward })
    }

    /// `integral of 1 / (|x - p|^2 + squared)^2` over the triangle, for a `squared` above 0.
    ///
    /// With `h` the height of `x` over the plane and `a^2 = h^2 + squared`, the plane integral in polar coordinates round the foot of `x`
    /// leaves one integral along each edge: of `d / (2 a^2 (a^2 + d^2 + t^2)) dt`, with `d` the distance of the edge's line from the
    /// foot, above 0 where the foot is inside. That is an arc tangent.
    pub(super) fn integral<R: Real>(&self, x: Point<R>, squared: f64) -> R {
        let height = x.minus(self.corners[0]).dot(self.normal);
        let raised = height * height + R::of(squared);
        let edges: [Edge<R>; 3] = std::array::from_fn(|k| {
            let from = x.minus(self.corners[k]);
            let start = R::of(0.0) - from.dot(self.along[k]);
            let distance = R::of(0.0) - from.dot(self.outward[k]);
            Edge { distance, start, end: start + R::of(self.lengths[k]) }
        });
        let is_outside = edges.iter().any(|edge| edge.distance.value() < 0.0);
        let sum = |part: &dyn Fn(&Edge<R>) -> R| part(&edges[0]) + part(&edges[1]) + part(&edges[2]);
        if is_outside && raised.value() * (BESIDE * BESIDE) < nearest_squared(&edges) {
            return R::of(0.0) - sum(&|edge| edge.beside(raised)).times(0.5);
        }
        sum(&|edge| edge.closed(raised)) * raised.times(2.0).inverse()
    }
}

/// An edge seen from the foot of a point: how far its line is, above 0 inside, and from where to where it goes.
struct Edge<R> {
    distance: R,
    start: R,
    end: R,
}

impl<R: Real> Edge<R> {
    /// The integral of `d / (a^2 + d^2 + t^2)`.
    fn closed(&self, raised: R) -> R {
        let s = (raised + self.distance * self.distance).sqrt();
        let angle = (s * (self.end - self.start)).angle(s * s + self.start * self.end);
        self.distance * s.inverse() * angle
    }

    /// The integral of `d / ((d^2 + t^2) (a^2 + d^2 + t^2))`: what is left of the closed form where its first terms cancel, because the
    /// foot sees the edges from outside and their angles sum to zero. Smooth, for the foot is far from the edge beside `a`.
    fn beside(&self, raised: R) -> R {
        let Self { distance: d, start, end } = *self;
        let (low, high) = (start.value(), end.value());
        let nearest = low.abs().min(high.abs());
        if low * high > 0.0 && d.value().abs() < nearest {
            // With t = 1 / w.
            let (from, to) = (end.inverse(), start.inverse());
            let dd = d * d;
            return d * by_gauss(from, to, |w| {
                let ww = w * w;
                let one = R::of(1.0);
                ww * ((one + dd * ww) * (one + (dd + raised) * ww)).inverse()
            });
        }
        // With t = d tan(angle).
        let side = R::of(if d.value() < 0.0 { -1.0 } else { 1.0 });
        let away = d * side;
        by_gauss(start.angle(away), end.angle(away), |angle| {
            let cosine = angle.cos();
            let squared = cosine * cosine;
            squared * (raised * squared + d * d).inverse()
        }) * side
    }
}

fn nearest_squared<R: Real>(edges: &[Edge<R>; 3]) -> f64 {
    let squared = |edge: &Edge<R>| {
        let beyond = edge.start.value().max(-edge.end.value()).max(0.0);
        let distance = edge.distance.value();
        distance * distance + beyond * beyond
    };
    edges.iter().map(squared).fold(f64::INFINITY, f64::min)
}

/// Gauss and Legendre's rule of ten points, half of it: places and weights.
const GAUSS: [(f64, f64); 5] = [
    (0.148_874_338_981_631_2, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];

fn by_gauss<R: Real>(from: R, to: R, f: impl Fn(R) -> R) -> R {
    let (middle, half) = ((from + to).times(0.5), (to - from).times(0.5));
    let pairs = GAUSS.map(|(place, weight)| {
        let step = half.times(place);
        (f(middle - step) + f(middle + step)).times(weight)
    });
    pairs.into_iter().fold(R::of(0.0), |sum, pair| sum + pair) * half
}
