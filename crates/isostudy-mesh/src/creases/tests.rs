use super::*;
use crate::{topology, weld};
use std::f64::consts::TAU;

/// A cube with the corners of the unit cube round the origin, whose sides share them; two triangles per side.
fn cube() -> TriangleMesh {
    let corner = |i: usize| Vec3::from([i & 1, i >> 1 & 1, i >> 2].map(|bit| bit as f32 - 0.5));
    let positions: Vec<Vec3> = (0..8).map(corner).collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriangleMesh { normals: positions.iter().map(|p| p.normalize()).collect(), positions, triangles }
}

/// A closed cylinder of radius 1 from z = -1 to 1, caps as fans round their middles; vertices on the rims are shared.
fn cylinder(steps: u32) -> TriangleMesh {
    let mut positions = vec![Vec3::NEG_Z, Vec3::Z];
    for i in 0..steps {
        let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(steps));
        positions.extend([-1.0, 1.0].map(|z| Vec3::new(cos as f32, sin as f32, z)));
    }
    let at = |i: u32, top: u32| 2 + 2 * (i % steps) + top;
    let of = |i: u32| {
        let [a, b, c, d] = [at(i, 0), at(i + 1, 0), at(i + 1, 1), at(i, 1)];
        [[a, b, c], [a, c, d], [0, b, a], [1, d, c]]
    };
    let triangles = (0..steps).flat_map(of).collect();
    TriangleMesh { positions, normals: Vec::new(), triangles }
}

/// The normal of every corner.
fn of_corners(mesh: &TriangleMesh, crease_deg: f32) -> Vec<[Vec3; 3]> {
    let made = corner_normals(mesh, crease_deg);
    made.corners.iter().map(|t| t.map(|place| made.normals[place as usize])).collect()
}

fn face_normal(mesh: &TriangleMesh, t: usize) -> Vec3 {
    let [a, b, c] = mesh.corners(t);
    (b - a).cross(c - a).normalize()
}

#[test]
fn a_cube_has_the_normals_of_its_sides() {
    let mesh = cube();
    for (t, normals) in of_corners(&mesh, 40.0).into_iter().enumerate() {
        assert_eq!(normals, [face_normal(&mesh, t); 3]);
    }
    let split = corner_normals(&mesh, 40.0).split(&mesh);
    assert_eq!((split.positions.len(), split.triangles.len()), (24, 12));
    // Three sides at each corner.
    assert_eq!(corner_normals(&mesh, 40.0).copies, (0..8).flat_map(|v| [v; 3]).collect::<Vec<u32>>());
}

/// The edges of a cube turn by 90 degrees: below it all are creases, above it none.
#[test]
fn the_angle_decides() {
    let mesh = cube();
    assert_eq!(corner_normals(&mesh, 89.9).copies.len(), 24);
    let smooth = corner_normals(&mesh, 90.1);
    assert_eq!((smooth.copies.len(), &smooth.normals, &smooth.corners), (0, &mesh.normals, &mesh.triangles));
}

/// The authority is the cylinder's equation: outward on the side, along the axis on the caps. Twelve steps turn by 30
/// degrees and are smooth; a side's normal is the mean of two faces that lie symmetrically, so it is exact.
#[test]
fn a_cylinder_is_smooth_around_and_flat_at_its_ends() {
    for steps in [12, 90] {
        let mesh = cylinder(steps);
        for (t, normals) in of_corners(&mesh, 40.0).into_iter().enumerate() {
            let is_cap = face_normal(&mesh, t).z.abs() > 0.5;
            for (normal, at) in normals.into_iter().zip(mesh.corners(t)) {
                let want = if is_cap { Vec3::Z * at.z } else { Vec3::new(at.x, at.y, 0.0) };
                assert!(normal.distance(want) < 1e-6, "{steps}: {normal} is not {want}");
            }
        }
    }
    // Eight steps turn by 45 degrees: every side is flat.
    let mesh = cylinder(8);
    for (t, normals) in of_corners(&mesh, 40.0).into_iter().enumerate() {
        assert!(normals.iter().all(|n| n.distance(face_normal(&mesh, t)) < 1e-6));
    }
}

