//! Fields that the tests share.

use isostudy_field::{FromFn, Plain, ScalarField, from_fn};
use isostudy_front::{Front, FrontError, Grown, grow};
use isostudy_mesh::glam::Vec3;
use isostudy_mesh::topology::{TopologyReport, topology};
use isostudy_mesh::{Bounds, TriangleMesh};

pub(crate) fn cube(half: f32) -> Bounds {
    Bounds { min: Vec3::splat(-half), max: Vec3::splat(half) }
}

pub(crate) fn torus(large: f32, small: f32) -> FromFn<impl Fn([f32; 3]) -> f32 + Sync> {
    from_fn(move |[x, y, z]| small - (((x * x + y * y).sqrt() - large).powi(2) + z * z).sqrt())
}

/// A tube round a figure of eight, of genus 2.
pub(crate) fn double_torus() -> FromFn<impl Fn([f32; 3]) -> f32 + Sync> {
    from_fn(|[x, y, z]| 0.01 - (x * x - x * x * x * x - y * y).powi(2) - z * z)
}

/// What is grown at 0.
pub(crate) fn grown(field: &dyn ScalarField, bounds: Bounds, settings: &Front) -> Result<Grown, FrontError> {
    grow(&Plain(field), bounds, 0.0, settings)
}

/// What a mesh must be: a manifold that faces one way, with every open edge on a face of the box.
pub(crate) fn sound(mesh: &TriangleMesh, bounds: Bounds) -> TopologyReport {
    let report = topology(mesh);
    let faults = [
        report.non_manifold_edges,
        report.non_manifold_vertices,
        report.misoriented_edges,
        report.collapsed_triangles,
        report.duplicate_faces,
        report.unused_vertices,
    ];
    assert_eq!(faults, [0; 6], "{report:?}");
    let mut ends: Vec<([u32; 2], bool)> = Vec::new();
    for &[a, b, c] in &mesh.triangles {
        ends.extend([[a, b], [b, c], [c, a]].map(|[p, q]| ([p.min(q), p.max(q)], p < q)));
    }
    ends.sort_unstable();
    for edge in ends.chunk_by(|a, b| a.0 == b.0).filter(|edge| edge.len() == 1) {
        let [p, q] = edge[0].0.map(|v| mesh.positions[v as usize]);
        let shares_face = (0..3).any(|axis| {
            [bounds.min, bounds.max].iter().any(|corner| p[axis] == corner[axis] && q[axis] == corner[axis])
        });
        assert!(shares_face, "an open edge inside of the box, from {p} to {q}");
    }
    report
}
