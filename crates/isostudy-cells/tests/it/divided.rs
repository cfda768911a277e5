//! Cubes with divided sides and edges: closed, and with the arcs of the cubes beyond each of their faces.

use std::collections::BTreeSet;

use isostudy_cells::{Cell, Triangulator};

/// A point of an edge: its ends.
type Crossing = [[i32; 3]; 2];

/// Numbers that have nothing to do with each other.
fn hash(i: u32) -> u32 {
    let mut hash = i.wrapping_mul(0x9e37_79b9);
    for factor in [0x85eb_ca6b, 0xc2b2_ae35] {
        hash = (hash ^ hash >> 15).wrapping_mul(factor);
    }
    hash ^ hash >> 16
}

/// All sides with no edge but theirs, and some with others.
fn each(mut check: impl FnMut(u8, u16, &Cell)) {
    for i in 0..256 {
        let (sides, edges) = (i as u8 & 63, if i < 64 { 0 } else { hash(i) as u16 & 0xfff });
        check(sides, edges, &Cell::divided(sides, edges));
    }
}

fn arcs(
    cell: &Cell,
    face: usize,
    inside: u32,
    joined: bool,
    place: impl Fn([i32; 3]) -> [i32; 3],
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

/// The places of a face's corners.
fn places(cell: &Cell, face: usize, place: impl Fn([i32; 3]) -> [i32; 3]) -> BTreeSet<[i32; 3]> {
    cell.faces()[face].iter().map(|&c| place(cell.corners()[usize::from(c)])).collect()
}

#[test]
fn divided_cubes_are_closed_polyhedra() {
    each(|sides, edges, cell| {
        let run: Vec<[u8; 2]> = cell
            .faces()
            .iter()
            .flat_map(|face| (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]]))
            .collect();
        let set: BTreeSet<[u8; 2]> = run.iter().copied().collect();
        assert_eq!(set.len(), run.len());
        assert!(set.iter().all(|&[a, b]| set.contains(&[b, a])), "each edge is run both ways");
        assert_eq!(cell.faces().len() as u32, 6 + 3 * sides.count_ones());
        // Six times the volume, which is positive since faces are seen from outside.
        let at = |c: u8| cell.corners()[usize::from(c)];
        let volume: i32 = cell
            .faces()
            .iter()
            .flat_map(|f| (1..f.len() - 1).map(|i| [at(f[0]), at(f[i]), at(f[i + 1])]))
            .map(|[a, b, c]| {
                let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
                a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]
            })
            .sum();
        assert_eq!(volume, 48);
        // An edge has two halves if it or a side at it is divided.
        let middles: BTreeSet<[i32; 3]> = cell.faces().iter().flatten().map(|&c| at(c)).collect();
        for axis in 0..3 {
            for end in 0..4 {
                let mut middle = [0; 3];
                let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
                (middle[axis], middle[u], middle[v]) = (1, 2 * (end & 1), 2 * (end >> 1));
                let is_side = |axis: usize| sides >> (2 * axis as i32 + middle[axis] / 2) & 1 != 0;
                let is_divided = edges >> (4 * axis as i32 + end) & 1 != 0 || is_side(u) || is_side(v);
                assert_eq!(middles.contains(&middle), is_divided, "{sides:b} {edges:b} {middle:?}");
            }
        }
    });
}

/// A cube half as large beyond each square of a divided side has the same arcs, the other way round, with the same signs and the same choice.
#[test]
fn squares_of_divided_sides_meet_small_cubes() {
    let cube = Cell::cube();
    let mut met = 0;
    each(|sides, edges, cell| {
        for round in 0..8 {
            let inside = hash(u32::from(sides) << 16 | u32::from(edges) << 3 | round);
            for face in (0..cell.faces().len()).filter(|&face| cell.faces()[face].len() == 4) {
                let own = places(cell, face, |place| place);
                let low = *own.first().unwrap();
                // Undivided sides are met by cubes as large.
                let size = if own.last().unwrap().iter().zip(low).map(|(a, b)| a - b).sum::<i32>() == 2 {
                    1
                } else {
                    2
                };
                let axis = (0..3).find(|&axis| own.iter().all(|place| place[axis] == low[axis])).unwrap();
                let beyond = if low[axis] == 0 { -size } else { 0 };
                let at = |place: [i32; 3]| {
                    let mut at = [0, 1, 2].map(|i| low[i] + size * place[i]);
                    at[axis] += beyond;
                    at
                };
                let other = (0..6).find(|&other| places(&cube, other, at) == own).unwrap();
                let number = |[x, y, z]: [i32; 3]| (x + 3 * y + 9 * z) as u32;
                let sign = |&c: &u8| {
                    let place = at(cube.corners()[usize::from(c)]);
                    own.contains(&place) && inside >> number(place) & 1 != 0
                };
                let of_cube = (0..8_u8).fold(0, |set, c| set | u32::from(sign(&c)) << c);
                for joined in [false, true] {
                    let of_other = arcs(&cube, other, of_cube, joined, at);
                    met += of_other.len();
                    assert_eq!(arcs(cell, face, inside, joined, |place| place), reversed(of_other));
                }
            }
        }
    });
    assert!(met > 10_000, "{met}");
}

