//! From what `extract` and `mesh` measured to the records that `analysis` reads. Field by field, on purpose: the
//! geometry crates know nothing of studies, and the statistics know nothing of geometry.

use design::ConfigurationId;
use design::record::{Accuracy, Counts, Distribution, Histogram, MeshRecord, Purpose, Quality, Topology};
use extract::Extraction;

pub(crate) fn mesh_record(
    id: &ConfigurationId,
    purpose: Purpose,
    spacing: f64,
    cells: [u32; 3],
    extraction: &Extraction,
    accuracy: &extract::Accuracy,
) -> MeshRecord {
    MeshRecord {
        id: id.clone(),
        purpose,
        spacing,
        cells,
        counts: counts(&extraction.counts),
        quality: quality(&mesh::quality::quality(&extraction.mesh)),
        topology: topology(&mesh::topology::topology(&extraction.mesh)),
        accuracy: self::accuracy(accuracy),
    }
}

pub(crate) fn accuracy(accuracy: &extract::Accuracy) -> Accuracy {
    Accuracy {
        distance: distribution(&accuracy.distance),
        distance_to_mesh: Some(distribution(&accuracy.distance_to_mesh)),
        normal_error_deg: distribution(&accuracy.normal_error_deg),
        lost_points: accuracy.lost_points,
        lost_vertices: accuracy.lost_vertices,
    }
}

/// # Panics
/// If the method is not one of tetrahedra: a record has no place for another yet.
pub(crate) fn counts(c: &extract::Counts) -> Counts {
    let tetrahedra = c.tetrahedra.expect("a study's methods are of tetrahedra");
    Counts {
        stored_samples: tetrahedra.stored_samples,
        needed_samples: c.samples,
        stored_edges: tetrahedra.stored_edges,
        needed_edges: tetrahedra.needed_edges,
        tetrahedra: tetrahedra.tetrahedra,
        tetrahedra_evaluated: tetrahedra.tetrahedra_evaluated,
        crossings: c.crossings,
        vertices: c.vertices,
        triangles: c.triangles,
        discarded_triangles: c.discarded_triangles,
        discarded_as_published: tetrahedra.discarded_as_published,
        sample_bytes: tetrahedra.sample_bytes,
        edge_bytes: tetrahedra.edge_bytes,
        vertex_bytes: c.vertex_bytes,
        index_bytes: c.index_bytes,
    }
}

pub(crate) fn quality(q: &mesh::quality::QualityReport) -> Quality {
    Quality {
        triangles: q.triangles,
        degenerate: q.degenerate,
        published_aspect_ratio: distribution(&q.published_aspect_ratio),
        edge_ratio: distribution(&q.edge_ratio),
        radius_ratio: distribution(&q.radius_ratio),
        min_angle_deg: distribution(&q.min_angle_deg),
        max_angle_deg: distribution(&q.max_angle_deg),
        area: distribution(&q.area),
    }
}

fn distribution(d: &mesh::distribution::Distribution) -> Distribution {
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

pub(crate) fn topology(t: &mesh::topology::TopologyReport) -> Topology {
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
    }
}
