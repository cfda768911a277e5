//! Means of the stages of each configuration, over the samples of a benchmark run.

use isostudy_design::ConfigurationId;
use isostudy_design::machine::ProfileDifference;
use isostudy_design::record::{BenchRun, BenchSample};
use isostudy_table::digits::counted;

/// Mean seconds per stage.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StageTimes {
    /// Making room for samples and edges.
    pub allocation_s: f64,
    /// Sampling the field.
    pub sampling_s: f64,
    /// Crossings and vertices.
    pub vertex_s: f64,
    /// As published: making triangles, and the edge collapse.
    pub geometry_s: f64,
    /// The edge collapse alone.
    pub clustering_s: f64,
    /// Normals of vertices.
    pub normals_s: f64,
    /// The method's finishing steps; 0 where it has none.
    pub finishing_s: f64,
    /// Median of the samples' totals without normals.
    pub median_without_normals_s: f64,
    /// Whether the stages were told apart, see [`BenchSample::has_stages`].
    pub has_stages: bool,
}

impl StageTimes {
    /// Means over a configuration's samples; `None` if it has none.
    pub fn of(run: &BenchRun, id: &ConfigurationId) -> Option<Self> {
        Self::over(run.samples.iter().filter(|sample| sample.id == *id).collect())
    }

    /// Of one round alone; `None` if the configuration has no sample in it.
    pub fn of_round(run: &BenchRun, id: &ConfigurationId, round: u32) -> Option<Self> {
        Self::over(
            run.samples.iter().filter(|sample| sample.id == *id && sample.iteration == round).collect(),
        )
    }

    fn over(samples: Vec<&BenchSample>) -> Option<Self> {
        if samples.is_empty() {
            return None;
        }
        let mean = |stage: fn(&BenchSample) -> f64| {
            samples.iter().map(|sample| stage(sample)).sum::<f64>() / samples.len() as f64
        };
        let mut totals: Vec<f64> = samples.iter().map(|s| s.total_s - s.normals_s).collect();
        totals.sort_unstable_by(f64::total_cmp);
        let middle = totals.len() / 2;
        let median =
            if totals.len() % 2 == 1 { totals[middle] } else { (totals[middle - 1] + totals[middle]) / 2.0 };
        Some(Self {
            allocation_s: mean(|s| s.allocation_s),
            sampling_s: mean(|s| s.sampling_s),
            vertex_s: mean(|s| s.vertex_s),
            geometry_s: mean(|s| s.geometry_s + s.clustering_s),
            clustering_s: mean(|s| s.clustering_s),
            normals_s: mean(|s| s.normals_s),
            finishing_s: mean(|s| s.finishing_s),
            median_without_normals_s: median,
            has_stages: samples.iter().any(|sample| sample.has_stages()),
        })
    }

    /// The published total, the first four stages, and what finishes the mesh.
    pub fn total_without_normals_s(&self) -> f64 {
        self.allocation_s + self.sampling_s + self.vertex_s + self.geometry_s + self.finishing_s
    }
}

/// Where and how often a run was measured, for a note under a table of means. What the machine has instead of the target is
/// said once, by the report.
pub fn conditions(run: &BenchRun) -> String {
    let target = match run.differences.is_empty() {
        true => format!("which matches the target {}", run.target.name),
        false => format!(
            "which does not match the target {}; the report says how, under \u{201c}Machine and timing\u{201d}",
            run.target.name
        ),
    };
    format!("Times: means over {}, {target}.", measured(run))
}

/// How often and where a run was measured, and whether that is the target.
pub fn circumstances(run: &BenchRun) -> String {
    format!("{}, {}.", measured(run), target(run))
}

/// How often, where and on how many threads.
pub fn measured(run: &BenchRun) -> String {
    let (rounds, threads) = (run.iterations as usize, counted(run.threads as usize, "sampling thread"));
    match &run.imported_from {
        // What a profile says of a model is a part of its name.
        Some(source) => {
            format!(
                "means of {} as published in {source}, on {}, {threads}",
                counted(rounds, "iteration"),
                run.target.name
            )
        }
        None => {
            let model = run.machine.model.as_deref().unwrap_or("an unnamed CPU");
            format!("{} after {} of warm-up, on {model}, {threads}", counted(rounds, "iteration"), run.warmup)
        }
    }
}

/// Whether the machine is the target, and what it has instead.
pub fn target(run: &BenchRun) -> String {
    if run.differences.is_empty() {
        return format!("which matches the target {}", run.target.name);
    }
    let instead = |d: &ProfileDifference| format!("{}: {} instead of {}", d.property, d.machine, d.target);
    let list: Vec<String> = run.differences.iter().map(instead).collect();
    format!("which does not match the target {} ({})", run.target.name, list.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    #[test]
    fn means_medians_and_conditions() {
        let study = fixture::study();
        let mut run = fixture::bench(&study);
        let id = study.configurations[0].id.clone();
        run.samples.retain(|s| s.id == id);
        for (sample, vertex_s) in run.samples.iter_mut().zip([1.0, 2.0, 6.0]) {
            sample.vertex_s = vertex_s;
            sample.total_s =
                sample.allocation_s + sample.sampling_s + vertex_s + sample.geometry_s + sample.normals_s;
        }
        run.samples.truncate(3);
        let times = StageTimes::of(&run, &id).unwrap();
        assert_eq!(times.vertex_s, 3.0);
        let without_vertex = times.total_without_normals_s() - 3.0;
        assert!((times.median_without_normals_s - 2.0 - without_vertex).abs() < 1e-3);
        assert_eq!(StageTimes::of(&run, &study.configurations[1].id), None);
        let geometry_s = times.geometry_s;
        run.samples.iter_mut().for_each(|sample| sample.clustering_s = 2.0);
        let collapsed = StageTimes::of(&run, &id).unwrap();
        assert_eq!(collapsed.clustering_s, 2.0);
        assert!((collapsed.geometry_s - geometry_s - 2.0).abs() < 1e-12, "as published, geometry has both");
        assert!(conditions(&run).contains("does not match the target Intel Core i7-11700"));
        run.differences.clear();
        assert!(conditions(&run).contains("which matches the target"));
        (run.iterations, run.threads) = (1, 1);
        let start = "1 iteration after 1 of warm-up, on Example CPU, 1 sampling thread, which";
        assert!(circumstances(&run).starts_with(start), "{}", circumstances(&run));
        run.imported_from = Some("a table".into());
        let text = measured(&run);
        assert_eq!(
            text,
            "means of 1 iteration as published in a table, on Intel Core i7-11700 (the paper's), 1 sampling thread"
        );
    }
}
