//! Vertices close to each other made one.

use crate::surface::{compact, is_proper};
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::DVec3;
use std::collections::HashMap;

/// The mesh with vertices merged that lie within `tolerance` of each other.
///
/// Vertices are taken in their order. One is merged into the nearest that was kept before it, if that lies within the tolerance;
/// otherwise it is kept. So no vertex moves farther than the tolerance, kept ones do not move, and any two of them lie farther apart.
/// Triangles that lose a corner by it are left out. The rest may be non-manifold, coincide or face each other: count it
/// with [`isostudy_mesh::topology`].
pub(crate) fn merge_by_distance(mesh: &TriangleMesh, tolerance: f64) -> TriangleMesh {
    let mut kept = Kept { cell: 2.002 * tolerance, tolerance, cells: HashMap::new(), points: Vec::new() };
    let is_used = {
        let mut is_used = vec![false; mesh.positions.len()];
        mesh.triangles.iter().flatten().for_each(|&v| is_used[v as usize] = true);
        is_used
    };
    let mut moved_to: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    for v in (0..mesh.positions.len() as u32).filter(|&v| is_used[v as usize]) {
        let p = mesh.positions[v as usize].as_dvec3();
        match kept.nearest(p) {
            Some(other) => moved_to[v as usize] = other,
            None => kept.keep(v, p),
        }
    }
    let moved = mesh.triangles.iter().map(|t| t.map(|v| moved_to[v as usize]));
    compact(&mesh.positions, &moved.filter(is_proper).collect::<Vec<_>>())
}

/// Kept vertices by cells of a grid, a little more than twice the tolerance wide, so that a ball reaches into two along each axis.
struct Kept {
    cell: f64,
    tolerance: f64,
    cells: HashMap<[u64; 3], Vec<u32>>,
    points: Vec<(u32, DVec3)>,
}

impl Kept {
    /// Cells are numbered by whole numbers in double precision, which may be as large as coordinates are.
    fn key(cell: DVec3) -> [u64; 3] {
        // The sum is 0 for -0 as well.
        cell.to_array().map(|number| (number + 0.0).to_bits())
    }

    fn cell_of(&self, p: DVec3) -> DVec3 {
        // Of no tolerance, each point is its own cell.
        if self.cell > 0.0 { (p / self.cell).floor() } else { p }
    }

    fn keep(&mut self, v: u32, p: DVec3) {
        let key = Self::key(self.cell_of(p));
        self.cells.entry(key).or_default().push(self.points.len() as u32);
        self.points.push((v, p));
    }

    /// The nearest within the tolerance, the first of those that are as near.
    fn nearest(&self, p: DVec3) -> Option<u32> {
        let reach = DVec3::splat(1.0005 * self.tolerance);
        let (low, high) = (self.cell_of(p - reach), self.cell_of(p + reach));
        let along = |axis: usize| if low[axis] == high[axis] { &[false][..] } else { &[false, true][..] };
        let mut found: Option<(f64, u32)> = None;
        for &x in along(0) {
            for &y in along(1) {
                for &z in along(2) {
                    let pick = |axis: usize, is_high: bool| if is_high { high[axis] } else { low[axis] };
                    let key = Self::key(DVec3::new(pick(0, x), pick(1, y), pick(2, z)));
                    for &at in self.cells.get(&key).into_iter().flatten() {
                        let (v, q) = self.points[at as usize];
                        let far = p.distance(q);
                        if far <= self.tolerance && found.is_none_or(|(least, of)| (far, v) < (least, of)) {
                            found = Some((far, v));
                        }
                    }
                }
            }
        }
        found.map(|(_, v)| v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cube, icosphere, sheet, torus};
    use isostudy_mesh::glam::Vec3;
    use isostudy_mesh::topology::topology;
    use proptest::prelude::*;

    /// Each triangle with corners of its own.
    fn soup(mesh: &TriangleMesh) -> TriangleMesh {
        let positions = mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]).collect();
        let triangles = (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        TriangleMesh { positions, normals: Vec::new(), triangles }
    }

    #[test]
    fn no_tolerance_is_a_weld() {
        for mesh in [icosphere(3), cube(4), sheet(3), torus(0.4, 12, 7)] {
            let merged = merge_by_distance(&soup(&mesh), 0.0);
            assert_eq!(topology(&merged), topology(&mesh));
            assert_eq!(merged.triangles.len(), mesh.triangles.len());
        }
        let zeros = TriangleMesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(-0.0, 0.0, -0.0), Vec3::Z, Vec3::X],
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            ..TriangleMesh::default()
        };
        assert_eq!(merge_by_distance(&zeros, 0.0).positions.len(), 4);
    }

    #[test]
    fn a_thin_plate_loses_its_inside() {
        // Two sheets a hundredth apart: merged, every triangle has a twin that faces it, and every edge four.
        let top = sheet(4);
        let mut plate = top.clone();
        plate.positions.extend(top.positions.iter().map(|&p| p - 0.01 * Vec3::Z));
        plate.triangles.extend(top.triangles.iter().map(|&[a, b, c]| [25 + a, 25 + c, 25 + b]));
        let before = topology(&plate);
        assert_eq!((before.components, before.non_manifold_edges), (2, 0));
        let after = topology(&merge_by_distance(&plate, 0.011));
        assert_eq!((after.components, after.folded_faces, after.vertices), (1, 32, 25));
        // Every inner edge: 3 n^2 + 2 n edges, 4 n of them at the border.
        assert_eq!(after.non_manifold_edges, 3 * 16 + 2 * 4 - 4 * 4);
        let apart = topology(&merge_by_distance(&plate, 0.009));
        assert_eq!(apart, before);
    }

    #[test]
    fn a_cube_of_one_tolerance_is_nothing() {
        let merged = merge_by_distance(&cube(3), 2.0);
        assert_eq!((merged.positions.len(), merged.triangles.len()), (0, 0));
    }

    proptest! {
        /// Against all pairs, at any scale.
        #[test]
        fn it_is_what_all_pairs_say(
            points in prop::collection::vec(prop::array::uniform3(-8i32..8), 3..60),
            scale in -20i32..20,
            tolerance in 0.0..3.0f64,
        ) {
            let scale = 2f32.powi(scale);
            let tolerance = tolerance * f64::from(scale);
            let positions: Vec<Vec3> =
                points.iter().map(|p| Vec3::from(p.map(|c| c as f32 * scale))).collect();
            let triangles = (0..positions.len() as u32 - 2).map(|v| [v, v + 1, v + 2]).collect();
            let mesh = TriangleMesh { positions, normals: Vec::new(), triangles };
            let mut kept: Vec<usize> = Vec::new();
            let mut moved_to = Vec::new();
            for (v, p) in mesh.positions.iter().enumerate() {
                let far = |&k: &usize| (mesh.positions[k].as_dvec3().distance(p.as_dvec3()), k);
                let near = kept.iter().map(far).filter(|(far, _)| *far <= tolerance);
                let to = near.min_by(|a, b| a.partial_cmp(b).unwrap()).map(|(_, k)| k);
                if to.is_none() {
                    kept.push(v);
                }
                moved_to.push(mesh.positions[to.unwrap_or(v)]);
            }
            let want: Vec<[Vec3; 3]> = mesh.triangles.iter().map(|t| t.map(|v| moved_to[v as usize]))
                .filter(|[a, b, c]| a != b && b != c && c != a).collect();
            let merged = merge_by_distance(&mesh, tolerance);
            let found: Vec<[Vec3; 3]> = (0..merged.triangles.len()).map(|t| merged.corners(t)).collect();
            prop_assert_eq!(found, want);
        }
    }
}
