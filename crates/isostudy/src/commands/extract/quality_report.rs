//! What `isostudy extract` prints of a mesh.

use super::chosen_method::Described;
use super::finished::StepReport;
use crate::records;
use crate::source::{Inside, Source};
use crate::terminal::{counted, significant};
use anyhow::Result;
use isostudy_design::record::{Accuracy, Counts, Distribution, Quality, Topology};
use isostudy_extract::{Arrangement, Clustering, Extraction, Method};
use serde::Serialize;

/// The version of the JSON.
const SCHEMA: u32 = 1;

/// What was extracted on.
#[derive(Debug, Clone, Copy)]
pub(super) enum Cells {
    /// Cubes of the source's spacing.
    Cubes([u32; 3]),
    /// A volume's own.
    Own {
        counts: [u32; 3],
        /// Against the axes of space.
        is_turned: bool,
    },
}

/// What a mesh is worth.
#[derive(Serialize)]
pub(super) struct QualityReport {
    schema: u32,
    /// The formula or the file.
    source: String,
    bounds: [[f32; 3]; 2],
    method: Described,
    /// What tetrahedra have; no key where the method is none of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    arrangement: Option<Arrangement>,
    #[serde(skip_serializing_if = "Option::is_none")]
    clustering: Option<Clustering>,
    isovalue: f32,
    inside: Inside,
    /// Of a volume's own cells, the edge of a cube as large as one.
    spacing: f32,
    cells: [u32; 3],
    /// Whether they are the volume's own.
    own_cells: bool,
    /// Wall-clock time of the extraction, seconds.
    extraction_s: f64,
    area: f64,
    /// The enclosed volume, if the mesh is closed.
    volume: Option<f64>,
    counts: Counts,
    quality: Quality,
    topology: Topology,
    boundary_loops: u64,
    accuracy: Accuracy,
    /// What was done to the mesh after it was extracted; all else is of the mesh after it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    finishing: Vec<StepReport>,
}

/// In place of what was looked for in another box.
const TURNED: &str = "not measured: the volume is turned";

impl QualityReport {
    pub(super) fn new(
        method: Method,
        source: &Source,
        cells: Cells,
        extraction: &Extraction,
        counts: Counts,
        accuracy: &isostudy_extract::Accuracy,
    ) -> Self {
        let topology = isostudy_mesh::topology::topology(&extraction.mesh);
        let is_closed = topology.boundary_edges == 0;
        let of = match method {
            Method::Tetrahedra(of) => Some(of),
            _ => None,
        };
        let (along, own_cells, is_turned) = match cells {
            Cells::Cubes(counts) => (counts, false, false),
            Cells::Own { counts, is_turned } => (counts, true, is_turned),
        };
        let mut accuracy = records::accuracy(accuracy);
        if is_turned {
            // The isosurface was looked for in the box of the turned volume, so beyond it too.
            (accuracy.distance_to_mesh, accuracy.sharp_edges) = (None, None);
        }
        Self {
            schema: SCHEMA,
            source: source.name.clone(),
            bounds: [source.bounds.min.to_array(), source.bounds.max.to_array()],
            method: Described::of(method),
            arrangement: of.map(|of| of.arrangement),
            clustering: of.map(|of| of.clustering),
            isovalue: source.asked_isovalue(),
            inside: source.inside,
            spacing: source.spacing,
            cells: along,
            own_cells,
            extraction_s: extraction.times.total().as_secs_f64(),
            area: extraction.mesh.area(),
            volume: is_closed.then(|| extraction.mesh.volume()),
            counts,
            quality: records::quality(&isostudy_mesh::quality::quality(&extraction.mesh)),
            boundary_loops: topology.boundary_loops,
            topology: records::topology(&topology, &extraction.mesh),
            accuracy,
            finishing: Vec::new(),
        }
    }

    /// With what was done to the mesh.
    pub(super) fn with_finishing(self, finishing: Vec<StepReport>) -> Self {
        Self { finishing, ..self }
    }

