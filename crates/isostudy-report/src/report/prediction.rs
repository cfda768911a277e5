//! What predicts preference, what 27 pairs can show of it, and what they cannot.

use crate::statement::{Block, Finding, Standing};
use crate::words::{capital, counted, interval, list, number, p, percent, percents, whole};
use isostudy_design::Study;
use isostudy_design::forms::Questionnaire;
use isostudy_inference::hypotheses::Rules;
use isostudy_inference::prediction::{MetricPrediction, Prediction};

pub(super) fn findings(study: &Study, prediction: Option<&Prediction>) -> Vec<Block> {
    let Some(prediction) = prediction else { return Vec::new() };
    let level = Rules::of(&study.file.analysis).level;
    let mut found: Vec<Finding> =
        prediction.metrics.iter().map(|m| metric(m, prediction.metrics.len(), level)).collect();
    found.extend(held_out(study, prediction, level));
    found.extend(together(prediction));
    found.push(limits(study, prediction));
    found.into_iter().map(Block::Finding).collect()
}

fn metric(found: &MetricPrediction, family: usize, level: f64) -> Finding {
    let (name, better) = (found.metric.label, &found.better);
    let Some(share) = better.share else {
        let text = format!("{}: nobody decided between a better and a worse value.", capital(name));
        return Finding::new(Standing::TooFew, text);
    };
    let flip = p(better.test.sign_flip.p());
    let correction = if family > 1 {
        format!(", {} after Holm's correction for {family} metrics", p(found.adjusted))
    } else {
        String::new()
    };
    let people = share.interval.map_or(String::new(), |i| {
        format!(", 95 % t interval {}, {}", percents(i), counted(better.test.participants(), "participant"))
    });
    let toward = better.test.mean >= 0.0;
    let is_of_people = found.adjusted <= level;
    let (standing, verdict) = match (found.holds(level), toward) {
        (true, true) => (Standing::Holds, "goes with preference"),
        (true, false) => (Standing::Holds, "goes against preference"),
        (false, true) if is_of_people => (
            Standing::Open,
            "goes with these people's choices, which is not shown to be more than chance among these methods",
        ),
        (false, false) if is_of_people => (
            Standing::Open,
            "goes against these people's choices, which is not shown to be more than chance among these methods",
        ),
        (false, _) => (Standing::Open, "is not shown to go with preference"),
    };
    let relabelled = relabelled(found, family);
    let pairs = better.pairs;
    let drawn = if pairs.drawn > 0 { format!(" ({} drawn)", pairs.drawn) } else { String::new() };
    let odds = found.coefficient.as_ref().map_or_else(
        |reason| format!("A model of choice on it has no estimate: {reason}."),
        |c| {
            format!(
                "One typical difference multiplies the odds of being chosen by {} ({}; Davidson's model, t, {}).",
                number(c.estimate.exp(), 2),
                interval(isostudy_statistics::interval::Interval { low: c.interval.low.exp(), high: c.interval.high.exp() }, 2),
                p(c.p)
            )
        },
    );
    let text = format!(
        "{} {verdict} ({} taken as better): the better value was chosen in {} of {} decided answers ({}{people}; exact sign-flip \
         test, {flip}{correction}), and won {} of {} decided pairs{drawn}.{relabelled} {odds}",
        capital(name),
        found.metric.better,
        number(share.hits, 0),
        number(share.of, 0),
        percent(share.share),
        pairs.better,
        pairs.better + pairs.worse
    );
    Finding::new(standing, text)
}

/// What exchanging the methods' values says.
fn relabelled(found: &MetricPrediction, family: usize) -> String {
    let Some(of) = found.relabelled else {
        return " With two methods nobody can tell whether another metric would do as well.".into();
    };
    let correction =
        if family > 1 { format!(", {} after Holm's correction", p(of.adjusted)) } else { String::new() };
    let orders = if of.is_exact { "all" } else { "the drawn" };
    format!(
        " Of {orders} {} ways to give the metric's values to the methods, {} % fit the answers as well as the true one \
         ({}{correction}).",
        whole(of.orders as u64),
        number(100.0 * of.p, 1),
        p(of.p)
    )
}