/// Where the fan is smooth the mesh's normal stays to the bit, whatever it is.
#[test]
fn smooth_fans_keep_the_normals_of_the_mesh() {
    let mut mesh = cylinder(24);
    let odd = Vec3::new(0.1, 0.2, 0.97);
    mesh.normals = vec![odd; mesh.positions.len()];
    let made = corner_normals(&mesh, 40.0);
    assert_eq!(made.normals[..mesh.normals.len()], mesh.normals[..]);
    // The caps' middles have a flat fan.
    for (triangle, corners) in mesh.triangles.iter().zip(&made.corners) {
        for (vertex, place) in triangle.iter().zip(corners) {
            assert_eq!(*vertex < 2, place == vertex, "vertices on rims alone are split");
        }
    }
}

/// A crease that ends in a vertex: there a way leads around, and the fan is one group.
#[test]
fn a_crease_may_end() {
    // Vertex 0 in the middle, twelve around it; the fold along 0-1 fades out to both sides.
    let ring = |i: u32| {
        let (sin, cos) = libm::sincos(TAU * f64::from(i) / 12.0);
        let away = f64::from(i.min(12 - i));
        Vec3::from([cos, sin, 1.5 * libm::exp(-0.6 * away)].map(|v| v as f32))
    };
    let mut positions = vec![Vec3::ZERO];
    positions.extend((0..12).map(ring));
    let triangles = (0..12).map(|i| [0, 1 + i, 1 + (i + 1) % 12]).collect();
    let mesh = TriangleMesh { positions, normals: vec![Vec3::Z; 13], triangles };
    let turn = |a, b| face_normal(&mesh, a).angle_between(face_normal(&mesh, b)).to_degrees();
    assert!(turn(0, 11) > 45.0, "{}", turn(0, 11));
    assert!((0..11).all(|i| turn(i, i + 1) < 35.0));
    let made = corner_normals(&mesh, 40.0);
    // The middle is one group around; the other end of the fold has two.
    assert_eq!(made.copies, [1, 1]);
}

/// Slivers on a flat square and beside the edge of a fold neither join what turns nor part what does not.
#[test]
fn triangles_without_direction_do_not_decide() {
    // A fold by 90 degrees along y, with a needle of no width on the fold and one on the flat part.
    let positions = [
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 0.0, -1.0],
        [0.0, 0.5, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.5, 0.5, 0.0],
    ]
    .map(Vec3::from);
    let mesh = TriangleMesh {
        positions: positions.to_vec(),
        normals: vec![Vec3::ONE.normalize(); 8],
        // Up: 0 2 1 with the sliver 1 2 7, beyond which is 2 6 ... ; down the wall: 0 4 3 and 4 1 3 beyond the cap 0 1 4.
        triangles: vec![[0, 2, 1], [0, 1, 4], [0, 4, 3], [4, 1, 3], [1, 2, 7], [2, 6, 7], [6, 1, 7]],
    };
    let normals = of_corners(&mesh, 40.0);
    for (t, up) in [(0, true), (2, false), (3, false), (5, true), (6, true)] {
        let want = if up { Vec3::Z } else { Vec3::NEG_X };
        for (corner, at) in normals[t].iter().zip(mesh.triangles[t]) {
            // Only the ends of the fold are split.
            let want = if [0, 1].contains(&at) { want } else { mesh.normals[0] };
            assert_eq!(*corner, want, "triangle {t}, vertex {at}");
        }
    }
}

/// Four triangles at one edge: two sheets that touch, each with a normal of its own.
#[test]
fn sheets_that_touch_in_an_edge_stay_apart() {
    let positions =
        [[0., 0., 0.], [0., 1., 0.], [1., 0., 0.1], [-1., 0., 0.1], [1., 0., -0.1], [-1., 0., -0.1]];
    let mesh = TriangleMesh {
        positions: positions.map(Vec3::from).to_vec(),
        normals: Vec::new(),
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 1, 4], [0, 5, 1]],
    };
    let normals = of_corners(&mesh, 40.0);
    assert!(normals[0][0].z > 0.99 && normals[0][0] == normals[1][0]);
    assert!(normals[2][0].z < -0.99 && normals[2][0] == normals[3][0]);
}

