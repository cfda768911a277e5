//! The nearest of many triangles: a tree of turned boxes, four children a node, four triangles a leaf.
//!
//! Everything is done four at a time in the lanes of a [`Vec4`]. The tree is built once by halving at the median,
//! so its depth is bounded and the traversal needs no heap. Bounds are kept on the safe side of rounding, so what
//! is passed over could not have been nearer: the result is that of a search through all leaves, to the bit.

use glam::{DVec3, Vec3, Vec4};

use crate::closest_point::closest_point;

/// Marks a child that is a leaf; the rest of the number is its place in `leaves`.
const LEAF: u32 = 1 << 31;
/// Four to a node, at most 17 levels over 2^32 triangles, three waiting a level.
const STACK: usize = 64;
/// A little less than one, by more than the rounding of a bound (about ten operations of 6e-8 each).
const SAFE: f32 = 1.0 - 2e-6;

/// A vector in each of four lanes.
#[derive(Debug, Clone, Copy)]
struct Lanes {
    x: Vec4,
    y: Vec4,
    z: Vec4,
}

impl Lanes {
    fn splat(p: Vec3) -> Self {
        Self { x: Vec4::splat(p.x), y: Vec4::splat(p.y), z: Vec4::splat(p.z) }
    }

    fn of(lanes: [Vec3; 4]) -> Self {
        let along = |axis: usize| Vec4::from_array(lanes.map(|p| p[axis]));
        Self { x: along(0), y: along(1), z: along(2) }
    }

    #[inline]
    fn minus(self, o: Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }

    /// `self - t * o`
    #[inline]
    fn minus_scaled(self, t: Vec4, o: Self) -> Self {
        Self { x: self.x - t * o.x, y: self.y - t * o.y, z: self.z - t * o.z }
    }

    #[inline]
    fn dot(self, o: Self) -> Vec4 {
        self.x * o.x + self.y * o.y + self.z * o.z
    }
}

/// Four patches of surface and what is in them. Each lies in a box turned as the patch is: `half` to both sides of
/// `centre` along each of `axes`.
///
/// Boxes along the coordinates' axes were tried and lost: a patch askew to them is as thick in its box as it is wide.
/// Absent children reach minus infinity to both sides, which puts them infinitely far away.
#[derive(Debug, Clone)]
struct Node {
    centre: Lanes,
    axes: [Lanes; 3],
    half: [Vec4; 3],
    children: [u32; 4],
}

impl Node {
    fn new(patches: [Patch; 4], children: [u32; 4]) -> Self {
        Self {
            centre: Lanes::of(patches.map(|p| p.centre)),
            axes: std::array::from_fn(|k| Lanes::of(patches.map(|p| p.axes[k]))),
            half: std::array::from_fn(|k| Vec4::from_array(patches.map(|p| p.half[k]))),
            children,
        }
    }

    /// A bound from below for the squared distance to each patch.
    #[inline]
    fn squared_bounds(&self, p: Lanes) -> Vec4 {
        let from_centre = p.minus(self.centre);
        let beside = |k: usize| {
            let over = (self.axes[k].dot(from_centre).abs() - self.half[k]).max(Vec4::ZERO);
            over * over
        };
        (beside(0) + beside(1) + beside(2)) * SAFE
    }
}

/// The turned box around some triangles, computed in double precision for the centre and axes as rounded.
#[derive(Clone, Copy)]
struct Patch {
    centre: Vec3,
    /// Across the patch, along it where it is longest, and along it where it is not.
    axes: [Vec3; 3],
    half: [f32; 3],
}

impl Patch {
    const ABSENT: Self = Self { centre: Vec3::ZERO, axes: [Vec3::Z; 3], half: [f32::NEG_INFINITY; 3] };

    fn around(triangles: &[[Vec3; 3]], members: &[u32]) -> Self {
        let corners = || members.iter().map(|&t| triangles[t as usize].map(|p| p.as_dvec3()));
        let mean = corners().flatten().sum::<DVec3>() / (3 * members.len()) as f64;
        let facing: DVec3 = corners().map(|[a, b, c]| (b - a).cross(c - a)).sum();
        let across = facing.normalize_or(DVec3::Z);
        let (u, v) = across.any_orthonormal_pair();
        // In the plane of the patch, the direction in which its corners spread most.
        let (difference, product) = corners()
            .flatten()
            .map(|p| (u.dot(p - mean), v.dot(p - mean)))
            .fold((0.0, 0.0), |(d, uv), (x, y)| (d + x * x - y * y, uv + x * y));
        let (sin, cos) = (0.5 * (2.0 * product).atan2(difference)).sin_cos();
        let axes = [across, u * cos + v * sin, v * cos - u * sin].map(|axis| axis.as_vec3());

        let range = |axis: DVec3, from: DVec3| {
            let along = corners().flatten().map(|p| axis.dot(p - from));
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
        };
        let units = axes.map(|axis| axis.as_dvec3());
        let to_middle = units.map(|axis| {
            let (low, high) = range(axis, mean);
            axis * (low + high) * 0.5
        });
        let centre = (mean + to_middle.into_iter().sum::<DVec3>()).as_vec3();
        let half = units.map(|axis| {
            let (low, high) = range(axis, centre.as_dvec3());
            high.max(-low)
        });
        let slack = half.iter().sum::<f64>() * f64::from(1.0 - SAFE);
        Self { centre, axes, half: half.map(|half| (half + slack) as f32) }
    }
}

