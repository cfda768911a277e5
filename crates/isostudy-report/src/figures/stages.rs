//! Stage times stacked: an object a panel; below, the same without sampling, which drowns the rest on costly fields.

use super::bars::{Bar, BarPanel, Cluster, Slot, largest, rows_of_panels};
use super::draft::Unfinished;
use super::legend::Swatch;
use super::meshes::median_of;
use super::sheet::Sheet;
use super::style::{self, Fill};
use isostudy_design::ConfigurationId;
use isostudy_design::record::{BenchRun, BenchSample};
use isostudy_inference::inputs::Inputs;
use isostudy_statistics::interval::{Interval, LEVEL};
use isostudy_timing::stage_times::conditions;

const ROW: f64 = 400.0;
/// The place of sampling among the stages.
const SAMPLING: usize = 1;

pub(super) fn stage_times(inputs: &Inputs<'_>, sheet: Sheet) -> Option<Unfinished> {
    let run = inputs.bench?;
    let with_samples: Vec<usize> = (0..inputs.study.file.objects.len())
        .filter(|&o| run.samples.iter().any(|sample| sample.id.object == inputs.study.file.objects[o].id))
        .collect();
    if with_samples.is_empty() {
        return None;
    }
    let mut legend: Vec<_> = fills(run).map(|(name, fill)| (Swatch::Area(fill), name.to_owned())).collect();
    legend.push((Swatch::Whisker, "95 % interval of the median".into()));
    let rows = sheet.in_rows(&with_samples).into_iter().flat_map(|block| {
        [true, false].map(|sampling| {
            let share = 1.0 / block.len() as f64;
            block.iter().map(|&object| (share, panel(inputs, object, sampling))).collect()
        })
    });
    let canvas = rows_of_panels(sheet, &legend, rows.collect(), ROW);
    let caption = format!(
        "Time of each stage, stacked: with sampling the field, and below without. Every panel has its own scale. Bars are \
         medians over rounds; the medians of stages are scaled to add up to that of the whole. {}",
        conditions(run).replace("means over ", "")
    );
    Some(Unfinished { name: "stage_times", caption, canvas })
}

/// The stages of a run; what finishes a mesh is one where some method is finished.
fn fills(run: &BenchRun) -> impl Iterator<Item = (&'static str, Fill)> {
    let is_finished = run.samples.iter().any(|sample| sample.finishing_s > 0.0);
    style::stages().into_iter().chain(is_finished.then(style::finishing))
}

fn panel(inputs: &Inputs<'_>, object: usize, sampling: bool) -> BarPanel {
    let object = &inputs.study.file.objects[object];
    let bar = |method| {
        let id = ConfigurationId { object: object.id.clone(), method };
        let Some(run) = inputs.bench else { return Bar::default() };
        let stage: [fn(&BenchSample) -> f64; 6] = [
            |s| s.allocation_s,
            |s| s.sampling_s,
            |s| s.vertex_s,
            |s| s.geometry_s + s.clustering_s,
            |s| s.normals_s,
            |s| s.finishing_s,
        ];
        let whole = |s: &BenchSample| if sampling { s.total_s } else { s.total_s - s.sampling_s };
        let medians = stage.map(|stage| median_of(run, &id, stage).map_or(0.0, |of| of.median));
        let Some(total) = median_of(run, &id, whole) else { return Bar::default() };
        let shown = |place: &usize| sampling || *place != SAMPLING;
        let fills: Vec<Fill> = fills(run).map(|(_, fill)| fill).collect();
        let sum: f64 = (0..fills.len()).filter(shown).map(|place| medians[place]).sum();
        // Medians of parts do not add up to the median of the whole.
        let scale = if sum > 0.0 { 1e3 * total.median / sum } else { 0.0 };
        Bar {
            segments: (0..fills.len())
                .filter(shown)
                .map(|place| (scale * medians[place], fills[place]))
                .collect(),
            interval: total.interval_at(LEVEL).map(|i| Interval { low: 1e3 * i.low, high: 1e3 * i.high }),
            ..Bar::default()
        }
    };
    let methods = inputs.study.method_ids().into_iter();
    let slots: Vec<Slot> =
        methods.map(|m| Slot { label: style::name(inputs.study, m), bars: vec![bar(m)] }).collect();
    let label = if sampling { object.name.clone() } else { format!("{}, without sampling", object.name) };
    let mut clusters = vec![Cluster { label, slots }];
    // A costly field takes seconds; milliseconds would only add zeros.
    let (unit, factor) =
        if largest(&clusters) >= 1000.0 { ("median time, s", 1e-3) } else { ("median time, ms", 1.0) };
    for bar in clusters.iter_mut().flat_map(|c| &mut c.slots).flat_map(|s| &mut s.bars) {
        bar.segments.iter_mut().for_each(|segment| segment.0 *= factor);
        bar.interval = bar.interval.map(|i| Interval { low: factor * i.low, high: factor * i.high });
    }
    BarPanel::from_zero(unit, clusters)
}
