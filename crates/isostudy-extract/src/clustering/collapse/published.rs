//! The published edge collapse: the post-process that the evaluation compares with integrated clustering.

use std::collections::TryReserveError;

use glam::Vec3;

use super::{Merged, unique_edges};

/// Collapses short edges of an unclustered mesh in one pass.
///
/// Edges are taken in order of their smaller, then larger vertex number. The two ends are looked up where earlier
/// collapses left them; if their distance is at most half of `spacing`, both become the midpoint. The
/// order is by number and not by length, collapses change lengths that were already passed over, and neither topology
/// nor normals are looked at: the result can fold over itself.
///
/// Returns where vertices are now, and which are one.
///
/// Source: Costen (2026), "post-processed" clustering.
pub(super) fn published(
    mut positions: Vec<Vec3>,
    triangles: &[[u32; 3]],
    spacing: f32,
) -> Result<(Vec<Vec3>, Merged), TryReserveError> {
    let limit = spacing * spacing / 4.0;
    let mut merged = Merged::none(positions.len())?;
    for (a, b) in unique_edges(triangles)? {
        let (a, b) = (merged.survivor(a), merged.survivor(b));
        let [p, q] = [positions[a as usize], positions[b as usize]];
        if a != b && (p - q).length_squared() <= limit {
            positions[a as usize] = (p + q) * 0.5;
            merged.into[b as usize] = a;
        }
    }
    Ok((positions, merged))
}

#[cfg(test)]
mod tests {
    use super::super::collapse_traced;
    use super::*;
    use crate::settings::Topology;

    /// Positions and triangles of what is left.
    fn collapsed(positions: Vec<Vec3>, triangles: &[[u32; 3]], spacing: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let after = collapse_traced(Topology::Published, spacing, positions, triangles).unwrap();
        (after.positions, after.triangles)
    }

    /// A strip of two triangles over a short and a long side.
    fn strip() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let positions =
            vec![Vec3::ZERO, Vec3::new(0.4, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0), Vec3::new(2.0, 2.0, 0.0)];
        (positions, vec![[0, 1, 2], [1, 3, 2]])
    }

    #[test]
    fn short_edge_goes_to_its_midpoint() {
        let (positions, triangles) = strip();
        let (positions, triangles) = collapsed(positions, &triangles, 1.0);
        assert_eq!(triangles, [[0, 1, 2]]);
        assert_eq!(positions, [Vec3::new(0.2, 0.0, 0.0), Vec3::new(2.0, 2.0, 0.0), Vec3::new(0.0, 2.0, 0.0)]);
    }

    #[test]
    fn half_the_spacing_is_the_limit_and_counts() {
        let (positions, triangles) = strip();
        let longer = collapsed(positions.clone(), &triangles, 0.79);
        assert_eq!(longer.1, triangles);
        let mut exact = positions;
        exact[1].x = 0.5;
        assert_eq!(collapsed(exact, &triangles, 1.0).1.len(), 1);
    }

    #[test]
    fn later_collapses_start_from_moved_vertices() {
        // Three points 0.4 apart: the first collapse moves the pair to 0.2, and 0.8 is then too far away.
        let positions =
            vec![Vec3::ZERO, Vec3::new(0.4, 0.0, 0.0), Vec3::new(0.8, 0.0, 0.0), Vec3::new(0.0, 9.0, 0.0)];
        let (positions, triangles) = collapsed(positions, &[[0, 1, 3], [1, 2, 3]], 1.0);
        assert_eq!(triangles.len(), 1);
        assert!(
            positions.contains(&Vec3::new(0.2, 0.0, 0.0)) && positions.contains(&Vec3::new(0.8, 0.0, 0.0))
        );
    }
}
