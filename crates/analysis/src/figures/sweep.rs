//! A sweep: time against samples, time per triangle, speed-up against threads, quality against cost.

use super::axis::Axis;
use super::legend::Swatch;
use super::marks::Mark;
use super::scatter::Scatter;
use super::{Draft, Figure, WIDTH, canvas_with_legend, style};
use crate::inputs::AnalysisError;
use crate::sweep::{Point, SpeedUp, Sweep};
use design::{Arrangement, Method, Study};

const ROW: f64 = 340.0;

/// The figures of a sweep; those with nothing to show are left out.
///
/// # Errors
/// If drawing fails, which is not to be expected.
pub fn sweep_figures(study: &Study, sweep: &Sweep) -> Result<Vec<Figure>, AnalysisError> {
    let objects = objects(sweep);
    if objects.is_empty() {
        return Ok(Vec::new());
    }
    let drafts = [
        time(study, sweep, &objects),
        per_triangle(study, sweep, &objects),
        speed_up(study, sweep, &objects),
        quality(study, sweep, &objects),
    ];
    drafts.into_iter().flatten().map(Draft::finish).collect()
}

fn objects(sweep: &Sweep) -> Vec<&str> {
    let mut objects: Vec<&str> = Vec::new();
    for point in &sweep.points {
        if !objects.contains(&point.id.object.as_str()) {
            objects.push(&point.id.object);
        }
    }
    objects
}

fn object_name<'a>(study: &'a Study, id: &'a str) -> &'a str {
    study.file.objects.iter().find(|object| object.id == id).map_or(id, |object| &object.name)
}

fn fewest(sweep: &Sweep) -> u32 {
    sweep.points.iter().map(|point| point.threads).min().unwrap_or(1)
}

/// Filled for body-centred, hollow for simple cubic; a shape each clustering.
fn mark(study: &Study, method: Method) -> Mark {
    let n = study.file.clusterings.iter().position(|c| *c == method.clustering).unwrap_or(0);
    Mark::nth(n, method.arrangement == Arrangement::BodyCentred)
}

fn legend(study: &Study) -> Vec<(Swatch, String)> {
    study.methods().into_iter().map(|m| (Swatch::Mark(mark(study, m)), m.label())).collect()
}

/// The points of one configuration on the fewest threads, by resolution.
fn line<'a>(sweep: &'a Sweep, object: &str, method: Method) -> Vec<&'a Point> {
    let threads = fewest(sweep);
    let own = |p: &&Point| p.id.object == object && p.id.method == method && p.threads == threads;
    sweep.points.iter().filter(own).collect()
}

/// What a panel shows of a point.
type Value = fn(&Point) -> Option<f64>;

struct Labels<'a> {
    heading: String,
    x: &'a str,
    y: &'a str,
}

/// A line with marks for each method of an object.
fn lines(
    study: &Study,
    sweep: &Sweep,
    object: &str,
    labels: Labels<'_>,
    [x, y]: [Value; 2],
    logarithmic_y: bool,
) -> Scatter {
    let (mut lines, mut marks) = (Vec::new(), Vec::new());
    for method in study.methods() {
        let points: Vec<(f64, f64)> =
            line(sweep, object, method).into_iter().filter_map(|p| Some((x(p)?, y(p)?))).collect();
        marks.extend(points.iter().map(|&at| (at, mark(study, method))));
        lines.push((style::method(method).outline, points));
    }
    let of = |pick: fn(&(f64, f64)) -> f64| lines.iter().flat_map(move |(_, line)| line.iter().map(pick));
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)))
    };
    let (xs, ys) = (ends(&mut of(|p| p.0)), ends(&mut of(|p| p.1)));
    Scatter {
        heading: labels.heading,
        labels: (labels.x.into(), labels.y.into()),
        x: Axis::decades(xs.0, xs.1),
        y: if logarithmic_y { Axis::decades(ys.0, ys.1) } else { Axis::spanning(ys.0, ys.1) },
        lines,
        dashed: None,
        marks,
        names: Vec::new(),
    }
}

/// Panels side by side, row by row.
fn draw(
    name: &'static str,
    caption: String,
    legend: &[(Swatch, String)],
    rows: &[Vec<Scatter>],
) -> Option<Draft> {
    let (mut canvas, top) = canvas_with_legend(legend, ROW * rows.len() as f64);
    for (row, panels) in (0_u32..).zip(rows) {
        let (width, y) = (WIDTH / panels.len() as f64, top + ROW * f64::from(row));
        for (column, panel) in (0_u32..).zip(panels) {
            let x = width * f64::from(column);
            panel.draw(&mut canvas, (x, y), (x + width, y + ROW));
        }
    }
    (!rows.is_empty()).then_some(Draft { name, caption, canvas })
}

fn threads(count: u32) -> String {
    if count == 1 { "1 thread".into() } else { format!("{count} threads") }
}

