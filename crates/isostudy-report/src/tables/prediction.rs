//! What predicts preference: metric by metric, together, object by object.

use isostudy_design::Study;
use isostudy_inference::prediction::{HeldOut, Prediction};
use isostudy_table::{Cell, Column, Table};

/// Metrics one by one, the model of all of them, predictions by object, and how the metrics hang together.
pub(super) fn all(study: &Study, prediction: &Prediction) -> Vec<Table> {
    vec![metrics(prediction), joint(prediction), objects(study, prediction), correlations(prediction)]
}

fn metrics(prediction: &Prediction) -> Table {
    let mut table = Table::new(
        "prediction",
        "What predicts preference? How often the better value was chosen",
        &[
            ("metric", "Metric"),
            ("better", "Better is"),
            ("chosen", "Answers for the better"),
            ("no_preference", "None"),
            ("not_chosen", "Answers for the worse"),
            ("share", "Share of decided"),
            ("share_low", "from"),
            ("share_high", "to"),
            ("p_sign_flip", "p"),
            ("p_adjusted", "p adjusted"),
            ("pairs", "Pairs"),
            ("pairs_won", "won by the better"),
            ("pairs_drawn", "drawn"),
            ("pairs_won_share", "Share of decided pairs"),
            ("better_right", "Answers with the better on the right"),
            ("showings", "of"),
            ("unit", "Unit"),
            ("coefficient", "Log-odds a unit"),
            ("coefficient_se", "SE"),
            ("coefficient_low", "from"),
            ("coefficient_high", "to"),
            ("coefficient_p", "p"),
            ("accuracy", "Left-out accuracy"),
            ("log_loss", "Log loss"),
            ("constant_log_loss", "of the constant"),
            ("gain_p", "p of a gain"),
        ],
    );
    for found in &prediction.metrics {
        let better = &found.better;
        let [chosen, none, not_chosen] = better.test.counts.unwrap_or_default();
        let decided = better.pairs.better + better.pairs.worse;
        let coefficient = found.coefficient.ok();
        let share_interval = better.share.and_then(|s| s.interval).map(|i| i.cut(0.0, 1.0));
        let mut row = vec![
            Cell::text(found.metric.label),
            Cell::text(found.metric.better),
            Cell::count(chosen),
            Cell::count(none),
            Cell::count(not_chosen),
            Cell::number(better.share.map(|s| s.share), 3),
            Cell::number(share_interval.map(|i| i.low), 3),
            Cell::number(share_interval.map(|i| i.high), 3),
            Cell::P(better.test.sign_flip.p(), 5),
            Cell::P(found.adjusted, 4),
            Cell::count(better.pair_count() as u64),
            Cell::count(better.pairs.better as u64),
            Cell::count(better.pairs.drawn as u64),
            Cell::number((decided > 0).then(|| better.pairs.better as f64 / decided as f64), 3),
            Cell::count(found.better_right),
            Cell::count(found.showings),
            Cell::Number(found.unit, 4),
            Cell::number(coefficient.map(|c| c.estimate), 3),
            Cell::number(coefficient.map(|c| c.se), 3),
            Cell::number(coefficient.map(|c| c.interval.low), 3),
            Cell::number(coefficient.map(|c| c.interval.high), 3),
            Cell::p(coefficient.map(|c| c.p), 5),
        ];
        row.extend(judged(found.held_out.as_ref()));
        table.push(row);
    }
    table.notes.push(
        "Metrics are of the meshes that were shown. Share of decided: answers for the side with the better value over all \
         answers but no preference; t interval at 95 % over participants. p: exact sign-flip test over participants, adjusted \
         by Holm over the metrics. A pair is won by the side with more answers. Log-odds: \
         Davidson's model with the metric's difference for the worths, in units of the root mean square of the differences \
         (differences of ratios and angles, logarithms of quotients for the rest); standard error, t interval and p clustered \
         on participants. Left-out: each object predicted from a fit to the others; the constant knows the share of ties and \
         no more; the gain is the mean fall in log loss, p one-sided by a t test over participants. Pairs won and accuracy have no interval: \
         more people would fit better and win other pairs, and no interval tried covers what they would show. Intervals of shares are cut at 0 and 1."
            .into(),
    );
    let blocks: [(&str, &[&str]); 3] = [
        (
            "Answers",
            &[
                "metric",
                "better",
                "chosen",
                "no_preference",
                "not_chosen",
                "share",
                "share_low",
                "share_high",
                "p_sign_flip",
                "p_adjusted",
            ],
        ),
        (
            "Pairs",
            &["metric", "pairs", "pairs_won", "pairs_drawn", "pairs_won_share", "better_right", "showings"],
        ),
        (
            "Model",
            &[
                "metric",
                "unit",
                "coefficient",
                "coefficient_low",
                "coefficient_high",
                "coefficient_p",
                "accuracy",
                "log_loss",
                "constant_log_loss",
                "gain_p",
            ],
        ),
    ];
    table.print_in_blocks(&blocks);
    table
}

