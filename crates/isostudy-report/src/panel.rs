//! One configuration at a glance: mesh, generation, timing, geometry.

use isostudy_design::machine::Machine;
use isostudy_design::record::{BenchSample, Distribution, MeshRecord};
use isostudy_design::{Configuration, Stage, Study};
use isostudy_statistics::interval::LEVEL;
use isostudy_statistics::{Median, median};
use isostudy_table::digits::counted;
use serde::Serialize;
use std::fmt::Write;

/// The version of [`Panel`] as JSON.
///
/// 2 has the distance from the isosurface to the mesh (`mesh.accuracy.distance_to_mesh`), 3 the study, the machine and how
/// many extractions were timed.
pub const PANEL_SCHEMA: u32 = 4;

/// What is known of one configuration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Panel {
    /// Version of this layout; [`PANEL_SCHEMA`].
    pub schema: u32,
    /// The study's id.
    pub study: String,
    /// The machine that it was timed on.
    pub machine: Machine,
    /// How many extractions were timed.
    pub iterations: usize,
    /// What the object is called.
    pub object: String,
    /// What the method is called.
    pub method: String,
    /// Threads in the sampling stage.
    pub threads: u32,
    /// Median seconds of the six stages and of their total, in their order.
    pub times: Vec<StageTime>,
    /// Counts, geometry and topology.
    pub mesh: MeshRecord,
}

/// The median time of a stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageTime {
    /// Which stage.
    pub stage: Stage,
    /// The median in seconds with its order-statistic interval.
    #[serde(flatten)]
    pub seconds: Median,
}

impl Panel {
    /// Puts a mesh and the samples of its extraction together. Samples of other configurations are not counted.
    pub fn new(
        study: &Study,
        configuration: &Configuration,
        machine: Machine,
        mesh: MeshRecord,
        samples: &[BenchSample],
        threads: u32,
    ) -> Self {
        let own: Vec<&BenchSample> = samples.iter().filter(|sample| sample.id == mesh.id).collect();
        let time = |stage: Stage| {
            let seconds = median(own.iter().map(|sample| stage.of(sample)).collect(), LEVEL)?;
            Some(StageTime { stage, seconds })
        };
        Self {
            schema: PANEL_SCHEMA,
            study: study.file.study.id.clone(),
            machine,
            iterations: own.len(),
            object: study.object(configuration).name.clone(),
            method: study.method(configuration.id.method).label.clone(),
            threads,
            times: Stage::parts_of(own.iter().copied()).into_iter().filter_map(time).collect(),
            mesh,
        }
    }

    /// The panel as text, a line each number.
    pub fn to_text(&self) -> String {
        let mut text = Lines::default();
        let (m, c) = (&self.mesh, &self.mesh.counts);
        let [x, y, z] = m.cells;
        text.heading(&format!(
            "{}: {}, {}, {x} x {y} x {z} cubes of {}",
            m.id, self.object, self.method, m.spacing
        ));
        text.heading("mesh");
        text.count("vertices", c.vertices);
        text.count("triangles", c.triangles);
        if let Some(discarded) = c.discarded_triangles {
            text.share("discarded triangles", discarded, c.triangles + discarded, "of all");
        }
        if let Some(of) = &c.tetrahedra {
            text.count("  as published, some twice", of.discarded_as_published);
        }
        let t = &m.topology;
        text.line("Euler characteristic", &t.euler_characteristic.to_string(), "");
        text.count("components", t.components);
        text.count("boundary edges", t.boundary_edges);
        text.count("edges of more than two triangles", t.non_manifold_edges);
        text.heading("generation");
        let needed = c.samples.unwrap_or_default();
        match &c.tetrahedra {
            Some(of) => {
                text.share("sample points stored", of.stored_samples, needed, "of those needed");
                text.count("  needed", needed);
                text.share("edges stored", of.stored_edges, of.needed_edges, "of those needed");
                text.count("  needed", of.needed_edges);
                text.share("tetrahedra evaluated", of.tetrahedra_evaluated, of.tetrahedra, "of all");
                text.count("  all", of.tetrahedra);
                text.count("lattice edges that cross", c.crossings.unwrap_or_default());
                text.count("bytes of samples", of.sample_bytes);
                text.count("bytes of edges", of.edge_bytes);
            }
            None => {
                let known = [
                    ("sample points", c.samples),
                    ("cells", c.cells),
                    ("cells looked into", c.cells_visited),
                    ("grid edges that cross", c.crossings),
                ];
                known
                    .iter()
                    .filter_map(|(name, count)| Some((name, (*count)?)))
                    .for_each(|(name, count)| text.count(name, count));
            }
        }
        text.count("bytes of vertices", c.vertex_bytes);
        text.count("bytes of indices", c.index_bytes);
        self.timing(&mut text);
        text.heading("geometry");
        text.spread("area", &m.quality.area, 6);
        text.spread("ratio of two edges, published", &m.quality.published_aspect_ratio, 3);
        text.spread("ratio of three edges", &m.quality.edge_ratio, 3);
        text.spread("radius ratio", &m.quality.radius_ratio, 3);
        text.spread("smallest angle, degrees", &m.quality.min_angle_deg, 1);
        text.count("degenerate triangles", m.quality.degenerate);
        text.heading("distance");
        let back = m.accuracy.distance_to_mesh.as_ref();
        for (name, of) in [("mesh to isosurface", Some(&m.accuracy.distance)), ("isosurface to mesh", back)] {
            let Some(of) = of else { continue };
            text.spread(&format!("{name}, mean"), of, 6);
            if of.count > 0 {
                text.line("  RMS", &format!("{:.6}", of.rms()), "");
            }
        }
        text.count("points without one", m.accuracy.lost_points);
        if let Some(hausdorff) = m.accuracy.hausdorff() {
            let size = m.cells.map(|cells| f64::from(cells) * m.spacing);
            let diagonal = size.iter().map(|side| side * side).sum::<f64>().sqrt();
            let share = format!(
                "{:.4} % of the volume's diagonal, {:.3} spacings",
                100.0 * hausdorff / diagonal,
                hausdorff / m.spacing
            );
            text.line("Hausdorff distance", &format!("{hausdorff:.6}"), &share);
        }
        text.0
    }

