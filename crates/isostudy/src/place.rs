//! A point in space, for people.

use glam::Vec3;

/// As lists of a study file have it: `[7.0, 7.0, 7.0]`.
pub(crate) fn place(p: Vec3) -> String {
    format!("[{:?}, {:?}, {:?}]", p.x, p.y, p.z)
}
