//! Distributions of the two aspect ratios: a box a configuration.

use super::axis::Axis;
use super::bars::{frame, room_for_labels};
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
    let objects: Vec<usize> = (0..inputs.study.file.objects.len()).collect();
    let blocks = sheet.in_rows(&objects);
    let (mut canvas, top) = canvas_with_legend(sheet, &[], 2.0 * ROW * blocks.len() as f64);
    let mut y = top;
    for block in blocks {
        for (label, of) in MEASURES {
            // One scale a row, so that objects can be compared.
            let q95 = meshes.in_order().map(|(_, mesh)| of(mesh).q95).fold(1.0, f64::max);
            let axis = Axis::logarithmic(q95);
            let width = sheet.width() / block.len() as f64;
            for (i, &object) in block.iter().enumerate() {
                let boxes: Vec<(MethodId, Option<&Distribution>)> = inputs
                    .study
                    .method_ids()
                    .into_iter()
                    .map(|method| (method, meshes.at(object, method).map(of).filter(|d| d.count > 0)))
                    .collect();
                let x = width * i as f64;
                let name = &inputs.study.file.objects[object].name;
                panel(&mut canvas, inputs.study, &axis, label, name, &boxes, (x, y), (x + width, y + ROW));
            }
            y += ROW;
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
    let (left, right) = (from.0 + room_for_labels(canvas.sheet(), axis), to.0 - 10.0);
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
