//! Meshes in files: the format is what the name ends with.

use crate::input;
use anyhow::{Context, Result, bail};
use glam::DVec3;
use isostudy_extract::BoxGrid;
use isostudy_mesh::{Bounds, MeshFormat, TriangleMesh};
use std::path::Path;

const READ: [MeshFormat; 3] = [MeshFormat::Obj, MeshFormat::Ply, MeshFormat::Stl];

/// The format to read a file in.
///
/// # Errors
/// If none that is read ends so.
pub(crate) fn format_to_read(path: &Path) -> Result<MeshFormat> {
    format_among(path, &READ)
}

/// The format to write a file in.
///
/// # Errors
/// If none that is written ends so.
pub(crate) fn format_to_write(path: &Path) -> Result<MeshFormat> {
    format_among(path, &MeshFormat::ALL)
}

fn format_among(path: &Path, known: &[MeshFormat]) -> Result<MeshFormat> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let endings = || known.iter().map(|f| format!(".{}", f.extension())).collect::<Vec<_>>().join(", ");
    MeshFormat::from_extension(&extension)
        .filter(|format| known.contains(format))
        .with_context(|| format!("known endings are {}", endings()))
}

/// The mesh in a file.
///
/// # Errors
/// If there is none that can be read. The path is named.
pub(crate) fn read(path: &Path) -> Result<TriangleMesh> {
    let named = || path.display().to_string();
    let format = format_to_read(path).with_context(named)?;
    format.read(input::open(path)?).with_context(named)
}

/// Checks that a mesh lies in the box of an object, or at most a cell beyond it, as a program's has to.
///
/// # Errors
/// The first vertex that does not, and how much larger or smaller than the box the mesh is: then its unit is another.
pub(crate) fn check_lies_in(mesh: &TriangleMesh, grid: &BoxGrid) -> Result<()> {
    let BoxGrid { bounds: Bounds { min, max }, spacing } = *grid;
    let beyond = f64::from(spacing) * (1.0 + 1e-6);
    let (low, high) = (min.as_dvec3() - beyond, max.as_dvec3() + beyond);
    let is_in = |p: DVec3| p.cmpge(low).all() && p.cmple(high).all();
    let Some((vertex, p)) = mesh.positions.iter().enumerate().find(|(_, p)| !is_in(p.as_dvec3())) else {
        return Ok(());
    };
    let size = |points: &mut dyn Iterator<Item = DVec3>| {
        let (low, high) =
            points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        (high - low).max_element()
    };
    let times = size(&mut mesh.positions.iter().map(|p| p.as_dvec3())) / size(&mut [low, high].into_iter());
    let unit = match times {
        _ if !times.is_finite() => String::new(),
        _ if times > 2.0 => {
            format!(" The mesh is {times:.3e} times as large as that box: its unit is another.")
        }
        _ if times < 0.1 => {
            format!(" The mesh is {times:.3e} times as large as that box: its unit may be another.")
        }
        _ => String::new(),
    };
    bail!(
        "vertex {vertex} lies at {:?}, more than a cell beyond the object's box, {:?} to {:?}: coordinates are in the object's \
         unit.{unit}",
        p.to_array(),
        min.to_array(),
        max.to_array()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A triangle across a box of two units, in another unit and elsewhere.
    #[test]
    fn a_mesh_lies_in_the_box_of_its_object_or_a_cell_beyond() {
        let grid = BoxGrid { bounds: Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }, spacing: 0.1 };
        let said = |scale: f32, shift: f32| {
            let corners = [Vec3::NEG_ONE, Vec3::new(1.0, -1.0, 0.0), Vec3::ONE];
            let positions = corners.map(|p| p * scale + shift).into();
            let mesh = TriangleMesh { positions, normals: Vec::new(), triangles: vec![[0, 1, 2]] };
            check_lies_in(&mesh, &grid).map_err(|error| error.to_string())
        };
        assert_eq!(said(1.0, 0.0), Ok(()));
        assert_eq!(said(1.0, 0.0999), Ok(()));
        let millimetres = said(1000.0, 0.0).unwrap_err();
        assert!(
            millimetres.contains("its unit is another") && millimetres.contains("9.091e2 times"),
            "{millimetres}"
        );
        let elsewhere = said(1.0, 3.0).unwrap_err();
        assert!(
            elsewhere.starts_with("vertex 1 lies at [4.0, 2.0, 3.0]") || elsewhere.starts_with("vertex 0"),
            "{elsewhere}"
        );
        assert!(!elsewhere.contains("unit is another"), "{elsewhere}");
        for odd in [f32::NAN, f32::INFINITY, 3.4e38] {
            assert!(said(1.0, odd).is_err(), "{odd}");
        }
    }
}
