//! Fronts in words: who is not beaten, and how many are.

use crate::statement::Block;
use crate::words::{capital, list};
use isostudy_design::MethodId;
use isostudy_inference::decision::{Front, ObjectCandidates, Standing};
use isostudy_inference::results::Decision;
use isostudy_table::digits::counted;

/// A paragraph an object, by code; the table says who beats whom.
pub(super) fn fronts_in_words(found: &Decision<'_>) -> Vec<Block> {
    let paragraph = |(of, fronts): (&ObjectCandidates<'_>, &[Front])| {
        let sentences: Vec<String> = fronts.iter().map(sentence).collect();
        let text = format!("{}: {}", capital(&of.object.name), sentences.join(" "));
        (!sentences.is_empty()).then_some(Block::Text(text))
    };
    found.each().filter_map(paragraph).collect()
}

fn sentence(front: &Front) -> String {
    let of = |holds: fn(&Standing) -> bool| -> Vec<MethodId> {
        front.points.iter().filter(|point| holds(&point.standing)).map(|point| point.method).collect()
    };
    let codes = |ids: &[MethodId]| list(&ids.iter().map(MethodId::to_string).collect::<Vec<_>>());
    let best = of(|standing| *standing == Standing::OnFront);
    let perhaps = of(|standing| matches!(standing, Standing::PerhapsBeaten(_)));
    let beaten = of(|standing| matches!(standing, Standing::Beaten(_)));
    let mut text = format!("In {} no method beats {}", front.axes.label(), codes(&best));
    if !perhaps.is_empty() {
        text.push_str(&format!("; {} may be beaten, within the intervals", codes(&perhaps)));
    }
    match beaten.len() {
        0 => {}
        n if n <= 6 => {
            text.push_str(&format!("; {} {} beaten", codes(&beaten), if n == 1 { "is" } else { "are" }))
        }
        n => text.push_str(&format!("; the other {} are beaten", counted(n, "method"))),
    }
    text + "."
}
