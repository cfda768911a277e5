//! The table: its census, its symmetry, and how it fits in every facet of the cube.

use std::collections::{BTreeMap, BTreeSet};

use isostudy_cells::{Cell, Label, Point, Symmetry, classes, classes_with_complement, symmetries};
use isostudy_four::{Cube, Table};

fn corners(dimensions: usize) -> Vec<Vec<i32>> {
    (0..1 << dimensions).map(|c| (0..dimensions).map(|axis| c >> axis & 1).collect()).collect()
}

/// The classes of the 65,536 entries, each found by trying all symmetries.
fn orbits(group: &[&Symmetry], with_complement: bool) -> usize {
    let mut seen = vec![false; 1 << 16];
    let mut count = 0;
    for entry in 0..1u32 << 16 {
        if seen[entry as usize] {
            continue;
        }
        count += 1;
        for symmetry in group {
            let image =
                symmetry.to.iter().enumerate().fold(0u32, |image, (c, to)| image | (entry >> c & 1) << to);
            seen[image as usize] = true;
            seen[(image ^ 0xffff) as usize] |= with_complement;
        }
    }
    count
}

#[test]
fn entries_have_222_402_and_496_classes() {
    let group = symmetries(&corners(4));
    let all: Vec<&Symmetry> = group.iter().collect();
    let rotations: Vec<&Symmetry> = group.iter().filter(|symmetry| symmetry.is_rotation).collect();
    assert_eq!((all.len(), rotations.len()), (384, 192));
    assert_eq!([orbits(&rotations, false), orbits(&all, false), orbits(&all, true)], [496, 402, 222]);
    assert_eq!([classes(&rotations, 2), classes(&all, 2), classes_with_complement(&all)], [496, 402, 222]);
    assert_eq!(Table::<4>::get().classes().len(), 402);
    assert_eq!(Table::<3>::get().classes().len(), 22);
}

#[test]
fn three_dimensions_have_836_triangles_on_the_polygons_of_the_cells_crate() {
    let table = Table::<3>::get();
    let cell = Cell::cube();
    let place = |c: u8| cell.corners()[usize::from(c)];
    // Numbers of edges there are those of edges here with the same ends.
    let same: Vec<u8> = cell
        .edges()
        .iter()
        .map(|&[a, b]| {
            let mut ends = [a, b].map(|c| place(c).iter().rev().fold(0, |corner, &x| corner << 1 | x as u8));
            ends.sort_unstable();
            table.cube().edges().iter().position(|edge| edge.corners == ends).unwrap() as u8
        })
        .collect();
    let mut count = 0;
    for entry in 0..256u32 {
        let labels: Vec<Label> = (0..8)
            .map(|c| {
                let corner = place(c).iter().rev().fold(0, |corner, &x| corner << 1 | x);
                if entry >> corner & 1 != 0 { Label::Inside } else { Label::Outside }
            })
            .collect();
        let there = cell.hull_patch(&labels).into_iter().map(|triangle| {
            triangle.map(|point| match point {
                Point::Edge(e) => same[usize::from(e)],
                Point::Corner(_) => unreachable!(),
            })
        });
        let here = table.entry(entry);
        count += here.len();
        assert_eq!(here.len(), there.len(), "{entry:#b}");
        assert_eq!(polygons(here.iter().copied()), polygons(there), "{entry:#b}");
    }
    assert_eq!(count, 836);
}

/// Triangles put together to polygons of one plane: the directed sides of each.
fn polygons(triangles: impl Iterator<Item = [u8; 3]>) -> BTreeSet<BTreeSet<[u8; 2]>> {
    let cube = Cube::<3>::new();
    // Edges of the cube are parallel to an axis; twice their middles are whole.
    let at = |e: u8| {
        let edge = cube.edges()[usize::from(e)];
        [0, 1, 2].map(|axis| edge.corners.map(|c| i64::from(c >> axis & 1)).iter().sum::<i64>())
    };
    let mut planes: BTreeMap<[i64; 4], BTreeSet<[u8; 2]>> = BTreeMap::new();
    for triangle in triangles {
        let [a, b, c] = triangle.map(at);
        let [u, v] = [b, c].map(|p| [0, 1, 2].map(|i| p[i] - a[i]));
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let length = n.iter().map(|x| x.abs()).max().unwrap();
        // The largest component becomes the same in all triangles of a plane.
        let n = n.map(|x| 840 * x / length);
        let offset = (0..3).map(|i| n[i] * a[i]).sum();
        let sides = planes.entry([n[0], n[1], n[2], offset]).or_default();
        for i in 0..3 {
            let side = [triangle[i], triangle[(i + 1) % 3]];
            if !sides.remove(&[side[1], side[0]]) {
                assert!(sides.insert(side));
            }
        }
    }
    planes.into_values().collect()
}

