use super::*;
use crate::shapes::{cube, icosphere, sheet, torus};
use isostudy_mesh::glam::Vec3;
use isostudy_mesh::metro::{Amount, Sampling, metro};
use isostudy_mesh::topology::topology;

fn hausdorff(a: &TriangleMesh, b: &TriangleMesh) -> f64 {
    metro(a, b, &Sampling { amount: Amount::Samples(20_000), seed: 1 }).unwrap().hausdorff()
}

/// A mesh turned and moved, so that no plane is along the axes.
fn turned(mesh: &TriangleMesh) -> TriangleMesh {
    let (x, y) = (Vec3::new(2.0, -1.0, 2.0) / 3.0, Vec3::new(2.0, 2.0, -1.0) / 3.0);
    let z = x.cross(y);
    mesh.transformed(|p| x * p.x + y * p.y + z * p.z + Vec3::new(5.0, -3.0, 2.0))
}

#[test]
fn a_box_of_any_number_of_cells_is_twelve_triangles() {
    for n in [1, 2, 3, 7, 16] {
        for mesh in [cube(n), turned(&cube(n))] {
            let found = coplanar(&mesh, 0.0);
            assert_eq!((found.positions.len(), found.triangles.len()), (8, 12), "{n}");
            assert!(topology(&found).is_closed_manifold());
            assert!((found.volume() - 1.0).abs() < 1e-5);
            assert!(hausdorff(&found, &mesh) < 1e-5);
        }
    }
}

/// Squares of a grid, those left out whose place says so.
fn pierced(n: u32, is_hole: impl Fn(u32, u32) -> bool) -> TriangleMesh {
    let mut mesh = sheet(n);
    let mut square = 0;
    mesh.triangles.retain(|_| {
        let (i, j) = (square / 2 / n, square / 2 % n);
        square += 1;
        !is_hole(i, j)
    });
    mesh
}

#[test]
fn a_plate_with_holes_has_as_few_triangles_as_its_outline_allows() {
    // Outline and each square hole have four corners: n - 2 + 2 h with n = 4 (h + 1).
    for (h, mesh) in [
        (1, pierced(9, |i, j| (3..6).contains(&i) && (3..6).contains(&j))),
        (4, pierced(9, |i, j| (i == 2 || i == 6) && (j == 2 || j == 6))),
        (9, pierced(13, |i, j| i % 4 == 2 && j % 4 == 2)),
    ] {
        for mesh in [mesh.clone(), turned(&mesh)] {
            let found = coplanar(&mesh, 0.0);
            let before = topology(&mesh);
            let after = topology(&found);
            assert_eq!(found.triangles.len(), 4 * (h + 1) - 2 + 2 * h, "{h} holes");
            assert_eq!(found.positions.len(), 4 * (h + 1));
            assert_eq!(after.boundary_loops, h as u64 + 1);
            assert_eq!(after.euler_characteristic, before.euler_characteristic);
            assert_eq!((after.non_manifold_edges, after.misoriented_edges), (0, 0));
            assert!((found.area() - mesh.area()).abs() < 1e-5);
            assert!(hausdorff(&found, &mesh) < 1e-5);
        }
    }
}

#[test]
fn holes_that_touch_keep_what_they_touch_in() {
    // Two holes meet in a corner: the vertex there has two fans, and what is round it stays.
    let mesh = pierced(6, |i, j| (i, j) == (2, 2) || (i, j) == (3, 3));
    let found = coplanar(&mesh, 0.0);
    let (before, after) = (topology(&mesh), topology(&found));
    assert_eq!(after.euler_characteristic, before.euler_characteristic);
    assert_eq!(after.non_manifold_vertices, before.non_manifold_vertices);
    assert!((found.area() - mesh.area()).abs() < 1e-6);
}

