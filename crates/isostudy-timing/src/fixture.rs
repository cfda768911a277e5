//! Runs of a benchmark, made up from the paper's published one. Tests of `isostudy-inference` and what follows it include this file.

use isostudy_design::Study;
use isostudy_design::machine::{Machine, ProfileDifference};
use isostudy_design::record::{BenchRun, BenchSample, Counters, PeakMemory, SweepMesh};
use std::path::{Path, PathBuf};

/// The paper's study file.
pub fn paper_path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/paper.toml")
}

/// The paper's study; its bunny is any file that is always there.
pub fn study() -> Study {
    study_with(&[])
}

/// The paper's study with passages of its file replaced.
pub fn study_with(replacements: &[(&str, &str)]) -> Study {
    let path = paper_path();
    let mut text = std::fs::read_to_string(&path).unwrap().replace("../cache/bunny.ply", "paper.toml");
    for (from, to) in replacements {
        assert!(text.contains(from), "{from} is not in {}", path.display());
        text = text.replace(from, to);
    }
    Study::parse(&text, &path).unwrap()
}

/// The two letters of a published method.
pub fn crossed(method: isostudy_design::MethodId) -> isostudy_design::Crossed {
    isostudy_design::Crossed::of(method).expect("two letters")
}

/// Five rounds with a little deterministic unrest, on another machine than the paper's.
pub fn bench(study: &Study) -> BenchRun {
    bench_of(study, 5)
}

/// The same of so many rounds.
pub fn bench_of(study: &Study, rounds: u32) -> BenchRun {
    let mut samples = Vec::new();
    for iteration in 0..rounds {
        for (place, row) in study.published.benchmark.iter().enumerate() {
            let unrest = 1.4 + 0.03 * f64::from((iteration * 7 + place as u32 * 3) % 5);
            let [a, s, v, g, n] =
                [row.allocation_s, row.sampling_s, row.vertex_s, row.geometry_s, row.normals_s]
                    .map(|t| t * unrest);
            samples.push(BenchSample {
                id: row.id.clone(),
                invocation: 0,
                iteration,
                place: place as u32,
                allocation_s: a,
                sampling_s: s,
                vertex_s: v,
                geometry_s: g,
                clustering_s: 0.0,
                normals_s: n,
                finishing_s: 0.0,
                total_s: a + s + v + g + n,
                reference_s: None,
                counters: Counters::default(),
            });
        }
    }
    BenchRun {
        schema: BenchRun::SCHEMA,
        study: study.file.study.id.clone(),
        workloads: Vec::new(),
        imported_from: None,
        warmup: 1,
        iterations: rounds,
        aa_iterations: 0,
        seed: 1,
        threads: 2,
        reference_threads: 1,
        pinned: None,
        target: study.target.clone(),
        machine: Machine {
            model: Some("Example CPU".into()),
            cores: Some(2),
            threads: 2,
            memory_bytes: Some(8 << 30),
            os: "linux".into(),
            features: vec!["avx2".into()],
            load: Some(0.1),
            ..Machine::default()
        },
        differences: vec![ProfileDifference {
            property: "model".into(),
            target: "i7-11700".into(),
            machine: "Example CPU".into(),
        }],
        samples,
        aa_samples: Vec::new(),
        load: Vec::new(),
        memory: Vec::new(),
        resumed: Vec::new(),
        failed: Vec::new(),
        allocations: Vec::new(),
    }
}

/// Runs by cells per axis and threads, and meshes, whose law is known: every stage of every configuration grows as the square of the cells, twice the threads halve
/// the time, memory grows as the cube; integrated clustering is the more regular and has a quarter of the triangles.
pub fn sweep_levels(study: &Study) -> (Vec<(u32, u32, BenchRun)>, Vec<SweepMesh>) {
    let base = bench_of(study, 9);
    let (mut levels, mut meshes) = (Vec::new(), Vec::new());
    for cells in [16_u32, 32, 64, 128] {
        let size = f64::from(cells) / 32.0;
        for threads in [1_u32, 2] {
            let mut run = base.clone();
            run.samples.retain(|sample| sample.id.object == "ss");
            for sample in &mut run.samples {
                let unrest = 1.0 + 0.01 * f64::from(sample.iteration % 3);
                let stage = 1e-3 * size.powi(2) / f64::from(threads) * unrest;
                (sample.allocation_s, sample.sampling_s, sample.vertex_s) = (stage, stage, stage);
                (sample.geometry_s, sample.clustering_s, sample.normals_s) = (stage, stage, stage);
                sample.total_s = 6.0 * stage;
            }
            run.memory = study
                .configurations
                .iter()
                .map(|c| PeakMemory {
                    id: c.id.clone(),
                    before_bytes: 1000,
                    peak_before_bytes: 1000,
                    peak_bytes: 1000 + (1e6 * size.powi(3)) as u64,
                })
                .collect();
            levels.push((cells, threads, run));
        }
        for configuration in study.configurations.iter().filter(|c| c.id.object == "ss") {
            let merged =
                crossed(configuration.id.method).clustering == isostudy_design::Clustering::Integrated;
            meshes.push(SweepMesh {
                id: configuration.id.clone(),
                cells,
                needed_samples: u64::from(cells).pow(3),
                vertices: 500,
                triangles: (if merged { 1000.0 } else { 4000.0 } * size.powi(2)) as u64,
                radius_ratio_mean: if merged { 0.9 } else { 0.6 },
                edge_ratio_mean: 1.3,
                published_aspect_ratio_mean: 1.2,
            });
        }
    }
    (levels, meshes)
}
