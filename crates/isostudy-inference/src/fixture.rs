//! A study with everything: the paper's file, and records made up from its published benchmark.

use crate::{Answered, Inputs};
use isostudy_design::Study;
use isostudy_design::config::FieldSection;
use isostudy_design::published::BenchmarkRow;
use isostudy_design::record::*;
use isostudy_responses::{Mapping, Plan, Responses};
use std::path::Path;

/// Studies and runs.
#[path = "../../isostudy-timing/src/fixture.rs"]
pub mod timed;

pub use timed::{bench, bench_of, crossed, paper_path, study, study_with, sweep_levels};

/// The published answers.
pub fn answers(study: &Study) -> Responses {
    let text = std::fs::read_to_string(study.responses.as_deref().unwrap()).unwrap();
    parse(&text, study)
}

/// The published answers, counted and tested.
pub fn answered(study: &Study) -> Answered {
    Answered::of(study, answers(study)).unwrap()
}

/// Answers in the text, read for the study.
pub fn parse(text: &str, study: &Study) -> Responses {
    let (path, plan) = (Path::new("answers.csv"), Plan::of_study(study));
    isostudy_responses::parse(text.as_bytes(), path, Some(&plan), &Mapping::default()).unwrap().responses
}

/// Everything a study can have.
pub struct Everything {
    /// The study.
    pub study: Study,
    /// Its meshes.
    pub meshes: Vec<MeshRecord>,
    /// Its benchmark.
    pub bench: BenchRun,
    /// Its answers.
    pub answers: Answered,
}

impl Everything {
    /// Made up for a study, but for its published answers.
    pub fn of(study: Study) -> Self {
        let (meshes, bench, answers) = (meshes(&study), bench(&study), answered(&study));
        Self { study, meshes, bench, answers }
    }

    /// What tables and figures are made from.
    pub fn inputs(&self) -> Inputs<'_> {
        Inputs {
            study: &self.study,
            meshes: &self.meshes,
            bench: Some(&self.bench),
            chunks: &[],
            stored: &[],
            answers: Some(&self.answers),
            left_out: &[],
        }
    }
}

/// Records of all three purposes, one a published row.
pub fn meshes(study: &Study) -> Vec<MeshRecord> {
    let purposes = [Purpose::Benchmark, Purpose::Stimulus, Purpose::Indexed];
    let of = |purpose| study.published.benchmark.iter().map(move |row| mesh(study, row, purpose));
    purposes.into_iter().flat_map(of).collect()
}

