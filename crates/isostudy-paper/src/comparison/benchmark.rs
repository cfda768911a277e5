//! The published benchmark, column by column, and the rules that explain differences.

use super::Compared;
use crate::verdict::{UNEXPLAINED, Verdict, prints_alike, relative_difference};
use isostudy_design::config::FieldSection;
use isostudy_design::published::BenchmarkRow;
use isostudy_design::record::{BenchRun, Counts, MeshRecord, Purpose};
use isostudy_design::{Arrangement, Crossed, Study};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::{MeshSet, discarded, discarded_as_published, known};
use isostudy_inference::published_ratio;
use isostudy_timing::stage_times::StageTimes;

/// Another bunny than the published one: its counts and shapes agree to about this.
const OTHER_MESH: f64 = 0.03;
/// The last bit of a sine moves the asteroid's noise: its counts and shapes agree to about this.
const OTHER_SINE: f64 = 0.002;
/// Lengths and areas computed in double precision here, in single precision there.
const OTHER_PRECISION: f64 = 5e-7;

/// What a column measures, and so what may move it.
#[derive(Clone, Copy)]
enum Kind {
    /// Follows from the lattice alone.
    Lattice,
    /// Points or edges that a formula says are needed.
    Needed(fn(&BenchmarkRow) -> f64),
    /// Follows from the surface.
    Surface,
    /// As [`Kind::Surface`], but ours leaves out what the published number counts twice.
    Discarded,
    /// The published aspect ratio, as published.
    Ratio,
    /// A moment of the published aspect ratio; ours leaves out degenerate triangles.
    RatioWithoutDegenerate,
}

impl Kind {
    /// Whether a quantity put right differs from the one as published, which is compared as well.
    fn adds_something(self, mesh: &MeshRecord) -> bool {
        match self {
            Self::Discarded => {
                mesh.counts.discarded_triangles < mesh.counts.of_tetrahedra(|t| t.discarded_as_published)
            }
            Self::RatioWithoutDegenerate => mesh.quality.degenerate > 0,
            _ => true,
        }
    }
}

struct Quantity {
    name: &'static str,
    decimals: usize,
    kind: Kind,
    published: fn(&BenchmarkRow) -> f64,
    ours: fn(&MeshRecord) -> Option<f64>,
}

/// A count, published as `$published`.
macro_rules! count {
    ($name:ident, $kind:expr, $published:ident, $ours:expr) => {
        Quantity {
            name: stringify!($name),
            decimals: 0,
            kind: $kind,
            published: |p| p.$published as f64,
            ours: |m| {
                let count: fn(&Counts) -> Option<u64> = $ours;
                count(&m.counts).map(|count| count as f64)
            },
        }
    };
}

/// A count that only tetrahedra have, and that both sides call by one name.
macro_rules! count_of_tetrahedra {
    ($name:ident, $kind:expr) => {
        count!($name, $kind, $name, |c| c.of_tetrahedra(|t| t.$name))
    };
}

/// Cubes along an axis.
macro_rules! cells {
    ($name:ident, $axis:literal) => {
        Quantity {
            name: stringify!($name),
            decimals: 0,
            kind: Kind::Lattice,
            published: |p| p.$name.into(),
            ours: |m| Some(m.cells[$axis].into()),
        }
    };
}

/// A real number, published as `$published`.
macro_rules! real {
    ($name:ident, $kind:expr, $published:ident, $ours:expr) => {
        Quantity {
            name: stringify!($name),
            decimals: 6,
            kind: $kind,
            published: |p| p.$published,
            ours: $ours,
        }
    };
}

