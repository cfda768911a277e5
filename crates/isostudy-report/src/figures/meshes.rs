//! The paper's grouped bar charts: triangles, pass times, aspect ratio.

use super::axis::Axis;
use super::bars::{Bar, BarPanel, Cluster, Slot, largest, rows_of_panels};
use super::draft::Unfinished;
use super::legend::Swatch;
use super::sheet::Sheet;
use super::style;
use crate::region;
use isostudy_design::ConfigurationId;
use isostudy_design::published::BenchmarkRow;
use isostudy_design::record::{BenchRun, BenchSample, MeshRecord, Purpose};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::{MeshSet, known};
use isostudy_statistics::interval::LEVEL;
use isostudy_statistics::{Median, median};

/// Where the paper cuts the axis of aspect ratios.
const CUT: f64 = 10.0;
const HEIGHT: f64 = 520.0;

/// The mark of published values where there are any; methods have their names under their bars.
fn published_legend(published: bool) -> Vec<(Swatch, String)> {
    if published { vec![(Swatch::Diamond, "published".into())] } else { Vec::new() }
}

/// One cluster an object, one slot a method; `bars` gives a slot's bars.
fn clusters(
    inputs: &Inputs<'_>,
    bars: impl Fn(&ConfigurationId, Option<&BenchmarkRow>) -> Vec<Bar>,
) -> Vec<Cluster> {
    let study = inputs.study;
    let cluster = |object: &isostudy_design::config::ObjectSection| Cluster {
        label: object.name.clone(),
        slots: study
            .method_ids()
            .into_iter()
            .map(|method| {
                let id = ConfigurationId { object: object.id.clone(), method };
                let row = study.published.benchmark.iter().find(|row| row.id == id);
                Slot { label: style::name(study, method), bars: bars(&id, row) }
            })
            .collect(),
    };
    study.file.objects.iter().map(cluster).collect()
}

fn draft(
    sheet: Sheet,
    name: &'static str,
    caption: String,
    panel: BarPanel,
    legend: &[(Swatch, String)],
) -> Unfinished {
    let canvas = rows_of_panels(sheet, legend, vec![vec![(1.0, panel)]], HEIGHT);
    Unfinished { name, caption, canvas }
}

/// One bar a configuration, from its benchmark mesh.
fn mesh_clusters(
    inputs: &Inputs<'_>,
    ours: fn(&MeshRecord) -> Option<f64>,
    published: fn(&BenchmarkRow) -> f64,
) -> Option<Vec<Cluster>> {
    let meshes = MeshSet::of(inputs, Purpose::Benchmark);
    if meshes.is_empty() {
        return None;
    }
    Some(clusters(inputs, |id, row| {
        vec![Bar::of(
            meshes.get(id).and_then(ours),
            style::method(inputs.study, id.method),
            row.map(published),
        )]
    }))
}

fn has_published(clusters: &[Cluster]) -> bool {
    clusters.iter().flat_map(|c| &c.slots).flat_map(|s| &s.bars).any(|bar| bar.published.is_some())
}

pub(super) fn triangles(inputs: &Inputs<'_>, sheet: Sheet) -> Option<Unfinished> {
    let clusters = mesh_clusters(inputs, |m| Some(m.judged().triangles as f64), |p| p.triangles as f64)?;
    let published = has_published(&clusters);
    let panel = BarPanel::from_zero("triangles", clusters);
    let caption = "Triangles of each configuration at the benchmark spacing.";
    let caption = region::said(caption, inputs.study, "They");
    Some(draft(sheet, "triangles", caption, panel, &published_legend(published)))
}

