//! One row per case of a sweep: its mesh, or its times. `docs/data.md` lists the columns.

use super::LongFrame;
use super::meshes::meshes_with;
use super::rows::Rows;
use crate::parquet_text::{ParquetError, parquet_as_csv};
use isostudy_design::Study;
use isostudy_design::record::{BenchRun, BenchSample, LoadWindow, MeshRecord, PeakMemory};
use isostudy_design::sweep::{Case, Sweep};
use isostudy_inference::cases::CaseQuantity;
use isostudy_statistics::interval::LEVEL;
use isostudy_statistics::median;
use polars::prelude::*;

/// A case, and its mesh; or why it has none.
#[derive(Debug, Clone)]
pub struct CaseMesh<'s> {
    /// Which.
    pub case: Case<'s>,
    /// What was measured.
    pub made: std::result::Result<MeshRecord, String>,
}

/// A case, and its times; or why it has none.
#[derive(Debug, Clone)]
pub struct CaseTimes<'s> {
    /// Which.
    pub case: Case<'s>,
    /// The run that measured it.
    pub made: std::result::Result<BenchRun, String>,
}

/// A file of cases has a column for each setting of the sweep, also where it does not apply to the pair: all files have the same columns.
///
/// # Panics
/// If the library refuses columns of one length, each with its own name.
pub fn case_meshes(study: &Study, sweep: &Sweep<'_>, cases: &[CaseMesh<'_>]) -> LongFrame {
    let mut rows = Rows::of(cases);
    describe(&mut rows, sweep, |of| &of.case, |of| of.made.as_ref().err());
    let records: Vec<MeshRecord> = cases.iter().filter_map(|of| of.made.clone().ok()).collect();
    let in_regions = study.file.objects.iter().any(|object| object.region.is_some());
    let measured = meshes_with(study, &records, in_regions).frame;
    // A case without a mesh has a row all the same.
    let mut made = 0;
    let places: IdxCa = cases
        .iter()
        .map(|of| {
            made += u32::from(of.made.is_ok());
            of.made.is_ok().then(|| made - 1)
        })
        .collect();
    let taken = ["id", "object", "method", "purpose"];
    let mut columns = rows.columns();
    for column in measured.columns() {
        let name = column.name().as_str();
        if !taken.contains(&name) && !name.starts_with("factor_") {
            columns.push(column.take(&places).expect("places of the records"));
        }
    }
    let frame = DataFrame::new(cases.len(), columns).expect("columns of one length, each with its own name");
    LongFrame { name: "cases", frame, texts: Vec::new() }
}

/// Median times with their intervals, the machine, and how busy it was.
pub fn case_times(sweep: &Sweep<'_>, cases: &[CaseTimes<'_>]) -> LongFrame {
    let mut rows = Rows::of(cases);
    describe(&mut rows, sweep, |of| &of.case, |of| of.made.as_ref().err());
    let run = |of: &CaseTimes<'_>| of.made.as_ref().ok().cloned();
    rows.text("machine", |of| Some(machine_name(&run(of)?)));
    rows.count("rounds", |of| Some(run(of)?.samples.len() as u64));
    rows.count("threads", |of| Some(run(of)?.threads.into()));
    let total = |of: &CaseTimes<'_>| median(run(of)?.samples.iter().map(|s| s.total_s).collect(), LEVEL);
    rows.number("median_s", |of| Some(total(of)?.median));
    rows.number("low_s", |of| Some(total(of)?.interval?.low));
    rows.number("high_s", |of| Some(total(of)?.interval?.high));
    for (name, stage) in STAGES {
        let of_stage = |of: &CaseTimes<'_>| {
            let samples = run(of)?.samples;
            // A program says how long all took.
            let told = samples.iter().all(BenchSample::has_stages);
            median(samples.iter().map(stage).collect(), LEVEL).filter(|_| told)
        };
        rows.number(name, |of| Some(of_stage(of)?.median));
    }
    rows.number("reference_s", |of| {
        let times = run(of)?.samples.iter().filter_map(|sample| sample.reference_s).collect();
        Some(median(times, LEVEL)?.median)
    });
    rows.count("extraction_bytes", |of| run(of)?.memory.first().and_then(PeakMemory::of_extraction));
    let most = |of: &CaseTimes<'_>, share: fn(&LoadWindow) -> f64| {
        run(of)?.load.iter().filter(|window| window.invocation.is_some()).map(share).reduce(f64::max)
    };
    rows.number("others", |of| most(of, |window| window.others));
    rows.number("steal", |of| most(of, |window| window.steal));
    LongFrame { name: "cases", frame: rows.frame(), texts: Vec::new() }
}

/// What a machine is called beside its times: the model of its processor, hardware threads and memory.
pub fn machine_name(run: &BenchRun) -> String {
    let machine = &run.machine;
    let model = machine.model.as_deref().unwrap_or("unknown processor");
    let memory = machine.memory_bytes.map(|bytes| format!(", {:.0} GiB", bytes as f64 / (1u64 << 30) as f64));
    format!("{model}, {} threads{}", machine.threads, memory.unwrap_or_default())
}

