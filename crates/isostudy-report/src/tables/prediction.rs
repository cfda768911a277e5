//! What predicts preference: metric by metric, together, object by object.

use isostudy_design::Study;
use isostudy_inference::prediction::{MetricPrediction, Prediction};
use isostudy_statistics::Coefficient;
use isostudy_statistics::interval::Interval;
use isostudy_table::{Cell, Column, Table, field, field_in};

/// Metrics one by one, the model of all of them, predictions by object, and how the metrics hang together.
pub(super) fn all(study: &Study, prediction: &Prediction) -> Vec<Table> {
    vec![metrics(prediction), joint(prediction), objects(study, prediction), correlations(prediction)]
}

fn metrics(prediction: &Prediction) -> Table {
    type Row<'a> = &'a MetricPrediction;
    fn chosen(of: Row<'_>, outcome: usize) -> Cell {
        Cell::count(of.better.test.counts.unwrap_or_default()[outcome])
    }
    fn share(of: Row<'_>) -> Option<Interval> {
        of.better.share.and_then(|s| s.interval).map(|i| i.cut(0.0, 1.0))
    }
    fn coefficient(of: Row<'_>, number: fn(&Coefficient) -> f64) -> Cell {
        Cell::number(of.coefficient.as_ref().ok().map(number), 3)
    }
    let fields = [
        field_in(&[0, 1, 2], "metric", "Metric", |of: &Row<'_>| Cell::text(of.metric.label)),
        field_in(&[0], "better", "Better is", |of| Cell::text(of.metric.better)),
        field_in(&[0], "chosen", "Answers for the better", |of| chosen(of, 0)),
        field_in(&[0], "no_preference", "None", |of| chosen(of, 1)),
        field_in(&[0], "not_chosen", "Answers for the worse", |of| chosen(of, 2)),
        field_in(&[0], "share", "Share of decided", |of| Cell::number(of.better.share.map(|s| s.share), 3)),
        field_in(&[0], "share_low", "from", |of| Cell::number(share(of).map(|i| i.low), 3)),
        field_in(&[0], "share_high", "to", |of| Cell::number(share(of).map(|i| i.high), 3)),
        field_in(&[0], "p_sign_flip", "p", |of| Cell::P(of.better.test.sign_flip.p(), 5)),
        field_in(&[0], "p_adjusted", "p adjusted", |of| Cell::P(of.adjusted, 4)),
        field_in(&[1], "pairs", "Pairs", |of| Cell::count(of.better.pair_count() as u64)),
        field_in(&[1], "pairs_won", "won by the better", |of| Cell::count(of.better.pairs.better as u64)),
        field_in(&[1], "pairs_drawn", "drawn", |of| Cell::count(of.better.pairs.drawn as u64)),
        field_in(&[1], "pairs_won_share", "Share of decided pairs", |of| {
            let decided = of.better.pairs.better + of.better.pairs.worse;
            Cell::number((decided > 0).then(|| of.better.pairs.better as f64 / decided as f64), 3)
        }),
        field_in(&[1], "better_right", "Answers with the better on the right", |of| {
            Cell::count(of.better_right)
        }),
        field_in(&[1], "showings", "of", |of| Cell::count(of.showings)),
        field_in(&[2], "unit", "Unit", |of| Cell::Number(of.unit, 4)),
        field_in(&[2], "coefficient", "Log-odds a unit", |of| coefficient(of, |c| c.estimate)),
        field_in(&[], "coefficient_se", "SE", |of| coefficient(of, |c| c.se)),
        field_in(&[2], "coefficient_low", "from", |of| coefficient(of, |c| c.interval.low)),
        field_in(&[2], "coefficient_high", "to", |of| coefficient(of, |c| c.interval.high)),
        field_in(&[2], "coefficient_p", "p", |of| Cell::p(of.coefficient.as_ref().ok().map(|c| c.p), 5)),
        field_in(&[2], "accuracy", "Left-out accuracy", |of| {
            Cell::number(of.held_out.as_ref().map(|h| h.accuracy.share), 3)
        }),
        field_in(&[2], "log_loss", "Log loss", |of| {
            Cell::number(of.held_out.as_ref().map(|h| h.log_loss), 4)
        }),
        field_in(&[2], "constant_log_loss", "of the constant", |of| {
            Cell::number(of.held_out.as_ref().map(|h| h.constant_log_loss), 4)
        }),
        field_in(&[2], "gain_p", "p of a gain", |of| Cell::p(of.held_out.as_ref().and_then(|h| h.gain_p), 4)),
    ];
    let caption = "What predicts preference? How often the better value was chosen";
    let mut table = Table::of("prediction", caption, &fields, &prediction.metrics);
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
    table.show_in_blocks(&fields, &["Answers", "Pairs", "Model"]);
    table
}

fn joint(prediction: &Prediction) -> Table {
    let fields = [
        field("metric", "Metric", |(of, _): &(&MetricPrediction, &Coefficient)| Cell::text(of.metric.label)),
        field("coefficient", "Log-odds a unit", |(_, c)| Cell::Number(c.estimate, 3)),
        field("se", "SE", |(_, c)| Cell::Number(c.se, 3)),
        field("low", "from", |(_, c)| Cell::Number(c.interval.low, 3)),
        field("high", "to", |(_, c)| Cell::Number(c.interval.high, 3)),
        field("p", "p", |(_, c)| Cell::P(c.p, 4)),
    ];
    let coefficients = prediction.joint.as_deref().unwrap_or_default();
    let rows = prediction.metrics.iter().zip(coefficients);
    let mut table = Table::of("prediction_joint", "All metrics in one model", &fields, rows);
    if let Err(reason) = &prediction.joint {
        table.notes.push(format!("No estimate: {reason}."));
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
