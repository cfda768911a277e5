//! The tables against the numbers that are known of them.

use std::collections::{BTreeMap, BTreeSet};

use isostudy_cells::{
    Cell, EdgeGroups, Label, Point, Symmetry, Triangulator, classes, classes_with_complement, symmetries,
};

/// By face rule: none joined, all joined.
const RULES: [u32; 2] = [0, !0];

fn triangles(cell: &Cell, triangulator: &Triangulator, inside: u32, joined: u32) -> Vec<[u8; 3]> {
    let loops = cell.loops(inside, joined);
    loops.iter().flat_map(|polygon| triangulator.fan(polygon).expect("a triangulation")).collect()
}

/// Directed sides without an opposite, and whether every other side is there just once each way.
fn rim<P: Ord + Copy>(triangles: &[[P; 3]]) -> BTreeSet<[P; 2]> {
    let sides: Vec<[P; 2]> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    let set: BTreeSet<[P; 2]> = sides.iter().copied().collect();
    assert_eq!(set.len(), sides.len(), "no side is run twice the same way");
    set.iter().copied().filter(|&[a, b]| !set.contains(&[b, a])).collect()
}

fn hypercube(dimension: usize) -> Vec<Symmetry> {
    let points: Vec<Vec<i32>> =
        (0..1 << dimension).map(|i| (0..dimension).map(|axis| i >> axis & 1).collect()).collect();
    symmetries(&points)
}

fn labels_of(mut entry: usize) -> Vec<Label> {
    (0..8)
        .map(|_| {
            let label = [Label::Outside, Label::On, Label::Inside][entry % 3];
            entry /= 3;
            label
        })
        .collect()
}

fn binary(inside: u32, corners: usize) -> Vec<Label> {
    (0..corners).map(|c| if inside >> c & 1 != 0 { Label::Inside } else { Label::Outside }).collect()
}

#[test]
fn sign_patterns_have_the_known_numbers_of_classes() {
    // rotations, with reflections, rotations and complement, all; and of three labels with reflections.
    for (dimension, order, expected, of_three) in
        [(2, 8, [6, 6, 4, 4], 21), (3, 48, [23, 22, 15, 14], 267), (4, 384, [496, 402, 272, 222], 132_102)]
    {
        let all = hypercube(dimension);
        assert_eq!(all.len(), order);
        let all: Vec<&Symmetry> = all.iter().collect();
        let rotations: Vec<&Symmetry> = all.iter().copied().filter(|s| s.is_rotation).collect();
        assert_eq!(rotations.len() * 2, order);
        let found = [
            classes(&rotations, 2),
            classes(&all, 2),
            classes_with_complement(&rotations),
            classes_with_complement(&all),
        ];
        assert_eq!(found, expected, "{dimension}");
        assert_eq!(classes(&all, 3), of_three, "{dimension}");
    }
}

/// Burnside's count against counting orbits one by one.
#[test]
fn orbits_are_as_many_as_the_lemma_says() {
    let all = hypercube(3);
    let orbits = |labels: u32, group: &[&Symmetry]| {
        let place = |entry: u32, corner: u8| entry / labels.pow(u32::from(corner)) % labels;
        let image = |entry: u32, symmetry: &Symmetry| {
            (0..8).map(|c| place(entry, c) * labels.pow(u32::from(symmetry.to[usize::from(c)]))).sum::<u32>()
        };
        let lowest = |entry: u32| group.iter().map(|symmetry| image(entry, symmetry)).min().unwrap();
        (0..labels.pow(8)).filter(|&entry| lowest(entry) == entry).count() as u64
    };
    let all: Vec<&Symmetry> = all.iter().collect();
    for labels in [2, 3] {
        assert_eq!(orbits(labels, &all), classes(&all, u64::from(labels)));
    }
}

