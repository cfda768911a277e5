//! The benchmark: counts, times, memory and the published aspect ratio of every configuration (appendix B).

use crate::budgets::budgets;
use crate::tables::design::{method_columns, with_factors};
use crate::wants::busy;
use isostudy_design::record::{BenchRun, MeshRecord, PeakMemory, Purpose};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::{MeshSet, discard_fraction, known};
use isostudy_inference::published_ratio;
use isostudy_table::{Cell, Columns, Table};
use isostudy_timing::stage_times::{StageTimes, conditions};

/// A mesh, its times, and what was resident when it was extracted.
struct Row<'a> {
    mesh: &'a MeshRecord,
    times: Option<StageTimes>,
    peak_bytes: Option<u64>,
}

/// What is known of a mesh; before stand the columns that tell the method.
fn with_counts(columns: Columns<Row<'_>>) -> Columns<Row<'_>> {
    columns
        .column("tetrahedra", "Tetrahedra", |of| maybe(of.mesh.counts.of_tetrahedra(|t| t.tetrahedra)))
        .column("tetrahedra_evaluated", "Evaluated", |of| {
            maybe(of.mesh.counts.of_tetrahedra(|t| t.tetrahedra_evaluated))
        })
        .column("evaluated_fraction", "Evaluated fraction", |of| {
            let share =
                of.mesh.counts.tetrahedra.as_ref().and_then(|t| ratio(t.tetrahedra_evaluated, t.tetrahedra));
            Cell::number(share, 4)
        })
        .column("vertices", "Vertices", |of| Cell::count(of.mesh.counts.vertices))
        .column("triangles", "Triangles", |of| Cell::count(of.mesh.counts.triangles))
        .column("discarded_triangles", "Discarded", |of| maybe(of.mesh.counts.discarded_triangles))
        .column("discarded_as_published", "Discarded, as published", |of| {
            maybe(of.mesh.counts.of_tetrahedra(|t| t.discarded_as_published))
        })
        .column("discard_fraction", "Discard fraction", |of| {
            let discarded = of.mesh.counts.discarded_triangles;
            Cell::number(discarded.map(|count| discard_fraction(count, of.mesh.counts.triangles)), 4)
        })
        .column("discard_fraction_as_published", "as published", |of| {
            let discarded = of.mesh.counts.of_tetrahedra(|t| t.discarded_as_published);
            Cell::number(discarded.map(|count| discard_fraction(count, of.mesh.counts.triangles)), 4)
        })
        .column("stored_samples", "Samples stored", |of| {
            maybe(of.mesh.counts.of_tetrahedra(|t| t.stored_samples))
        })
        .column("needed_samples", "Samples needed", |of| maybe(of.mesh.counts.samples))
        .column("evaluations", "Samples taken", |of| maybe(of.mesh.counts.evaluations))
        .column("evaluations_per_vertex", "Samples taken per vertex", |of| {
            Cell::number(of.mesh.counts.evaluations_per_vertex(), 2)
        })
        .column("gradients", "Gradients taken", |of| maybe(of.mesh.counts.gradients))
        .column("stored_edges", "Edges stored", |of| maybe(of.mesh.counts.of_tetrahedra(|t| t.stored_edges)))
        .column("needed_edges", "Edges needed", |of| maybe(of.mesh.counts.of_tetrahedra(|t| t.needed_edges)))
        .quantity("sample_bytes", "Lattice bytes", "bytes", |of| {
            maybe(of.mesh.counts.of_tetrahedra(|t| t.sample_bytes))
        })
        .quantity("edge_bytes", "Edge bytes", "bytes", |of| {
            maybe(of.mesh.counts.of_tetrahedra(|t| t.edge_bytes))
        })
        .quantity("vertex_bytes", "Vertex bytes", "bytes", |of| Cell::count(of.mesh.counts.vertex_bytes))
        .quantity("index_bytes", "Index bytes", "bytes", |of| Cell::count(of.mesh.counts.index_bytes))
        .column("aspect_ratio_mean", "Aspect ratio mean", |of| {
            Cell::number(known(&of.mesh.quality.published_aspect_ratio, |d| d.mean), 3)
        })
        .column("aspect_ratio_sd", "Aspect ratio SD", |of| {
            Cell::number(known(&of.mesh.quality.published_aspect_ratio, |d| d.sd), 3)
        })
        .column("aspect_ratio_mean_as_published", "mean, as published", |of| {
            Cell::number(published_ratio::mean(&of.mesh.quality), 3)
        })
        .column("aspect_ratio_sd_as_published", "SD, as published", |of| {
            Cell::number(published_ratio::sd(&of.mesh.quality), 3)
        })
        .column("degenerate_triangles", "Degenerate", |of| Cell::count(of.mesh.quality.degenerate))
}

/// Seconds in full in CSV, microseconds' precision for people.
fn with_times(columns: Columns<Row<'_>>) -> Columns<Row<'_>> {
    fn seconds(of: &Row<'_>, seconds: fn(&StageTimes) -> f64) -> Cell {
        Cell::number(of.times.as_ref().map(seconds), 6)
    }
    /// Empty where stages were not told apart.
    fn told_apart(of: &Row<'_>, seconds: fn(&StageTimes) -> f64) -> Cell {
        Cell::number(of.times.as_ref().filter(|times| times.has_stages).map(seconds), 6)
    }
    fn fraction(of: &Row<'_>, seconds: fn(&StageTimes) -> f64) -> Cell {
        let times = of.times.as_ref().filter(|times| times.total_without_normals_s() > 0.0);
        Cell::number(times.map(|times| seconds(times) / times.total_without_normals_s()), 3)
    }
    columns
        .quantity("total_without_normals_s", "Total, {}", "s", |of| {
            seconds(of, StageTimes::total_without_normals_s)
        })
        .quantity("total_without_normals_median_s", "Median, {}", "s", |of| {
            seconds(of, |t| t.median_without_normals_s)
        })
        .quantity("allocation_s", "Allocation, {}", "s", |of| told_apart(of, |t| t.allocation_s))
        .quantity("sampling_s", "Sampling, {}", "s", |of| seconds(of, |t| t.sampling_s))
        .column("sampling_fraction", "Sampling fraction", |of| fraction(of, |t| t.sampling_s))
        .quantity("vertex_s", "Vertex, {}", "s", |of| told_apart(of, |t| t.vertex_s))
        .column("vertex_fraction", "Vertex fraction", |of| match &of.times {
            Some(times) if times.has_stages => fraction(of, |t| t.vertex_s),
            _ => Cell::Missing,
        })
        .quantity("geometry_s", "Geometry, {}", "s", |of| seconds(of, |t| t.geometry_s))
        .quantity("clustering_s", "Edge collapse within it, {}", "s", |of| told_apart(of, |t| t.clustering_s))
        .column("geometry_fraction", "Geometry fraction", |of| fraction(of, |t| t.geometry_s))
        .quantity("normals_s", "Normals, {}", "s", |of| told_apart(of, |t| t.normals_s))
}

/// What finishing takes, where some method is finished; it is in the totals.
fn with_finishing(columns: Columns<Row<'_>>) -> Columns<Row<'_>> {
    columns.quantity("finishing_s", "Finishing, {}", "s", |of| {
        Cell::number(of.times.as_ref().map(|times| times.finishing_s).filter(|seconds| *seconds > 0.0), 6)
    })
}

/// Stands for the columns that tell the method.
const FACTORS: &str = "factors";

/// The four blocks that the paper prints.
const BLOCKS: &[(&str, &[&str])] = &[
    (
        "Resolution and counts",
        &[
            "id",
            "resolution",
            "spacing",
            FACTORS,
            "tetrahedra",
            "vertices",
            "triangles",
            "discarded_triangles",
            "discarded_as_published",
        ],
    ),
    (
        "Times",
        &[
            "id",
            "total_without_normals_s",
            "total_without_normals_median_s",
            "sampling_s",
            "sampling_fraction",
            "vertex_s",
            "vertex_fraction",
            "geometry_s",
            "clustering_s",
            "geometry_fraction",
        ],
    ),
    ("Memory", &["id", "sample_bytes", "edge_bytes", "vertex_bytes", "index_bytes"]),
    (
        "Work and shape",
        &[
            "id",
            "tetrahedra_evaluated",
            "evaluated_fraction",
            "evaluations_per_vertex",
            "discard_fraction",
            "discard_fraction_as_published",
            "aspect_ratio_mean",
            "aspect_ratio_sd",
            "degenerate_triangles",
            "aspect_ratio_mean_as_published",
            "aspect_ratio_sd_as_published",
        ],
    ),
];

/// A count; empty where the method has none.
fn maybe(count: Option<u64>) -> Cell {
    count.map_or(Cell::Missing, Cell::count)
}

fn ratio(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

/// The whole benchmark, one row a configuration.
pub(super) fn benchmark(inputs: &Inputs<'_>) -> Option<Table> {
    let mut table = of_objects(inputs, |_| true)?;
    let study = inputs.study;
    let factors: Vec<&str> =
        method_columns(study).into_iter().map(|factor| &*study.factor(factor).name).collect();
    let spelt = |names: &[&'static str]| -> Vec<&str> {
        let of = |name: &&'static str| if *name == FACTORS { factors.clone() } else { vec![*name] };
        names.iter().flat_map(of).collect()
    };
    let blocks = BLOCKS.iter().filter(|(name, _)| inputs.bench.is_some() || *name != "Times");
    let parts = blocks.map(|(name, columns)| {
        let mut columns = spelt(columns);
        if *name == "Times" && inputs.bench.is_some_and(is_finished) {
            columns.push("finishing_s");
        }
        if study.file.benchmark.memory && *name == "Memory" {
            columns.push("extraction_memory_bytes");
        }
        table.block(name, &columns)
    });
    table.parts = parts.collect();
    Some(table)
}

/// Whether some method of a run is finished.
fn is_finished(run: &BenchRun) -> bool {
    run.samples.iter().any(|sample| sample.finishing_s > 0.0)
}

/// The rows of the objects that `holds` picks, as one wide table.
pub fn of_objects(inputs: &Inputs<'_>, holds: impl Fn(usize) -> bool) -> Option<Table> {
    let meshes = MeshSet::of(inputs, Purpose::Benchmark);
    let study = inputs.study;
    let rows = meshes.in_order().filter(|(c, _)| holds(c.object)).map(|(configuration, mesh)| {
        let (run, id) = (inputs.bench, &configuration.id);
        let peak = run.and_then(|run| run.memory.iter().find(|peak| peak.id == *id));
        let peak_bytes = peak.and_then(PeakMemory::of_extraction);
        Row { mesh, times: run.and_then(|run| StageTimes::of(run, id)), peak_bytes }
    });
    // Where the object's spacing does not hold for all.
    let matched = study.methods.iter().any(|method| method.budget.is_some());
    let columns = Columns::over(rows)
        .column("id", "Id", |of| Cell::text(&of.mesh.id))
        .column("resolution", "Cubes", |of| match of.mesh.has_grid() {
            true => Cell::text(format!("{}x{}x{}", of.mesh.cells[0], of.mesh.cells[1], of.mesh.cells[2])),
            false => Cell::Missing,
        })
        .columns_if(matched, |all| {
            all.column("spacing", "Cube edge", |of| {
                Cell::number(of.mesh.has_grid().then_some(of.mesh.spacing), 5)
            })
        });
    let columns = with_factors(columns, study, method_columns(study), |of| of.mesh.id.method);
    let mut table = with_counts(columns)
        .columns_if(inputs.bench.is_some(), with_times)
        .columns_if(inputs.bench.is_some_and(is_finished), with_finishing)
        .columns_if(study.file.benchmark.memory, |all| {
            all.quantity("extraction_memory_bytes", "Memory beside the field, {}", "bytes", |of| {
                maybe(of.peak_bytes)
            })
        })
        .into_table("benchmark", "Benchmark");
    if let Some(run) = inputs.bench {
        table
            .notes
            .push(format!("{} Total and fractions leave the normals out, as published.", conditions(run)));
        if run.samples.iter().any(|sample| !sample.has_stages()) {
            let told =
                "A program does not tell its stages: all its work stands as geometry, normals included.";
            table.notes.push(told.into());
        }
        table.notes.extend(busy(inputs));
    }
    table.notes.push(
        "Discarded, as published, counts some triangles twice; discarded is the true number. The aspect ratio is \
         the published one, longer over shorter of the two edges at a triangle's first corner; degenerate triangles \
         (zero area or a zero-length edge) are left out of it, and counted as 0 in the columns as published."
            .into(),
    );
    table.notes.push(
        "Samples taken: how often the field was called for a value, whatever for; what it said of whole boxes is not counted, nor are \
         gradients."
            .into(),
    );
    table.notes.extend(budgets(inputs));
    table.unless_empty()
}
