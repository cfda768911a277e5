//! Holes closed on small shapes and on the Stanford bunny.

use std::fs::File;
use std::path::Path;

use crate::shapes::*;
use isostudy_mesh::repair::*;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{TriangleMesh, read_obj, read_ply};

#[test]
fn unused_vertices_go_and_normals_move_along() {
    let mut spare = cube();
    spare.positions.insert(0, [9.0; 3].into());
    spare.normals = (0..9).map(|i| [i as f32, 0.0, 0.0].into()).collect();
    spare.triangles.iter_mut().flatten().for_each(|v| *v += 1);
    let tidy = drop_unused_vertices(&spare);
    assert_eq!((&tidy.positions, &tidy.triangles), (&cube().positions, &cube().triangles));
    assert_eq!(tidy.normals[0].x, 1.0);
    assert_eq!(drop_unused_vertices(&tidy), tidy);
}

#[test]
fn a_missing_cube_face_is_closed_where_it_was() {
    let mut open = cube();
    open.triangles.drain(..2);
    let loops = boundary_loops(&open).unwrap();
    assert_eq!(loops.len(), 1);
    assert!(loops[0].iter().zip(loops[0].iter().cycle().skip(1)).all(|(a, b)| a[1] == b[0]), "{loops:?}");
    let closed = closed_solid(&open).unwrap();
    assert!(topology(&closed).is_closed_manifold());
    assert_eq!(closed.positions[8].to_array(), [0.5, 0.5, 0.0]);
    assert!((closed.volume() - 1.0).abs() < 1e-6 && (closed.area() - 6.0).abs() < 1e-6);
    assert!((closed_solid(&flip(&open)).unwrap().volume() - 1.0).abs() < 1e-6, "turned outward");
    assert_eq!(close_boundary_loops(&cube()).unwrap(), cube(), "nothing to do");
}

#[test]
fn holes_that_touch_are_closed_apart() {
    let mut open = icosahedron();
    let first = open.triangles.remove(0);
    let shared = |t: &[u32; 3]| t.iter().filter(|v| first.contains(v)).count();
    let second = open.triangles.iter().position(|t| shared(t) == 1).unwrap();
    open.triangles.remove(second);
    let closed = close_boundary_loops(&open).unwrap();
    let report = topology(&closed);
    // The common vertex has one fan again, since both fans' loops are closed on it.
    assert_eq!((report.boundary_edges, report.euler_characteristic, closed.positions.len()), (0, 2, 14));
    assert!(report.is_closed_manifold(), "{report:?}");
}

#[test]
fn what_has_no_inside_is_refused_by_name() {
    let mut fin = cube();
    fin.positions.push([0.5, -1.0, 0.0].into());
    fin.triangles.push([0, 1, 8]);
    assert_eq!(boundary_loops(&fin), Err(RepairError::NonManifoldEdge { edge: [0, 1], triangles: 3 }));
    assert!(matches!(close_boundary_loops(&moebius(9)), Err(RepairError::MisorientedEdge { .. })));
    let mut collapsed = cube();
    collapsed.triangles.push([4, 4, 5]);
    assert_eq!(boundary_loops(&collapsed), Err(RepairError::CollapsedTriangle { triangle: 12 }));
}

/// The real file, or `None` where going without it was asked for.
fn bunny() -> Option<(TriangleMesh, bool)> {
    let cache = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cache");
    if let Ok(file) = File::open(cache.join("bunny.ply")) {
        return Some((read_ply(file).expect("a sound PLY"), true));
    }
    if let Ok(file) = File::open(cache.join("bunny.obj")) {
        return Some((read_obj(file).expect("a sound OBJ"), false));
    }
    // A test that quietly checks nothing is worse than none: going without has to be asked for.
    let without = std::env::var_os("ISOSTUDY_WITHOUT_BUNNY").is_some();
    assert!(without, "no bunny in cache/: run `make bunny`, or set ISOSTUDY_WITHOUT_BUNNY=1 to go without");
    None
}

#[test]
fn the_bunny_becomes_a_closed_solid() {
    let Some((scan, original)) = bunny() else { return };
    if original {
        assert_eq!((scan.positions.len(), scan.triangles.len()), (35_947, 69_451));
        let report = topology(&scan);
        assert_eq!((report.vertices, report.boundary_edges, report.boundary_loops), (34_834, 223, 5));
        let mut lengths: Vec<_> = boundary_loops(&scan).unwrap().iter().map(Vec::len).collect();
        lengths.sort_unstable();
        assert_eq!(lengths, [22, 39, 40, 42, 80]);
    }
    let solid = closed_solid(&scan).unwrap();
    let report = topology(&solid);
    assert!(report.is_closed_manifold(), "{report:?}");
    assert_eq!((report.euler_characteristic, report.components, report.unused_vertices), (2, 1, 0));
    assert!(solid.volume() > 0.0);
    if original {
        assert_eq!((solid.positions.len(), solid.triangles.len()), (34_839, 69_674));
    }
}
