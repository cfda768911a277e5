//! The benchmark: counts, times, memory and the published aspect ratio of every configuration (appendix B).

use crate::budgets::budgets;
use crate::tables::design::{level, method_columns};
use isostudy_design::record::{MeshRecord, PeakMemory, Purpose};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::{MeshSet, discard_fraction, known};
use isostudy_inference::published_ratio;
use isostudy_table::{Cell, Table};
use isostudy_timing::stage_times::{StageTimes, conditions};

/// A column: name in CSV, heading, and its cell.
type Entry = (&'static str, &'static str, fn(&MeshRecord) -> Cell);

/// What is known of a mesh; after the first come the columns that tell the method.
const MESH_COLUMNS: &[Entry] = &[
    ("resolution", "Cubes", |m| match m.has_grid() {
        true => Cell::text(format!("{}x{}x{}", m.cells[0], m.cells[1], m.cells[2])),
        false => Cell::Missing,
    }),
    ("tetrahedra", "Tetrahedra", |m| maybe(m.counts.of_tetrahedra(|t| t.tetrahedra))),
    ("tetrahedra_evaluated", "Evaluated", |m| maybe(m.counts.of_tetrahedra(|t| t.tetrahedra_evaluated))),
    ("evaluated_fraction", "Evaluated fraction", |m| {
        let share = m.counts.tetrahedra.as_ref().and_then(|t| ratio(t.tetrahedra_evaluated, t.tetrahedra));
        Cell::number(share, 4)
    }),
    ("vertices", "Vertices", |m| Cell::count(m.counts.vertices)),
    ("triangles", "Triangles", |m| Cell::count(m.counts.triangles)),
    ("discarded_triangles", "Discarded", |m| maybe(m.counts.discarded_triangles)),
    ("discarded_as_published", "Discarded, as published", |m| {
        maybe(m.counts.of_tetrahedra(|t| t.discarded_as_published))
    }),
    ("discard_fraction", "Discard fraction", |m| {
        let discarded = m.counts.discarded_triangles;
        Cell::number(discarded.map(|count| discard_fraction(count, m.counts.triangles)), 4)
    }),
    ("discard_fraction_as_published", "as published", |m| {
        let discarded = m.counts.of_tetrahedra(|t| t.discarded_as_published);
        Cell::number(discarded.map(|count| discard_fraction(count, m.counts.triangles)), 4)
    }),
    ("stored_samples", "Samples stored", |m| maybe(m.counts.of_tetrahedra(|t| t.stored_samples))),
    ("needed_samples", "Samples needed", |m| maybe(m.counts.samples)),
    ("evaluations", "Samples taken", |m| maybe(m.counts.evaluations)),
    ("evaluations_per_vertex", "Samples taken per vertex", |m| {
        Cell::number(m.counts.evaluations_per_vertex(), 2)
    }),
    ("gradients", "Gradients taken", |m| maybe(m.counts.gradients)),
    ("stored_edges", "Edges stored", |m| maybe(m.counts.of_tetrahedra(|t| t.stored_edges))),
    ("needed_edges", "Edges needed", |m| maybe(m.counts.of_tetrahedra(|t| t.needed_edges))),
    ("sample_bytes", "Lattice bytes", |m| maybe(m.counts.of_tetrahedra(|t| t.sample_bytes))),
    ("edge_bytes", "Edge bytes", |m| maybe(m.counts.of_tetrahedra(|t| t.edge_bytes))),
    ("vertex_bytes", "Vertex bytes", |m| Cell::count(m.counts.vertex_bytes)),
    ("index_bytes", "Index bytes", |m| Cell::count(m.counts.index_bytes)),
    ("aspect_ratio_mean", "Aspect ratio mean", |m| {
        Cell::number(known(&m.quality.published_aspect_ratio, |d| d.mean), 3)
    }),
    ("aspect_ratio_sd", "Aspect ratio SD", |m| {
        Cell::number(known(&m.quality.published_aspect_ratio, |d| d.sd), 3)
    }),
    ("aspect_ratio_mean_as_published", "mean, as published", |m| {
        Cell::number(published_ratio::mean(&m.quality), 3)
    }),
    ("aspect_ratio_sd_as_published", "SD, as published", |m| {
        Cell::number(published_ratio::sd(&m.quality), 3)
    }),
    ("degenerate_triangles", "Degenerate", |m| Cell::count(m.quality.degenerate)),
];

/// As for meshes; seconds in full in CSV, microseconds' precision for people.
type TimeEntry = (&'static str, &'static str, fn(&StageTimes) -> Cell);

