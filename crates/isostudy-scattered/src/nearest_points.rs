//! Which points are nearest to a place.

use glam::DVec3;

/// Points in a leaf, which are looked at one by one.
const LEAF: usize = 8;

/// A tree of points, cut in halves along the longest side of each box.
pub(crate) struct NearestPoints<'a> {
    points: &'a [DVec3],
    /// The points, leaf by leaf.
    order: Vec<u32>,
    /// Across which axis each box is cut, and where: the first box is 1, and the halves of the box `n` are `2 n` and `2 n + 1`.
    cuts: Vec<(u8, f64)>,
}

/// The nearest so far, the farthest of them last: squared distance and point.
struct Found {
    wanted: usize,
    nearest: Vec<(f64, u32)>,
}

impl<'a> NearestPoints<'a> {
    pub(crate) fn new(points: &'a [DVec3]) -> Self {
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let mut cuts = Vec::new();
        split(points, &mut order, 1, &mut cuts);
        Self { points, order, cuts }
    }

    /// Up to so many points, the nearest first; of those equally far, the ones that come first.
    pub(crate) fn nearest(&self, p: DVec3, wanted: usize) -> Vec<(f64, u32)> {
        let mut found = Found { wanted, nearest: Vec::with_capacity(wanted + 1) };
        self.look(p, &self.order, 1, &mut found);
        found.nearest
    }

    fn look(&self, p: DVec3, part: &[u32], number: usize, found: &mut Found) {
        if part.len() <= LEAF {
            for &i in part {
                found.take((p.distance_squared(self.points[i as usize]), i));
            }
            return;
        }
        let (axis, cut) = self.cuts[number];
        let away = p[usize::from(axis)] - cut;
        let (low, high) = part.split_at(part.len() / 2);
        let halves = [(low, 2 * number), (high, 2 * number + 1)];
        let [(near, near_number), (far, far_number)] =
            if away < 0.0 { halves } else { [halves[1], halves[0]] };
        self.look(p, near, near_number, found);
        if found.reaches(away * away) {
            self.look(p, far, far_number, found);
        }
    }
}

impl Found {
    fn reaches(&self, squared: f64) -> bool {
        self.nearest.len() < self.wanted || self.nearest.last().is_some_and(|last| squared <= last.0)
    }

    fn take(&mut self, new: (f64, u32)) {
        if self.nearest.len() == self.wanted && self.nearest.last().is_some_and(|last| *last <= new) {
            return;
        }
        let place = self.nearest.partition_point(|other| *other <= new);
        self.nearest.insert(place, new);
        self.nearest.truncate(self.wanted);
    }
}

fn split(points: &[DVec3], part: &mut [u32], number: usize, cuts: &mut Vec<(u8, f64)>) {
    if part.len() <= LEAF {
        return;
    }
    let (axis, middle) = (longest(points, part), part.len() / 2);
    let by =
        |a: &u32, b: &u32| points[*a as usize][axis].total_cmp(&points[*b as usize][axis]).then(a.cmp(b));
    part.select_nth_unstable_by(middle, by);
    cuts.resize(cuts.len().max(number + 1), (0, 0.0));
    cuts[number] = (axis as u8, points[part[middle] as usize][axis]);
    let (low, high) = part.split_at_mut(middle);
    split(points, low, 2 * number, cuts);
    split(points, high, 2 * number + 1, cuts);
}

/// The axis along which points reach farthest.
fn longest(points: &[DVec3], part: &[u32]) -> usize {
    let ends = part.iter().map(|&i| points[i as usize]);
    let (low, high) =
        ends.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let size = high - low;
    (0..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn the_nearest_are_those_of_a_search_of_all() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(1);
        // On a coarse grid, so that many are equally far.
        let mut place = || DVec3::from_array(std::array::from_fn(|_| f64::from(random.random_range(0..9))));
        let points: Vec<DVec3> = (0..500).map(|_| place()).collect();
        let tree = NearestPoints::new(&points);
        for _ in 0..200 {
            let p = place() * 1.1;
            let mut all: Vec<(f64, u32)> =
                points.iter().enumerate().map(|(i, q)| (p.distance_squared(*q), i as u32)).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            assert_eq!(tree.nearest(p, 13), all[..13]);
        }
        assert_eq!(NearestPoints::new(&points[..5]).nearest(DVec3::ZERO, 9).len(), 5);
    }
}
