//! Files of a study's own that people are shown: pictures, films and meshes.

use crate::study_key::place;
use crate::{input, mesh_file, video};
use anyhow::{Context, Result, bail};
use glam::{Mat3, Vec3};
use isostudy_design::config::ShownFile;
use isostudy_design::{Configuration, Study};
use isostudy_mesh::normals::area_weighted_normals;
use isostudy_mesh::{Bounds, TriangleMesh};
use isostudy_raster::Film;
use std::path::{Path, PathBuf};

/// How much longer or shorter than `stimuli.duration_s` a film may be: rates of frames are seldom whole.
const TOLERANCE_S: f64 = 0.1;

/// Where the file of a configuration is.
///
/// # Errors
/// If the study shows no files.
pub(crate) fn path(study: &Study, of: &Configuration) -> Result<PathBuf> {
    let shown = study.file.stimuli.file_of(&of.id).context("the study shows no file of this")?;
    Ok(study.resolve(&shown.file))
}

/// Where a file stands in the study file.
fn key(study: &Study, shown: &ShownFile) -> String {
    let i = study.file.stimuli.files.iter().position(|other| other == shown).unwrap_or(0);
    place(study, &format!("stimuli.files[{i}].file"))
}

/// Checks that every file is there.
///
/// # Errors
/// The first that is not, naming file, key and path.
pub(crate) fn check(study: &Study) -> Result<()> {
    for shown in &study.file.stimuli.files {
        let path = study.resolve(&shown.file);
        if !path.is_file() {
            bail!("{} names {}: no such file", key(study, shown), path.display());
        }
    }
    Ok(())
}

/// The files as the study writes them, with their SHA-256; none of a study that shows none.
///
/// # Errors
/// If one cannot be read.
pub(crate) fn digests(study: &Study) -> Result<Vec<(String, String)>> {
    let digest = |shown: &ShownFile| {
        let bytes = input::bytes(&study.resolve(&shown.file))?;
        Ok((shown.file.clone(), crate::store::sha256(&bytes)))
    };
    study.file.stimuli.files.iter().map(digest).collect()
}

/// The picture or the film of a configuration.
///
/// # Errors
/// If it cannot be read; if a film does not take `stimuli.duration_s`.
pub(crate) fn film(study: &Study, of: &Configuration) -> Result<Film> {
    let path = path(study, of)?;
    let film = read_film(&path).with_context(|| path.display().to_string())?;
    let wanted = study.file.stimuli.duration_s;
    if let Some(found) = film.duration_s
        && (found - wanted).abs() > TOLERANCE_S
    {
        bail!(
            "{} takes {found:.2} s, and stimuli.duration_s of {} is {wanted:?}: all films take as long",
            path.display(),
            study.path.display()
        );
    }
    Ok(film)
}

fn read_film(path: &Path) -> Result<Film> {
    Ok(match ending(path).as_str() {
        "png" => Film::from_png(&input::bytes(path)?)?,
        "gif" => Film::from_gif(&input::bytes(path)?)?,
        _ => video::read(path)?,
    })
}

fn ending(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// The meshes of one object, in the order of `all`, moved and scaled as one so that they fill a ball of radius 1 about the origin. glTF's
/// upward y is upward z here; coordinates of other files stay as they are.
///
/// # Errors
/// If one cannot be read, or none has a triangle.
pub(crate) fn meshes(study: &Study, all: &[&Configuration]) -> Result<Vec<TriangleMesh>> {
    let read = |of: &&Configuration| {
        let path = path(study, of)?;
        read_mesh(&path).with_context(|| path.display().to_string())
    };
    let mut meshes: Vec<TriangleMesh> = all.iter().map(read).collect::<Result<_>>()?;
    let bounds = |mesh: &TriangleMesh| mesh.bounds().filter(|_| !mesh.triangles.is_empty());
    let join = |a: Bounds, b: Bounds| Bounds { min: a.min.min(b.min), max: a.max.max(b.max) };
    let object = || &study.object(all[0]).id;
    let whole = meshes.iter().filter_map(bounds).reduce(join);
    let whole = whole.with_context(|| format!("no file of {} has a triangle", object()))?;
    let middle = (whole.min + whole.max) / 2.0;
    let radius = (whole.max - whole.min).length() / 2.0;
    if !(radius.is_finite() && radius > 0.0) {
        bail!("the meshes of {} have no extent", object());
    }
    for mesh in &mut meshes {
        mesh.positions.iter_mut().for_each(|p| *p = (*p - middle) / radius);
    }
    Ok(meshes)
}

fn read_mesh(path: &Path) -> Result<TriangleMesh> {
    let mut mesh =
        if ending(path) == "glb" { read_glb(&input::bytes(path)?)? } else { mesh_file::read(path)? };
    if mesh.normals.len() != mesh.positions.len() {
        mesh.normals = area_weighted_normals(&mesh.positions, &mesh.triangles);
    }
    Ok(mesh)
}

/// The triangles of a binary glTF file's scene, each node where it stands. Materials, textures, skins and movements are left out.
///
/// # Errors
/// If it is no such file, or its numbers are in another file.
fn read_glb(bytes: &[u8]) -> Result<TriangleMesh> {
    let file = gltf::Gltf::from_slice(bytes).context("no glTF")?;
    let blob = file.blob.as_deref();
    let source = |buffer: gltf::Buffer<'_>| match buffer.source() {
        gltf::buffer::Source::Bin => blob,
        gltf::buffer::Source::Uri(_) => None,
    };
    let scene = file.default_scene().or_else(|| file.scenes().next()).context("no scene")?;
    let mut mesh = TriangleMesh::default();
    // Parents before children, with where they stand.
    let mut nodes: Vec<(gltf::Node<'_>, glam::Mat4)> =
        scene.nodes().map(|node| (node, glam::Mat4::IDENTITY)).collect();
    while let Some((node, parent)) = nodes.pop() {
        let at = parent * glam::Mat4::from_cols_array_2d(&node.transform().matrix());
        nodes.extend(node.children().map(|child| (child, at)));
        for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
            add_primitive(&mut mesh, &primitive, source, at)?;
        }
    }
    Ok(mesh)
}

