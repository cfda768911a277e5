//! The outlines of regions, without the vertices on their straight parts.

use super::regions::{Regions, across};
use crate::surface::{Surface, VertexKind};
use isostudy_mesh::glam::DVec3;
use std::collections::HashMap;

/// The outlines of all regions. What lies on both sides of an outline has the same vertices of it.
pub(crate) struct Outlines {
    /// Of each region, its outlines with the surface to the left, by the vertices that are left; `None` if one cannot be followed.
    loops: Vec<Option<Vec<Vec<u32>>>>,
}

impl Outlines {
    /// Follows all outlines, and takes out what lies within the tolerance of a straight line on them.
    pub(crate) fn of(
        surface: &Surface,
        regions: &Regions,
        kinds: &[VertexKind],
        is_kept: &[bool],
        tolerance: f64,
    ) -> Self {
        let followed: Vec<Option<Vec<Vec<u32>>>> = (0..regions.count())
            .map(|r| if is_kept[r] { None } else { follow(surface, regions, r) })
            .collect();
        let is_left = left_vertices(surface, regions, kinds, is_kept, tolerance);
        let thin = |all: Vec<Vec<u32>>| -> Vec<Vec<u32>> {
            all.into_iter().map(|of| of.into_iter().filter(|&v| is_left[v as usize]).collect()).collect()
        };
        Self { loops: followed.into_iter().map(|all| all.map(thin)).collect() }
    }

    /// The outlines of a region.
    pub(crate) fn loops(&self, r: usize) -> Option<Vec<Vec<u32>>> {
        self.loops[r].clone()
    }
}

/// Whether an edge of a triangle is a part of its region's outline.
fn is_outline(surface: &Surface, regions: &Regions, t: u32, u: u32, v: u32) -> bool {
    across(surface, u, v).is_none_or(|other| regions.of_triangle(other) != regions.of_triangle(t))
}

/// The outlines of a region: from each edge of it on, round its end within the region, to the next.
fn follow(surface: &Surface, regions: &Regions, r: usize) -> Option<Vec<Vec<u32>>> {
    let mut starts = Vec::new();
    let mut is_open: HashMap<[u32; 2], bool> = HashMap::new();
    for &t in regions.triangles(r) {
        let corners = surface.triangles[t as usize];
        for k in 0..3 {
            let [u, v] = [corners[k], corners[(k + 1) % 3]];
            if is_outline(surface, regions, t, u, v) {
                starts.push((t, [u, v]));
                is_open.insert([u, v], true);
            }
        }
    }
    let mut loops = Vec::new();
    for &(first, edge) in &starts {
        if !is_open[&edge] {
            continue;
        }
        let (mut found, mut t, mut at) = (Vec::new(), first, edge);
        while *is_open.get(&at)? {
            is_open.insert(at, false);
            found.push(at[0]);
            // Round the end, to the next edge of the outline.
            let [_, pivot] = at;
            let mut out = after(surface, t, pivot);
            while !is_outline(surface, regions, t, pivot, out) {
                t = across(surface, pivot, out)?;
                out = after(surface, t, pivot);
            }
            at = [pivot, out];
        }
        if at != edge {
            return None;
        }
        loops.push(found);
    }
    Some(loops)
}

/// The vertex that follows another in a triangle.
fn after(surface: &Surface, t: u32, v: u32) -> u32 {
    let corners = surface.triangles[t as usize];
    let k = corners.iter().position(|&w| w == v).expect("a corner");
    corners[(k + 1) % 3]
}

