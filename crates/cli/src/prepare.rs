//! From a study's words to the extractor's: methods, grids, isovalues. The one place where `design` meets `extract`.

use crate::fields::Fields;
use crate::memory::Limit;
use anyhow::{Context, Result, bail};
use bench::Prepared;
use design::config::{ObjectSection, SweepSection};
use design::record::Purpose;
use design::{Configuration, MethodId, Study};
use extract::{Execution, Grid, Method, Positions, Tetrahedra};
use glam::Vec3;
use mesh::Bounds;

/// At which resolution, and for what.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Wanted {
    /// At the object's own spacing for the purpose.
    For(Purpose),
    /// So many cells along the longest side of the object's volume, for this purpose.
    Cells(u32, Purpose),
    /// This spacing, for this purpose.
    Spacing(f64, Purpose),
}

impl Wanted {
    fn purpose(self) -> Purpose {
        match self {
            Self::For(purpose) | Self::Cells(_, purpose) | Self::Spacing(_, purpose) => purpose,
        }
    }

    /// The cube edge for an object.
    pub(crate) fn spacing(self, object: &ObjectSection) -> f64 {
        match self {
            Self::For(Purpose::Benchmark | Purpose::Indexed) => object.benchmark_spacing,
            Self::For(Purpose::Stimulus) => object.stimulus_spacing,
            Self::Cells(cells, _) => {
                let longest = (0..3).map(|axis| object.max[axis] - object.min[axis]).fold(0.0, f64::max);
                longest / f64::from(cells)
            }
            Self::Spacing(spacing, _) => spacing,
        }
    }
}

/// A configuration, ready to extract.
///
/// # Errors
/// If its field cannot be made, or its recipe is none; the study, the key and what is allowed are named.
pub(crate) fn prepare<'a>(
    study: &Study,
    fields: &'a Fields<'_>,
    configuration: &Configuration,
    wanted: Wanted,
) -> Result<Prepared<'a>> {
    let object = study.object(configuration);
    Ok(Prepared {
        field: fields.get(configuration.object)?,
        method: method(study, configuration.id.method, wanted.purpose())?,
        grid: grid(object, wanted.spacing(object)),
        isovalue: object.isovalue as f32,
    })
}

/// What a study's method is to the extractor. Meshes made for [`Purpose::Indexed`] have indexed positions whatever the study says.
///
/// # Errors
/// If its recipe is none, naming file, key and what is allowed.
pub(crate) fn method(study: &Study, id: MethodId, purpose: Purpose) -> Result<Method> {
    let recipe = &study.method(id).recipe;
    let mut keys = recipe.settings.clone();
    keys.insert("kind".into(), recipe.kind.as_str().into());
    let method = toml::Value::Table(keys).try_into().with_context(|| {
        let key = match study.file.methods.iter().position(|section| section.id == id) {
            Some(i) => format!("methods[{i}].recipe"),
            None => "extraction".to_owned(),
        };
        format!("{}: {key}", study.path.display())
    })?;
    Ok(match (method, purpose) {
        (Method::Tetrahedra(of), Purpose::Indexed) => {
            Method::Tetrahedra(Tetrahedra { positions: Positions::Indexed, ..of })
        }
        (method, _) => method,
    })
}

/// Whether some method sums its positions up, so that meshes with indexed ones are measured beside.
pub(crate) fn sums_positions(study: &Study) -> Result<bool> {
    for of in &study.methods {
        if let Method::Tetrahedra(of) = method(study, of.id, Purpose::Benchmark)?
            && of.positions != Positions::Indexed
        {
            return Ok(true);
        }
    }
    Ok(false)
}

/// An object's volume, filled with cubes.
pub(crate) fn grid(object: &ObjectSection, spacing: f64) -> Grid {
    let corner = |p: [f64; 3]| Vec3::from_array(p.map(|x| x as f32));
    let bounds = Bounds { min: corner(object.min), max: corner(object.max) };
    Grid { bounds, spacing: spacing as f32 }
}

/// Checks that every method goes with every grid of the study, and that what the extractor holds of it fits into memory.
///
/// # Errors
/// The first that does not, naming file, key and limit.
pub(crate) fn check(study: &Study, machine_bytes: Option<u64>) -> Result<()> {
    let file = study.path.display();
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let execution = Execution { threads: cores.max(study.file.benchmark.threads as usize) };
    let check = |key: String, object: &ObjectSection, id: MethodId, wanted: Wanted| -> Result<()> {
        let spacing = wanted.spacing(object);
        let method = method(study, id, wanted.purpose())?;
        check_memory(study, &method, &grid(object, spacing), &execution, machine_bytes)
            .with_context(|| format!("{file}: {key} = {spacing:?}"))
    };
    for (i, object) in study.file.objects.iter().enumerate() {
        for (purpose, name) in
            [(Purpose::Benchmark, "benchmark_spacing"), (Purpose::Stimulus, "stimulus_spacing")]
        {
            for method in &study.methods {
                check(format!("objects[{i}].{name}"), object, method.id, Wanted::For(purpose))?;
            }
        }
    }
    for (i, still) in study.file.stills.iter().enumerate() {
        let named = study.configurations.iter().find(|c| c.id == still.configuration);
        let object = study.object(named.expect("checked when the study was read"));
        let wanted = Wanted::Spacing(still.spacing, Purpose::Stimulus);
        check(format!("stills[{i}].spacing"), object, still.configuration.method, wanted)?;
    }
    Ok(())
}

