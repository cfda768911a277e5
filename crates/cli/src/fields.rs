//! The scalar fields of a study's objects, from what the study file says of them.

use crate::mesh_file;
use crate::store::sha256;
use anyhow::{Context, Result, bail};
use design::Study;
use design::config::{FieldSection, MeshSourceSection, ObjectSection};
use field::{Asteroid, MeshDistance, ScalarField, Sphere};
use glam::DVec3;
use mesh::TriangleMesh;
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
        FieldSection::Sphere { radius } => Box::new(Sphere { radius: *radius as f32 }),
        FieldSection::Asteroid => Box::new(Asteroid::default()),
        FieldSection::Mesh { sources } => {
            let (source, path) = present_source(study, sources)?;
            let mesh = read_placed(source, &path).with_context(|| path.display().to_string())?;
            Box::new(MeshDistance::try_new(&mesh).with_context(|| path.display().to_string())?)
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
