//! A sweep: time against samples, time per triangle, speed-up against threads, quality against cost.

use super::axis::Axis;
use super::draft::{Unfinished, canvas_with_legend};
use super::error::FigureError;
use super::legend::Swatch;
use super::scatter::Scatter;
use super::sheet::Sheet;
use super::style;
use crate::figure::Figure;
use isostudy_design::{MethodId, Study};
use isostudy_timing::sweep::{Point, SpeedUp, Sweep};

const ROW: f64 = 340.0;
/// From one mark to the next at the same number of threads, in widths of the axis.
const ASIDE: f64 = 0.025;

/// The figures of a sweep; those with nothing to show are left out.
///
/// # Errors
/// If drawing fails, which is not to be expected.
pub fn sweep_figures(study: &Study, sweep: &Sweep) -> Result<Vec<Figure>, FigureError> {
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
    drafts.into_iter().flatten().map(Unfinished::finish).collect()
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

fn legend(study: &Study) -> Vec<(Swatch, String)> {
    study.methods.iter().map(|m| (Swatch::Mark(style::mark(study, m.id)), m.label.clone())).collect()
}

/// The points of one configuration on the fewest threads, by resolution.
fn line<'a>(sweep: &'a Sweep, object: &str, method: MethodId) -> Vec<&'a Point> {
    let threads = fewest(sweep);
    let own = |p: &&Point| p.id.object == object && p.id.method == method && p.threads == threads;
    sweep.points.iter().filter(own).collect()
}

/// What a panel shows of a point.
type Value = fn(&Point) -> Option<f64>;

struct Labels {
    heading: String,
    x: String,
    y: String,
}

/// A line with marks for each method of an object.
fn lines(
    study: &Study,
    sweep: &Sweep,
    object: &str,
    labels: Labels,
    [x, y]: [Value; 2],
    logarithmic_y: bool,
) -> Scatter {
    let (mut lines, mut marks) = (Vec::new(), Vec::new());
    for method in study.method_ids() {
        let points: Vec<(f64, f64)> =
            line(sweep, object, method).into_iter().filter_map(|p| Some((x(p)?, y(p)?))).collect();
        marks.extend(points.iter().map(|&at| (at, style::mark(study, method))));
        lines.push((style::method(study, method).outline, points));
    }
    let of = |pick: fn(&(f64, f64)) -> f64| lines.iter().flat_map(move |(_, line)| line.iter().map(pick));
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)))
    };
    let (xs, ys) = (ends(&mut of(|p| p.0)), ends(&mut of(|p| p.1)));
    Scatter {
        heading: labels.heading,
        labels: (labels.x, labels.y),
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
) -> Option<Unfinished> {
    let (mut canvas, top) = canvas_with_legend(Sheet::Wide, legend, ROW * rows.len() as f64);
    for (row, panels) in (0_u32..).zip(rows) {
        let (width, y) = (Sheet::Wide.width() / panels.len() as f64, top + ROW * f64::from(row));
        for (column, panel) in (0_u32..).zip(panels) {
            let x = width * f64::from(column);
            panel.draw(&mut canvas, (x, y), (x + width, y + ROW));
        }
    }
    (!rows.is_empty()).then_some(Unfinished { name, caption, canvas })
}

fn threads(count: u32) -> String {
    if count == 1 { "1 thread".into() } else { format!("{count} threads") }
}

fn time(study: &Study, sweep: &Sweep, objects: &[&str]) -> Option<Unfinished> {
    let panel = |object: &&str| {
        let labels = Labels {
            heading: object_name(study, object).into(),
            x: "sample points".into(),
            y: format!("time on {}, ms", threads(fewest(sweep))),
        };
        let values: [Value; 2] = [|p| Some(p.samples as f64), |p| Some(1e3 * p.total_s.median)];
        lines(study, sweep, object, labels, values, true)
    };
    let caption = format!(
        "Median time of an extraction against the sample points of its lattice, on {}. Both axes are logarithmic.",
        threads(fewest(sweep))
    );
    draw("sweep_time", caption, &legend(study), &[objects.iter().map(panel).collect()])
}

