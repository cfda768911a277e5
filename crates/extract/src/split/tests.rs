//! The cuts fill the cube, neighbours agree, and the counts are the formulas.

use std::collections::{BTreeMap, BTreeSet};

use glam::Vec3;
use mesh::Bounds;

use super::cut::{Cut, Step, turn};
use crate::spot::tests::normal_lies_between;
use crate::{Arrangement, Lattice};

const BOTH: [Arrangement; 2] = [Arrangement::FiveTetrahedra, Arrangement::FaceCentred];

fn tetrahedra_at(cut: &Cut, cell: [i8; 3]) -> impl Iterator<Item = [Step; 4]> + '_ {
    let parity = cell.iter().sum::<i8>() as usize % 2;
    let lowest = cell.map(|i| i * cut.steps_a_cell as i8);
    let moved = move |corner: Step| [0, 1, 2].map(|axis| corner[axis] + lowest[axis]);
    cut.tetrahedra[parity].iter().map(move |tetrahedron| tetrahedron.corners.map(moved))
}

#[test]
fn tetrahedra_turn_one_way_and_fill_the_cube() {
    for (arrangement, sizes) in BOTH.into_iter().zip([vec![2, 1, 1, 1, 1], vec![2; 24]]) {
        let cut = Cut::of(arrangement);
        let cube = 6 * (cut.steps_a_cell as i32).pow(3);
        for parity in 0..2 {
            let volumes: Vec<i32> = tetrahedra_at(&cut, [parity, 0, 0]).map(turn).collect();
            assert_eq!(volumes, sizes, "{arrangement:?}: one regular of a third, or all equal");
            assert_eq!(volumes.iter().sum::<i32>(), cube);
        }
    }
}

/// Each face of a tetrahedron is that of another one, turned over, or on the outside of the block, where the cubes'
/// faces are covered once.
#[test]
fn faces_meet_inside_and_between_cubes() {
    const CELLS: i8 = 3;
    for arrangement in BOTH {
        let cut = Cut::of(arrangement);
        let mut faces: BTreeSet<[Step; 3]> = BTreeSet::new();
        let cells = (0..CELLS.pow(3)).map(|i| [i % CELLS, i / CELLS % CELLS, i / CELLS.pow(2)]);
        for [o, a, b, c] in cells.flat_map(|cell| tetrahedra_at(&cut, cell).collect::<Vec<_>>()) {
            for face in [[a, b, c], [o, c, b], [o, a, c], [o, b, a]] {
                let least = (0..3).min_by_key(|&k| face[k]).unwrap();
                let turned = [0, 1, 2].map(|k| face[(k + least) % 3]);
                assert!(faces.insert(turned), "{arrangement:?}: {turned:?} twice the same way");
            }
        }
        let end = CELLS * cut.steps_a_cell as i8;
        let outside = |face: &[Step; 3]| {
            (0..3).any(|axis| [0, end].iter().any(|&side| face.iter().all(|corner| corner[axis] == side)))
        };
        for &[a, b, c] in &faces {
            assert_ne!(faces.contains(&[a, c, b]), outside(&[a, b, c]), "{arrangement:?}: {:?}", [a, b, c]);
        }
        // Each square of the outside is cut into two or four.
        let triangles_a_square = if arrangement == Arrangement::FiveTetrahedra { 2 } else { 4 };
        let count = faces.iter().filter(|face| outside(face)).count();
        assert_eq!(count, 6 * (CELLS as usize).pow(2) * triangles_a_square);
    }
}

/// What a point of each class is joined to, by mirroring: every symmetry of its surroundings is one of its edges.
#[test]
fn edges_have_the_symmetry_of_their_point() {
    let bits = |arrangement: Arrangement| {
        let counts = Cut::of(arrangement).edges_of.map(u32::count_ones);
        counts.into_iter().filter(|&count| count > 0).collect::<Vec<_>>()
    };
    assert_eq!(bits(Arrangement::FiveTetrahedra), [18, 6], "even corners have the diagonals");
    assert_eq!(bits(Arrangement::FaceCentred), [26, 6, 6, 6, 14], "corner, face centres, cube centre");
    for arrangement in BOTH {
        let cut = Cut::of(arrangement);
        for edges in cut.edges_of {
            let steps: BTreeSet<Step> =
                (0..cut.steps.len()).filter(|d| edges >> d & 1 != 0).map(|d| cut.steps[d]).collect();
            for axis in 0..3 {
                let mirrored: BTreeSet<Step> = steps
                    .iter()
                    .map(|&step| {
                        let mut step = step;
                        step[axis] = -step[axis];
                        step
                    })
                    .collect();
                assert_eq!(steps, mirrored, "{arrangement:?}");
            }
        }
    }
}

/// Points, edges, tetrahedra, and Euler's formula for a ball.
#[test]
fn counts_are_the_formulas() {
    for arrangement in BOTH {
        let cut = Cut::of(arrangement);
        for cells in [[1i8, 1, 1], [2, 1, 3], [4, 3, 2]] {
            let max = Vec3::from_array(cells.map(f32::from));
            let lattice = Lattice::try_new(arrangement, Bounds { min: Vec3::ZERO, max }, 1.0).unwrap();
            let all: Vec<[Step; 4]> = (0..cells[2])
                .flat_map(|z| (0..cells[1]).flat_map(move |y| (0..cells[0]).map(move |x| [x, y, z])))
                .flat_map(|cell| tetrahedra_at(&cut, cell).collect::<Vec<_>>())
                .collect();
            let mut simplices: BTreeMap<usize, BTreeSet<Vec<Step>>> = BTreeMap::new();
            for tetrahedron in &all {
                for set in 1..16usize {
                    let mut corners: Vec<Step> =
                        (0..4).filter(|i| set >> i & 1 != 0).map(|i| tetrahedron[i]).collect();
                    corners.sort_unstable();
                    simplices.entry(corners.len()).or_default().insert(corners);
                }
            }
            let count = |corners: usize| simplices[&corners].len() as u64;
            assert_eq!(count(1), lattice.needed_samples(), "{arrangement:?} {cells:?} points");
            assert_eq!(count(2), lattice.needed_edges(), "{arrangement:?} {cells:?} edges");
            assert_eq!(count(4), lattice.tetrahedra(), "{arrangement:?} {cells:?} tetrahedra");
            assert_eq!(count(1) + count(3), count(2) + count(4) + 1, "a ball");
        }
    }
}

/// So that a sample that equals the isovalue turns no triangle over ([`crate::spot::Apart`]).
#[test]
fn normals_of_faces_lie_between_the_edges_that_lead_there() {
    for arrangement in BOTH {
        let cut = Cut::of(arrangement);
        for corners in (0..2).flat_map(|parity| tetrahedra_at(&cut, [parity, 0, 0]).collect::<Vec<_>>()) {
            let corners = corners.map(|corner| glam::DVec3::from_array(corner.map(f64::from)));
            for from in 0..4 {
                let edges = [1, 2, 3].map(|k| corners[(from + k) % 4] - corners[from]);
                assert!(normal_lies_between(edges), "{arrangement} {corners:?}");
            }
        }
    }
}