fn time(study: &Study, sweep: &Sweep, objects: &[&str]) -> Option<Draft> {
    let panel = |object: &&str| {
        let labels = Labels { heading: object_name(study, object).into(), x: "sample points", y: "time, ms" };
        let values: [Value; 2] = [|p| Some(p.samples as f64), |p| Some(1e3 * p.total_s.median)];
        lines(study, sweep, object, labels, values, true)
    };
    let caption = format!(
        "Median time of an extraction against the sample points of its lattice, on {}. Both axes are logarithmic.",
        threads(fewest(sweep))
    );
    draw("sweep_time", caption, &legend(study), &[objects.iter().map(panel).collect()])
}

fn per_triangle(study: &Study, sweep: &Sweep, objects: &[&str]) -> Option<Draft> {
    let panel = |object: &&str| {
        let heading = object_name(study, object).into();
        let labels = Labels { heading, x: "cells per axis", y: "time per triangle, \u{b5}s" };
        let each: Value = |p| (p.triangles > 0).then(|| 1e6 * p.total_s.median / p.triangles as f64);
        lines(study, sweep, object, labels, [|p| Some(f64::from(p.cells)), each], true)
    };
    let caption = format!(
        "Median time over the triangles that are left, on {}. A line that rises: the volume is what costs; one that stays: the \
         surface is. Both axes are logarithmic.",
        threads(fewest(sweep))
    );
    draw("sweep_per_triangle", caption, &legend(study), &[objects.iter().map(panel).collect()])
}

/// At the middle and at the finest resolution.
fn speed_up(study: &Study, sweep: &Sweep, objects: &[&str]) -> Option<Draft> {
    let mut cells: Vec<u32> = sweep.speed_ups.iter().map(|found| found.cells).collect();
    cells.sort_unstable();
    cells.dedup();
    let (last, base) = (*cells.last()?, fewest(sweep));
    let mut shown = vec![cells[cells.len() / 2], last];
    shown.dedup();
    let most = sweep.speed_ups.iter().map(|found| found.threads).max()?;
    let highest =
        sweep.speed_ups.iter().map(|found| found.ratio).fold(f64::from(most) / f64::from(base), f64::max);
    let panel = |object: &str, cells: u32| {
        let ideal = vec![(f64::from(base), 1.0), (f64::from(most), f64::from(most) / f64::from(base))];
        let (mut lines, mut marks) = (vec![(style::GRID, ideal)], Vec::new());
        for method in study.methods() {
            let own = |f: &&SpeedUp| f.cells == cells && f.id.object == object && f.id.method == method;
            let found = sweep.speed_ups.iter().filter(own).map(|f| (f64::from(f.threads), f.ratio));
            let points: Vec<(f64, f64)> = std::iter::once((f64::from(base), 1.0)).chain(found).collect();
            marks.extend(points[1..].iter().map(|&at| (at, mark(study, method))));
            lines.push((style::method(method).outline, points));
        }
        Scatter {
            heading: format!("{}, {cells} cells per axis", object_name(study, object)),
            labels: ("threads".into(), format!("speed-up over {}", threads(base))),
            x: Axis::whole(base, most),
            y: Axis::from_zero(highest),
            lines,
            dashed: Some(1.0),
            marks,
            names: Vec::new(),
        }
    };
    let rows: Vec<Vec<Scatter>> =
        shown.iter().map(|&cells| objects.iter().map(|object| panel(object, cells)).collect()).collect();
    let mut legend = legend(study);
    legend.push((Swatch::Dashes, "no faster".into()));
    let caption = "What more threads are worth: time on the fewest over time on so many. The pale line is a speed-up in \
                   proportion to the threads."
        .to_owned();
    draw("sweep_speed_up", caption, &legend, &rows)
}

fn quality(study: &Study, sweep: &Sweep, objects: &[&str]) -> Option<Draft> {
    let q: Value = |p| p.radius_ratio;
    let rows = objects.iter().map(|object| {
        let panel = |x: &'static str, value: Value| {
            let labels = Labels { heading: object_name(study, object).into(), x, y: "mean radius ratio" };
            lines(study, sweep, object, labels, [value, q], false)
        };
        vec![
            panel("triangles", |p| Some(p.triangles as f64)),
            panel("time, ms", |p| Some(1e3 * p.total_s.median)),
        ]
    });
    let rows: Vec<Vec<Scatter>> = rows.collect();
    let caption = format!(
        "Regularity of the triangles (1: all equilateral) against their number and against the median time on {}, a mark for each \
         resolution. Higher and further to the left is better.",
        threads(fewest(sweep))
    );
    draw("sweep_quality", caption, &legend(study), &rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    #[test]
    fn every_figure_is_drawn_within_its_frame() {
        let (study, sweep) = (fixture::study(), crate::sweep::tests::made_up());
        let objects = objects(&sweep);
        let drafts = [
            time(&study, &sweep, &objects),
            per_triangle(&study, &sweep, &objects),
            speed_up(&study, &sweep, &objects),
            quality(&study, &sweep, &objects),
        ];
        for draft in drafts {
            let draft = draft.expect("there is something to show");
            assert_eq!(draft.canvas.texts_outside(), Vec::<String>::new(), "{}", draft.name);
        }
        assert_eq!(sweep_figures(&study, &sweep).unwrap().len(), 4);
        let nothing = Sweep { points: Vec::new(), ..sweep };
        assert!(sweep_figures(&study, &nothing).unwrap().is_empty());
    }
}
