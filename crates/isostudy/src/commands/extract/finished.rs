//! The finishing steps of `isostudy extract --finish`, one after another, and what each does.

use crate::terminal::grouped;
use crate::{finishing, records};
use anyhow::Result;
use isostudy_design::record::Counts;
use isostudy_extract::Extraction;
use isostudy_finish::{Extent, Finished, Step};
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::topology::{TopologyReport, topology};
use serde::Serialize;
use std::time::Instant;

/// What a step did.
#[derive(Debug, Serialize)]
pub(super) struct StepReport {
    /// The step, as a study file has it.
    #[serde(flatten)]
    step: Step,
    /// Wall-clock time, seconds.
    finishing_s: f64,
    before: Shape,
    after: Shape,
    /// Where it could not do what was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    stopped: Option<String>,
}

/// What a step may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
struct Shape {
    triangles: u64,
    vertices: u64,
    components: u64,
    euler_characteristic: i64,
    boundary_edges: u64,
    non_manifold_edges: u64,
    non_manifold_vertices: u64,
    duplicate_faces: u64,
}

impl Shape {
    fn of(mesh: &TriangleMesh) -> Self {
        let TopologyReport {
            vertices,
            triangles,
            components,
            euler_characteristic,
            boundary_edges,
            non_manifold_edges,
            non_manifold_vertices,
            duplicate_faces,
            ..
        } = topology(mesh);
        Self {
            triangles,
            vertices,
            components,
            euler_characteristic,
            boundary_edges,
            non_manifold_edges,
            non_manifold_vertices,
            duplicate_faces,
        }
    }

    /// What differs beside triangles and vertices, by name.
    fn changes(&self, after: &Self) -> Vec<String> {
        let counts = |of: &Self| {
            [
                ("components", of.components as i64),
                ("Euler characteristic", of.euler_characteristic),
                ("boundary edges", of.boundary_edges as i64),
                ("edges with more than two triangles", of.non_manifold_edges as i64),
                ("vertices with more than one fan", of.non_manifold_vertices as i64),
                ("triangles twice", of.duplicate_faces as i64),
            ]
        };
        let pairs = counts(self).into_iter().zip(counts(after));
        let changed = pairs.filter(|((_, was), (_, is))| was != is);
        changed.map(|((name, was), (_, is))| format!("{name} from {was} to {is}")).collect()
    }
}

/// Applies the steps to what was extracted, whose counts are then those of the finished mesh.
///
/// # Errors
/// If a step cannot be applied, or nothing is left.
pub(super) fn finish(
    extraction: &mut Extraction,
    counts: &mut Counts,
    steps: &[Step],
) -> Result<Vec<StepReport>> {
    let mut reports: Vec<StepReport> = Vec::new();
    for &step in steps {
        let before = reports.last().map_or_else(|| Shape::of(&extraction.mesh), |last| last.after);
        let began = Instant::now();
        let Finished { mesh, stopped } = finishing::apply(&step, &extraction.mesh, Extent::Whole)?;
        let finishing_s = began.elapsed().as_secs_f64();
        extraction.mesh = mesh;
        let after = Shape::of(&extraction.mesh);
        let stopped = stopped.first().map(ToString::to_string);
        reports.push(StepReport { step, finishing_s, before, after, stopped });
    }
    if !steps.is_empty() {
        *counts = records::with_mesh(std::mem::take(counts), &extraction.mesh);
        (extraction.counts.vertices, extraction.counts.triangles) = (counts.vertices, counts.triangles);
    }
    Ok(reports)
}

impl StepReport {
    /// How large the mesh is afterwards, how long it took, and what else changed.
    pub(super) fn to_line(&self) -> String {
        let (name, Shape { triangles, vertices, .. }) = (self.step.name(), self.after);
        let size = format!("{} triangles, {} vertices", grouped(triangles), grouped(vertices));
        let changes = self.before.changes(&self.after);
        let changed = if changes.is_empty() { String::new() } else { format!("; {}", changes.join(", ")) };
        // Its first word is the step's name.
        let stopped = self.stopped.as_ref().map_or_else(String::new, |why| format!("\n{why}"));
        format!("{name}: {size}, finished in {:.1} ms{changed}{stopped}", 1e3 * self.finishing_s)
    }

    /// The same with what was before.
    pub(super) fn to_text(&self) -> String {
        let (was, is) = (self.before, self.after);
        let changes = was.changes(&is);
        let topology = if changes.is_empty() { "topology as before".into() } else { changes.join(", ") };
        let stopped = self.stopped.as_ref().map_or_else(String::new, |why| format!("; {why}"));
        format!(
            "{}: {} of {} triangles, {} of {} vertices, {:.3} s; {topology}{stopped}",
            self.step.name(),
            is.triangles,
            was.triangles,
            is.vertices,
            was.vertices,
            self.finishing_s
        )
    }
}