fn mesh(study: &Study, row: &BenchmarkRow, purpose: Purpose) -> MeshRecord {
    let object = study.file.objects.iter().find(|o| o.id == row.id.object).unwrap();
    let merged = crossed(row.id.method).clustering.code();
    let (x, y, z) = (u64::from(row.cells_x), u64::from(row.cells_y), u64::from(row.cells_z));
    let body = crossed(row.id.method).arrangement.code() == 'b';
    // The published unclustered count tells the true number of discarded triangles.
    let unclustered = study.published.benchmark.iter().find(|other| {
        other.id.object == row.id.object
            && crossed(other.id.method).arrangement == crossed(row.id.method).arrangement
            && crossed(other.id.method).clustering.code() == 'u'
    });
    let discarded = unclustered.map_or(0, |u| u.triangles - row.triangles);
    let degenerate = if row.aspect_ratio_mean > 100.0 { 96 } else { 0 };
    let (mut mean, mut sd) = (row.aspect_ratio_mean, row.aspect_ratio_sd);
    if degenerate > 0 {
        // The inverse of `published_ratio`, so that the published moments come out again.
        let share = (row.triangles - degenerate) as f64 / row.triangles as f64;
        mean /= share;
        sd = (sd * sd / share - mean * mean * (1.0 - share)).sqrt();
    }
    if matches!(object.field, FieldSection::Mesh { .. }) {
        mean *= 1.004;
    }
    let edge_mean = match (merged, body) {
        ('u', true) => 6.2,
        ('u', false) => 6.8,
        ('i', true) => 1.30,
        ('i', false) => 1.53,
        (_, true) => 1.39,
        (_, false) => 1.62,
    };
    let vertices = row.vertices + u64::from(purpose == Purpose::Indexed && object.id == "ss");
    MeshRecord {
        schema: MeshRecord::SCHEMA,
        region: None,
        trilinear: None,
        program: None,
        id: row.id.clone(),
        purpose,
        spacing: object.benchmark_spacing,
        cells: [row.cells_x, row.cells_y, row.cells_z],
        counts: Counts {
            samples: Some(if body { row.needed_samples } else { (x + 1) * (y + 1) * (z + 1) }),
            cells: Some(x * y * z),
            cells_visited: None,
            crossings: Some(row.vertices),
            vertices,
            triangles: row.triangles,
            discarded_triangles: Some(discarded),
            evaluations: Some(3 * vertices),
            gradients: Some(0),
            vertex_bytes: row.vertex_bytes,
            index_bytes: row.index_bytes,
            tetrahedra: Some(TetrahedraCounts {
                stored_samples: row.stored_samples,
                stored_edges: row.stored_edges,
                needed_edges: if body {
                    row.needed_edges
                } else {
                    7 * x * y * z + 3 * (x * y + x * z + y * z) + x + y + z
                },
                tetrahedra: row.tetrahedra,
                tetrahedra_evaluated: row.tetrahedra_evaluated,
                discarded_as_published: row.discarded_as_published,
                sample_bytes: row.sample_bytes,
                edge_bytes: row.edge_bytes,
            }),
        },
        quality: Quality {
            triangles: row.triangles,
            degenerate,
            published_aspect_ratio: Distribution {
                max: row.aspect_ratio_max,
                ..spread(mean, sd, 1.0, row.triangles - degenerate, (1.0, 4.0, 60))
            },
            edge_ratio: spread(edge_mean, 0.3, 1.0, row.triangles - degenerate, (1.0, 4.0, 60)),
            radius_ratio: spread(0.8, 0.1, 0.0, row.triangles - degenerate, (0.0, 1.0, 50)),
            min_angle_deg: spread(42.0, 7.0, 0.0, row.triangles - degenerate, (0.0, 60.0, 60)),
            max_angle_deg: spread(80.0, 9.0, 60.0, row.triangles - degenerate, (60.0, 180.0, 60)),
            area: Distribution {
                max: row.area_max,
                ..spread(row.area_mean, row.area_sd, 0.0, row.triangles, (0.0, row.area_max, 50))
            },
            shortest_edge: Some(0.001),
        },
        topology: Topology {
            vertices,
            edges: row.triangles * 3 / 2,
            triangles: row.triangles,
            boundary_edges: if object.id == "ss" && body { 8 } else { 0 },
            non_manifold_edges: 0,
            misoriented_edges: 0,
            non_manifold_vertices: 0,
            duplicate_faces: 0,
            folded_faces: 0,
            components: 1,
            euler_characteristic: 2,
            self_intersections: Some(0),
        },
        accuracy: Accuracy {
            distance: spread(2e-4, 1e-4, 0.0, 8_192, (0.0, 0.1 * object.benchmark_spacing, 50)),
            sharp_edges: None,
            distance_to_mesh: Some(spread(3e-4, 2e-4, 0.0, 8_192, (0.0, 0.1 * object.benchmark_spacing, 50))),
            normal_error_deg: spread(2.0, 1.0, 0.0, vertices, (0.0, 30.0, 60)),
            lost_points: 0,
            lost_vertices: degenerate,
        },
    }
}

/// A distribution that falls off from `low`: quantiles and histogram are made up to look like one.
fn spread(mean: f64, sd: f64, low: f64, count: u64, bins: (f64, f64, usize)) -> Distribution {
    let (start, end, n) = bins;
    let centre = (mean - low).min(3.0);
    let at = |share: f64| low + centre * share;
    let weights: Vec<f64> = (0..n)
        .map(|i| {
            let x = start + (end - start) * (i as f64 + 0.5) / n as f64;
            let t = (x - low) / centre.max(1e-9);
            t * (-2.0 * t).exp()
        })
        .collect();
    let sum: f64 = weights.iter().sum::<f64>().max(1e-12);
    let counts: Vec<u64> = weights.iter().map(|w| (w / sum * count as f64) as u64).collect();
    let above = count - counts.iter().sum::<u64>();
    Distribution {
        count,
        mean,
        sd,
        min: low,
        q05: at(0.1),
        q25: at(0.45),
        median: at(0.8),
        q75: at(1.2),
        q95: at(2.1),
        max: mean + 12.0 * sd,
        histogram: Histogram { low: start, high: end, counts, below: 0, above },
    }
}

/// A study unlike the paper's: two objects, one clustering, one group, nothing published.
pub fn small_study() -> Study {
    let path = paper_path();
    let text = std::fs::read_to_string(&path).unwrap().replace("../cache/bunny.ply", "paper.toml");
    let text = text.replace(r#"["none", "integrated", "edge-collapse"]"#, r#"["integrated"]"#);
    let kept =
        |line: &&str| !line.contains("question =") || line.contains("\"Q8\"") || line.contains("\"Q17\"");
    let text = text.lines().filter(kept).collect::<Vec<_>>().join("\n");
    let without = |text: String, start: &str, end: &str| {
        let from = text.find(start).unwrap();
        let to = from + start.len() + text[from + start.len()..].find(end).unwrap();
        format!("{}{}", &text[..from], &text[to..])
    };
    let text = without(text, "[[objects]]\nid = \"as\"", "[[objects]]");
    let text = without(text, "[benchmark.sweep]", "# Comparison groups");
    let text = without(text, "[[groups]]\nid = \"B\"", "[[groups]]\nid = \"I\"");
    let text = without(text, "[[groups]]\nid = \"P\"", "[responses]");
    let text = &text[..text.find("[published]").unwrap()];
    Study::parse(text, &path).unwrap()
}
