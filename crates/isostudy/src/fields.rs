//! The scalar fields of a study's objects, from what the study file says of them.

use crate::grid_file;
use crate::input;
use crate::memory::{Limit, OfVolume};
use crate::mesh_file;
use crate::scattered_file::{self, WantedPoints};
use crate::source::{self, Options};
use crate::store::{sha256, sha256_of};
use crate::study_key::place;
use crate::terminal::tell_once;
use anyhow::{Context, Result, bail};
use glam::{DVec3, Vec3};
use isostudy_design::Study;
use isostudy_design::config::{FieldSection, MeshSourceSection, ObjectSection, PointKernel, PointNormals};
use isostudy_design::wording::{did_you_mean, plainly};
use isostudy_field::{Asteroid, MeshDistance, Sphere, StudyField, Terrain, TerrainCharacter};
use isostudy_grid::{Grid, GridField};
use isostudy_mesh::{Bounds, TriangleMesh};
use isostudy_scattered::{FitSettings, Kernel, PointSettings};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// An object's field.
pub(crate) struct ObjectField {
    /// Inside is above [`isovalue`](Self::isovalue), whatever the study says.
    pub(crate) field: Box<dyn StudyField + Send>,
    pub(crate) isovalue: f32,
    /// The cells of a grid, which are a lattice of their own; `None` of other fields.
    pub(crate) cells: Option<Arc<Grid>>,
}

/// The scalar fields of a study's objects, each made when it is first asked for.
pub(crate) struct Fields<'a> {
    study: &'a Study,
    made: Vec<OnceLock<ObjectField>>,
    inputs: Vec<OnceLock<String>>,
}

impl<'a> Fields<'a> {
    pub(crate) fn new(study: &'a Study) -> Self {
        let objects = study.file.objects.len();
        let made = (0..objects).map(|_| OnceLock::new()).collect();
        Self { study, made, inputs: vec![OnceLock::new(); objects] }
    }

    /// What a field is made from, for the digest of a stage's inputs: the section, and the content of its files.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub(crate) fn inputs(&self, object: usize) -> Result<&str> {
        if self.inputs[object].get().is_none() {
            let _ = self.inputs[object].set(field_inputs(self.study, object)?);
        }
        Ok(self.inputs[object].get().expect("made above"))
    }

    /// The field of an object. Fields are made from one thread, so none is made twice.
    ///
    /// # Errors
    /// If a file cannot be read, is not the one the study names, or has no inside; if a formula or a setting is none.
    pub(crate) fn get(&self, object: usize) -> Result<&ObjectField> {
        if self.made[object].get().is_none() {
            let section = &self.study.file.objects[object];
            let field = make(self.study, object, section)
                .with_context(|| place(self.study, &format!("objects[{object}].field")))?;
            let _ = self.made[object].set(field);
        }
        Ok(self.made[object].get().expect("made above"))
    }
}

/// An object's volume.
pub(crate) fn bounds(object: &ObjectSection) -> Bounds {
    let corner = |p: [f64; 3]| Vec3::from_array(p.map(|x| x as f32));
    Bounds { min: corner(object.min), max: corner(object.max) }
}

fn make(study: &Study, number: usize, object: &ObjectSection) -> Result<ObjectField> {
    let isovalue = object.isovalue as f32;
    let as_it_is = |field: Box<dyn StudyField + Send>| Ok(ObjectField { field, isovalue, cells: None });
    match &object.field {
        FieldSection::Sphere { radius } => as_it_is(Box::new(Sphere { radius: *radius as f32 })),
        FieldSection::Asteroid {} => as_it_is(Box::<Asteroid>::default()),
        FieldSection::Mesh { allow_open: true, .. } => {
            let (source, path) = present_source(study, number, object)?;
            if source != MeshSourceSection::plain(&source.file) {
                bail!("allow_open goes with file alone: what has holes is taken as it stands");
            }
            Ok(of(options(study, object, None, false).of_mesh(&path)?))
        }
        FieldSection::Mesh { .. } => {
            let (source, path) = present_source(study, number, object)?;
            let mesh = read_placed(&source, &path).with_context(|| path.display().to_string())?;
            let field = MeshDistance::try_new(&mesh).with_context(|| path.display().to_string())?;
            as_it_is(Box::new(field))
        }
        FieldSection::Formula { text, inside, close } => {
            Ok(of(options(study, object, *inside, *close).of_formula(text, bounds(object), "text =")?))
        }
        FieldSection::Volume { file, inside, close } => {
            Ok(of(options(study, object, *inside, *close).of_volume(&study.resolve(file))?))
        }
        FieldSection::Grid { file, array, inside } => {
            of_grid(study, object, (file, array.as_deref(), *inside))
        }
        FieldSection::Points { file, inside, close, .. } => {
            let options = options(study, object, *inside, *close);
            Ok(of(options.of_points(&study.resolve(file), &wanted_points(&object.field))?))
        }
        FieldSection::Soup { file, epsilon, inside, close } => {
            let options = options(study, object, *inside, *close);
            Ok(of(options.of_soup(&study.resolve(file), *epsilon)?))
        }
        FieldSection::Terrain(keys) => as_it_is(Box::new(TerrainKeys::of(keys)?.terrain(bounds(object))?)),
        FieldSection::Files {} => {
            bail!("there is none: the study shows the files of [[stimuli.files]] and makes no meshes")
        }
    }
}

