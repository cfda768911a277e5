//! Extractors by speed and by how often they are right.

use super::axis::Axis;
use super::canvas::Colour;
use super::draft::{Unfinished, canvas_with_legend};
use super::error::FigureError;
use super::legend::Swatch;
use super::marks::Mark;
use super::scatter::Scatter;
use super::sheet::Sheet;
use super::style::{LEFT, RIGHT};
use crate::figure::Figure;

/// An engine, where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct EnginePoint {
    /// As tables name it.
    pub name: String,
    /// The geometric mean of its times over the least, and the interval of that.
    pub time: [f64; 3],
    /// The share of workloads that it was asked for whose mesh is right.
    pub right: f64,
    /// Whether the makers of the figure made it.
    pub ours: bool,
}

const HEIGHT: f64 = 460.0;

/// Speed against correctness.
///
/// # Errors
/// If drawing fails, which is not to be expected.
pub fn barometer_figure(points: &[EnginePoint]) -> Result<Figure, FigureError> {
    draft(points, Sheet::Wide).finish()
}

fn draft(points: &[EnginePoint], sheet: Sheet) -> Unfinished {
    let mark = |ours: bool| Mark::nth(usize::from(!ours), true).coloured(if ours { RIGHT } else { LEFT });
    let legend = [true, false].map(|ours| {
        let words = if ours { "made by the makers of the barometer" } else { "made by others" };
        (Swatch::Mark(mark(ours)), words.to_owned())
    });
    let (mut canvas, top) = canvas_with_legend(sheet, &legend, HEIGHT);
    let slowest = points.iter().map(|of| of.time[2]).fold(2.0, f64::max);
    let at = |of: &EnginePoint| (of.time[0], 100.0 * of.right);
    let lines: Vec<(Colour, Vec<(f64, f64)>)> = points
        .iter()
        .map(|of| {
            (if of.ours { RIGHT } else { LEFT }, [of.time[1], of.time[2]].map(|x| (x, at(of).1)).to_vec())
        })
        .filter(|(_, ends)| ends[0] != ends[1])
        .collect();
    let panel = Scatter {
        heading: "Speed and correctness".into(),
        labels: (
            "time over that of the fastest engine, geometric mean over workloads".into(),
            "workloads with the right mesh, %".into(),
        ),
        x: Axis::decades(1.0, slowest),
        y: Axis::within(0.0, 100.0),
        lines,
        dashed: None,
        marks: points.iter().map(|of| (at(of), mark(of.ours))).collect(),
        names: points.iter().map(|of| (at(of), of.name.clone())).collect(),
    };
    panel.draw(&mut canvas, (0.0, top), (sheet.width(), top + HEIGHT));
    let caption = "Engines that are given samples and passed at least half of the workloads. Better is to the left, and up. Lines are intervals \
                   at 95 % over surfaces. A few workloads have the topology of the trilinear interpolant for their truth, which most methods do not \
                   promise.";
    Unfinished { name: "speed-and-correctness", caption: caption.into(), canvas }
}
