//! The points of Wavefront OBJ, with or without faces.

use glam::Vec3;
use isostudy_mesh::read_obj;

use super::{PointCloud, PointsError, number, text};

pub(super) fn read(bytes: &[u8]) -> Result<PointCloud, PointsError> {
    // It checks the file.
    let mesh = read_obj(bytes)?;
    let text = text(bytes);
    let mut cloud = PointCloud { positions: mesh.positions, ..PointCloud::default() };
    for (line, written) in (1..).zip(text.lines()) {
        let mut words = written.split('#').next().unwrap_or_default().split_ascii_whitespace();
        match words.next() {
            Some("v") => cloud.lines.push(line as u32),
            Some("vn") if mesh.triangles.is_empty() => {
                let mut normal = Vec3::ZERO;
                for (axis, word) in words.take(3).enumerate() {
                    normal[axis] = number(line, word)?;
                }
                cloud.normals.push(normal);
            }
            _ => {}
        }
    }
    if !mesh.triangles.is_empty() {
        cloud.normals = mesh.normals;
    }
    let (normals, points) = (cloud.normals.len(), cloud.positions.len());
    if normals > 0 && normals != points {
        return Err(PointsError::Normals { normals, points });
    }
    Ok(cloud)
}