fn per_triangle(study: &Study, sweep: &Sweep, objects: &[&str]) -> Option<Unfinished> {
    let panel = |object: &&str| {
        let labels = Labels {
            heading: object_name(study, object).into(),
            x: "cells per axis".into(),
            y: format!("time per triangle on {}, \u{b5}s", threads(fewest(sweep))),
        };
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
fn speed_up(study: &Study, sweep: &Sweep, objects: &[&str]) -> Option<Unfinished> {
    let mut cells: Vec<u32> = sweep.speed_ups.iter().map(|found| found.cells).collect();
    cells.sort_unstable();
    cells.dedup();
    let (last, base) = (*cells.last()?, fewest(sweep));
    let mut shown = vec![cells[cells.len() / 2], last];
    shown.dedup();
    let most = sweep.speed_ups.iter().map(|found| found.threads).max()?;
    let ends = |found: &SpeedUp| found.interval.map_or(found.ratio, |interval| interval.high);
    let shown_ups = sweep.speed_ups.iter().filter(|found| shown.contains(&found.cells));
    let highest = shown_ups.map(ends).fold(f64::from(most) / f64::from(base), f64::max);
    let panel = |object: &str, cells: u32| {
        let ideal = vec![(f64::from(base), 1.0), (f64::from(most), f64::from(most) / f64::from(base))];
        let (mut lines, mut marks) = (vec![(style::IDEAL, ideal)], Vec::new());
        let methods = study.method_ids();
        for (n, &method) in methods.iter().enumerate() {
            // Side by side, so that one interval does not hide another.
            let aside = (n as f64 - (methods.len() - 1) as f64 / 2.0) * ASIDE * f64::from(most - base);
            let own = |f: &&SpeedUp| f.cells == cells && f.id.object == object && f.id.method == method;
            let colour = style::method(study, method).outline;
            let mut points = vec![(f64::from(base), 1.0)];
            for found in sweep.speed_ups.iter().filter(own) {
                let x = f64::from(found.threads) + aside;
                points.push((x, found.ratio));
                lines.extend(found.interval.map(|i| (colour, vec![(x, i.low), (x, i.high)])));
            }
            marks.extend(points[1..].iter().map(|&at| (at, style::mark(study, method))));
            lines.push((colour, points));
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
    legend.push((Swatch::Line(style::IDEAL), "in proportion to the threads".into()));
    let caption = "What more threads are worth: time on the fewest over time on so many, medians. Upright lines: intervals that \
                   hold at 95 % for all configurations of a resolution together. Marks stand side by side."
        .to_owned();
    draw("sweep_speed_up", caption, &legend, &rows)
}

fn quality(study: &Study, sweep: &Sweep, objects: &[&str]) -> Option<Unfinished> {
    let q: Value = |p| p.radius_ratio;
    let rows = objects.iter().map(|object| {
        let panel = |x: String, value: Value| {
            let labels =
                Labels { heading: object_name(study, object).into(), x, y: "mean radius ratio".into() };
            lines(study, sweep, object, labels, [value, q], false)
        };
        vec![
            panel("triangles".into(), |p| Some(p.triangles as f64)),
            panel(format!("time on {}, ms", threads(fewest(sweep))), |p| Some(1e3 * p.total_s.median)),
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

    /// The paper's study with other methods: so many of the first factor's levels times so many of the second's, or one by one.
    fn with_methods(levels: Option<[usize; 2]>, count: usize) -> Study {
        let mut study = fixture::study();
        let spec = |count: usize| isostudy_design::FactorSpec {
            levels: vec![study.factors[0].levels[0].clone(); count],
            ..study.factors[0].clone()
        };
        let mut factors: Vec<isostudy_design::FactorSpec> = levels.into_iter().flatten().map(spec).collect();
        factors.push(spec(count));
        let method = |i: usize| isostudy_design::Method {
            id: format!("m{i}").parse().unwrap(),
            label: format!("method {i}"),
            levels: levels.map_or(Vec::new(), |[_, inner]| vec![Some(i / inner), Some(i % inner)]),
            ..study.methods[0].clone()
        };
        let methods = (0..count).map(method).collect();
        (study.factors, study.methods) = (factors, methods);
        study
    }

    /// In the legend and in the plot, and in bars.
    #[test]
    fn no_two_methods_look_the_same() {
        let crossed = |outer, inner| with_methods(Some([outer, inner]), outer * inner);
        // Five of the first factor have no filling each, so that the methods are told apart one by one.
        for study in [fixture::study(), crossed(4, 6), crossed(5, 4), crossed(2, 9), with_methods(None, 24)] {
            let mut looks = std::collections::BTreeMap::new();
            for method in &study.methods {
                let mut canvas = super::super::canvas::Canvas::on(Sheet::Wide, 20.0);
                style::mark(&study, method.id).draw(&mut canvas, (10.0, 10.0));
                let marked = canvas.to_svg("mark").unwrap();
                let mut canvas = super::super::canvas::Canvas::on(Sheet::Wide, 20.0);
                style::method(&study, method.id).paint(&mut canvas, (5.0, 5.0), (35.0, 15.0));
                for look in [marked, canvas.to_svg("bar").unwrap()] {
                    if let Some(other) = looks.insert(look, method.id) {
                        panic!("{other} and {} look the same", method.id);
                    }
                }
            }
            assert_eq!(looks.len(), 2 * study.methods.len());
        }
    }

    fn made_up() -> Sweep {
        let (levels, meshes) = fixture::sweep_levels(&fixture::study());
        let level = |(cells, threads, run)| isostudy_timing::sweep::SweepLevel { cells, threads, run };
        isostudy_timing::sweep::sweep("test", &levels.into_iter().map(level).collect::<Vec<_>>(), &meshes)
    }

    #[test]
    fn every_figure_is_drawn_within_its_frame() {
        let (study, sweep) = (fixture::study(), made_up());
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
