//! One row per mesh that was extracted.

use super::LongFrame;
use super::rows::Rows;
use crate::distribution::{STATISTICS, purpose_name};
use isostudy_design::record::{Counts, Distribution, MeshRecord, TetrahedraCounts, Topology};
use isostudy_design::{Level, Study};
use isostudy_inference::mesh_set::known;

/// Records by purpose, then in the study's order.
///
/// Statistics of a distribution of nothing are missing.
pub(crate) fn meshes(study: &Study, records: &[MeshRecord]) -> LongFrame {
    let mut sorted: Vec<&MeshRecord> = records.iter().collect();
    let place = |mesh: &MeshRecord| study.configurations.iter().position(|c| c.id == mesh.id);
    sorted.sort_by_key(|mesh| (mesh.purpose, place(mesh), mesh.id.clone()));
    let mut rows = Rows::of(sorted);
    rows.text("id", |mesh| Some(mesh.id.to_string()));
    rows.text("object", |mesh| Some(mesh.id.object.clone()));
    rows.text("method", |mesh| Some(mesh.id.method.to_string()));
    for factor in study.declared_factors() {
        let code = |level: Level| study.level(level).code.clone();
        rows.text(&format!("factor_{}", study.factor(factor).name), |mesh| {
            study.level_of(mesh.id.method, factor).map(code)
        });
    }
    rows.text("purpose", |mesh| Some(purpose_name(mesh.purpose).into()));
    rows.number("spacing", |mesh| mesh.has_grid().then_some(mesh.spacing));
    for (axis, name) in ["cells_x", "cells_y", "cells_z"].into_iter().enumerate() {
        rows.count(name, |mesh| mesh.has_grid().then(|| mesh.cells[axis].into()));
    }
    COUNTS.iter().for_each(|(name, of)| rows.count(name, |mesh| of(&mesh.counts)));
    TETRAHEDRA.iter().for_each(|(name, of)| rows.count(name, |mesh| mesh.counts.of_tetrahedra(*of)));
    rows.count("degenerate_triangles", |mesh| Some(mesh.quality.degenerate));
    for (name, of) in DISTRIBUTIONS {
        rows.count(&format!("{name}_count"), |mesh| of(mesh).map(|d| d.count));
        for (statistic, _, value) in STATISTICS {
            rows.number(&format!("{name}_{statistic}"), |mesh| of(mesh).and_then(|d| known(d, *value)));
        }
    }
    rows.number("hausdorff", |mesh| mesh.accuracy.hausdorff());
    rows.count("lost_points", |mesh| Some(mesh.accuracy.lost_points));
    rows.count("lost_vertices", |mesh| Some(mesh.accuracy.lost_vertices));
    TOPOLOGY.iter().for_each(|(name, of)| rows.count(name, |mesh| Some(of(&mesh.topology))));
    rows.whole("euler_characteristic", |mesh| Some(mesh.topology.euler_characteristic));
    rows.count("self_intersections", |mesh| mesh.topology.self_intersections);
    LongFrame { name: "meshes", frame: rows.frame(), texts: Vec::new() }
}

type Named<T, V> = (&'static str, fn(&T) -> V);

const COUNTS: [Named<Counts, Option<u64>>; 11] = [
    ("samples", |c| c.samples),
    ("cells", |c| c.cells),
    ("cells_visited", |c| c.cells_visited),
    ("crossings", |c| c.crossings),
    ("vertices", |c| Some(c.vertices)),
    ("triangles", |c| Some(c.triangles)),
    ("discarded_triangles", |c| c.discarded_triangles),
    ("evaluations", |c| c.evaluations),
    ("gradients", |c| c.gradients),
    ("vertex_bytes", |c| Some(c.vertex_bytes)),
    ("index_bytes", |c| Some(c.index_bytes)),
];

const TETRAHEDRA: [Named<TetrahedraCounts, u64>; 8] = [
    ("stored_samples", |t| t.stored_samples),
    ("stored_edges", |t| t.stored_edges),
    ("needed_edges", |t| t.needed_edges),
    ("tetrahedra", |t| t.tetrahedra),
    ("tetrahedra_evaluated", |t| t.tetrahedra_evaluated),
    ("discarded_as_published", |t| t.discarded_as_published),
    ("sample_bytes", |t| t.sample_bytes),
    ("edge_bytes", |t| t.edge_bytes),
];

/// What is distributed: its name in columns, and where it stands.
type Described = (&'static str, fn(&MeshRecord) -> Option<&Distribution>);

const DISTRIBUTIONS: [Described; 10] = [
    ("published_aspect_ratio", |m| Some(&m.quality.published_aspect_ratio)),
    ("edge_ratio", |m| Some(&m.quality.edge_ratio)),
    ("radius_ratio", |m| Some(&m.quality.radius_ratio)),
    ("min_angle_deg", |m| Some(&m.quality.min_angle_deg)),
    ("max_angle_deg", |m| Some(&m.quality.max_angle_deg)),
    ("area", |m| Some(&m.quality.area)),
    ("distance", |m| Some(&m.accuracy.distance)),
    ("distance_to_mesh", |m| m.accuracy.distance_to_mesh.as_ref()),
    ("sharp_edges", |m| m.accuracy.sharp_edges.as_ref()),
    ("normal_error_deg", |m| Some(&m.accuracy.normal_error_deg)),
];

const TOPOLOGY: [Named<Topology, u64>; 10] = [
    ("used_vertices", |t| t.vertices),
    ("edges", |t| t.edges),
    ("proper_triangles", |t| t.triangles),
    ("boundary_edges", |t| t.boundary_edges),
    ("non_manifold_edges", |t| t.non_manifold_edges),
    ("misoriented_edges", |t| t.misoriented_edges),
    ("non_manifold_vertices", |t| t.non_manifold_vertices),
    ("duplicate_faces", |t| t.duplicate_faces),
    ("folded_faces", |t| t.folded_faces),
    ("components", |t| t.components),
];
