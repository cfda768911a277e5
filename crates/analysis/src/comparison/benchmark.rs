//! The published benchmark, column by column, and the rules that explain differences.

use super::Compared;
use crate::inputs::Inputs;
use crate::mesh_set::{MeshSet, discard_fraction};
use crate::published_ratio;
use crate::stage_times::StageTimes;
use crate::verdict::{UNEXPLAINED, Verdict, prints_alike, relative_difference};
use design::config::FieldSection;
use design::published::BenchmarkRow;
use design::record::{BenchRun, Counts, MeshRecord, Purpose};
use design::{Arrangement, Study};

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
            Self::Discarded => mesh.counts.discarded_triangles != mesh.counts.discarded_as_published,
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
    ours: fn(&MeshRecord) -> f64,
}

const fn quantity(
    name: &'static str,
    decimals: usize,
    kind: Kind,
    published: fn(&BenchmarkRow) -> f64,
    ours: fn(&MeshRecord) -> f64,
) -> Quantity {
    Quantity { name, decimals, kind, published, ours }
}

const QUANTITIES: &[Quantity] = &[
    quantity("cells_x", 0, Kind::Lattice, |p| p.cells_x.into(), |m| m.cells[0].into()),
    quantity("cells_y", 0, Kind::Lattice, |p| p.cells_y.into(), |m| m.cells[1].into()),
    quantity("cells_z", 0, Kind::Lattice, |p| p.cells_z.into(), |m| m.cells[2].into()),
    quantity("tetrahedra", 0, Kind::Lattice, |p| p.tetrahedra as f64, |m| m.counts.tetrahedra as f64),
    quantity(
        "stored_samples",
        0,
        Kind::Lattice,
        |p| p.stored_samples as f64,
        |m| m.counts.stored_samples as f64,
    ),
    quantity("stored_edges", 0, Kind::Lattice, |p| p.stored_edges as f64, |m| m.counts.stored_edges as f64),
    quantity("sample_bytes", 0, Kind::Lattice, |p| p.sample_bytes as f64, |m| m.counts.sample_bytes as f64),
    quantity("edge_bytes", 0, Kind::Lattice, |p| p.edge_bytes as f64, |m| m.counts.edge_bytes as f64),
    quantity(
        "needed_samples",
        0,
        Kind::Needed(samples_with_the_wrong_sign),
        |p| p.needed_samples as f64,
        |m| m.counts.needed_samples as f64,
    ),
    quantity(
        "needed_edges",
        0,
        Kind::Needed(edges_with_the_wrong_sign),
        |p| p.needed_edges as f64,
        |m| m.counts.needed_edges as f64,
    ),
    quantity(
        "tetrahedra_evaluated",
        0,
        Kind::Surface,
        |p| p.tetrahedra_evaluated as f64,
        |m| m.counts.tetrahedra_evaluated as f64,
    ),
    quantity("vertices", 0, Kind::Surface, |p| p.vertices as f64, |m| m.counts.vertices as f64),
    quantity("triangles", 0, Kind::Surface, |p| p.triangles as f64, |m| m.counts.triangles as f64),
    quantity("vertex_bytes", 0, Kind::Surface, |p| p.vertex_bytes as f64, |m| m.counts.vertex_bytes as f64),
    quantity("index_bytes", 0, Kind::Surface, |p| p.index_bytes as f64, |m| m.counts.index_bytes as f64),
    quantity(
        "discarded_as_published",
        0,
        Kind::Surface,
        |p| p.discarded_as_published as f64,
        |m| m.counts.discarded_as_published as f64,
    ),
    quantity(
        "discarded_triangles",
        0,
        Kind::Discarded,
        |p| p.discarded_as_published as f64,
        |m| m.counts.discarded_triangles as f64,
    ),
    quantity(
        "discard_fraction_as_published",
        6,
        Kind::Surface,
        |p| p.discard_fraction,
        |m| discard_fraction(m.counts.discarded_as_published, m.counts.triangles),
    ),
    quantity(
        "discard_fraction",
        6,
        Kind::Discarded,
        |p| p.discard_fraction,
        |m| discard_fraction(m.counts.discarded_triangles, m.counts.triangles),
    ),
    quantity("area_mean", 6, Kind::Surface, |p| p.area_mean, |m| m.quality.area.mean),
    quantity("area_sd", 6, Kind::Surface, |p| p.area_sd, |m| m.quality.area.sd),
    quantity("area_max", 6, Kind::Surface, |p| p.area_max, |m| m.quality.area.max),
    quantity(
        "aspect_ratio_mean_as_published",
        6,
        Kind::Ratio,
        |p| p.aspect_ratio_mean,
        |m| published_ratio::mean(&m.quality),
    ),
    quantity(
        "aspect_ratio_sd_as_published",
        6,
        Kind::Ratio,
        |p| p.aspect_ratio_sd,
        |m| published_ratio::sd(&m.quality),
    ),
    quantity(
        "aspect_ratio_max",
        6,
        Kind::Ratio,
        |p| p.aspect_ratio_max,
        |m| m.quality.published_aspect_ratio.max,
    ),
    quantity(
        "aspect_ratio_mean",
        6,
        Kind::RatioWithoutDegenerate,
        |p| p.aspect_ratio_mean,
        |m| m.quality.published_aspect_ratio.mean,
    ),
    quantity(
        "aspect_ratio_sd",
        6,
        Kind::RatioWithoutDegenerate,
        |p| p.aspect_ratio_sd,
        |m| m.quality.published_aspect_ratio.sd,
    ),
];