/// What a study asks of points; the defaults for other fields.
fn wanted_points(field: &FieldSection) -> WantedPoints {
    let FieldSection::Points { normals, kernel, offset, smoothing, centres, .. } = field else {
        return WantedPoints::default();
    };
    let kernel = match kernel {
        PointKernel::Biharmonic => Kernel::Biharmonic,
        PointKernel::Triharmonic => Kernel::Triharmonic,
    };
    let fit = FitSettings { kernel, smoothing: *smoothing, most_centres: *centres as usize };
    WantedPoints {
        are_normals_estimated: *normals == PointNormals::Estimated,
        settings: PointSettings { fit, offset: *offset },
    }
}

fn of(source: source::Source) -> ObjectField {
    ObjectField { field: source.field, isovalue: source.isovalue, cells: None }
}

/// A grid, as cells and as what interpolates on them.
fn of_grid(
    study: &Study,
    object: &ObjectSection,
    (file, array, inside): (&str, Option<&str>, Option<isostudy_design::config::Inside>),
) -> Result<ObjectField> {
    let path = study.resolve(file);
    let grid = grid_file::read(&path, array, limit(study))?;
    let (grid, isovalue) = match inside {
        Some(isostudy_design::config::Inside::Below) => (grid.negated(), -object.isovalue as f32),
        _ => (grid, object.isovalue as f32),
    };
    let cells = Arc::new(grid);
    let field = GridField::try_new(Arc::clone(&cells)).with_context(|| path.display().to_string())?;
    Ok(ObjectField { field: Box::new(field), isovalue, cells: Some(cells) })
}

fn limit(study: &Study) -> Limit {
    Limit::of_study(study, isostudy_bench::read_machine().memory_bytes)
}

/// The object's box is its own, and so is its isovalue; its spacing belongs to each method.
fn options(
    study: &Study,
    object: &ObjectSection,
    inside: Option<isostudy_design::config::Inside>,
    close: bool,
) -> Options {
    let bounds = bounds(object);
    Options {
        bounds: Some(bounds),
        spacing: Some(object.benchmark_spacing as f32),
        cells: None,
        isovalue: object.isovalue as f32,
        inside: inside.map(|side| match side {
            isostudy_design::config::Inside::Above => source::Inside::Above,
            isostudy_design::config::Inside::Below => source::Inside::Below,
        }),
        close,
        allow_open: true,
        limit: limit(study),
        // Each of the study's methods is held against the limit by itself.
        method: None,
        in_file: false,
    }
}

/// What an object's volume takes, from its header; `None` where the field is no volume, or the file is not there.
///
/// # Errors
/// If the header is none.
pub(crate) fn volume(study: &Study, number: usize) -> Result<Option<OfVolume>> {
    let FieldSection::Volume { file, .. } = &study.file.objects[number].field else { return Ok(None) };
    let path = study.resolve(file);
    if !path.is_file() {
        return Ok(None);
    }
    let unread =
        isostudy_volume::open(&path).with_context(|| place(study, &format!("objects[{number}].field")))?;
    Ok(Some(source::held_as_a_field(&unread)))
}

/// The keys of a terrain: a character, and what differs from it; names and units as in [`isostudy_field::TerrainSettings`].
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TerrainKeys {
    character: String,
    #[serde(default = "one")]
    seed: u32,
    ground: Option<f64>,
    relief: Option<f64>,
    period: Option<f64>,
    octaves: Option<u32>,
    gain: Option<f64>,
    ridged: Option<f64>,
    billowed: Option<f64>,
    terrace: Option<f64>,
    overhang: Option<f64>,
    overhang_period: Option<f64>,
    caves: Option<f64>,
    cave_period: Option<f64>,
    closed: Option<bool>,
    margin: Option<f64>,
}

fn one() -> u32 {
    1
}

