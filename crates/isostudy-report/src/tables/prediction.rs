//! What predicts preference: metric by metric, together, object by object.

use crate::region;
use isostudy_design::Study;
use isostudy_inference::prediction::{HeldOut, MetricPrediction, Prediction};
use isostudy_statistics::Coefficient;
use isostudy_statistics::interval::Interval;
use isostudy_table::{Cell, Columns, Table};

/// Metrics one by one, the model of all of them, predictions by object, and how the metrics hang together.
pub(super) fn all(study: &Study, prediction: &Prediction) -> Vec<Table> {
    vec![metrics(study, prediction), joint(prediction), objects(study, prediction), correlations(prediction)]
}

fn metrics(study: &Study, prediction: &Prediction) -> Table {
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
    let caption = "What predicts preference? How often the better value was chosen";
    let mut table = Columns::over(&prediction.metrics)
        .column_in(&[0, 1, 2], "metric", "Metric", |of| Cell::text(of.metric.label))
        .column_in(&[0], "better", "Better is", |of| Cell::text(of.metric.better))
        .column_in(&[0], "chosen", "Answers for the better", |of| chosen(of, 0))
        .column_in(&[0], "no_preference", "None", |of| chosen(of, 1))
        .column_in(&[0], "not_chosen", "Answers for the worse", |of| chosen(of, 2))
        .column_in(&[0], "share", "Share of decided", |of| Cell::number(of.better.share.map(|s| s.share), 3))
        .column_in(&[0], "share_low", "from", |of| Cell::number(share(of).map(|i| i.low), 3))
        .column_in(&[0], "share_high", "to", |of| Cell::number(share(of).map(|i| i.high), 3))
        .column_in(&[0], "p_sign_flip", "p", |of| Cell::P(of.better.test.sign_flip.p(), 5))
        .column_in(&[0], "p_adjusted", "p adjusted", |of| Cell::P(of.adjusted, 4))
        .column_in(&[0], "p_relabelled", "p over methods", |of| Cell::p(of.relabelled.map(|of| of.p), 4))
        .column_in(&[0], "p_relabelled_adjusted", "adjusted", |of| {
            Cell::p(of.relabelled.map(|of| of.adjusted), 4)
        })
        .column_in(&[1], "pairs", "Pairs", |of| Cell::count(of.better.pair_count() as u64))
        .column_in(&[1], "pairs_won", "won by the better", |of| Cell::count(of.better.pairs.better as u64))
        .column_in(&[1], "pairs_drawn", "drawn", |of| Cell::count(of.better.pairs.drawn as u64))
        .column_in(&[1], "pairs_won_share", "Share of decided pairs", |of| {
            let decided = of.better.pairs.better + of.better.pairs.worse;
            Cell::number((decided > 0).then(|| of.better.pairs.better as f64 / decided as f64), 3)
        })
        .column_in(&[1], "better_right", "Answers with the better on the right", |of| {
            Cell::count(of.better_right)
        })
        .column_in(&[1], "showings", "of", |of| Cell::count(of.showings))
        .column_in(&[2], "unit", "Unit", |of| Cell::Number(of.unit, 4))
        .column_in(&[2], "coefficient", "Log-odds a unit", |of| coefficient(of, |c| c.estimate))
        .column_in(&[], "coefficient_se", "SE", |of| coefficient(of, |c| c.se))
        .column_in(&[2], "coefficient_low", "from", |of| coefficient(of, |c| c.interval.low))
        .column_in(&[2], "coefficient_high", "to", |of| coefficient(of, |c| c.interval.high))
        .column_in(&[2], "coefficient_p", "p", |of| Cell::p(of.coefficient.as_ref().ok().map(|c| c.p), 5))
        .column_in(&[2], "accuracy", "Left-out accuracy", |of| {
            Cell::number(of.held_out.as_ref().map(|h| h.accuracy.share), 3)
        })
        .column_in(&[2], "log_loss", "Log loss", |of| {
            Cell::number(of.held_out.as_ref().map(|h| h.log_loss), 4)
        })
        .column_in(&[2], "constant_log_loss", "of the constant", |of| {
            Cell::number(of.held_out.as_ref().map(|h| h.constant_log_loss), 4)
        })
        .column_in(&[2], "gain_p", "p of a gain", |of| {
            Cell::p(of.held_out.as_ref().and_then(|h| h.gain_p), 4)
        })
        .column_in(&[2], "gain_p_adjusted", "adjusted", |of| Cell::p(of.gain_adjusted, 4))
        .into_blocks("prediction", caption, &["Answers", "Pairs", "Model"]);
    table.notes.push(
        "Metrics are of the meshes that were shown. Share of decided: answers for the side with the better value over all \
         answers but no preference; t interval at 95 % over participants. p: exact sign-flip test over participants, adjusted \
         by Holm over the metrics. p over methods: the share of all orders of the methods (9,999 drawn ones and the true one, of more than \
         7) whose values agree with the answers as well as the true order, adjusted by Holm over the metrics. A pair is won by the side with more answers. Log-odds: \
         Davidson's model with the metric's difference for the worths, in units of the root mean square of the differences \
         (differences of ratios and angles, logarithms of quotients for the rest); standard error, t interval and p clustered \
         on participants. Left-out: each object predicted from a fit to the others; the constant knows the share of ties and \
         no more; the gain is the mean fall in log loss, p one-sided by a t test over participants, adjusted by Holm over the metrics. Pairs won and accuracy have no interval: \
         more people would fit better and win other pairs, and no interval tried covers what they would show. Intervals of shares are cut at 0 and 1."
            .into(),
    );
    table.notes.extend(region::sentence(study, "Metrics"));
    table
}