#[test]
fn the_face_rules_make_820_triangles() {
    let cube = Cell::cube();
    let triangulator = Triangulator::new(&cube);
    for joined in RULES {
        let mut entries = [0; 6];
        let mut polygons = BTreeMap::new();
        for inside in 0..256 {
            entries[triangles(&cube, &triangulator, inside, joined).len()] += 1;
            for polygon in cube.loops(inside, joined) {
                *polygons.entry(polygon.len()).or_insert(0) += 1;
            }
        }
        assert_eq!(entries, [2, 16, 50, 80, 76, 32]);
        assert_eq!(polygons, BTreeMap::from([(3, 144), (4, 66), (5, 72), (6, 52), (7, 24)]));
    }
}

#[test]
fn the_two_rules_differ_in_120_entries() {
    let cube = Cell::cube();
    let differ = |&inside: &u32| cube.loops(inside, 0) != cube.loops(inside, !0);
    assert_eq!((0..256).filter(differ).count(), 120);
    // 12 of the 96 patterns of faces.
    let ambiguous: BTreeSet<(u32, u32)> = (0..256u32)
        .flat_map(|inside| (0..6).map(move |face| (inside, face)))
        .filter(|&(inside, face)| cube.ambiguous_faces(inside) >> face & 1 != 0)
        .map(|(inside, face)| {
            let corners = cube.faces()[face as usize].iter().fold(0, |set, c| set | 1 << c);
            (face, inside & corners)
        })
        .collect();
    assert_eq!(ambiguous.len(), 12);
}

#[test]
fn the_hull_rule_makes_836_triangles_and_joins_what_the_joining_rule_joins() {
    let cube = Cell::cube();
    let mut sum = 0;
    let mut tubes = 0;
    for inside in 0..256 {
        let patch = cube.hull_patch(&binary(inside, 8));
        sum += patch.len();
        let arcs: BTreeSet<[Point; 2]> =
            (0..6).flat_map(|face| cube.arcs(face, inside, true)).map(|arc| arc.map(Point::Edge)).collect();
        assert_eq!(rim(&patch), arcs, "{inside:08b}");
        let discs: usize = cube.loops(inside, !0).iter().map(|polygon| polygon.len() - 2).sum();
        tubes += usize::from(patch.len() != discs);
    }
    assert_eq!((sum, tubes), (836, 4));
}

#[test]
fn the_table_with_corners_on_the_surface_has_14512_triangles() {
    let cube = Cell::cube();
    let mut entries = BTreeMap::new();
    let mut in_a_face = 0;
    for entry in 0..6561 {
        let labels = labels_of(entry);
        let patch = cube.hull_patch(&labels);
        *entries.entry(patch.len()).or_insert(0) += 1;
        rim(&patch);
        assert!(patch.iter().all(|[a, b, c]| a != b && b != c && c != a), "no triangle repeats a point");
        let faces = |point: &Point| match *point {
            Point::Corner(c) => cube.faces_at_corner()[usize::from(c)],
            Point::Edge(e) => cube.faces_at_edge()[usize::from(e)],
        };
        let common = patch.iter().flatten().fold(!0, |set, point| set & faces(point));
        in_a_face += usize::from(!patch.is_empty() && common != 0);
    }
    assert_eq!(
        entries,
        BTreeMap::from([(0, 331), (1, 1120), (2, 2572), (3, 1968), (4, 510), (5, 56), (6, 4)])
    );
    assert_eq!(entries.iter().map(|(n, count)| n * count).sum::<usize>(), 14_512);
    assert_eq!(in_a_face, 30);
}

