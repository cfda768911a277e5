//! The weighted sums over all patches: near ones by their integrals, far ones by the moments of whole boxes.

use glam::DVec3;

use super::patch::Patch;
use super::real::{Point, Real};

/// Patches in a leaf.
const LEAF: usize = 4;
/// How large the ball round a group of patches may be, beside its distance, for its moments to stand for it.
const OPENING: f64 = 0.25;

/// Sums over patches: of the weight's integral, and of that times the signed distance to the patch's plane.
#[derive(Clone, Copy)]
pub(super) struct Sums<R> {
    pub(super) weights: R,
    pub(super) distances: R,
}

/// Patches, in boxes that are cut in halves.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    patches: Vec<Patch>,
    /// A group, then those of its first half, then those of its second.
    groups: Vec<Group>,
}

/// Some patches, and their moments about their centre.
#[derive(Debug, Clone)]
struct Group {
    /// The mean place of their area.
    centre: DVec3,
    /// Within this lie all corners.
    radius: f64,
    area: f64,
    /// Sums of area times normal, and of area times the plane's height over the centre.
    normal: DVec3,
    height: f64,
    /// Sums of `q n^T` and of `q` times that height, with `q` the area's first moment: by rows of `q`.
    turned: [DVec3; 3],
    raised: DVec3,
    /// Second moment of the area.
    spread: [DVec3; 3],
    patches: std::ops::Range<usize>,
    /// The group that comes after all within this one.
    next: usize,
}

impl Tree {
    pub(super) fn new(mut patches: Vec<Patch>) -> Self {
        let mut groups = Vec::new();
        let many = patches.len();
        group(&mut patches, 0..many, &mut groups);
        Self { patches, groups }
    }

    pub(super) fn sums<R: Real>(&self, x: Point<R>, squared: f64) -> Sums<R> {
        let mut sums = Sums { weights: R::of(0.0), distances: R::of(0.0) };
        let mut at = 0;
        while let Some(group) = self.groups.get(at) {
            let away = x.minus(group.centre);
            if group.radius * group.radius < OPENING * OPENING * away.value().length_squared() {
                sums.add(group.moments(away, squared));
                at = group.next;
                continue;
            }
            at += 1;
            if at == group.next {
                for patch in &self.patches[group.patches.clone()] {
                    sums.add(of_patch(patch, x, squared));
                }
            }
        }
        sums
    }

    /// The same without moments.
    #[cfg(test)]
    pub(super) fn sums_of_all<R: Real>(&self, x: Point<R>, squared: f64) -> Sums<R> {
        let mut sums = Sums { weights: R::of(0.0), distances: R::of(0.0) };
        self.patches.iter().for_each(|patch| sums.add(of_patch(patch, x, squared)));
        sums
    }
}

impl<R: Real> Sums<R> {
    fn add(&mut self, other: Self) {
        self.weights = self.weights + other.weights;
        self.distances = self.distances + other.distances;
    }
}

fn of_patch<R: Real>(patch: &Patch, x: Point<R>, squared: f64) -> Sums<R> {
    let weights = patch.integral(x, squared);
    Sums { weights, distances: weights * x.minus(patch.corners[0]).dot(patch.normal) }
}

fn group(patches: &mut [Patch], range: std::ops::Range<usize>, groups: &mut Vec<Group>) {
    let part = &mut patches[range.clone()];
    let number = groups.len();
    groups.push(Group::of(part, range.clone()));
    if part.len() > LEAF {
        let centres = part.iter().map(centre);
        let (low, high) =
            centres.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let size = high - low;
        let axis = (0..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
        // Stable, so that the order of the file decides between equals.
        part.sort_by(|a, b| centre(a)[axis].total_cmp(&centre(b)[axis]));
        let middle = range.start + part.len() / 2;
        group(patches, range.start..middle, groups);
        group(patches, middle..range.end, groups);
    }
    groups[number].next = groups.len();
}

fn centre(patch: &Patch) -> DVec3 {
    (patch.corners[0] + patch.corners[1] + patch.corners[2]) / 3.0
}

impl Group {
    fn of(part: &[Patch], patches: std::ops::Range<usize>) -> Self {
        let area: f64 = part.iter().map(|patch| patch.area).sum();
        let about = part.iter().map(|patch| patch.area / area * centre(patch)).sum::<DVec3>();
        let corners = part.iter().flat_map(|patch| patch.corners);
        let radius = corners.map(|corner| corner.distance(about)).fold(0.0, f64::max);
        let mut group = Self {
            centre: about,
            radius,
            area,
            normal: DVec3::ZERO,
            height: 0.0,
            turned: [DVec3::ZERO; 3],
            raised: DVec3::ZERO,
            spread: [DVec3::ZERO; 3],
            patches,
            next: 0,
        };
        for patch in part {
            let height = patch.normal.dot(patch.corners[0] - about);
            let first = patch.area * (centre(patch) - about);
            group.normal += patch.area * patch.normal;
            group.height += patch.area * height;
            group.raised += height * first;
            let corners = patch.corners.map(|corner| corner - about);
            let sum = corners[0] + corners[1] + corners[2];
            for k in 0..3 {
                group.turned[k] += first[k] * patch.normal;
                let of_corners: DVec3 = corners.iter().map(|corner| corner[k] * *corner).sum();
                group.spread[k] += patch.area / 12.0 * (of_corners + sum[k] * sum);
            }
        }
        group
    }

    /// The sums from far away. The weight is expanded to second order about the centre, where its first order vanishes; with distances, the
    /// second order is as if they had nothing to do with places.
    fn moments<R: Real>(&self, away: Point<R>, squared: f64) -> Sums<R> {
        let inverse = (away.square() + R::of(squared)).inverse();
        let weight = inverse * inverse;
        let trace = self.spread[0].x + self.spread[1].y + self.spread[2].z;
        let second = away.form(&self.spread).times(12.0) * inverse * inverse - inverse.times(2.0 * trace);
        let distance = away.dot(self.normal) - R::of(self.height);
        let first = (away.form(&self.turned) - away.dot(self.raised)).times(4.0) * inverse;
        let factor = R::of(1.0) + second.times(1.0 / self.area);
        Sums { weights: weight * factor.times(self.area), distances: weight * (distance * factor + first) }
    }
}
