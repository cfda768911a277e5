//! The 512 patterns of a transition cell: they fit the cubes on either side and each other, whatever ambiguous faces join.

use std::collections::BTreeSet;

use isostudy_cells::{Cell, Triangulator, symmetries};

/// A point of an edge of the fine squares, or of the coarse one: the ends in steps of the fine grid.
type Crossing = [[i32; 2]; 2];

const FINE: usize = 4;
const COARSE: usize = 4;
const SIDES: [usize; 4] = [5, 6, 7, 8];

/// The corners inside, of a pattern of nine fine ones.
fn inside(pattern: u32) -> u32 {
    let coarse = [0, 2, 6, 8].into_iter().enumerate();
    coarse.fold(pattern, |set, (c, fine)| set | (pattern >> fine & 1) << (9 + c))
}

/// Every pattern with every choice for its ambiguous faces.
fn each(cell: &Cell, mut check: impl FnMut(u32, u32)) {
    for pattern in 0..512 {
        let inside = inside(pattern);
        let ambiguous = cell.ambiguous_faces(inside);
        (0..512).filter(|joined| joined & !ambiguous == 0).for_each(|joined| check(inside, joined));
    }
}

/// The arcs in a face, with crossings by the ends of their edges in the plane, moved and scaled.
fn arcs(
    cell: &Cell,
    face: usize,
    inside: u32,
    joined: bool,
    place: impl Fn([i32; 3]) -> [i32; 2],
) -> BTreeSet<[Crossing; 2]> {
    let crossing = |edge: u8| {
        let mut ends = cell.edges()[usize::from(edge)].map(|c| place(cell.corners()[usize::from(c)]));
        ends.sort_unstable();
        ends
    };
    cell.arcs(face, inside, joined).into_iter().map(|arc| arc.map(crossing)).collect()
}

fn reversed(arcs: BTreeSet<[Crossing; 2]>) -> BTreeSet<[Crossing; 2]> {
    arcs.into_iter().map(|[from, to]| [to, from]).collect()
}

#[test]
fn the_cell_is_a_closed_polyhedron() {
    let cell = Cell::transition();
    assert_eq!((cell.corners().len(), cell.edges().len(), cell.faces().len()), (13, 20, 9));
    let sides: Vec<[u8; 2]> = cell
        .faces()
        .iter()
        .flat_map(|face| (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]]))
        .collect();
    let set: BTreeSet<[u8; 2]> = sides.iter().copied().collect();
    assert_eq!(set.len(), sides.len());
    assert!(set.iter().all(|&[a, b]| set.contains(&[b, a])), "each edge is run both ways");
    // Six times the volume: 4 for a slab of 2 by 2 by 1, and positive since faces are seen from outside.
    let at = |c: u8| cell.corners()[usize::from(c)].map(i64::from);
    let volume: i64 = cell
        .faces()
        .iter()
        .flat_map(|f| (1..f.len() - 1).map(|i| [at(f[0]), at(f[i]), at(f[i + 1])]))
        .map(|[a, b, c]| {
            let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
            a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]
        })
        .sum();
    assert_eq!(volume, 24);
}

/// Up to rotations and reflections of the square there are 73 patterns, if inside and outside may be exchanged where no square of either
/// grid has a choice: as many as Lengyel found.
#[test]
fn patterns_have_the_published_number_of_classes() {
    let cell = Cell::transition();
    let points: Vec<Vec<i32>> = (0..9).map(|c| vec![c % 3, c / 3]).collect();
    let all = symmetries(&points);
    assert_eq!(all.len(), 8);
    let has_choice = |pattern: u32| cell.ambiguous_faces(inside(pattern)) != 0;
    let lowest = |pattern: u32| {
        let image = |p: u32| {
            let to = |symmetry: &isostudy_cells::Symmetry| {
                (0..9).fold(0, |set, c| set | (p >> c & 1) << symmetry.to[c as usize])
            };
            all.iter().map(to).min().unwrap()
        };
        if has_choice(pattern) { image(pattern) } else { image(pattern).min(image(511 - pattern)) }
    };
    let classes: BTreeSet<u32> = (0..512).map(lowest).collect();
    assert_eq!(classes.len(), 73);
}

