//! Pareto fronts: a row an object, a panel two quantities; who is beaten in both lies behind the line.

use super::OVERVIEW;
use super::axis::Axis;
use super::canvas::{BLACK, Colour};
use super::draft::{Unfinished, canvas_with_legend};
use super::legend::Swatch;
use super::marks::Mark;
use super::scatter::Scatter;
use super::sheet::Sheet;
use super::style;
use crate::region;
use isostudy_design::{Method, MethodId, Study};
use isostudy_inference::decision::{Axes, Front, FrontPoint, LEAST_ERROR, ObjectCandidates, Standing};
use isostudy_inference::results::Decision;

const ROW: f64 = 330.0;
/// An axis that reaches farther than so many times is logarithmic.
const DECADE: f64 = 10.0;

/// Nothing where no object has two methods to choose from.
pub(super) fn draft(study: &Study, decision: &Decision<'_>, sheet: Sheet) -> Option<Unfinished> {
    let rows: Vec<(&str, &[Front])> =
        decision.each().map(|(of, fronts)| (of.object.name.as_str(), fronts)).collect();
    let shown: Vec<Axes> = Axes::ALL
        .into_iter()
        .filter(|axes| rows.iter().any(|(_, fronts)| fronts.iter().any(|front| front.axes == *axes)))
        .collect();
    if shown.is_empty() {
        return None;
    }
    let columns = sheet.columns(shown.len());
    let lines = shown.len() / columns;
    let height = ROW * (rows.len() * lines) as f64;
    let (mut canvas, top) = canvas_with_legend(sheet, &legend(study, &decision.objects), height);
    let width = sheet.width() / columns as f64;
    for (r, (object, fronts)) in rows.iter().enumerate() {
        for (place, axes) in shown.iter().enumerate() {
            let Some(front) = fronts.iter().find(|front| front.axes == *axes) else { continue };
            let x = width * (place % columns) as f64;
            let y = top + ROW * (r * lines + place / columns) as f64;
            panel(study, object, front).draw(&mut canvas, (x, y), (x + width, y + ROW));
        }
    }
    let mut caption: String = "Each method on each object, two quantities at a time; better is to the left, and down for error, up for preference. The line \
                   joins the methods that no other method beats in both quantities. Codes stand beside the marks, as far as there is room. Thin lines are \
                   intervals at 95 %. The table of fronts has every value, and says which method beats which."
        .into();
    if decision.objects.iter().any(ObjectCandidates::has_least_error) {
        caption.push_str(&format!(" A mean error below {LEAST_ERROR} is drawn there."));
    }
    let caption = region::said(caption, study, "Errors and triangles");
    Some(Unfinished { name: "fronts", caption, canvas })
}

/// The fronts of the object on which methods differ most: without a legend, since their codes stand beside the marks. On a narrow
/// sheet the first front alone. Times that decide nothing are not shown. `object` is its place among the study's.
pub(super) fn overview(
    study: &Study,
    decision: &Decision<'_>,
    object: usize,
    times_decide: bool,
    sheet: Sheet,
) -> Option<Unfinished> {
    let id = &study.file.objects.get(object)?.id;
    let (of, fronts) = decision.each().find(|(of, _)| of.object.id == *id)?;
    let fronts = fronts.iter().filter(|front| times_decide || front.axes == Axes::TrianglesError);
    let shown: Vec<&Front> = fronts.take(if sheet.is_narrow() { 1 } else { Axes::ALL.len() }).collect();
    if shown.is_empty() {
        return None;
    }
    let width = sheet.width() / shown.len() as f64;
    let (mut canvas, top) = canvas_with_legend(sheet, &[], ROW);
    for (column, front) in shown.iter().enumerate() {
        let x = width * column as f64;
        panel(study, &of.object.name, front).draw(&mut canvas, (x, top), (x + width, top + ROW));
    }
    let mut caption = format!(
        "The methods on one object, the {}. Better is to the left, and down for error. The line joins the methods that no other \
         method beats in both quantities. Thin lines are intervals at 95 %.",
        of.object.name
    );
    caption = region::said(caption, study, "Errors and triangles");
    if decision.each().filter(|(_, fronts)| !fronts.is_empty()).count() > 1 {
        caption.push_str(" The figure of fronts has every object.");
    }
    Some(Unfinished { name: OVERVIEW, caption, canvas })
}