/// What a hull patch leaves on a face depends on that face's labels alone, and neighbours run it the other way.
#[test]
fn hull_patches_agree_on_faces_with_corners_on_the_surface() {
    let cube = Cell::cube();
    let mut known: BTreeMap<(usize, Vec<Label>), BTreeSet<[Point; 2]>> = BTreeMap::new();
    for entry in 0..6561 {
        let labels = labels_of(entry);
        let patch = cube.hull_patch(&labels);
        let faces_of = |point: &Point| match *point {
            Point::Corner(c) => cube.faces_at_corner()[usize::from(c)],
            Point::Edge(e) => cube.faces_at_edge()[usize::from(e)],
        };
        if !patch.is_empty() && patch.iter().flatten().fold(!0, |set, p| set & faces_of(p)) != 0 {
            // The whole patch lies in a face: it is for both neighbours to keep or drop.
            continue;
        }
        let rim = rim(&patch);
        for face in 0..6 {
            let on = |side: &&[Point; 2]| side.iter().all(|p| faces_of(p) >> face & 1 != 0);
            // A side along an edge of the cell is in two faces; who has it is the neighbours' affair across that edge.
            let along_edge =
                |side: &&[Point; 2]| side.iter().fold(!0, |s, p| s & faces_of(p)).count_ones() > 1;
            let here: BTreeSet<[Point; 2]> =
                rim.iter().filter(on).filter(|side| !along_edge(side)).copied().collect();
            let of_face: Vec<Label> = cube.faces()[face].iter().map(|&c| labels[usize::from(c)]).collect();
            let before = known.entry((face, of_face)).or_insert_with(|| here.clone());
            assert_eq!(*before, here, "entry {entry}, face {face}");
        }
    }
}

/// Consistency over all patterns and all pairs of neighbours: 2^12 signs of two cubes side by side, along each axis. The sides of
/// triangles in their common face cancel, and no diagonal of either lies in it.
#[test]
fn neighbours_meet_whatever_their_signs() {
    let cube = Cell::cube();
    let triangulator = Triangulator::new(&cube);
    for joined in RULES {
        let patches: Vec<_> = (0..256).map(|s| triangles(&cube, &triangulator, s, joined)).collect();
        let rims: Vec<_> = patches.iter().map(|patch| rim(patch)).collect();
        for axis in 0..3 {
            let [high, low] = [1, 0].map(|side| {
                let is_there = |&face: &usize| {
                    cube.faces()[face].iter().all(|&c| cube.corners()[usize::from(c)][axis] == side)
                };
                (0..6).find(is_there).unwrap()
            });
            // The upper cube's corners and edges in the common face have the lower cube's numbers less a step.
            let edge_below = |edge: u8| {
                let [a, b] = cube.edges()[usize::from(edge)].map(|c| c + (1 << axis));
                cube.edges().iter().position(|&e| e == [a, b]).unwrap() as u8
            };
            let in_face = |side: &&[u8; 2], face: usize| {
                side.iter().all(|&e| cube.faces_at_edge()[usize::from(e)] >> face & 1 != 0)
            };
            for signs in 0..1u32 << 12 {
                let lower = signs & 255;
                let mut upper = 0;
                let mut fresh = signs >> 8;
                for c in 0..8 {
                    let bit = if c >> axis & 1 == 0 {
                        lower >> (c | 1 << axis) & 1
                    } else {
                        let bit = fresh & 1;
                        fresh >>= 1;
                        bit
                    };
                    upper |= bit << c;
                }
                let below: BTreeSet<[u8; 2]> =
                    rims[lower as usize].iter().filter(|side| in_face(side, high)).copied().collect();
                let above: BTreeSet<[u8; 2]> = rims[upper as usize]
                    .iter()
                    .filter(|side| in_face(side, low))
                    .map(|&[a, b]| [edge_below(b), edge_below(a)])
                    .collect();
                assert_eq!(below, above, "axis {axis}, signs {signs:012b}");
            }
        }
    }
}

#[test]
fn patches_are_discs_whose_sides_are_the_arcs() {
    for cell in [Cell::cube(), Cell::tetrahedron(), Cell::pyramid(), Cell::wedge(), Cell::octahedron()] {
        let triangulator = Triangulator::new(&cell);
        for inside in 0..1 << cell.corners().len() {
            let ambiguous = cell.ambiguous_faces(inside);
            // Every choice on every ambiguous face.
            let mut joined = ambiguous;
            loop {
                let loops = cell.loops(inside, joined);
                let arcs: BTreeSet<[u8; 2]> = (0..cell.faces().len())
                    .flat_map(|f| cell.arcs(f, inside, joined >> f & 1 != 0))
                    .collect();
                let crossed: u64 = loops.iter().flatten().fold(0, |set, e| set | 1 << e);
                assert_eq!(crossed, cell.crossed(inside));
                assert_eq!(loops.iter().map(Vec::len).sum::<usize>(), crossed.count_ones() as usize);
                for polygon in &loops {
                    let Some(patch) = triangulator.fan(polygon) else { continue };
                    assert_eq!(patch.len(), polygon.len() - 2);
                    let rim = rim(&patch);
                    assert!(rim.is_subset(&arcs) && rim.len() == polygon.len(), "{inside:b} {joined:b}");
                    for [a, b] in patch.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]) {
                        assert!(rim.contains(&[a, b]) || triangulator.may_join(a, b), "a diagonal in a face");
                    }
                }
                if joined == 0 {
                    break;
                }
                joined = (joined - 1) & ambiguous;
            }
        }
    }
}