/// How well each object is foretold from the others, against the constant and against the side.
fn held_out(study: &Study, prediction: &Prediction, level: f64) -> Vec<Finding> {
    let mut found = Vec::new();
    let names: Vec<&str> = study.file.objects.iter().map(|o| o.name.as_str()).collect();
    let judged: Vec<_> = prediction.metrics.iter().filter_map(|m| Some((m, m.held_out.as_ref()?))).collect();
    let best = judged.iter().min_by(|a, b| a.1.log_loss.total_cmp(&b.1.log_loss));
    let Some((metric, best)) = best else { return found };
    let objects: Vec<String> = best
        .objects
        .iter()
        .map(|(o, hits, of)| {
            format!("{} of {of} on the {}", number(*hits, 1).trim_end_matches(".0"), names[*o])
        })
        .collect();
    let gain = metric.gain_adjusted.map_or(String::new(), |gain| {
        format!(" (one-sided t test over participants, {} after Holm's correction for the metrics)", p(gain))
    });
    let better = metric.foretells(level);
    let text = format!(
        "Fitted to the other objects, {} foretells an object's answers {}: {} of the decided ones right, {}; mean log loss {} \
         against {} of a constant{gain}.",
        metric.metric.label,
        if better {
            "best, and better than guessing"
        } else {
            "best, but not demonstrably better than guessing"
        },
        percent(best.accuracy.share),
        list(&objects),
        number(best.log_loss, 3),
        number(best.constant_log_loss, 3)
    );
    found.push(Finding::new(if better { Standing::Holds } else { Standing::Open }, text));
    let failing: Vec<&str> =
        judged.iter().filter(|(m, _)| !m.foretells(level)).map(|(m, _)| m.metric.label).collect();
    if !failing.is_empty() {
        let text = format!(
            "Not shown to foretell objects left out better than guessing does, among other methods too: {}.",
            list(&failing)
        );
        found.push(Finding::new(Standing::Open, text));
    }
    if let Some(joint) = &prediction.joint_held_out {
        let comparison = if joint.log_loss < best.log_loss { "better" } else { "no better" };
        let text = format!(
            "All {} together foretell left-out objects {comparison} than the best of them alone: log loss {}, {} right.",
            counted(prediction.metrics.len(), "metric"),
            number(joint.log_loss, 3),
            percent(joint.accuracy.share)
        );
        found.push(Finding::new(Standing::Noted, text));
    }
    let text = match &prediction.side_held_out {
        Some(side) => format!(
            "The side alone, whatever stood there, foretells {} of {} ({}), with log loss {}: a metric has to be read against \
             that as well.",
            number(side.accuracy.hits, 0),
            number(side.accuracy.of, 0),
            percent(side.accuracy.share),
            number(side.log_loss, 3)
        ),
        None => "What the side alone foretells has no estimate. Without some object, every decided answer chose the same side, \
                 or no answer was decided."
            .into(),
    };
    found.push(Finding::new(Standing::Noted, text));
    found
}

/// Which metrics cannot be told apart.
fn together(prediction: &Prediction) -> Option<Finding> {
    let n = prediction.metrics.len();
    let of = |i: usize, j: usize| prediction.correlations[i][j].map(|r| (r, i, j));
    let pairs: Vec<(f64, usize, usize)> =
        (0..n).flat_map(|i| (i + 1..n).filter_map(move |j| of(i, j))).collect();
    let size = |a: &&(f64, usize, usize), b: &&(f64, usize, usize)| a.0.abs().total_cmp(&b.0.abs());
    let (most, least) = (pairs.iter().max_by(size)?, pairs.iter().min_by(size)?);
    let label = |i: usize| prediction.metrics[i].metric.label;
    let strong = pairs.iter().filter(|(r, ..)| r.abs() >= 0.7).count();
    let verdict = match strong {
        0 => "The metrics can be distinguished to some degree",
        _ => "Which of the metrics people react to cannot be told, since they rise and fall together",
    };
    let range = match pairs.len() {
        1 => format!(
            "the rank correlation of {} and {} is {}",
            label(most.1),
            label(most.2),
            number(most.0, 2)
        ),
        all => format!(
            "rank correlations across the pairs reach from {} ({} and {}) to {} ({} and {}), and {strong} of {all} are 0.7 \
             or more in size",
            number(least.0, 2),
            label(least.1),
            label(least.2),
            number(most.0, 2),
            label(most.1),
            label(most.2)
        ),
    };
    let standing = if strong > 0 { Standing::NotAnswerable } else { Standing::Noted };
    Some(Finding::new(standing, format!("{verdict}: {range}.")))
}

fn limits(study: &Study, prediction: &Prediction) -> Finding {
    let sides: Vec<String> = prediction
        .metrics
        .iter()
        .enumerate()
        .map(|(i, m)| {
            let answers = if i == 0 { " answers" } else { "" };
            format!("{} of {}{answers} for {}", m.better_right, m.showings, m.metric.label)
        })
        .collect();
    let text = format!(
        "{} of {} from {} are no large sample: only {} of their differences do not follow from the others, and {}. Intervals and sign-flip tests are about other people before these pairs. The test over methods is about other methods on these objects. No number here is about other objects. The better value stood \
         on the right in {}, so a leaning to one side would {}look like a metric.",
        capital(&counted(prediction.pairs, "pair")),
        counted(prediction.meshes, "mesh").replace("meshs", "meshes"),
        counted(prediction.objects, "object"),
        prediction.independent,
        match Questionnaire::of(study).is_some_and(|of| of.blocks() > 1) {
            true => "each person saw only a part of them",
            false => "every person saw the same ones",
        },
        list(&sides),
        if prediction.metrics.iter().all(|of| 2 * of.better_right == of.showings) { "not " } else { "" }
    );
    Finding::new(Standing::NotAnswerable, text)
}