impl TerrainKeys {
    /// The keys of a study file.
    ///
    /// # Errors
    /// The first that is none, or that is missing, with what is allowed.
    fn of(keys: &toml::Table) -> Result<Self> {
        let known = TerrainCharacter::ALL.map(|character| character.to_string());
        let allowed = known.each_ref().map(|name| format!("\"{name}\"")).join(", ");
        match keys.get("character") {
            None => bail!("character is missing; allowed: {allowed}"),
            Some(toml::Value::String(name)) if known.contains(name) => {}
            Some(other) => {
                let meant =
                    did_you_mean(other.as_str().unwrap_or_default(), known.iter().map(String::as_str));
                bail!("character = {other}: allowed: {allowed}{meant}")
            }
        }
        let keys = toml::Value::Table(keys.clone()).try_into();
        keys.map_err(|error: toml::de::Error| anyhow::Error::msg(plainly(error.to_string().trim_end())))
    }

    fn terrain(&self, bounds: Bounds) -> Result<Terrain> {
        let character: TerrainCharacter = self.character.parse()?;
        let mut settings = character.settings(self.seed);
        for (setting, given) in [
            (&mut settings.ground, self.ground),
            (&mut settings.relief, self.relief),
            (&mut settings.period, self.period),
            (&mut settings.gain, self.gain),
            (&mut settings.ridged, self.ridged),
            (&mut settings.billowed, self.billowed),
            (&mut settings.terrace, self.terrace),
            (&mut settings.overhang, self.overhang),
            (&mut settings.overhang_period, self.overhang_period),
            (&mut settings.caves, self.caves),
            (&mut settings.cave_period, self.cave_period),
            (&mut settings.margin, self.margin),
        ] {
            *setting = given.unwrap_or(*setting);
        }
        settings.octaves = self.octaves.unwrap_or(settings.octaves);
        settings.closed = self.closed.unwrap_or(settings.closed);
        Ok(Terrain::try_new(settings, bounds)?)
    }
}

/// The first of a mesh's sources that is there.
fn present_source(
    study: &Study,
    number: usize,
    object: &ObjectSection,
) -> Result<(MeshSourceSection, PathBuf)> {
    let sources = object.field.mesh_sources();
    let resolved = sources.iter().map(|source| (source, study.resolve(&source.file)));
    let mut present = resolved.filter(|(_, path)| path.is_file());
    let missing = || {
        let path = sources.first().map_or_else(PathBuf::new, |first| study.resolve(&first.file));
        let key = match &object.field {
            FieldSection::Mesh { file: Some(_), .. } => "file",
            _ => "sources[0].file",
        };
        // What is fetched has a digest.
        let bunny = match sources.first().is_some_and(|first| first.sha256.is_some()) {
            true => "; `make bunny` (scripts/fetch-bunny.sh) fetches the mesh",
            false => "",
        };
        let key = place(study, &format!("objects[{number}].field.{key}"));
        format!("{key} names {}: no such file{bunny}", path.display())
    };
    present.next().map(|(source, path)| (source.clone(), path)).with_context(missing)
}

/// The files that an object's field is read from, with their SHA-256; none for a field that is computed.
///
/// # Errors
/// If one cannot be read.
pub(crate) fn files(study: &Study, number: usize) -> Result<Vec<(String, String)>> {
    let object = &study.file.objects[number];
    let named = |written: &str, path: &Path| -> Result<(String, String)> {
        let bytes =
            input::bytes(path).with_context(|| place(study, &format!("objects[{number}].field.file")))?;
        Ok((written.to_owned(), sha256(&bytes)))
    };
    match &object.field {
        FieldSection::Mesh { .. } => {
            let (source, path) = present_source(study, number, object)?;
            Ok(vec![named(&source.file, &path)?])
        }
        FieldSection::Points { file, .. } | FieldSection::Soup { file, .. } => {
            Ok(vec![named(file, &study.resolve(file))?])
        }
        FieldSection::Volume { file, .. } => {
            let path = study.resolve(file);
            let read = || {
                let unread = isostudy_volume::open(&path)?;
                let needed = OfVolume::samples(&unread);
                limit(study).read(unread, needed)
            };
            let volume = read().with_context(|| format!("objects[{number}].field.file"))?;
            // The samples as well: a header may name another file that holds them.
            let lies = format!("{:?} {:?} {:?}", volume.counts, volume.origin, volume.steps).into_bytes();
            let samples = volume.values.chunks(1 << 14);
            let samples = samples.map(|part| part.iter().flat_map(|value| value.to_le_bytes()).collect());
            let digest = sha256_of(std::iter::once(lies).chain(samples));
            Ok(vec![named(file, &path)?, (format!("samples of {file}"), digest)])
        }
        FieldSection::Grid { file, .. } => {
            let files = isostudy_grid::files(&study.resolve(file));
            files.iter().map(|path| named(&beside(file, path), path)).collect()
        }
        _ => Ok(Vec::new()),
    }
}

/// A file as written in a study, or another beside it.
fn beside(written: &str, path: &Path) -> String {
    Path::new(written).with_file_name(path.file_name().unwrap_or_default()).display().to_string()
}