/// Two large cubes beside each other, with the same edges divided, have the same arcs in their common side.
#[test]
fn sides_with_divided_edges_meet_each_other() {
    // The upper side along x of one, the lower one of the other.
    let (upper, lower) = (1, 0);
    for edges in 0..16_u16 {
        // The edges of the side along y are at bits 4 and 5 more in x; those along z at 8, with x after y.
        let at = |is_upper: bool| {
            let x = u16::from(is_upper);
            let along_y = |z: u16, bit: u16| (edges >> bit & 1) << (4 + z + 2 * x);
            let along_z = |y: u16, bit: u16| (edges >> bit & 1) << (8 + x + 2 * y);
            along_y(0, 0) | along_y(1, 1) | along_z(0, 2) | along_z(1, 3)
        };
        let [one, other] = [true, false].map(|is_upper| Cell::divided(0, at(is_upper)));
        let moved = |[x, y, z]: [i32; 3]| [x + 2, y, z];
        let own = places(&one, upper, |place| place);
        assert_eq!(own, places(&other, lower, moved));
        assert_eq!(own.len(), 4 + edges.count_ones() as usize);
        for signs in 0..512_u32 {
            let sign = |y: i32, z: i32| signs >> (y + 3 * z) & 1;
            let inside = |x: i32| {
                let all = (0..9).map(|i| (i % 3, i / 3));
                all.fold(0, |set, (y, z)| set | sign(y, z) << (x + 3 * y + 9 * z))
            };
            for joined in [false, true] {
                let of_one = arcs(&one, upper, inside(2), joined, |place| place);
                let of_other = arcs(&other, lower, inside(0), joined, moved);
                assert_eq!(of_one, reversed(of_other), "{edges:b} {signs:b}");
            }
        }
    }
}

/// No diagonal lies in a face or along an edge. So nothing has one that a neighbour has too.
#[test]
fn diagonals_of_divided_cubes_lie_within() {
    each(|_, _, cell| {
        let triangulator = Triangulator::new(cell);
        let line = |edge: u8| {
            let [a, b] = cell.edges()[usize::from(edge)].map(|c| cell.corners()[usize::from(c)]);
            let axis = (0..3).find(|&axis| a[axis] != b[axis]).unwrap();
            let mut line = a;
            line[axis] = -1;
            // Of the cube's own edges alone: lines across a side are none of a neighbour's.
            line.iter().all(|&c| c != 1).then_some(line)
        };
        let count = cell.edges().len() as u8;
        for (a, b) in (0..count).flat_map(|a| (0..count).map(move |b| (a, b))).filter(|(a, b)| a != b) {
            let have_face = cell.face_edges().iter().any(|edges| edges.contains(&a) && edges.contains(&b));
            let have_line = line(a).is_some() && line(a) == line(b);
            assert_eq!(triangulator.may_join(a, b), !have_face && !have_line, "{a} {b}");
        }
    });
}

/// Each crossing is in one loop, and the arcs between are those of the faces.
#[test]
fn loops_of_divided_cubes_have_all_arcs() {
    each(|sides, edges, cell| {
        let mut loops = isostudy_cells::Loops::default();
        for round in 0..16 {
            let inside = hash(u32::from(sides) << 20 | u32::from(edges) << 4 | round);
            let joined = hash(inside);
            cell.find_loops(inside, joined, &mut loops);
            let crossed: u64 = loops.iter().flatten().fold(0, |set, step| set | 1 << step.edge);
            assert_eq!(crossed, cell.crossed(inside));
            let mut found: Vec<(usize, [u8; 2])> = loops
                .iter()
                .flat_map(|steps| {
                    let next = steps.iter().cycle().skip(1);
                    steps.iter().zip(next).map(|(a, b)| (usize::from(a.face), [a.edge, b.edge]))
                })
                .collect();
            found.sort_unstable();
            let mut wanted: Vec<(usize, [u8; 2])> = (0..cell.faces().len())
                .flat_map(|face| {
                    cell.arcs(face, inside, joined >> face & 1 != 0).into_iter().map(move |arc| (face, arc))
                })
                .collect();
            wanted.sort_unstable();
            assert_eq!(found, wanted);
        }
    });
}
