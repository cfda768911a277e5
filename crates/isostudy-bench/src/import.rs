//! A published table of means as a run, so that it stands beside ours.

use crate::error::BenchError;
use crate::stages::StageSeconds;
use isostudy_design::machine::{Build, CpuProfile, Machine};
use isostudy_design::published::BenchmarkRow;
use isostudy_design::record::{BenchRun, BenchSample};
use std::collections::HashSet;

/// A run with one sample for each row: what was published is a mean, so there is no spread and no interval can be had.
///
/// `iterations` are the rounds that the means are of; `source` says where they are from. The machine is what the profile
/// tells of it. The published geometry stage has the edge collapse in it and cannot be taken apart: it becomes
/// `geometry_s`, and `clustering_s` is 0.
///
/// # Errors
/// If there are no rows, an id is there twice, or a time is not a duration.
pub fn import(
    rows: &[BenchmarkRow],
    source: &str,
    iterations: u32,
    threads: u32,
    profile: &CpuProfile,
) -> Result<BenchRun, BenchError> {
    if rows.is_empty() {
        return Err(BenchError::NoRows);
    }
    let mut seen = HashSet::new();
    let samples: Vec<BenchSample> = rows.iter().zip(0..).map(|(row, place)| sample(row, place)).collect();
    for sample in &samples {
        if !seen.insert(&sample.id) {
            return Err(BenchError::Repeated(sample.id.clone()));
        }
        sample.check(1).map_err(|reason| BenchError::Row { id: sample.id.clone(), reason })?;
    }
    let machine = machine_of(profile);
    Ok(BenchRun {
        schema: BenchRun::SCHEMA,
        study: source.into(),
        workloads: Vec::new(),
        imported_from: Some(source.into()),
        warmup: 0,
        iterations,
        aa_iterations: 0,
        seed: 0,
        threads,
        reference_threads: 1,
        pinned: None,
        target: profile.clone(),
        differences: crate::differences(profile, &machine),
        machine,
        samples,
        aa_samples: Vec::new(),
        load: Vec::new(),
        memory: Vec::new(),
        resumed: Vec::new(),
        failed: Vec::new(),
        allocations: Vec::new(),
    })
}

fn sample(row: &BenchmarkRow, place: u32) -> BenchSample {
    let &BenchmarkRow { allocation_s, sampling_s, vertex_s, geometry_s, normals_s, .. } = row;
    let stages = StageSeconds {
        allocation_s,
        sampling_s,
        vertex_s,
        geometry_s,
        clustering_s: 0.0,
        normals_s,
        finishing_s: 0.0,
    };
    stages.sample(row.id.clone(), [0, 0, place], None)
}

fn machine_of(profile: &CpuProfile) -> Machine {
    Machine {
        model: (!profile.model.is_empty()).then(|| profile.model.clone()),
        cores: profile.cores,
        threads: profile.threads.unwrap_or(0),
        memory_bytes: profile.memory_gib.map(|gib| u64::from(gib) << 30),
        l1d_kib: profile.l1d_kib,
        l2_kib: profile.l2_kib,
        l3_kib: profile.l3_kib,
        os: profile.os.clone().unwrap_or_default(),
        isa: profile.isa,
        features: profile.features.clone(),
        build: Build { target_cpu: profile.target_cpu.clone().unwrap_or_default(), ..Build::default() },
        ..Machine::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_design::record::InvalidSample;

    fn rows() -> Vec<BenchmarkRow> {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../study/paper/published_benchmark.csv");
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).unwrap();
        reader.deserialize().collect::<Result<_, _>>().unwrap()
    }

    #[test]
    fn the_published_table_becomes_a_run_of_means() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../configs/cpu/i7-11700.toml");
        let profile: CpuProfile = toml::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        let run = import(&rows(), "Costen (2026)", 100, 16, &profile).unwrap();
        assert_eq!((run.samples.len(), run.iterations, run.threads), (18, 100, 16));
        assert_eq!(run.differences, [], "the machine is the profile's own");
        let sphere = &run.samples[0];
        assert_eq!(
            (sphere.id.to_string().as_str(), sphere.geometry_s, sphere.clustering_s),
            ("ss_bu", 0.003084, 0.0)
        );
        // As published, with the normals that the published total leaves out.
        for (sample, row) in run.samples.iter().zip(rows()) {
            assert!(
                (sample.total_s - sample.normals_s - row.total_without_normals_s).abs() < 2.5e-6,
                "{}",
                row.id
            );
        }
    }

    #[test]
    fn a_table_that_makes_no_sense_is_refused() {
        let profile: CpuProfile = toml::from_str("name = \"any\"\nmodel = \"\"").unwrap();
        let error = |rows: &[BenchmarkRow]| import(rows, "x", 1, 1, &profile).unwrap_err();
        assert!(matches!(error(&[]), BenchError::NoRows));
        let mut rows = rows();
        rows[3].vertex_s = -1.0;
        let negative = InvalidSample::NotADuration { what: "vertex", seconds: -1.0 };
        assert!(matches!(
            error(&rows),
            BenchError::Row { id, reason } if id == rows[3].id && reason == negative
        ));
        let twice = [rows[0].clone(), rows[0].clone()];
        assert!(matches!(error(&twice), BenchError::Repeated(_)));
    }
}