fn field_inputs(study: &Study, number: usize) -> Result<String> {
    let object = &study.file.objects[number];
    let mut inputs = serde_json::to_string(&object.field)?;
    for (_, digest) in files(study, number)? {
        inputs.push(' ');
        inputs.push_str(&digest);
    }
    Ok(inputs)
}

/// Checks what can be said of every field before it is made: that its files are there and are the ones the study names, that a
/// formula is one, that a terrain's settings are in their ranges.
///
/// # Errors
/// The first that is not, naming file and key.
pub(crate) fn check(study: &Study) -> Result<()> {
    for (number, object) in study.file.objects.iter().enumerate() {
        let place = || place(study, &format!("objects[{number}].field"));
        match &object.field {
            FieldSection::Asteroid {} | FieldSection::Files {} => {}
            FieldSection::Mesh { .. } => {
                let (source, path) = present_source(study, number, object)?;
                read_checked(&source, &path).with_context(|| format!("{}: {}", place(), path.display()))?;
            }
            FieldSection::Volume { file, .. } | FieldSection::Grid { file, .. } => {
                present_file(study, file, &place)?;
                check_sides(study, number, object)?;
            }
            // A fit may take long, and is made when a mesh is.
            FieldSection::Points { file, .. } => {
                let path = present_file(study, file, &place)?;
                scattered_file::check_points(&path, &wanted_points(&object.field)).with_context(place)?;
            }
            FieldSection::Soup { file, .. } => {
                present_file(study, file, &place)?;
                check_sides(study, number, object)?;
            }
            FieldSection::Sphere { .. } | FieldSection::Formula { .. } | FieldSection::Terrain(_) => {
                check_sides(study, number, object)?;
            }
        }
    }
    Ok(())
}

/// The path of a field's file, which is there.
fn present_file(study: &Study, file: &str, place: &dyn Fn() -> String) -> Result<PathBuf> {
    let path = study.resolve(file);
    if !path.is_file() {
        bail!("{}.file names {}: no such file", place(), path.display());
    }
    Ok(path)
}

fn check_sides(study: &Study, number: usize, object: &ObjectSection) -> Result<()> {
    let place = || place(study, &format!("objects[{number}].field"));
    let made = make(study, number, object).with_context(place)?;
    if !has_both_sides(&made, object) {
        bail!(
            "{}: has every value on one side of isovalue = {:?} between min and max: there is no surface",
            place(),
            object.isovalue
        );
    }
    Ok(())
}

/// Samples along each side of the grid on which a surface is looked for before any work starts.
const PROBES: u32 = 96;

/// Whether a coarse grid, or the study's own where that is finer, finds both sides of the isovalue.
fn has_both_sides(made: &ObjectField, object: &ObjectSection) -> bool {
    let bounds = bounds(object);
    let middle = made.field.sample(0.5 * (bounds.min + bounds.max));
    if let Some((low, high)) = made.field.range(bounds, middle)
        && (low > made.isovalue || high <= made.isovalue)
    {
        return false;
    }
    let size = bounds.size();
    let finest = object.benchmark_spacing.min(object.stimulus_spacing) as f32;
    let along = |side: f32| {
        ((side / finest).ceil() as u32).clamp(1, 4 * PROBES).max(PROBES.min((side / finest) as u32 + 1))
    };
    let cells = size.to_array().map(along);
    let mut seen = [false; 2];
    for k in 0..=cells[2] {
        for j in 0..=cells[1] {
            for i in 0..=cells[0] {
                let share = Vec3::new(i as f32, j as f32, k as f32)
                    / Vec3::new(cells[0] as f32, cells[1] as f32, cells[2] as f32);
                seen[usize::from(made.field.sample(bounds.min + share * size) > made.isovalue)] = true;
                if seen == [true; 2] {
                    return true;
                }
            }
        }
    }
    false
}

fn read_checked(source: &MeshSourceSection, path: &Path) -> Result<Vec<u8>> {
    let bytes = input::bytes(path)?;
    let found = sha256(&bytes);
    match &source.sha256 {
        Some(wanted) if found != wanted.to_lowercase() => {
            bail!("has SHA-256 {found}, but the study asks for {wanted}")
        }
        _ => Ok(bytes),
    }
}

fn read_placed(source: &MeshSourceSection, path: &Path) -> Result<TriangleMesh> {
    let format = mesh_file::format_to_read(path)?;
    let mesh = format.read(read_checked(source, path)?.as_slice())?;
    let holes = isostudy_mesh::repair::boundary_loops(&mesh)?.len();
    let solid = isostudy_mesh::repair::closed_solid(&mesh)?;
    if holes > 0 {
        let closed =
            if holes == 1 { "1 hole was closed".into() } else { format!("{holes} holes were closed") };
        tell_once(&format!("{}: {closed}; allow_open = true takes a mesh with its holes", path.display()));
    }
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