/// Up to seven corners every polygon has a triangulation without a diagonal in a face; of longer ones, which only mixed choices
/// make, some have none.
#[test]
fn only_the_longest_polygons_of_the_cube_need_a_vertex() {
    let cube = Cell::cube();
    let triangulator = Triangulator::new(&cube);
    let mut lengths = BTreeMap::new();
    for inside in 0..256 {
        let ambiguous = cube.ambiguous_faces(inside);
        for joined in (0..64).filter(|joined| joined & !ambiguous == 0) {
            for polygon in cube.loops(inside, joined) {
                *lengths.entry((polygon.len(), triangulator.fan(&polygon).is_some())).or_insert(0) += 1;
            }
        }
    }
    assert!(lengths.keys().all(|&(length, can)| can || length > 7), "{lengths:?}");
    assert!(lengths.contains_key(&(12, false)), "{lengths:?}");
}

#[test]
fn triangles_face_outward() {
    for cell in [Cell::cube(), Cell::tetrahedron(), Cell::pyramid(), Cell::wedge(), Cell::octahedron()] {
        for corner in 0..cell.corners().len() {
            let inside = 1 << corner;
            let at = |e: u8| {
                let [a, b] = cell.edges()[usize::from(e)].map(|c| cell.corners()[usize::from(c)]);
                [0, 1, 2].map(|i| a[i] + b[i] - 2 * cell.corners()[corner][i])
            };
            for polygon in cell.loops(inside, 0) {
                for [a, b, c] in Triangulator::new(&cell).fan(&polygon).unwrap() {
                    let [a, b, c] = [a, b, c].map(at);
                    let turn = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                        + a[2] * (b[0] * c[1] - b[1] * c[0]);
                    assert!(turn > 0, "seen from beyond, away from the corner, it turns counter-clockwise");
                }
            }
        }
    }
}

/// A turned pattern has the turned loops; a mirrored one has them run the other way.
#[test]
fn loops_turn_with_their_pattern() {
    let cube = Cell::cube();
    let edge = |[a, b]: [u8; 2]| cube.edges().iter().position(|&e| e == [a.min(b), a.max(b)]).unwrap() as u8;
    let canonical = |mut polygon: Vec<u8>| {
        let first = (0..polygon.len()).min_by_key(|&i| polygon[i]).unwrap();
        polygon.rotate_left(first);
        polygon
    };
    for symmetry in hypercube(3) {
        let corner = |c: u8| symmetry.to[usize::from(c)];
        for inside in 0..256u32 {
            let turned = (0..8).fold(0, |set, c| set | (inside >> c & 1) << corner(c));
            for joined in RULES {
                let mut images: Vec<Vec<u8>> = cube
                    .loops(inside, joined)
                    .into_iter()
                    .map(|polygon| {
                        let image = |e: u8| edge(cube.edges()[usize::from(e)].map(corner));
                        let mut polygon: Vec<u8> = polygon.into_iter().map(image).collect();
                        if !symmetry.is_rotation {
                            polygon.reverse();
                        }
                        canonical(polygon)
                    })
                    .collect();
                images.sort_unstable();
                assert_eq!(images, cube.loops(turned, joined));
            }
        }
    }
}

