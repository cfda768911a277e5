//! The paper's grouped bar charts: triangles, pass times, aspect ratio.

use super::axis::Axis;
use super::bars::{Bar, BarPanel, Cluster, Slot, largest};
use super::legend::Swatch;
use super::{Unfinished, WIDTH, canvas_with_legend, style};
use crate::inputs::Inputs;
use crate::mesh_set::{MeshSet, known};
use design::published::BenchmarkRow;
use design::record::{MeshRecord, Purpose};
use design::{ConfigurationId, Method};
use timing::stage_times::StageTimes;

/// Where the paper cuts the axis of aspect ratios.
const CUT: f64 = 10.0;
const HEIGHT: f64 = 420.0;

/// The methods with their fills, and the mark of published values where there are any.
pub(super) fn method_legend(inputs: &Inputs<'_>, published: bool) -> Vec<(Swatch, String)> {
    let study = inputs.study;
    let entry = |m: &Method| (Swatch::Area(style::method(study, m.id)), format!("{}: {}", m.id, m.label));
    let mut legend: Vec<_> = study.methods.iter().map(entry).collect();
    if published {
        legend.push((Swatch::Diamond, "published".into()));
    }
    legend
}

/// One cluster an object, one slot a method; `bars` gives a slot's bars.
fn clusters(
    inputs: &Inputs<'_>,
    bars: impl Fn(&ConfigurationId, Option<&BenchmarkRow>) -> Vec<Bar>,
) -> Vec<Cluster> {
    let study = inputs.study;
    let cluster = |object: &design::config::ObjectSection| Cluster {
        label: object.name.clone(),
        slots: study
            .method_ids()
            .into_iter()
            .map(|method| {
                let id = ConfigurationId { object: object.id.clone(), method };
                let row = study.published.benchmark.iter().find(|row| row.id == id);
                Slot { label: method.to_string(), bars: bars(&id, row) }
            })
            .collect(),
    };
    study.file.objects.iter().map(cluster).collect()
}

fn draft(name: &'static str, caption: String, panel: &BarPanel, legend: &[(Swatch, String)]) -> Unfinished {
    let (mut canvas, top) = canvas_with_legend(legend, HEIGHT);
    panel.draw(&mut canvas, (0.0, top), (WIDTH, top + HEIGHT));
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

pub(super) fn triangles(inputs: &Inputs<'_>) -> Option<Unfinished> {
    let clusters = mesh_clusters(inputs, |m| Some(m.counts.triangles as f64), |p| p.triangles as f64)?;
    let published = has_published(&clusters);
    let panel = BarPanel {
        heading: String::new(),
        axis_label: "triangles".into(),
        axis: Axis::from_zero(largest(&clusters)),
        clusters,
        broken: false,
        cap: None,
    };
    let caption = "Triangles of each configuration at the benchmark spacing.".into();
    Some(draft("triangles", caption, &panel, &method_legend(inputs, published)))
}

pub(super) fn pass_times(inputs: &Inputs<'_>) -> Option<Unfinished> {
    let run = inputs.bench?;
    let clusters = clusters(inputs, |id, row| {
        let times = StageTimes::of(run, id);
        let fill = style::method(inputs.study, id.method);
        let ms = |s: f64| 1e3 * s;
        let vertex = times.map(|t| ms(t.vertex_s));
        let geometry = times.map(|t| ms(t.geometry_s));
        vec![
            Bar::of(vertex, fill, row.map(|r| ms(r.vertex_s))),
            Bar::of(geometry, fill.striped(), row.map(|r| ms(r.geometry_s))),
        ]
    });
    if largest(&clusters) == 0.0 {
        return None;
    }
    let published = has_published(&clusters);
    let mut legend = method_legend(inputs, false);
    let white = style::Fill { outline: super::canvas::BLACK, ..style::Fill::plain(super::canvas::WHITE) };
    legend.push((Swatch::Area(white), "vertex pass (left bar)".into()));
    legend.push((Swatch::Area(white.striped()), "geometry pass (right bar)".into()));
    let mut caption =
        format!("Time of the vertex and the geometry pass. {}", timing::stage_times::conditions(run));
    if published {
        legend.push((Swatch::Diamond, "published".into()));
        if !run.differences.is_empty() {
            caption.push_str(" Published times are from another machine.");
        }
    }
    let panel = BarPanel {
        heading: String::new(),
        axis_label: "time, ms".into(),
        axis: Axis::from_zero(largest(&clusters)),
        clusters,
        broken: false,
        cap: None,
    };
    Some(draft("pass_times", caption, &panel, &legend))
}

pub(super) fn aspect_ratios(inputs: &Inputs<'_>) -> Option<Unfinished> {
    let clusters = mesh_clusters(
        inputs,
        |m| known(&m.quality.published_aspect_ratio, |d| d.mean),
        |p| p.aspect_ratio_mean,
    )?;
    let published = has_published(&clusters);
    let degenerate: u64 =
        MeshSet::of(inputs, Purpose::Benchmark).in_order().map(|(_, m)| m.quality.degenerate).sum();
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
    let axis_label = "mean aspect ratio".into();
    let panel = BarPanel { heading: String::new(), axis_label, axis, clusters, broken: true, cap: None };
    Some(draft("aspect_ratio", caption, &panel, &method_legend(inputs, published)))
}
