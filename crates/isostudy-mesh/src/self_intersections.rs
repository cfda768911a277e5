//! Pairs of triangles that pass through each other.

mod exact;
mod pair;

use glam::Vec3;

use self::pair::{has_area, meet_beyond_what_they_share};
use crate::{MeshError, TriangleMesh, used_vertices};

/// How many pairs of triangles of a mesh have a point in common that is no common vertex and lies on no common side. Touching counts: a
/// vertex that lies in another triangle, two triangles that lie on each other.
///
/// Vertices at one place count as one, whatever their numbers are. Triangles without area meet nothing. The answer is exact: signs of
/// volumes and areas are computed with as many digits as they need (Shewchuk 1997).
///
/// Takes O(n log n) where triangles are about equally large: a second or two for a million of them.
///
/// # Errors
/// As [`used_vertices`].
pub fn self_intersections(mesh: &TriangleMesh) -> Result<u64, MeshError> {
    used_vertices(mesh)?;
    let corners: Vec<[Vec3; 3]> =
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).filter(|corners| has_area(*corners)).collect();
    if corners.is_empty() {
        return Ok(0);
    }
    let tree = Tree::of(&corners);
    Ok(tree.pairs_within(&corners, 0))
}

/// A box along the axes.
#[derive(Debug, Clone, Copy)]
struct Around {
    low: Vec3,
    high: Vec3,
}

impl Around {
    fn of(triangles: impl Iterator<Item = [Vec3; 3]>) -> Self {
        let nothing = Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };
        triangles.flatten().fold(nothing, |of, p| Self { low: of.low.min(p), high: of.high.max(p) })
    }

    fn meets(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }
}

/// The most triangles that are not divided any further.
const LEAF: usize = 4;

/// A node of a tree: its triangles, and its two halves, the first right after it.
#[derive(Debug)]
struct Node {
    around: Around,
    members: std::ops::Range<usize>,
    /// The node of the second half; none in a leaf.
    second: Option<usize>,
}

/// Triangles by halves, apart along the longest axis of their box.
struct Tree {
    nodes: Vec<Node>,
    members: Vec<u32>,
}

impl Tree {
    fn of(corners: &[[Vec3; 3]]) -> Self {
        let members = (0..corners.len() as u32).collect();
        let mut tree = Self { nodes: Vec::new(), members };
        tree.add(corners, 0..corners.len());
        tree
    }

    fn add(&mut self, corners: &[[Vec3; 3]], members: std::ops::Range<usize>) -> usize {
        let own = &mut self.members[members.clone()];
        let around = Around::of(own.iter().map(|&t| corners[t as usize]));
        let axis = (around.high - around.low).max_position();
        let number = self.nodes.len();
        self.nodes.push(Node { around, members: members.clone(), second: None });
        if members.len() > LEAF {
            let key = |t: u32| corners[t as usize].iter().map(|p| p[axis]).sum::<f32>();
            let half = members.len() / 2;
            own.select_nth_unstable_by(half, |&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
            let middle = members.start + half;
            self.add(corners, members.start..middle);
            self.nodes[number].second = Some(self.add(corners, middle..members.end));
        }
        number
    }

    /// Pairs of triangles of one node.
    fn pairs_within(&self, corners: &[[Vec3; 3]], number: usize) -> u64 {
        let node = &self.nodes[number];
        if let Some(second) = node.second {
            let first = number + 1;
            return self.pairs_within(corners, first)
                + self.pairs_within(corners, second)
                + self.pairs_between(corners, first, second);
        }
        let own = &self.members[node.members.clone()];
        let with_later = |(i, a): (usize, &u32)| meeting(corners, &[*a], &own[i + 1..]);
        own.iter().enumerate().map(with_later).sum()
    }

    /// Pairs of a triangle of one node and one of another.
    fn pairs_between(&self, corners: &[[Vec3; 3]], a: usize, b: usize) -> u64 {
        let [of_a, of_b] = [a, b].map(|number| &self.nodes[number]);
        if !of_a.around.meets(&of_b.around) {
            return 0;
        }
        match (of_a.second, of_b.second) {
            (None, None) => {
                let [of_a, of_b] = [of_a, of_b].map(|node| &self.members[node.members.clone()]);
                meeting(corners, of_a, of_b)
            }
            // The one with more triangles is divided.
            (Some(second), _) if of_b.second.is_none() || of_a.members.len() >= of_b.members.len() => {
                self.pairs_between(corners, a + 1, b) + self.pairs_between(corners, second, b)
            }
            (_, Some(second)) => {
                self.pairs_between(corners, a, b + 1) + self.pairs_between(corners, a, second)
            }
            (Some(_), None) => unreachable!("a node that is divided beside one that is not is divided first"),
        }
    }
}

/// How many triangles of one set meet one of another.
fn meeting(corners: &[[Vec3; 3]], of_a: &[u32], of_b: &[u32]) -> u64 {
    let mut count = 0;
    for &a in of_a {
        let a = corners[a as usize];
        let around = Around::of([a].into_iter());
        for &b in of_b {
            let b = corners[b as usize];
            if around.meets(&Around::of([b].into_iter())) {
                count += u64::from(meet_beyond_what_they_share(a, b));
            }
        }
    }
    count
}
