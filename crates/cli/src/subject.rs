//! From a study's words to the extractor's: fields, lattices, settings. The one place where `design` meets `extract`.

use crate::memory::Limit;
use crate::mesh_file;
use crate::store::sha256;
use anyhow::{Context, Result, bail};
use design::config::{
    FieldSection, MeshSourceSection, ObjectSection, Placement, Positions, SweepSection, Topology,
};
use design::record::Purpose;
use design::{Arrangement, Clustering, Configuration, Study};
use extract::{Execution, ExtractSettings, Lattice};
use field::ScalarField;
use glam::{DVec3, Vec3};
use mesh::{Bounds, TriangleMesh};
use std::path::PathBuf;
use std::sync::OnceLock;

/// The scalar fields of a study's objects, each made when it is first asked for.
pub(crate) struct Fields<'a> {
    study: &'a Study,
    made: Vec<OnceLock<Box<dyn ScalarField + Send>>>,
}

impl<'a> Fields<'a> {
    pub(crate) fn new(study: &'a Study) -> Self {
        let made = study.file.objects.iter().map(|_| OnceLock::new()).collect();
        Self { study, made }
    }

    /// The field of an object. Fields are made from one thread, so none is made twice.
    ///
    /// # Errors
    /// If a mesh cannot be read, is not the one the study names, or is not closed.
    pub(crate) fn get(&self, object: usize) -> Result<&dyn ScalarField> {
        if self.made[object].get().is_none() {
            let section = &self.study.file.objects[object];
            let field = make_field(self.study, &section.field)
                .with_context(|| format!("{}: objects[{object}].field", self.study.path.display()))?;
            let _ = self.made[object].set(field);
        }
        Ok(&**self.made[object].get().expect("made above"))
    }
}

fn make_field(study: &Study, section: &FieldSection) -> Result<Box<dyn ScalarField + Send>> {
    Ok(match section {
        FieldSection::Sphere { radius } => Box::new(field::Sphere { radius: *radius as f32 }),
        FieldSection::Asteroid => Box::new(field::Asteroid::default()),
        FieldSection::Mesh { sources } => {
            let (source, path) = present_source(study, sources)?;
            let mesh = read_placed(source, &path).with_context(|| path.display().to_string())?;
            Box::new(field::MeshDistance::try_new(&mesh).with_context(|| path.display().to_string())?)
        }
    })
}

/// The first of the sources that is there.
fn present_source<'s>(
    study: &Study,
    sources: &'s [MeshSourceSection],
) -> Result<(&'s MeshSourceSection, PathBuf)> {
    let resolved = sources.iter().map(|source| (source, study.resolve(&source.file)));
    let mut present = resolved.filter(|(_, path)| path.is_file());
    let missing = || {
        let files =
            |sources: &[MeshSourceSection]| sources.iter().map(|s| s.file.clone()).collect::<Vec<_>>();
        let this = |object: &ObjectSection| matches!(&object.field, FieldSection::Mesh { sources: of } if files(of) == files(sources));
        let object = study.file.objects.iter().position(this).unwrap_or_default();
        let path = sources.first().map_or_else(PathBuf::new, |first| study.resolve(&first.file));
        format!(
            "{}: objects[{object}].field.sources[0].file names {}: no such file; `make bunny` (scripts/fetch-bunny.sh) \
             fetches the mesh",
            study.path.display(),
            path.display()
        )
    };
    present.next().with_context(missing)
}

/// What a field is made from, for the digest of a stage's inputs: the section, and which mesh file is used.
pub(crate) fn field_inputs(study: &Study, object: &ObjectSection) -> Result<String> {
    let section = serde_json::to_string(&object.field)?;
    Ok(match &object.field {
        FieldSection::Mesh { sources } => format!("{section} {}", present_source(study, sources)?.0.sha256),
        _ => section,
    })
}

/// Checks that the mesh file each field would be made from is the one the study names.
///
/// # Errors
/// If it cannot be read or has another digest.
pub(crate) fn check_mesh_files(study: &Study) -> Result<()> {
    for (i, object) in study.file.objects.iter().enumerate() {
        if let FieldSection::Mesh { sources } = &object.field {
            let (source, path) = present_source(study, sources)?;
            read_checked(source, &path).with_context(|| {
                format!("{}: objects[{i}].field: {}", study.path.display(), path.display())
            })?;
        }
    }
    Ok(())
}

fn read_checked(source: &MeshSourceSection, path: &std::path::Path) -> Result<Vec<u8>> {
    let bytes = std::fs::read(path)?;
    let found = sha256(&bytes);
    if found != source.sha256.to_lowercase() {
        bail!("has SHA-256 {found}, but the study asks for {}", source.sha256);
    }
    Ok(bytes)
}

