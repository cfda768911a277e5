//! Every contrast object by object: does a preference depend on what is shown?

use super::axis::Axis;
use super::forest::{self, Block, Row};
use super::legend::Swatch;
use super::marks::Mark;
use super::{Unfinished, canvas_with_legend};
use design::Level;
use design::Study;
use design::contrast::{Contrast, Over, contrasts};
use statistics::{DeclaredBallot, ScoreTest};

pub(super) fn by_object(study: &Study, ballots: &[DeclaredBallot]) -> Option<Unfinished> {
    let pooled = contrasts(study).into_iter().filter(|c| c.over == Over::All);
    let blocks: Vec<Block> = pooled.filter_map(|contrast| block(study, ballots, &contrast)).collect();
    if blocks.is_empty() {
        return None;
    }
    let mut legend: Vec<(Swatch, String)> = study
        .file
        .objects
        .iter()
        .enumerate()
        .map(|(o, object)| (Swatch::Mark(Mark::nth(o, true)), object.name.clone()))
        .collect();
    legend.push((Swatch::Mark(Mark::nth(0, false)), "all objects".into()));
    legend.push(forest::interval_entry());
    let (mut canvas, top) = canvas_with_legend(&legend, forest::height(&blocks));
    let label = "mean score: \u{2212}1 always the second, 1 always the first";
    forest::draw(&mut canvas, &blocks, &Axis::spanning(-1.0, 1.0), label, 0.0, top);
    let caption = "Preference by object: mean over respondents of answers for the first less answers for the second, over all \
                   their answers to these questions. On the right the answers for the first, without preference, and for the \
                   second. Intervals are cut at \u{2212}1 and 1."
        .into();
    Some(Unfinished { name: "object_interaction", caption, canvas })
}

fn block(study: &Study, ballots: &[DeclaredBallot], contrast: &Contrast) -> Option<Block> {
    let row = |object: Option<usize>| {
        let inside = |b: &&DeclaredBallot| object.is_none_or(|o| study.comparisons[b.question()].object == o);
        let own = ballots.iter().filter(inside);
        let signed = own.filter_map(|b| {
            let sign = contrast.parts[0].get(&b.question())?;
            Some((b.participant(), sign * b.preference().sign()))
        });
        let test = ScoreTest::of(signed);
        let [first, ties, second] = test.counts?;
        (test.participants() > 0).then(|| Row {
            label: object.map_or("all objects".into(), |o| study.file.objects[o].name.clone()),
            value: Some(test.mean),
            interval: test.interval.map(|i| i.cut(-1.0, 1.0)),
            mark: object.map_or(Mark::nth(0, false), |o| Mark::nth(o, true)),
            remark: format!("{first} : {ties} : {second}"),
        })
    };
    let objects = (0..study.file.objects.len()).map(Some);
    let rows: Vec<Row> = objects.chain([None]).filter_map(row).collect();
    let heading =
        format!("{} against {}", label(study, contrast.levels[0]), label(study, contrast.levels[1]));
    (!rows.is_empty()).then_some(Block { heading, rows })
}

fn label(study: &Study, level: Level) -> &str {
    let spec = study.level(level);
    // "none" says nothing without its factor.
    if spec.label == "none" { &spec.phrase } else { &spec.label }
}
