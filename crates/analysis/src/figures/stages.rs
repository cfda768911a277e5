//! Stage times stacked: an object a panel; below, the same without sampling, which drowns the rest on costly fields.

use super::axis::Axis;
use super::bars::{Bar, BarPanel, Cluster, Slot, largest};
use super::legend::Swatch;
use super::{Unfinished, WIDTH, canvas_with_legend, style};
use crate::inputs::Inputs;
use design::ConfigurationId;
use timing::stage_times::{StageTimes, conditions};

const ROW: f64 = 280.0;
const PER_ROW: usize = 3;

pub(super) fn stage_times(inputs: &Inputs<'_>) -> Option<Unfinished> {
    let run = inputs.bench?;
    let with_samples: Vec<usize> = (0..inputs.study.file.objects.len())
        .filter(|&o| run.samples.iter().any(|sample| sample.id.object == inputs.study.file.objects[o].id))
        .collect();
    if with_samples.is_empty() {
        return None;
    }
    let legend: Vec<_> =
        style::stages().into_iter().map(|(name, fill)| (Swatch::Area(fill), name.to_owned())).collect();
    let blocks: Vec<&[usize]> = with_samples.chunks(PER_ROW).collect();
    let (mut canvas, top) = canvas_with_legend(&legend, 2.0 * ROW * blocks.len() as f64);
    let mut y = top;
    for block in blocks {
        for sampling in [true, false] {
            let width = WIDTH / block.len() as f64;
            for (i, &object) in block.iter().enumerate() {
                let x = width * i as f64;
                panel(inputs, object, sampling).draw(&mut canvas, (x, y), (x + width, y + ROW));
            }
            y += ROW;
        }
    }
    let caption = format!(
        "Time of each stage, stacked; above with, below without sampling the field. Every panel has its own scale. {}",
        conditions(run)
    );
    Some(Unfinished { name: "stage_times", caption, canvas })
}

fn panel(inputs: &Inputs<'_>, object: usize, sampling: bool) -> BarPanel {
    let object = &inputs.study.file.objects[object];
    let bar = |method| {
        let id = ConfigurationId { object: object.id.clone(), method };
        let Some(t) = inputs.bench.and_then(|run| StageTimes::of(run, &id)) else { return Bar::default() };
        let seconds = [t.allocation_s, t.sampling_s, t.vertex_s, t.geometry_s, t.normals_s];
        let stages =
            style::stages().into_iter().zip(seconds).filter(|((name, _), _)| sampling || *name != "sampling");
        Bar { segments: stages.map(|((_, fill), s)| (1e3 * s, fill)).collect(), ..Bar::default() }
    };
    let methods = inputs.study.method_ids().into_iter();
    let slots: Vec<Slot> = methods.map(|m| Slot { label: m.to_string(), bars: vec![bar(m)] }).collect();
    let label = if sampling { object.name.clone() } else { format!("{}, without sampling", object.name) };
    let mut clusters = vec![Cluster { label, slots }];
    // A costly field takes seconds; milliseconds would only add zeros.
    let (unit, factor) = if largest(&clusters) >= 1000.0 { ("time, s", 1e-3) } else { ("time, ms", 1.0) };
    for bar in clusters.iter_mut().flat_map(|c| &mut c.slots).flat_map(|s| &mut s.bars) {
        bar.segments.iter_mut().for_each(|segment| segment.0 *= factor);
    }
    BarPanel {
        heading: String::new(),
        axis_label: unit.into(),
        axis: Axis::from_zero(largest(&clusters)),
        clusters,
        broken: false,
        cap: None,
    }
}
