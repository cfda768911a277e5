//! Meshes held against samples: what is right is right, and every fault is found.

use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::Vec3;
use isostudy_trilinear::{Fault, Samples, Ties, verify};

/// One sample above the level in the middle of 3^3.
fn volume() -> Vec<f32> {
    let mut values = vec![-1.0; 27];
    values[13] = 1.0;
    values
}

fn octahedron(centre: Vec3, first: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let places = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    (places.map(|p| centre + 0.5 * p).to_vec(), faces.map(|f| f.map(|v| v + first)).to_vec())
}

fn mesh(parts: &[(Vec<Vec3>, Vec<[u32; 3]>)]) -> TriangleMesh {
    let positions = parts.iter().flat_map(|(positions, _)| positions.clone()).collect();
    let triangles = parts.iter().flat_map(|(_, triangles)| triangles.clone()).collect();
    TriangleMesh { positions, triangles, ..TriangleMesh::default() }
}

fn faults(mesh: &TriangleMesh, values: &[f32]) -> Vec<Fault> {
    let samples = Samples::try_new([3; 3], values).unwrap();
    let verdict = verify(mesh, &samples, 0.0, Ties::Outside).unwrap();
    assert_eq!(verdict.is_right(), verdict.findings.is_empty());
    verdict.findings.iter().map(|finding| finding.fault).collect()
}

#[test]
fn the_octahedron_round_a_sample_is_right() {
    assert_eq!(faults(&mesh(&[octahedron(Vec3::ONE, 0)]), &volume()), []);
}

#[test]
fn every_fault_is_found() {
    let whole = mesh(&[octahedron(Vec3::ONE, 0)]);
    let values = volume();
    let mut open = whole.clone();
    open.triangles.pop();
    assert_eq!(faults(&open, &values), [Fault::BoundaryLoops, Fault::EulerCharacteristic]);
    let mut turned = whole.clone();
    turned.triangles[3].swap(0, 1);
    assert_eq!(faults(&turned, &values), [Fault::MisorientedEdges]);
    let mut twice = whole.clone();
    twice.triangles.push(twice.triangles[0]);
    let found = faults(&twice, &values);
    assert!(found.contains(&Fault::NonManifoldEdges) && found.contains(&Fault::DuplicateTriangles));
    let mut collapsed = whole.clone();
    collapsed.triangles.push([0, 0, 2]);
    assert_eq!(faults(&collapsed, &values), [Fault::CollapsedTriangles]);
    let two = mesh(&[octahedron(Vec3::ONE, 0), octahedron(Vec3::splat(9.0), 6)]);
    assert_eq!(faults(&two, &values), [Fault::Components, Fault::EulerCharacteristic]);
    let mut touching = two;
    touching.triangles.iter_mut().flatten().for_each(|v| *v = if *v == 6 { 0 } else { *v });
    let found = faults(&touching, &values);
    assert!(found.contains(&Fault::NonManifoldVertices), "{found:?}");
    assert_eq!(faults(&TriangleMesh::default(), &values), [Fault::Components, Fault::EulerCharacteristic]);
}

/// A ball inside a shell is two spheres; a torus and a sphere with a handle less are the same in sum only.
#[test]
fn components_are_compared_one_by_one() {
    // A ring of samples round the middle of 5 x 5 x 3, and one by itself: a torus and a sphere.
    let counts = [7, 5, 3];
    let ring = [[1, 1], [2, 1], [3, 1], [1, 2], [3, 2], [1, 3], [2, 3], [3, 3], [5, 2]];
    let mut values = vec![-1.0; counts.iter().product()];
    for [x, y] in ring {
        values[(counts[1] + y) * counts[0] + x] = 1.0;
    }
    let samples = Samples::try_new(counts, &values).unwrap();
    let surface = isostudy_trilinear::topology(&samples, 0.0, Ties::Outside).unwrap();
    let mut euler: Vec<i64> = surface.components.iter().map(|c| c.euler_characteristic).collect();
    euler.sort_unstable();
    assert_eq!(euler, [0, 2]);
    assert_eq!(surface.genus(), 1);
    let spheres = mesh(&[octahedron(Vec3::ONE, 0), octahedron(Vec3::splat(9.0), 6)]);
    let verdict = verify(&spheres, &samples, 0.0, Ties::Outside).unwrap();
    let found: Vec<Fault> = verdict.findings.iter().map(|finding| finding.fault).collect();
    assert_eq!(found, [Fault::EulerCharacteristic, Fault::Tunnels]);
}