/// Four triangles `a`, `a + ab`, `a + ac`, with what depends on them only. Inverses of zero are zero.
#[derive(Debug, Clone)]
struct Leaf {
    a: Lanes,
    ab: Lanes,
    ac: Lanes,
    ab_ab: Vec4,
    ac_ac: Vec4,
    ab_ac: Vec4,
    per_ab_ab: Vec4,
    per_ac_ac: Vec4,
    per_bc_bc: Vec4,
    per_determinant: Vec4,
}

impl Leaf {
    /// Spare lanes repeat the first triangle.
    fn new(triangles: &[[Vec3; 3]], members: &[u32]) -> Self {
        let lane = |k: usize| triangles[members[if k < members.len() { k } else { 0 }] as usize];
        let corner = |i: usize| Lanes::of(std::array::from_fn(|k| lane(k)[i]));
        let a = corner(0);
        let (ab, ac) = (corner(1).minus(a), corner(2).minus(a));
        let (ab_ab, ac_ac, ab_ac) = (ab.dot(ab), ac.dot(ac), ab.dot(ac));
        let bc = ac.minus(ab);
        let inverse = |v: Vec4| Vec4::from_array(v.to_array().map(|v| if v > 0.0 { 1.0 / v } else { 0.0 }));
        Self {
            a,
            ab,
            ac,
            ab_ab,
            ac_ac,
            ab_ac,
            per_ab_ab: inverse(ab_ab),
            per_ac_ac: inverse(ac_ac),
            per_bc_bc: inverse(bc.dot(bc)),
            per_determinant: inverse(ab_ab * ac_ac - ab_ac * ab_ac),
        }
    }

    /// Squared distance to the nearest of the four.
    ///
    /// The candidates are the nearest points of the three edges and, where it falls inside, the foot of the
    /// perpendicular. Each is a point of the triangle, so rounding in a sliver costs accuracy of the order of its
    /// width and no more.
    #[inline]
    fn squared_distance(&self, p: Lanes) -> f32 {
        let ap = p.minus(self.a);
        let (d1, d2) = (self.ab.dot(ap), self.ac.dot(ap));
        let unit = |t: Vec4| t.max(Vec4::ZERO).min(Vec4::ONE);
        let squared = |v: Lanes| v.dot(v);

        let on_ab = squared(ap.minus_scaled(unit(d1 * self.per_ab_ab), self.ab));
        let on_ac = squared(ap.minus_scaled(unit(d2 * self.per_ac_ac), self.ac));
        let bp = ap.minus(self.ab);
        let bc = self.ac.minus(self.ab);
        let on_bc = squared(bp.minus_scaled(unit(bc.dot(bp) * self.per_bc_bc), bc));
        let on_edges = on_ab.min(on_ac).min(on_bc);

        let v = (self.ac_ac * d1 - self.ab_ac * d2) * self.per_determinant;
        let w = (self.ab_ab * d2 - self.ab_ac * d1) * self.per_determinant;
        let foot = squared(ap.minus_scaled(v, self.ab).minus_scaled(w, self.ac));
        let inside = v.cmpge(Vec4::ZERO) & w.cmpge(Vec4::ZERO) & (v + w).cmple(Vec4::ONE);
        Vec4::select(inside, foot.min(on_edges), on_edges).min_element()
    }
}

/// A bounding volume hierarchy over triangles that finds the nearest of them, whatever their topology. A triangle
/// without area is the segment or the point it covers.
///
/// Building takes O(n log n) and gives the same tree every time; it holds about 200 bytes a triangle. A search gives
/// the same answer, to the bit, as a look at every triangle.
#[derive(Debug, Clone)]
pub struct NearestTriangles {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    /// The numbers of each leaf's triangles; spare places repeat the first.
    members: Vec<[u32; 4]>,
}

