//! The frames that are written beside a study's tables.

use crate::frames::{COLUMNS, LongFrame, answers, meshes, times};
use isostudy_inference::answered::Answered;
use isostudy_inference::inputs::Inputs;

/// The frames of a study: `answers`, `meshes` and `times`, without those that it has no rows of.
pub fn frames(inputs: &Inputs<'_>) -> Vec<LongFrame> {
    let of_answers =
        |answered: &Answered| answers(Some(inputs.study), &answered.responses, &answered.excluded, &COLUMNS);
    let mut frames: Vec<LongFrame> = inputs.answers.map(of_answers).into_iter().collect();
    frames.push(meshes(inputs.study, inputs.meshes));
    frames.extend(inputs.bench.map(times));
    frames.retain(|frame| frame.height() > 0);
    frames
}
