//! One row per mesh that was extracted.

use super::LongFrame;
use super::rows::Rows;
use crate::distribution::{STATISTICS, purpose_name};
use isostudy_design::record::{
    Accuracy, Counts, Distribution, MeshRecord, Quality, TetrahedraCounts, Topology,
};
use isostudy_design::{Level, Study};
use isostudy_inference::mesh_set::known;

/// Records by purpose, then in the study's order.
///
/// Statistics of a distribution of nothing are missing.
pub(crate) fn meshes(study: &Study, records: &[MeshRecord]) -> LongFrame {
    meshes_with(study, records, records.iter().any(|mesh| mesh.region.is_some()))
}

/// The same with columns of regions or without.
pub(super) fn meshes_with(study: &Study, records: &[MeshRecord], has_regions: bool) -> LongFrame {
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
    for (name, counted) in DISTRIBUTIONS {
        let of = |mesh: &MeshRecord, value: fn(&Distribution) -> f64| {
            counted(&mesh.quality, &mesh.accuracy).and_then(|d| known(d, value))
        };
        rows.count(&format!("{name}_count"), |mesh| counted(&mesh.quality, &mesh.accuracy).map(|d| d.count));
        for (statistic, _, value) in STATISTICS {
            rows.number(&format!("{name}_{statistic}"), |mesh| of(mesh, *value));
        }
    }
    rows.number("hausdorff", |mesh| mesh.accuracy.hausdorff());
    rows.count("lost_points", |mesh| Some(mesh.accuracy.lost_points));
    rows.count("lost_vertices", |mesh| Some(mesh.accuracy.lost_vertices));
    TOPOLOGY.iter().for_each(|(name, of)| rows.count(name, |mesh| Some(of(&mesh.topology))));
    rows.whole("euler_characteristic", |mesh| Some(mesh.topology.euler_characteristic));
    rows.count("self_intersections", |mesh| mesh.topology.self_intersections);
    if has_regions {
        in_regions(&mut rows);
    }
    LongFrame { name: "meshes", frame: rows.frame(), texts: Vec::new() }
}

/// The same of objects' regions; missing where an object has none.
fn in_regions(rows: &mut Rows<&MeshRecord>) {
    rows.text("region", |mesh| Some(mesh.region.as_ref()?.name.clone()));
    rows.count("region_triangles", |mesh| Some(mesh.region.as_ref()?.triangles));
    rows.number("region_area_share", |mesh| Some(mesh.region.as_ref()?.area_share));
    rows.count("region_degenerate_triangles", |mesh| Some(mesh.region.as_ref()?.quality.degenerate));
    for (name, described) in DISTRIBUTIONS {
        let of = |mesh: &MeshRecord, value: fn(&Distribution) -> f64| {
            let part = mesh.region.as_ref()?;
            described(&part.quality, &part.accuracy).map(value)
        };
        rows.count(&format!("region_{name}_count"), |mesh| of(mesh, |d| d.count as f64).map(|n| n as u64));
        for (statistic, _, value) in STATISTICS {
            let value = *value;
            rows.number(&format!("region_{name}_{statistic}"), |mesh| {
                of(mesh, |d| d.count as f64).filter(|count| *count > 0.0).and(of(mesh, value))
            });
        }
    }
    rows.number("region_hausdorff", |mesh| mesh.region.as_ref()?.accuracy.hausdorff());
    rows.count("region_lost_points", |mesh| Some(mesh.region.as_ref()?.accuracy.lost_points));
    rows.count("region_lost_vertices", |mesh| Some(mesh.region.as_ref()?.accuracy.lost_vertices));
    rows.count("region_self_intersections", |mesh| mesh.region.as_ref()?.self_intersections);
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
type Described = (&'static str, for<'a> fn(&'a Quality, &'a Accuracy) -> Option<&'a Distribution>);

const DISTRIBUTIONS: [Described; 10] = [
    ("published_aspect_ratio", |q, _| Some(&q.published_aspect_ratio)),
    ("edge_ratio", |q, _| Some(&q.edge_ratio)),
    ("radius_ratio", |q, _| Some(&q.radius_ratio)),
    ("min_angle_deg", |q, _| Some(&q.min_angle_deg)),
    ("max_angle_deg", |q, _| Some(&q.max_angle_deg)),
    ("area", |q, _| Some(&q.area)),
    ("distance", |_, a| Some(&a.distance)),
    ("distance_to_mesh", |_, a| a.distance_to_mesh.as_ref()),
    ("sharp_edges", |_, a| a.sharp_edges.as_ref()),
    ("normal_error_deg", |_, a| Some(&a.normal_error_deg)),
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
