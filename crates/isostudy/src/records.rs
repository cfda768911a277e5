//! From what `extract` and `mesh` measured to the records that `isostudy-inference` reads. Field by field, on purpose: the
//! geometry crates know nothing of studies, and the statistics know nothing of geometry.

use isostudy_design::ConfigurationId;
use isostudy_design::record::{
    Accuracy, Counts, Distribution, Histogram, MeshRecord, Purpose, Quality, TetrahedraCounts, Topology,
};
use isostudy_field::Counted;
use isostudy_mesh::TriangleMesh;

pub(crate) fn mesh_record(
    id: &ConfigurationId,
    purpose: Purpose,
    spacing: f64,
    cells: [u32; 3],
    counts: Counts,
    mesh: &TriangleMesh,
    accuracy: &isostudy_extract::Accuracy,
) -> MeshRecord {
    MeshRecord {
        schema: MeshRecord::SCHEMA,
        id: id.clone(),
        purpose,
        spacing,
        cells,
        counts,
        quality: quality(&isostudy_mesh::quality::quality(mesh)),
        topology: topology(&isostudy_mesh::topology::topology(mesh), mesh),
        accuracy: self::accuracy(accuracy),
        trilinear: None,
        program: None,
    }
}

pub(crate) fn accuracy(accuracy: &isostudy_extract::Accuracy) -> Accuracy {
    Accuracy {
        distance: distribution(&accuracy.distance),
        distance_to_mesh: Some(distribution(&accuracy.distance_to_mesh)),
        sharp_edges: Some(distribution(&accuracy.sharp_edges)),
        normal_error_deg: distribution(&accuracy.normal_error_deg),
        lost_points: accuracy.lost_points,
        lost_vertices: accuracy.lost_vertices,
    }
}

pub(crate) fn counts(c: &isostudy_extract::Counts) -> Counts {
    Counts {
        samples: Some(c.samples),
        cells: Some(c.cells),
        cells_visited: Some(c.cells_visited),
        crossings: Some(c.crossings),
        vertices: c.vertices,
        triangles: c.triangles,
        discarded_triangles: Some(c.discarded_triangles),
        // Whoever calls the extractor knows.
        evaluations: None,
        gradients: None,
        vertex_bytes: c.vertex_bytes,
        index_bytes: c.index_bytes,
        tetrahedra: c.tetrahedra.as_ref().map(|t| TetrahedraCounts {
            stored_samples: t.stored_samples,
            stored_edges: t.stored_edges,
            needed_edges: t.needed_edges,
            tetrahedra: t.tetrahedra,
            tetrahedra_evaluated: t.tetrahedra_evaluated,
            discarded_as_published: t.discarded_as_published,
            sample_bytes: t.sample_bytes,
            edge_bytes: t.edge_bytes,
        }),
    }
}

/// With how often the field was called.
pub(crate) fn with_calls(counts: Counts, field: &Counted<'_>) -> Counts {
    Counts { evaluations: Some(field.evaluations()), gradients: Some(field.gradients()), ..counts }
}

/// Of a mesh that came from elsewhere, made on a grid of so many cells if that is known.
pub(crate) fn counts_of_mesh(mesh: &TriangleMesh, cells: Option<[u32; 3]>) -> Counts {
    let product = |more: u64| cells.map(|cells| cells.iter().map(|&along| u64::from(along) + more).product());
    let bytes = |count: usize, each: usize| (count * each) as u64;
    Counts {
        samples: product(1),
        cells: product(0),
        vertices: mesh.positions.len() as u64,
        triangles: mesh.triangles.len() as u64,
        vertex_bytes: bytes(mesh.positions.len() + mesh.normals.len(), size_of::<[f32; 3]>()),
        index_bytes: bytes(mesh.triangles.len(), size_of::<[u32; 3]>()),
        ..Counts::default()
    }
}

pub(crate) fn quality(q: &isostudy_mesh::quality::QualityReport) -> Quality {
    Quality {
        triangles: q.triangles,
        degenerate: q.degenerate,
        published_aspect_ratio: distribution(&q.published_aspect_ratio),
        edge_ratio: distribution(&q.edge_ratio),
        radius_ratio: distribution(&q.radius_ratio),
        min_angle_deg: distribution(&q.min_angle_deg),
        max_angle_deg: distribution(&q.max_angle_deg),
        area: distribution(&q.area),
        shortest_edge: Some(q.shortest_edge),
    }
}

fn distribution(d: &isostudy_mesh::distribution::Distribution) -> Distribution {
    Distribution {
        count: d.count,
        mean: d.mean,
        sd: d.sd,
        min: d.min,
        q05: d.q05,
        q25: d.q25,
        median: d.median,
        q75: d.q75,
        q95: d.q95,
        max: d.max,
        histogram: Histogram {
            low: d.histogram.low,
            high: d.histogram.high,
            counts: d.histogram.counts.clone(),
            below: d.histogram.below,
            above: d.histogram.above,
        },
    }
}

/// `t` is the mesh's.
pub(crate) fn topology(t: &isostudy_mesh::topology::TopologyReport, mesh: &TriangleMesh) -> Topology {
    Topology {
        vertices: t.vertices,
        edges: t.edges,
        triangles: t.triangles,
        boundary_edges: t.boundary_edges,
        non_manifold_edges: t.non_manifold_edges,
        misoriented_edges: t.misoriented_edges,
        non_manifold_vertices: t.non_manifold_vertices,
        duplicate_faces: t.duplicate_faces,
        folded_faces: t.folded_faces,
        components: t.components,
        euler_characteristic: t.euler_characteristic,
        // Of no triangles there is no such number.
        self_intersections: isostudy_mesh::self_intersections(mesh).ok(),
    }
}