/// Accuracy, log losses, and whether there is a gain.
fn judged(held_out: Option<&HeldOut>) -> [Cell; 4] {
    [
        Cell::number(held_out.map(|h| h.accuracy.share), 3),
        Cell::number(held_out.map(|h| h.log_loss), 4),
        Cell::number(held_out.map(|h| h.constant_log_loss), 4),
        Cell::p(held_out.and_then(|h| h.gain_p), 4),
    ]
}

fn joint(prediction: &Prediction) -> Table {
    let mut table = Table::new(
        "prediction_joint",
        "All metrics in one model",
        &[
            ("metric", "Metric"),
            ("coefficient", "Log-odds a unit"),
            ("se", "SE"),
            ("low", "from"),
            ("high", "to"),
            ("p", "p"),
        ],
    );
    match &prediction.joint {
        Ok(coefficients) => {
            for (found, c) in prediction.metrics.iter().zip(coefficients) {
                let numbers = [c.estimate, c.se, c.interval.low, c.interval.high].map(|x| Cell::Number(x, 3));
                let name = std::iter::once(Cell::text(found.metric.label));
                table.push(name.chain(numbers).chain([Cell::P(c.p, 4)]).collect());
            }
        }
        Err(reason) => table.notes.push(format!("No estimate: {reason}.")),
    }
    table.notes.push(
        "Metrics that rise and fall together share their credit in ways that another study would share anew: a coefficient \
         here says little of its metric alone. Units and intervals as for single metrics."
            .into(),
    );
    table
}

fn objects(study: &Study, prediction: &Prediction) -> Table {
    let mut table = Table::new(
        "prediction_objects",
        "Decided answers foretold on each object by a fit to the others",
        &[("predictor", "Predictor")],
    );
    let whole = "All objects";
    let names = study.file.objects.iter().map(|o| (o.id.as_str(), o.name.as_str()));
    for (id, name) in names.chain([("all", whole)]) {
        table.columns.push(Column { name: id.into(), heading: name.into() });
        table.columns.push(Column { name: format!("{id}_of"), heading: "of".into() });
    }
    let metrics = prediction.metrics.iter().map(|m| (m.metric.label, m.held_out.as_ref()));
    let others = [
        ("all metrics", prediction.joint_held_out.as_ref()),
        ("the side alone", prediction.side_held_out.as_ref()),
    ];
    for (name, held_out) in metrics.chain(others) {
        let mut row = vec![Cell::text(name)];
        for object in 0..study.file.objects.len() {
            let own = held_out.and_then(|h| h.objects.iter().find(|(o, ..)| *o == object));
            row.extend([
                Cell::number(own.map(|o| o.1), 0),
                own.map_or(Cell::Missing, |o| Cell::count(o.2 as u64)),
            ]);
        }
        let sum = held_out.map(|h| h.accuracy);
        row.extend([
            Cell::number(sum.map(|s| s.hits), 0),
            sum.map_or(Cell::Missing, |s| Cell::count(s.of as u64)),
        ]);
        table.push(row);
    }
    table.notes.push(
        "Half of them is what guessing foretells. The side alone: whichever side the other objects' answers favoured, \
         whatever stood there. Missing: some fit has no estimate."
            .into(),
    );
    table
}

fn correlations(prediction: &Prediction) -> Table {
    let mut table = Table::new(
        "prediction_correlations",
        "How the metrics hang together: rank correlations of their differences across the pairs",
        &[("metric", "Metric")],
    );
    for found in &prediction.metrics {
        table.columns.push(Column { name: found.metric.code.into(), heading: found.metric.label.into() });
    }
    for (found, row) in prediction.metrics.iter().zip(&prediction.correlations) {
        let numbers = row.iter().map(|r| Cell::number(*r, 2));
        table.push(std::iter::once(Cell::text(found.metric.label)).chain(numbers).collect());
    }
    table.notes.push(
        "Spearman's, each pair taken in both orders, so that what stood on the left does not matter; signed so that 1 means \
         that both metrics call the same side better."
            .into(),
    );
    table
}
