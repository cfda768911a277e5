//! Edge collapse: the post-process that the evaluation compares with integrated clustering.

use glam::Vec3;

/// Collapses short edges of an unclustered mesh in one pass and renumbers what is left.
///
/// Edges are taken in order of their smaller, then larger vertex number. The two ends are looked up where earlier
/// collapses left them; if their distance is at most half of `spacing`, both become the midpoint. Triangles that lose
/// a corner are dropped. The order is by number and not by length, collapses change lengths that were already
/// passed over, and neither topology nor normals are looked at: the result can fold over itself.
///
/// Returns positions and triangles; vertices are numbered by first use.
///
/// Source: Costen (2026), "post-processed" clustering.
pub(crate) fn collapse_short_edges(
    mut positions: Vec<Vec3>,
    triangles: &[[u32; 3]],
    spacing: f32,
) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let limit = spacing * spacing / 4.0;
    let mut merged = Merged { into: (0..positions.len() as u32).collect() };
    for (a, b) in unique_edges(triangles) {
        let (a, b) = (merged.survivor(a), merged.survivor(b));
        let [p, q] = [positions[a as usize], positions[b as usize]];
        if a != b && (p - q).length_squared() <= limit {
            positions[a as usize] = (p + q) * 0.5;
            merged.into[b as usize] = a;
        }
    }
    rebuild(&positions, triangles, &mut merged)
}

/// Which vertex each vertex was merged into, directly or through others.
struct Merged {
    into: Vec<u32>,
}

impl Merged {
    /// Follows the chain to its end and shortens it on the way.
    fn survivor(&mut self, vertex: u32) -> u32 {
        let mut vertex = vertex as usize;
        while self.into[vertex] as usize != vertex {
            self.into[vertex] = self.into[self.into[vertex] as usize];
            vertex = self.into[vertex] as usize;
        }
        vertex as u32
    }
}

fn unique_edges(triangles: &[[u32; 3]]) -> Vec<(u32, u32)> {
    let ordered = |a: u32, b: u32| (a.min(b), a.max(b));
    let mut edges: Vec<_> =
        triangles.iter().flat_map(|&[a, b, c]| [ordered(a, b), ordered(b, c), ordered(c, a)]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

fn rebuild(positions: &[Vec3], triangles: &[[u32; 3]], merged: &mut Merged) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    const UNSEEN: u32 = u32::MAX;
    let mut numbers = vec![UNSEEN; positions.len()];
    let mut kept_positions = Vec::new();
    let mut kept_triangles = Vec::new();
    for triangle in triangles {
        let triangle @ [a, b, c] = triangle.map(|vertex| merged.survivor(vertex));
        if a == b || b == c || c == a {
            continue;
        }
        kept_triangles.push(triangle.map(|vertex| {
            let number = &mut numbers[vertex as usize];
            if *number == UNSEEN {
                *number = kept_positions.len() as u32;
                kept_positions.push(positions[vertex as usize]);
            }
            *number
        }));
    }
    (kept_positions, kept_triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of two triangles over a short and a long side.
    fn strip() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let positions =
            vec![Vec3::ZERO, Vec3::new(0.4, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0), Vec3::new(2.0, 2.0, 0.0)];
        (positions, vec![[0, 1, 2], [1, 3, 2]])
    }

    #[test]
    fn short_edge_goes_to_its_midpoint() {
        let (positions, triangles) = strip();
        let (positions, triangles) = collapse_short_edges(positions, &triangles, 1.0);
        assert_eq!(triangles, [[0, 1, 2]]);
        assert_eq!(positions, [Vec3::new(0.2, 0.0, 0.0), Vec3::new(2.0, 2.0, 0.0), Vec3::new(0.0, 2.0, 0.0)]);
    }

    #[test]
    fn half_the_spacing_is_the_limit_and_counts() {
        let (positions, triangles) = strip();
        let longer = collapse_short_edges(positions.clone(), &triangles, 0.79);
        assert_eq!(longer.1, triangles);
        let mut exact = positions;
        exact[1].x = 0.5;
        assert_eq!(collapse_short_edges(exact, &triangles, 1.0).1.len(), 1);
    }

    #[test]
    fn later_collapses_start_from_moved_vertices() {
        // Three points 0.4 apart: the first collapse moves the pair to 0.2, and 0.8 is then too far away.
        let positions =
            vec![Vec3::ZERO, Vec3::new(0.4, 0.0, 0.0), Vec3::new(0.8, 0.0, 0.0), Vec3::new(0.0, 9.0, 0.0)];
        let (positions, triangles) = collapse_short_edges(positions, &[[0, 1, 3], [1, 2, 3]], 1.0);
        assert_eq!(triangles.len(), 1);
        assert!(
            positions.contains(&Vec3::new(0.2, 0.0, 0.0)) && positions.contains(&Vec3::new(0.8, 0.0, 0.0))
        );
    }
}
