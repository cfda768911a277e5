//! The equations of a spline's centres, and their solution.

use glam::DVec3;

use super::cholesky::{BLOCK, Cholesky};
use super::reduced::{Anchors, Reduced};
use super::{FitSettings, Kernel, Polyharmonic};

/// The equations of the centres so far.
pub(super) struct System<'a> {
    pub(super) points: &'a [DVec3],
    pub(super) values: &'a [f64],
    kernel: Kernel,
    smoothing: f64,
    anchors: Anchors,
    /// Which points are centres, the anchors aside, and what the reduced kernel takes of them.
    centres: Vec<usize>,
    reduced: Vec<Reduced>,
    factor: Cholesky,
    /// Of the centres, then of the anchors.
    weights: Vec<f64>,
    anchor_weights: [f64; 4],
    linear: (DVec3, f64, DVec3),
}

impl<'a> System<'a> {
    pub(super) fn new(
        points: &'a [DVec3],
        values: &'a [f64],
        settings: &FitSettings,
        anchors: Anchors,
    ) -> Self {
        let linear = anchors.linear(anchors.points.map(|i| values[i]));
        let mut factor = Cholesky::default();
        factor.reserve(points.len().min(settings.most_centres));
        Self {
            points,
            values,
            kernel: settings.kernel,
            smoothing: settings.smoothing,
            anchors,
            centres: Vec::new(),
            reduced: Vec::new(),
            factor,
            weights: Vec::new(),
            anchor_weights: [0.0; 4],
            linear,
        }
    }

    /// How many points are centres.
    pub(super) fn len(&self) -> usize {
        self.factor.len() + 4
    }

    pub(super) fn is_anchor(&self, point: usize) -> bool {
        self.anchors.points.contains(&point)
    }

    /// Makes points centres. Anchors are passed over: they are already.
    pub(super) fn append(&mut self, chosen: &[usize]) {
        let chosen: Vec<usize> = chosen.iter().copied().filter(|&i| !self.is_anchor(i)).collect();
        for block in chosen.chunks(BLOCK) {
            let new: Vec<Reduced> =
                block.iter().map(|&i| self.anchors.reduce(self.points[i], self.kernel)).collect();
            let mut rows: [Vec<f64>; BLOCK] = std::array::from_fn(|b| {
                let mut row = Vec::with_capacity(self.reduced.len() + BLOCK);
                if let Some(point) = new.get(b) {
                    row.extend(
                        self.reduced.iter().chain(&new[..=b]).map(|other| point.with(other, self.kernel)),
                    );
                    *row.last_mut().expect("itself") += self.smoothing;
                }
                row.resize(self.reduced.len() + BLOCK, 0.0);
                row
            });
            let taken = self.factor.append(&mut rows, block.len());
            for (b, &point) in block.iter().enumerate().filter(|(b, _)| taken[*b]) {
                self.centres.push(point);
                self.reduced.push(new[b]);
            }
        }
    }

    /// Weights and polynomial for the centres so far.
    pub(super) fn solve(&mut self) {
        self.weights = vec![0.0; self.centres.len()];
        self.anchor_weights = [0.0; 4];
        self.linear = self.anchors.linear(self.anchors.points.map(|i| self.values[i]));
        self.refine();
    }

    /// Solves once more for what is left at the centres.
    pub(super) fn refine(&mut self) {
        let left = |i: usize, weight: f64, spline: &Polyharmonic| {
            self.values[i] - spline.value(self.points[i]) - self.smoothing * weight
        };
        let spline = self.spline();
        let at_anchors: [f64; 4] =
            std::array::from_fn(|j| left(self.anchors.points[j], self.anchor_weights[j], &spline));
        let right = (0..self.centres.len()).map(|k| {
            let by_anchors: f64 = (0..4).map(|j| self.reduced[k].shares[j] * at_anchors[j]).sum();
            left(self.centres[k], self.weights[k], &spline) - by_anchors
        });
        let change = self.factor.solve(right.collect());
        for (k, change) in change.iter().enumerate() {
            self.weights[k] += change;
            (0..4).for_each(|j| self.anchor_weights[j] -= self.reduced[k].shares[j] * change);
        }
        // The polynomial is what the kernels leave at the anchors.
        self.linear = (DVec3::ZERO, 0.0, DVec3::ZERO);
        let spline = self.spline();
        let rest = std::array::from_fn(|j| {
            let i = self.anchors.points[j];
            self.values[i] - spline.value(self.points[i]) - self.smoothing * self.anchor_weights[j]
        });
        self.linear = self.anchors.linear(rest);
    }

    pub(super) fn spline(&self) -> Polyharmonic {
        let sign = match self.kernel {
            Kernel::Biharmonic => -1.0,
            Kernel::Triharmonic => 1.0,
        };
        let centres = || self.anchors.points.iter().chain(&self.centres).map(|&i| self.points[i]);
        let weights = self.anchor_weights.iter().chain(&self.weights);
        let (about, constant, slope) = self.linear;
        Polyharmonic {
            kernel: self.kernel,
            x: centres().map(|p| p.x).collect(),
            y: centres().map(|p| p.y).collect(),
            z: centres().map(|p| p.z).collect(),
            weights: weights.map(|weight| sign * weight).collect(),
            about,
            constant,
            slope,
        }
    }
}
