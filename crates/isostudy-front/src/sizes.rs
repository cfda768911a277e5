//! How long edges are, place by place.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;
use isostudy_mesh::Bounds;

use crate::probe::{Foot, Probe};
use crate::samples::Samples;

/// By how much lengths may grow along a way, as a share of it.
const GROWTH: f64 = 0.35;

/// The length of edges: that of the settings, and less round places that were repaired.
pub(crate) struct Sizes {
    edge: f64,
    guide: Option<Guide>,
    finer: Vec<Finer>,
}

/// A ball with shorter edges.
struct Finer {
    centre: DVec3,
    radius: f64,
    edge: f64,
}

impl Sizes {
    pub(crate) fn new(edge: f64, guide: Option<Guide>) -> Self {
        Self { edge, guide, finer: Vec::new() }
    }

    pub(crate) fn at(&self, p: DVec3) -> f64 {
        let start = self.guide.as_ref().map_or(self.edge, |guide| guide.at(p));
        self.finer.iter().fold(start, |size, ball| {
            size.min(ball.edge + GROWTH * (p.distance(ball.centre) - ball.radius).max(0.0))
        })
    }

    /// Halves the length round a place that extends so far. What it is now.
    pub(crate) fn halve(&mut self, centre: DVec3, extent: f64) -> f64 {
        let edge = 0.5 * self.at(centre);
        self.finer.push(Finer { centre, radius: extent + 4.0 * edge, edge });
        edge
    }
}

/// Lengths at the points of a grid, interpolated.
pub(crate) struct Guide {
    min: DVec3,
    spacing: DVec3,
    counts: [usize; 3],
    lengths: Vec<f64>,
}

impl Guide {
    /// Where edges of the samples' grid cross the surface, curvature is measured. From there lengths grow with the distance.
    pub(crate) fn of(
        samples: &Samples,
        probe: &Probe<'_>,
        bounds: Bounds,
        edge: f64,
        smallest: f64,
        angle: f64,
    ) -> Self {
        let mut lengths = vec![edge; samples.counts.iter().product()];
        let mut waiting = BinaryHeap::new();
        for crossing in samples.crossings() {
            // What cannot be measured is an error of the front when it gets there.
            let Ok(foot) = probe.between(crossing.inside, crossing.outside) else { continue };
            let curvature = curvature(probe, foot, 0.25 * smallest);
            let length = (angle / curvature.max(1e-12)).clamp(smallest, edge);
            for i in crossing.ends {
                if length < lengths[i] {
                    lengths[i] = length;
                    waiting.push((Reverse(length.to_bits()), i));
                }
            }
        }
        let guide =
            Self { min: bounds.min.as_dvec3(), spacing: samples.spacing, counts: samples.counts, lengths };
        guide.spread(waiting)
    }

    fn spread(mut self, mut waiting: BinaryHeap<(Reverse<u64>, usize)>) -> Self {
        let strides = [1, self.counts[0], self.counts[0] * self.counts[1]];
        while let Some((Reverse(bits), i)) = waiting.pop() {
            if self.lengths[i].to_bits() != bits {
                continue;
            }
            for (axis, stride) in strides.into_iter().enumerate() {
                let at = i / stride % self.counts[axis];
                let there = self.lengths[i] + GROWTH * self.spacing[axis];
                let before = (at > 0).then(|| i - stride);
                let after = (at + 1 < self.counts[axis]).then(|| i + stride);
                for j in before.into_iter().chain(after) {
                    if there < self.lengths[j] {
                        self.lengths[j] = there;
                        waiting.push((Reverse(there.to_bits()), j));
                    }
                }
            }
        }
        self
    }

    fn at(&self, p: DVec3) -> f64 {
        let at = ((p - self.min) / self.spacing).to_array();
        let low = [0, 1, 2].map(|axis| (at[axis].max(0.0) as usize).min(self.counts[axis] - 2));
        let share = [0, 1, 2].map(|axis| (at[axis] - low[axis] as f64).clamp(0.0, 1.0));
        let corner = |bits: usize| {
            let [x, y, z] = [0, 1, 2].map(|axis| low[axis] + (bits >> axis & 1));
            let weight = |axis: usize| if bits >> axis & 1 == 1 { share[axis] } else { 1.0 - share[axis] };
            weight(0) * weight(1) * weight(2) * self.lengths[(z * self.counts[1] + y) * self.counts[0] + x]
        };
        (0..8).map(corner).sum()
    }
}

/// The greater of the two principal curvatures, without sign: how the normal turns along two directions of the tangent plane.
fn curvature(probe: &Probe<'_>, foot: Foot, step: f64) -> f64 {
    let u = foot.normal.any_orthonormal_vector();
    let v = foot.normal.cross(u);
    let turned = |along: DVec3| {
        let [before, after] = [-step, step].map(|way| probe.normal(foot.place + along * way));
        Some((after.ok()? - before.ok()?) / (2.0 * step))
    };
    let (Some(by_u), Some(by_v)) = (turned(u), turned(v)) else { return f64::INFINITY };
    let (uu, vv, uv) = (by_u.dot(u), by_v.dot(v), 0.5 * (by_u.dot(v) + by_v.dot(u)));
    let (mean, spread) = (0.5 * (uu + vv), (0.25 * (uu - vv).powi(2) + uv * uv).sqrt());
    mean.abs() + spread
}