/// Above the times of ours, medians with intervals; below what share of the whole a pass takes, beside the published share:
/// seconds of two machines say nothing about each other.
pub(super) fn pass_times(inputs: &Inputs<'_>, sheet: Sheet) -> Option<Unfinished> {
    let run = inputs.bench?;
    let whole = |sample: &BenchSample| sample.total_s - sample.normals_s;
    let passes: [fn(&BenchSample) -> f64; 2] = [|s| s.vertex_s, |s| s.geometry_s + s.clustering_s];
    let bars = |value: &dyn Fn(&BenchSample, f64) -> f64, published: fn(&BenchmarkRow) -> [f64; 2]| {
        clusters(inputs, |id, row| {
            let fill = style::method(inputs.study, id.method);
            let published = row.map(published);
            let bar = |(place, fill): (usize, style::Fill)| {
                let of = median_of(run, id, |sample| value(sample, passes[place](sample)));
                Bar {
                    interval: of.as_ref().and_then(|of| of.interval_at(LEVEL)),
                    ..Bar::of(
                        of.map(|of| of.median),
                        fill,
                        published.map(|of| of[place]).filter(|p| p.is_finite()),
                    )
                }
            };
            [(0, fill), (1, fill.striped())].map(bar).into()
        })
    };
    let times = bars(&|_, pass| 1e3 * pass, |_| [f64::NAN; 2]);
    if largest(&times) == 0.0 {
        return None;
    }
    let shares = bars(&|sample, pass| pass / whole(sample), |row| {
        [row.vertex_s, row.geometry_s].map(|pass| pass / row.total_without_normals_s)
    });
    let white = style::Fill { outline: super::canvas::BLACK, ..style::Fill::plain(super::canvas::WHITE) };
    let mut legend = vec![
        (Swatch::Area(white), "vertex pass (left bar)".into()),
        (Swatch::Area(white.striped()), "geometry pass (right bar)".into()),
        (Swatch::Whisker, "95 % interval of the median".into()),
    ];
    let mut caption = format!(
        "Time of the vertex and the geometry pass, medians over rounds: in milliseconds, and as shares of the whole \
         extraction without normals. {}",
        isostudy_timing::stage_times::conditions(run).replace("means over ", "")
    );
    if has_published(&shares) {
        legend.push((Swatch::Diamond, "published share".into()));
        caption.push_str(" Published times are from another machine, so they are shown as shares alone.");
    }
    let rows = [("median time, ms", times), ("share of the whole", shares)]
        .map(|(axis_label, clusters)| vec![(1.0, BarPanel::from_zero(axis_label, clusters))]);
    let canvas = rows_of_panels(sheet, &legend, rows.into(), HEIGHT);
    Some(Unfinished { name: "pass_times", caption, canvas })
}

/// The median of something over a configuration's samples, with its interval.
pub(super) fn median_of(
    run: &BenchRun,
    id: &ConfigurationId,
    value: impl Fn(&BenchSample) -> f64,
) -> Option<Median> {
    median(run.samples.iter().filter(|sample| sample.id == *id).map(value).collect(), LEVEL)
}

/// A bounded measure of shape, which no sliver drives.
pub(super) fn radius_ratios(inputs: &Inputs<'_>, sheet: Sheet) -> Option<Unfinished> {
    let meshes = MeshSet::of(inputs, Purpose::Benchmark);
    if meshes.is_empty() {
        return None;
    }
    let clusters = clusters(inputs, |id, _| {
        let mean = meshes.get(id).and_then(|m| known(&m.judged().quality.radius_ratio, |d| d.mean));
        vec![Bar::of(mean, style::method(inputs.study, id.method), None)]
    });
    let panel = BarPanel::of("mean radius ratio", Axis::up_to(1.0), clusters);
    let caption = "Mean radius ratio of the triangles at the benchmark spacing: 1 is equilateral, 0 is flat. A few flat \
                   triangles change it little, unlike the mean aspect ratio.";
    let caption = region::said(caption, inputs.study, "The triangles");
    Some(draft(sheet, "radius_ratio", caption, panel, &[]))
}

pub(super) fn aspect_ratios(inputs: &Inputs<'_>, sheet: Sheet) -> Option<Unfinished> {
    let clusters = mesh_clusters(
        inputs,
        |m| known(&m.judged().quality.published_aspect_ratio, |d| d.mean),
        |p| p.aspect_ratio_mean,
    )?;
    let published = has_published(&clusters);
    let degenerate: u64 =
        MeshSet::of(inputs, Purpose::Benchmark).in_order().map(|(_, m)| m.judged().quality.degenerate).sum();
    let beyond: Vec<String> = inputs
        .study
        .published
        .benchmark
        .iter()
        .filter(|row| row.aspect_ratio_mean > CUT)
        .map(|row| format!("{} {:.2}", row.id, row.aspect_ratio_mean))
        .collect();
    let mut caption = String::from(
        "Mean aspect ratio as published: longer over shorter of the two edges at a triangle's first corner.",
    );
    caption = region::said(caption, inputs.study, "The triangles");
    if largest(&clusters) > CUT {
        caption.push_str(" The axis is cut at 10; bars that run out of it carry their value.");
    }
    if degenerate > 0 {
        caption
            .push_str(&format!(" {degenerate} degenerate triangles, whose ratio is infinite, are left out."));
    }
    if published && !beyond.is_empty() {
        caption.push_str(&format!(" Published values beyond the axis: {}.", beyond.join(", ")));
    }
    let axis = match largest(&clusters) {
        high if high > CUT => Axis::up_to(CUT),
        high => Axis::from_zero(high),
    };
    let panel = BarPanel { broken: true, ..BarPanel::of("mean aspect ratio", axis, clusters) };
    Some(draft(sheet, "aspect_ratio", caption, panel, &published_legend(published)))
}