/// In its colour too, since marks lie close together.
fn mark(study: &Study, method: MethodId) -> Mark {
    style::mark(study, method).coloured(style::method(study, method).outline)
}

fn legend(study: &Study, objects: &[ObjectCandidates<'_>]) -> Vec<(Swatch, String)> {
    let is_shown =
        |method: &&Method| objects.iter().flat_map(|of| &of.candidates).any(|of| of.id() == method.id);
    let entry =
        |method: &Method| (Swatch::Mark(mark(study, method.id)), format!("{}: {}", method.id, method.label));
    study.methods.iter().filter(is_shown).map(entry).collect()
}

fn panel(study: &Study, object: &str, front: &Front) -> Scatter {
    let unit = if front.axes == Axes::TrianglesError { 1.0 } else { 1e3 };
    let at = |point: &FrontPoint| (unit * point.at[0].value, point.at[1].value);
    let ends = |of: usize, unit: f64| {
        // A worth that nothing bounds has no ends, and is drawn all the same.
        let of_point = |point: &FrontPoint| [point.at[of].value, point.at[of].low, point.at[of].high];
        let values = front.points.iter().flat_map(of_point);
        let values = values.filter(|value| value.is_finite()).map(|value| unit * value);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    };
    let ((x_low, x_high), (y_low, y_high)) = (ends(0, unit), ends(1, 1.0));
    let x = match front.axes {
        // Where one method has many more triangles than the rest, they would stand on each other.
        Axes::TrianglesError if x_high > DECADE * x_low => Axis::decades(x_low, x_high),
        Axes::TrianglesError => Axis::spanning(0.95 * x_low, 1.02 * x_high),
        _ => Axis::decades(x_low, x_high),
    };
    let y = match front.axes {
        Axes::TimePreference => Axis::within(y_low - 0.1, y_high + 0.1),
        _ => Axis::decades(y_low, y_high),
    };
    // Intervals, under the marks; the axis cuts those without an end.
    let intervals = front.points.iter().flat_map(|point| {
        let (colour, (x, y)) = (style::method(study, point.method).outline, at(point));
        let [wide, high] = point.at;
        [
            (colour, vec![(unit * wide.low, y), (unit * wide.high, y)]),
            (colour, vec![(x, high.low), (x, high.high)]),
        ]
    });
    let mut lines: Vec<(Colour, Vec<(f64, f64)>)> =
        intervals.filter(|(_, ends)| ends[0] != ends[1]).collect();
    let mut line: Vec<&FrontPoint> =
        front.points.iter().filter(|point| point.standing == Standing::OnFront).collect();
    line.sort_by(|a, b| {
        a.at[0].value.total_cmp(&b.at[0].value).then(a.at[1].value.total_cmp(&b.at[1].value))
    });
    let [x_label, y_label] = match front.axes {
        Axes::TimeError => ["ms from field to mesh", "mean error, cube edges"],
        Axes::TrianglesError => ["triangles", "mean error, cube edges"],
        Axes::TimePreference => ["ms from field to mesh", "worth"],
    };
    // A step: between two methods nothing was measured.
    let mut steps = Vec::new();
    for point in &line {
        let (x, y) = at(point);
        steps.extend(steps.last().map(|&(_, before)| (x, before)));
        steps.push((x, y));
    }
    lines.push((BLACK, steps));
    Scatter {
        heading: format!("{object}: {}", front.axes.label()),
        labels: (x_label.into(), y_label.into()),
        x,
        y,
        lines,
        dashed: None,
        marks: front.points.iter().map(|point| (at(point), mark(study, point.method))).collect(),
        // Those on the line first: where there is not room for all, theirs are read.
        names: line
            .iter()
            .copied()
            .chain(front.points.iter().filter(|point| point.standing != Standing::OnFront))
            .map(|point| (at(point), point.method.to_string()))
            .collect(),
    }
}
