use super::*;
use crate::shapes::{cube, icosphere, sheet, torus};
use isostudy_mesh::metro::{Amount, Sampling, metro};
use isostudy_mesh::quality::quality;
use isostudy_mesh::topology::topology;

fn retile(mesh: &TriangleMesh, points: usize, by: Density) -> Finished {
    Retile { points, by, seed: 1 }.run(mesh).unwrap()
}

fn hausdorff(a: &TriangleMesh, b: &TriangleMesh) -> f64 {
    metro(a, b, &Sampling { amount: Amount::Samples(20_000), seed: 1 }).unwrap().hausdorff()
}

#[test]
fn the_mesh_has_exactly_so_many_vertices_and_its_topology() {
    for mesh in [icosphere(4), torus(0.4, 48, 20), cube(6)] {
        let before = topology(&mesh);
        for points in [150, 700, 2500] {
            let found = retile(&mesh, points, Density::Area);
            assert_eq!(found.stopped, [], "{points}");
            let after = topology(&found.mesh);
            assert_eq!(found.mesh.positions.len(), points);
            assert!(after.is_closed_manifold());
            assert_eq!(after.euler_characteristic, before.euler_characteristic);
        }
    }
}

#[test]
fn its_triangles_are_near_equilateral_and_close() {
    let mesh = icosphere(5);
    let found = retile(&mesh, 1000, Density::Area).mesh;
    let of = quality(&found);
    assert!(of.radius_ratio.mean > 0.9, "{}", of.radius_ratio.mean);
    assert!(of.min_angle_deg.min > 20.0, "{}", of.min_angle_deg.min);
    // Equal triangles of a sphere: 2 (n - 2) of them, with a sagitta of 4.84 over their number.
    let error = hausdorff(&found, &mesh) / (4.84 / 1996.0);
    assert!(error < 3.0, "{error} of the error of equal triangles");
    for t in 0..found.triangles.len() {
        let [a, b, c] = found.corners(t);
        assert!((b - a).cross(c - a).dot(a + b + c) > 0.0, "triangle {t} faces inwards");
    }
}

#[test]
fn borders_stay_and_count() {
    let found = retile(&sheet(6), 200, Density::Area);
    assert_eq!(found.stopped, []);
    assert_eq!(found.mesh.positions.len(), 200);
    let after = topology(&found.mesh);
    assert_eq!((after.boundary_edges, after.boundary_loops, after.euler_characteristic), (24, 1, 1));
    assert!((found.mesh.area() - 1.0).abs() < 1e-5);
    let error = Retile { points: 24, by: Density::Area, seed: 1 }.run(&sheet(6)).unwrap_err();
    assert_eq!(error, FinishError::StayingVertices { points: 24, staying: 24 });
}

#[test]
fn what_topology_needs_is_left_with_its_place() {
    // A torus has at least seven vertices.
    let found = retile(&torus(0.4, 24, 12), 3, Density::Area);
    let [stopped] = found.stopped[..] else { panic!("three are too few") };
    assert!(stopped.left >= 4, "{stopped:?}");
    assert!(found.mesh.positions.contains(&stopped.at));
    assert_eq!(found.mesh.positions.len() as u64, 3 + stopped.left);
    let after = topology(&found.mesh);
    assert!(after.is_closed_manifold() && after.euler_characteristic == 0);
}

#[test]
fn curvature_draws_points() {
    // A ball drawn out to ten times its height bends at its tips.
    let mesh = icosphere(5).transformed(|p| p * isostudy_mesh::glam::Vec3::new(1.0, 1.0, 4.0));
    let tips = |mesh: &TriangleMesh| mesh.positions.iter().filter(|p| p.z.abs() > 3.2).count();
    let [even, bent] = [Density::Area, Density::Curvature].map(|by| retile(&mesh, 600, by).mesh);
    assert_eq!((even.positions.len(), bent.positions.len()), (600, 600));
    assert!(tips(&bent) as f64 > 1.5 * tips(&even) as f64, "{} and {}", tips(&bent), tips(&even));
    assert!(topology(&bent).is_closed_manifold());
    assert!(hausdorff(&bent, &mesh) < hausdorff(&even, &mesh));
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_others() {
    let mesh = icosphere(3);
    let run = |seed| Retile { points: 100, by: Density::Area, seed }.run(&mesh).unwrap().mesh;
    assert_eq!(run(4), run(4));
    assert_ne!(run(4), run(5));
}

#[test]
fn points_that_are_too_close_are_refused_with_their_place() {
    // A triangle of 2^-22 at 1 has a few places in single precision.
    let far = Vec3::ONE;
    let step = 2f32.powi(-22);
    let mesh = TriangleMesh {
        positions: [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|p| far + step * p).to_vec(),
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        ..TriangleMesh::default()
    };
    let error = Retile { points: 100, by: Density::Area, seed: 1 }.run(&mesh).unwrap_err();
    assert!(matches!(error, FinishError::TooClose { points: 100, .. }), "{error}");
    let flat =
        TriangleMesh { positions: vec![Vec3::X; 3], triangles: vec![[0, 1, 2]], ..TriangleMesh::default() };
    let error = Retile { points: 100, by: Density::Area, seed: 1 }.run(&flat).unwrap_err();
    assert_eq!(error, FinishError::NoArea);
}