/// Two triangles that run their edge the same way face different ways: nothing is averaged.
#[test]
fn triangles_turned_against_each_other_share_nothing() {
    let positions = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]];
    let mesh = TriangleMesh {
        positions: positions.map(Vec3::from).to_vec(),
        normals: Vec::new(),
        triangles: vec![[0, 1, 2], [1, 2, 3]],
    };
    let normals = of_corners(&mesh, 40.0);
    assert_eq!((normals[0], normals[1]), ([Vec3::Z; 3], [Vec3::NEG_Z; 3]));
}

#[test]
fn vertices_are_copies_that_weld() {
    let mesh = cylinder(24);
    let made = corner_normals(&mesh, 40.0);
    for split in [made.split(&mesh), made.with_copies(&mesh)] {
        let normals = |t: usize| split.triangles[t].map(|v| split.normals[v as usize]);
        assert_eq!((0..mesh.triangles.len()).map(normals).collect::<Vec<_>>(), of_corners(&mesh, 40.0));
        for t in 0..mesh.triangles.len() {
            assert_eq!(split.corners(t), mesh.corners(t));
        }
        assert_eq!(weld(&split), TriangleMesh { normals: Vec::new(), ..mesh.clone() });
    }
    assert_eq!(made.split(&mesh).positions.len(), 2 + 4 * 24, "every rim vertex twice");
    assert!(topology::topology(&weld(&made.split(&mesh))).is_closed_manifold());
}

/// Brute force: the group of a corner is what a walk over all pairs of triangles at the vertex reaches.
#[test]
fn groups_are_those_of_a_plain_search() {
    let mut state = 1u64;
    let mut random = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 40) as f32 / (1u64 << 24) as f32
    };
    for crease in [10.0, 25.0, 40.0, 70.0] {
        // A rough closed surface: a cylinder with every vertex moved.
        let mut mesh = cylinder(30);
        mesh.positions.iter_mut().for_each(|p| *p += 0.12 * Vec3::new(random(), random(), random()));
        mesh.normals = vec![Vec3::X; mesh.positions.len()];
        let found = of_corners(&mesh, crease);
        let turns_less = |a: usize, b: usize| {
            face_normal(&mesh, a).angle_between(face_normal(&mesh, b)).to_degrees() < crease
        };
        for (t, corners) in mesh.triangles.iter().enumerate() {
            for (k, &vertex) in corners.iter().enumerate() {
                let fan: Vec<usize> =
                    (0..mesh.triangles.len()).filter(|&t| mesh.triangles[t].contains(&vertex)).collect();
                let shared = |a: usize, b: usize| {
                    mesh.triangles[a].iter().filter(|v| mesh.triangles[b].contains(v)).count()
                };
                let mut group = vec![t];
                let mut at = 0;
                while at < group.len() {
                    let more: Vec<usize> = fan
                        .iter()
                        .copied()
                        .filter(|&b| !group.contains(&b))
                        .filter(|&b| shared(group[at], b) == 2 && turns_less(group[at], b))
                        .collect();
                    group.extend(more);
                    at += 1;
                }
                let want = if group.len() == fan.len() {
                    Vec3::X
                } else {
                    let sum: Vec3 = group
                        .iter()
                        .map(|&t| {
                            let own = mesh.triangles[t].iter().position(|&v| v == vertex).unwrap();
                            let [a, b, c] = [0, 1, 2].map(|i| mesh.corners(t)[(own + i) % 3]);
                            (b - a).cross(c - a) * (b - a).angle_between(c - a)
                        })
                        .sum();
                    sum.normalize()
                };
                assert!(found[t][k].distance(want) < 1e-4, "{crease}: {} is not {want}", found[t][k]);
            }
        }
    }
}