    /// As lines for people.
    ///
    /// # Errors
    /// If the recipe cannot be written as TOML, which each can.
    pub(super) fn to_text(&self) -> Result<String> {
        let [x, y, z] = self.cells;
        let (q, t) = (&self.quality, &self.topology);
        let state = state_of(t);
        let [arrangement, spacing] = match (self.arrangement, self.own_cells) {
            (_, true) => ["the volume's own cells, ".to_owned(), String::new()],
            (Some(of), _) => [format!("{of}, "), format!(" cubes of {}", self.spacing)],
            (None, _) => [String::new(), format!(" cubes of {}", self.spacing)],
        };
        let rows = [
            ("method", self.method.to_text()?),
            ("lattice", format!("{arrangement}{x} x {y} x {z}{spacing}")),
            ("clustering", self.clustering.map_or_else(|| "none".into(), |of| of.to_string())),
            ("time", format!("{:.3} s", self.extraction_s)),
            ("samples taken", taken(&self.counts)),
            ("vertices", t.vertices.to_string()),
            ("triangles", q.triangles.to_string()),
            (
                "topology",
                format!(
                    "{state}; {}, Euler characteristic {}, {}",
                    counted(t.components, "component"),
                    t.euler_characteristic,
                    counted(self.boundary_loops, "boundary loop")
                ),
            ),
            ("intersections", intersecting(t.self_intersections)),
            ("area", significant(self.area)),
            ("volume", self.volume.map_or_else(|| "none: the surface is open".into(), significant)),
            (
                "radius ratio",
                format!(
                    "mean {:.4}, 5 % below {:.4}, smallest {:.4}",
                    q.radius_ratio.mean, q.radius_ratio.q05, q.radius_ratio.min
                ),
            ),
            (
                "smallest angle",
                format!("mean {:.1} deg, smallest {:.2} deg", q.min_angle_deg.mean, q.min_angle_deg.min),
            ),
            ("shortest edge", significant(q.shortest_edge.unwrap_or_default())),
            ("without area", format!("{} triangles", q.degenerate)),
            ("to the surface", way(&self.accuracy.distance) + &lost(self.accuracy.lost_points)),
            ("from it", self.accuracy.distance_to_mesh.as_ref().map_or_else(|| TURNED.into(), way)),
            (
                "sharp edges",
                match &self.accuracy.sharp_edges {
                    Some(none) if none.count == 0 => "none found".into(),
                    Some(edges) => way(edges),
                    None => TURNED.into(),
                },
            ),
        ];
        let finishing = self.finishing.iter().map(|step| ("finishing", step.to_text()));
        let rows = rows.into_iter().chain(finishing);
        Ok(rows.map(|(name, value)| format!("{name:<15} {value}")).collect::<Vec<_>>().join("\n"))
    }
}

/// What a mesh is, or its faults.
pub(super) fn state_of(t: &Topology) -> String {
    let faults = [
        ("boundary edges", t.boundary_edges),
        ("edges with more than two triangles", t.non_manifold_edges),
        ("edges between opposite sides", t.misoriented_edges),
        ("vertices with more than one fan", t.non_manifold_vertices),
        ("triangles twice", t.duplicate_faces),
    ];
    let faults: Vec<String> =
        faults.iter().filter(|f| f.1 > 0).map(|(name, count)| format!("{count} {name}")).collect();
    if faults.is_empty() { "closed manifold".to_owned() } else { faults.join(", ") }
}

/// How often the field was called.
fn taken(counts: &Counts) -> String {
    match (counts.evaluations, counts.evaluations_per_vertex()) {
        (Some(calls), Some(each)) => format!("{calls}, {each:.2} per vertex"),
        _ => "none: they are the volume's".into(),
    }
}

/// Distances one way.
fn way(distances: &Distribution) -> String {
    format!("mean {:.3e}, largest {:.3e} (over {} points)", distances.mean, distances.max, distances.count)
}

fn lost(points: u64) -> String {
    if points == 0 { String::new() } else { format!(", {} without a distance", counted(points, "point")) }
}

/// How many triangles pass through each other, in words.
pub(super) fn intersecting(pairs: Option<u64>) -> String {
    match pairs {
        Some(0) => "no triangle passes through another".to_owned(),
        Some(isostudy_mesh::MOST_INTERSECTIONS) => {
            format!(
                "at least {} pairs of triangles that pass through each other",
                isostudy_mesh::MOST_INTERSECTIONS
            )
        }
        Some(pairs) => format!("{} of triangles that pass through each other", counted(pairs, "pair")),
        None => "not counted".to_owned(),
    }
}
