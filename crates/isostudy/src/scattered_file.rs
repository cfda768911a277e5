//! Fields of points and of polygon soup in files, and what is said of them.

use crate::input;
use crate::mesh_file;
use crate::terminal::{counted, grouped, tell_once};
use anyhow::{Context, Error, Result};
use isostudy_scattered::{
    PointCloud, PointField, PointFieldError, PointFormat, PointSettings, SoupField, estimate_normals,
    read_points,
};
use std::path::Path;

/// What is asked of points.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct WantedPoints {
    /// Whether normals are made of the points' neighbours, whatever the file says.
    pub(crate) are_normals_estimated: bool,
    pub(crate) settings: PointSettings,
}

/// The field of the points in a file. How good the fit is, is said on standard error.
///
/// # Errors
/// If they cannot be read, or make no surface. The path and the place in the file are named.
pub(crate) fn points(path: &Path, wanted: &WantedPoints) -> Result<PointField> {
    let cloud = read(path, wanted)?;
    let field = PointField::try_new(&cloud, &wanted.settings).map_err(|error| faulty(path, &error))?;
    let name = path.display();
    if field.repeated() > 0 {
        let repeated = counted(field.repeated() as u64, "point");
        tell_once(&format!("{name}: {repeated} left out, with the place and the normal of others"));
    }
    let (all, at_points) = (field.report(), field.report_at_points());
    let [points, places, centres] =
        [at_points.points, all.points, all.centres].map(|number| grouped(number as u64));
    let chosen = if all.centres < all.points { "chosen as centres" } else { "centres" };
    tell_once(&format!(
        "{name}: {points} points; of {places} places on and beside the surface, {centres} are {chosen}. At the points the fit is {:.2e} \
         off at most, {:.2e} in root mean square",
        at_points.largest, at_points.root_mean_square
    ));
    Ok(field)
}

/// Checks points without the work of a fit.
///
/// # Errors
/// The same, but for points and normals in one plane.
pub(crate) fn check_points(path: &Path, wanted: &WantedPoints) -> Result<()> {
    let cloud = read(path, wanted)?;
    PointField::check(&cloud, &wanted.settings).map_err(|error| faulty(path, &error))
}

/// The field of the triangles in a file. Flat ones that are left out are said on standard error.
///
/// # Errors
/// If they cannot be read, or all are flat. The path is named.
pub(crate) fn soup(path: &Path, epsilon: Option<f64>) -> Result<SoupField> {
    let mesh = mesh_file::read(path)?;
    let name = path.display();
    let field = SoupField::try_new(&mesh, epsilon).with_context(|| name.to_string())?;
    if let Some(flat) = field.flat() {
        tell_once(&format!(
            "{name}: {} of {} left out, which have no plane: triangle {} is the first",
            grouped(flat.many as u64),
            counted(mesh.triangles.len() as u64, "triangle"),
            flat.first
        ));
    }
    Ok(field)
}

fn read(path: &Path, wanted: &WantedPoints) -> Result<PointCloud> {
    let name = || path.display().to_string();
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let format = PointFormat::from_extension(&extension)
        .context("known endings of points are .ply, .xyz, .obj")
        .with_context(name)?;
    let cloud = read_points(format, input::open(path)?).with_context(name)?;
    Ok(if wanted.are_normals_estimated { estimate_normals(&cloud) } else { cloud })
}

/// A fault of points with their file, and what may help.
fn faulty(path: &Path, error: &PointFieldError) -> Error {
    let advice = match error {
        PointFieldError::NoNormals => {
            "; --normals estimated makes some of neighbours, in a study normals = \"estimated\""
        }
        _ => "",
    };
    Error::msg(format!("{}: {error}{advice}", path.display()))
}
