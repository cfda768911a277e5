//! Surface nets and dual contouring in chunks of several levels: closed whatever the samples, and of the
//! right shape.

use crate::two_levels::{
    CELLS, Octree, REACH, ball, by_position, chunks, extractor, noise, open_edges, shapes, turned_over,
    welded,
};
use isostudy_extract::{DualContouring, Method, SurfaceNets, weld_chunks};
use isostudy_mesh::topology::topology;

/// Vertices that stay in their cells, those of the presets, which may leave them, and those that are drawn to
/// each other.
const DUALS: [Method; 4] = [
    Method::SurfaceNets(SurfaceNets::new()),
    Method::SurfaceNets(SurfaceNets::new().with_smoothing(3)),
    Method::DualContouring(DualContouring::new().with_truncation(0.1).with_in_cell(true)),
    Method::DualContouring(DualContouring::new()),
];

/// Of how many ways one is tried with each of [`DUALS`]: the field is called most for tangent planes.
const STEPS: [usize; 4] = [1, 7, 3, 7];

/// One vertex a cell is no manifold where sheets share it, but nothing is open, whatever the samples.
#[test]
fn seams_of_duals_are_closed_whatever_the_samples() {
    for (method, step) in DUALS.into_iter().zip(STEPS) {
        let mut extractor = extractor(0.5, &method);
        let mut triangles = 0;
        for fine in (0..256).step_by(step) {
            let field = noise(fine, 1e6, 3.4);
            let chunks = chunks(&mut extractor, &field, fine, CELLS);
            assert_eq!(open_edges(&weld_chunks(&chunks).unwrap()), 0, "{method:?} {fine:08b}");
            triangles += chunks.iter().map(|chunk| chunk.seam).sum::<u32>();
        }
        assert!(triangles > 50_000 / step as u32, "{triangles}");
    }
}

/// The Euler characteristic is that of the shape, in whatever way levels meet. A vertex that may leave its
/// cell may turn a triangle over; how many do is bounded.
#[test]
fn shapes_of_duals_keep_their_topology_in_all_256_ways() {
    for (method, step) in DUALS.into_iter().zip(STEPS) {
        let is_free = matches!(method, Method::DualContouring(planes) if !planes.in_cell);
        let mut extractor = extractor(0.125, &method);
        for (s, shape) in shapes().iter().enumerate() {
            let (mut turned, mut all) = (0, 0);
            for fine in (0..256).step_by(if s == 0 { step } else { 7 * step }) {
                let chunks = chunks(&mut extractor, &*shape.field, fine, 10);
                let report = welded(&chunks);
                assert_eq!(report.unused_vertices, 0);
                assert_eq!(open_edges(&by_position(&chunks)), 0, "{method:?} {s} {fine:08b}");
                assert_eq!(
                    report.euler_characteristic, shape.euler_characteristic,
                    "{method:?} {s} {fine:08b}"
                );
                // Sheets near each other, and a saddle on a face, may share a cell's vertex.
                if shape.is_round {
                    assert!(report.is_closed_manifold(), "{method:?} {s} {fine:08b}: {report:?}");
                }
                turned += turned_over(&chunks, &*shape.field);
                all += chunks.iter().map(|chunk| chunk.triangles.len()).sum::<usize>();
            }
            let most = match (is_free, shape.is_round) {
                (false, true) => 0,
                (false, false) => all / 1_000,
                (true, true) => all / 500,
                (true, false) => all / 40,
            };
            assert!(turned <= most, "{method:?} {s}: {turned} of {all}");
        }
    }
}

/// Three levels, with all the ways in which they meet.
#[test]
fn octrees_of_three_levels_are_closed() {
    for seed in 0..6 {
        let octree = Octree::random(seed);
        for method in DUALS {
            let mut extractor = extractor(0.25, &method);
            let reach = 4.0 * 0.25 * REACH as f32 - 1.1;
            let chunks = octree.chunks(&mut extractor, &noise(seed, 1e6, reach), 4);
            let mesh = weld_chunks(&chunks).unwrap();
            assert!(mesh.triangles.len() > 1_000);
            assert_eq!(open_edges(&mesh), 0, "{seed} {method:?}");
            assert_eq!(topology(&mesh).boundary_edges, 0, "{seed} {method:?}");
            let chunks = octree.chunks(&mut extractor, &ball(3.2, [0.2, 0.03, -0.3]), 4);
            let report = welded(&chunks);
            assert!(report.is_closed_manifold(), "{seed} {method:?}: {report:?}");
            assert_eq!(report.euler_characteristic, 2, "{seed} {method:?}");
            assert_eq!(open_edges(&by_position(&chunks)), 0, "{seed} {method:?}");
        }
    }
}
