//! Topology and quality of shapes whose counts are known by hand.

use crate::shapes::*;
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::quality::quality;
use isostudy_mesh::topology::{TopologyReport, first_boundary_edge, topology};
use proptest::prelude::*;

/// vertices, edges, triangles, Euler characteristic, components
fn makeup(r: &TopologyReport) -> (u64, u64, u64, i64, u64) {
    (r.vertices, r.edges, r.triangles, r.euler_characteristic, r.components)
}

#[test]
fn closed_shapes() {
    for (name, mesh, want, volume) in [
        ("tetrahedron", tetrahedron(), (4, 6, 4, 2, 1), 8.0 / 3.0),
        ("cube", cube(), (8, 18, 12, 2, 1), 1.0),
        ("icosahedron", icosahedron(), (12, 30, 20, 2, 1), 5.0 / 12.0 * (3.0 + 5f64.sqrt()) * 8.0),
        // A polygon of n sides round the axis, m round the tube: Pappus with their areas.
        ("torus", torus(40, 30), (1200, 3600, 2400, 0, 1), {
            let polygon = |n: f64| n / 2.0 * (std::f64::consts::TAU / n).sin();
            polygon(30.0) * 0.25 * 2.0 * 2.0 * polygon(40.0)
        }),
        ("two cubes", joined(&cube(), &cube()), (16, 36, 24, 4, 2), 2.0),
    ] {
        let report = topology(&mesh);
        assert_eq!(makeup(&report), want, "{name}");
        assert!(report.is_closed_manifold(), "{name}: {report:?}");
        assert!((mesh.volume() / volume - 1.0).abs() < 2e-3, "{name}: {}", mesh.volume());
    }
}

#[test]
fn a_boundary_edge_is_one_of_the_hole_and_a_closed_surface_has_none() {
    let mut open = cube();
    assert_eq!(first_boundary_edge(&open), None);
    assert_eq!(first_boundary_edge(&TriangleMesh::default()), None);
    let hole = open.triangles.remove(7).map(|v| open.positions[v as usize]);
    let [from, to] = first_boundary_edge(&open).unwrap();
    assert!(from != to && hole.contains(&from) && hole.contains(&to));
    // The same edge whatever the order of the triangles after the first that has one.
    let single = TriangleMesh { triangles: vec![open.triangles[0]], ..open };
    let [a, b, _] = single.corners(0);
    assert_eq!(first_boundary_edge(&single), Some([a, b]));
}

#[test]
fn nothing_is_not_a_closed_manifold() {
    let report = topology(&TriangleMesh::default());
    assert_eq!(report, TopologyReport::default());
    assert!(!report.is_closed_manifold());
}

#[test]
fn holes_are_loops() {
    let mut open = cube();
    open.triangles.remove(0);
    let report = topology(&open);
    assert_eq!((report.boundary_edges, report.boundary_loops, report.euler_characteristic), (3, 1, 1));
    assert_eq!(report.non_manifold_vertices, 0);
    // Two faces of the icosahedron that share one vertex: the vertex has two fans, and the one boundary passes it twice.
    let mut open = icosahedron();
    let first = open.triangles.remove(0);
    let shared = |t: &[u32; 3]| t.iter().filter(|v| first.contains(v)).count();
    let second = open.triangles.iter().position(|t| shared(t) == 1).expect("there is one");
    open.triangles.remove(second);
    let report = topology(&open);
    assert_eq!((report.boundary_edges, report.boundary_loops, report.non_manifold_vertices), (6, 1, 1));
}

#[test]
fn a_fin_is_one_duplicate_one_fold_and_one_non_manifold_edge() {
    // Published meshes: every fin adds 1 to the Euler characteristic and no non-manifold vertex.
    let mut fin = cube();
    fin.positions.push([0.5, -1.0, 0.0].into());
    fin.triangles.extend([[0, 1, 8], [1, 0, 8]]);
    let report = topology(&fin);
    assert_eq!((report.duplicate_faces, report.folded_faces, report.non_manifold_edges), (1, 1, 1));
    assert_eq!((report.euler_characteristic, report.non_manifold_vertices), (3, 0));
    assert_eq!((report.boundary_edges, report.misoriented_edges), (0, 0));
    assert!(!report.is_closed_manifold());
    // The same face twice, facing the same way, is no fold.
    let mut twice = cube();
    twice.triangles.push(twice.triangles[3]);
    let report = topology(&twice);
    assert_eq!((report.duplicate_faces, report.folded_faces, report.non_manifold_edges), (1, 0, 3));
}

