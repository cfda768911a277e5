//! From what `extract` and `mesh` measured to the records that `isostudy-inference` reads. Field by field, on purpose: the
//! geometry crates know nothing of studies, and the statistics know nothing of geometry.

use isostudy_design::ConfigurationId;
use isostudy_design::record::{
    Accuracy, Counts, Distribution, Histogram, MeshRecord, Purpose, Quality, RegionMeasures,
    TetrahedraCounts, Topology,
};
use isostudy_field::Counted;
use isostudy_mesh::TriangleMesh;

/// A record with the fields of the same names; the others after `and`.
macro_rules! same_fields {
    ($from:expr => $record:ident { $($field:ident),* $(; and $($other:ident: $value:expr),*)? }) => {
        $record { $($field: $from.$field,)* $($($other: $value,)*)? }
    };
}

pub(crate) fn mesh_record(
    id: &ConfigurationId,
    purpose: Purpose,
    spacing: f64,
    cells: [u32; 3],
    counts: Counts,
    (quality, topology): (Quality, Topology),
    (accuracy, region): (&isostudy_extract::Accuracy, Option<RegionMeasures>),
) -> MeshRecord {
    MeshRecord {
        schema: MeshRecord::SCHEMA,
        id: id.clone(),
        purpose,
        spacing,
        cells,
        counts,
        quality,
        topology,
        accuracy: self::accuracy(accuracy),
        region,
        trilinear: None,
        program: None,
    }
}

/// What is measured of a mesh alone.
pub(crate) fn of_mesh(mesh: &TriangleMesh) -> (Quality, Topology) {
    let of_topology = topology(&isostudy_mesh::topology::topology(mesh), mesh);
    (quality(&isostudy_mesh::quality::quality(mesh)), of_topology)
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
        tetrahedra: c.tetrahedra.as_ref().map(|t| {
            same_fields!(t => TetrahedraCounts {
                stored_samples, stored_edges, needed_edges, tetrahedra, tetrahedra_evaluated, discarded_as_published,
                sample_bytes, edge_bytes
            })
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

/// With what a finished mesh has, in place of what was extracted.
pub(crate) fn with_mesh(counts: Counts, mesh: &TriangleMesh) -> Counts {
    let Counts { vertices, triangles, vertex_bytes, index_bytes, .. } = counts_of_mesh(mesh, None);
    Counts { vertices, triangles, vertex_bytes, index_bytes, ..counts }
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
    let h = d.histogram.clone();
    let histogram = same_fields!(h => Histogram { low, high, counts, below, above });
    same_fields!(d => Distribution { count, mean, sd, min, q05, q25, median, q75, q95, max; and histogram: histogram })
}

const _: () = assert!(isostudy_design::record::MOST_INTERSECTIONS == isostudy_mesh::MOST_INTERSECTIONS);

/// `t` is the mesh's.
pub(crate) fn topology(t: &isostudy_mesh::topology::TopologyReport, mesh: &TriangleMesh) -> Topology {
    same_fields!(t => Topology {
        vertices, edges, triangles, boundary_edges, non_manifold_edges, misoriented_edges, non_manifold_vertices,
        duplicate_faces, folded_faces, components, euler_characteristic;
        // Of no triangles there is no such number.
        and self_intersections: isostudy_mesh::self_intersections(mesh).ok()
    })
}