    fn timing(&self, text: &mut Lines) {
        if self.times.is_empty() {
            return text.heading("timing: none, the mesh was read from a file");
        }
        let (times, threads) =
            (counted(self.iterations, "extraction"), counted(self.threads as usize, "sampling thread"));
        let model = self.machine.model.as_deref().unwrap_or("an unnamed CPU");
        text.heading(&format!("timing, ms: medians of {times} on {threads} of {model}"));
        let total =
            self.times.iter().find(|time| time.stage == Stage::Total).map_or(0.0, |t| t.seconds.median);
        for StageTime { stage, seconds } in &self.times {
            let ms = format!("{:.3}", 1e3 * seconds.median);
            let remark = match (seconds.interval, stage) {
                (Some(i), Stage::Total) => format!("{:.3} to {:.3}", 1e3 * i.low, 1e3 * i.high),
                (_, Stage::Total) => String::new(),
                _ if total > 0.0 => format!("{:.1} %", 100.0 * seconds.median / total),
                _ => String::new(),
            };
            text.line(stage.label(), &ms, &remark);
        }
    }
}

/// Lines of name, number and remark.
#[derive(Default)]
struct Lines(String);

impl Lines {
    fn heading(&mut self, heading: &str) {
        let gap = if self.0.is_empty() { "" } else { "\n" };
        writeln!(self.0, "{gap}{heading}").expect("a string takes everything");
    }

    fn line(&mut self, name: &str, value: &str, remark: &str) {
        let line = format!("  {name:<34}{value:>14}  {remark}");
        writeln!(self.0, "{}", line.trim_end()).expect("a string takes everything");
    }

    fn count(&mut self, name: &str, count: u64) {
        self.line(name, &crate::words::whole(count), "");
    }

    fn share(&mut self, name: &str, part: u64, whole: u64, of: &str) {
        let share = if whole > 0 {
            format!("{:.2} % {of}", 100.0 * part as f64 / whole as f64)
        } else {
            String::new()
        };
        self.line(name, &crate::words::whole(part), &share);
    }

    fn spread(&mut self, name: &str, of: &Distribution, decimals: usize) {
        if of.count == 0 {
            return self.line(name, "none", "");
        }
        let remark = format!("SD {:.decimals$}, {:.decimals$} to {:.decimals$}", of.sd, of.min, of.max);
        self.line(name, &format!("{:.decimals$}", of.mean), &remark);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    #[test]
    fn a_panel_has_what_was_counted_and_measured() {
        let study = fixture::study();
        let configuration = study.configurations.iter().find(|c| c.id.to_string() == "ss_bi").unwrap();
        let mesh = fixture::meshes(&study).into_iter().find(|mesh| mesh.id == configuration.id).unwrap();
        let mut samples = fixture::bench(&study).samples;
        for sample in &mut samples {
            // The median of 1, 2, 3 ... rounds, and a total that is not their sum, so that none stands for another.
            sample.vertex_s = 0.001 * f64::from(sample.iteration + 1);
            sample.total_s = 0.010;
        }
        let machine = Machine { model: Some("Example CPU".into()), ..Machine::default() };
        let panel = Panel::new(&study, configuration, machine, mesh, &samples, 2);
        assert_eq!((panel.study.as_str(), panel.iterations), ("paper", 5));
        let text = panel.to_text();
        let has = |line: &str| assert!(text.lines().any(|l| l == line), "{line}\n{text}");
        has("ss_bi: sphere, body-centred, integrated, 50 x 50 x 50 cubes of 0.04");
        has("  vertices                                  13,605");
        // 101,720 without clustering.
        has("  discarded triangles                       74,520  73.26 % of all");
        has("    as published, some twice               105,086");
        has("  tetrahedra evaluated                     160,992  10.52 % of all");
        has("timing, ms: medians of 5 extractions on 2 sampling threads of Example CPU");
        has("  vertex                                     3.000  30.0 %");
        has("  mesh to isosurface, mean                0.000200  SD 0.000100, 0.000000 to 0.001400");
        has("    RMS                                   0.000224");
        has("  isosurface to mesh, mean                0.000300  SD 0.000200, 0.000000 to 0.002700");
        has(
            "  Hausdorff distance                      0.002700  0.0779 % of the volume's diagonal, 0.068 spacings",
        );
        assert_eq!(panel.times.len(), 7);
        assert!((panel.times[2].seconds.median - 0.003).abs() < 1e-12);
    }
}