/// As published, then put right where that makes a difference.
const QUANTITIES: &[Quantity] = &[
    cells!(cells_x, 0),
    cells!(cells_y, 1),
    cells!(cells_z, 2),
    count_of_tetrahedra!(tetrahedra, Kind::Lattice),
    count_of_tetrahedra!(stored_samples, Kind::Lattice),
    count_of_tetrahedra!(stored_edges, Kind::Lattice),
    count_of_tetrahedra!(sample_bytes, Kind::Lattice),
    count_of_tetrahedra!(edge_bytes, Kind::Lattice),
    count!(needed_samples, Kind::Needed(samples_with_the_wrong_sign), needed_samples, |c| c.samples),
    count_of_tetrahedra!(needed_edges, Kind::Needed(edges_with_the_wrong_sign)),
    count_of_tetrahedra!(tetrahedra_evaluated, Kind::Surface),
    Quantity {
        name: "evaluated_fraction",
        decimals: 6,
        kind: Kind::Surface,
        published: |p| p.tetrahedra_evaluated as f64 / p.tetrahedra as f64,
        ours: |m| m.counts.tetrahedra.as_ref().map(|t| t.tetrahedra_evaluated as f64 / t.tetrahedra as f64),
    },
    count!(vertices, Kind::Surface, vertices, |c| Some(c.vertices)),
    count!(triangles, Kind::Surface, triangles, |c| Some(c.triangles)),
    count!(vertex_bytes, Kind::Surface, vertex_bytes, |c| Some(c.vertex_bytes)),
    count!(index_bytes, Kind::Surface, index_bytes, |c| Some(c.index_bytes)),
    count_of_tetrahedra!(discarded_as_published, Kind::Surface),
    count!(discarded_triangles, Kind::Discarded, discarded_as_published, |c| c.discarded_triangles),
    real!(discard_fraction_as_published, Kind::Surface, discard_fraction, |m| {
        Some(discarded_as_published(m)).filter(|share| !share.is_nan())
    }),
    real!(discard_fraction, Kind::Discarded, discard_fraction, |m| {
        Some(discarded(m)).filter(|share| !share.is_nan())
    }),
    real!(area_mean, Kind::Surface, area_mean, |m| known(&m.quality.area, |d| d.mean)),
    real!(area_sd, Kind::Surface, area_sd, |m| known(&m.quality.area, |d| d.sd)),
    real!(area_max, Kind::Surface, area_max, |m| known(&m.quality.area, |d| d.max)),
    real!(aspect_ratio_mean_as_published, Kind::Ratio, aspect_ratio_mean, |m| {
        published_ratio::mean(&m.quality)
    }),
    real!(aspect_ratio_sd_as_published, Kind::Ratio, aspect_ratio_sd, |m| published_ratio::sd(&m.quality)),
    real!(aspect_ratio_max, Kind::Ratio, aspect_ratio_max, |m| {
        known(&m.quality.published_aspect_ratio, |d| d.max)
    }),
    real!(aspect_ratio_mean, Kind::RatioWithoutDegenerate, aspect_ratio_mean, |m| {
        known(&m.quality.published_aspect_ratio, |d| d.mean)
    }),
    real!(aspect_ratio_sd, Kind::RatioWithoutDegenerate, aspect_ratio_sd, |m| {
        known(&m.quality.published_aspect_ratio, |d| d.sd)
    }),
];

type Stage = (&'static str, fn(&BenchmarkRow) -> f64, fn(&StageTimes) -> f64);

const STAGES: &[Stage] = &[
    ("allocation_s", |p| p.allocation_s, |t| t.allocation_s),
    ("sampling_s", |p| p.sampling_s, |t| t.sampling_s),
    ("vertex_s", |p| p.vertex_s, |t| t.vertex_s),
    ("geometry_s", |p| p.geometry_s, |t| t.geometry_s),
    ("normals_s", |p| p.normals_s, |t| t.normals_s),
    ("total_without_normals_s", |p| p.total_without_normals_s, |t| t.total_without_normals_s()),
    (
        "sampling_fraction",
        |p| p.sampling_s / p.total_without_normals_s,
        |t| t.sampling_s / t.total_without_normals_s(),
    ),
    (
        "vertex_fraction",
        |p| p.vertex_s / p.total_without_normals_s,
        |t| t.vertex_s / t.total_without_normals_s(),
    ),
    (
        "geometry_fraction",
        |p| p.geometry_s / p.total_without_normals_s,
        |t| t.geometry_s / t.total_without_normals_s(),
    ),
];

/// (x-1)(y-1)(z-1): the published count of sample points that a simple cubic lattice needs.
fn samples_with_the_wrong_sign(p: &BenchmarkRow) -> f64 {
    (f64::from(p.cells_x) - 1.0) * (f64::from(p.cells_y) - 1.0) * (f64::from(p.cells_z) - 1.0)
}

/// 7xyz - 3(xy+xz+yz) + (x+y+z): the published count of edges that a simple cubic lattice needs.
fn edges_with_the_wrong_sign(p: &BenchmarkRow) -> f64 {
    let (x, y, z) = (f64::from(p.cells_x), f64::from(p.cells_y), f64::from(p.cells_z));
    7.0 * x * y * z - 3.0 * (x * y + x * z + y * z) + x + y + z
}

/// All published rows that the study has a configuration and a mesh for.
pub(super) fn compare(inputs: &Inputs<'_>) -> Vec<Compared> {
    let meshes = MeshSet::of(inputs, Purpose::Benchmark);
    let mut all = Vec::new();
    for row in &inputs.study.published.benchmark {
        let Some(mesh) = meshes.get(&row.id) else { continue };
        for quantity in QUANTITIES.iter().filter(|quantity| quantity.kind.adds_something(mesh)) {
            let (published, ours) = ((quantity.published)(row), (quantity.ours)(mesh));
            all.push(Compared {
                source: "benchmark",
                row: row.id.to_string(),
                quantity: quantity.name.into(),
                published,
                ours,
                decimals: quantity.decimals,
                verdict: verdict(inputs.study, row, mesh, quantity, published, ours),
            });
        }
        let times = inputs.bench.and_then(|run| Some((run, StageTimes::of(run, &row.id)?)));
        for (name, published, ours) in times.iter().flat_map(|_| STAGES) {
            let (run, times) = times.as_ref().expect("iterated over");
            let (published, ours) = (published(row), ours(times));
            all.push(Compared {
                source: "benchmark",
                row: row.id.to_string(),
                quantity: (*name).into(),
                published,
                ours: Some(ours),
                decimals: 6,
                verdict: time_verdict(run, published, ours),
            });
        }
    }
    all
}

fn verdict(
    study: &Study,
    row: &BenchmarkRow,
    mesh: &MeshRecord,
    quantity: &Quantity,
    published: f64,
    ours: Option<f64>,
) -> Verdict {
    let Some(ours) = ours else { return Verdict::not_comparable("no triangle here to measure it on") };
    if prints_alike(published, ours, quantity.decimals) {
        return Verdict::Equal;
    }
    if mesh.cells != [row.cells_x, row.cells_y, row.cells_z] {
        let [x, y, z] = mesh.cells;
        return Verdict::not_comparable(format!("this study has {x}x{y}x{z} cubes"));
    }
    match quantity.kind {
        Kind::Needed(wrong_sign)
            if Crossed::of(row.id.method).is_some_and(|of| of.arrangement == Arrangement::SimpleCubic)
                && published == wrong_sign(row) =>
        {
            return Verdict::differs("the published formula has a wrong sign");
        }
        Kind::Discarded => return Verdict::differs(double_count(excess(&mesh.counts))),
        Kind::RatioWithoutDegenerate => return Verdict::differs(zero_ratios(mesh.quality.degenerate)),
        _ => {}
    }
    // A number of few printed digits is only known to half a unit.
    let half_unit = 0.5 * 10_f64.powi(-(quantity.decimals as i32));
    let off = match quantity.decimals {
        0 => relative_difference(published, ours),
        _ => ((ours - published).abs() - half_unit) / published.abs(),
    };
    let percent = |tolerance: f64| {
        let text = format!("{:.6}", 100.0 * tolerance);
        format!("{} %", text.trim_end_matches('0').trim_end_matches('.'))
    };
    if off <= OTHER_PRECISION && quantity.decimals > 0 {
        return Verdict::within(
            percent(OTHER_PRECISION),
            "lengths and areas in double precision here, in single precision there",
        );
    }
    let object = study.file.objects.iter().find(|object| object.id == row.id.object);
    let cause = object.and_then(|object| cause(&object.field));
    match cause {
        Some(cause) if off <= cause.tolerance => Verdict::within(percent(cause.tolerance), cause.long),
        Some(cause) if cause.beyond => {
            let ratio = matches!(quantity.kind, Kind::Ratio) && published > 5.0;
            let led = if ratio { "; led by the thinnest slivers" } else { "" };
            Verdict::differs(format!("{}: {:.1} % off{led}", cause.short, 100.0 * off))
        }
        _ => Verdict::differs(format!("{UNEXPLAINED}: {:.3} % off", 100.0 * off)),
    }
}

/// Why a mesh of ours is not the published one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cause {
    /// Counts and shapes agree to about this.
    pub(crate) tolerance: f64,
    /// Whether it explains more than that as well.
    pub(crate) beyond: bool,
    pub(crate) short: &'static str,
    pub(crate) long: &'static str,
}

