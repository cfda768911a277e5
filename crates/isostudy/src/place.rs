//! Points of space, as text.

use glam::Vec3;

/// As a study file has it: `[7.0, 7.0, 7.0]`.
pub(crate) fn place(p: Vec3) -> String {
    format!("[{:?}, {:?}, {:?}]", p.x, p.y, p.z)
}