fn joint(prediction: &Prediction) -> Table {
    let coefficients = prediction.joint.as_deref().unwrap_or_default();
    let rows = prediction.metrics.iter().zip(coefficients);
    let mut table = Columns::over(rows)
        .column("metric", "Metric", |(of, _)| Cell::text(of.metric.label))
        .column("coefficient", "Log-odds a unit", |(_, c)| Cell::Number(c.estimate, 3))
        .column("se", "SE", |(_, c)| Cell::Number(c.se, 3))
        .column("low", "from", |(_, c)| Cell::Number(c.interval.low, 3))
        .column("high", "to", |(_, c)| Cell::Number(c.interval.high, 3))
        .column("p", "p", |(_, c)| Cell::P(c.p, 4))
        .into_table("prediction_joint", "All metrics in one model");
    if let Err(reason) = &prediction.joint {
        table.notes.push(format!("No estimate: {reason}."));
    }
    table.with_note(
        "Metrics that rise and fall together share their credit in ways that another study would share anew: a coefficient \
         here says little of its metric alone. Units and intervals as for single metrics.",
    )
}

fn objects(study: &Study, prediction: &Prediction) -> Table {
    let metrics = prediction.metrics.iter().map(|m| (m.metric.label, m.held_out.as_ref()));
    let others = [
        ("all metrics", prediction.joint_held_out.as_ref()),
        ("the side alone", prediction.side_held_out.as_ref()),
    ];
    let objects = study.file.objects.iter().enumerate().map(|(o, of)| (&*of.id, &*of.name, Some(o)));
    let foretold = |held_out: Option<&HeldOut>, object: Option<usize>| -> Option<(f64, f64)> {
        let found = held_out?;
        let Some(object) = object else { return Some((found.accuracy.hits, found.accuracy.of)) };
        found.objects.iter().find(|(o, ..)| *o == object).map(|&(_, hits, of)| (hits, of))
    };
    let table = Columns::over(metrics.chain(others))
        .column("predictor", "Predictor", |(name, _)| Cell::text(name))
        .columns_of(objects.chain([("all", "All objects", None)]), |all, (id, name, object)| {
            all.column(id, name, |(_, of)| Cell::number(foretold(*of, object).map(|(hits, _)| hits), 0))
                .column(format!("{id}_of"), "of", |(_, of)| {
                    foretold(*of, object).map_or(Cell::Missing, |(_, of)| Cell::count(of as u64))
                })
        })
        .into_table("prediction_objects", "Decided answers foretold on each object by a fit to the others");
    table.with_note(
        "Half of them is what guessing foretells. The side alone: whichever side the other objects' answers favoured, \
         whatever stood there. Missing: some fit has no estimate.",
    )
}

fn correlations(prediction: &Prediction) -> Table {
    let metrics = prediction.metrics.iter().enumerate();
    let table = Columns::over(prediction.metrics.iter().zip(&prediction.correlations))
        .column("metric", "Metric", |(found, _)| Cell::text(found.metric.label))
        .columns_of(metrics, |all, (i, found)| {
            all.column(found.metric.code, found.metric.label, |(_, row)| Cell::number(row[i], 2))
        })
        .into_table(
            "prediction_correlations",
            "How the metrics hang together: rank correlations of their differences across the pairs",
        );
    table.with_note(
        "Spearman's, each pair taken in both orders, so that what stood on the left does not matter; signed so that 1 means \
         that both metrics call the same side better.",
    )
}