/// Checks every grid of a sweep, as [`check`].
///
/// # Errors
/// The first that cannot be filled or does not fit, naming file, key and limit.
pub(crate) fn check_sweep(study: &Study, section: &SweepSection, machine_bytes: Option<u64>) -> Result<()> {
    let threads = section.threads.iter().copied().max().unwrap_or(1) as usize;
    for (i, &cells) in section.cells.iter().enumerate() {
        for object in study.file.objects.iter().filter(|object| section.objects.contains(&object.id)) {
            let wanted = Wanted::Cells(cells, Purpose::Indexed);
            for of in &study.methods {
                let method = method(study, of.id, Purpose::Indexed)?;
                let grid = grid(object, wanted.spacing(object));
                check_memory(study, &method, &grid, &Execution { threads }, machine_bytes).with_context(
                    || format!("{}: benchmark.sweep.cells[{i}] = {cells}", study.path.display()),
                )?;
            }
        }
    }
    Ok(())
}

/// Checks that a method goes with a grid, and that what the extractor holds of it fits into what the study allows and the machine
/// has.
///
/// # Errors
/// If it does not, naming the limit.
pub(crate) fn check_memory(
    study: &Study,
    method: &Method,
    grid: &Grid,
    execution: &Execution,
    machine_bytes: Option<u64>,
) -> Result<()> {
    let allowed = (study.file.limits.memory_gib * GIB) as u64;
    let limit = match machine_bytes {
        Some(machine) if machine < allowed => Limit { bytes: machine, name: "this machine has" },
        _ => Limit { bytes: allowed, name: "limits.memory_gib allows" },
    };
    check_limit(method, grid, execution, 0, limit)
}

/// Checks that a method goes with a grid, and that what the extractor holds of it, beside what the field holds already, is not more
/// than a limit.
///
/// # Errors
/// If it is, naming the limit.
pub(crate) fn check_limit(
    method: &Method,
    grid: &Grid,
    execution: &Execution,
    held: u64,
    limit: Limit,
) -> Result<()> {
    method.check(grid)?;
    let needed = method.memory_bytes(grid, execution)?;
    if needed.saturating_add(held) > limit.bytes {
        let (needed, allowed) = (gibibytes(needed), gibibytes(limit.bytes));
        let beside =
            if held > 0 { format!(" beside the volume's {}", gibibytes(held)) } else { String::new() };
        let what = match method {
            Method::Tetrahedra(of) => format!("the {} lattice", of.arrangement),
            _ => "the grid".into(),
        };
        bail!("{what} needs {needed}{beside}, {} {allowed}", limit.name);
    }
    Ok(())
}

fn gibibytes(bytes: u64) -> String {
    let gib = bytes as f64 / GIB;
    if gib < 1.0 { format!("{:.1} MiB", 1024.0 * gib) } else { format!("{gib:.1} GiB") }
}

const GIB: f64 = (1u64 << 30) as f64;

#[cfg(test)]
mod tests {
    use super::*;
    use extract::{Placement, Topology};
    use std::path::Path;

    /// The paper's file with one passage replaced.
    fn paper_with(from: &str, to: &str) -> Result<Tetrahedra> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/paper.toml");
        let text = std::fs::read_to_string(&path)?;
        assert!(text.contains(from), "{from} is not in {}", path.display());
        let study = Study::parse(&text.replacen(from, to, 1), &path)?;
        let Method::Tetrahedra(of) = method(&study, study.methods[0].id, Purpose::Benchmark)? else {
            bail!("no tetrahedra");
        };
        Ok(of)
    }

    #[test]
    fn what_is_left_out_has_the_extractors_default() {
        let topology = |to| paper_with("topology = \"published\"", to).unwrap().topology;
        assert_eq!(
            (topology("topology = \"published\""), topology("")),
            (Topology::Published, Topology::Guarded)
        );
        let positions = |to| paper_with("accumulation_chunks = 16", to).unwrap().positions;
        assert_eq!(positions("accumulation_chunks = 16"), Positions::Accumulated { chunks: 16 });
        assert_eq!(positions(""), Positions::Accumulated { chunks: 1 });
        let placement = |to| paper_with("placement = \"mean-of-crossings\"", to).unwrap().placement;
        assert_eq!(
            (placement(""), placement("placement = \"relaxed\"")),
            (Placement::MeanOfCrossings, Placement::Relaxed)
        );
        // Chunks say nothing where positions follow from indices.
        let indexed = paper_with("positions = \"accumulated\"", "positions = \"indexed\"").unwrap();
        assert_eq!(indexed.positions, Positions::Indexed);
    }

    #[test]
    fn what_no_recipe_has_is_refused_with_what_there_is() {
        let told = |from, to| format!("{:#}", paper_with(from, to).unwrap_err());
        let error = told("placement = \"mean-of-crossings\"", "placement = \"nearest\"");
        for part in
            ["paper.toml: extraction", "nearest", "mean-of-crossings", "curvature-weighted", "relaxed"]
        {
            assert!(error.contains(part), "{error}");
        }
        let error = told("refine_crossings = false", "refine_crossings = 4");
        assert!(error.contains("4") && error.contains("boolean"), "{error}");
        let error = told("refine_crossings = false", "refine_crossing = false");
        assert!(error.contains("refine_crossing") && error.contains("refine_crossings"), "{error}");
    }
}