/// The triangles that tetrahedra have once, each facing as its tetrahedron says, with an even permutation that puts the least first.
fn rim(tetrahedra: &[[u8; 4]]) -> Vec<[u8; 3]> {
    let mut count: BTreeMap<[u8; 3], Vec<[u8; 3]>> = BTreeMap::new();
    for &[a, b, c, d] in tetrahedra {
        for face in [[b, c, d], [a, d, c], [a, b, d], [a, c, b]] {
            let mut key = face;
            key.sort_unstable();
            count.entry(key).or_default().push(turned(face));
        }
    }
    count
        .into_values()
        .filter_map(|faces| match faces[..] {
            [face] => Some(face),
            [one, two] => {
                assert_eq!(one, turned([two[0], two[2], two[1]]), "two sides of a triangle");
                None
            }
            _ => panic!("a triangle of more than two tetrahedra"),
        })
        .collect()
}

/// The same triangle with the least number first.
fn turned([a, b, c]: [u8; 3]) -> [u8; 3] {
    [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap()
}

#[test]
fn every_facet_of_all_entries_has_the_table_of_three_dimensions() {
    let (four, three) = (Table::<4>::get(), Table::<3>::get());
    let ends = |edges: &[[u8; 2]]| edges.to_vec();
    let edges4 = ends(&four.cube().edges().iter().map(|e| e.corners).collect::<Vec<_>>());
    for entry in 0..1u32 << 16 {
        let mut rim: BTreeSet<[u8; 3]> = rim(four.entry(entry)).into_iter().collect();
        for axis in 0..4 {
            // From three dimensions into the facet: the other axes in order.
            let into = |c: u8, side: u8| {
                let (low, high) = (c & ((1 << axis) - 1), c >> axis);
                low | side << axis | high << (axis + 1)
            };
            for side in 0..2 {
                let inside = (0..8u8).fold(0, |set, c| set | (entry >> into(c, side) & 1) << c);
                let number = |e: u8| {
                    let corners = three.cube().edges()[usize::from(e)].corners.map(|c| into(c, side));
                    edges4.iter().position(|&other| other == corners).unwrap() as u8
                };
                for &[a, b, c] in three.entry(inside) {
                    let [a, b, c] = [a, b, c].map(number);
                    // The facet's outward normal along the axis, and how many axes it is moved across.
                    let is_same = (axis + side as usize).is_multiple_of(2);
                    let face = if is_same { [a, b, c] } else { [a, c, b] };
                    assert!(rim.remove(&turned(face)), "{entry:#06x}, axis {axis}, side {side}");
                }
            }
        }
        assert!(rim.is_empty(), "{entry:#06x}: the surface ends within the cell");
    }
}

#[test]
fn complements_differ_and_nothing_is_empty_that_should_not_be() {
    let table = Table::<4>::get();
    let counts: Vec<usize> = (0..1u32 << 16).map(|entry| table.entry(entry).len()).collect();
    assert_eq!((counts[0], counts[0xffff]), (0, 0));
    assert_eq!(counts.iter().filter(|&&count| count == 0).count(), 2);
    // Every crossed edge has a vertex, and no other edge.
    for entry in 0..1u32 << 16 {
        let used = table.entry(entry).iter().flatten().fold(0, |set, e| set | 1u32 << e);
        assert_eq!(used, table.cube().crossed(entry), "{entry:#06x}");
    }
    assert!((0..1 << 15).any(|entry| counts[entry] != counts[0xffff ^ entry]));
    println!("{} tetrahedra, at most {}", counts.iter().sum::<usize>(), counts.iter().max().unwrap());
}
