//! Distributions of the two aspect ratios: a box a configuration.

use super::axis::Axis;
use super::bars::{PITCH, frame, room_for_labels};
use super::canvas::{Align, BLACK, Canvas, text_width};
use super::draft::{Unfinished, canvas_with_legend};
use super::sheet::Sheet;
use super::style;
use super::style::Fill;
use crate::region;
use isostudy_design::record::{Distribution, MeshRecord, Purpose};
use isostudy_design::{MethodId, Study};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::MeshSet;

const ROW: f64 = 400.0;
/// How high a row is of which each method has a part alone.
const PART: f64 = 330.0;
/// Room to the right of a plot.
const RIGHT: f64 = 10.0;
/// A box lower than this is a line.
const FLAT: f64 = 5.0;

type Measure = (&'static str, fn(&MeshRecord) -> &Distribution);

const MEASURES: [Measure; 2] = [
    ("longest / shortest edge", |m| &m.judged().quality.edge_ratio),
    ("published ratio", |m| &m.judged().quality.published_aspect_ratio),
];

pub(super) fn aspect_ratios(inputs: &Inputs<'_>, sheet: Sheet) -> Option<Unfinished> {
    let meshes = MeshSet::of(inputs, Purpose::Benchmark);
    if meshes.is_empty() {
        return None;
    }
    let study = inputs.study;
    let methods = study.method_ids();
    let objects: Vec<usize> = (0..study.file.objects.len()).collect();
    // One scale a measure, so that objects can be compared.
    let axes = MEASURES.map(|(_, of)| {
        Axis::logarithmic(meshes.in_order().map(|(_, mesh)| of(mesh).q95).fold(1.0, f64::max))
    });
    // How many names stand beside each other under one of so many panels.
    let room = |columns: usize| {
        let taken = axes.iter().map(|axis| room_for_labels(sheet, axis)).fold(0.0, f64::max) + RIGHT;
        ((sheet.width() / columns as f64 - taken) / (PITCH * sheet.em())) as usize
    };
    let usual = sheet.in_rows(&objects);
    let widest = usual.iter().map(|row| row.len()).max().unwrap_or(1);
    let columns = (1..=widest).rev().find(|&columns| methods.len() <= room(columns)).unwrap_or(1);
    let blocks: Vec<&[usize]> = if columns == widest { usual } else { objects.chunks(columns).collect() };
    let parts = if columns > 1 { 1 } else { methods.len().div_ceil(room(1).max(1)).max(1) };
    let parts: Vec<&[MethodId]> = methods.chunks(methods.len().div_ceil(parts).max(1)).collect();
    let height = if parts.len() > 1 { PART } else { ROW };
    let rows = MEASURES.len() * parts.len() * blocks.len();
    let (mut canvas, top) = canvas_with_legend(sheet, &[], height * rows as f64);
    let mut y = top;
    for block in blocks {
        for ((label, of), axis) in MEASURES.iter().zip(&axes) {
            for part in &parts {
                let width = sheet.width() / block.len() as f64;
                for (i, &object) in block.iter().enumerate() {
                    let distribution = |method| meshes.at(object, method).map(of).filter(|d| d.count > 0);
                    let boxes: Vec<(MethodId, Option<&Distribution>)> =
                        part.iter().map(|&method| (method, distribution(method))).collect();
                    let x = width * i as f64;
                    let name = &study.file.objects[object].name;
                    panel(&mut canvas, study, axis, label, name, &boxes, (x, y), (x + width, y + height));
                }
                y += height;
            }
        }
    }
    let caption = "Aspect ratios of the triangles, at the benchmark spacing. Box: quartiles and median; whiskers: 5 % and 95 %; \
                   logarithmic scale. Above: longest over shortest of all three edges; below: the published ratio of \
                   the two edges at the first corner. Degenerate triangles are left out.";
    let caption = region::said(caption, inputs.study, "The triangles");
    Some(Unfinished { name: "aspect_ratio_distributions", caption, canvas })
}

fn panel(
    canvas: &mut Canvas,
    study: &Study,
    axis: &Axis,
    label: &str,
    object: &str,
    boxes: &[(MethodId, Option<&Distribution>)],
    from: (f64, f64),
    to: (f64, f64),
) {
    let em = canvas.sheet().em();
    let (left, right) = (from.0 + room_for_labels(canvas.sheet(), axis), to.0 - RIGHT);
    let name = |method: MethodId| style::name(study, method);
    let labels = boxes.iter().map(|(method, _)| text_width(&name(*method), em)).fold(0.0, f64::max);
    let (top, bottom) = (from.1 + 16.0, to.1 - 34.0 - labels);
    frame(canvas, axis, label, (left, right), (bottom, top));
    let pitch = (right - left) / boxes.len() as f64;
    let half = (0.32 * pitch).min(24.0);
    for (i, (method, distribution)) in boxes.iter().enumerate() {
        let x = left + pitch * (i as f64 + 0.5);
        let label = name(*method);
        let down = bottom + 8.0 + text_width(&label, em) / 2.0;
        canvas.text_upwards(label, (x + 4.0, down), em);
        let Some(d) = distribution else { continue };
        let heights = [d.q05, d.q25, d.median, d.q75, d.q95].map(|value| axis.place(value, bottom, top));
        draw_box(canvas, (x, half), heights, style::method(study, *method));
    }
    canvas.line(vec![(left, bottom), (right, bottom)], BLACK, 1.0);
    canvas.text(
        object,
        ((left + right) / 2.0, bottom + labels + 22.0),
        canvas.sheet().large_em(),
        Align::Middle,
    );
}

/// A box with its whiskers: heights of the lower whisker's end, the lower quartile, the median, the upper quartile and the upper
/// whisker's end.
pub(super) fn draw_box(canvas: &mut Canvas, (x, half): (f64, f64), heights: [f64; 5], fill: Fill) {
    let [low, lower, median, upper, high] = heights;
    for (inner, outer) in [(lower, low), (upper, high)] {
        canvas.line(vec![(x, inner), (x, outer)], BLACK, 1.0);
        canvas.line(vec![(x - half / 2.0, outer), (x + half / 2.0, outer)], BLACK, 1.0);
    }
    fill.paint(canvas, (x - half, lower), (x + half, upper));
    // In a box as flat as the line, what stands out against the fill might not against the page.
    let ink = if (upper - lower).abs() < FLAT { fill.outline } else { fill.ink() };
    canvas.line(vec![(x - half, median), (x + half, median)], ink, 2.0);
}