#[test]
fn random_plates_keep_their_area_and_holes() {
    // Every pattern of holes that leaves no vertex with two fans is drawn by the fewest triangles.
    let mut drawn = 0;
    for seed in 0..400u32 {
        let is_hole = |i: u32, j: u32| {
            let mixed = (i * 7 + j).wrapping_mul(2_654_435_761).wrapping_add(seed.wrapping_mul(40_503 * 97));
            (1..6).contains(&i)
                && (1..6).contains(&j)
                && (mixed ^ (mixed >> 13)).wrapping_mul(0x5bd1_e995) >> 30 == 0
        };
        let mesh = turned(&pierced(7, is_hole));
        let (before, found) = (topology(&mesh), coplanar(&mesh, 0.0));
        let after = topology(&found);
        assert_eq!(after.euler_characteristic, before.euler_characteristic, "seed {seed}");
        assert_eq!(after.boundary_loops, before.boundary_loops, "seed {seed}");
        assert_eq!((after.non_manifold_edges, after.misoriented_edges), (0, 0), "seed {seed}");
        assert!((found.area() - mesh.area()).abs() < 1e-5, "seed {seed}");
        if before.non_manifold_vertices == 0 && before.components == 1 {
            let holes = after.boundary_loops as usize - 1;
            assert_eq!(found.triangles.len(), found.positions.len() - 2 + 2 * holes, "seed {seed}");
            drawn += 1;
        }
    }
    assert!(drawn > 50, "{drawn} patterns have no vertex with two fans");
}

#[test]
fn what_is_curved_stays() {
    for mesh in [icosphere(3), torus(0.4, 24, 12)] {
        let found = coplanar(&mesh, 0.0);
        // A torus of quadrilaterals has flat ones.
        assert!(found.triangles.len() <= mesh.triangles.len());
        assert_eq!(topology(&found).euler_characteristic, topology(&mesh).euler_characteristic);
        assert_eq!(found.positions.len(), mesh.positions.len());
    }
}

#[test]
fn a_tolerance_flattens_what_lies_within() {
    let mesh = icosphere(5);
    let before = topology(&mesh);
    let mut last = mesh.triangles.len();
    for tolerance in [0.005, 0.01, 0.03] {
        let found = coplanar(&mesh, tolerance);
        let after = topology(&found);
        assert!(found.triangles.len() < last, "{tolerance}");
        assert!(after.is_closed_manifold() && after.euler_characteristic == before.euler_characteristic);
        assert!(hausdorff(&found, &mesh) < 2.5 * tolerance, "{tolerance}: {}", hausdorff(&found, &mesh));
        last = found.triangles.len();
    }
}

#[test]
fn thin_triangles_in_a_plane_join_it() {
    // A square with a vertex on a side, twice: a triangle without area between them.
    let mesh = TriangleMesh {
        positions: [[0., 0., 0.], [2., 0., 0.], [2., 2., 0.], [0., 2., 0.], [1., 0., 0.], [0., 1., 0.]]
            .map(Vec3::from)
            .to_vec(),
        triangles: vec![[0, 1, 4], [4, 1, 2], [4, 2, 3], [4, 3, 5], [4, 5, 0]],
        ..TriangleMesh::default()
    };
    let found = coplanar(&mesh, 0.0);
    assert_eq!((found.triangles.len(), found.positions.len()), (2, 4));
    assert!((found.area() - 4.0).abs() < 1e-6);
}

#[test]
fn both_sides_of_a_card_do_not_share_their_diagonals() {
    // A card without thickness: two regions with one outline of eight vertices.
    let n = 8;
    let positions = (0..n).map(|i| {
        let turn = std::f32::consts::TAU * i as f32 / n as f32;
        Vec3::new(turn.cos(), turn.sin(), 0.0)
    });
    let fan = (1..n - 1).map(|i| [0, i, i + 1]);
    let other = (2..n).map(|i| [1, (i + 1) % n, i]);
    let mesh = TriangleMesh {
        positions: positions.collect(),
        triangles: fan.chain(other).collect(),
        ..TriangleMesh::default()
    };
    let before = topology(&mesh);
    assert!(before.is_closed_manifold());
    let after = topology(&coplanar(&mesh, 0.0));
    assert_eq!(after.non_manifold_edges, 0);
    assert_eq!(after.euler_characteristic, 2);
}
