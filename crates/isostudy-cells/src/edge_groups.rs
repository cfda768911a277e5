//! Edge groups: kinds of triangles by which edges of the cell their corners lie on, and how well shaped each kind is.

use crate::cell::Cell;
use crate::symmetry::symmetries;

/// Points along an edge at which expected quality is taken.
const POINTS: usize = 59;

/// The kinds of triples of crossed edges of a cell, up to its symmetries (Dietrich et al. 2008).
#[derive(Debug, Clone)]
pub struct EdgeGroups {
    edges: usize,
    /// By triple of edges.
    group: Vec<Option<u8>>,
    groups: Vec<EdgeGroup>,
}

/// Triples of edges that symmetries take to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeGroup {
    /// How many there are.
    pub triples: usize,
    /// One of them.
    pub example: [u8; 3],
    /// Whether they are paths in space, end to end and not in one plane: group 2 of the paper.
    pub is_path: bool,
    /// The radius ratio ([`radius_ratio`]) over corners spread evenly along their edges, ends aside: the least, the mean and the
    /// greatest.
    pub quality: [f64; 3],
    /// The shares below 0.1 and below 0.3.
    pub below: [f64; 2],
}

impl EdgeGroups {
    /// The groups of a cell. Triples in one face are in none: no triangle has them.
    pub fn new(cell: &Cell) -> Self {
        let edges = cell.edges();
        let points: Vec<Vec<i32>> = cell.corners().iter().map(|corner| corner.to_vec()).collect();
        let number = |a: u8, b: u8| edges.iter().position(|&e| e == [a.min(b), a.max(b)]);
        let images: Vec<Vec<usize>> = symmetries(&points)
            .iter()
            .map(|symmetry| {
                let image = |&[a, b]: &[u8; 2]| {
                    let [a, b] = [a, b].map(|c| symmetry.to[usize::from(c)]);
                    number(a, b).expect("a symmetry takes edges to edges")
                };
                edges.iter().map(image).collect()
            })
            .collect();
        let n = edges.len();
        let mut found = Self { edges: n, group: vec![None; n * n * n], groups: Vec::new() };
        for [a, b, c] in triples(n) {
            let faces = [a, b, c].iter().fold(!0, |set, &e| set & cell.faces_at_edge()[e]);
            if faces != 0 || found.group[found.place([a, b, c])].is_some() {
                continue;
            }
            let group = found.groups.len() as u8;
            let mut members = 0;
            for image in &images {
                let place = found.place([image[a], image[b], image[c]]);
                members += usize::from(found.group[place].replace(group).is_none());
            }
            let corners = [a, b, c].map(|e| edges[e].map(usize::from));
            let (quality, below) = qualities(cell, corners);
            let example = [a, b, c].map(|e| e as u8);
            found.groups.push(EdgeGroup {
                triples: members,
                example,
                is_path: is_path(corners),
                quality,
                below,
            });
        }
        found
    }

    fn place(&self, mut triple: [usize; 3]) -> usize {
        triple.sort_unstable();
        (triple[0] * self.edges + triple[1]) * self.edges + triple[2]
    }

    fn group(&self, triangle: [u8; 3]) -> &EdgeGroup {
        &self.groups[self.number(triangle).expect("the edges are not in one face")]
    }

    /// The group of a triple of edges; `None` if they are in one face.
    pub fn number(&self, triangle: [u8; 3]) -> Option<usize> {
        self.group[self.place(triangle.map(usize::from))].map(usize::from)
    }

    /// The groups, by their numbers.
    pub fn all(&self) -> &[EdgeGroup] {
        &self.groups
    }

    /// Whether the triangle's edges are a path in space, end to end and not in one plane: group 2, whose triangles are the
    /// only ones that are often bad.
    ///
    /// # Panics
    /// If the edges are in one face.
    pub fn is_path(&self, triangle: [u8; 3]) -> bool {
        self.group(triangle).is_path
    }

    /// The mean of [`radius_ratio`] over corners spread evenly along their edges.
    ///
    /// # Panics
    /// If the edges are in one face.
    pub fn expected_quality(&self, triangle: [u8; 3]) -> f64 {
        self.group(triangle).quality[1]
    }
}

fn triples(n: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..n).flat_map(move |a| (a + 1..n).flat_map(move |b| (b + 1..n).map(move |c| [a, b, c])))
}

/// Whether one of three edges meets both others, at different ends.
fn is_path(edges: [[usize; 2]; 3]) -> bool {
    (0..3).any(|middle| {
        let [one, other] = [edges[(middle + 1) % 3], edges[(middle + 2) % 3]];
        let [a, b] = edges[middle];
        (one.contains(&a) && other.contains(&b)) || (one.contains(&b) && other.contains(&a))
    })
}

/// Least, mean and greatest radius ratio, and the shares below 0.1 and 0.3.
fn qualities(cell: &Cell, edges: [[usize; 2]; 3]) -> ([f64; 3], [f64; 2]) {
    let along = |edge: [usize; 2], i: usize| {
        let share = (i as f64 + 1.0) / (POINTS as f64 + 1.0);
        let [a, b] = edge.map(|c| cell.corners()[c].map(f64::from));
        [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * share)
    };
    let (mut least, mut sum, mut greatest, mut below) = (1.0f64, 0.0, 0.0f64, [0.0; 2]);
    for i in 0..POINTS {
        for j in 0..POINTS {
            for k in 0..POINTS {
                let ratio = radius_ratio([along(edges[0], i), along(edges[1], j), along(edges[2], k)]);
                (least, sum, greatest) = (least.min(ratio), sum + ratio, greatest.max(ratio));
                below = [
                    below[0] + f64::from(u8::from(ratio < 0.1)),
                    below[1] + f64::from(u8::from(ratio < 0.3)),
                ];
            }
        }
    }
    let count = (POINTS as f64).powi(3);
    ([least, sum / count, greatest], below.map(|n| n / count))
}

/// Twice the radius of a triangle's inscribed circle over that of its circumscribed one: 1 if it is equilateral, 0 without area.
pub fn radius_ratio(corners: [[f64; 3]; 3]) -> f64 {
    let length = |i: usize, j: usize| {
        let squared = |k: usize| (corners[i][k] - corners[j][k]) * (corners[i][k] - corners[j][k]);
        (squared(0) + squared(1) + squared(2)).sqrt()
    };
    let (a, b, c) = (length(0, 1), length(1, 2), length(2, 0));
    let product = a * b * c;
    let ratio = (b + c - a) * (c + a - b) * (a + b - c) / product;
    if product > 0.0 { ratio.max(0.0) } else { 0.0 }
}