fn read_placed(source: &MeshSourceSection, path: &std::path::Path) -> Result<TriangleMesh> {
    let format = mesh_file::format_to_read(path)?;
    let mesh = format.read(read_checked(source, path)?.as_slice())?;
    let solid = mesh::repair::closed_solid(&mesh)?;
    let axes = source.axes.each_ref().map(|axis| axis_vector(axis));
    let offset = DVec3::from_array(source.offset);
    Ok(solid.transformed(|p| {
        let p = p.as_dvec3();
        let turned = DVec3::new(axes[0].dot(p), axes[1].dot(p), axes[2].dot(p));
        (turned * source.scale + offset).as_vec3()
    }))
}

/// The file axis that `design` has checked to be x, y or z with an optional minus.
fn axis_vector(axis: &str) -> DVec3 {
    let (sign, letter) = match axis.strip_prefix('-') {
        Some(letter) => (-1.0, letter),
        None => (1.0, axis),
    };
    sign * match letter {
        "x" => DVec3::X,
        "y" => DVec3::Y,
        _ => DVec3::Z,
    }
}

/// The spacing of an object for a purpose, and the key it comes from.
pub(crate) fn spacing(object: &ObjectSection, purpose: Purpose) -> (f64, &'static str) {
    match purpose {
        Purpose::Benchmark | Purpose::Indexed => (object.benchmark_spacing, "benchmark_spacing"),
        Purpose::Stimulus => (object.stimulus_spacing, "stimulus_spacing"),
    }
}

/// The spacing that cuts the longest axis of an object's volume into so many cells.
pub(crate) fn spacing_of_cells(object: &ObjectSection, cells: u32) -> f64 {
    let longest = (0..3).map(|axis| object.max[axis] - object.min[axis]).fold(0.0, f64::max);
    longest / f64::from(cells)
}

/// The lattice of an arrangement over an object's volume.
///
/// # Errors
/// If the extractor refuses it; the caller knows the key to name.
pub(crate) fn lattice(object: &ObjectSection, arrangement: Arrangement, spacing: f64) -> Result<Lattice> {
    let corner = |p: [f64; 3]| Vec3::from_array(p.map(|x| x as f32));
    let bounds = Bounds { min: corner(object.min), max: corner(object.max) };
    lattice_over(bounds, arrangement, spacing as f32)
}

/// The lattice of an arrangement over a box.
///
/// # Errors
/// If the extractor refuses it.
pub(crate) fn lattice_over(bounds: Bounds, arrangement: Arrangement, spacing: f32) -> Result<Lattice> {
    let arrangement = match arrangement {
        Arrangement::BodyCentred => extract::Arrangement::BodyCentred,
        Arrangement::SimpleCubic => extract::Arrangement::SimpleCubic,
        Arrangement::FiveTetrahedra => extract::Arrangement::FiveTetrahedra,
        Arrangement::FaceCentred => extract::Arrangement::FaceCentred,
    };
    Ok(Lattice::try_new(arrangement, bounds, spacing)?)
}

fn positions(study: &Study, purpose: Purpose) -> extract::Positions {
    let section = &study.file.extraction;
    match (purpose, section.positions) {
        (Purpose::Indexed, _) | (_, Positions::Indexed) => extract::Positions::Indexed,
        (_, Positions::Accumulated) => {
            extract::Positions::Accumulated { chunks: section.accumulation_chunks }
        }
    }
}

/// The extractor's word for a clustering.
pub(crate) fn clustering(clustering: Clustering) -> extract::Clustering {
    match clustering {
        Clustering::None => extract::Clustering::None,
        Clustering::Integrated => extract::Clustering::Integrated,
        Clustering::EdgeCollapse => extract::Clustering::EdgeCollapse,
        Clustering::IntegratedCollapse => extract::Clustering::IntegratedCollapse,
    }
}

/// The extractor's settings for a configuration. Meshes made for [`Purpose::Indexed`] have indexed positions whatever the
/// study says.
pub(crate) fn settings(study: &Study, configuration: &Configuration, purpose: Purpose) -> ExtractSettings {
    let section = &study.file.extraction;
    let positions = positions(study, purpose);
    let clustering = clustering(configuration.id.method.clustering);
    let topology = match section.topology {
        Topology::Guarded => extract::Topology::Guarded,
        Topology::Published => extract::Topology::Published,
    };
    let placement = match section.placement {
        Placement::MeanOfCrossings => extract::Placement::MeanOfCrossings,
        Placement::CurvatureWeighted => extract::Placement::CurvatureWeighted,
        Placement::Projected => extract::Placement::Projected,
        Placement::Relaxed => extract::Placement::Relaxed,
    };
    let isovalue = study.object(configuration).isovalue as f32;
    let refine_crossings = section.refine_crossings;
    ExtractSettings { isovalue, clustering, topology, positions, placement, refine_crossings }
}