/// A cube of the fine grid below each fine square, one of the coarse grid above the coarse square: with the same signs and the same
/// choice, both have the arcs of the transition, the other way round.
#[test]
fn squares_meet_the_cubes_of_both_grids() {
    let (cell, cube) = (Cell::transition(), Cell::cube());
    let at_height = |z: i32| {
        let is_it = |face: &Vec<u8>| face.iter().all(|&c| cube.corners()[usize::from(c)][2] == z);
        cube.faces().iter().position(is_it).unwrap()
    };
    let (top, bottom) = (at_height(1), at_height(0));
    let flat = |[x, y, _]: [i32; 3]| [x, y];
    each(&cell, |inside, joined| {
        for square in 0..FINE {
            let (i, j) = (square as i32 % 2, square as i32 / 2);
            let sides = |c: u32| inside >> ((i as u32 + (c & 1)) + 3 * (j as u32 + (c >> 1 & 1))) & 1;
            let of_cube = (0..8).fold(0, |set, c| set | sides(c) << c);
            let is_joined = joined >> square & 1 != 0;
            let fine = arcs(&cube, top, of_cube, is_joined, |[x, y, _]| [x + i, y + j]);
            assert_eq!(arcs(&cell, square, inside, is_joined, flat), reversed(fine), "{inside:b} {joined:b}");
        }
        let of_cube = (0..8).fold(0, |set, c| set | (inside >> (9 + (c & 3)) & 1) << c);
        let is_joined = joined >> COARSE & 1 != 0;
        let coarse = arcs(&cube, bottom, of_cube, is_joined, |[x, y, _]| [2 * x, 2 * y]);
        assert_eq!(arcs(&cell, COARSE, inside, is_joined, flat), reversed(coarse), "{inside:b} {joined:b}");
    });
}

/// A side says nothing but what its three fine corners are: so do the sides of neighbours, the other way round, also where a seam turns
/// at an edge of a chunk.
#[test]
fn sides_meet_each_other() {
    let cell = Cell::transition();
    assert!(
        (0..512).all(|pattern| SIDES.iter().all(|s| cell.ambiguous_faces(inside(pattern)) >> s & 1 == 0))
    );
    // Along the side, and up.
    let places: [fn([i32; 3]) -> [i32; 2]; 4] =
        [|[x, _, z]| [x, z], |[x, _, z]| [x, z], |[_, y, z]| [y, z], |[_, y, z]| [y, z]];
    let corners = [[0, 1, 2], [6, 7, 8], [0, 3, 6], [2, 5, 8]];
    let of = |side: usize, pattern: u32| arcs(&cell, SIDES[side], inside(pattern), false, places[side]);
    for one in 0..512 {
        for (side, three) in corners.iter().enumerate() {
            let signs = three.map(|c| one >> c & 1);
            // The sides at y = 2 and x = 0 run the other way than those at y = 0 and x = 2.
            for (other_side, other_three) in corners.iter().enumerate() {
                let other = (0..3).fold(0, |set, i| set | signs[i] << other_three[i]);
                let is_other_way = [false, true, true, false][side] != [false, true, true, false][other_side];
                let found = of(other_side, other);
                assert_eq!(of(side, one), if is_other_way { reversed(found) } else { found });
            }
        }
    }
}

/// The triangles of a pattern end where its arcs are, every other side has two, and none of those lies in a face. At most 12 crossings and
/// 12 triangles, as published.
#[test]
fn triangles_fill_the_loops() {
    let cell = Cell::transition();
    let triangulator = Triangulator::new(&cell);
    each(&cell, |inside, joined| {
        let loops = cell.loops(inside, joined);
        assert!(loops.iter().map(Vec::len).sum::<usize>() <= 12);
        let triangles: Vec<[u8; 3]> = loops
            .iter()
            .flat_map(|polygon| triangulator.fan(polygon).expect("diagonals off the faces"))
            .collect();
        assert!(triangles.len() <= 12);
        let sides: Vec<[u8; 2]> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        let set: BTreeSet<[u8; 2]> = sides.iter().copied().collect();
        assert_eq!(set.len(), sides.len(), "a side is run twice the same way");
        let rim: BTreeSet<[u8; 2]> = set.iter().copied().filter(|&[a, b]| !set.contains(&[b, a])).collect();
        let arcs = (0..9).flat_map(|face| cell.arcs(face, inside, joined >> face & 1 != 0)).collect();
        assert_eq!(rim, arcs);
        assert!(set.difference(&rim).all(|&[a, b]| triangulator.may_join(a, b)));
    });
}