/// What may move the numbers of an object; `None` for a surface that both programs compute alike.
pub(crate) fn cause(field: &FieldSection) -> Option<Cause> {
    match field {
        FieldSection::Mesh { .. } => {
            let reason = "another bunny mesh";
            Some(Cause { tolerance: OTHER_MESH, beyond: true, short: reason, long: reason })
        }
        FieldSection::Asteroid {} => Some(Cause {
            tolerance: OTHER_SINE,
            beyond: false,
            short: "another mathematics library",
            long: "the last bit of a sine differs between mathematics libraries, and the noise magnifies it",
        }),
        _ => None,
    }
}

/// Why the published moments of the aspect ratio are too low.
pub(crate) fn zero_ratios(degenerate: u64) -> String {
    format!(
        "{degenerate} degenerate triangles counted as ratio 0 there, left out of ours; led by edges whose length is \
         rounding noise"
    )
}

/// By how much our re-run of the published count of discarded triangles exceeds the true one.
fn excess(counts: &Counts) -> String {
    let published = counts.of_tetrahedra(|t| t.discarded_as_published).unwrap_or_default();
    published.saturating_sub(counts.discarded_triangles.unwrap_or_default()).to_string()
}

/// Why the published number of discarded triangles is too high. `excess` is of our own two counts: the published
/// number less our true one mixes it with whatever else moves the mesh.
pub(crate) fn double_count(excess: impl std::fmt::Display) -> String {
    format!(
        "our re-run of the published count exceeds the true one by {excess}: triangles counted twice when q1 = q2"
    )
}

/// Never "equal": two measured times that print alike do so by chance.
fn time_verdict(run: &BenchRun, published: f64, ours: f64) -> Verdict {
    if !run.differences.is_empty() {
        let model = run.machine.model.as_deref().unwrap_or("an unnamed CPU");
        let target = &run.target.name;
        return Verdict::not_comparable(format!("measured on {model}, published for {target}"));
    }
    let off = relative_difference(published, ours);
    match off <= 0.25 {
        true => Verdict::within("25 %", "another compiler and operating-system state on a matching machine"),
        false => Verdict::differs(format!("{:.0} % off on a matching machine", 100.0 * off)),
    }
}
