//! Every link that a point of a lattice can have, read off the lattice's own tetrahedra.

use std::collections::BTreeMap;

use super::link::Link;
use crate::lattice::tetrahedra::{Spoke, belongs_to_an_earlier_cell, spokes};
use crate::lattice::{Arrangement, DIRECTIONS, Directions, Offset, Uniform};

/// Two cells along each axis have a point in every place: low end, high end and between.
const CELLS: usize = 2;

/// All links, by their present directions. The last is the whole sphere, of every point inside the volume.
///
/// Inside, 14 directions, 36 joins and 24 triangles. At the boundary a disc: 26 of them simple cubic; body-centred
/// 26 of cube corners and 6 of the centres outside the box.
pub(super) fn links(arrangement: Arrangement) -> Vec<Link> {
    let mut links: Vec<Link> =
        triangles_at_points(arrangement).values().map(|triangles| Link::new(triangles)).collect();
    links.sort_by_key(Link::present);
    links.dedup_by_key(|link| link.present());
    links
}

/// The link triangles of every point of a small lattice, by its place in half cells.
pub(super) fn triangles_at_points(arrangement: Arrangement) -> BTreeMap<Offset, Vec<[u8; 3]>> {
    let directions = arrangement.directions();
    let spokes = spokes(arrangement);
    let mut at_points: BTreeMap<Offset, Vec<[u8; 3]>> = BTreeMap::new();
    for cell in (0..CELLS.pow(3)).map(|i| [i % CELLS, i / CELLS % CELLS, i / CELLS.pow(2)]) {
        let base = cell.map(|i| match arrangement.expect_uniform() {
            Uniform::BodyCentred => 2 * i as i8 + 1,
            Uniform::SimpleCubic => 2 * i as i8,
        });
        let own = |spoke: &&Spoke| !belongs_to_an_earlier_cell(arrangement, spoke, cell);
        for tetrahedron in spokes.iter().filter(own).flat_map(|spoke| &spoke.ring) {
            let [a, b, c] = tetrahedron.corners.map(|d| plus(base, directions.offsets[d as usize]));
            // Even permutations of (base, a, b, c): seen from each corner, the others turn the same way.
            for [from, others @ ..] in [[base, a, b, c], [a, base, c, b], [b, c, base, a], [c, b, a, base]] {
                let triangle = others.map(|to| direction(directions, from, to));
                at_points.entry(from).or_default().push(triangle);
            }
        }
    }
    at_points
}

fn plus(a: Offset, b: Offset) -> Offset {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn direction(directions: &Directions, from: Offset, to: Offset) -> u8 {
    (0..DIRECTIONS)
        .find(|&d| plus(from, directions.offsets[d]) == to)
        .expect("corners of a tetrahedron are lattice neighbours") as u8
}
