//! Metric against preference: a panel a metric, a mark a pair.

use super::axis::Axis;
use super::canvas::BLACK;
use super::draft::{Unfinished, canvas_with_legend};
use super::legend::Swatch;
use super::marks::Mark;
use super::scatter::Scatter;
use super::sheet::Sheet;
use super::style::object_colour;
use isostudy_design::{Comparison, Study};
use isostudy_inference::prediction::{MetricPrediction, Prediction, Scale};
use isostudy_inference::preference;
use isostudy_statistics::{DeclaredBallot, outcome_counts};

const ROW: f64 = 320.0;
const PER_ROW: usize = 3;

pub(super) fn draft(
    study: &Study,
    prediction: &Prediction,
    declared: &[DeclaredBallot],
    sheet: Sheet,
) -> Unfinished {
    let counts = outcome_counts(declared);
    let mut legend: Vec<(Swatch, String)> = Vec::new();
    for (o, object) in study.file.objects.iter().enumerate() {
        legend.push((Swatch::Mark(Mark::nth(o, true).coloured(object_colour(o))), object.name.clone()));
    }
    // Only of two factors does one of them say something that the other does not.
    if let Some([outer, _]) = preference::two_factors(study)
        && study.comparisons.iter().any(|c| differs(study, c))
    {
        let text = format!("hollow: different {}", study.factor(outer).plural);
        legend.push((Swatch::Mark(Mark::nth(0, false)), text));
    }
    legend.push((Swatch::Line(BLACK), "Davidson's model".into()));
    legend.push((Swatch::Dashes, "as many for either".into()));
    let rows: Vec<&[MetricPrediction]> = prediction.metrics.chunks(sheet.columns(PER_ROW)).collect();
    let (mut canvas, top) = canvas_with_legend(sheet, &legend, ROW * rows.len() as f64);
    for (r, row) in rows.iter().enumerate() {
        let (width, y) = (sheet.width() / sheet.columns(PER_ROW) as f64, top + ROW * r as f64);
        for (i, found) in row.iter().enumerate() {
            let x = width * i as f64;
            panel(study, found, &counts).draw(&mut canvas, (x, y), (x + width, y + ROW));
        }
    }
    let caption = "Each pair shown: by how much the better value is better, against the share of decided answers for it. Marks \
                   above the dashed line: the better value won. The line is the share that Davidson's model on this metric \
                   alone expects. Pairs without a decided answer or a difference are left out. Marks are moved up or down by at most \
                   0.015, so that no two lie on each other."
        .into();
    Unfinished { name: "prediction", caption, canvas }
}

/// By how much a mark is moved, by the number of its question: spread evenly by the golden section, and the same each time.
fn jitter(question: usize) -> f64 {
    const MOST: f64 = 0.015;
    let place = (question as f64 * 0.618_033_988_75).fract();
    MOST * (2.0 * place - 1.0)
}

/// Whether a question's methods differ in the first of two factors.
fn differs(study: &Study, comparison: &Comparison) -> bool {
    let level = |method, factor| study.level_of(method, factor);
    let (left, right) = (comparison.left.method, comparison.right.method);
    preference::two_factors(study).is_some_and(|[outer, _]| level(left, outer) != level(right, outer))
}

fn panel(study: &Study, found: &MetricPrediction, counts: &[[u64; 3]]) -> Scatter {
    let of_scale = |advantage: f64| match found.metric.scale {
        Scale::Difference => advantage,
        Scale::LogRatio => advantage.exp(),
    };
    let mut marks = Vec::new();
    let mut most: f64 = 0.0;
    for (question, advantage) in found.advantages.iter().enumerate() {
        let (Some(advantage), comparison) = (advantage, &study.comparisons[question]) else { continue };
        let [left, _, right] = counts.get(question).copied().unwrap_or_default();
        let better = if *advantage > 0.0 { left } else { right };
        if left + right == 0 || *advantage == 0.0 {
            continue;
        }
        most = most.max(advantage.abs());
        let same = !differs(study, comparison);
        let at = (of_scale(advantage.abs()), better as f64 / (left + right) as f64);
        let at = (at.0, at.1 + jitter(question));
        marks.push((at, Mark::nth(comparison.object, same).coloured(object_colour(comparison.object))));
    }
    let x = match found.metric.scale {
        Scale::Difference => Axis::from_zero(most),
        Scale::LogRatio => Axis::logarithmic(most.exp()),
    };
    let label = match found.metric.scale {
        Scale::Difference => "difference",
        Scale::LogRatio => "ratio",
    };
    let lines = found.coefficient.iter().map(|c| {
        let share = |advantage: f64| 1.0 / (1.0 + (-c.estimate * advantage / found.unit).exp());
        (BLACK, (0..=40).map(|i| most * f64::from(i) / 40.0).map(|a| (of_scale(a), share(a))).collect())
    });
    Scatter {
        heading: found.metric.label.into(),
        labels: (format!("{label}; {} is better", found.metric.better), "share for the better".into()),
        y: Axis::around_shares(),
        lines: lines.collect(),
        dashed: Some(0.5),
        marks,
        names: Vec::new(),
        x,
    }
}