type Seconds = (&'static str, fn(&BenchSample) -> f64);

const STAGES: [Seconds; 6] = [
    ("allocation_s", |s| s.allocation_s),
    ("sampling_s", |s| s.sampling_s),
    ("vertex_s", |s| s.vertex_s),
    ("geometry_s", |s| s.geometry_s),
    ("clustering_s", |s| s.clustering_s),
    ("normals_s", |s| s.normals_s),
];

/// Which case it is, its settings, and why it was left out.
fn describe<'r, 's: 'r, T: 'r>(
    rows: &mut Rows<&'r T>,
    sweep: &Sweep<'s>,
    case: impl Fn(&T) -> &Case<'s>,
    left_out: impl Fn(&T) -> Option<&String>,
) {
    rows.count("case", |of| Some(case(of).number));
    rows.count("cells_per_axis", |of| Some(case(of).cells.into()));
    let count = sweep.section.settings.len();
    let names: Vec<String> = (0..count).map(|setting| sweep.name(setting)).collect();
    for (first, name) in names.iter().enumerate() {
        if names[..first].contains(name) {
            continue;
        }
        // Several settings of other objects or methods may be the same key.
        let same: Vec<usize> = (0..count).filter(|&setting| names[setting] == *name).collect();
        let values = || same.iter().flat_map(|&setting| sweep.values(setting));
        let chosen = |of: &T| {
            let settings = &case(of).settings;
            settings.iter().find(|chosen| same.contains(&chosen.setting)).map(|chosen| chosen.value.clone())
        };
        if values().all(|value| value.is_integer()) {
            rows.whole(name, |of| chosen(of)?.as_integer());
        } else if values().all(|value| value.is_integer() || value.is_float()) {
            rows.number(name, |of| {
                let value = chosen(of)?;
                value.as_float().or(value.as_integer().map(|whole| whole as f64))
            });
        } else if values().all(|value| value.is_bool()) {
            rows.truth(name, |of| chosen(of)?.as_bool());
        } else {
            rows.text(name, |of| {
                let value = chosen(of)?;
                Some(value.as_str().map_or_else(|| value.to_string(), str::to_owned))
            });
        }
    }
    rows.text("left_out", |of| left_out(of).cloned());
}

/// The measures that a sweep's sums take, with their columns.
const MEASURES: [(CaseQuantity, &str, bool); 5] = [
    (CaseQuantity::Samples, "samples", false),
    (CaseQuantity::Triangles, "triangles", true),
    (CaseQuantity::Distance, "distance_mean", true),
    (CaseQuantity::DistanceToMesh, "distance_to_mesh_mean", true),
    (CaseQuantity::RadiusRatio, "radius_ratio_mean", true),
];

/// A case's number, and its measures; `None` where it has no mesh.
pub type MeasuredCase = (u64, Option<Vec<(CaseQuantity, Option<f64>)>>);
/// A case's number, its machine, and its median time in seconds; `None` where it has none.
pub type TimedCase = (u64, Option<(String, f64)>);

/// What a sweep's sums take from a file of [`case_meshes`]: of the object's region where it has one.
///
/// # Errors
/// If it is no such file.
pub fn measured_cases(
    bytes: Vec<u8>,
    in_region: bool,
) -> std::result::Result<Vec<MeasuredCase>, ParquetError> {
    let columns: Vec<String> = MEASURES
        .iter()
        .map(
            |(_, name, of_region)| {
                if *of_region && in_region { format!("region_{name}") } else { (*name).into() }
            },
        )
        .collect();
    let wanted: Vec<&str> =
        ["case", "vertices"].into_iter().chain(columns.iter().map(String::as_str)).collect();
    let read = |cells: &[&str]| {
        let number = |cell: &str| cell.parse::<f64>().ok();
        let made = !cells[1].is_empty();
        let measures =
            || MEASURES.iter().zip(&cells[2..]).map(|((of, ..), cell)| (*of, number(cell))).collect();
        Some((cells[0].parse().ok()?, made.then(measures)))
    };
    rows_of(bytes, &wanted, read)
}

/// The same from a file of [`case_times`].
///
/// # Errors
/// If it is no such file.
pub fn timed_cases(bytes: Vec<u8>) -> std::result::Result<Vec<TimedCase>, ParquetError> {
    let read = |cells: &[&str]| {
        let time = cells[2].parse().ok().map(|seconds| (cells[1].to_owned(), seconds));
        Some((cells[0].parse().ok()?, time))
    };
    rows_of(bytes, &["case", "machine", "median_s"], read)
}

/// Rows with the wanted columns in this order.
fn rows_of<T>(
    bytes: Vec<u8>,
    wanted: &[&str],
    read: impl Fn(&[&str]) -> Option<T>,
) -> std::result::Result<Vec<T>, ParquetError> {
    let csv = parquet_as_csv(bytes, |name| wanted.contains(&name))?;
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let header = reader.headers().map_err(|error| ParquetError::Refused(error.to_string()))?.clone();
    let place = |name: &&str| {
        let missing = || ParquetError::Refused(format!("it has no column {name}"));
        header.iter().position(|known| known == *name).ok_or_else(missing)
    };
    let places: Vec<usize> = wanted.iter().map(place).collect::<std::result::Result<_, _>>()?;
    let mut rows = Vec::new();
    for row in reader.records() {
        let row = row.map_err(|error| ParquetError::Refused(error.to_string()))?;
        let cells: Vec<&str> = places.iter().map(|&place| row.get(place).unwrap_or_default()).collect();
        rows.push(read(&cells).ok_or(ParquetError::Damaged)?);
    }
    Ok(rows)
}

#[cfg(test)]
mod tests;