#[test]
fn edge_groups_are_eight_and_one_is_bad() {
    let groups = EdgeGroups::new(&Cell::cube());
    assert_eq!(groups.all().iter().map(|group| group.triples).sum::<usize>(), 196);
    let mut means: Vec<(usize, f64)> =
        groups.all().iter().map(|group| (group.triples, group.quality[1])).collect();
    means.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap());
    // Computed once more in Python over 59^3 places on the edges.
    let known = [
        (8, 0.808),
        (8, 0.931),
        (12, 0.853),
        (24, 0.473),
        (24, 0.747),
        (24, 0.919),
        (48, 0.690),
        (48, 0.746),
    ];
    assert_eq!(means.len(), known.len());
    for ((size, q), (known_size, known_q)) in means.into_iter().zip(known) {
        assert_eq!(size, known_size);
        assert!((q - known_q).abs() < 6e-4, "{size}: {q} for {known_q}");
    }
}

/// Diagonals alone bring the triangles of group 2 from 200 down to 56, in 28 entries; the hull table has 80.
#[test]
fn diagonals_leave_56_triangles_of_group_2() {
    let cube = Cell::cube();
    let (triangulator, groups) = (Triangulator::new(&cube), EdgeGroups::new(&cube));
    for joined in RULES {
        let (mut bad, mut touched) = (0, 0);
        for inside in 0..256 {
            let of_entry: usize = cube
                .loops(inside, joined)
                .iter()
                .map(|polygon| {
                    let cost = |t: [u8; 3]| if groups.is_path(t) { 1.0 } else { 0.0 };
                    let patch = triangulator.cheapest(polygon, cost).unwrap();
                    patch.into_iter().filter(|&t| groups.is_path(t)).count()
                })
                .sum();
            bad += of_entry;
            touched += usize::from(of_entry > 0);
        }
        assert_eq!((bad, touched), (56, 28));
    }
    let edges = |t: [Point; 3]| {
        t.map(|p| match p {
            Point::Edge(e) => e,
            Point::Corner(c) => panic!("corner {c} is not on the surface"),
        })
    };
    let hull: usize = (0..256)
        .flat_map(|inside| cube.hull_patch(&binary(inside, 8)))
        .filter(|&t| groups.is_path(edges(t)))
        .count();
    assert_eq!(hull, 80);
}

/// The published facts, computed once more in Python over 59^3 places: the bad group is a path, is never good and is bad ten times
/// as often as any other; three groups whose edges share no corner are never bad.
#[test]
fn groups_have_the_known_distributions() {
    let groups = EdgeGroups::new(&Cell::cube());
    let is_close = |a: f64, b: f64| (a - b).abs() < 6e-4;
    let bad = groups.all().iter().find(|group| group.is_path).unwrap();
    assert!(is_close(bad.below[0], 0.050) && is_close(bad.below[1], 0.223), "{bad:?}");
    // It comes near the greatest, 2 sqrt 2 - 2, towards the ends of edges alone.
    assert!((0.81..0.8285).contains(&bad.quality[2]), "{bad:?}");
    let others = groups.all().iter().filter(|group| !group.is_path);
    assert!(others.clone().all(|group| group.below[0] < 0.1 * 1.3 * bad.below[0]));
    let never = others.filter(|group| group.quality[0] >= 0.698).map(|group| group.triples);
    assert_eq!(never.collect::<BTreeSet<_>>(), BTreeSet::from([8, 12, 24]));
}

/// A tetrahedron has 4 triples of edges at a corner and 12 that are paths. Eight symmetries leave 4 groups of the body-centred lattice's.
/// A cube's, cut along its diagonal, has one symmetry beside the identity, which keeps 4 paths: 2 + (12 + 4) / 2 groups.
#[test]
fn tetrahedra_have_four_groups_or_ten() {
    let disphenoid = Cell::try_new(&[[0, 0, 0], [2, 0, 0], [1, 1, 1], [1, 1, -1]]).unwrap();
    let freudenthal = Cell::try_new(&[[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]]).unwrap();
    for (cell, groups) in [(disphenoid, 4), (freudenthal, 10)] {
        let found = EdgeGroups::new(&cell);
        assert_eq!(found.all().len(), groups);
        assert_eq!(found.all().iter().map(|group| group.triples).sum::<usize>(), 16);
    }
}