type Stage = (&'static str, fn(&BenchmarkRow) -> f64, fn(&StageTimes) -> f64);

const STAGES: &[Stage] = &[
    ("allocation_s", |p| p.allocation_s, |t| t.allocation_s),
    ("sampling_s", |p| p.sampling_s, |t| t.sampling_s),
    ("vertex_s", |p| p.vertex_s, |t| t.vertex_s),
    ("geometry_s", |p| p.geometry_s, |t| t.geometry_s),
    ("normals_s", |p| p.normals_s, |t| t.normals_s),
    ("total_without_normals_s", |p| p.total_without_normals_s, |t| t.total_without_normals_s()),
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
                ours: Some(ours),
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
    ours: f64,
) -> Verdict {
    if prints_alike(published, ours, quantity.decimals) {
        return Verdict::Equal;
    }
    if mesh.cells != [row.cells_x, row.cells_y, row.cells_z] {
        let [x, y, z] = mesh.cells;
        return Verdict::not_comparable(format!("this study has {x}x{y}x{z} cubes"));
    }
    match quantity.kind {
        Kind::Needed(wrong_sign)
            if row.id.method.arrangement == Arrangement::SimpleCubic && published == wrong_sign(row) =>
        {
            return Verdict::differs("the published formula has a wrong sign");
        }
        Kind::Discarded => {
            if let Some(reason) = double_count(&mesh.counts) {
                return Verdict::differs(reason);
            }
        }
        Kind::RatioWithoutDegenerate if mesh.quality.degenerate > 0 => {
            return Verdict::differs(zero_ratios(mesh.quality.degenerate));
        }
        _ => {}
    }
    // A number of few printed digits is only known to half a unit.
    let half_unit = 0.5 * 10_f64.powi(-(quantity.decimals as i32));
    let off = match quantity.decimals {
        0 => relative_difference(published, ours),
        _ => ((ours - published).abs() - half_unit) / published.abs(),
    };
    let is_ratio = matches!(quantity.kind, Kind::Ratio | Kind::RatioWithoutDegenerate);
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
    match object.map(|object| &object.field) {
        Some(FieldSection::Mesh { .. }) if off <= OTHER_MESH => {
            Verdict::within(percent(OTHER_MESH), "another bunny mesh")
        }
        Some(FieldSection::Mesh { .. }) if is_ratio && published > 5.0 => Verdict::differs(format!(
            "another bunny mesh: {:.1} % off; led by the thinnest slivers",
            100.0 * off
        )),
        Some(FieldSection::Mesh { .. }) => {
            Verdict::differs(format!("another bunny mesh: {:.1} % off", 100.0 * off))
        }
        Some(FieldSection::Asteroid) if off <= OTHER_SINE => Verdict::within(
            percent(OTHER_SINE),
            "the last bit of a sine differs between mathematics libraries, and the noise magnifies it",
        ),
        _ => Verdict::differs(format!("{UNEXPLAINED}: {:.3} % off", 100.0 * off)),
    }
}

/// Why the published moments of the aspect ratio are too low.
pub(crate) fn zero_ratios(degenerate: u64) -> String {
    format!(
        "{degenerate} degenerate triangles counted as ratio 0 there, left out of ours; led by edges whose length is \
         rounding noise"
    )
}

/// Why the published number of discarded triangles is too high; `None` if it is not.
pub(crate) fn double_count(counts: &Counts) -> Option<String> {
    let excess = counts.discarded_as_published.saturating_sub(counts.discarded_triangles);
    (excess > 0).then(|| format!("over-counted by {excess}: triangles counted twice when q1 = q2"))
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