const TIME_COLUMNS: &[TimeEntry] = &[
    ("total_without_normals_s", "Total, s", |t| Cell::Number(t.total_without_normals_s(), 6)),
    ("total_without_normals_median_s", "Median, s", |t| Cell::Number(t.median_without_normals_s, 6)),
    ("allocation_s", "Allocation, s", |t| told_apart(t, t.allocation_s)),
    ("sampling_s", "Sampling, s", |t| Cell::Number(t.sampling_s, 6)),
    ("sampling_fraction", "Sampling fraction", |t| fraction(t, t.sampling_s)),
    ("vertex_s", "Vertex, s", |t| told_apart(t, t.vertex_s)),
    ("vertex_fraction", "Vertex fraction", |t| match t.has_stages {
        true => fraction(t, t.vertex_s),
        false => Cell::Missing,
    }),
    ("geometry_s", "Geometry, s", |t| Cell::Number(t.geometry_s, 6)),
    ("clustering_s", "Edge collapse within it, s", |t| told_apart(t, t.clustering_s)),
    ("geometry_fraction", "Geometry fraction", |t| fraction(t, t.geometry_s)),
    ("normals_s", "Normals, s", |t| told_apart(t, t.normals_s)),
];

/// Seconds of a stage; empty where stages were not told apart.
fn told_apart(times: &StageTimes, seconds: f64) -> Cell {
    Cell::number(times.has_stages.then_some(seconds), 6)
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

fn fraction(times: &StageTimes, stage_s: f64) -> Cell {
    let total = times.total_without_normals_s();
    Cell::number((total > 0.0).then(|| stage_s / total), 3)
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
    let mut blocks: Vec<(&str, Vec<&str>)> = BLOCKS
        .iter()
        .filter(|(name, _)| inputs.bench.is_some() || *name != "Times")
        .map(|(name, columns)| (*name, spelt(columns)))
        .collect();
    if study.file.benchmark.memory {
        let of_memory = blocks.iter_mut().find(|(name, _)| *name == "Memory").expect("a block");
        of_memory.1.push("extraction_memory_bytes");
    }
    let blocks: Vec<(&str, &[&str])> = blocks.iter().map(|(name, columns)| (*name, &columns[..])).collect();
    table.print_in_blocks(&blocks);
    Some(table)
}

/// The rows of the objects that `holds` picks, as one wide table.
pub fn of_objects(inputs: &Inputs<'_>, holds: impl Fn(usize) -> bool) -> Option<Table> {
    let meshes = MeshSet::of(inputs, Purpose::Benchmark);
    let study = inputs.study;
    let factors = method_columns(study);
    let headings: Vec<String> = factors.iter().map(|&factor| study.factor(factor).heading()).collect();
    let mut columns = vec![("id", "Id"), (MESH_COLUMNS[0].0, MESH_COLUMNS[0].1)];
    // Where the object's spacing does not hold for all.
    let matched = study.methods.iter().any(|method| method.budget.is_some());
    if matched {
        columns.push(("spacing", "Cube edge"));
    }
    columns.extend(factors.iter().zip(&headings).map(|(&f, heading)| (&*study.factor(f).name, &**heading)));
    columns.extend(MESH_COLUMNS[1..].iter().map(|&(name, heading, _)| (name, heading)));
    if inputs.bench.is_some() {
        columns.extend(TIME_COLUMNS.iter().map(|&(name, heading, _)| (name, heading)));
    }
    let has_memory = study.file.benchmark.memory;
    if has_memory {
        columns.push(("extraction_memory_bytes", "Memory beside the field, bytes"));
    }
    let mut table = Table::new("benchmark", "Benchmark", &columns);
    for (configuration, mesh) in meshes.in_order().filter(|(c, _)| holds(c.object)) {
        let mut row = vec![Cell::text(&mesh.id), (MESH_COLUMNS[0].2)(mesh)];
        row.extend(matched.then(|| Cell::number(mesh.has_grid().then_some(mesh.spacing), 5)));
        row.extend(factors.iter().map(|&factor| level(study, mesh.id.method, factor)));
        row.extend(MESH_COLUMNS[1..].iter().map(|(_, _, cell)| cell(mesh)));
        if let Some(run) = inputs.bench {
            let times = StageTimes::of(run, &configuration.id);
            let cell = |entry: &TimeEntry| times.as_ref().map_or(Cell::Missing, entry.2);
            row.extend(TIME_COLUMNS.iter().map(cell));
        }
        if has_memory {
            let peak =
                inputs.bench.and_then(|run| run.memory.iter().find(|peak| peak.id == configuration.id));
            row.push(maybe(peak.and_then(PeakMemory::of_extraction)));
        }
        table.push(row);
    }
    if let Some(run) = inputs.bench {
        table
            .notes
            .push(format!("{} Total and fractions leave the normals out, as published.", conditions(run)));
        if run.samples.iter().any(|sample| !sample.has_stages()) {
            let told =
                "A program does not tell its stages: all its work stands as geometry, normals included.";
            table.notes.push(told.into());
        }
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
    (!table.rows.is_empty()).then_some(table)
}