/// Checks that every lattice of the study can be made, and that what the extractor holds of it fits into memory.
///
/// # Errors
/// The first that cannot, naming file, key and limit.
pub(crate) fn check_lattices(study: &Study, machine_bytes: Option<u64>) -> Result<()> {
    let file = study.path.display();
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let execution = Execution { threads: cores.max(study.file.benchmark.threads as usize) };
    let check = |key: String, object: &ObjectSection, arrangement, spacing: f64, purpose| -> Result<()> {
        let lattice =
            lattice(object, arrangement, spacing).with_context(|| format!("{file}: {key} = {spacing:?}"))?;
        let settings = ExtractSettings { positions: positions(study, purpose), ..Default::default() };
        check_memory(study, &lattice, &settings, &execution, machine_bytes)
            .with_context(|| format!("{file}: {key} = {spacing:?}"))
    };
    for (i, object) in study.file.objects.iter().enumerate() {
        for purpose in [Purpose::Benchmark, Purpose::Stimulus] {
            let (spacing, name) = spacing(object, purpose);
            for &arrangement in &study.file.arrangements {
                check(format!("objects[{i}].{name}"), object, arrangement, spacing, purpose)?;
            }
        }
    }
    for (i, still) in study.file.stills.iter().enumerate() {
        let named = study.configurations.iter().find(|c| c.id == still.configuration);
        let object = study.object(named.expect("checked when the study was read"));
        let arrangement = still.configuration.method.arrangement;
        check(format!("stills[{i}].spacing"), object, arrangement, still.spacing, Purpose::Stimulus)?;
    }
    Ok(())
}

/// Checks every lattice of a sweep, as [`check_lattices`].
///
/// # Errors
/// The first that cannot be made or does not fit, naming file, key and limit.
pub(crate) fn check_sweep(study: &Study, section: &SweepSection, machine_bytes: Option<u64>) -> Result<()> {
    let threads = section.threads.iter().copied().max().unwrap_or(1) as usize;
    let settings = ExtractSettings { positions: extract::Positions::Indexed, ..Default::default() };
    for (i, &cells) in section.cells.iter().enumerate() {
        for object in study.file.objects.iter().filter(|object| section.objects.contains(&object.id)) {
            for &arrangement in &study.file.arrangements {
                let key = || format!("{}: benchmark.sweep.cells[{i}] = {cells}", study.path.display());
                let lattice =
                    lattice(object, arrangement, spacing_of_cells(object, cells)).with_context(key)?;
                check_memory(study, &lattice, &settings, &Execution { threads }, machine_bytes)
                    .with_context(key)?;
            }
        }
    }
    Ok(())
}

/// Checks that what the extractor holds of a lattice fits into what the study allows and the machine has.
///
/// # Errors
/// If it does not, naming the limit.
pub(crate) fn check_memory(
    study: &Study,
    lattice: &Lattice,
    settings: &ExtractSettings,
    execution: &Execution,
    machine_bytes: Option<u64>,
) -> Result<()> {
    let allowed = (study.file.limits.memory_gib * GIB) as u64;
    let limit = match machine_bytes {
        Some(machine) if machine < allowed => Limit { bytes: machine, name: "this machine has" },
        _ => Limit { bytes: allowed, name: "limits.memory_gib allows" },
    };
    check_limit(lattice, settings, execution, 0, limit)
}

/// Checks that what the extractor holds of a lattice, beside what the field holds already, is not more than a limit.
///
/// # Errors
/// If it is, naming the limit.
pub(crate) fn check_limit(
    lattice: &Lattice,
    settings: &ExtractSettings,
    execution: &Execution,
    held: u64,
    limit: Limit,
) -> Result<()> {
    let needed = lattice.memory_bytes_for(settings, execution);
    if needed.saturating_add(held) > limit.bytes {
        let (needed, allowed) = (gibibytes(needed), gibibytes(limit.bytes));
        let beside =
            if held > 0 { format!(" beside the volume's {}", gibibytes(held)) } else { String::new() };
        bail!("the {} lattice needs {needed}{beside}, {} {allowed}", lattice.arrangement(), limit.name);
    }
    Ok(())
}

fn gibibytes(bytes: u64) -> String {
    let gib = bytes as f64 / GIB;
    if gib < 1.0 { format!("{:.1} MiB", 1024.0 * gib) } else { format!("{gib:.1} GiB") }
}

const GIB: f64 = (1u64 << 30) as f64;