/// The nearest point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestPoint {
    /// The triangle it lies in.
    pub triangle: usize,
    /// Where it is.
    pub position: DVec3,
    /// How far it is.
    pub distance: f64,
}

impl NearestTriangles {
    /// The tree over `triangles`.
    ///
    /// # Panics
    /// If there are no triangles, or 2^31 and more.
    pub fn new(triangles: &[[Vec3; 3]]) -> Self {
        assert!(!triangles.is_empty() && triangles.len() < LEAF as usize, "{} triangles", triangles.len());
        let centres: Vec<Vec3> =
            triangles.iter().map(|&[a, b, c]| (a.min(b).min(c) + a.max(b).max(c)) * 0.5).collect();
        let mut members: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut tree = Self { nodes: Vec::new(), leaves: Vec::new(), members: Vec::new() };
        tree.node(triangles, &centres, &mut members);
        tree
    }

    fn node(&mut self, triangles: &[[Vec3; 3]], centres: &[Vec3], members: &mut [u32]) -> u32 {
        let at = self.nodes.len();
        self.nodes.push(Node::new([Patch::ABSENT; 4], [0; 4]));
        let (low, high) = halves(centres, members);
        let quarters = [low, high].map(|half| halves(centres, half)).map(|(a, b)| [a, b]);
        let (mut patches, mut children) = ([Patch::ABSENT; 4], [0; 4]);
        for (k, quarter) in quarters.into_iter().flatten().enumerate().filter(|(_, q)| !q.is_empty()) {
            patches[k] = Patch::around(triangles, quarter);
            children[k] = if quarter.len() <= 4 {
                self.leaves.push(Leaf::new(triangles, quarter));
                self.members.push(std::array::from_fn(|k| quarter[if k < quarter.len() { k } else { 0 }]));
                (self.leaves.len() as u32 - 1) | LEAF
            } else {
                self.node(triangles, centres, quarter)
            };
        }
        self.nodes[at] = Node::new(patches, children);
        at as u32
    }

    /// The distance from `p`, which must be finite, to the nearest triangle, in single precision: relative error of a
    /// few 1e-7 of the distance and the size of the nearest triangles. Coordinates must be small enough, at most 1e18,
    /// for their squares to be finite.
    pub fn distance(&self, p: Vec3) -> f32 {
        self.search::<true>(p, f32::INFINITY).0.sqrt()
    }

    /// The same to the bit, and quicker where it is thought to be below `limit` and where the nearest triangle is near that of
    /// another search: `from` is where that ended, any number at first, and then where this one did.
    pub fn distance_from(&self, p: Vec3, limit: f32, from: &mut u32) -> f32 {
        let begin = (*from).min(self.leaves.len() as u32 - 1);
        let known = self.leaves[begin as usize].squared_distance(Lanes::splat(p));
        let limit = known.min(limit * limit);
        let mut found = self.search::<false>(p, limit);
        if found.0 >= limit {
            // Nothing was nearer than the limit: it was too tight, or the nearest is where the search began.
            found = if known <= limit { (known, begin) } else { self.search::<true>(p, f32::INFINITY) };
        }
        *from = found.1;
        found.0.sqrt()
    }

    /// The nearest point to `p` of the triangles that the tree was built from, which `corners` gives by number; quicker
    /// where its distance is thought to be below `limit`.
    ///
    /// Position and distance are those of the triangle in double precision. Which triangle it is was decided in single
    /// precision: another may be nearer by a few 1e-7 of the coordinates of `p` and of the sizes of both triangles.
    pub fn nearest(&self, p: DVec3, limit: f64, corners: impl Fn(usize) -> [Vec3; 3]) -> NearestPoint {
        let (_, leaf) = self.search_within(p.as_vec3(), limit as f32);
        let candidate = |&t: &u32| {
            let position = closest_point(corners(t as usize).map(|corner| corner.as_dvec3()), p);
            NearestPoint { triangle: t as usize, position, distance: position.distance(p) }
        };
        let [first, rest @ ..] = &self.members[leaf as usize];
        rest.iter()
            .map(candidate)
            .fold(candidate(first), |best, next| if next.distance < best.distance { next } else { best })
    }

    /// The squared distance to the nearest triangle, and its leaf.
    fn search_within(&self, p: Vec3, limit: f32) -> (f32, u32) {
        let limit = limit * limit;
        let found = self.search::<true>(p, limit);
        // Nothing was nearer than the limit: it was too tight.
        if found.0 < limit { found } else { self.search::<true>(p, f32::INFINITY) }
    }