#[test]
fn a_lone_folded_pair_is_closed_but_no_manifold() {
    let pillow = mesh(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], &[[0, 1, 2], [0, 2, 1]]);
    let report = topology(&pillow);
    assert_eq!((report.boundary_edges, report.euler_characteristic, report.folded_faces), (0, 2, 1));
    assert!(!report.is_closed_manifold());
}

#[test]
fn a_bow_tie_is_one_non_manifold_vertex_and_one_component() {
    let mut tie = joined(&tetrahedron(), &tetrahedron());
    for v in tie.triangles.iter_mut().flatten().filter(|v| **v == 4) {
        *v = 0;
    }
    let report = topology(&tie);
    assert_eq!((report.non_manifold_vertices, report.components, report.euler_characteristic), (1, 1, 3));
    assert_eq!((report.vertices, report.unused_vertices), (7, 1));
    assert!(!report.is_closed_manifold());
}

#[test]
fn a_moebius_strip_cannot_be_oriented() {
    let report = topology(&moebius(12));
    assert_eq!(makeup(&report), (24, 48, 24, 0, 1));
    assert_eq!((report.boundary_edges, report.boundary_loops), (24, 1));
    assert_eq!(report.misoriented_edges, 1);
    assert_eq!((report.non_manifold_edges, report.non_manifold_vertices), (0, 0));
}

#[test]
fn one_triangle_turned_round_spoils_its_three_edges() {
    let mut turned = icosahedron();
    turned.triangles[7].swap(0, 1);
    let report = topology(&turned);
    assert_eq!((report.misoriented_edges, report.boundary_edges), (3, 0));
    assert!(!report.is_closed_manifold());
}

#[test]
fn collapsed_triangles_stand_apart() {
    let mut collapsed = cube();
    collapsed.triangles.extend([[2, 2, 5], [1, 1, 1]]);
    let report = topology(&collapsed);
    assert_eq!(report.collapsed_triangles, 2);
    assert_eq!(makeup(&report), makeup(&topology(&cube())));
    assert!(!report.is_closed_manifold());
}

#[test]
fn quality_of_the_icosahedron_and_the_cube() {
    let report = quality(&icosahedron());
    assert_eq!((report.triangles, report.degenerate), (20, 0));
    assert!((report.edge_ratio.max - 1.0).abs() < 1e-6 && (report.radius_ratio.min - 1.0).abs() < 1e-6);
    assert!((report.area.mean - 3f64.sqrt()).abs() < 1e-6 && report.area.sd < 1e-6);
    // Half squares: 45, 45 and 90 degrees, r_in = (2 - sqrt 2) / 2, R_circ = sqrt 2 / 2.
    let report = quality(&cube());
    assert!(
        (report.min_angle_deg.mean - 45.0).abs() < 1e-12 && (report.max_angle_deg.mean - 90.0).abs() < 1e-12
    );
    assert!((report.radius_ratio.median - (2.0 * 2f64.sqrt() - 2.0)).abs() < 1e-12);
    assert_eq!((report.area.mean, report.area.sd), (0.5, 0.0));
}

proptest! {
    /// Any soup: the fans never outnumber the corners, nothing panics, and the order of triangles and the
    /// rotation of their corners change nothing.
    #[test]
    fn any_soup_is_counted_and_order_is_nothing(
        triangles in prop::collection::vec(prop::array::uniform3(0u32..9), 0..40),
    ) {
        let soup = mesh(&[[0.0; 3]; 9], &triangles);
        let report = topology(&soup);
        let turned: Vec<_> = triangles.iter().rev().map(|&[a, b, c]| [b, c, a]).collect();
        prop_assert_eq!(topology(&mesh(&[[0.0; 3]; 9], &turned)), report);
        prop_assert!(report.folded_faces <= report.duplicate_faces);
        prop_assert!(report.boundary_loops <= report.boundary_edges);
        prop_assert_eq!(report.triangles + report.collapsed_triangles, triangles.len() as u64);
        // The other orientation has the same faults.
        prop_assert_eq!(topology(&isostudy_mesh::repair::flip(&soup)), report);
    }
}
