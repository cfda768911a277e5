//! All steps on meshes that nobody would make.

use crate::{Density, Extent, Step};
use isostudy_mesh::glam::Vec3;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{TriangleMesh, metro};
use proptest::prelude::*;

const STEPS: [Step; 7] = [
    Step::Coplanar { tolerance: 0.0 },
    Step::Coplanar { tolerance: 0.6 },
    Step::Decimate { triangles: Some(1), ratio: None, error: None, lock_borders: false },
    Step::Decimate { triangles: Some(1), ratio: None, error: None, lock_borders: true },
    Step::Decimate { triangles: None, ratio: None, error: Some(0.5), lock_borders: false },
    Step::ReTile { points: 40, by: Density::Area, seed: 1 },
    Step::ReTile { points: 40, by: Density::Curvature, seed: 1 },
];

/// What is to stay: Euler characteristic, pieces, faults and borders.
fn kept(mesh: &TriangleMesh) -> [i64; 6] {
    let of = topology(mesh);
    let faults = [of.non_manifold_edges, of.misoriented_edges, of.non_manifold_vertices];
    let [a, b, c] = faults.map(|count| count as i64);
    [of.euler_characteristic, of.components as i64, a, b, c, of.boundary_loops as i64]
}

/// Triangles between a few points of a grid: in one plane, folded, twice, pierced and without area.
fn soup() -> impl Strategy<Value = TriangleMesh> {
    let points = prop::collection::vec(prop::array::uniform3(0i32..4), 4..14);
    let corners = prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 1..40);
    (points, corners).prop_map(|(points, corners)| {
        let positions: Vec<Vec3> = points.iter().map(|p| Vec3::from(p.map(|c| c as f32))).collect();
        let corners = corners.iter().map(|t| t.map(|corner| corner.index(positions.len()) as u32));
        TriangleMesh { triangles: corners.collect(), positions, normals: Vec::new() }
    })
}

/// A sheet of squares over a field of heights, of which some are left out: borders, holes, flat parts and steps.
fn sheet() -> impl Strategy<Value = TriangleMesh> {
    let heights = prop::collection::vec(0i32..3, 49);
    let squares = prop::collection::vec(0u32..5, 36);
    (heights, squares).prop_map(|(heights, squares)| {
        let at = |i: usize| Vec3::new((i % 7) as f32, (i / 7) as f32, heights[i] as f32);
        let mut triangles = Vec::new();
        for (s, _) in squares.iter().enumerate().filter(|(_, keep)| **keep > 0) {
            let first = (s / 6 * 7 + s % 6) as u32;
            triangles.extend([[first, first + 1, first + 8], [first, first + 8, first + 7]]);
        }
        TriangleMesh { positions: (0..49).map(at).collect(), triangles, normals: Vec::new() }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn whatever_the_mesh_topology_stays(mesh in prop_oneof![soup(), sheet()]) {
        for step in STEPS {
            if let Ok(found) = step.apply(&mesh, Extent::Whole) {
                prop_assert_eq!(kept(&found.mesh), kept(&mesh), "{:?}", step);
                // Of two triangles on the same corners, points make more than two.
                let twice = |mesh| topology(mesh).duplicate_faces;
                prop_assert!(twice(&found.mesh) <= twice(&mesh), "{:?}", step);
                prop_assert!(found.mesh.positions.iter().all(|p| p.is_finite()));
                let again = step.apply(&mesh, Extent::Whole).unwrap();
                prop_assert_eq!(again, found);
            }
        }
    }

    /// Of a sheet no step goes far away.
    #[test]
    fn what_is_flat_stays_in_its_plane(mesh in sheet()) {
        let flat = mesh.transformed(|p| Vec3::new(p.x, p.y, 0.0));
        for step in [STEPS[0], STEPS[2], STEPS[4]] {
            let found = step.apply(&flat, Extent::Whole).unwrap().mesh;
            prop_assert!(found.positions.iter().all(|p| p.z.abs() < 1e-5));
            if matches!(step, Step::Coplanar { .. }) {
                prop_assert!((found.area() - flat.area()).abs() < 1e-4);
                let sampling = metro::Sampling { amount: metro::Amount::Samples(500), seed: 1 };
                let far = metro::metro(&found, &flat, &sampling).unwrap().hausdorff();
                prop_assert!(far < 1e-4, "{}", far);
            }
        }
    }
}

/// What random meshes found: points that insertion put twice on an edge, and a triangle that hung on a fault and was lost.
#[test]
fn meshes_that_broke_a_step_once() {
    let at = |points: &[[f32; 3]]| points.iter().copied().map(Vec3::from).collect();
    let card = TriangleMesh {
        positions: at(&[[0., 2., 0.], [2., 0., 2.], [1., 1., 1.], [3., 0., 0.]]),
        triangles: vec![
            [1, 3, 0],
            [2, 3, 0],
            [3, 1, 0],
            [2, 3, 0],
            [1, 2, 3],
            [1, 3, 2],
            [1, 0, 3],
            [1, 2, 0],
        ],
        ..TriangleMesh::default()
    };
    let bow_tie = TriangleMesh {
        positions: at(&[[0.; 3]; 5]),
        triangles: vec![[4, 0, 1], [0, 2, 3]],
        ..TriangleMesh::default()
    };
    for mesh in [card, bow_tie] {
        for step in STEPS {
            if let Ok(found) = step.apply(&mesh, Extent::Whole) {
                assert_eq!(kept(&found.mesh), kept(&mesh), "{step:?}");
            }
        }
    }
}