    /// The squared distance to the nearest triangle and its leaf, or `limit` if that is less.
    ///
    /// Going to the nearest child first finds a bound early where there is none. Where `limit` is close already, hardly
    /// a child is passed over for having waited, and `SORTED` costs more than it saves.
    fn search<const SORTED: bool>(&self, p: Vec3, limit: f32) -> (f32, u32) {
        let lanes = Lanes::splat(p);
        let (mut best, mut nearest) = (limit, 0);
        let mut waiting = [(0.0f32, 0u32); STACK];
        let mut top = 1; // the root waits
        while top > 0 {
            top -= 1;
            let (bound, child) = waiting[top];
            if bound >= best {
                continue;
            }
            if child & LEAF != 0 {
                let leaf = child & !LEAF;
                let squared = self.leaves[leaf as usize].squared_distance(lanes);
                // Which way it goes is hard to foretell: without a branch.
                nearest = if squared < best { leaf } else { nearest };
                best = best.min(squared);
                continue;
            }
            let node = &self.nodes[child as usize];
            let first = top;
            for (bound, child) in node.squared_bounds(lanes).to_array().into_iter().zip(node.children) {
                if !SORTED {
                    // Without a branch here too.
                    waiting[top] = (bound, child);
                    top += usize::from(bound < best);
                    continue;
                }
                if bound >= best {
                    continue;
                }
                // Insertion sort, the nearest on top.
                let mut slot = top;
                while slot > first && waiting[slot - 1].0 < bound {
                    waiting[slot] = waiting[slot - 1];
                    slot -= 1;
                }
                waiting[slot] = (bound, child);
                top += 1;
            }
        }
        (best, nearest)
    }
}

/// Two halves of `members`, apart along the axis on which their centres spread most; ties go by number, so that
/// the tree is the same every time. A handful stays together.
fn halves<'a>(centres: &[Vec3], members: &'a mut [u32]) -> (&'a mut [u32], &'a mut [u32]) {
    if members.len() <= 4 {
        return members.split_at_mut(members.len());
    }
    let spread = members.iter().map(|&t| centres[t as usize]);
    let (low, high) = spread.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
    let axis = (high - low).max_position();
    // A multiple of four to the left fills the leaves.
    let middle = (members.len() / 2).next_multiple_of(4);
    let key = |t: u32| centres[t as usize][axis];
    members.select_nth_unstable_by(middle, |&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
    members.split_at_mut(middle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point(size: f32) -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-size..size).prop_map(Vec3::from)
    }

    proptest! {
        /// Bounds may pass over what is farther, never what is nearer, not even in the last bit.
        #[test]
        fn the_tree_finds_what_a_search_through_all_leaves_finds(
            triangles in prop::collection::vec((point(1.0), point(0.1), point(0.1)), 1..120),
            points in prop::collection::vec(point(3.0), 20),
            on_triangles in prop::collection::vec((any::<prop::sample::Index>(), point(1e-4)), 20),
        ) {
            let triangles: Vec<_> = triangles.into_iter().map(|(a, u, v)| [a, a + u, a + v]).collect();
            let tree = NearestTriangles::new(&triangles);
            let near = on_triangles.iter().map(|(i, shift)| i.get(&triangles).iter().sum::<Vec3>() / 3.0 + *shift);
            let mut from = u32::MAX;
            for p in points.into_iter().chain(near) {
                let all = tree.leaves.iter().map(|leaf| leaf.squared_distance(Lanes::splat(p)));
                let want = all.fold(f32::INFINITY, f32::min).sqrt();
                prop_assert_eq!(tree.distance(p).to_bits(), want.to_bits());
                // Whatever is thought of the distance, and wherever the search before ended.
                for limit in [f32::INFINITY, 1.1 * want, want, 0.9 * want, 0.0] {
                    prop_assert_eq!(tree.distance_from(p, limit, &mut from).to_bits(), want.to_bits());
                }
            }
        }

        /// A triangle without area, or without length, is still where it is.
        #[test]
        fn slivers_and_points_are_found(a in point(1.0), u in point(1.0), t in 0.0..1.0f32, p in point(2.0)) {
            let to_point = NearestTriangles::new(&[[a; 3]]).distance(p);
            prop_assert!((to_point - p.distance(a)).abs() <= 1e-6 * (1.0 + to_point));
            let along = ((p - a).dot(u) / u.length_squared().max(1e-12)).clamp(0.0, 1.0);
            let to_segment = p.distance(a + u * along);
            let sliver = NearestTriangles::new(&[[a, a + u, a + u * t]]).distance(p);
            prop_assert!((sliver - to_segment).abs() <= 1e-5 * (1.0 + to_segment), "{sliver} {to_segment}");
        }
    }
}
