//! One row per timed extraction.

use super::LongFrame;
use super::rows::Rows;
use isostudy_design::record::{BenchRun, BenchSample};

/// The samples of a run in the order measured, those of the A/A block after the others.
pub(crate) fn times(run: &BenchRun) -> LongFrame {
    let measured = run.samples.iter().map(|sample| ("measured", sample));
    let mut rows = Rows::of(measured.chain(run.aa_samples.iter().map(|sample| ("aa", sample))));
    rows.text("id", |(_, sample)| Some(sample.id.to_string()));
    rows.text("object", |(_, sample)| Some(sample.id.object.clone()));
    rows.text("method", |(_, sample)| Some(sample.id.method.to_string()));
    rows.text("block", |(block, _)| Some((*block).into()));
    rows.count("invocation", |(_, sample)| Some(sample.invocation.into()));
    rows.count("iteration", |(_, sample)| Some(sample.iteration.into()));
    rows.count("place", |(_, sample)| Some(sample.place.into()));
    STAGES.iter().for_each(|(name, of, everybody)| {
        rows.number(name, |(_, sample)| (*everybody || sample.has_stages()).then(|| of(sample)));
    });
    let is_finished = |sample: &BenchSample| sample.finishing_s > 0.0;
    if run.samples.iter().chain(&run.aa_samples).any(is_finished) {
        rows.number("finishing_s", |(_, sample)| Some(sample.finishing_s));
    }
    rows.number("reference_s", |(_, sample)| sample.reference_s);
    LongFrame { name: "times", frame: rows.frame(), texts: Vec::new() }
}

/// A column of seconds, where they stand, and whether programs have them too.
type Timed = (&'static str, fn(&BenchSample) -> f64, bool);

const STAGES: [Timed; 7] = [
    ("allocation_s", |s| s.allocation_s, false),
    ("sampling_s", |s| s.sampling_s, true),
    ("vertex_s", |s| s.vertex_s, false),
    ("geometry_s", |s| s.geometry_s, true),
    ("clustering_s", |s| s.clustering_s, false),
    ("normals_s", |s| s.normals_s, false),
    ("total_s", |s| s.total_s, true),
];