/// Which vertices of outlines are left: those where outlines meet, those of regions that are kept, and those that straight lines need.
fn left_vertices(
    surface: &Surface,
    regions: &Regions,
    kinds: &[VertexKind],
    is_kept: &[bool],
    tolerance: f64,
) -> Vec<bool> {
    let count = surface.positions.len();
    // The vertices that each is joined to by an edge of an outline.
    let mut joined: Vec<Vec<u32>> = vec![Vec::new(); count];
    let mut is_left = vec![false; count];
    for (t, &corners) in (0..).zip(&surface.triangles) {
        for k in 0..3 {
            let [u, v] = [corners[k], corners[(k + 1) % 3]];
            if is_outline(surface, regions, t, u, v) {
                joined[u as usize].push(v);
                joined[v as usize].push(u);
            }
        }
        if is_kept[regions.of_triangle(t) as usize] {
            corners.iter().for_each(|&v| is_left[v as usize] = true);
        }
    }
    for (v, of) in joined.iter_mut().enumerate() {
        of.sort_unstable();
        of.dedup();
        is_left[v] |= !matches!(of.len(), 0 | 2) || kinds[v] == VertexKind::Singular;
    }
    let chains = Chains { surface, joined: &joined, tolerance };
    let mut is_passed = vec![false; count];
    for v in 0..count as u32 {
        if is_left[v as usize] {
            for &next in &joined[v as usize] {
                let chain = chains.from(v, next, &is_left);
                chain.iter().for_each(|&w| is_passed[w as usize] = true);
                // Each chain is found from both of its ends.
                if (chain[0], chain[1]) <= (chain[chain.len() - 1], chain[chain.len() - 2]) {
                    chains.straighten(&chain, &mut is_left);
                }
            }
        }
    }
    // What is left are rings without a vertex where outlines meet.
    for v in 0..count as u32 {
        if joined[v as usize].len() == 2 && !is_passed[v as usize] {
            let mut ring = chains.from(v, joined[v as usize][0], &is_left);
            ring.iter().for_each(|&w| is_passed[w as usize] = true);
            ring.pop();
            chains.straighten_ring(&ring, &mut is_left);
        }
    }
    is_left
}

struct Chains<'a> {
    surface: &'a Surface,
    joined: &'a [Vec<u32>],
    tolerance: f64,
}

impl Chains<'_> {
    /// The vertices from one that is left, by its neighbour, to the next that is left, both included; of a ring, once round.
    fn from(&self, v: u32, next: u32, is_left: &[bool]) -> Vec<u32> {
        let mut chain = vec![v, next];
        while let &[.., before, at] = &chain[..]
            && at != v
            && !is_left[at as usize]
        {
            let of = &self.joined[at as usize];
            chain.push(if of[0] == before { of[1] } else { of[0] });
        }
        chain
    }

    /// Leaves what lies off the straight line between the ends of a chain (Douglas and Peucker 1973).
    fn straighten(&self, chain: &[u32], is_left: &mut [bool]) {
        let mut parts = vec![(0, chain.len() - 1)];
        while let Some((first, last)) = parts.pop() {
            let [a, b] = [first, last].map(|i| self.surface.position(chain[i]));
            let far = |i: usize| from_segment(self.surface.position(chain[i]), a, b);
            let farthest =
                (first + 1..last).map(|i| (far(i), i)).reduce(|x, y| if y.0 > x.0 { y } else { x });
            if let Some((far, i)) = farthest
                && far > self.tolerance
            {
                is_left[chain[i] as usize] = true;
                parts.extend([(first, i), (i, last)]);
            }
        }
    }

    /// The same of a ring, which begins where it is farthest from its middle, for this is a corner.
    fn straighten_ring(&self, ring: &[u32], is_left: &mut [bool]) {
        let middle = ring.iter().map(|&v| self.surface.position(v)).sum::<DVec3>() / ring.len() as f64;
        let farthest_from = |p: DVec3| {
            let far = |i: usize| self.surface.position(ring[i]).distance_squared(p);
            (0..ring.len()).reduce(|i, j| if far(j) > far(i) { j } else { i }).expect("a ring has vertices")
        };
        let first = farthest_from(middle);
        let second = farthest_from(self.surface.position(ring[first]));
        for (from, to) in [(first, second), (second, first)] {
            is_left[ring[from] as usize] = true;
            let length = (to + ring.len() - from) % ring.len();
            let chain: Vec<u32> = (0..=length).map(|i| ring[(from + i) % ring.len()]).collect();
            self.straighten(&chain, is_left);
        }
    }
}

fn from_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let ab = b - a;
    let along = ab.dot(p - a) / ab.length_squared();
    // A segment without length gives NaN, and its start.
    p.distance(if along > 0.0 { a + ab * along.min(1.0) } else { a })
}
