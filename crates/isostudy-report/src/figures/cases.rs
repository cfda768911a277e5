//! The cases of a sweep: distance, triangles and time against the resolution.

use super::axis::Axis;
use super::draft::{Unfinished, canvas_with_legend};
use super::error::FigureError;
use super::legend::Swatch;
use super::scatter::Scatter;
use super::sheet::Sheet;
use super::style;
use crate::figure::Figure;
use isostudy_design::{MethodId, Study};
use isostudy_inference::cases::{CaseQuantity, SweepFound, SweepLine};

const ROW: f64 = 340.0;

/// A figure: what it shows, in words, and its unit where it has one.
#[derive(Clone, Copy)]
struct Drawn {
    name: &'static str,
    quantity: CaseQuantity,
    measure: &'static str,
    unit: &'static str,
}

const DRAWN: [Drawn; 3] = [
    Drawn {
        name: "sweep_distance",
        quantity: CaseQuantity::Distance,
        measure: "mean distance to the isosurface",
        unit: "",
    },
    Drawn { name: "sweep_triangles", quantity: CaseQuantity::Triangles, measure: "triangles", unit: "" },
    Drawn { name: "sweep_seconds", quantity: CaseQuantity::Seconds, measure: "median time", unit: ", s" },
];

/// The figures of a sweep's cases; those with nothing to show are left out.
///
/// # Errors
/// If drawing fails, which is not to be expected.
pub fn case_figures(study: &Study, found: &SweepFound) -> Result<Vec<Figure>, FigureError> {
    let drafts = |sheet: Sheet| DRAWN.iter().map(move |drawn| draft(study, found, sheet, drawn));
    let both = drafts(Sheet::Wide).flatten().zip(drafts(Sheet::Narrow).flatten());
    both.map(|(wide, narrow)| wide.finish_with(narrow)).collect()
}

/// An object, and of times a machine.
type Shown<'a> = (&'a str, Option<&'a String>);

fn draft(study: &Study, found: &SweepFound, sheet: Sheet, of: &Drawn) -> Option<Unfinished> {
    let Drawn { name, quantity, measure, unit } = *of;
    let y = format!("{measure}{unit}");
    let lines: Vec<&SweepLine> =
        found.lines.iter().filter(|line| line.quantity == quantity && line.points.len() > 1).collect();
    let mut panels: Vec<Shown<'_>> = Vec::new();
    for line in &lines {
        let shown = (line.id.object.as_str(), line.machine.as_ref());
        if !panels.contains(&shown) {
            panels.push(shown);
        }
    }
    let methods: Vec<MethodId> = study.method_ids();
    let drawn = |method: &&MethodId| lines.iter().any(|line| line.id.method == **method);
    let mark =
        |method: &MethodId| (Swatch::Mark(style::mark(study, *method)), study.method(*method).label.clone());
    let legend: Vec<(Swatch, String)> = methods.iter().filter(drawn).map(mark).collect();
    let panels: Vec<Scatter> = panels.into_iter().map(|shown| panel(study, &lines, shown, &y)).collect();
    let rows: Vec<&[Scatter]> = panels.chunks(sheet.columns(3)).collect();
    let (mut canvas, top) = canvas_with_legend(sheet, &legend, ROW * rows.len() as f64);
    for (row, panels) in (0_u32..).zip(&rows) {
        let width = sheet.width() / rows[0].len() as f64;
        let y = top + ROW * f64::from(row);
        for (column, panel) in (0_u32..).zip(*panels) {
            let x = width * f64::from(column);
            panel.draw(&mut canvas, (x, y), (x + width, y + ROW));
        }
    }
    let caption = format!(
        "{} against the cells per axis. Each mark is the geometric mean over all settings at a resolution. Both axes are logarithmic.",
        crate::words::capital(measure)
    );
    (!rows.is_empty()).then_some(Unfinished { name, caption, canvas })
}

fn panel(study: &Study, lines: &[&SweepLine], (object, machine): Shown<'_>, y: &str) -> Scatter {
    let (mut drawn, mut marks) = (Vec::new(), Vec::new());
    let own = |line: &&&SweepLine| line.id.object == object && line.machine.as_ref() == machine;
    for line in lines.iter().filter(own) {
        let method = line.id.method;
        let points: Vec<(f64, f64)> =
            line.points.iter().map(|point| (f64::from(point.cells), point.mean)).collect();
        marks.extend(points.iter().map(|&at| (at, style::mark(study, method))));
        drawn.push((style::method(study, method).outline, points));
    }
    let ends = |of: fn(&(f64, f64)) -> f64| {
        let values = drawn.iter().flat_map(|(_, line)| line.iter().map(of));
        values.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)))
    };
    let (xs, ys) = (ends(|at| at.0), ends(|at| at.1));
    let name = study.file.objects.iter().find(|of| of.id == object).map_or(object, |of| &of.name);
    Scatter {
        heading: machine.map_or_else(|| name.to_owned(), |machine| format!("{name}, {machine}")),
        labels: ("cells per axis".into(), y.into()),
        x: Axis::decades(xs.0, xs.1),
        y: Axis::decades(ys.0, ys.1),
        lines: drawn,
        dashed: None,
        marks,
        names: Vec::new(),
    }
}
