//! The table, as CSV and Markdown, with every sample beside it.

use crate::{Grid, Measured};
use anyhow::Result;
use design::machine::Machine;
use glam::DVec3;
use mesh::TriangleMesh;
use std::fmt::Write;
use std::path::Path;

/// What everything is compared with.
const BASE: &str = "isostudy bi";

/// Under which it was measured.
pub(crate) struct Conditions {
    pub(crate) rounds: u32,
    pub(crate) pinned: bool,
    /// The largest share of the CPU time that others had during a field and size.
    pub(crate) others: Option<f64>,
    /// Names of the peers with what is in their times.
    pub(crate) notes: Vec<String>,
    /// What was not measured, and why.
    pub(crate) skipped: Vec<String>,
    pub(crate) machine: Machine,
    pub(crate) date: String,
}

pub(crate) struct Row {
    field: &'static str,
    cells: u32,
    peer: String,
    extraction_s: [f64; 3],
    sampling_s: f64,
    /// Median and quartiles over rounds of this peer's time over the base's.
    ratio: [f64; 3],
    vertices: usize,
    triangles: u64,
    radius_ratio: f64,
    smallest_angle_deg: f64,
    boundary_edges: u64,
    non_manifold_edges: u64,
    euler_characteristic: i64,
}

/// Lower quartile, median, upper quartile; between values by straight lines.
fn quartiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [0.25, 0.5, 0.75].map(|share| {
        let at = share * (values.len() - 1) as f64;
        let (low, high) = (values[at.floor() as usize], values[at.ceil() as usize]);
        low + (at - at.floor()) * (high - low)
    })
}

pub(crate) fn rows(grid: &Grid, measured: Vec<Measured>) -> Vec<Row> {
    let base = measured.iter().find(|m| m.peer.starts_with(BASE)).map(|m| m.extraction_s.clone());
    // Without ours there is nothing to stand beside; the report says why.
    let Some(base) = base else { return Vec::new() };
    let row = |measured: Measured| {
        let mesh = outward(measured.mesh);
        let (quality, topology) = (mesh::quality::quality(&mesh), mesh::topology::topology(&mesh));
        Row {
            field: grid.field,
            cells: grid.cells,
            peer: measured.peer,
            ratio: quartiles(measured.extraction_s.iter().zip(&base).map(|(own, base)| own / base).collect()),
            extraction_s: quartiles(measured.extraction_s),
            sampling_s: quartiles(measured.sampling_s)[1],
            vertices: mesh.positions.len(),
            triangles: quality.triangles,
            radius_ratio: quality.radius_ratio.mean,
            smallest_angle_deg: quality.min_angle_deg.min,
            boundary_edges: topology.boundary_edges,
            non_manifold_edges: topology.non_manifold_edges,
            euler_characteristic: topology.euler_characteristic,
        }
    };
    measured.into_iter().map(row).collect()
}

/// With triangles turned so that the volume is positive: which way they face is a convention.
fn outward(mut mesh: TriangleMesh) -> TriangleMesh {
    let p = |i: u32| mesh.positions[i as usize].as_dvec3();
    let volume: f64 = mesh.triangles.iter().map(|&[a, b, c]| DVec3::dot(p(a), p(b).cross(p(c)))).sum();
    if volume < 0.0 {
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    mesh
}

pub(crate) fn write(out: &Path, rows: &[Row], samples: &[String], conditions: &Conditions) -> Result<()> {
    let Conditions { rounds, pinned, .. } = conditions;
    let mut csv = String::from(
        "field,cells,peer,extraction_q25_s,extraction_median_s,extraction_q75_s,sampling_median_s,ratio_q25,ratio_median,ratio_q75,\
         vertices,triangles,radius_ratio_mean,smallest_angle_deg,boundary_edges,non_manifold_edges,euler_characteristic\n",
    );
    let mut markdown = format!(
        "Extraction beside other libraries, {rounds} interleaved rounds after a warm-up, {}.\n\n\
         | field | cells | extractor | extraction, ms (quartiles) | times isostudy bi | sampling, ms | vertices | triangles | mean radius \
         ratio | smallest angle | boundary, non-manifold edges | \u{3c7} |\n|---|---:|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
        if *pinned { "all on one core" } else { "not pinned" }
    );
    for row in rows {
        let Row { field, cells, peer, vertices, triangles, .. } = row;
        let [low, middle, high] = row.extraction_s;
        let [ratio_low, ratio, ratio_high] = row.ratio;
        let (radius_ratio, angle, chi) = (row.radius_ratio, row.smallest_angle_deg, row.euler_characteristic);
        let (boundary, non_manifold) = (row.boundary_edges, row.non_manifold_edges);
        writeln!(
            csv,
            "{field},{cells},\"{peer}\",{low},{middle},{high},{},{ratio_low},{ratio},{ratio_high},{vertices},{triangles},\
             {radius_ratio},{angle},{boundary},{non_manifold},{chi}",
            row.sampling_s
        )?;
        let ms = |seconds: f64| format!("{:.2}", 1e3 * seconds);
        let sampling = if row.sampling_s > 0.0 { ms(row.sampling_s) } else { "given".into() };
        writeln!(
            markdown,
            "| {field} | {cells} | {peer} | {} ({} to {}) | {ratio:.2} ({ratio_low:.2} to {ratio_high:.2}) | {sampling} | {vertices} | \
             {triangles} | {radius_ratio:.3} | {angle:.1} | {boundary}, {non_manifold} | {chi} |",
            ms(middle),
            ms(low),
            ms(high)
        )?;
    }
    let machine = &conditions.machine;
    writeln!(
        markdown,
        "\nOn {}, {}. Extraction: from samples, or from the field with the time in the field taken off, to vertices and triangles. Samples \
         are 32-bit floats on one cubic grid; isostudy and manifold3d call the field, since their body-centred lattices have points \
         that the grid has not, and isostudy samples near the surface only. Spacing is the same for all; a body-centred lattice has \
         twice the points of a cubic one.",
        machine.model.as_deref().unwrap_or("an unnamed CPU"),
        conditions.date
    )?;
    if let Some(others) = conditions.others {
        writeln!(markdown, "\nOthers had up to {:.0} % of the CPU time meanwhile.", 100.0 * others)?;
    }
    for (label, note) in conditions.notes.iter().filter_map(|name| name.split_once("; ")) {
        writeln!(markdown, "\n{label}: {note}.")?;
    }
    for reason in &conditions.skipped {
        writeln!(markdown, "\nSkipped: {reason}.")?;
    }
    std::fs::create_dir_all(out)?;
    std::fs::write(out.join("peers.csv"), csv)?;
    std::fs::write(out.join("peers.md"), &markdown)?;
    std::fs::write(out.join("samples.csv"), samples.join("\n") + "\n")?;
    std::fs::write(out.join("machine.json"), serde_json::to_vec_pretty(machine)?)?;
    print!("{markdown}");
    println!("{}", out.display());
    Ok(())
}