fn add_primitive<'a, 's>(
    mesh: &mut TriangleMesh,
    primitive: &'a gltf::Primitive<'a>,
    source: impl Clone + Fn(gltf::Buffer<'a>) -> Option<&'s [u8]>,
    at: glam::Mat4,
) -> Result<()> {
    if primitive.mode() != gltf::mesh::Mode::Triangles {
        bail!("has {:?}, and only triangles are read", primitive.mode());
    }
    // Upward y of glTF is upward z here.
    let upright = |p: Vec3| Vec3::new(p.x, -p.z, p.y);
    let reader = primitive.reader(source);
    let positions = reader.read_positions().context("positions are missing, or in another file")?;
    let first = u32::try_from(mesh.positions.len()).context("too many vertices")?;
    mesh.positions.extend(positions.map(|p| upright(at.transform_point3(Vec3::from(p)))));
    let added = u32::try_from(mesh.positions.len()).context("too many vertices")? - first;
    let linear = Mat3::from_mat4(at);
    if let Some(normals) = reader.read_normals() {
        let turned = linear.inverse().transpose();
        mesh.normals.extend(normals.map(|n| upright((turned * Vec3::from(n)).normalize_or_zero())));
    }
    let indices: Vec<u32> = match reader.read_indices() {
        Some(indices) => indices.into_u32().collect(),
        None => (0..added).collect(),
    };
    // A mirror turns triangles round.
    let is_mirrored = linear.determinant() < 0.0;
    for corners in indices.as_chunks::<3>().0 {
        if let Some(beyond) = corners.iter().find(|corner| **corner >= added) {
            bail!("a triangle names vertex {beyond} of {added}");
        }
        let [a, b, c] = corners.map(|corner| corner + first);
        mesh.triangles.push(if is_mirrored { [a, c, b] } else { [a, b, c] });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What our own writer writes comes back: it writes coordinates as they are, and the reader takes y for up.
    #[test]
    fn a_mesh_comes_back_from_gltf() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, 3.0), Vec3::new(-1.0, 0.5, 0.25)];
        let triangles = vec![[0, 1, 2], [2, 3, 0]];
        let normals = area_weighted_normals(&positions, &triangles);
        let mesh = TriangleMesh { positions, normals, triangles };
        let mut bytes = Vec::new();
        isostudy_mesh::write_glb(&mesh, &mut bytes).unwrap();
        let read = read_glb(&bytes).unwrap();
        assert_eq!(read.triangles, mesh.triangles);
        let near = |a: Vec3, b: Vec3| (a - b).length() < 1e-6;
        let upright = |p: &Vec3| Vec3::new(p.x, -p.z, p.y);
        let is_same = |read: &[Vec3], own: &[Vec3]| {
            read.len() == own.len() && read.iter().zip(own).all(|(a, b)| near(*a, upright(b)))
        };
        assert!(is_same(&read.positions, &mesh.positions), "{:?}", read.positions);
        assert!(is_same(&read.normals, &mesh.normals), "{:?}", read.normals);
        for cut in 0..bytes.len() {
            assert!(read_glb(&bytes[..cut]).is_err(), "{cut}");
        }
    }
}
