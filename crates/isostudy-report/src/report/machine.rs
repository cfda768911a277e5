//! The machine of the times, once, and what was timed.

use crate::statement::Block;
use isostudy_inference::inputs::Inputs;
use isostudy_table::digits::counted;
use isostudy_timing::stage_times::circumstances;

/// Nothing where nothing was timed.
pub(super) fn described(inputs: &Inputs<'_>) -> Vec<Block> {
    let Some(run) = inputs.bench.filter(|run| !run.samples.is_empty()) else { return Vec::new() };
    let positions = inputs.study.file.extraction.as_ref().map(|section| {
        section.get("positions").and_then(|value| value.as_str()).unwrap_or("indexed").to_owned()
    });
    let extractor = match positions.as_deref() {
        Some("accumulated") => {
            "The extractor is the dense one: positions are accumulated as in the paper, and all samples are taken and kept. \
             With indexed positions the streaming extractor takes samples near the surface alone, and is several times faster."
        }
        Some(_) => {
            "Positions are indexed, so that extractors stream: they keep a few layers and take samples near the surface alone."
        }
        None => "Each method's recipe in the study file says its extractor and its positions.",
    };
    vec![
        Block::Text(format!("Times are over {}", circumstances(run))),
        Block::Text(format!(
            "Timed is one extraction in memory, from the field to the mesh: allocation, sampling, vertices, geometry and \
             normals. Reading and writing files are not timed. Sampling runs on {}, the other stages on one. {extractor}",
            counted(run.threads as usize, "thread")
        )),
    ]
}
